//! One connection to a broker: the bytes on the wire, and the protocol. All calls return at once; what waits to be sent is
//! bounded, and a broker that says nothing is given up.
//! Source: OASIS MQTT 3.1.1.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Duration;

use mqtt_protocol_core::mqtt::common::Cursor;
use mqtt_protocol_core::mqtt::connection::{ConnectionOptions, Event, Sendable};
use mqtt_protocol_core::mqtt::packet::v3_1_1::{Connect, Disconnect, Pingreq, Publish, Subscribe};
use mqtt_protocol_core::mqtt::packet::{Packet, Qos, SubEntry, SubOpts};
use mqtt_protocol_core::mqtt::prelude::*;
use mqtt_protocol_core::mqtt::result_code::{ConnectReturnCode, MqttError, SubackReturnCode};
use mqtt_protocol_core::mqtt::{Connection, Version, role};
use rustls::ClientConnection;

use super::broker_settings::TlsEnds;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::gateway::in_words;
use crate::gateway::wire::Wire;
use crate::link::network::TlsView;

/// Time between two pings.
const PING_INTERVAL: Duration = Duration::from_secs(10);
/// How long the broker may take to answer a ping or the connection.
const ANSWER_TIME: Duration = Duration::from_secs(10);
/// The broker gives the control up after one and a half times so long without a sign, s.
const KEEP_ALIVE_S: u16 = 20;
/// What the broker may leave unread, and up to what history follows, bytes.
const PENDING_LIMIT: usize = 1 << 20;
const ROOM: usize = 64 * 1_024;
/// Longest packet that is taken from the broker, bytes.
const RECEIVED_LIMIT: u32 = 64 * 1_024;
/// Bytes looked at in a read, and reads in a step.
const READ_SIZE: usize = 4_096;
const READS: usize = 16;

/// Who connects, and what the broker tells the others when the connection is lost.
pub struct BrokerLogin<'a> {
    /// Name of the client, unique at the broker.
    pub client: &'a str,
    /// User and password; an empty user for none.
    pub user: (&'a str, &'a str),
    /// Topic and payload of the will.
    pub will: (String, Vec<u8>),
}

/// What a broker has done.
#[derive(Debug, PartialEq, Eq)]
pub enum BrokerEvent {
    /// It has taken the connection.
    Accepted,
    /// It has sent a message of a topic that was subscribed.
    Received {
        /// The topic.
        topic: String,
        /// The message.
        payload: Vec<u8>,
        /// It was kept by the broker: it may be old, and come again with each connection.
        is_retained: bool,
    },
    /// It has the message with this packet identifier.
    Acknowledged(u16),
    /// It does not let the control listen to a topic.
    TopicRefused,
    /// It was sent a ping.
    PingSent,
    /// It has answered the ping: it has taken all that was sent before that.
    PingAnswered,
}

/// What the broker is to say next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaited {
    /// That it takes the connection, until then.
    Acceptance(Duration),
    /// The answer to a ping, until then.
    Pong(Duration),
    /// Nothing: the next ping is due then.
    Nothing(Duration),
}

/// A connection.
pub struct BrokerLink {
    wire: Wire,
    protocol: Connection<role::Client>,
    /// Bytes to send.
    pending: Vec<u8>,
    awaited: Awaited,
    /// Why it is over.
    fault: Option<LocalizedText>,
}

impl BrokerLink {
    /// Begins to speak the protocol on a stream that is connected.
    ///
    /// # Errors
    /// The system refuses the stream, or a name has no place in the protocol.
    pub fn open(
        stream: TcpStream,
        tls: Option<TlsEnds>,
        login: BrokerLogin<'_>,
        now: Duration,
    ) -> Result<Self, LocalizedText> {
        stream.set_nonblocking(true).map_err(in_words)?;
        // Without it small messages wait for the answer to the one before; the broker works either way.
        drop(stream.set_nodelay(true));
        let wire = match tls {
            None => Wire::Plain(stream),
            Some(TlsEnds { config, name, .. }) => {
                let session = ClientConnection::new(config, name).map_err(in_words)?;
                Wire::Tls(Box::new(session.into()), stream)
            }
        };
        let connect = connect_packet(login).map_err(in_words)?;
        let options = ConnectionOptions::new().maximum_packet_size_recv(RECEIVED_LIMIT);
        let mut protocol = Connection::with_options(Version::V3_1_1, options);
        protocol.set_auto_pub_response(true);
        let awaited = Awaited::Acceptance(now + ANSWER_TIME);
        let mut link = Self { wire, protocol, pending: Vec::new(), awaited, fault: None };
        let events = link.protocol.checked_send(connect);
        link.take_up(events);
        Ok(link)
    }

    /// Receives, pings and sends. What has come counts, even if the connection is over.
    pub fn step(&mut self, now: Duration) -> Vec<BrokerEvent> {
        let mut events = Vec::new();
        self.receive(now, &mut events);
        match self.awaited {
            Awaited::Acceptance(until) | Awaited::Pong(until) if now > until => {
                self.end(Text::new("服务器没有应答", "the broker does not answer").into());
            }
            Awaited::Nothing(ping_at) if now >= ping_at => {
                self.awaited = Awaited::Pong(now + ANSWER_TIME);
                let sent = self.protocol.checked_send(Pingreq::new());
                self.take_up(sent);
                events.push(BrokerEvent::PingSent);
            }
            Awaited::Acceptance(_) | Awaited::Pong(_) | Awaited::Nothing(_) => {}
        }
        self.send();
        events
    }

    /// How the connection is encrypted.
    #[must_use]
    pub fn tls(&self) -> Option<TlsView> {
        self.wire.tls()
    }

    /// Why the connection is over; none while it lasts.
    #[must_use]
    pub const fn fault(&self) -> Option<&LocalizedText> {
        self.fault.as_ref()
    }

    /// Whether the broker takes what it is sent: more may follow.
    #[must_use]
    pub const fn has_room(&self) -> bool {
        self.pending.len() <= ROOM
    }

    /// Sends a message that nobody acknowledges.
    pub fn publish(&mut self, topic: &str, payload: Vec<u8>) {
        self.publish_once(topic, payload, false);
    }

    /// As [`Self::publish`]; the broker keeps it for whoever comes later.
    pub fn publish_retained(&mut self, topic: &str, payload: Vec<u8>) {
        self.publish_once(topic, payload, true);
    }

    fn publish_once(&mut self, topic: &str, payload: Vec<u8>, retain: bool) {
        let built = Publish::builder().topic_name(topic);
        let built = built.map(|message| message.payload(payload).qos(Qos::AtMostOnce).retain(retain));
        self.send_packet(built.and_then(|message| message.build()));
    }

    /// Sends a message that the broker acknowledges; its packet identifier, none while too many wait.
    pub fn publish_acknowledged(&mut self, topic: &str, payload: Vec<u8>) -> Option<u16> {
        let packet = self.protocol.acquire_packet_id().ok()?;
        let built = Publish::builder().topic_name(topic).map(|message| message.payload(payload).qos(Qos::AtLeastOnce));
        self.send_packet(built.and_then(|message| message.packet_id(packet).build()));
        Some(packet)
    }

    /// Asks for the messages of a topic.
    pub fn subscribe(&mut self, topic: &str) {
        let entry = SubEntry::new(topic, SubOpts::new().set_qos(Qos::AtLeastOnce));
        let built = entry.and_then(|entry| {
            let packet = self.protocol.acquire_packet_id()?;
            Subscribe::builder().packet_id(packet).entries(vec![entry]).build()
        });
        self.send_packet(built);
    }

    /// Takes leave: the broker does not tell the will.
    pub fn disconnect(&mut self) {
        if self.fault.is_some() {
            return;
        }
        self.send_packet(Disconnect::builder().build());
        // The protocol calls it closed before the last words are sent.
        self.fault = None;
        self.send();
    }

    /// Sends what goes at once.
    pub fn send(&mut self) {
        while !self.pending.is_empty() && self.fault.is_none() {
            match self.wire.write(&self.pending) {
                Ok(0) => self.end_closed(),
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => self.end_by(&error),
            }
        }
        if self.pending.len() > PENDING_LIMIT {
            self.end(Text::new("服务器接收太慢", "the broker is too slow").into());
        }
    }

    fn send_packet<T: Sendable<role::Client, u16>>(&mut self, packet: Result<T, MqttError>) {
        match packet {
            Ok(packet) => {
                let events = self.protocol.checked_send(packet);
                self.take_up(events);
            }
            Err(error) => self.end(in_words(format!("MQTT: {error}"))),
        }
    }

    fn receive(&mut self, now: Duration, events: &mut Vec<BrokerEvent>) {
        let mut bytes = [0; READ_SIZE];
        for _ in 0..READS {
            if self.fault.is_some() {
                return;
            }
            match self.wire.read(&mut bytes) {
                Ok(0) => self.end_closed(),
                Ok(count) => self.take_in(&bytes[..count], now, events),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => self.end_by(&error),
            }
        }
    }

    fn take_in(&mut self, bytes: &[u8], now: Duration, events: &mut Vec<BrokerEvent>) {
        let mut cursor = Cursor::new(bytes);
        while (cursor.position() as usize) < bytes.len() && self.fault.is_none() {
            let happened = self.protocol.recv(&mut cursor);
            for packet in self.take_up(happened) {
                self.look_at(packet, now, events);
            }
        }
    }

    /// What the protocol asks for; the packets that have come. The timers are those of this file.
    fn take_up(&mut self, happened: Vec<Event>) -> Vec<Packet> {
        let (mut received, mut closes) = (Vec::new(), false);
        for event in happened {
            match event {
                Event::RequestSendPacket { packet, .. } => {
                    self.pending.extend_from_slice(&packet.to_continuous_buffer());
                }
                Event::NotifyPacketReceived(packet) => received.push(packet),
                Event::NotifyError(error) => self.end(in_words(format!("MQTT: {error}"))),
                Event::RequestClose => closes = true,
                Event::NotifyPacketIdReleased(_) | Event::RequestTimerReset { .. } | Event::RequestTimerCancel(_) => {}
            }
        }
        // A refusal comes with the wish to close: its reason is the better one.
        if closes && received.is_empty() {
            self.end_closed();
        }
        received
    }

    fn look_at(&mut self, packet: Packet, now: Duration, events: &mut Vec<BrokerEvent>) {
        match (packet, self.awaited) {
            (Packet::V3_1_1Connack(answer), Awaited::Acceptance(_)) => match answer.return_code() {
                ConnectReturnCode::Accepted => {
                    self.awaited = Awaited::Nothing(now + PING_INTERVAL);
                    events.push(BrokerEvent::Accepted);
                }
                code => self.end(refusal(code)),
            },
            (Packet::V3_1_1Connack(_), _) | (_, Awaited::Acceptance(_)) => {
                self.end(Text::new("服务器违反 MQTT 协议", "the broker breaks the protocol of MQTT").into());
            }
            (Packet::V3_1_1Pingresp(_), Awaited::Pong(_)) => {
                self.awaited = Awaited::Nothing(now + PING_INTERVAL);
                events.push(BrokerEvent::PingAnswered);
            }
            (Packet::V3_1_1Publish(message), _) => events.push(BrokerEvent::Received {
                topic: message.topic_name().to_owned(),
                payload: message.payload().as_slice().to_vec(),
                is_retained: message.retain(),
            }),
            (Packet::V3_1_1Suback(answer), _) if !answer.return_codes().iter().all(SubackReturnCode::is_success) => {
                events.push(BrokerEvent::TopicRefused);
            }
            (Packet::V3_1_1Puback(answer), _) => events.push(BrokerEvent::Acknowledged(answer.packet_id())),
            _ => {}
        }
    }

    /// The connection is over; the first reason counts.
    fn end(&mut self, why: LocalizedText) {
        self.fault.get_or_insert(why);
    }

    fn end_by(&mut self, error: &std::io::Error) {
        match io_fault(error) {
            Some(why) => self.end(why),
            None => self.end_closed(),
        }
    }

    /// A broker that ends a connection which it had taken may have another client of the same name.
    fn end_closed(&mut self) {
        let text = match self.awaited {
            Awaited::Acceptance(_) => Text::new("服务器断开了连接", "closed by the broker"),
            Awaited::Pong(_) | Awaited::Nothing(_) => Text::new(
                "服务器断开了连接（同一机床编号 P482 的另一台控制？）",
                "closed by the broker (another control with the same P482?)",
            ),
        };
        self.end(text.into());
    }
}

fn connect_packet(login: BrokerLogin<'_>) -> Result<Connect, MqttError> {
    let BrokerLogin { client, user: (user, password), will: (topic, payload) } = login;
    let mut connect = Connect::builder().client_id(client)?.clean_session(true).keep_alive(KEEP_ALIVE_S).will_message(
        topic,
        payload,
        Qos::AtLeastOnce,
        false,
    )?;
    if !user.is_empty() {
        connect = connect.user_name(user)?.password(password)?;
    }
    connect.build()
}

fn refusal(code: ConnectReturnCode) -> LocalizedText {
    match code {
        ConnectReturnCode::BadUserNameOrPassword | ConnectReturnCode::NotAuthorized => {
            Text::new("服务器拒绝了用户或密码", "the broker refuses user or password").into()
        }
        code => phrase!("服务器拒绝了连接：{code}", "refused by the broker: {code}", code = code.to_string()),
    }
}

/// What the system or TLS says; none where it says no more than that the connection is over.
fn io_fault(error: &std::io::Error) -> Option<LocalizedText> {
    use rustls::CertificateError::{Expired, ExpiredContext, NotValidYet, NotValidYetContext};
    let is_end = matches!(
        error.kind(),
        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::ConnectionAborted | ErrorKind::BrokenPipe
    );
    if is_end {
        return None;
    }
    let of_tls = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    Some(match of_tls {
        Some(rustls::Error::InvalidCertificate(
            Expired | ExpiredContext { .. } | NotValidYet | NotValidYetContext { .. },
        )) => Text::new(
            "服务器的证书现在无效：检查本机时钟和证书期限",
            "the certificate of the broker is not valid now: check this clock and its dates",
        )
        .into(),
        Some(rustls::Error::InvalidCertificate(why)) => phrase!(
            "服务器的证书无效：{why}",
            "the certificate of the broker is not accepted: {why}",
            why = why.to_string()
        ),
        Some(other) => in_words(format!("TLS: {other}")),
        None => in_words(error),
    })
}
