//! Reads the words of corners and angles of lines: `,C` `,R` `,A`, and CHR, CHF, RND, RNDM, ANG. Source: spec B2, S1.

use super::common::{MAX_VALUE, out_of_range_as};
use super::move_target::{MoveSyntax, MoveTarget};
use super::rules::BlockContext;
use crate::geometry::Corner;
use crate::nc::corner::CornerWords;
use crate::nc::fault::{E, ReadResult, fail2};
use crate::nc::op::AxisSet;
use crate::nc::words::{CHAMFER, CHAMFER_LENGTH, LINE_ANGLE, ROUNDING, Word, letter_mask};

/// The words of a corner, as a mask.
const CORNER_WORDS: u32 = letter_mask(&[CHAMFER, ROUNDING, CHAMFER_LENGTH]);
/// Cosine below which a line does not reach a coordinate.
const SQUARE_COSINE: f64 = 1e-6;

/// The angle of a line, radian, and what it is for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineAngle {
    open: Option<f64>,
    end: Option<f64>,
}

/// Reads `,A`, the angle of a line from the first axis of the plane (Z in ZX), counter-clockwise. With one coordinate
/// it gives the other one; alone the next block ends the line; with both it ends the line of the block before.
pub(super) fn line_angle(
    running: &BlockContext<'_, '_>,
    syntax: &MoveSyntax,
    target: &mut MoveTarget,
) -> ReadResult<LineAngle> {
    let Some(word) = running.words.take(LINE_ANGLE) else { return Ok(LineAngle::default()) };
    if !(-360.0..=360.0).contains(&word.value) {
        return out_of_range_as(syntax.corner_names[2], word, "±360");
    }
    let angle = word.value.to_radians();
    let (first, second) = running.modals.plane.axes();
    if let Some(outside) = target.words.iter().find(|axis| *axis != first && *axis != second) {
        return fail2(word.at as usize, E::NotTogether, syntax.corner_names[2], outside.letter());
    }
    let (given, sought, along, across) = match [first, second].map(|axis| target.words.contains(axis)) {
        [false, false] => return Ok(LineAngle { open: Some(angle), end: None }),
        [true, true] => return Ok(LineAngle { open: None, end: Some(angle) }),
        [true, false] => (first, second, angle.cos(), angle.sin()),
        [false, true] => (second, first, angle.sin(), angle.cos()),
    };
    if along.abs() < SQUARE_COSINE {
        return out_of_range_as(syntax.corner_names[2], word, given.letter().to_string().as_str());
    }
    target.to[sought] = target.from[sought] + (target.to[given] - target.from[given]) * across / along;
    target.words = target.words.with(AxisSet::of(sought));
    if target.incremental.contains(given) {
        target.incremental.insert(sought);
    }
    Ok(LineAngle::default())
}

/// Notes what the move just pushed asks of its end: a corner of its block, or the modal rounding (RNDM).
#[inline]
pub(super) fn note_corner(
    running: &mut BlockContext<'_, '_>,
    syntax: &MoveSyntax,
    target: &MoveTarget,
    angle: LineAngle,
) -> ReadResult<()> {
    let has_angle = angle.open.is_some() || angle.end.is_some();
    if has_angle || running.words.has_any(CORNER_WORDS) || running.modals.rounding.is_some() {
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
    let [chamfer_name, round_name, angle_name] = syntax.corner_names;
    let mut found: Option<(Word, &'static str, Corner)> = None;
    for (letter, name) in [(CHAMFER, chamfer_name), (CHAMFER_LENGTH, "CHF"), (ROUNDING, round_name)] {
        let Some(word) = running.words.take(letter) else { continue };
        let mm = (syntax.length_mm)(running, word)?;
        if !(0.0..=MAX_VALUE).contains(&mm) {
            return out_of_range_as(name, word, "0–99999.999");
        }
        if let Some((_, other, _)) = found {
            return fail2(word.at as usize, E::NotTogether, other, name);
        }
        found = Some((
            word,
            name,
            match letter {
                CHAMFER => Corner::ChamferLeg(mm),
                CHAMFER_LENGTH => Corner::ChamferLength(mm),
                _ => Corner::Radius(mm),
            },
        ));
    }
    let is_none = |corner: &Corner| matches!(corner, Corner::ChamferLeg(mm) | Corner::ChamferLength(mm) | Corner::Radius(mm) if *mm <= 0.0);
    let is_modal = found.is_none() && angle.open.is_none();
    let corner = match found {
        Some((.., corner)) => Some(corner).filter(|corner| !is_none(corner)),
        None => running.modals.rounding.map(Corner::Radius),
    };
    if corner.is_none() && angle.open.is_none() && angle.end.is_none() {
        return Ok(None);
    }
    let angle_word = || running.words.peek(LINE_ANGLE).map(|word| (word, angle_name));
    let named = found.map(|(word, name, _)| (word, name)).or_else(angle_word);
    let (at, name) = named.map_or((running.at, "RNDM"), |(word, name)| (word.at as usize, name));
    if running.modals.modal_call && !is_modal {
        // The macro of G66 would have to run in the middle of the corner.
        return fail2(at, E::NotTogether, "G66", name);
    }
    let (from, plane) = (target.from, running.modals.plane);
    let LineAngle { open: open_angle, end: end_angle } = angle;
    Ok(Some(CornerWords { corner, open_angle, end_angle, is_modal, from, plane, at, name }))
}
