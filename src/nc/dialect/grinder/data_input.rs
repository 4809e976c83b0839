//! G10: wear, tool offsets and work offsets from the program, and G52, the local zero.
//!
//! `G10 D_ U_ W_` is the customer's (K4.1). The others are FANUC's: `G10 L2 P0…P6` external offset and G54 to G59,
//! `G10 L20 P1…P48` G54.1, `G10 P1…P16` wear and `G10 P10001…P10016` geometry of a tool offset. X Y Z replace, U V W (and
//! X Y Z under G91) add. They are written as system variables. Source: spec K4.1, B2, B3.

use super::coordinates::axis_value;
use super::{OneShot, axis_letters, integer, length_mm, out_of_range};
use crate::defs::system_variable as variable;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::expression::Scope;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::op::Op;
use crate::nc::words::{Code, Word};
use crate::nc::work_offsets::{EXTRA_WORK_OFFSETS, OriginPlace};
use crate::units::{Axis, MM_PER_INCH, PerAxis};

/// Added to the number of an offset for its geometry.
const GEOMETRY_P: u32 = 10_000;

/// How the one-shot functions of this file are read.
pub(super) fn reading_of(code: u32) -> Option<OneShot> {
    Some(match code {
        10 => data_input,
        52 => local_zero,
        _ => return None,
    })
}

fn data_input(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let kind = running.words.take(b'L').map(|word| (word, integer(word, 0, 9_999)));
    match kind {
        None if running.words.has(b'P') && !running.words.has(b'D') => tool_offset(running, code),
        None => add_wear(running, code),
        Some((_, Ok(2))) => work_offset(running, code, (0, 6)),
        Some((_, Ok(20))) => work_offset(running, code, (1, EXTRA_WORK_OFFSETS as u32)),
        Some((word, _)) => out_of_range(word, "2, 20"),
    }
}

/// `G10 D_ U_ W_ V_`: adds to the wear of offset D (K4.1).
fn add_wear(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let words = running.words;
    let Some(number) = words.take(b'D') else { return fail2(code.at as usize, E::MissingWord, "G10", "D") };
    let number = integer(number, 1, running.settings.tool_count)? as u8;
    let mut by = PerAxis::default();
    let mut named = false;
    for axis in Axis::ALL {
        let [_, incremental] = axis_letters(axis);
        let Some(word) = words.take(incremental) else { continue };
        named = true;
        by[axis] = axis_value(running, axis, word)?;
    }
    if !named {
        return fail2(code.at as usize, E::MissingWord, "G10", "U / W");
    }
    running.ops.push(Op::AddWear { number, by });
    Ok(())
}

/// `G10 L2 P_` and `G10 L20 P_`: an origin in machine coordinates.
fn work_offset(running: &mut BlockContext<'_, '_>, code: Code, (low, high): (u32, u32)) -> ReadResult<()> {
    let Some(p) = running.words.take(b'P') else { return fail2(code.at as usize, E::MissingWord, "G10 L", "P") };
    let number = integer(p, low, high)? as usize;
    let place = match (low, number) {
        (0, 0) => OriginPlace::External,
        (0, number) => OriginPlace::Work(number - 1),
        (_, number) => OriginPlace::Work(OriginPlace::COUNT - 2 - EXTRA_WORK_OFFSETS + number),
    };
    let fitted = running.settings.axes;
    let index = |axis: Axis| fitted.iter().take_while(|(of, _)| *of != axis).filter(|(_, is)| **is).count() as u32;
    if write_axes(running, |axis| place.first_variable() + index(axis))? {
        return Ok(());
    }
    fail2(code.at as usize, E::MissingWord, "G10 L P", "X / Z")
}

/// `G10 P_`: wear or geometry of a tool offset, its radius R and its tip Q.
fn tool_offset(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let Some(p) = running.words.take(b'P') else { return fail2(code.at as usize, E::MissingWord, "G10", "P") };
    let count = running.settings.tool_count;
    let given = integer(p, 1, GEOMETRY_P + count)?;
    let (is_geometry, number) = (given > GEOMETRY_P, given % GEOMETRY_P);
    if !(1..=count).contains(&number) {
        return out_of_range(p, format_args!("1–{count} {}–{}", GEOMETRY_P + 1, GEOMETRY_P + count));
    }
    let table = |axis: Axis| match (axis, is_geometry) {
        (Axis::X, false) => variable::WEAR_X,
        (Axis::Y, false) => variable::WEAR_Y,
        (Axis::Z, false) => variable::WEAR_Z,
        (Axis::X, true) => variable::GEOMETRY_X,
        (Axis::Y, true) => variable::GEOMETRY_Y,
        (Axis::Z, true) => variable::GEOMETRY_Z,
    };
    let mut named = write_axes(running, |axis| table(axis).first + number - 1)?;
    if let Some(radius) = running.words.take(b'R') {
        let radius = length_mm(running, radius)?;
        write(running, variable::CUTTER_RADIUS.first + number - 1, radius);
        named = true;
    }
    if let Some(tip) = running.words.take(b'Q') {
        write(running, variable::CUTTER_TIP.first + number - 1, f64::from(integer(tip, 0, 9)?));
        named = true;
    }
    if named { Ok(()) } else { fail2(code.at as usize, E::MissingWord, "G10 P", "X / Z / U / W / R / Q") }
}

/// Writes the axis words of the block to variables, mm as displayed; false if there is none.
fn write_axes(running: &mut BlockContext<'_, '_>, variable: impl Fn(Axis) -> u32) -> ReadResult<bool> {
    let mut named = false;
    for axis in Axis::ALL {
        let [absolute, distance] = axis_letters(axis);
        let (word, adds) = match (running.words.take(absolute), running.words.take(distance)) {
            (None, None) => continue,
            (Some(_), Some(word)) => {
                return fail2(word.at as usize, E::AbsoluteAndIncremental, axis.letter(), word.letter as char);
            }
            (Some(word), None) => (word, running.modals.incremental && running.settings.is_mill()),
            (None, Some(word)) => (word, true),
        };
        let mut value = displayed_mm(running, axis, word)?;
        if adds {
            value += stored_mm(running, variable(axis), word)?;
        }
        write(running, variable(axis), value);
        named = true;
    }
    Ok(named)
}

/// The stored value of a variable in mm. A program under G20 reads origins in inches, offsets of tools in mm.
fn stored_mm(running: &mut BlockContext<'_, '_>, number: u32, word: Word) -> ReadResult<f64> {
    let read = running.scope.read(number, word.at as usize)?.unwrap_or(0.0);
    let in_inches = running.modals.inch && variable::is_origin(number);
    Ok(if in_inches { read * MM_PER_INCH } else { read })
}

/// The value of an axis word in mm as displayed: X a diameter where diameters are programmed.
fn displayed_mm(running: &BlockContext<'_, '_>, axis: Axis, word: Word) -> ReadResult<f64> {
    if !running.settings.axes[axis] {
        return fail1(word.at as usize, E::NoAxis, axis.letter());
    }
    length_mm(running, word)
}

fn write(running: &mut BlockContext<'_, '_>, number: u32, value: f64) {
    running.ops.push(Op::SetSystemVariable { number, value: Some(value) });
}

/// `G52 X_ Z_`: the local zero in the active work offset.
fn local_zero(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let mut values = PerAxis::default();
    let mut named = false;
    for axis in Axis::ALL {
        let [letter, distance] = axis_letters(axis);
        if let Some(word) = running.words.peek(distance) {
            return fail2(word.at as usize, E::NotTogether, "G52", word.letter as char);
        }
        let Some(word) = running.words.take(letter) else { continue };
        values[axis] = Some(axis_value(running, axis, word)?);
        named = true;
    }
    if !named {
        return fail2(code.at as usize, E::MissingWord, "G52", "X / Z");
    }
    running.ops.push(Op::SetLocalZero { values });
    Ok(())
}
