//! The simulated machine and its physics.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

#[path = "../common/stories.rs"]
mod stories;

mod axis;
mod bench;
mod grinding;
mod injector;
mod interference;
mod kinds;
mod machine;
mod machine_file;
mod part_file;
mod process;
mod story;
mod table;
mod trace;
mod wiring;
