//! The axis words and the feed of a block. Source: spec B2, K1.

use super::{AXIS_WORDS, MAX_VALUE, axis_letters, length_mm};
use crate::nc::dialect::motion;
use crate::nc::dialect::move_target::{MoveSyntax, MoveTarget, NO_LETTER};
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::ReadResult;
use crate::nc::op::Feed;
use crate::nc::words::Word;
use crate::units::Axis;

/// How moves are written.
pub(super) const SYNTAX: MoveSyntax = MoveSyntax {
    axis_words: AXIS_WORDS,
    feed_codes: "G98/G99",
    radius: (b'R', "R", "R"),
    centre: "I J K",
    refused: NO_LETTER,
    names_x: false,
    corner_names: [",C", ",R", ",A"],
    length_mm,
};

/// The end of the move by the axis words of the block.
#[inline]
pub(super) fn target(running: &BlockContext<'_, '_>) -> ReadResult<MoveTarget> {
    MoveTarget::read(running, axis_letters, |axis, word| axis_value(running, axis, word), MAX_VALUE)
}

/// The value of an axis word, radius mm.
#[inline]
pub(super) fn axis_value(running: &BlockContext<'_, '_>, axis: Axis, word: Word) -> ReadResult<f64> {
    motion::radius_mm(running, axis, word, length_mm)
}

/// The active feed.
#[inline]
pub(super) fn modal_feed(running: &BlockContext<'_, '_>) -> ReadResult<Feed> {
    motion::modal_feed(running, &SYNTAX)
}
