//! What the host and the screen put into a snapshot beside what the core knows.

use std::sync::Arc;

use super::demo_view::DemoView;
use super::network::NetworkView;

/// Network services and demonstration: the core knows neither.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostView {
    /// The network services; none where the control runs without them. The screen puts it in.
    pub network: Option<Arc<NetworkView>>,
    /// What spectators of a demonstration are told. The host puts it in.
    pub demo: DemoView,
    /// Number of the control: another one takes its place in a demonstration. The host puts it in.
    pub control: u32,
}
