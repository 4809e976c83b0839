//! The programs that come with the control, each ground on its part to size on the simulated machine: rows K7.9, K7.10,
//! K4.1–K4.5, P4–P7.

#![allow(clippy::unwrap_used, reason = "a test driver: a failure is the message")]
#![allow(clippy::print_stdout, reason = "the figures are for people: `--nocapture`")]

#[path = "../told/mod.rs"]
mod told;

mod batch;
mod dressing;
mod pages;
mod refusals;
mod retract;
mod shop;
mod sizes;
