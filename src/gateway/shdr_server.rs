//! The port to which agents of MTConnect connect. It sends, and understands `* PING`. Programs of the same computer, such
//! as the OPC UA server, may ask for the list of orders (`* ORDERS`), propose one (`* ORDER {…}`), which the operator
//! accepts, and say how the OPC UA server does (`* OPCUA {…}`), for the page. Nothing else that is received reaches the
//! control.
//! Source: MTConnect Agent (cppagent), "Adapter Agent Protocol".

use std::cell::Cell;
use std::net::SocketAddr;
use std::sync::PoisonError;
use std::time::Duration;

use super::opcua_report::OpcUaReport;
use super::order_inbox::{self, LONGEST_ORDER, SharedInbox};
use super::port_server::{Connection, ConnectionState, PortLimits, PortServer};
use super::shdr::ShdrLines;
use super::timestamp;
use crate::link::network::OpcUaView;
use crate::link::snapshot::Snapshot;

/// Most agents, what each may leave unread, its longest line, and how long it may take to its first ping.
const LIMITS: PortLimits =
    PortLimits { connections: 8, pending: 256 * 1_024, received: 2 * LONGEST_ORDER, patience: Duration::from_secs(60) };
/// Time between two looks at measured values: what trembles in its last digit does not fill the memory of an agent.
const SAMPLE_INTERVAL: Duration = Duration::from_millis(100);
/// An agent is to ping so often, ms.
const HEARTBEAT_MS: u64 = 10_000;
/// One that has pinged and does not for so long is gone.
const LONGEST_SILENCE: Duration = Duration::from_millis(3 * HEARTBEAT_MS);

/// The port and the agents connected to it.
pub struct ShdrServer {
    /// The port.
    pub port: PortServer,
    lines: ShdrLines,
    inbox: SharedInbox,
    /// The OPC UA server, and its connection.
    opcua: Option<(SocketAddr, OpcUaView)>,
    /// When measured values are looked at again.
    sample_at: Duration,
}

impl ShdrServer {
    /// Listens at a port, on this computer alone or on all its networks; orders go to a control.
    ///
    /// # Errors
    /// The port is in use or not allowed.
    pub fn open(port: u16, reaches_network: bool, inbox: SharedInbox) -> std::io::Result<Self> {
        let port = PortServer::open(port, reaches_network, LIMITS)?;
        Ok(Self { port, lines: ShdrLines::default(), inbox, opcua: None, sample_at: Duration::ZERO })
    }

    /// Tells what has changed, takes new agents, answers pings. `time` is the time of day.
    pub fn step(&mut self, now: Duration, time: Duration, snapshot: &Snapshot) {
        let time = timestamp(time);
        let with_samples = now >= self.sample_at;
        if with_samples {
            self.sample_at = now + SAMPLE_INTERVAL;
        }
        let changes = self.lines.changes(&time, snapshot, with_samples);
        let connections = self.port.connections();
        connections.iter_mut().for_each(|agent| agent.pending.extend_from_slice(changes.as_bytes()));
        let told = Cell::new(changes.lines().count() * connections.len());
        let welcome = || {
            let everything = self.lines.everything(&time);
            told.set(told.get() + everything.lines().count());
            everything.into_bytes()
        };
        let (inbox, opcua) = (&self.inbox, &mut self.opcua);
        self.port.step(now, welcome, |agent| answer(agent, now, (inbox, opcua), snapshot));
        self.port.count_sent(told.get() as u64);
    }

    /// What the OPC UA server has said of itself, while it is connected.
    #[must_use]
    pub fn opcua(&self) -> Option<&OpcUaView> {
        let (server, view) = self.opcua.as_ref()?;
        self.port.clients().any(|client| client == *server).then_some(view)
    }
}

/// Answers the pings of an agent, and who speaks of orders; one that has pinged is to go on. One that begins with something
/// else is none: a page in a browser of this computer could send lines, too.
fn answer(
    agent: &mut Connection,
    now: Duration,
    (inbox, opcua): (&SharedInbox, &mut Option<(SocketAddr, OpcUaView)>),
    snapshot: &Snapshot,
) {
    let mut is_listed = false;
    while let Some(end) = agent.received.iter().position(|byte| *byte == b'\n') {
        let line: Vec<u8> = agent.received.drain(..=end).collect();
        let line = line.trim_ascii();
        if line == b"* PING" {
            agent.pending.extend_from_slice(format!("* PONG {HEARTBEAT_MS}\n").as_bytes());
            (agent.deadline, agent.state) = (now + LONGEST_SILENCE, ConnectionState::Proven);
        } else if agent.state != ConnectionState::Proven {
            if !line.starts_with(b"* ") {
                return agent.state = ConnectionState::Closing;
            }
        } else if line == b"* ORDERS" && is_of_this_computer(agent) {
            // One list a step, however often it is asked for.
            if !std::mem::replace(&mut is_listed, true) {
                agent.pending.extend_from_slice(format!("* orders: {}\n", order_inbox::list(snapshot)).as_bytes());
            }
        } else if let Some(order) = line.strip_prefix(b"* ORDER ") {
            let answer = match is_of_this_computer(agent) {
                true => inbox.lock().unwrap_or_else(PoisonError::into_inner).take(now, order, snapshot),
                false => order_inbox::answer(None, Err("orders come from programs of the same computer".to_owned())),
            };
            agent.pending.extend_from_slice(format!("* order: {answer}\n").as_bytes());
        } else if let Some(view) = OpcUaReport::view(line).filter(|_| is_of_this_computer(agent)) {
            *opcua = Some((agent.address, view));
        }
    }
}

fn is_of_this_computer(agent: &Connection) -> bool {
    agent.address.ip().is_loopback()
}
