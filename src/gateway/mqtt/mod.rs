//! The broker: states, alarms and results of the machine by MQTT, as an edge node of Sparkplug B. Connections are made by
//! the control; no port is opened. The commands are the one for a birth, and orders that the operator has to accept.
//! Files: `broker_settings` where the broker is and how to prove oneself, `broker_link` one connection, `edge_node` what
//! Sparkplug says, `order_topics` orders of the shop, `part_outbox` the results that the broker acknowledges, `told_to_broker` what it has of them.

mod broker_link;
mod broker_settings;
mod edge_node;
mod order_topics;
mod part_outbox;
mod told_to_broker;

use std::net::{TcpStream, ToSocketAddrs};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use self::broker_link::{BrokerEvent, BrokerLink, BrokerLogin};
use self::broker_settings::{BrokerSettings, TlsEnds};
use self::edge_node::EdgeNode;
use self::order_topics::OrderTopics;
use self::part_outbox::PartOutbox;
use crate::defs::date::DateTime;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::gateway::in_words;
use crate::gateway::order_inbox::SharedInbox;
use crate::link::network::{BrokerState, BrokerView, TlsView};
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
/// Time between two writings of what the broker has: it waits for the disk.
const WRITE_INTERVAL: Duration = Duration::from_secs(10);

/// Last levels of the topics beside Sparkplug.
const PART_TOPIC: &str = "part";
const ORDER_TOPIC: &str = "order";
const ANSWER_TOPIC: &str = "order/answer";
const LIST_TOPIC: &str = "orders";

/// A stream to the broker, and what to say on it.
struct Dialed {
    settings: BrokerSettings,
    stream: TcpStream,
    tls: Option<TlsEnds>,
}

/// The broker that the settings name, if they can be read, and what became of the try.
type DialResult = (String, Result<Dialed, LocalizedText>);

/// How far the connection is.
enum Phase {
    /// The next try is waited for.
    Waiting,
    /// A thread reads the settings and connects.
    Dialing(Receiver<DialResult>),
    /// The broker has not answered yet.
    Joining(BrokerLink),
    /// The broker listens.
    Connected(BrokerLink),
}

/// The client of the broker.
pub struct MqttClient {
    /// The data directory.
    folder: PathBuf,
    is_on: bool,
    phase: Phase,
    node: Option<EdgeNode>,
    outbox: PartOutbox,
    orders: OrderTopics,
    /// Why the last try has failed; none once the broker listens.
    failure: Option<LocalizedText>,
    /// When the next try is due, and the time to the one after it.
    retry_at: Duration,
    retry_time: Duration,
    /// When the certificate of the control ends.
    machine_until: Option<DateTime>,
    /// When the broker took the connection.
    since: Duration,
    sample_at: Duration,
    write_at: Duration,
    /// When the next birth may be told to who asks for it.
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
            is_on: false,
            phase: Phase::Waiting,
            node: None,
            orders: OrderTopics::default(),
            failure: None,
            retry_at: Duration::ZERO,
            retry_time: RETRY_TIMES[0],
            machine_until: None,
            since: Duration::ZERO,
            sample_at: Duration::ZERO,
            write_at: Duration::ZERO,
            birth_at: Duration::ZERO,
            birth_wanted: false,
            view: BrokerView::default(),
        }
    }

    /// With orders to a control.
    #[must_use]
    pub fn with_orders(self, inbox: SharedInbox) -> Self {
        Self { orders: OrderTopics::new(inbox), ..self }
    }

    /// Connects, tells, keeps. `now` runs on from any begin; `time` is the time of day.
    pub fn step(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        let is_on = snapshot.params.get(param::MQTT_ENABLED) > 0.0;
        if std::mem::replace(&mut self.is_on, is_on) && !is_on {
            self.switch_off(time);
        }
        if !is_on {
            return;
        }
        match std::mem::replace(&mut self.phase, Phase::Waiting) {
            Phase::Waiting if now < self.retry_at => {}
            Phase::Waiting if !has_number(snapshot) => self.failure = Some(no_number()),
            Phase::Waiting => self.dial(now),
            Phase::Dialing(dialed) => self.join(now, time, snapshot, dialed),
            Phase::Joining(link) => self.wait_for_acceptance(now, snapshot, link),
            Phase::Connected(link) => self.serve(now, time, snapshot, link),
        }
        if let Some(node) = self.node.as_mut().filter(|_| !matches!(self.phase, Phase::Connected(_))) {
            node.keep(time, snapshot);
        }
        if now >= self.write_at {
            self.write_at = now + WRITE_INTERVAL;
            self.outbox.told.write();
        }
        self.show(snapshot);
    }

    /// Ends the connection: nothing is known any more. It is tried again at the next step.
    pub fn close(&mut self, time: Duration) {
        if let (Phase::Connected(link), Some(node)) = (&mut self.phase, &self.node) {
            let death = node.death(time);
            link.publish(&death.topic, death.payload);
            link.disconnect();
        }
        self.end_connection();
        self.outbox.told.write();
        self.view.state = if self.is_on { BrokerState::Connecting } else { BrokerState::Off };
    }

    /// What the page shows.
    #[must_use]
    pub const fn view(&self) -> &BrokerView {
        &self.view
    }

    /// The connection is over, or there was none; it is tried again a while later.
    pub fn fail(&mut self, now: Duration, why: LocalizedText, snapshot: &Snapshot) {
        if matches!(self.phase, Phase::Connected(_)) && now.saturating_sub(self.since) >= GOOD_CONNECTION {
            self.retry_time = RETRY_TIMES[0];
        }
        self.end_connection();
        self.failure = Some(why);
        // The controls of a shop do not all come back in the same moment.
        let spread = Duration::from_millis((snapshot.params.get(param::MACHINE_NUMBER) % 100.0) as u64 * 10);
        self.retry_at = now + self.retry_time + spread;
        self.retry_time = (2 * self.retry_time).min(RETRY_TIMES[1]);
    }

    fn switch_off(&mut self, time: Duration) {
        self.close(time);
        (self.node, self.failure) = (None, None);
        (self.retry_at, self.retry_time) = (Duration::ZERO, RETRY_TIMES[0]);
        self.view = BrokerView::default();
    }

    /// What is known without the broker: when the certificate of the control ends.
    fn own_tls(&self) -> Option<TlsView> {
        self.machine_until.map(|end| TlsView { valid_until: Some(end) })
    }

    fn end_connection(&mut self) {
        self.phase = Phase::Waiting;
        self.view.tls = self.own_tls();
        self.birth_wanted = false;
        self.outbox.connection_lost();
        self.orders.connection_lost();
        if let Some(node) = &mut self.node {
            node.connection_lost();
        }
    }

    fn show(&mut self, snapshot: &Snapshot) {
        self.view.state = match (&self.phase, &self.failure) {
            (Phase::Connected(_), _) => BrokerState::Connected,
            (_, Some(why)) => BrokerState::Failed(why.clone()),
            (_, None) => BrokerState::Connecting,
        };
        let (stored, lost) = self.node.as_ref().map_or((0, 0), |node| (node.stored_count() as u64, node.lost_count()));
        self.view.waiting = stored + self.outbox.waiting(&snapshot.production.parts);
        self.view.lost = lost + self.outbox.told.skipped();
    }

    /// Begins to connect, on a thread: names and files may take their time.
    fn dial(&mut self, now: Duration) {
        let (tell, dialed) = bounded(1);
        let folder = self.folder.clone();
        let dial = move || drop(tell.send(dial(&folder)));
        match std::thread::Builder::new().name("kt830-mqtt-dial".to_owned()).spawn(dial) {
            Ok(_) => self.phase = Phase::Dialing(dialed),
            Err(error) => {
                self.failure = Some(in_words(error));
                self.retry_at = now + RETRY_TIMES[1];
            }
        }
    }

    /// Begins to speak the protocol once the stream is there.
    fn join(&mut self, now: Duration, time: Duration, snapshot: &Snapshot, dialed: Receiver<DialResult>) {
        let (address, ends) = match dialed.try_recv() {
            Ok(ends) => ends,
            Err(TryRecvError::Empty) => return self.phase = Phase::Dialing(dialed),
            Err(TryRecvError::Disconnected) => (String::new(), Err(super::internal_fault())),
        };
        self.view.address = address;
        let ends = if has_number(snapshot) { ends } else { Err(no_number()) };
        let opened = ends.and_then(|Dialed { settings, stream, tls }| {
            self.machine_until = tls.as_ref().and_then(|ends| ends.machine_until);
            self.view.tls = self.own_tls();
            let known = self.node.take().filter(|node| node.stands_for(&settings.group, snapshot));
            let node = self.node.insert(known.unwrap_or_else(|| EdgeNode::new(&settings.group, snapshot)));
            node.begin_session(self.outbox.told.take_session());
            let will = node.death(time);
            let user = (settings.user.as_str(), settings.password.as_str());
            BrokerLink::open(
                stream,
                tls,
                BrokerLogin { client: node.id(), user, will: (will.topic, will.payload) },
                now,
            )
        });
        match opened {
            Ok(link) => self.phase = Phase::Joining(link),
            Err(why) => self.fail(now, why, snapshot),
        }
    }

    fn wait_for_acceptance(&mut self, now: Duration, snapshot: &Snapshot, mut link: BrokerLink) {
        let events = link.step(now);
        if let Some(why) = link.fault() {
            return self.fail(now, why.clone(), snapshot);
        }
        if !events.contains(&BrokerEvent::Accepted) {
            return self.phase = Phase::Joining(link);
        }
        if let Some(node) = &self.node {
            link.subscribe(&node.command_topic());
        }
        (self.since, self.failure) = (now, None);
        self.view.tls = link
            .tls()
            .map(|tls| TlsView { valid_until: [tls.valid_until, self.machine_until].into_iter().flatten().min() });
        (self.view.refuses_topic, self.view.connections) = (false, self.view.connections + 1);
        self.phase = Phase::Connected(link);
    }

    /// A step of a connection that the broker has taken.
    fn serve(&mut self, now: Duration, time: Duration, snapshot: &Snapshot, mut link: BrokerLink) {
        let Some(node) = &mut self.node else { return };
        for event in link.step(now) {
            match event {
                // An empty one takes back what the broker was to keep: it is none of the control's.
                BrokerEvent::Received { topic, payload, .. }
                    if payload.is_empty() && topic == node.own_topic(ORDER_TOPIC) => {}
                BrokerEvent::Received { topic, payload, is_retained } if topic == node.own_topic(ORDER_TOPIC) => {
                    let answer = self.orders.take(now, (&payload, is_retained), snapshot);
                    if link.has_room() {
                        link.publish(&node.own_topic(ANSWER_TOPIC), answer.into_bytes());
                    }
                }
                BrokerEvent::Received { topic, payload, .. } => {
                    self.birth_wanted |= node.asks_for_birth(&topic, &payload);
                }
                BrokerEvent::Acknowledged(packet) => self.outbox.acknowledged(packet),
                BrokerEvent::TopicRefused => self.view.refuses_topic = true,
                BrokerEvent::PingSent => node.ping_sent(),
                BrokerEvent::PingAnswered => node.ping_answered(),
                BrokerEvent::Accepted => {}
            }
        }
        if self.birth_wanted && now >= self.birth_at {
            (self.birth_wanted, self.birth_at) = (false, now + BIRTH_INTERVAL);
            node.forget_birth();
        }
        let with_samples = now >= self.sample_at;
        if with_samples {
            self.sample_at = now + SAMPLE_INTERVAL;
        }
        for message in node.tell(time, snapshot, with_samples, link.has_room()) {
            link.publish(&message.topic, message.payload);
            self.view.sent += 1;
        }
        while let Some(result) = self.outbox.next(now, node.id(), &snapshot.production.parts) {
            let payload = result.text.clone().into_bytes();
            let Some(packet) = link.publish_acknowledged(&node.own_topic(PART_TOPIC), payload) else { break };
            self.outbox.sent(result, packet);
            self.view.sent += 1;
        }
        if self.orders.begins(snapshot) {
            link.subscribe(&node.own_topic(ORDER_TOPIC));
        }
        if let Some(list) = self.orders.changed_list(snapshot) {
            for (topic, list) in self.outbox.told.lists_to_tell(node.own_topic(LIST_TOPIC), list) {
                link.publish_retained(&topic, list.into_bytes());
            }
        }
        link.send();
        let (is_other, fault) = (!node.is_of(snapshot), link.fault().cloned());
        self.phase = Phase::Connected(link);
        match fault {
            Some(why) => self.fail(now, why, snapshot),
            // The machine has another number: it comes back under its new name.
            None if is_other => self.close(time),
            None => {}
        }
    }
}

/// Two machines of the factory's number would be one for the broker, and the parts of both one list.
fn has_number(snapshot: &Snapshot) -> bool {
    snapshot.params.get(param::MACHINE_NUMBER) >= 1.0
}

fn no_number() -> LocalizedText {
    Text::new("机床编号 P482 为 0：每台机床要有自己的编号", "P482 is 0: each machine needs a number of its own").into()
}

/// Reads the settings anew and connects.
fn dial(folder: &Path) -> DialResult {
    match BrokerSettings::read(folder) {
        Ok(settings) => (settings.broker.clone(), connect(folder, settings)),
        Err(why) => (String::new(), Err(why)),
    }
}

/// Connects to the first address that answers.
fn connect(folder: &Path, settings: BrokerSettings) -> Result<Dialed, LocalizedText> {
    let tls = settings.tls_ends(folder)?;
    let addresses = settings.host_and_port().map(|address| address.to_socket_addrs()).transpose().map_err(in_words)?;
    let mut refused = std::io::ErrorKind::NotFound.into();
    for address in addresses.into_iter().flatten() {
        match TcpStream::connect_timeout(&address, DIAL_TIME) {
            Ok(stream) => return Ok(Dialed { settings, stream, tls }),
            Err(error) => refused = error,
        }
    }
    Err(unreachable_text(&refused))
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
