//! The tables of `kt830::defs`.

mod alarm;
mod availability;
mod date;
mod english;
mod gcode;
mod key;
mod kind;
mod leadscrew;
mod mcode;
mod page_text;
mod param;
mod param_row;
mod port_conflict;
mod program_error;
mod program_kind;
mod program_number;
mod signal;
mod soft_key;
mod system_variable;
mod text;
mod turning_tool;
mod value_bound;
mod variable_name;
