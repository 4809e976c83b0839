//! A thread that was cut, as it was measured.
//! Source: spec L5.

/// Measurements of a thread that was cut (L5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadCut {
    /// Line of the program, from 1.
    pub line: u32,
    /// Lead, mm.
    pub lead_mm: f64,
    /// Distance from the start to the run-out, mm.
    pub length_mm: f64,
    /// Maximum minus minimum deviation of Z from its spindle-synchronised position, mm.
    pub error_mm: f64,
}
