//! The control as a whole: stories told to a fresh control on its simulated machine.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

#[path = "../common/command.rs"]
mod command;
#[path = "../common/stories.rs"]
mod stories;

mod absolute_encoder;
mod alarms;
mod allocation;
mod bus_clock;
mod compensation;
mod core_alone;
mod dense_program;
mod fault_table;
mod field_bus;
mod file_requests;
mod gathered_writes;
mod grinding_functions;
mod grinding_phase;
mod held_run;
mod homing;
mod interlock;
mod jog_demand;
mod lathe;
mod lathe_hand;
mod machine_rules;
mod motion_dense;
mod motion_feed;
mod motion_mover;
mod motion_path;
mod motion_profile;
mod motion_thread;
mod oscillation;
mod panel_keys;
mod power_fail;
mod process_end;
mod production;
mod restart;
mod retract;
mod run_control;
mod run_phase;
mod scope;
mod start_guide;
mod start_latency;
mod stations;
mod teach_in;
mod thread_recorder;
mod touch_probe;
mod vertical;
mod vertical_correction;
mod wheel_list;
mod wheel_size;
mod work_offsets;
