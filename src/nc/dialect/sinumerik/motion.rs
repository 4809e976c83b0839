//! Lines, arcs and dwell. X is a diameter, also under G91. I and K are distances from the start; I is a radius.
//! Source: spec S1.

use super::{CR_ADDRESS, out_of_range};
use crate::nc::dialect::codes::BlockCodes;
use crate::nc::dialect::common::{MAX_VALUE, in_range};
use crate::nc::dialect::motion::{self, radius_mm};
use crate::nc::dialect::move_target::{MoveSyntax, MoveTarget, NO_LETTER};
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::modal::{DiameterProgramming, MotionMode};
use crate::nc::op::{AxisSet, Op, SpeedMode};
use crate::nc::words::{Code, Word, letter_mask};
use crate::units::{Axis, MM_PER_INCH, PerAxis};

/// Seconds per minute.
const SECONDS_PER_MINUTE: f64 = 60.0;

/// How moves are written.
const SYNTAX: MoveSyntax = MoveSyntax {
    axis_words: letter_mask(b"XYZ"),
    feed_codes: "G94/G95",
    radius: (CR_ADDRESS, "CR", "CR="),
    centre: "I K",
    refused: b'J',
    names_x: true,
    corner_names: ["CHR", "RND", "ANG"],
    length_mm: |running, word| Ok(word.value * unit_mm(running)),
};

/// The length of a unit: G70 and G700 select inches.
fn unit_mm(running: &BlockContext<'_, '_>) -> f64 {
    if running.modals.inch { MM_PER_INCH } else { 1.0 }
}

/// Whether the block contains an axis word.
pub(super) fn names_axes(running: &BlockContext<'_, '_>) -> bool {
    running.words.has_any(SYNTAX.axis_words)
}

/// The end of the move by the axis words of the block.
fn target(running: &BlockContext<'_, '_>) -> ReadResult<MoveTarget> {
    let letters = |axis: Axis| [axis.letter() as u8, NO_LETTER];
    MoveTarget::read(running, letters, |axis, word| axis_mm(running, axis, word), f64::INFINITY)
}

/// The value of an axis word, radius mm.
fn axis_mm(running: &BlockContext<'_, '_>, axis: Axis, word: Word) -> ReadResult<f64> {
    let length_mm = |running: &BlockContext<'_, '_>, word: Word| match word.value.abs() > MAX_VALUE {
        true => out_of_range(word, "±99999.999"),
        false => Ok(word.value * unit_mm(running)),
    };
    let is_incremental = || running.words.is_incremental(word.letter).unwrap_or(running.modals.incremental);
    let is_radius = match running.modals.diameter {
        DiameterProgramming::On => false,
        DiameterProgramming::Off => true,
        DiameterProgramming::Absolute => is_incremental(),
    };
    let radius = radius_mm(running, axis, word, length_mm)?;
    // `radius_mm` has halved it.
    Ok(if is_radius && axis == Axis::X && running.settings.diameter { 2.0 * radius } else { radius })
}

/// The axis words of the block as lengths, radius mm.
pub(super) fn axis_lengths(running: &BlockContext<'_, '_>) -> ReadResult<PerAxis<Option<f64>>> {
    let mut lengths = PerAxis::default();
    for axis in Axis::ALL {
        let word = running.words.take(axis.letter() as u8);
        lengths[axis] = word.map(|word| axis_mm(running, axis, word)).transpose()?;
    }
    Ok(lengths)
}

/// What a one-shot function does with the block.
pub(super) fn one_shot(running: &mut BlockContext<'_, '_>, plan: &BlockCodes, code: Code) -> ReadResult<()> {
    match code.number {
        4 => dwell(running, code),
        9 => motion::exact_stop_block(running, |running| modal_move(running, plan)),
        53 | 153 => machine_move(running, code),
        _ => reference_move(running, code),
    }
}

/// G53, G153: machine coordinates for this block.
fn machine_move(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { to, words, incremental, .. } = target(running)?;
    let name = || code.name('G', 0);
    if words.is_empty() {
        return fail2(code.at as usize, E::MissingWord, name(), "X / Z");
    }
    if !incremental.is_empty() {
        return fail2(motion::first_offset(running, &SYNTAX), E::NotTogether, name(), "G91 / IC");
    }
    let feed = match running.modals.motion {
        MotionMode::Rapid => None,
        _ => Some(motion::modal_feed(running, &SYNTAX)?),
    };
    running.ops.push(Op::MachineMove { to: PerAxis::from_fn(|axis| words.contains(axis).then_some(to[axis])), feed });
    Ok(())
}

/// G74: to the machine zero; G75: to the fixed point, reference point 2. The values of the words do not matter.
fn reference_move(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let MoveTarget { from, words, .. } = target(running)?;
    if words.is_empty() {
        return fail2(code.at as usize, E::MissingWord, code.name('G', 0), "X1=0 / Z1=0");
    }
    let number = if code.number == 74 { 1 } else { 2 };
    running.ops.push(Op::ReturnToReference { number, via: from, words, incremental: AxisSet::NONE });
    Ok(())
}

/// The move of G0 to G3. Motion modes of other dialects are never active here.
pub(super) fn modal_move(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    motion::modal_move(running, plan, &SYNTAX, target).map(drop)
}

/// G4: `F` seconds, or `S` revolutions of the wheel at its programmed speed.
fn dwell(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    if names_axes(running) {
        return fail1(motion::first_offset(running, &SYNTAX), E::AxisUnused, "G4");
    }
    let s = match (running.words.take(b'F'), running.words.take(b'S')) {
        (Some(_), Some(turns)) => return fail2(turns.at as usize, E::NotTogether, "F", "S"),
        (None, None) => return fail2(code.at as usize, E::MissingWord, "G4", "F / S"),
        (Some(seconds), None) => in_range(seconds, (0.0, MAX_VALUE), "")?,
        (None, Some(turns)) => match (running.modals.speed, running.modals.speed_mode) {
            (Some(rpm), SpeedMode::Rpm) if rpm > 0.0 => {
                in_range(turns, (0.0, MAX_VALUE), "")? * SECONDS_PER_MINUTE / rpm
            }
            // Under constant surface speed the rpm depends on the wheel diameter.
            (Some(_) | None, _) => {
                return fail1(turns.at as usize, E::DwellWithoutSpeed, format_args!("G4 S{}", turns.value));
            }
        },
    };
    running.ops.push(Op::Dwell { s });
    Ok(())
}
