//! The terminals as the diagnosis page shows them.
//! Source: spec B6, K3.13.

use crate::defs::signal::Terminals;

/// Circuits of the terminals and analog outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TerminalView {
    /// Circuits of the input terminals; a closed one is low.
    pub inputs: Terminals,
    /// Circuits of the output terminals; a closed one is low.
    pub outputs: Terminals,
    /// The analog outputs: wheel speed, second output; volts.
    pub analog_volts: [f64; 2],
}
