//! The broker: states, alarms and results of the machine by MQTT, as an edge node of Sparkplug B. Connections are made by
//! the control; no port is opened, and no command but the one for a birth is known.
//! Files: `broker_settings` where the broker is and how to prove oneself, `broker_link` one connection, `edge_node` what
//! Sparkplug says, `part_outbox` the results that the broker acknowledges.

mod broker_link;
mod broker_settings;
mod edge_node;
mod part_outbox;

use std::net::{TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use self::broker_link::{BrokerEvent, BrokerLink, Login};
use self::broker_settings::BrokerSettings;
use self::edge_node::EdgeNode;
use self::part_outbox::PartOutbox;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::link::network::{BrokerState, BrokerView};
use crate::link::snapshot::Snapshot;

/// Longest time to connect to an address of the broker.
const DIAL_TIME: Duration = Duration::from_secs(5);
/// Time to the next try, and the longest; it doubles while tries fail.
const RETRY_TIMES: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(30)];
/// A connection that has lasted so long was a good one.
const GOOD_CONNECTION: Duration = Duration::from_secs(60);
/// Time between two looks at measured values.
const SAMPLE_INTERVAL: Duration = Duration::from_secs(1);
/// Least time between two births that somebody asks for.
const BIRTH_INTERVAL: Duration = Duration::from_secs(1);
/// Time between two writings of how far the broker knows the parts.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// How far the connection is.
enum Phase {
    /// Switched off, or the next try is waited for.
    Waiting,
    /// A thread connects.
    Dialing(BrokerSettings, Receiver<std::io::Result<TcpStream>>),
    /// The broker has not answered yet.
    Joining(BrokerLink),
    /// The broker listens.
    Connected(BrokerLink),
}

/// The client of the broker.
pub struct MqttClient {
    /// The data directory.
    folder: PathBuf,
    phase: Phase,
    node: Option<EdgeNode>,
    outbox: PartOutbox,
    /// When the next try is due, and the time to the one after it.
    retry_at: Duration,
    retry_time: Duration,
    /// When the phase began.
    since: Duration,
    sample_at: Duration,
    write_at: Duration,
    /// When the last birth was told.
    birth_at: Duration,
    birth_wanted: bool,
    view: BrokerView,
}

impl MqttClient {
    /// A client that is off, of a data directory.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self {
            outbox: PartOutbox::new(&folder),
            folder,
            phase: Phase::Waiting,
            node: None,
            retry_at: Duration::ZERO,
            retry_time: RETRY_TIMES[0],
            since: Duration::ZERO,
            sample_at: Duration::ZERO,
            write_at: Duration::ZERO,
            birth_at: Duration::ZERO,
            birth_wanted: false,
            view: BrokerView::default(),
        }
    }

    /// Connects, tells, keeps. `now` runs on from any begin; `time` is the time of day.
    pub fn step(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        if snapshot.params.get(param::MQTT_ENABLED) < 1.0 {
            return self.switch_off();
        }
        match std::mem::replace(&mut self.phase, Phase::Waiting) {
            Phase::Waiting if now < self.retry_at => {}
            Phase::Waiting => {
                if let Err(why) = self.dial(now, snapshot) {
                    self.fail(now, why);
                }
            }
            Phase::Dialing(settings, dialed) => {
                if let Err(why) = self.join(now, time, settings, dialed) {
                    self.fail(now, why);
                }
            }
            Phase::Joining(link) | Phase::Connected(link) => {
                if let Err(why) = self.serve(now, time, snapshot, link) {
                    self.lose(now, why);
                }
            }
        }
        let is_connected = matches!(self.phase, Phase::Connected(_));
        if let Some(node) = self.node.as_mut().filter(|_| !is_connected) {
            node.keep(time, snapshot);
        }
        if now >= self.write_at {
            self.write_at = now + WRITE_INTERVAL;
            self.outbox.write();
        }
        let stored = self.node.as_ref().map_or(0, EdgeNode::stored_count) as u64;
        self.view.waiting = stored + self.outbox.waiting(snapshot);
    }

    /// Ends the connection: the broker tells the others that nothing is known any more.
    pub fn close(&mut self) {
        if matches!(self.phase, Phase::Joining(_) | Phase::Connected(_)) {
            self.forget_sent();
        }
        self.phase = Phase::Waiting;
        self.outbox.write();
    }

    /// What the page shows.
    #[must_use]
    pub const fn view(&self) -> &BrokerView {
        &self.view
    }

    fn switch_off(&mut self) {
        self.close();
        (self.node, self.retry_at, self.retry_time) = (None, Duration::ZERO, RETRY_TIMES[0]);
        self.view = BrokerView::default();
    }

    /// Reads the settings anew and begins to connect.
    fn dial(&mut self, now: Duration, snapshot: &Snapshot) -> Result<(), LocalizedText> {
        self.since = now;
        let settings = BrokerSettings::read(&self.folder)?;
        let Some((host, port)) = settings.host_and_port() else { return Ok(()) };
        self.view.address = format!("{host}:{port}");
        self.view.is_encrypted = settings.tls.is_some();
        if !self.node.as_ref().is_some_and(|node| node.stands_for(&settings.group, snapshot)) {
            self.node = Some(EdgeNode::new(&settings.group, snapshot));
        }
        let (tell, dialed) = bounded(1);
        let dial = move || drop(tell.send(connect((host.as_str(), port))));
        std::thread::Builder::new().name("kt830-mqtt-dial".to_owned()).spawn(dial).map_err(in_words)?;
        if !matches!(self.view.state, BrokerState::Failed(_)) {
            self.view.state = BrokerState::Connecting;
        }
        self.phase = Phase::Dialing(settings, dialed);
        Ok(())
    }

    /// Begins to speak the protocol once the stream is there.
    fn join(
        &mut self,
        now: Duration,
        time: Duration,
        settings: BrokerSettings,
        dialed: Receiver<std::io::Result<TcpStream>>,
    ) -> Result<(), LocalizedText> {
        let stream = match dialed.try_recv() {
            Ok(stream) => stream.map_err(|error| unreachable_text(&error))?,
            Err(TryRecvError::Empty) => {
                self.phase = Phase::Dialing(settings, dialed);
                return Ok(());
            }
            Err(TryRecvError::Disconnected) => return Err(in_words("connect")),
        };
        let Some(node) = &mut self.node else { return Ok(()) };
        let will = node.next_session(time);
        let login =
            Login { client: node.id(), user: (&settings.user, &settings.password), will: (will.topic, will.payload) };
        let tls = settings.tls_ends(&self.folder)?;
        self.phase = Phase::Joining(BrokerLink::open(stream, tls, login, now)?);
        self.since = now;
        Ok(())
    }

    /// A step of a connection.
    fn serve(
        &mut self,
        now: Duration,
        time: Duration,
        snapshot: &Snapshot,
        mut link: BrokerLink,
    ) -> Result<(), LocalizedText> {
        let Some(node) = &mut self.node else { return Ok(()) };
        for event in link.step(now)? {
            match event {
                BrokerEvent::Accepted => {
                    link.subscribe(&node.command_topic(), now)?;
                    (self.since, self.view.state) = (now, BrokerState::Connected);
                    self.view.connections += 1;
                }
                BrokerEvent::Received { topic, payload } => self.birth_wanted |= node.asks_for_birth(&topic, &payload),
                BrokerEvent::Acknowledged(packet) => self.outbox.acknowledged(packet),
                BrokerEvent::PingSent => node.ping_sent(),
                BrokerEvent::PingAnswered => node.ping_answered(),
            }
        }
        if self.view.state != BrokerState::Connected {
            self.phase = Phase::Joining(link);
            return Ok(());
        }
        let with_samples = now >= self.sample_at;
        if with_samples {
            self.sample_at = now + SAMPLE_INTERVAL;
        }
        let mut told = node.tell(time, snapshot, with_samples);
        if self.birth_wanted && now >= self.birth_at + BIRTH_INTERVAL {
            (self.birth_wanted, self.birth_at) = (false, now);
            told.push(node.birth(time));
        }
        for message in told {
            link.publish(&message.topic, message.payload)?;
            self.view.sent += 1;
        }
        while let Some((part, text)) = self.outbox.next(node.id(), snapshot) {
            let Some(packet) = link.publish_acknowledged(&node.part_topic(), text.clone().into_bytes())? else { break };
            self.outbox.sent((part, text), packet);
            self.view.sent += 1;
        }
        link.send()?;
        self.phase = Phase::Connected(link);
        Ok(())
    }

    /// A try has failed, or a connection is over; it is tried again a while later.
    pub fn fail(&mut self, now: Duration, why: LocalizedText) {
        self.view.state = BrokerState::Failed(why);
        self.retry_at = now + self.retry_time;
        self.retry_time = (2 * self.retry_time).min(RETRY_TIMES[1]);
    }

    /// A connection is over.
    fn lose(&mut self, now: Duration, why: LocalizedText) {
        if now.saturating_sub(self.since) >= GOOD_CONNECTION {
            self.retry_time = RETRY_TIMES[0];
        }
        self.forget_sent();
        self.fail(now, why);
    }

    fn forget_sent(&mut self) {
        self.outbox.connection_lost();
        if let Some(node) = &mut self.node {
            node.connection_lost();
        }
    }
}

/// Connects to the first address that answers.
fn connect(address: (&str, u16)) -> std::io::Result<TcpStream> {
    let mut refused = None;
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, DIAL_TIME) {
            Ok(stream) => return Ok(stream),
            Err(error) => refused = Some(error),
        }
    }
    Err(refused.unwrap_or_else(|| std::io::ErrorKind::NotFound.into()))
}

/// A fault as the system or a library tells it.
fn in_words(fault: impl std::fmt::Display) -> LocalizedText {
    LocalizedText::same(&fault)
}

fn unreachable_text(error: &std::io::Error) -> LocalizedText {
    match error.kind() {
        std::io::ErrorKind::ConnectionRefused => {
            Text::new("服务器不在：连接被拒绝", "no broker there: the connection is refused").into()
        }
        std::io::ErrorKind::TimedOut => Text::new("服务器没有应答", "the broker does not answer").into(),
        _ => in_words(error),
    }
}
