//! The touch screen: control screen and operator panel in egui, drawn only from the newest snapshot.
//!
//! [`Hmi::ui`] draws one frame and returns the commands of the operator's touches and keys; it does not depend on a
//! window. [`window::run`] shows it on a display; [`shot`] and [`page_text`] draw without one.
//! Source: spec H1–H10, K2, K7.

pub mod app;
mod asking;
pub mod entry;
mod frame;
mod help;
mod keyboard;
mod keycap;
pub mod layout;
mod letters;
mod login;
mod pad;
mod page;
pub mod panel;
pub mod pictogram;
mod press;
mod question;
pub mod raster;
mod search;
pub mod shot;
mod softkey;
pub mod theme;
pub mod typing;
pub mod view;
mod widget;
pub mod window;

pub use app::Hmi;
pub use help::{HelpEntry, Section as HelpSection, entries as help_entries};
pub use keyboard::{SHORTCUTS, Shortcut};
pub use shot::{page_text, shot};
