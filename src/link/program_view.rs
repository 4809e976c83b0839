//! The current program and its running block, as pages show them. Source: spec B6, K7.2.

use std::sync::Arc;

use ropey::Rope;

use crate::defs::value_bound::{ValueBound, ValueRange};

/// The current program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramView {
    /// O number, 0 when there is none.
    pub number: u32,
    /// Its text as displayed. Copies share memory.
    pub text: Rope,
    /// The bounds that it names for the values of its page. Copies share memory.
    pub bounds: Arc<[ValueBound]>,
    /// Checksum of the file; it changes with the text.
    pub stamp: u64,
    /// The file has bytes that are neither UTF-8 nor GBK.
    pub has_invalid_bytes: bool,
    /// Program of the running block: a subprogram's number while one runs.
    pub block_program: u32,
    /// Text of the running subprogram; none while none runs or if it is not in the folder. Copies share memory.
    pub subprogram_text: Option<Rope>,
    /// Line of the running block, from 1; 0 before the first.
    pub line: u32,
    /// N number of the running block.
    pub block: Option<u32>,
    /// A run is open: it executes, holds or waits; an MDI line too.
    pub is_open: bool,
    /// Its last run has come to its end.
    pub is_completed: bool,
}

impl ProgramView {
    /// The range of a variable by the bounds of the program.
    #[must_use]
    pub fn range_of(&self, variable: u16, variables: &[Option<f64>]) -> ValueRange {
        ValueRange::of(variable, &self.bounds, |other| variables.get(usize::from(other)).copied().flatten())
    }

    /// Whether a subprogram is being executed.
    #[must_use]
    pub const fn in_subprogram(&self) -> bool {
        self.block_program != 0 && self.block_program != self.number
    }

    /// Whether `line` is a line of the program itself: neither of a subprogram nor of MDI or the retract.
    #[must_use]
    pub const fn is_own_line(&self) -> bool {
        self.block_program == self.number || self.line == 0
    }

    /// The program of the running block: the subprogram while one runs.
    #[must_use]
    pub const fn running_program(&self) -> u32 {
        if self.in_subprogram() { self.block_program } else { self.number }
    }

    /// The text that `line` is in; none if it is not known.
    #[must_use]
    pub const fn running_text(&self) -> Option<&Rope> {
        match &self.subprogram_text {
            _ if self.number == 0 => None,
            _ if self.is_own_line() => Some(&self.text),
            text => text.as_ref(),
        }
    }
}
