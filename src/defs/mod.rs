//! The tables: one per concept, used by the core, the pages, the program checker and the manual.
//!
//! Each number, name and text is defined once, in its row. This module has no behaviour.

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
