//! Safety: inputs, supervision, alarms and their reactions, outputs.

pub mod alarms;
pub mod drives;
mod filter;
pub mod inputs;
mod output_image;
pub mod outputs;
mod supervision;
