//! Rapids, lines, arcs, the rectangle cycle, dwell, G92 and moves to fixed points. Source: spec L2–L4, L6.

use super::{MAX_COORDINATE_MM, out_of_range};
use crate::nc::dialect::common::in_range;
use crate::nc::dialect::motion::ArcEnds;
use crate::nc::dialect::move_target::{MoveTarget, NO_LETTER, refuse_both};
use crate::nc::dialect::rules::BlockContext;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{AxisSet, Feed, Op};
use crate::nc::words::{BlockWords, Code, Word};
use crate::units::{Axis, PerAxis, Plane, WorkPos};

/// Ranges of F, mm/min on Z: G00, G01 and G23, G02 and G03.
const RAPID_FEED_RANGE: (f64, f64) = (2_000.0, 6_000.0);
const LINE_FEED_RANGE: (f64, f64) = (6.0, 2_000.0);
const ARC_FEED_RANGE: (f64, f64) = (6.0, 600.0);
/// Range of G04, seconds. The manual's text says 9999.99, its table 99.99; the text applies (D).
const DWELL_RANGE_S: (f64, f64) = (0.01, 9_999.99);
/// An arc's radius must be greater than this, mm.
const MIN_RADIUS_MM: f64 = 0.2;
/// The end error of an arc must be below this many increments.
const MAX_END_ERROR_INCREMENTS: f64 = 5.0;
/// Rounding of a programmed radius, mm.
const RADIUS_ROUNDING_MM: f64 = 0.01;
/// Shorter lengths count as zero, mm.
const MIN_LENGTH_MM: f64 = 1e-9;

/// The absolute and the incremental word of X and of Z.
const AXIS_ADDRESSES: [[u8; 2]; 2] = [[b'X', b'U'], [b'Z', b'W']];

/// Refuses X with U and Z with W (L1).
pub(super) fn check_one_word_per_axis(words: &BlockWords) -> ReadResult<()> {
    let both = AXIS_ADDRESSES.into_iter().find(|letters| letters.iter().all(|letter| words.has(*letter)));
    both.map_or(Ok(()), |letters| refuse_both(words, letters))
}

/// The end of the move by the axis words of the block.
pub(super) fn target(running: &BlockContext<'_, '_>) -> ReadResult<MoveTarget> {
    check_one_word_per_axis(running.words)?;
    let letters = |axis| match axis {
        Axis::X => [b'X', b'U'],
        Axis::Y => [NO_LETTER; 2],
        Axis::Z => [b'Z', b'W'],
    };
    MoveTarget::read(running, letters, coordinate, f64::INFINITY)
}

/// The value of an axis word, radius mm.
pub(super) fn coordinate(axis: Axis, word: Word) -> ReadResult<f64> {
    if word.value.abs() > MAX_COORDINATE_MM {
        return out_of_range(word, "±9999.99");
    }
    Ok(if axis == Axis::X { word.value / 2.0 } else { word.value })
}

const fn feed_range(motion: MotionMode) -> (f64, f64) {
    match motion {
        MotionMode::Rapid => RAPID_FEED_RANGE,
        MotionMode::ArcClockwise | MotionMode::ArcCounterClockwise => ARC_FEED_RANGE,
        _ => LINE_FEED_RANGE,
    }
}

/// Checks a feed against the range of a motion (L2).
pub(super) fn check_feed(word: Word, motion: MotionMode) -> ReadResult<()> {
    in_range(word, feed_range(motion), " mm/min").map(drop)
}

/// F of the block, checked against the range of the active function. The F of G00 is not modal.
pub(super) fn take_feed(running: &mut BlockContext<'_, '_>) -> ReadResult<Option<f64>> {
    let Some(word) = running.words.take(b'F') else { return Ok(None) };
    check_feed(word, running.modals.motion)?;
    if running.modals.motion != MotionMode::Rapid {
        running.modals.feed = Some(word.value);
    }
    Ok(Some(word.value))
}

/// The active feed of lines, else the parameter's.
fn line_feed(running: &BlockContext<'_, '_>) -> f64 {
    running.modals.feed.unwrap_or(running.settings.superman.line_feed)
}

/// Feed along a line: F, reduced so that X moves at no more than half of F.
fn feed_along(feed: f64, from: WorkPos, to: WorkPos) -> Feed {
    let (x, z) = ((to[Axis::X] - from[Axis::X]).abs(), to[Axis::Z] - from[Axis::Z]);
    let length = x.hypot(z);
    let most = if x > MIN_LENGTH_MM { feed / 2.0 * length / x } else { feed };
    Feed::PerMinute(feed.min(most))
}

/// Records the direction of X, for the run-out of a thread.
fn record_infeed(running: &mut BlockContext<'_, '_>, from: WorkPos, to: WorkPos) {
    let by = to[Axis::X] - from[Axis::X];
    if by.abs() > MIN_LENGTH_MM {
        running.modals.infeed_direction = if by > 0.0 { 1 } else { -1 };
    }
}

/// G00: both axes move in a fixed speed ratio, then one axis completes its distance.
pub(super) fn rapid(running: &mut BlockContext<'_, '_>, feed: Option<f64>) -> ReadResult<()> {
    let target = target(running)?;
    let MoveTarget { from, to, incremental, .. } = target;
    record_infeed(running, from, to);
    let (x, z) = (to[Axis::X] - from[Axis::X], to[Axis::Z] - from[Axis::Z]);
    let ratio = running.settings.superman.rapid_z_per_x;
    let both = x.abs().min(z.abs() / ratio);
    let (over_x, over_z) = (x.abs() - both, z.abs() - both * ratio);
    let mut corner = from;
    corner[Axis::X] += both.copysign(x);
    corner[Axis::Z] += (both * ratio).copysign(z);
    if both <= MIN_LENGTH_MM || over_x.max(over_z) <= MIN_LENGTH_MM {
        push_rapid(running, target, feed);
        return Ok(());
    }
    push_rapid(running, MoveTarget { to: corner, ..target }, feed);
    // The axis that is in position is not named again.
    let left = AxisSet::of(if over_x > over_z { Axis::X } else { Axis::Z });
    let rest = MoveTarget { from: corner, to, words: left, incremental: incremental.intersection(left) };
    push_rapid(running, rest, feed);
    Ok(())
}

/// Adds a rapid; with F, at that feed.
fn push_rapid(running: &mut BlockContext<'_, '_>, target: MoveTarget, feed: Option<f64>) {
    let MoveTarget { from, to, words, incremental } = target;
    let feed = feed.map(|feed| feed_along(feed, from, to));
    running.ops.push(Op::Rapid { to, feed, words, incremental });
}

/// G01.
pub(super) fn line(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let MoveTarget { from, to, words, incremental } = target(running)?;
    record_infeed(running, from, to);
    let feed = feed_along(line_feed(running), from, to);
    running.ops.push(Op::Feed { to, feed, words, incremental });
    Ok(())
}

/// G02 (`iso_turn` −1) and G03 (1): I (a diameter) and K from the start, or R (negative: major arc).
pub(super) fn arc_move(running: &mut BlockContext<'_, '_>, place: usize, iso_turn: i8) -> ReadResult<()> {
    // L2: the manual draws X down to the operator; with X drawn up its G02 is the clockwise one of ISO.
    let turn = if running.settings.superman.arcs_reversed { -iso_turn } else { iso_turn };
    let MoveTarget { from, to, words, incremental } = target(running)?;
    let offsets = [running.words.take(b'I'), running.words.take(b'K')];
    let center = match (offsets, running.words.take(b'R')) {
        ([None, None], None) => return fail2(place, E::ArcWithoutCentre, "R", "I K"),
        ([None, None], Some(radius)) => centre_from_r(from, to, radius, turn)?,
        ([i, k], None) => centre_by_offsets(running, place, (from, to), [i, k])?,
        ([i, k], Some(radius)) => {
            let other = i.or(k).map_or('I', |word| char::from(word.letter));
            return fail2(radius.at as usize, E::NotTogether, "R", other);
        }
    };
    // A feed from lines may be too fast for an arc; the parameter's feed then applies.
    let turning = &running.settings.superman;
    let feed = running.modals.feed.filter(|feed| *feed <= ARC_FEED_RANGE.1).unwrap_or(turning.arc_feed);
    let feed = Feed::PerMinute(feed);
    running.ops.push(Op::Arc { to, center, plane: Plane::Zx, turn, feed, words, incremental });
    Ok(())
}

fn check_radius(at: usize, radius: f64) -> ReadResult<()> {
    if radius > MIN_RADIUS_MM {
        return Ok(());
    }
    fail2(at, E::ArcTooSmall, format_args!("{radius:.3}"), format_args!("{MIN_RADIUS_MM}"))
}

fn centre_by_offsets(
    running: &BlockContext<'_, '_>,
    place: usize,
    (from, to): (WorkPos, WorkPos),
    offsets: [Option<Word>; 2],
) -> ReadResult<WorkPos> {
    let mut center = from;
    for (axis, word) in [Axis::X, Axis::Z].into_iter().zip(offsets) {
        if let Some(word) = word {
            center[axis] += coordinate(axis, word)?;
        }
    }
    let at = offsets.into_iter().flatten().next().map_or(place, |word| word.at as usize);
    let arm = |point: WorkPos| (point[Axis::X] - center[Axis::X], point[Axis::Z] - center[Axis::Z]);
    let ((start_x, start_z), (end_x, end_z)) = (arm(from), arm(to));
    let (radius, reached) = (start_x.hypot(start_z), end_x.hypot(end_z));
    check_radius(at, radius)?;
    // The end error in each coordinate as programmed.
    let off = (reached - radius).abs();
    let share = if reached > MIN_LENGTH_MM { (2.0 * end_x.abs() / reached).max(end_z.abs() / reached) } else { 2.0 };
    // Tolerates the rounding error of the sum.
    if off * share + MIN_LENGTH_MM >= MAX_END_ERROR_INCREMENTS * running.settings.superman.increment_mm {
        return fail1(at, E::ArcEndOffCircle, format_args!("{off:.3}"));
    }
    Ok(center)
}

fn centre_from_r(from: WorkPos, to: WorkPos, word: Word, turn: i8) -> ReadResult<WorkPos> {
    let (radius, at) = (word.value, word.at as usize);
    if (to[Axis::Z] - from[Axis::Z]).hypot(to[Axis::X] - from[Axis::X]) <= MIN_LENGTH_MM {
        return fail(at, E::FullCircleByRadius);
    }
    check_radius(at, radius.abs())?;
    // The radius of a half circle may be too small by the rounding of the text.
    ArcEnds { from, to, plane: Plane::Zx }
        .centre_by_radius(turn, radius, RADIUS_ROUNDING_MM)
        .map_or_else(|| fail1(at, E::ArcRadius, format_args!("R{radius}")), Ok)
}

/// G23: from A to B (X at rapid), C (Z at F), D (X at F) and back to A (Z at rapid).
pub(super) fn rectangle(running: &mut BlockContext<'_, '_>, place: usize) -> ReadResult<()> {
    let MoveTarget { from, to, words, incremental } = target(running)?;
    let kept = running.modals.cycle;
    let x = if words.contains(Axis::X) { Some(to[Axis::X]) } else { kept.x };
    let z = if words.contains(Axis::Z) { Some(to[Axis::Z]) } else { kept.z };
    let (Some(x), Some(z)) = (x, z) else {
        return fail2(place, E::MissingWord, "G23", if x.is_none() { "X / U" } else { "Z / W" });
    };
    for (axis, corner) in [(Axis::X, x), (Axis::Z, z)] {
        if (corner - from[axis]).abs() <= MIN_LENGTH_MM {
            let letters: &[u8] = if axis == Axis::X { b"XU" } else { b"ZW" };
            let word = letters.iter().find_map(|letter| running.words.peek(*letter));
            return fail1(word.map_or(place, |word| word.at as usize), E::RectangleSide, axis.letter());
        }
    }
    (running.modals.cycle.x, running.modals.cycle.z) = (Some(x), Some(z));
    let feed = line_feed(running);
    let with = |mut point: WorkPos, axis: Axis, value: f64| {
        point[axis] = value;
        point
    };
    let corner_b = with(from, Axis::X, x);
    let corner_c = with(corner_b, Axis::Z, z);
    let corner_d = with(corner_c, Axis::X, from[Axis::X]);
    let (on_x, on_z) = (AxisSet::of(Axis::X), AxisSet::of(Axis::Z));
    let (by_x, by_z) = (incremental.intersection(on_x), incremental.intersection(on_z));
    running.ops.push(Op::Rapid { to: corner_b, feed: None, words: on_x, incremental: by_x });
    let along_z = feed_along(feed, corner_b, corner_c);
    running.ops.push(Op::Feed { to: corner_c, feed: along_z, words: on_z, incremental: by_z });
    let along_x = feed_along(feed, corner_c, corner_d);
    running.ops.push(Op::Feed { to: corner_d, feed: along_x, words: on_x, incremental: by_x });
    running.ops.push(Op::Rapid { to: from, feed: None, words: on_z, incremental: by_z });
    Ok(())
}

/// Checks the range of G04 (L2).
pub(super) fn check_dwell(word: Word) -> ReadResult<()> {
    in_range(word, DWELL_RANGE_S, " s").map(drop)
}

/// G04 F, seconds.
pub(super) fn dwell(running: &mut BlockContext<'_, '_>, place: usize) -> ReadResult<()> {
    let Some(word) = running.words.take(b'F') else { return fail2(place, E::MissingWord, "G04", "F") };
    check_dwell(word)?;
    running.ops.push(Op::Dwell { s: word.value });
    Ok(())
}

/// Checks that G92 has X and Z, and neither U nor W (L3).
pub(super) fn check_preset_words(words: &BlockWords, place: usize) -> ReadResult<()> {
    if let Some(word) = [b'U', b'W'].into_iter().find_map(|letter| words.peek(letter)) {
        return fail2(word.at as usize, E::G92WithDistances, "G92", "U W");
    }
    match [b'X', b'Z'].into_iter().find(|letter| words.peek(*letter).is_none()) {
        Some(letter) => fail2(place, E::MissingWord, "G92", char::from(letter)),
        None => Ok(()),
    }
}

/// G92: assigns work coordinates X Z to the present position; nothing moves.
pub(super) fn set_coordinate_system(running: &mut BlockContext<'_, '_>, place: usize) -> ReadResult<()> {
    check_preset_words(running.words, place)?;
    let MoveTarget { to, .. } = target(running)?;
    running.ops.push(Op::SetCoordinateSystem { values: PerAxis([Some(to[Axis::X]), None, Some(to[Axis::Z])]) });
    Ok(())
}

/// The axes that a code moves to a fixed point, X before Z; it takes no coordinates.
fn fixed_point_axes(running: &BlockContext<'_, '_>, code: Code) -> ReadResult<AxisSet> {
    match [b'X', b'Z', b'U', b'W'].into_iter().find_map(|letter| running.words.peek(letter)) {
        Some(word) => fail1(word.at as usize, E::AxisUnused, code.name('G', 2)),
        None => Ok(match code.number {
            26 | 36 => AxisSet::XZ,
            27 | 37 => AxisSet::of(Axis::X),
            _ => AxisSet::of(Axis::Z),
        }),
    }
}

/// G26, G27, G29: moves to the tool-change point.
pub(super) fn return_to_tool_change(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let (mut at, start) = (running.scope.position(), running.scope.world.program_start());
    for axis in fixed_point_axes(running, code)?.iter() {
        at[axis] = start[axis];
        running.ops.push(Op::Rapid { to: at, feed: None, words: AxisSet::of(axis), incremental: AxisSet::NONE });
    }
    Ok(())
}

/// G36, G37, G39: homes by the switch; the coordinate there is the parameter's.
pub(super) fn home(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let (axes, origin) = (fixed_point_axes(running, code)?, running.settings.superman.origin);
    running.ops.push(Op::HomeSwitch { axes });
    let values = PerAxis::from_fn(|axis| axes.contains(axis).then_some(origin[axis]));
    running.ops.push(Op::SetCoordinateSystem { values });
    Ok(())
}
