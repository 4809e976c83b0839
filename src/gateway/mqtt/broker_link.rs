//! One connection to a broker: the bytes on the wire, and the protocol. All calls return at once; what waits to be sent is
//! bounded, and a broker that says nothing is given up.
//! Source: OASIS MQTT 3.1.1.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use mqtt_protocol_core::mqtt::common::Cursor;
use mqtt_protocol_core::mqtt::connection::{ConnectionOptions, Event};
use mqtt_protocol_core::mqtt::packet::v3_1_1::{Connect, Pingreq, Publish, Subscribe};
use mqtt_protocol_core::mqtt::packet::{Packet, Qos, SubEntry, SubOpts};
use mqtt_protocol_core::mqtt::prelude::*;
use mqtt_protocol_core::mqtt::result_code::{ConnectReturnCode, MqttError};
use mqtt_protocol_core::mqtt::{Connection, Version, role};
use rustls::{ClientConnection, StreamOwned};

use super::broker_settings::TlsEnds;
use super::in_words;
use crate::defs::text::{LocalizedText, Text};

/// Time between two pings.
const PING_INTERVAL: Duration = Duration::from_secs(10);
/// How long the broker may take to answer a ping or the connection.
const ANSWER_TIME: Duration = Duration::from_secs(10);
/// The broker gives the control up after one and a half times so long without a sign, s.
const KEEP_ALIVE_S: u16 = 20;
/// What the broker may leave unread, bytes.
const PENDING_LIMIT: usize = 1 << 20;
/// Longest packet that is taken from the broker, bytes.
const RECEIVED_LIMIT: u32 = 64 * 1_024;
/// Bytes looked at in a read, and reads in a step.
const READ_SIZE: usize = 4_096;
const READS: usize = 16;

/// Who connects, and what the broker tells the others when the connection is lost.
pub struct Login<'a> {
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
    },
    /// It has the message with this packet identifier.
    Acknowledged(u16),
    /// It was sent a ping.
    PingSent,
    /// It has answered the ping: it has taken all that was sent before that.
    PingAnswered,
}

/// A connection.
pub struct BrokerLink {
    wire: Wire,
    protocol: Connection<role::Client>,
    /// Bytes to send.
    pending: Vec<u8>,
    /// When it is given up unless the broker has answered.
    answer_by: Option<Duration>,
    /// When the next ping is due; none before the connection is accepted.
    ping_at: Option<Duration>,
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
        login: Login<'_>,
        now: Duration,
    ) -> Result<Self, LocalizedText> {
        stream.set_nonblocking(true).map_err(in_words)?;
        // Without it small messages wait for the answer to the one before; the broker works either way.
        drop(stream.set_nodelay(true));
        let wire = match tls {
            None => Wire::Plain(stream),
            Some(TlsEnds { config, name }) => {
                let session = ClientConnection::new(config, name).map_err(in_words)?;
                Wire::Tls(Box::new(StreamOwned::new(session, stream)))
            }
        };
        let connect = connect_packet(login).map_err(in_words)?;
        let options = ConnectionOptions::new().maximum_packet_size_recv(RECEIVED_LIMIT);
        let mut protocol = Connection::with_options(Version::V3_1_1, options);
        protocol.set_auto_pub_response(true);
        let mut link = Self { wire, protocol, pending: Vec::new(), answer_by: None, ping_at: None, fault: None };
        link.answer_by = Some(now + ANSWER_TIME);
        let events = link.protocol.checked_send(connect);
        link.take_up(events, &mut Vec::new(), now);
        Ok(link)
    }

    /// Receives, pings and sends.
    ///
    /// # Errors
    /// The connection is over; why, in words for the page.
    pub fn step(&mut self, now: Duration) -> Result<Vec<BrokerEvent>, LocalizedText> {
        let mut events = Vec::new();
        self.receive(now, &mut events)?;
        if self.ping_at.is_some_and(|at| now >= at) && self.answer_by.is_none() {
            (self.ping_at, self.answer_by) = (Some(now + PING_INTERVAL), Some(now + ANSWER_TIME));
            let sent = self.protocol.checked_send(Pingreq::new());
            self.take_up(sent, &mut events, now);
            events.push(BrokerEvent::PingSent);
        }
        if self.answer_by.is_some_and(|by| now > by) {
            return Err(Text::new("服务器没有应答", "the broker does not answer").into());
        }
        self.send()?;
        self.fault.take().map_or(Ok(events), Err)
    }

    /// Sends a message that nobody acknowledges.
    ///
    /// # Errors
    /// The topic has no place in the protocol.
    pub fn publish(&mut self, topic: &str, payload: Vec<u8>) -> Result<(), LocalizedText> {
        self.publish_with(topic, payload, None).map_err(in_words)
    }

    /// Sends a message that the broker acknowledges; its packet identifier, none while too many wait.
    ///
    /// # Errors
    /// As [`Self::publish`].
    pub fn publish_acknowledged(&mut self, topic: &str, payload: Vec<u8>) -> Result<Option<u16>, LocalizedText> {
        let packet = self.protocol.acquire_packet_id().ok();
        let sent = packet.map(|packet| self.publish_with(topic, payload, Some(packet)));
        sent.transpose().map(|_| packet).map_err(in_words)
    }

    /// Asks for the messages of a topic.
    ///
    /// # Errors
    /// The topic has no place in the protocol.
    pub fn subscribe(&mut self, topic: &str, now: Duration) -> Result<(), LocalizedText> {
        let subscription = |link: &mut Self| {
            let entry = SubEntry::new(topic, SubOpts::new().set_qos(Qos::AtLeastOnce))?;
            let packet = link.protocol.acquire_packet_id()?;
            Subscribe::builder().packet_id(packet).entries(vec![entry]).build()
        };
        let subscribe = subscription(self).map_err(in_words)?;
        let events = self.protocol.checked_send(subscribe);
        self.take_up(events, &mut Vec::new(), now);
        Ok(())
    }

    fn publish_with(&mut self, topic: &str, payload: Vec<u8>, packet: Option<u16>) -> Result<(), MqttError> {
        let message = Publish::builder().topic_name(topic)?.payload(payload);
        let message = match packet {
            Some(packet) => message.qos(Qos::AtLeastOnce).packet_id(packet),
            None => message.qos(Qos::AtMostOnce),
        };
        let events = self.protocol.checked_send(message.build()?);
        self.take_up(events, &mut Vec::new(), Duration::ZERO);
        Ok(())
    }

    fn receive(&mut self, now: Duration, events: &mut Vec<BrokerEvent>) -> Result<(), LocalizedText> {
        let mut bytes = [0; READ_SIZE];
        for _ in 0..READS {
            let count = match self.wire.read(&mut bytes) {
                Ok(0) => return Err(closed()),
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(io_fault(&error)),
            };
            let mut cursor = Cursor::new(&bytes[..count]);
            while (cursor.position() as usize) < count && self.fault.is_none() {
                let happened = self.protocol.recv(&mut cursor);
                self.take_up(happened, events, now);
            }
        }
        Ok(())
    }

    /// Sends what goes at once.
    ///
    /// # Errors
    /// The connection is over, or the broker does not take what it is sent.
    pub fn send(&mut self) -> Result<(), LocalizedText> {
        while !self.pending.is_empty() {
            match self.wire.write(&self.pending) {
                Ok(0) => return Err(closed()),
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(io_fault(&error)),
            }
        }
        if self.pending.len() > PENDING_LIMIT {
            return Err(Text::new("服务器接收太慢", "the broker is too slow").into());
        }
        Ok(())
    }

    /// What the protocol asks for; the timers are those of this file.
    fn take_up(&mut self, happened: Vec<Event>, events: &mut Vec<BrokerEvent>, now: Duration) {
        let mut closes = false;
        for event in happened {
            match event {
                Event::RequestSendPacket { packet, .. } => {
                    self.pending.extend_from_slice(&packet.to_continuous_buffer());
                }
                Event::NotifyPacketReceived(packet) => self.look_at(packet, events, now),
                Event::NotifyError(error) => {
                    self.fault.get_or_insert_with(|| in_words(format!("MQTT: {error}")));
                }
                Event::RequestClose => closes = true,
                Event::NotifyPacketIdReleased(_) | Event::RequestTimerReset { .. } | Event::RequestTimerCancel(_) => {}
            }
        }
        if closes {
            self.fault.get_or_insert_with(closed);
        }
    }

    fn look_at(&mut self, packet: Packet, events: &mut Vec<BrokerEvent>, now: Duration) {
        match packet {
            Packet::V3_1_1Connack(answer) if answer.return_code() == ConnectReturnCode::Accepted => {
                (self.answer_by, self.ping_at) = (None, Some(now + PING_INTERVAL));
                events.push(BrokerEvent::Accepted);
            }
            Packet::V3_1_1Connack(answer) => self.fault = Some(refusal(answer.return_code())),
            Packet::V3_1_1Publish(message) => events.push(BrokerEvent::Received {
                topic: message.topic_name().to_owned(),
                payload: message.payload().as_slice().to_vec(),
            }),
            Packet::V3_1_1Puback(answer) => events.push(BrokerEvent::Acknowledged(answer.packet_id())),
            Packet::V3_1_1Pingresp(_) => {
                self.answer_by = None;
                events.push(BrokerEvent::PingAnswered);
            }
            _ => {}
        }
    }
}

fn connect_packet(login: Login<'_>) -> Result<Connect, MqttError> {
    let Login { client, user: (user, password), will: (topic, payload) } = login;
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

/// The stream, encrypted or not.
enum Wire {
    Plain(TcpStream),
    Tls(Box<StreamOwned<ClientConnection, TcpStream>>),
}

impl Wire {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.read(bytes),
            Self::Tls(stream) => stream.read(bytes),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.write(bytes),
            Self::Tls(stream) => stream.write(bytes),
        }
    }
}

/// A broker that ends connections soon after it has taken them may have another client of the same name.
fn closed() -> LocalizedText {
    Text::new(
        "服务器断开了连接（同一机床编号 P482 的另一台控制？）",
        "closed by the broker (another control with the same P482?)",
    )
    .into()
}

fn refusal(code: ConnectReturnCode) -> LocalizedText {
    match code {
        ConnectReturnCode::BadUserNameOrPassword | ConnectReturnCode::NotAuthorized => {
            Text::new("服务器拒绝了用户或密码", "the broker refuses user or password").into()
        }
        code => LocalizedText::new(format!("服务器拒绝了连接：{code}"), format!("refused by the broker: {code}")),
    }
}

fn io_fault(error: &std::io::Error) -> LocalizedText {
    let inner = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    match inner {
        Some(rustls::Error::InvalidCertificate(why)) => LocalizedText::new(
            format!("服务器的证书无效：{why}"),
            format!("the certificate of the broker is not accepted: {why}"),
        ),
        Some(other) => in_words(format!("TLS: {other}")),
        None => in_words(error),
    }
}
