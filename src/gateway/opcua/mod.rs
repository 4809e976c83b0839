//! `kt830 opcua`: an OPC UA server for a control, in a process of its own. It takes what the control tells at its adapter
//! port (P480), and hands on the orders that clients propose: nothing else that a client of OPC UA does, nor a fault of the
//! server, reaches the control.
//! Files: `adapter_state` what the control tells, `adapter_client` the connection to it, `machine_tool` the machine in the
//! address space, `production_plan` its orders, `node_builder` how nodes are made, `node_manager` the address space,
//! `alert_event` alarms and messages, `order_desk` orders on their way to the control, `accounts` users, `certificates`,
//! `gatekeeper` what stands before the library, `source_clock` the times of values, `log`.
//! Source: OPC 10000 (OPC UA), OPC 40501-1 (machine tools).

#[cfg(feature = "opcua")]
mod accounts;
#[cfg(feature = "opcua")]
mod adapter_client;
pub mod adapter_state;
#[cfg(feature = "opcua")]
mod alert_event;
#[cfg(feature = "opcua")]
pub mod certificates;
#[cfg(feature = "opcua")]
mod gatekeeper;
#[cfg(feature = "opcua")]
mod log;
#[cfg(feature = "opcua")]
mod machine_tool;
#[cfg(feature = "opcua")]
mod node_builder;
#[cfg(feature = "opcua")]
mod node_manager;
#[cfg(feature = "opcua")]
mod opcua_server;
#[cfg(feature = "opcua")]
mod order_desk;
#[cfg(feature = "opcua")]
mod production_plan;
#[cfg(feature = "opcua")]
mod source_clock;

#[cfg(feature = "opcua")]
pub use accounts::Users;
#[cfg(feature = "opcua")]
pub use opcua_server::{OpcUaServer, OpcUaSettings};
