//! A broker for tests, stepped like the control: it takes one client at a time, remembers what it is sent, and can be rude.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;

use mqtt_protocol_core::mqtt::common::Cursor;
use mqtt_protocol_core::mqtt::connection::Event;
use mqtt_protocol_core::mqtt::packet::v3_1_1::{Connack, Puback, Publish, Suback};
use mqtt_protocol_core::mqtt::packet::{Packet, Qos};
use mqtt_protocol_core::mqtt::prelude::*;
use mqtt_protocol_core::mqtt::result_code::{ConnectReturnCode, SubackReturnCode};
use mqtt_protocol_core::mqtt::{Connection, Version, role};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};
use srad_types::payload::{Message, Payload};

/// A message that the broker was sent.
#[derive(Clone, Debug)]
pub struct Sent {
    pub topic: String,
    pub payload: Vec<u8>,
}

impl Sent {
    /// As Sparkplug has it.
    pub fn sparkplug(&self) -> Payload {
        Payload::decode(self.payload.as_slice()).unwrap()
    }
}

/// How the broker behaves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Manners {
    /// As it should.
    Good,
    /// It takes no user.
    Refusing,
    /// It says nothing, and reads all.
    Silent,
    /// It neither reads nor says anything once it has taken the connection.
    Deaf,
    /// It acknowledges nothing.
    Forgetful,
    /// It answers with something else than the protocol.
    Garbage,
    /// It answers a ping that it was not sent, and says nothing else.
    EarlyPong,
    /// It takes the connection twice.
    Twice,
    /// It lets nobody listen to a topic.
    Unsubscribed,
}

/// The connection of a client.
struct Client {
    stream: Box<dyn Stream>,
    protocol: Connection<role::Server>,
    pending: Vec<u8>,
    is_taken: bool,
}

trait Stream: Read + Write {}
impl<T: Read + Write> Stream for T {}

/// The broker.
pub struct TestBroker {
    listener: TcpListener,
    tls: Option<Arc<ServerConfig>>,
    client: Option<Client>,
    pub manners: Manners,
    pub sent: Vec<Sent>,
    /// The will of each client that connected.
    pub wills: Vec<Sent>,
    /// User and password of the last client.
    pub user: Option<(String, String)>,
    /// Streams that were taken.
    pub taken: usize,
    /// Whether the last client has subscribed to something.
    pub has_subscription: bool,
}

impl TestBroker {
    pub fn new() -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        Self {
            listener,
            tls: None,
            client: None,
            manners: Manners::Good,
            sent: Vec::new(),
            wills: Vec::new(),
            user: None,
            taken: 0,
            has_subscription: false,
        }
    }

    /// With the certificate of the tests.
    pub fn encrypted(certificates: &Path) -> Self {
        let chain = CertificateDer::pem_file_iter(certificates.join("broker.pem")).unwrap().map(Result::unwrap);
        let key = PrivateKeyDer::from_pem_file(certificates.join("broker.key")).unwrap();
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .unwrap()
            .with_no_client_auth()
            .with_single_cert(chain.collect(), key)
            .unwrap();
        Self { tls: Some(Arc::new(config)), ..Self::new() }
    }

    pub fn port(&self) -> u16 {
        self.listener.local_addr().unwrap().port()
    }

    pub fn has_client(&self) -> bool {
        self.client.is_some()
    }

    /// Cuts the connection, as a broker that is restarted.
    pub fn drop_client(&mut self) {
        (self.client, self.has_subscription) = (None, false);
    }

    /// Sends the client a message.
    pub fn publish(&mut self, topic: &str, payload: Vec<u8>) {
        let client = self.client.as_mut().unwrap();
        let message = Publish::builder().topic_name(topic).unwrap().payload(payload).qos(Qos::AtMostOnce);
        let events = client.protocol.checked_send(message.build().unwrap());
        client.send_all(events);
    }

    /// Takes a client, receives, answers.
    pub fn step(&mut self) {
        self.serve_client();
        // The last words of a client are heard before the next one takes its place.
        if let Ok((stream, _)) = self.listener.accept() {
            self.serve_client();
            self.taken += 1;
            self.take(stream);
        }
    }

    fn serve_client(&mut self) {
        let Some(mut client) = self.client.take() else { return };
        let keeps = self.manners == Manners::Deaf && client.is_taken || self.serve(&mut client);
        // As brokers do: the refusal and the end come together.
        if keeps && !(self.manners == Manners::Refusing && client.is_taken) {
            self.client = Some(client);
        }
    }

    fn take(&mut self, stream: TcpStream) {
        stream.set_nonblocking(true).unwrap();
        // The time of these tests is not that of the network: nothing waits for an acknowledgement.
        stream.set_nodelay(true).unwrap();
        let stream: Box<dyn Stream> = match &self.tls {
            None => Box::new(stream),
            Some(tls) => Box::new(StreamOwned::new(ServerConnection::new(Arc::clone(tls)).unwrap(), stream)),
        };
        let protocol = Connection::new(Version::V3_1_1);
        self.client = Some(Client { stream, protocol, pending: Vec::new(), is_taken: false });
        self.has_subscription = false;
    }

    /// False when the client is gone.
    fn serve(&mut self, client: &mut Client) -> bool {
        let mut bytes = [0; 4_096];
        loop {
            match client.stream.read(&mut bytes) {
                Ok(0) => return false,
                Ok(count) => {
                    let mut cursor = Cursor::new(&bytes[..count]);
                    while (cursor.position() as usize) < count {
                        for event in client.protocol.recv(&mut cursor) {
                            if let Event::NotifyPacketReceived(packet) = event {
                                self.answer(client, packet);
                            }
                        }
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => return false,
            }
        }
        while !client.pending.is_empty() {
            match client.stream.write(&client.pending) {
                Ok(count) => drop(client.pending.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => return false,
            }
        }
        true
    }

    fn answer(&mut self, client: &mut Client, packet: Packet) {
        if self.manners == Manners::Silent {
            return;
        }
        match packet {
            Packet::V3_1_1Connect(connect) => {
                let topic = connect.will_topic().unwrap().to_owned();
                self.wills.push(Sent { topic, payload: connect.will_payload().unwrap().to_vec() });
                let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
                self.user = connect.user_name().map(|user| (user.to_owned(), text(connect.password().unwrap())));
                let odd = match self.manners {
                    Manners::Garbage => b"HTTP/1.1 400 Bad Request\r\n".repeat(20),
                    Manners::EarlyPong => vec![0xd0, 0],
                    // CONNACK, accepted.
                    Manners::Twice => [0x20, 2, 0, 0].repeat(2),
                    _ => Vec::new(),
                };
                client.pending.extend_from_slice(&odd);
                if !odd.is_empty() {
                    return;
                }
                let code = match self.manners {
                    Manners::Refusing => ConnectReturnCode::NotAuthorized,
                    _ => ConnectReturnCode::Accepted,
                };
                let answer = Connack::builder().session_present(false).return_code(code).build().unwrap();
                client.is_taken = true;
                let events = client.protocol.checked_send(answer);
                client.send_all(events);
            }
            Packet::V3_1_1Subscribe(subscribe) => {
                self.has_subscription = true;
                let codes = vec![match self.manners {
                    Manners::Unsubscribed => SubackReturnCode::Failure,
                    _ => SubackReturnCode::SuccessMaximumQos1,
                }];
                let answer = Suback::builder().packet_id(subscribe.packet_id()).return_codes(codes).build().unwrap();
                let events = client.protocol.checked_send(answer);
                client.send_all(events);
            }
            Packet::V3_1_1Publish(message) => {
                let payload = message.payload().as_slice().to_vec();
                self.sent.push(Sent { topic: message.topic_name().to_owned(), payload });
                if let Some(packet) = message.packet_id().filter(|_| self.manners != Manners::Forgetful) {
                    let answer = Puback::builder().packet_id(packet).build().unwrap();
                    let events = client.protocol.checked_send(answer);
                    client.send_all(events);
                }
            }
            Packet::V3_1_1Pingreq(_) => {
                use mqtt_protocol_core::mqtt::packet::v3_1_1::Pingresp;
                if self.manners != Manners::Forgetful {
                    let events = client.protocol.checked_send(Pingresp::new());
                    client.send_all(events);
                }
            }
            _ => {}
        }
    }
}

impl Client {
    fn send_all(&mut self, events: Vec<Event>) {
        for event in events {
            if let Event::RequestSendPacket { packet, .. } = event {
                self.pending.extend_from_slice(&packet.to_continuous_buffer());
            }
        }
    }
}
