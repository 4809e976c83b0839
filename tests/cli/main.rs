//! The command line, the files on disk, the documents and the house rules.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

#[path = "../common/command.rs"]
mod command;
#[path = "../common/stories.rs"]
mod stories;

mod check;
mod cli;
mod data_choice;
mod data_loss;
mod database_check;
mod defs;
mod docs;
mod foreign;
mod fuzz_corpus;
mod host;
mod languages;
mod modbus;
mod network;
mod pace;
mod password_loss;
mod process_trace;
mod production_store;
mod program_parts;
mod requirements;
#[cfg(unix)]
mod serial;
mod serial_format;
mod storage;
mod store_files;
mod store_retained;
mod story_lines;
mod structure;
mod technology;
mod tidy;
mod toolpath;
