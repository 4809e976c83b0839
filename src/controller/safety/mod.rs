//! Safety: inputs, supervision, alarms and their reactions, outputs.

pub mod alarms;
mod filter;
pub mod inputs;
pub mod outputs;
mod supervision;
