//! G32 and G33: a thread of length W along Z, with taper U and a run-out. Source: spec L5, seed 5.1.6.

use super::motion::coordinate;
use super::out_of_range;
use crate::defs::text::arg::Arg;
use crate::nc::dialect::common::in_range;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{Op, ThreadMove};
use crate::nc::words::Word;
use crate::units::{Axis, MM_PER_INCH};

/// Range of the lead of G33, mm.
const LEAD_RANGE_MM: (f64, f64) = (0.25, 12.0);
/// Range of G32, turns per inch.
const TURNS_PER_INCH_RANGE: (f64, f64) = (3.0, 33.5);
/// Length of the run-out along Z, mm: the tool retracts there.
const RUN_OUT_MM: f64 = 1.2;
/// Approach length before the part, in leads.
const APPROACH_LEADS: f64 = 3.0;

/// A thread from the present position.
pub(super) fn execute(running: &mut BlockContext<'_, '_>, place: usize) -> ReadResult<()> {
    let words = running.words;
    if let Some(word) = [b'X', b'Z'].into_iter().find_map(|letter| words.peek(letter)) {
        return fail2(word.at as usize, E::IncrementalOnly, char::from(word.letter), "");
    }
    let code = if running.modals.motion == MotionMode::InchThread { "G32" } else { "G33" };
    let Some(length) = words.take(b'W') else { return fail2(place, E::MissingWord, code, "W") };
    let lead = match words.take(b'F') {
        Some(word) if code == "G32" => MM_PER_INCH / turns_per_inch(running, word)?,
        Some(word) => in_range(word, LEAD_RANGE_MM, " mm")?,
        None => match running.modals.thread_lead_mm {
            Some(lead) => lead,
            None => return fail2(place, E::MissingWord, code, "F"),
        },
    };
    let along = coordinate(Axis::Z, length)?;
    if along.abs() <= RUN_OUT_MM {
        let (length_mm, run_out) = (format_args!("{}", along.abs()), format_args!("{RUN_OUT_MM}"));
        return fail2(length.at as usize, E::ThreadTooShort, length_mm, run_out);
    }
    let taper = words.take(b'U').map_or(Ok(0.0), |word| coordinate(Axis::X, word))?;
    if running.modals.infeed_direction == 0 {
        return fail(place, E::ThreadWithoutInfeed);
    }
    warn_about_thread(running, place, lead, along);
    let from = running.scope.position();
    let (mut out, mut to) = (from, from);
    let share = 1.0 - RUN_OUT_MM / along.abs();
    out[Axis::X] += taper * share;
    out[Axis::Z] += along * share;
    // Retracts by 2 · lead + 2 mm on the diameter, against the last infeed.
    to[Axis::X] += taper - f64::from(running.modals.infeed_direction) * (lead + 1.0);
    to[Axis::Z] += along;
    running.modals.thread_lead_mm = Some(lead);
    running.ops.push(Op::Thread(ThreadMove { to, run_out_start: out, lead_mm: lead }));
    Ok(())
}

/// Turns per inch. The digits after the point are the denominator of a fraction: 33.2 is 33½.
fn turns_per_inch(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let written = running.text.get(word.at as usize + 1..).unwrap_or_default();
    let digits = |bytes: &[u8]| -> usize { bytes.iter().take_while(|byte| byte.is_ascii_digit()).count() };
    let blanks = written.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'+')).count();
    let written = &written[blanks..];
    let whole = digits(written);
    let after = written.get(whole..).filter(|rest| rest.first() == Some(&b'.')).map_or(&[][..], |rest| &rest[1..]);
    let number = |bytes: &[u8]| bytes.iter().fold(0.0, |sum, digit| sum * 10.0 + f64::from(digit - b'0'));
    let denominator = number(&after[..digits(after)]);
    let fraction = match denominator {
        none if none < 1.0 => 0.0,
        denominator if denominator >= 2.0 => 1.0 / denominator,
        _ => return fail1(word.at as usize, E::ThreadFraction, format_args!("F{}", word.value)),
    };
    let turns = number(&written[..whole]) + fraction;
    if word.value < 0.0 || !(TURNS_PER_INCH_RANGE.0..=TURNS_PER_INCH_RANGE.1).contains(&turns) {
        return out_of_range(word, "3–33.2 (33½)");
    }
    Ok(turns)
}

/// Run-up distance of Z to `speed` (mm/s) by acceleration and jerk, mm: half of `speed` times the run-up time.
fn run_up_mm(speed: f64, (accel, jerk): (f64, f64)) -> f64 {
    let seconds =
        if speed * jerk <= accel * accel { 2.0 * (speed / jerk).sqrt() } else { speed / accel + accel / jerk };
    speed * seconds / 2.0
}

/// Warnings about approach length and spindle speed, for a check. The run monitors the spindle itself.
fn warn_about_thread(running: &mut BlockContext<'_, '_>, place: usize, lead: f64, along: f64) {
    let z = running.scope.position()[Axis::Z];
    let speed = running.modals.speed.unwrap_or(running.settings.superman.spindle_rpm);
    // Note 5: the approach is at least three leads, and at least the run-up of the axis.
    let run_up = run_up_mm(lead * speed / 60.0, running.settings.superman.z_accel_jerk);
    let needed = (APPROACH_LEADS * lead).max(run_up);
    // The part's face is at Z 0, if the thread crosses it.
    let enters = if along < 0.0 { z >= 0.0 && z + along < 0.0 } else { z <= 0.0 && z + along > 0.0 };
    if enters && z.abs() < needed {
        let details = [format_args!("{:.3}", z.abs()).into(), format_args!("{needed:.3}").into()];
        running.scope.warn(place, E::ThreadApproachShort, details);
    }
    if !running.modals.spindle_on {
        running.scope.warn(place, E::ThreadSpindle, [Arg::None, Arg::None]);
    }
    let limit = ThreadMove::max_spindle_rpm(lead);
    if speed > limit {
        let details = [format_args!("{speed}").into(), format_args!("{limit:.0}").into()];
        running.scope.warn(place, E::SpindleTooFast, details);
    }
}
