//! The screen: pages, keys and entry, with and without a control behind them.

#![cfg(feature = "hmi")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test driver: a failure is the message")]

#[path = "../common/command.rs"]
mod command;
#[path = "../common/sample.rs"]
mod sample;
#[path = "../common/stories.rs"]
mod stories;

mod alarm;
mod bus;
mod checklist;
mod closing;
mod core_fault;
mod demo_band;
mod designer;
mod designer_arrange;
mod dressing_point;
mod editor;
mod english;
mod entry;
mod favourites;
mod fitted;
mod graphic;
mod help;
mod home;
mod jobs;
mod languages;
mod lathe;
mod live_screen;
mod network;
mod operators;
mod pages;
mod panel;
mod params;
mod part_result;
mod path_plot;
mod picture_labels;
mod process;
mod program_list;
mod reach;
mod repaint;
mod scene;
mod scope;
mod screen;
mod screen_zoom;
mod screw;
mod service;
mod shift;
mod simulator;
mod soak;
mod soft_keys;
mod sound;
mod start_guide;
mod technology;
mod text_editor;
mod touch;
mod transfer;
mod values;
mod vertical;
