//! The interpreter: reads program text and returns canonical operations. It moves nothing.
//!
//! `Source` holds a text. `lexer` reads its bytes. `expression` and `statement` evaluate. A dialect turns words into
//! operations (`Op`). `flow` handles jumps and calls. `Interpreter::next` returns one block at a time. `check` runs a
//! whole file without a machine. Source: spec B1, B3, B4, B8, K4.
//!
//! Invariants: a refused block changes nothing. A block that needs a live value (`NextStatus::Drain`) is read again from
//! its start. All lengths in operations are radius millimetres.

mod assignment;
mod block;
mod called_texts;
pub mod check;
pub mod common_variables;
mod compensation;
mod contour;
mod contour_compensation;
mod contour_reader;
mod contour_return;
mod contour_segment;
mod corner;
mod cutter;
mod dialect;
mod expression;
pub mod external_state;
pub mod fault;
mod flow;
mod functions;
mod idle_passes;
pub mod interpreter;
mod lexer;
mod lost_state;
mod message_texts;
pub mod misread_text;
mod modal;
mod modal_calls;
mod offline_run;
pub mod op;
pub mod op_effect;
mod op_text;
mod preflight;
mod print_statement;
mod program_parts;
pub mod program_uses;
mod roughing;
mod scope;
pub mod settings;
pub mod source;
mod source_index;
mod statement;
mod unexecuted_blocks;
mod unexecuted_lines;
mod words;
pub mod work_offsets;

pub use block::{Block, USUAL_OPS};
pub use check::{CheckReport, MAX_FAULTS, ProgramCheck, check};
pub use common_variables::{CommonVariables, VariableError};
pub use cutter::{Compensation, CutterRangeError, CutterShape, MAX_CUTTER_RADIUS_MM, MAX_TIP};
pub use dialect::{call_text, function_names, new_program_text, refused_words};
pub use external_state::{ExternalState, LiveValue, OfflineMachine, SystemVariables};
pub use fault::{BlockLocation, ProgramFault};
pub use interpreter::{Interpreter, NextStatus};
pub use message_texts::{AlarmHelp, TextRowFault};
pub use modal::{ModalState, MotionMode};
pub use op::{AxisSet, CONTACT_SKIP_SIGNAL, Feed, GaugeMove, Op, PathMode, REFERENCE_POINTS, SpeedMode, ThreadMove};
pub use op_effect::{
    ArcMove, CoordinateChange, MCodeWords, MotionSegment, OpEffect, OpMotion, OscillationChange, ProgramMessage,
};
pub use preflight::{PreflightStatus, ProgramPreflight};
pub use program_parts::{ProgramPart, lines_before_number, program_parts};
pub use settings::{CodeMacros, CutterSource, Dialect, NcSettings, SpeedUnit, SuperManSettings};
pub use source::{EmptyLibrary, Library, SharedLibrary, Source};
pub use source_index::o_number;
pub use unexecuted_lines::check_syntax;
pub use work_offsets::{OriginPlace, ToolOffsetPlace, WorkOffsets};
