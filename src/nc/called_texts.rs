//! The programs that a check comes to by calls, in the order of the first calls. Source: spec B1, B3.

use std::sync::Arc;

use super::expression::Locals;
use super::fault::CallChain;
use super::flow::CallDepth;
use super::source::Source;
use super::unexecuted_lines::ExecutedLines;

/// Most texts that are read for one program.
const MAX_TEXTS: usize = 100;

/// A line of a text of the check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct TextLine {
    /// 0 for the program; those that it calls follow.
    pub text: usize,
    /// From 0.
    pub line: u32,
}

/// A call: its program, #1–#33 of it, and how deep in calls it is.
pub(super) type FoundCall = (Arc<Source>, Locals, CallDepth);

/// A program that the checked one calls.
pub(super) struct CalledText {
    pub source: Arc<Source>,
    pub marks: ExecutedLines,
    /// #1–#33 of its first call.
    pub locals: Locals,
    /// How the check came to it first.
    pub calls: CallChain,
    /// How deep in calls it was there.
    pub depth: CallDepth,
}

/// The programs that the checked one calls.
#[derive(Default)]
pub(super) struct CalledTexts(Vec<CalledText>);

impl CalledTexts {
    /// Keeps the memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The text with an index of [`TextLine`]; none for the program itself.
    pub fn get(&self, text: usize) -> Option<&CalledText> {
        self.0.get(text.checked_sub(1)?)
    }

    pub fn get_mut(&mut self, text: usize) -> Option<&mut CalledText> {
        self.0.get_mut(text.checked_sub(1)?)
    }

    /// The numbers of the programs.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        self.0.iter().map(|text| text.source.number())
    }

    /// The index of a text; `likely` is looked at first.
    pub fn find(&self, source: &Arc<Source>, likely: usize) -> Option<usize> {
        let is_there = |text: &CalledText| Arc::ptr_eq(&text.source, source);
        if self.get(likely).is_some_and(is_there) {
            return Some(likely);
        }
        self.0.iter().position(is_there).map(|index| index + 1)
    }

    /// Adds a program, unless it is there already.
    pub fn add(&mut self, (source, locals, depth): FoundCall, calls: CallChain) {
        if self.0.len() < MAX_TEXTS && self.find(&source, 0).is_none() {
            let marks = ExecutedLines::new(source.line_count());
            self.0.push(CalledText { source, marks, locals, calls, depth });
        }
    }
}
