//! Reads the words of corners and angles of lines: `,C` `,R` `,A`, and CHR, CHF, RND, RNDM, ANG. Source: spec B2, S1.

use super::common::{MAX_VALUE, out_of_range_as};
use super::move_target::{MoveSyntax, MoveTarget};
use super::rules::BlockContext;
use crate::geometry::Corner;
use crate::nc::corner::{CornerWord, CornerWords, LineAngle};
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::op::AxisSet;
use crate::nc::words::{CHAMFER, CHAMFER_LENGTH, LINE_ANGLE, ROUNDING, ValueKind, letter_mask};

/// The words of a corner, as a mask.
const CORNER_WORDS: u32 = letter_mask(&[CHAMFER, ROUNDING, CHAMFER_LENGTH]);
/// Cosine below which a line does not reach a coordinate.
const SQUARE_COSINE: f64 = 1e-6;

/// Reads `,A`, the angle of a line from the first axis of the plane (Z in ZX), counter-clockwise. With one coordinate
/// it gives the other one; alone the next block ends the line; with both it ends the line of the block before.
pub(super) fn line_angle(
    running: &BlockContext<'_, '_>,
    syntax: &MoveSyntax,
    target: &mut MoveTarget,
) -> ReadResult<LineAngle> {
    let Some(word) = running.words.take(LINE_ANGLE) else { return Ok(LineAngle::None) };
    let least = running.settings.least_increment_mm.filter(|_| word.kind == ValueKind::Integer);
    let degrees = word.value * least.unwrap_or(1.0);
    if !(-360.0..=360.0).contains(&degrees) {
        return out_of_range_as(syntax.corner_names[2], word, "±360");
    }
    let angle = degrees.to_radians();
    let (first, second) = running.modals.plane.axes();
    if let Some(outside) = target.words.iter().find(|axis| *axis != first && *axis != second) {
        return fail2(word.at as usize, E::NotTogether, syntax.corner_names[2], outside.letter());
    }
    let (given, sought, along, across) = match [first, second].map(|axis| target.words.contains(axis)) {
        [false, false] => return Ok(LineAngle::Open(angle)),
        [true, true] => return Ok(LineAngle::End(angle)),
        [true, false] => (first, second, angle.cos(), angle.sin()),
        [false, true] => (second, first, angle.sin(), angle.cos()),
    };
    if along.abs() < SQUARE_COSINE {
        return out_of_range_as(syntax.corner_names[2], word, given.letter().to_string().as_str());
    }
    if (target.to[given] - target.from[given]) / along < 0.0 {
        return fail1(word.at as usize, E::AngleAway, syntax.corner_names[2]);
    }
    target.to[sought] = target.from[sought] + (target.to[given] - target.from[given]) * across / along;
    target.words = target.words.with(AxisSet::of(sought));
    if target.incremental.contains(given) {
        target.incremental.insert(sought);
    }
    Ok(LineAngle::None)
}

/// Notes what the move just pushed asks of its end: a corner of its block, or the modal rounding (RNDM).
#[inline]
pub(super) fn note_corner(
    running: &mut BlockContext<'_, '_>,
    syntax: &MoveSyntax,
    target: &MoveTarget,
    angle: LineAngle,
) -> ReadResult<()> {
    if angle != LineAngle::None || running.words.has_any(CORNER_WORDS) || running.modals.rounding.is_some() {
        *running.corner = read_corner(running, syntax, target, angle)?;
    }
    Ok(())
}

#[cold]
fn read_corner(
    running: &BlockContext<'_, '_>,
    syntax: &MoveSyntax,
    target: &MoveTarget,
    angle: LineAngle,
) -> ReadResult<Option<CornerWords>> {
    let [.., angle_name] = syntax.corner_names;
    let found = corner_word(running, syntax)?;
    let here = CornerWord { at: running.at, name: "RNDM" };
    let corner = match found {
        Some((corner, _)) => Some(corner).filter(|corner| corner.size_mm() > 0.0),
        None => running.modals.rounding.map(Corner::Radius),
    };
    let angle_at = running.words.peek(LINE_ANGLE).map_or(running.at, |word| word.at as usize);
    let words = CornerWords {
        corner,
        corner_word: found.map_or(here, |(_, word)| word),
        angle,
        angle_word: CornerWord { at: angle_at, name: angle_name },
        is_modal: found.is_none(),
        from: target.from,
        plane: running.modals.plane,
    };
    if corner.is_none() && angle == LineAngle::None {
        return Ok(None);
    }
    if running.modals.modal_call && !words.is_optional() {
        // The macro of G66 would have to run in the middle of the corner.
        let CornerWord { at, name } = if found.is_some() { words.corner_word } else { words.angle_word };
        return fail2(at, E::NotTogether, "G66", name);
    }
    Ok(Some(words))
}

/// The chamfer or rounding of the block, and its word; 0 is none.
fn corner_word(running: &BlockContext<'_, '_>, syntax: &MoveSyntax) -> ReadResult<Option<(Corner, CornerWord)>> {
    let [chamfer, rounding, _] = syntax.corner_names;
    let mut found: Option<(Corner, CornerWord)> = None;
    for (letter, name) in [(CHAMFER, chamfer), (CHAMFER_LENGTH, "CHF"), (ROUNDING, rounding)] {
        let Some(word) = running.words.take(letter) else { continue };
        let mm = (syntax.length_mm)(running, word)?;
        if !(0.0..=MAX_VALUE).contains(&mm) {
            return out_of_range_as(name, word, "0–99999.999");
        }
        let corner = match letter {
            CHAMFER => Corner::ChamferLeg(mm),
            CHAMFER_LENGTH => Corner::ChamferLength(mm),
            _ => Corner::Radius(mm),
        };
        let at = word.at as usize;
        if let Some((_, other)) = found.replace((corner, CornerWord { at, name })) {
            return fail2(at, E::NotTogether, other.name, name);
        }
    }
    Ok(found)
}
