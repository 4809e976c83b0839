//! The cycles of GC: G90 along Z and G94 along X in four moves, G70–G73 over a contour of the program, G74 and G75 peck
//! grooving.
//!
//! A first block of G71 to G75 stores modal settings (`G71 U2 R1`); a second block executes the cycle
//! (`G71 P10 Q50 U0.4 W0.1 F80`). Source: spec B2, K1.

use super::coordinates::{axis_value, modal_feed, target};
use super::{MAX_VALUE, OneShot, integer, length_mm, out_of_range};
use crate::defs::text::arg::Arg;
use crate::nc::contour::{ContourCycle, CycleKind};
use crate::nc::dialect::move_target::MoveTarget;
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::op::{AxisSet, Feed, Op};
use crate::nc::words::{Code, ValueKind, Word};
use crate::units::{Axis, MM_PER_INCH, PerAxis, WorkPos};

/// Most passes of G73.
const MAX_PASSES: u32 = 1_000;
/// Most pecks of G74 and G75.
const MAX_PECKS: usize = 5_000;
/// Unit of P and Q of G74 and G75 without a decimal point, mm.
const INCREMENT_MM: f64 = 0.001;
/// The same under G20, inches.
const INCREMENT_INCH: f64 = 0.0001;
/// Shorter distances count as zero, mm.
const MIN_LENGTH_MM: f64 = 1e-7;

/// G90: X in at rapid, Z at feed (taper R: start radius minus end radius), X out at feed, Z back at rapid.
pub(super) fn longitudinal(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    push_cycle(running, Axis::X, Axis::Z)
}

/// G94: Z in at rapid, X at feed (taper R in Z), Z out at feed, X back at rapid.
pub(super) fn face(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    push_cycle(running, Axis::Z, Axis::X)
}

fn push_cycle(running: &mut BlockContext<'_, '_>, infeed: Axis, stroke: Axis) -> ReadResult<()> {
    let MoveTarget { from, to, words, incremental } = target(running)?;
    let mut kept = running.modals.cycle;
    if words.contains(Axis::X) {
        kept.x = Some(to[Axis::X]);
    }
    if words.contains(Axis::Z) {
        kept.z = Some(to[Axis::Z]);
    }
    if let Some(taper) = running.words.take(b'R') {
        kept.taper = length_mm(running, taper)?;
    }
    let g = running.modals.motion.g();
    let (Some(x), Some(z)) = (kept.x, kept.z) else {
        let missing = if kept.x.is_none() { "X / U" } else { "Z / W" };
        return fail2(running.at, E::TurningCycleWord, format_args!("G{g:02}"), missing);
    };
    let feed = modal_feed(running)?;
    running.modals.cycle = kept;
    let with = |base: WorkPos, axis: Axis, value: f64| {
        let mut point = base;
        point[axis] = value;
        point
    };
    let end = with(with(from, Axis::X, x), Axis::Z, z);
    let start = with(from, infeed, end[infeed] + kept.taper);
    let out = with(end, infeed, from[infeed]);
    let by = |axes: AxisSet| axes.intersection(incremental);
    let (one, other) = (AxisSet::of(infeed), AxisSet::of(stroke));
    running.ops.push(Op::Rapid { to: start, feed: None, words: one, incremental: by(one) });
    running.ops.push(Op::Feed { to: end, feed, words: one.with(other), incremental: by(one.with(other)) });
    running.ops.push(Op::Feed { to: out, feed, words: one, incremental: by(one) });
    running.ops.push(Op::Rapid { to: from, feed: None, words: other, incremental: by(other) });
    Ok(())
}

/// How the one-shot functions of this file are read.
pub(super) fn reading_of(code: u32) -> Option<OneShot> {
    Some(match code {
        74 | 75 => grooving_cycle,
        _ => return None,
    })
}

/// Whether a code is a contour cycle.
pub(super) const fn is_contour_cycle(code: u32) -> bool {
    matches!(code, 70..=73)
}

/// Whether a code is a grooving cycle: many moves that are no contour.
pub(super) const fn is_grooving(code: u32) -> bool {
    matches!(code, 74 | 75)
}

/// Depth, allowance or retract of a cycle above which a decimal point is missing, mm.
const MAX_WITHOUT_POINT_MM: f64 = 100.0;

/// G70 to G73: stores the settings of the block, or returns the cycle to execute.
pub(super) fn contour_cycle(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<Option<ContourCycle>> {
    let (code, at) = (code.number, code.at as usize);
    let name = || Arg::from(format_args!("G{code}"));
    if let Some(word) = b"ABDHIK".iter().find_map(|letter| running.words.peek(*letter)) {
        return fail2(word.at as usize, E::ForeignCycle, name(), char::from(word.letter));
    }
    let (first, last) = (running.words.take(b'P'), running.words.take(b'Q'));
    let (first, last) = match (first, last) {
        (None, None) if code != 70 => return store_settings(running, code, at).map(|()| None),
        (Some(first), Some(last)) => (integer(first, 1, 99_999_999)?, integer(last, 1, 99_999_999)?),
        (first, _) => return fail2(at, E::MissingWord, name(), if first.is_none() { "P" } else { "Q" }),
    };
    if let Some(code) = running.words.m.first() {
        return fail2(code.at as usize, E::NotTogether, name(), format_args!("M{:02}", code.number));
    }
    let kept = running.modals.repetitive;
    let mut allowance = PerAxis::default();
    refuse_missing_points(running)?;
    if code != 70 {
        let given = [(b'U', Axis::X), (b'W', Axis::Z)].map(|(letter, axis)| (running.words.take(letter), axis));
        for (word, axis) in given {
            allowance[axis] = word.map_or(Ok(0.0), |word| axis_value(running, axis, word))?;
        }
    }
    let form = match code {
        70 => CycleKind::Finish,
        73 => {
            let (Some((x, z)), Some(passes)) = (kept.shift, kept.passes) else {
                return fail2(at, E::FirstBlockMissing, "G73 P Q", "G73 U W R");
            };
            CycleKind::Pattern { shift: PerAxis([x, 0.0, z]), passes, feed: modal_feed(running)? }
        }
        _ => {
            let (infeed, form, first) =
                if code == 71 { (Axis::X, "G71 P Q", "G71 U R") } else { (Axis::Z, "G72 P Q", "G72 W R") };
            let Some(depth) = kept.depth else { return fail2(at, E::FirstBlockMissing, form, first) };
            CycleKind::Roughing { infeed, depth, escape: kept.escape, feed: modal_feed(running)? }
        }
    };
    Ok(Some(ContourCycle { first_block: first, last_block: last, at, allowance, kind: form }))
}

/// Refuses U, W and R without a decimal point that are read as millimetres and are larger than any cut: their program was
/// written for a control that counts them in thousandths.
fn refuse_missing_points(running: &BlockContext<'_, '_>) -> ReadResult<()> {
    if running.settings.least_increment_mm.is_some() {
        return Ok(());
    }
    for word in b"UWR".iter().filter_map(|letter| running.words.peek(*letter)) {
        if word.kind == ValueKind::Integer && length_mm(running, word)?.abs() > MAX_WITHOUT_POINT_MM {
            return fail1(word.at as usize, E::PointMissing, format_args!("{}{}", char::from(word.letter), word.value));
        }
    }
    Ok(())
}

/// A block without P and Q: stores the settings.
fn store_settings(running: &mut BlockContext<'_, '_>, code: u32, at: usize) -> ReadResult<()> {
    let words = running.words;
    let (u, w, r) = (words.take(b'U'), words.take(b'W'), words.take(b'R'));
    refuse_missing_points(running)?;
    let mut kept = running.modals.repetitive;
    if code == 73 {
        let of = |word: Option<Word>| word.map_or(Ok(0.0), |word| length_mm(running, word));
        if u.is_none() && w.is_none() {
            return fail2(at, E::MissingWord, "G73", "U / W");
        }
        kept.shift = Some((of(u)?, of(w)?));
        kept.passes = r.map(|word| integer(word, 1, MAX_PASSES)).transpose()?.or(kept.passes);
        if kept.passes.is_none() {
            return fail2(at, E::MissingWord, "G73", "R");
        }
    } else {
        let (depth, stray, letter) = if code == 71 { (u, w, "U") } else { (w, u, "W") };
        let Some(word) = depth else { return fail2(at, E::MissingWord, format_args!("G{code}"), letter) };
        if let Some(stray) = stray {
            return fail1(stray.at as usize, E::UnknownWord, char::from(stray.letter));
        }
        kept.depth = Some(positive_length(running, word)?);
        if let Some(word) = r {
            kept.escape = non_negative_length(running, word)?;
        }
    }
    running.modals.repetitive = kept;
    Ok(())
}

/// G74 pecks along Z and steps along X; G75 pecks along X and steps along Z.
fn grooving_cycle(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let (code, at) = (code.number, code.at as usize);
    let (peck, step) = if code == 74 { (Axis::Z, Axis::X) } else { (Axis::X, Axis::Z) };
    if let Some(word) = b"DHIK".iter().find_map(|letter| running.words.peek(*letter)) {
        return fail2(word.at as usize, E::ForeignCycle, format_args!("G{code}"), char::from(word.letter));
    }
    let MoveTarget { from, to, words, .. } = target(running)?;
    let relief = running.words.take(b'R');
    if words.is_empty() {
        let Some(word) = relief else { return fail2(at, E::MissingWord, format_args!("G{code}"), "X / Z / R") };
        running.modals.repetitive.peck_back = non_negative_length(running, word)?;
        return Ok(());
    }
    let axis_word = if peck == Axis::X { "X / U" } else { "Z / W" };
    if !words.contains(peck) {
        return fail2(at, E::MissingWord, format_args!("G{code}"), axis_word);
    }
    let (p, q) = (running.words.take(b'P'), running.words.take(b'Q'));
    let moves_aside = (to[step] - from[step]).abs() > MIN_LENGTH_MM;
    let (of_peck, of_step) = if code == 74 { (q, p) } else { (p, q) };
    // `G74 Z-70 P0 Q10000`: one hole has no step.
    let of_step = of_step.filter(|word| moves_aside || word.value.abs() > 0.0);
    let groove = GroovingCycle {
        peck,
        step,
        from,
        to,
        peck_depth: of_peck.map(|word| increment_mm(running, word)).transpose()?,
        step_width: of_step.map(|word| increment_mm(running, word)).transpose()?,
        peck_back: running.modals.repetitive.peck_back,
        relief: relief.map_or(Ok(0.0), |word| length_mm(running, word))?,
        feed: modal_feed(running)?,
    };
    if moves_aside && groove.step_width.is_none() {
        let letter = if code == 74 { "P" } else { "Q" };
        return fail2(at, E::MissingWord, format_args!("G{code}"), letter);
    }
    if let (Some(word), Some(step)) = (relief, groove.step_width.filter(|_| moves_aside))
        && groove.relief.abs() > step.min((to[groove.step] - from[groove.step]).abs())
    {
        // It would go at rapid beyond what is cut.
        return out_of_range(word, if code == 74 { "≤P" } else { "≤Q" });
    }
    groove.push_ops(running, at)
}

struct GroovingCycle {
    peck: Axis,
    step: Axis,
    from: WorkPos,
    to: WorkPos,
    /// Depth of a peck; none: one cut to full depth.
    peck_depth: Option<f64>,
    step_width: Option<f64>,
    peck_back: f64,
    relief: f64,
    feed: Feed,
}

impl GroovingCycle {
    fn push_ops(&self, running: &mut BlockContext<'_, '_>, at: usize) -> ReadResult<()> {
        let (peck, step) = (self.peck, self.step);
        let (one, side) = (AxisSet::of(peck), AxisSet::of(step));
        let rapid = |to, words| Op::Rapid { to, feed: None, words, incremental: AxisSet::NONE };
        let cut = |to| Op::Feed { to, feed: self.feed, words: one, incremental: AxisSet::NONE };
        let way = |axis: Axis| self.to[axis] - self.from[axis];
        let mut place = self.from;
        let mut count = 0;
        for across in positions_in_steps(self.from[step], self.to[step], self.step_width) {
            place[step] = across;
            running.ops.push(rapid(place, side));
            for depth in positions_in_steps(self.from[peck], self.to[peck], self.peck_depth).into_iter().skip(1) {
                place[peck] = depth;
                running.ops.push(cut(place));
                if (self.to[peck] - depth).abs() > MIN_LENGTH_MM && self.peck_back > 0.0 {
                    place[peck] -= self.peck_back.copysign(way(peck));
                    running.ops.push(rapid(place, one));
                }
                count += 1;
                if count > MAX_PECKS {
                    return fail1(at, E::ContourStrokes, "");
                }
            }
            // At the bottom, relief away from the cut wall, towards the start of the groove.
            if self.relief.abs() > MIN_LENGTH_MM && (across - self.from[step]).abs() > MIN_LENGTH_MM {
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
fn positions_in_steps(from: f64, to: f64, by: Option<f64>) -> Vec<f64> {
    let way = to - from;
    let mut all = vec![from];
    if way.abs() <= MIN_LENGTH_MM {
        return all;
    }
    let by = by.unwrap_or(way.abs());
    let mut number = 1.0;
    while by * number < way.abs() - MIN_LENGTH_MM && all.len() <= MAX_PECKS {
        all.push(from + (by * number).copysign(way));
        number += 1.0;
    }
    all.push(to);
    all
}

/// P and Q: least increments without a decimal point, millimetres or inches with one; radius, greater than zero.
fn increment_mm(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let value = match word.kind {
        ValueKind::Integer if running.modals.inch => word.value * INCREMENT_INCH * MM_PER_INCH,
        ValueKind::Integer => word.value * INCREMENT_MM,
        ValueKind::Decimal | ValueKind::Null | ValueKind::AddressOnly => length_mm(running, word)?,
    };
    check_positive(word, value)
}

fn positive_length(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    check_positive(word, length_mm(running, word)?)
}

fn check_positive(word: Word, value: f64) -> ReadResult<f64> {
    if value > 0.0 && value <= MAX_VALUE { Ok(value) } else { out_of_range(word, ">0") }
}

fn non_negative_length(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let value = length_mm(running, word)?;
    if value >= 0.0 { Ok(value) } else { out_of_range(word, "≥0") }
}
