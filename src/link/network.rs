//! What the page of the network shows: the services that the control offers, and who uses them.
//! Source: docs/manual, chapter "network".

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
}

/// The network.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NetworkView {
    /// The adapter of MTConnect.
    pub mtconnect: ServiceView,
    /// The view for a browser.
    pub web: ServiceView,
}
