//! The program languages: blocks to operations, every mistake with its place.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

mod calls;
mod common_variables;
mod compensation;
mod contour_cycles;
mod corners;
mod cutter_compensation;
mod everyday_words;
mod fuzz;
mod golden;
mod grinding_cycles;
mod message_texts;
mod op_effect;
mod program_uses;
mod roughing;
mod rows;
mod running;
mod sinumerik;
mod unexecuted;
mod work_offsets;
