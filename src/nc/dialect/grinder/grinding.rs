//! The grinding functions: G27 dressing point, G35/G36 oscillation, G78 gauge positioning. Source: spec K4.

use super::coordinates::axis_value;
use super::{MAX_VALUE, OneShot, axis_letters, integer, length_mm, out_of_range};
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::op::{AxisSet, GaugeMove, Op};
use crate::nc::words::{Code, ValueKind, Word, letter_mask};
use crate::units::Axis;

/// Number of gauge inputs.
const GAUGE_INPUTS: u32 = 6;

/// How the one-shot functions of this file are read.
pub(super) fn reading_of(code: u32) -> Option<OneShot> {
    Some(match code {
        27 => dress_return,
        35 => oscillation_on,
        36 => oscillation_off,
        78 => gauge_move,
        _ => return None,
    })
}

/// G27 `X Z F_`: axes without numbers; X if there is none, P243 if there is no F (K4.2).
fn dress_return(running: &mut BlockContext<'_, '_>, _code: Code) -> ReadResult<()> {
    let words = running.words;
    let mut axes = AxisSet::NONE;
    for axis in Axis::ALL {
        let [letter, _] = axis_letters(axis);
        let Some(word) = words.take(letter) else { continue };
        if word.kind != ValueKind::AddressOnly {
            return fail2(word.at as usize, E::TakesNoNumber, "G27", axis.letter());
        }
        if !running.settings.axes[axis] {
            return fail1(word.at as usize, E::NoAxis, axis.letter());
        }
        axes.insert(axis);
    }
    let feed = words.take(b'F').map(|word| feed_word(running, word)).transpose()?;
    if axes.is_empty() {
        axes = AxisSet::of(Axis::X);
    }
    running.ops.push(Op::DressReturn { axes, feed });
    Ok(())
}

/// G35 `X_|Z_ D_ Q_` (K4.3); with a cylinder it has no words (K4.4).
pub(super) fn oscillation_on(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let words = running.words;
    if running.settings.oscillation_by_cylinder {
        running.ops.push(Op::OscillationOn { stroke: None, ramp_ms: None, strokes_min: None });
        return Ok(());
    }
    let named = |axis: &Axis| words.take(axis_letters(*axis)[0]).map(|word| (*axis, word));
    let mut ends = [Axis::X, Axis::Z].iter().filter_map(named);
    let Some((axis, word)) = ends.next() else { return fail2(code.at as usize, E::MissingWord, "G35", "X / Z") };
    if let Some((other, second)) = ends.next() {
        return fail2(second.at as usize, E::NotTogether, axis.letter(), other.letter());
    }
    let to = axis_value(running, axis, word)?;
    // K4.3: values below the minimum are raised to it, with a message, when the oscillation starts.
    let bounded = |word: Word| {
        if word.value <= MAX_VALUE { Ok(word.value) } else { out_of_range(word, "≤99999.999") }
    };
    let ramp_ms = words.take(b'D').map(bounded).transpose()?;
    let strokes_min = words.take(b'Q').map(bounded).transpose()?;
    running.ops.push(Op::OscillationOn { stroke: Some((axis, to)), ramp_ms, strokes_min });
    Ok(())
}

/// M35: G35 with words; alone, the oscillation of the key by P238 to P241 (K4.3).
pub(super) fn oscillation_by_m_code(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    if running.settings.oscillation_by_cylinder || running.words.has_any(letter_mask(b"XZUWDQ")) {
        return oscillation_on(running, code);
    }
    let stroke = Some(running.settings.oscillation_stroke);
    running.ops.push(Op::OscillationOn { stroke, ramp_ms: None, strokes_min: None });
    Ok(())
}

/// G36.
fn oscillation_off(running: &mut BlockContext<'_, '_>, _code: Code) -> ReadResult<()> {
    running.ops.push(Op::OscillationOff);
    Ok(())
}

/// G78 `Z_ F_ J_ P_ Q_ L_`; on GS the axis may be Y (K4.5).
fn gauge_move(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let words = running.words;
    let missing = |name: &str| fail2(code.at as usize, E::MissingWord, "G78", name);
    let other = running.settings.is_mill().then(|| words.take(b'Y')).flatten();
    let (axis, word) = match (words.take(b'Z'), other) {
        (Some(word), None) => (Axis::Z, word),
        (None, Some(word)) => (Axis::Y, word),
        (Some(_), Some(word)) => return fail2(word.at as usize, E::NotTogether, "Z", "Y"),
        (None, None) => return missing("Z"),
    };
    let to = axis_value(running, axis, word)?;
    let Some(fast) = words.take(b'F') else { return missing("F") };
    let Some(fine) = words.take(b'J') else { return missing("J") };
    let Some(first) = words.take(b'P') else { return missing("P") };
    let (fast_mm_min, fine_mm_min) = (feed_word(running, fast)?, feed_word(running, fine)?);
    let first_input = integer(first, 1, GAUGE_INPUTS)? as u8;
    let second_input =
        words.take(b'Q').map(|word| integer(word, 1, GAUGE_INPUTS)).transpose()?.map(|signal| signal as u8);
    let retract = words.take(b'L').map(|word| length_mm(running, word).map(|mm| (word, mm))).transpose()?;
    let retract_mm = match retract {
        Some((word, mm)) if mm < 0.0 || second_input.is_none() && mm <= 0.0 => {
            return out_of_range(word, "> 0");
        }
        Some((_, mm)) => mm,
        // A single contact is approached twice, so a retract is required.
        None if second_input.is_none() => return missing("L"),
        None => 0.0,
    };
    let gauging = GaugeMove { axis, to, fast_mm_min, fine_mm_min, first_input, second_input, retract_mm };
    running.ops.push(Op::Gauge(gauging));
    Ok(())
}

/// A feed word, mm/min.
fn feed_word(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let unit = if running.modals.inch { crate::units::MM_PER_INCH } else { 1.0 };
    if word.value <= 0.0 || word.value > MAX_VALUE {
        return out_of_range(word, "0–99999.999");
    }
    Ok(word.value * unit)
}
