//! The program languages: blocks to operations, every mistake with its place.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

mod fuzz;
mod golden;
mod rows;
mod sinumerik;
