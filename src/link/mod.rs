//! Everything that the control screen and the core share: commands in, the newest snapshot out.
//! Neither side calls the other: a page cannot call the core, the core cannot call a page.

pub mod bus;
pub mod command;
pub mod condition;
pub mod cycle;
pub mod cycle_times;
pub mod data_item;
pub mod demo_view;
pub mod edit;
pub mod files;
pub mod host_view;
pub mod internal_signal;
pub mod line_fault;
pub mod media;
pub mod network;
pub mod observed;
pub mod page_command;
pub mod page_file;
pub mod part_result;
pub mod production;
pub mod program_view;
pub mod restart_view;
pub mod scope;
pub mod screens;
pub mod simulation;
pub mod snapshot;
pub mod start_guide;
pub mod teach;
pub mod terminals;
pub mod thread_cut;
pub mod toolpath;
pub mod wheels;

pub use command::Command;
pub use page_command::PageCommand;
pub use snapshot::Snapshot;
