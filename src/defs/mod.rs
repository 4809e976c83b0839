//! The tables: one per concept, read by the core, the pages, the checker and the manual.
//!
//! A row is the only place where a number, a name or a text stands. Nothing here acts.

pub mod alarm;
pub mod date;
pub mod dialect_word;
pub mod face;
pub mod fault;
pub mod gcode;
pub mod history;
pub mod key;
pub mod kind;
pub mod mcode;
pub mod page;
pub mod param;
pub mod param_row;
pub mod port;
pub mod program;
pub mod program_error;
pub mod r_name;
pub mod r_parameter;
pub mod screen;
pub mod screw;
pub mod signal;
pub mod soft_key;
pub mod text;
pub mod turning_tool;
pub mod variable;
