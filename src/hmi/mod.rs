//! The touch screen: control screen and operator panel in egui, drawn only from the newest snapshot.
//!
//! [`Hmi::ui`] draws one frame and returns the commands of the operator's touches and keys; it does not depend on a
//! window. [`window::run`] shows it on a display; [`screenshot`] and [`page_text`] draw without one.
//! Source: spec H1–H10, K2, K7.

pub mod app;
pub mod aside;
mod closing;
pub mod core_fault;
mod demo_band;
mod explanation;
pub mod field_editor;
mod guarded_question;
mod key_press;
mod keyboard;
mod keycap;
pub mod layout;
mod letter_pad;
mod login;
mod numeric_pad;
pub mod offscreen;
mod page;
mod page_frame;
mod page_map;
mod page_message;
mod page_picture;
pub mod panel;
pub mod path_plot;
pub mod pictogram;
mod pointer_finger;
mod question;
pub mod rasterizer;
pub mod repaint;
mod requests;
pub mod scene;
mod screen_zoom;
mod search_field;
pub mod sound;
mod swipe;
pub mod theme;
pub mod variable_entry;
pub mod view;
mod widget;
pub mod window;

pub use app::Hmi;
pub(crate) use field_editor::{CoreAnswer, FieldEditor, ValueField, param_range, parse_number};
pub(crate) use guarded_question::GuardedQuestion;
pub(crate) use keyboard::{EditKey, KeyboardInput, TypedInput};
pub use keyboard::{SHORTCUTS, Shortcut};
pub(crate) use keycap::KeycapState;
pub(crate) use layout::Area;
pub(crate) use letter_pad::LetterKey;
pub(crate) use login::Login;
pub use offscreen::{page_text, screenshot};
pub use page::help::{HelpEntry, Section as HelpSection, entries as help_entries};
pub(crate) use page_message::PageMessage;
pub(crate) use question::{Question, QuestionDialog};
pub(crate) use requests::{PendingRequests, RequestEvent, file_command};
pub(crate) use search_field::{Search, SearchTouch};
pub(crate) use view::{
    View, blink_phase, clock_time, format_cycle_time, format_date_time, format_feed, format_length, format_size,
    format_strokes, format_value, format_volts, format_whole,
};
pub(crate) use widget::{KeyboardFocus, PageKey, round_to_lines};
