//! How a dialect writes its moves, and the end of a move by the axis words of a block. Source: spec B2, S1.

use super::common::out_of_range;
use super::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail2};
use crate::nc::op::AxisSet;
use crate::nc::words::{BlockWords, Word};
use crate::units::{Axis, WorkPos};

/// In place of the letter of a word that a dialect does not have.
pub(super) const NO_LETTER: u8 = b'@';

/// How a dialect writes its moves.
pub(super) struct MoveSyntax {
    /// The letters of axis words, as a mask.
    pub axis_words: u32,
    /// The codes that select the unit of F.
    pub feed_codes: &'static str,
    /// Letter and name of an arc's radius, and what precedes its value.
    pub radius: (u8, &'static str, &'static str),
    /// The other words of an arc's centre; `refused` is one that no arc has.
    pub centre: &'static str,
    pub refused: u8,
    /// A radius beside both distances is refused with the name of X's; else of the plane's first axis.
    pub names_x: bool,
    /// The names of a chamfer by its legs, a rounding, and the angle of a line.
    pub corner_names: [&'static str; 3],
    /// The length of a centre word, mm. B2: I is a radius, even if X is a diameter.
    pub length_mm: fn(&BlockContext<'_, '_>, Word) -> ReadResult<f64>,
}

/// The end of a move.
#[derive(Clone, Copy, Debug)]
pub(super) struct MoveTarget {
    pub from: WorkPos,
    pub to: WorkPos,
    pub words: AxisSet,
    pub incremental: AxisSet,
}

impl MoveTarget {
    /// The end of the move by the axis words of the block: `letters` are those of an axis, absolute and incremental,
    /// `value` is the radius mm of a word. No coordinate may be greater than `most`.
    #[inline]
    pub fn read(
        running: &BlockContext<'_, '_>,
        letters: impl Fn(Axis) -> [u8; 2],
        value: impl Fn(Axis, Word) -> ReadResult<f64>,
        most: f64,
    ) -> ReadResult<Self> {
        let from = running.scope.position();
        let mut target = Self { from, to: from, words: AxisSet::NONE, incremental: AxisSet::NONE };
        for axis in Axis::ALL {
            let [absolute, distance] = letters(axis);
            let (letter, incremental) = match [absolute, distance].map(|letter| running.words.has(letter)) {
                [false, false] => continue,
                [true, true] => return refuse_both(running.words, [absolute, distance]),
                [true, false] => {
                    (absolute, running.words.is_incremental(absolute).unwrap_or(running.modals.incremental))
                }
                [false, true] => (distance, true),
            };
            let Some(word) = running.words.take_in_place(letter) else { continue };
            let value = value(axis, *word)?;
            target.words.insert(axis);
            if incremental {
                target.incremental.insert(axis);
            }
            target.to[axis] = if incremental { target.to[axis] + value } else { value };
            if target.to[axis].abs() > most {
                return out_of_range(*word, format_args!("±{most}"));
            }
        }
        Ok(target)
    }
}

/// Refuses an absolute and an incremental word of the same axis.
#[cold]
pub(super) fn refuse_both<T>(words: &BlockWords, letters: [u8; 2]) -> ReadResult<T> {
    let mut at = letters.map(|letter| (words.peek(letter).map_or(0, |word| word.at), char::from(letter)));
    at.sort_unstable();
    fail2(at[1].0 as usize, E::AbsoluteAndIncremental, at[0].1, at[1].1)
}
