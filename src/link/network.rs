//! What the page of the network shows: the services that the control offers, and who uses them.
//! Source: docs/manual, chapter "network".

use crate::defs::date::DateTime;
use crate::defs::text::LocalizedText;

/// State of a service.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ServiceState {
    /// Its port is 0: nothing listens.
    #[default]
    Off,
    /// It listens.
    Listening,
    /// It cannot listen.
    Failed(LocalizedText),
}

/// An encrypted connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TlsView {
    /// When the certificate ends that ends first, UTC (a day more or less does not matter here); none if nobody can say.
    pub valid_until: Option<DateTime>,
}

/// A service.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ServiceView {
    /// Its state.
    pub state: ServiceState,
    /// Address and port; empty while it is off.
    pub address: String,
    /// Addresses of those who are connected.
    pub clients: Vec<String>,
    /// Lines or answers sent since the port was opened.
    pub sent: u64,
    /// Connections refused: too many at once.
    pub refused: u64,
    /// Connections given up: too slow, silent or not of the protocol.
    pub dropped: u64,
    /// How its connections are encrypted; none if they are not.
    pub tls: Option<TlsView>,
}

/// State of the connection to a broker.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum BrokerState {
    /// Switched off.
    #[default]
    Off,
    /// It has not answered yet.
    Connecting,
    /// It listens.
    Connected,
    /// The last try has failed, or the connection is lost; it is tried again.
    Failed(LocalizedText),
}

/// The broker that the control tells.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BrokerView {
    /// State of the connection.
    pub state: BrokerState,
    /// Its name and port; empty while it is off.
    pub address: String,
    /// How the connection is encrypted, with a broker that has to prove itself; none if it is not.
    pub tls: Option<TlsView>,
    /// The broker does not let the control listen to a topic: no orders, or no births that are asked for.
    pub refuses_topic: bool,
    /// Messages sent since it was switched on.
    pub sent: u64,
    /// Changes that are not sent yet, and results that the broker has not acknowledged.
    pub waiting: u64,
    /// Changes that were dropped for newer ones while the broker was away, and results that the control had forgotten by then.
    pub lost: u64,
    /// Connections that the broker has taken since it was switched on.
    pub connections: u64,
}

/// The OPC UA server, a process of its own that has reported itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpcUaView {
    /// Where clients reach it; empty without a server.
    pub address: String,
    /// Clients that are connected.
    pub clients: u32,
    /// Certificates that were refused and that nobody has trusted.
    pub untrusted: u32,
    /// When its certificate ends, UTC; none if nobody can say.
    pub certificate_until: Option<DateTime>,
}

/// The network.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NetworkView {
    /// The adapter of MTConnect.
    pub mtconnect: ServiceView,
    /// The view for a browser.
    pub web: ServiceView,
    /// The broker.
    pub mqtt: BrokerView,
    /// The OPC UA server.
    pub opcua: OpcUaView,
}
