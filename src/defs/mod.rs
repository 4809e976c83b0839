//! One table per concept: the core, the pages, the checker and the manual read the same rows.

pub mod gcode;
pub mod program_error;
pub mod text;
