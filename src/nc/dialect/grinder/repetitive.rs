//! The repetitive cycles of GC: G70–G73 over a contour of the program, G74 and G75 peck grooving.
//!
//! A first block stores modal settings (`G71 U2 R1`); a second block executes the cycle
//! (`G71 P10 Q50 U0.4 W0.1 F80`). Source: spec B2, K1.

use super::motion::{Target, code_place, feed, target};
use super::{LIMIT, integer, length, out_of_range};
use crate::defs::program_error::ProgramError as E;
use crate::nc::contour::{ContourCycle, Form};
use crate::nc::dialect::Running;
use crate::nc::fault::{Outcome, wrong1, wrong2};
use crate::nc::op::{AxisSet, Feed, Op};
use crate::nc::words::{Kind, Word};
use crate::units::{Axis, PerAxis};

/// Most passes of G73.
const PASSES: u32 = 1_000;
/// Most pecks of G74 and G75.
const PECKS: usize = 5_000;
/// Unit of P and Q of G74 and G75 without a decimal point, mm.
const LEAST_MM: f64 = 0.001;
/// Shorter distances count as zero, mm.
const NO_WAY_MM: f64 = 1e-7;

/// The stored settings of the cycles, radius mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RepeatWords {
    /// G71, G72: depth of a stroke and retract at 45°.
    depth: Option<f64>,
    escape: f64,
    /// G73: stock to remove in X and Z, and the number of passes.
    shift: Option<(f64, f64)>,
    passes: Option<u32>,
    /// G74, G75: retract of a peck.
    peck_back: f64,
}

/// Whether a code is a contour cycle.
pub(super) const fn is_contour_cycle(code: u32) -> bool {
    matches!(code, 70..=73)
}

/// G70 to G73: stores the settings of the block, or returns the cycle to execute.
pub(super) fn contour(running: &mut Running<'_, '_>, code: u32) -> Outcome<Option<Box<ContourCycle>>> {
    let at = code_place(running, code);
    let name = format!("G{code}");
    let (first, last) = (running.words.take(b'P'), running.words.take(b'Q'));
    let (first, last) = match (first, last) {
        (None, None) if code != 70 => return settings(running, code, at).map(|()| None),
        (Some(first), Some(last)) => (integer(first, 1, 99_999_999)?, integer(last, 1, 99_999_999)?),
        (first, _) => return wrong2(at, E::MissingWord, name, if first.is_none() { "P" } else { "Q" }),
    };
    if let Some(code) = running.words.m().first() {
        return wrong2(code.at as usize, E::NotTogether, name, format!("M{:02}", code.number));
    }
    let kept = running.modals.repeat;
    let mut allowance = PerAxis::default();
    if code != 70 {
        let given = [(b'U', Axis::X), (b'W', Axis::Z)].map(|(letter, axis)| (running.words.take(letter), axis));
        for (word, axis) in given {
            allowance[axis] = word.map_or(Ok(0.0), |word| super::motion::axis_value(running, axis, word))?;
        }
    }
    let form = match code {
        70 => Form::Finish,
        73 => {
            let (Some((x, z)), Some(passes)) = (kept.shift, kept.passes) else {
                return wrong2(at, E::MissingWord, name, "U W R");
            };
            Form::Pattern { shift: PerAxis([x, 0.0, z]), passes, feed: feed(running)? }
        }
        _ => {
            let (infeed, letter) = if code == 71 { (Axis::X, "U") } else { (Axis::Z, "W") };
            let Some(depth) = kept.depth else { return wrong2(at, E::MissingWord, name, letter) };
            Form::Rough { infeed, depth, escape: kept.escape, feed: feed(running)? }
        }
    };
    Ok(Some(Box::new(ContourCycle { first, last, at, allowance, form })))
}

/// A block without P and Q: stores the settings.
fn settings(running: &mut Running<'_, '_>, code: u32, at: usize) -> Outcome<()> {
    let words = running.words;
    let (u, w, r) = (words.take(b'U'), words.take(b'W'), words.take(b'R'));
    let mut kept = running.modals.repeat;
    if code == 73 {
        let of = |word: Option<Word>| word.map_or(Ok(0.0), |word| length(running, word));
        if u.is_none() && w.is_none() {
            return wrong2(at, E::MissingWord, "G73", "U / W");
        }
        kept.shift = Some((of(u)?, of(w)?));
        kept.passes = r.map(|word| integer(word, 1, PASSES)).transpose()?.or(kept.passes);
        if kept.passes.is_none() {
            return wrong2(at, E::MissingWord, "G73", "R");
        }
    } else {
        let (depth, stray, letter) = if code == 71 { (u, w, "U") } else { (w, u, "W") };
        if let Some(stray) = stray {
            return wrong1(stray.at as usize, E::UnknownWord, char::from(stray.letter));
        }
        let Some(word) = depth else { return wrong2(at, E::MissingWord, format!("G{code}"), letter) };
        kept.depth = Some(positive(running, word)?);
        if let Some(word) = r {
            kept.escape = not_negative(running, word)?;
        }
    }
    running.modals.repeat = kept;
    Ok(())
}

/// G74 pecks along Z and steps along X; G75 pecks along X and steps along Z.
pub(super) fn groove(running: &mut Running<'_, '_>, code: u32) -> Outcome<()> {
    let at = code_place(running, code);
    let (peck, step) = if code == 74 { (Axis::Z, Axis::X) } else { (Axis::X, Axis::Z) };
    let from = running.scope.position();
    let Target { to, words, .. } = target(running, from)?;
    let relief = running.words.take(b'R');
    if words.is_empty() {
        let Some(word) = relief else { return wrong2(at, E::MissingWord, format!("G{code}"), "X / Z / R") };
        running.modals.repeat.peck_back = not_negative(running, word)?;
        return Ok(());
    }
    let axis_word = if peck == Axis::X { "X / U" } else { "Z / W" };
    if !words.contains(peck) {
        return wrong2(at, E::MissingWord, format!("G{code}"), axis_word);
    }
    let (p, q) = (running.words.take(b'P'), running.words.take(b'Q'));
    let (of_peck, of_step) = if code == 74 { (q, p) } else { (p, q) };
    let groove = Groove {
        peck,
        step,
        from,
        to,
        depth: of_peck.map(|word| increment(running, word)).transpose()?,
        width: of_step.map(|word| increment(running, word)).transpose()?,
        back: running.modals.repeat.peck_back,
        relief: relief.map_or(Ok(0.0), |word| length(running, word))?,
        feed: feed(running)?,
    };
    if (to[step] - from[step]).abs() > NO_WAY_MM && groove.width.is_none() {
        let letter = if code == 74 { "P" } else { "Q" };
        return wrong2(at, E::MissingWord, format!("G{code}"), letter);
    }
    groove.hand_out(running, at)
}

struct Groove {
    peck: Axis,
    step: Axis,
    from: PerAxis<f64>,
    to: PerAxis<f64>,
    /// Depth of a peck; none: one cut to full depth.
    depth: Option<f64>,
    width: Option<f64>,
    back: f64,
    relief: f64,
    feed: Feed,
}

impl Groove {
    fn hand_out(&self, running: &mut Running<'_, '_>, at: usize) -> Outcome<()> {
        let (peck, step) = (self.peck, self.step);
        let (one, side) = (AxisSet::of(peck), AxisSet::of(step));
        let rapid = |to, words| Op::Rapid { to, feed: None, words, incremental: AxisSet::NONE };
        let cut = |to| Op::Feed { to, feed: self.feed, words: one, incremental: AxisSet::NONE };
        let way = |axis: Axis| self.to[axis] - self.from[axis];
        let mut place = self.from;
        let mut count = 0;
        for across in stations(self.from[step], self.to[step], self.width) {
            place[step] = across;
            running.ops.push(rapid(place, side));
            for depth in stations(self.from[peck], self.to[peck], self.depth).into_iter().skip(1) {
                place[peck] = depth;
                running.ops.push(cut(place));
                if (self.to[peck] - depth).abs() > NO_WAY_MM && self.back > 0.0 {
                    place[peck] -= self.back.copysign(way(peck));
                    running.ops.push(rapid(place, one));
                }
                count += 1;
                if count > PECKS {
                    return wrong1(at, E::ContourStrokes, "");
                }
            }
            // At the bottom, relief away from the cut wall, towards the start of the groove.
            if self.relief.abs() > NO_WAY_MM && (across - self.from[step]).abs() > NO_WAY_MM {
                place[step] -= self.relief.copysign(way(step));
                running.ops.push(rapid(place, side));
            }
            place[peck] = self.from[peck];
            running.ops.push(rapid(place, one));
        }
        running.ops.push(rapid(self.from, side));
        Ok(())
    }
}

/// Positions from `from` to `to` in steps of at most `by`, both ends included.
fn stations(from: f64, to: f64, by: Option<f64>) -> Vec<f64> {
    let way = to - from;
    let mut all = vec![from];
    if way.abs() <= NO_WAY_MM {
        return all;
    }
    let by = by.unwrap_or(way.abs());
    let mut number = 1.0;
    while by * number < way.abs() - NO_WAY_MM && all.len() <= PECKS {
        all.push(from + (by * number).copysign(way));
        number += 1.0;
    }
    all.push(to);
    all
}

/// P and Q: least increments without a decimal point, millimetres with one; radius, greater than zero.
fn increment(running: &Running<'_, '_>, word: Word) -> Outcome<f64> {
    let value = match word.kind {
        Kind::Digits => word.value * LEAST_MM,
        Kind::Exact | Kind::Null | Kind::Bare => length(running, word)?,
    };
    above_zero(word, value)
}

fn positive(running: &Running<'_, '_>, word: Word) -> Outcome<f64> {
    above_zero(word, length(running, word)?)
}

fn above_zero(word: Word, value: f64) -> Outcome<f64> {
    if value > 0.0 && value <= LIMIT { Ok(value) } else { out_of_range(char::from(word.letter), word, ">0") }
}

fn not_negative(running: &Running<'_, '_>, word: Word) -> Outcome<f64> {
    let value = length(running, word)?;
    if value >= 0.0 { Ok(value) } else { out_of_range(char::from(word.letter), word, "≥0") }
}
