//! The interpreter: reads program text and returns canonical operations. It moves nothing.
//!
//! `Source` holds a text. `lexer` reads its bytes. `expression` and `statement` evaluate. A dialect turns words into
//! operations (`Op`). `flow` handles jumps and calls. `Interpreter::next` returns one block at a time. `check` runs a
//! whole file without a machine. Source: spec B1, B3, B4, B8, K4.
//!
//! Invariants: a refused block changes nothing. A block that needs a live value (`Next::Drain`) is read again from
//! its start. All lengths in operations are radius millimetres.

pub mod check;
mod collect;
mod contour;
mod dialect;
mod expression;
pub mod fault;
mod flow;
mod follow;
pub mod frames;
mod functions;
pub mod interpreter;
mod lexer;
pub mod memory;
pub mod modal;
pub mod op;
mod proof;
mod scope;
pub mod settings;
pub mod source;
mod statement;
mod unread;
pub mod uses;
mod words;
pub mod world;

pub use check::{Checked, Checking, check, check_until, check_with, look};
pub use fault::{Fault, Place};
pub use follow::ADVANCE_PER_CALL;
pub use frames::Frames;
pub use interpreter::{Block, Interpreter, Next};
pub use memory::{Memory, VariableError};
pub use modal::{Modals, Motion};
pub use op::{AxisSet, Feed, Gauging, Op, PathMode, Plane, REFERENCES, SpeedMode, Threading};
pub use proof::{Proof, Proved};
pub use settings::{Settings, SpeedUnit, System, Turning};
pub use source::{Library, NoLibrary, Source};
pub use world::{CheckWorld, Live, World};
