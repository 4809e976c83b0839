//! Lines, arcs, dwell, skip, G50 and moves to reference points. Source: spec B2, K1, K5.10, K5.11.

use super::codes::GrinderCodes;
use super::{AXIS_WORDS, MAX_VALUE, axis_letters, cycle, integer, length_mm, out_of_range};
use crate::defs::program_error::ProgramError as E;
use crate::nc::dialect::common;
pub(super) use crate::nc::dialect::common::MoveTarget;
use crate::nc::dialect::{BlockContext, arc};
use crate::nc::fault::{ReadResult, fail, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{Feed, Op, REFERENCE_POINTS};
use crate::nc::words::{ValueKind, Word};
use crate::units::{Axis, PerAxis, WorkPos};

/// Number of skip signals of G31.
const SKIP_SIGNALS: u32 = 6;
const CENTRE_ADDRESSES: u32 = 1 << (b'I' - b'A') | 1 << (b'J' - b'A') | 1 << (b'K' - b'A');

/// The end of the move from `from` by the axis words of the block.
pub(super) fn target(running: &BlockContext<'_, '_>, from: WorkPos) -> ReadResult<MoveTarget> {
    let words = running.words;
    let mut target = MoveTarget::from(from);
    for axis in Axis::ALL {
        let [absolute, distance] = axis_letters(axis).map(|letter| words.take(letter));
        let (word, by) = match (absolute, distance) {
            (None, None) => continue,
            (Some(word), None) => (word, running.modals.incremental),
            (None, Some(word)) => (word, true),
            (Some(first), Some(second)) => {
                let (first, second) = if first.at < second.at { (first, second) } else { (second, first) };
                let names = [first, second].map(|word| char::from(word.letter).to_string());
                let [first_name, second_name] = names;
                return fail2(second.at as usize, E::AbsoluteAndIncremental, first_name, second_name);
            }
        };
        let value = axis_value(running, axis, word)?;
        target.add(axis, value, by);
        if target.to[axis].abs() > MAX_VALUE {
            return out_of_range(char::from(word.letter), word, "±99999.999");
        }
    }
    Ok(target)
}

/// The value of an axis word, radius mm.
#[inline]
pub(super) fn axis_value(running: &BlockContext<'_, '_>, axis: Axis, word: Word) -> ReadResult<f64> {
    if !running.settings.axes[axis] {
        return fail1(word.at as usize, E::NoAxis, axis.letter());
    }
    let value = length_mm(running, word)?;
    Ok(if axis == Axis::X && running.settings.diameter { value / 2.0 } else { value })
}

/// The active feed.
#[inline]
pub(super) fn modal_feed(running: &BlockContext<'_, '_>) -> ReadResult<Feed> {
    match running.modals.feed() {
        Some(feed) => Ok(feed),
        None => fail1(first_offset(running), E::FeedMissing, "G98/G99"),
    }
}

/// The byte of the first axis word, else of the first code.
fn first_offset(running: &BlockContext<'_, '_>) -> usize {
    common::first_offset(running, |letter| Axis::ALL.iter().any(|axis| axis_letters(*axis).contains(&letter)))
}

/// The move of the active function of group 01.
pub(super) fn modal_move(running: &mut BlockContext<'_, '_>, plan: &GrinderCodes) -> ReadResult<()> {
    let named = running.words.has_any(AXIS_WORDS);
    let arc = matches!(running.modals.motion, MotionMode::ArcClockwise | MotionMode::ArcCounterClockwise);
    let by_centre = arc && running.words.has_any(CENTRE_ADDRESSES);
    if !named && !by_centre {
        return match running.words.peek(b'R') {
            // An arc by radius needs an end point.
            Some(radius) if arc && plan.motion.is_some() => {
                fail1(radius.at as usize, E::ArcRadius, format_args!("R{}", radius.value))
            }
            Some(_) | None => Ok(()),
        };
    }
    match running.modals.motion {
        MotionMode::Rapid => {
            let MoveTarget { to, words, incremental } = target(running, running.scope.position())?;
            running.ops.push(Op::Rapid { to, feed: None, words, incremental });
        }
        MotionMode::Feed => {
            let MoveTarget { to, words, incremental } = target(running, running.scope.position())?;
            let feed = modal_feed(running)?;
            running.ops.push(Op::Feed { to, feed, words, incremental });
        }
        MotionMode::ArcClockwise => arc_move(running, -1)?,
        MotionMode::ArcCounterClockwise => arc_move(running, 1)?,
        MotionMode::LongitudinalCycle => cycle::longitudinal(running)?,
        MotionMode::FaceCycle => cycle::face(running)?,
        // Of another dialect; no code of this one selects them.
        MotionMode::RectangleCycle | MotionMode::InchThread | MotionMode::MetricThread => {}
    }
    Ok(())
}

fn arc_move(running: &mut BlockContext<'_, '_>, turn: i8) -> ReadResult<()> {
    let from = running.scope.position();
    let target = target(running, from)?;
    let plane = running.modals.plane;
    let (first, second) = plane.axes();
    if let Some(outside) = target.words.iter().find(|axis| *axis != first && *axis != second) {
        return fail1(first_offset(running), E::AxisOutsidePlane, outside.letter());
    }
    let feed = modal_feed(running)?;
    let offsets = [first, second].map(|axis| running.words.take(centre_address(axis)));
    let radius = running.words.take(b'R');
    let center = match (offsets, radius) {
        ([None, None], None) => return fail2(first_offset(running), E::ArcWithoutCentre, "R", "I J K"),
        ([None, None], Some(radius)) => centre_from_r(running, from, target.to, radius, turn)?,
        ([a, b], None) => centre_by_offsets(running, from, target.to, [a, b])?,
        ([a, b], Some(radius)) => {
            let other = a.or(b).map_or('I', |word| char::from(word.letter));
            return fail2(radius.at as usize, E::NotTogether, "R", format_args!("{other}"));
        }
    };
    let MoveTarget { to, words, incremental } = target;
    running.ops.push(Op::Arc { to, center, plane, turn, feed, words, incremental });
    Ok(())
}

const fn centre_address(axis: Axis) -> u8 {
    match axis {
        Axis::X => b'I',
        Axis::Y => b'J',
        Axis::Z => b'K',
    }
}

fn centre_by_offsets(
    running: &BlockContext<'_, '_>,
    from: WorkPos,
    to: WorkPos,
    offsets: [Option<Word>; 2],
) -> ReadResult<WorkPos> {
    let (first, second) = running.modals.plane.axes();
    let mut center = from;
    for (axis, word) in [first, second].into_iter().zip(offsets) {
        if let Some(word) = word {
            // B2: I is a radius, even if X is a diameter.
            center[axis] += length_mm(running, word)?;
        }
    }
    let (radius, off) = arc::radius_and_end_error((from, to), center, running.modals.plane);
    if radius <= f64::EPSILON {
        return fail1(first_offset(running), E::ArcRadius, "0");
    }
    if off > running.settings.arc_tolerance_mm {
        return fail1(first_offset(running), E::ArcEndOffCircle, format_args!("{off:.3}"));
    }
    Ok(center)
}

fn centre_from_r(
    running: &BlockContext<'_, '_>,
    from: WorkPos,
    to: WorkPos,
    word: Word,
    turn: i8,
) -> ReadResult<WorkPos> {
    let radius = length_mm(running, word)?;
    let tolerance = running.settings.arc_tolerance_mm;
    match arc::centre_by_radius((from, to), running.modals.plane, turn, radius, tolerance) {
        Some(center) => Ok(center),
        None => fail1(word.at as usize, E::ArcRadius, format_args!("R{}", word.value)),
    }
}

/// G04: P milliseconds, X or U seconds.
pub(super) fn dwell(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let words = running.words;
    let found = [b'P', b'X', b'U'].map(|letter| words.take(letter));
    let mut given = found.into_iter().flatten();
    let Some(word) = given.next() else { return fail2(code_offset(running, 4), E::MissingWord, "G04", "P / X / U") };
    if let Some(second) = given.next() {
        let names = [word, second].map(|word| char::from(word.letter).to_string());
        let [first, other] = names;
        return fail2(second.at as usize, E::NotTogether, first, other);
    }
    let scale = match (word.letter, word.kind, running.settings.least_increment_mm) {
        (b'P', _, _) => 0.001,
        (_, ValueKind::Integer, Some(least)) => least,
        _ => 1.0,
    };
    let s = word.value * scale;
    if !(0.0..=MAX_VALUE).contains(&s) {
        return out_of_range(char::from(word.letter), word, "0–99999.999 s");
    }
    running.ops.push(Op::Dwell { s });
    Ok(())
}

/// G28: via the intermediate point to the machine zero; G30 P2 to P4: to another reference point.
pub(super) fn return_to_reference(running: &mut BlockContext<'_, '_>, code: u32) -> ReadResult<()> {
    let MoveTarget { to, words, incremental } = target(running, running.scope.position())?;
    if words.is_empty() {
        return fail2(code_offset(running, code), E::MissingWord, format_args!("G{code}"), "X / Z");
    }
    let number = match running.words.take(b'P').filter(|_| code == 30) {
        Some(word) => integer(word, 2, REFERENCE_POINTS as u32)? as u8,
        None if code == 30 => 2,
        None => 1,
    };
    running.ops.push(Op::ReturnToReference { number, via: to, words, incremental });
    Ok(())
}

/// G31: feeds until skip signal P is active (1–6, default 1).
pub(super) fn skip(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let MoveTarget { to, words, incremental } = target(running, running.scope.position())?;
    if words.is_empty() {
        return fail2(code_offset(running, 31), E::MissingWord, "G31", "X / Z");
    }
    let signal = running.words.take(b'P').map_or(Ok(1), |word| integer(word, 1, SKIP_SIGNALS))? as u8;
    let feed = modal_feed(running)?;
    running.ops.push(Op::Skip { to, feed, signal, words, incremental });
    Ok(())
}

/// G50: assigns work coordinates X Z to the present position; U and W shift them; S limits the speed under G96.
pub(super) fn set_coordinate_system(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let at = code_offset(running, 50);
    let MoveTarget { to, words, .. } = target(running, running.scope.position())?;
    let limit = running.words.take(b'S');
    if let Some(word) = limit {
        if !(0.0..=MAX_VALUE).contains(&word.value) {
            return out_of_range("S", word, "0–99999.999");
        }
        running.ops.push(Op::SpeedLimit { rpm: word.value });
    }
    if words.is_empty() {
        return if limit.is_some() { Ok(()) } else { fail2(at, E::MissingWord, "G50", "X / Z / S") };
    }
    if running.modals.several_tools {
        return fail(at, E::G50WithTools);
    }
    running.modals.g50_used = true;
    running
        .ops
        .push(Op::SetCoordinateSystem { values: PerAxis::from_fn(|axis| words.contains(axis).then_some(to[axis])) });
    Ok(())
}

/// G53: machine coordinates for this block.
pub(super) fn machine_move(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let at = code_offset(running, 53);
    let MoveTarget { to, words, incremental } = target(running, running.scope.position())?;
    if words.is_empty() {
        return fail2(at, E::MissingWord, "G53", "X / Z");
    }
    if !incremental.is_empty() {
        return fail2(first_offset(running), E::NotTogether, "G53", "U V W G91");
    }
    let feed = match running.modals.motion {
        MotionMode::Rapid => None,
        MotionMode::Feed => Some(modal_feed(running)?),
        motion => return fail2(at, E::NotTogether, "G53", format_args!("G{:02}", motion.g())),
    };
    running.ops.push(Op::MachineMove { to: PerAxis::from_fn(|axis| words.contains(axis).then_some(to[axis])), feed });
    Ok(())
}

pub(super) fn code_offset(running: &BlockContext<'_, '_>, number: u32) -> usize {
    running.words.g().iter().find(|code| code.number == number).map_or(running.at, |code| code.at as usize)
}
