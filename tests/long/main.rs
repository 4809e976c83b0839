//! Long searches and batches: run optimised, `cargo test --release --test long`.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]
#![allow(clippy::print_stdout, reason = "the figures are for people: `--nocapture`")]

#[path = "../common/command.rs"]
mod command;
#[path = "../common/stories.rs"]
mod stories;

mod attacks;
mod machine_explore;
mod machine_table;
mod motion_limits;
mod oscillation_hours;
mod programs;
mod torture;
