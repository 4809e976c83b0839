//! The tables: one per concept, used by the core, the pages, the program checker and the manual.
//!
//! Each number, name and text is defined once, in its row. This module has no behaviour.

pub mod alarm;
pub mod alarm_history;
pub mod availability;
pub mod date;
pub mod device_state;
pub mod dialect;
pub mod dialect_word;
pub mod equipment;
pub mod fitted;
pub mod gcode;
pub mod grinding_phase;
pub mod grinding_workspace;
pub mod history;
pub mod hour_record;
pub mod key;
pub mod kind;
pub mod language_row;
pub mod lathe_workspace;
pub mod leadscrew;
pub mod mcode;
pub mod page;
pub mod page_meaning;
pub mod page_text;
pub mod param;
pub mod param_row;
pub mod part_defect;
pub mod part_record;
pub mod part_verdict;
pub mod port_conflict;
pub mod port_errors;
pub mod production_order;
pub mod program_error;
pub mod program_kind;
pub mod program_number;
pub mod scope_signal;
pub mod signal;
pub mod sim_fault;
pub mod soft_key;
pub mod start_step;
pub mod system_variable;
pub mod text;
pub mod turning_tool;
pub mod value_bound;
pub mod variable_name;
