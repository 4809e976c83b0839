//! A TCP port and the connections to it. All calls return at once; connections and their memory are bounded, so that a
//! flood, a client that does not read and one that never ends its request cost no more than that.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

use rustls::ServerConfig;

use super::wire::Wire;

/// Most connections taken or refused in a step: a flood does not hold the others up.
const MAX_ACCEPTS: usize = 64;

/// How long a client may take to close a connection whose answer it has.
const CLOSING_TIME: Duration = Duration::from_secs(1);

/// What a port takes.
#[derive(Clone, Copy, Debug)]
pub struct PortLimits {
    /// Connections at once.
    pub connections: usize,
    /// What a client may leave unread, bytes.
    pub pending: usize,
    /// What a client may send without a whole request, bytes.
    pub received: usize,
    /// How long a new connection lasts until the protocol says more of it.
    pub patience: Duration,
}

/// What became of the connections to a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortCounts {
    /// Lines or answers sent.
    pub sent: u64,
    /// Connections refused: too many at once.
    pub refused: u64,
    /// Connections given up: too slow, silent, or against the protocol.
    pub dropped: u64,
}

/// How far a connection has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConnectionState {
    /// It has said nothing of the protocol yet: it makes room for another one.
    Idle,
    /// It has spoken the protocol and keeps its place.
    Proven,
    /// It ends once everything is sent; nothing that comes is looked at any more.
    Closing,
    /// The other side has been told that nothing follows.
    Shut,
}

/// A connection.
pub struct Connection {
    wire: Wire,
    /// Who it is.
    pub address: SocketAddr,
    /// Bytes to send.
    pub pending: Vec<u8>,
    /// Bytes received and not used yet.
    pub received: Vec<u8>,
    /// It is given up then, unless the protocol sets another time.
    pub deadline: Duration,
    /// How far it has come.
    pub state: ConnectionState,
}

/// A port.
pub struct PortServer {
    listener: TcpListener,
    /// Connections are in TLS with it.
    tls: Option<Arc<ServerConfig>>,
    connections: Vec<Connection>,
    limits: PortLimits,
    counts: PortCounts,
}

impl PortServer {
    /// Listens at a port, on this computer alone or on all its networks.
    ///
    /// # Errors
    /// The port is in use or not allowed.
    pub fn open(port: u16, reaches_network: bool, limits: PortLimits) -> std::io::Result<Self> {
        let host = if reaches_network { Ipv4Addr::UNSPECIFIED } else { Ipv4Addr::LOCALHOST };
        let listener = TcpListener::bind((host, port))?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, tls: None, connections: Vec::new(), limits, counts: PortCounts::default() })
    }

    /// The same, with every connection in TLS.
    #[must_use]
    pub fn with_tls(self, config: Arc<ServerConfig>) -> Self {
        Self { tls: Some(config), ..self }
    }

    /// Takes new connections, each with what it is told first; then each of them receives, `answer` looks at what has come,
    /// and sends.
    pub fn step(&mut self, now: Duration, welcome: impl Fn() -> Vec<u8>, mut answer: impl FnMut(&mut Connection)) {
        for _ in 0..MAX_ACCEPTS {
            let Ok((stream, address)) = self.listener.accept() else { break };
            if stream.set_nonblocking(true).is_err() || !self.makes_room() {
                self.counts.refused += 1;
                continue;
            }
            // Without it small lines wait for the answer to the one before; a client works either way.
            drop(stream.set_nodelay(true));
            let Ok(wire) = Wire::from_client(stream, self.tls.as_ref()) else { continue };
            self.connections.push(Connection {
                wire,
                address,
                pending: welcome(),
                received: Vec::new(),
                deadline: now + self.limits.patience,
                state: ConnectionState::Idle,
            });
        }
        let (limits, counts) = (self.limits, &mut self.counts);
        self.connections.retain_mut(|connection| {
            let hears = connection.receive();
            if hears && !connection.is_ending() {
                answer(connection);
            }
            let sends = connection.send() && connection.shut(now);
            if !sends || !hears && connection.pending.is_empty() && connection.wire.is_flushed() {
                return false;
            }
            let fits = connection.pending.len() <= limits.pending && connection.received.len() <= limits.received;
            let keeps = fits && now <= connection.deadline;
            counts.dropped += u64::from(!keeps && connection.state != ConnectionState::Shut);
            keeps
        });
    }

    /// The connections.
    pub fn connections(&mut self) -> &mut [Connection] {
        &mut self.connections
    }

    /// Who is connected.
    pub fn clients(&self) -> impl Iterator<Item = SocketAddr> {
        self.connections.iter().map(|connection| connection.address)
    }

    /// Where it listens.
    ///
    /// # Errors
    /// The system does not say.
    pub fn address(&self) -> std::io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// What became of the connections.
    pub const fn counts(&self) -> PortCounts {
        self.counts
    }

    /// The protocol has sent so many lines or answers.
    pub const fn count_sent(&mut self, count: u64) {
        self.counts.sent += count;
    }

    /// Whether there is a place for another connection; a full port gives up the oldest that has said nothing of the
    /// protocol, so that idle ones do not keep the others out.
    fn makes_room(&mut self) -> bool {
        if self.connections.len() < self.limits.connections {
            return true;
        }
        let idle = self.connections.iter().position(|connection| connection.state == ConnectionState::Idle);
        if let Some(oldest) = idle {
            self.connections.remove(oldest);
            self.counts.dropped += 1;
        }
        idle.is_some()
    }
}

impl Connection {
    /// Takes what has come; false if the other side sends no more.
    fn receive(&mut self) -> bool {
        let mut bytes = [0; 1_024];
        match self.wire.read(&mut bytes) {
            Ok(0) => return false,
            Ok(_) if self.is_ending() => self.received.clear(),
            Ok(count) => self.received.extend_from_slice(&bytes[..count]),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(_) => return false,
        }
        true
    }

    /// Sends what goes at once; false if the connection is over.
    fn send(&mut self) -> bool {
        while !self.pending.is_empty() {
            match self.wire.write(&self.pending) {
                Ok(0) => return false,
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        true
    }

    /// Tells the other side that nothing follows, once everything is sent; false if the connection is over. It is kept for
    /// a while: what was sent is lost if a connection ends while something that has come is not read.
    fn shut(&mut self, now: Duration) -> bool {
        if self.state != ConnectionState::Closing || !self.pending.is_empty() {
            return true;
        }
        match self.wire.finish() {
            Ok(true) => (self.state, self.deadline) = (ConnectionState::Shut, now + CLOSING_TIME),
            // What was taken is still on its way.
            Ok(false) => {}
            Err(_) => return false,
        }
        true
    }

    /// What comes is not looked at any more.
    const fn is_ending(&self) -> bool {
        matches!(self.state, ConnectionState::Closing | ConnectionState::Shut)
    }
}
