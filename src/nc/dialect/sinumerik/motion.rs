//! Lines, arcs and dwell. X is a diameter, also under G91. I and K are distances from the start; I is a radius.
//! Source: spec S1.

use super::codes::SinumerikCodes;
use super::{CR_ADDRESS, address_name, checked_value, out_of_range};
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::common::MAX_VALUE;
use crate::nc::dialect::common::{self, MoveTarget};
use crate::nc::dialect::{BlockContext, arc};
use crate::nc::fault::{ReadResult, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{Feed, Op, SpeedMode};
use crate::nc::words::{Code, Word};
use crate::units::Axis;

/// Seconds per minute.
const SECONDS_PER_MINUTE: f64 = 60.0;

const fn axis_address(axis: Axis) -> u8 {
    match axis {
        Axis::X => b'X',
        Axis::Y => b'Y',
        Axis::Z => b'Z',
    }
}

/// Whether the block contains an axis word.
pub(super) fn names_axes(running: &BlockContext<'_, '_>) -> bool {
    Axis::ALL.into_iter().any(|axis| running.words.has(axis_address(axis)))
}

/// The value of an axis word, radius mm.
fn axis_value(running: &BlockContext<'_, '_>, axis: Axis, word: Word) -> ReadResult<f64> {
    if !running.settings.axes[axis] {
        return fail1(word.at as usize, E::NoAxis, axis.letter());
    }
    if word.value.abs() > MAX_VALUE {
        return out_of_range(word, "±99999.999");
    }
    Ok(if axis == Axis::X && running.settings.diameter { word.value / 2.0 } else { word.value })
}

/// The end of the move by the axis words of the block.
fn target(running: &BlockContext<'_, '_>) -> ReadResult<MoveTarget> {
    let from = running.scope.position();
    let incremental = running.modals.incremental;
    let mut target = MoveTarget::from(from);
    for axis in Axis::ALL {
        let Some(word) = running.words.take(axis_address(axis)) else { continue };
        let value = axis_value(running, axis, word)?;
        target.add(axis, value, incremental);
    }
    Ok(target)
}

/// The byte of the first axis word, else of the first code.
fn first_offset(running: &BlockContext<'_, '_>) -> usize {
    common::first_offset(running, |letter| Axis::ALL.into_iter().any(|axis| axis_address(axis) == letter))
}

fn modal_feed(running: &BlockContext<'_, '_>) -> ReadResult<Feed> {
    match running.modals.feed() {
        Some(feed) => Ok(feed),
        None => fail1(first_offset(running), E::FeedMissing, "G94/G95"),
    }
}

/// The move of G0 to G3.
pub(super) fn modal_move(running: &mut BlockContext<'_, '_>, plan: &SinumerikCodes) -> ReadResult<()> {
    let centre = [b'I', b'J', b'K'].into_iter().any(|letter| running.words.has(letter));
    let is_arc = matches!(running.modals.motion, MotionMode::ArcClockwise | MotionMode::ArcCounterClockwise);
    if !(names_axes(running) || is_arc && centre) {
        return match running.words.peek(CR_ADDRESS) {
            // An arc by radius needs an end point.
            Some(word) if is_arc && plan.motion.is_some() => {
                fail1(word.at as usize, E::ArcRadius, format_args!("CR={}", word.value))
            }
            Some(_) | None => Ok(()),
        };
    }
    let op = match running.modals.motion {
        MotionMode::Feed => {
            let MoveTarget { to, words, incremental } = target(running)?;
            Op::Feed { to, feed: modal_feed(running)?, words, incremental }
        }
        MotionMode::ArcClockwise => arc_move(running, -1)?,
        MotionMode::ArcCounterClockwise => arc_move(running, 1)?,
        // G0. Motion modes of other dialects are never active here.
        _ => {
            let MoveTarget { to, words, incremental } = target(running)?;
            Op::Rapid { to, feed: None, words, incremental }
        }
    };
    running.ops.push(op);
    Ok(())
}

fn arc_move(running: &BlockContext<'_, '_>, turn: i8) -> ReadResult<Op> {
    let from = running.scope.position();
    let MoveTarget { to, words, incremental } = target(running)?;
    let plane = running.modals.plane;
    let (first, second) = plane.axes();
    if let Some(outside) = words.iter().find(|axis| *axis != first && *axis != second) {
        return fail1(first_offset(running), E::AxisOutsidePlane, outside.letter());
    }
    if let Some(word) = running.words.peek(b'J') {
        return fail1(word.at as usize, E::AxisOutsidePlane, "J");
    }
    let feed = modal_feed(running)?;
    let distance = |letter| running.words.take(letter);
    let offsets = [(Axis::X, distance(b'I')), (Axis::Z, distance(b'K'))];
    let given = offsets.iter().find_map(|(_, word)| *word);
    let center = match (given, running.words.take(CR_ADDRESS)) {
        (None, None) => return fail2(first_offset(running), E::ArcWithoutCentre, "CR=", "I K"),
        (Some(other), Some(radius)) => return fail2(radius.at as usize, E::NotTogether, "CR", address_name(other)),
        (None, Some(word)) => {
            let tolerance = running.settings.arc_tolerance_mm;
            match arc::centre_by_radius((from, to), plane, turn, word.value, tolerance) {
                Some(center) => center,
                None => return fail1(word.at as usize, E::ArcRadius, format_args!("CR={}", word.value)),
            }
        }
        (Some(_), None) => {
            let mut center = from;
            for (axis, word) in offsets {
                center[axis] += word.map_or(0.0, |word| word.value);
            }
            let (radius, miss) = arc::radius_and_end_error((from, to), center, plane);
            if radius <= f64::EPSILON {
                return fail1(first_offset(running), E::ArcRadius, "0");
            }
            if miss > running.settings.arc_tolerance_mm {
                return fail1(first_offset(running), E::ArcEndOffCircle, format_args!("{miss:.3}"));
            }
            center
        }
    };
    Ok(Op::Arc { to, center, plane, turn, feed, words, incremental })
}

/// G4: `F` seconds, or `S` revolutions of the wheel at its programmed speed.
pub(super) fn dwell(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    if names_axes(running) {
        return fail1(first_offset(running), E::AxisUnused, "G4");
    }
    let s = match (running.words.take(b'F'), running.words.take(b'S')) {
        (Some(_), Some(turns)) => return fail2(turns.at as usize, E::NotTogether, "F", "S"),
        (None, None) => return fail2(code.at as usize, E::MissingWord, "G4", "F / S"),
        (Some(seconds), None) => checked_value(seconds, 0.0)?,
        (None, Some(turns)) => match (running.modals.speed, running.modals.speed_mode) {
            (Some(rpm), SpeedMode::Rpm) if rpm > 0.0 => checked_value(turns, 0.0)? * SECONDS_PER_MINUTE / rpm,
            // Under constant surface speed the rpm depends on the wheel diameter.
            (Some(_) | None, _) => {
                let written = format!("G4 S{}", turns.value);
                return fail1(turns.at as usize, E::DwellWithoutSpeed, written);
            }
        },
    };
    running.ops.push(Op::Dwell { s });
    Ok(())
}
