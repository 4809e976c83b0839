//! Lines and arcs, as far as the dialects share them: axis words, the feed, the centre of an arc by radius or by
//! distances from the start. Source: spec B2, S1.

use super::codes::BlockCodes;
use super::corner::{line_angle, note_corner};
use super::move_target::{MoveSyntax, MoveTarget};
use super::rules::BlockContext;
use crate::nc::corner::LineAngle;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::modal::MotionMode;
use crate::nc::op::{Feed, Op, PathMode};
use crate::nc::words::{LINE_ANGLE, Word, letter_mask};
use crate::units::{Axis, Plane, WorkPos};

/// Shorter chords and radii count as zero, mm.
const MIN_LENGTH_MM: f64 = 1e-9;
/// The distances from the start of an arc to its centre.
const CENTRE_WORDS: u32 = letter_mask(b"IJK");

/// The radius mm of a word of an axis that the machine must have.
#[inline]
pub(super) fn radius_mm(
    running: &BlockContext<'_, '_>,
    axis: Axis,
    word: Word,
    length_mm: impl Fn(&BlockContext<'_, '_>, Word) -> ReadResult<f64>,
) -> ReadResult<f64> {
    if !running.settings.axes[axis] {
        return fail1(word.at as usize, E::NoAxis, axis.letter());
    }
    let value = length_mm(running, word)?;
    Ok(if axis == Axis::X && running.settings.diameter { value / 2.0 } else { value })
}

/// The byte of the first axis word, else of the first code.
pub(super) fn first_offset(running: &BlockContext<'_, '_>, syntax: &MoveSyntax) -> usize {
    let words = running.words;
    let axis = words.list.iter().find(|word| syntax.axis_words & letter_mask(&[word.letter]) != 0);
    axis.map_or_else(|| words.g.first().map_or(running.at, |code| code.at as usize), |word| word.at as usize)
}

/// The active feed.
#[inline]
pub(super) fn modal_feed(running: &BlockContext<'_, '_>, syntax: &MoveSyntax) -> ReadResult<Feed> {
    running.modals.feed().map_or_else(|| fail1(first_offset(running, syntax), E::FeedMissing, syntax.feed_codes), Ok)
}

/// The move of G00 to G03; `false` if the block moves by another function of group 01.
#[inline]
pub(super) fn modal_move(
    running: &mut BlockContext<'_, '_>,
    plan: &BlockCodes,
    syntax: &MoveSyntax,
    target: impl Fn(&BlockContext<'_, '_>) -> ReadResult<MoveTarget>,
) -> ReadResult<bool> {
    let is_arc = matches!(running.modals.motion, MotionMode::ArcClockwise | MotionMode::ArcCounterClockwise);
    let has_angle = running.words.has(LINE_ANGLE) && running.modals.motion == MotionMode::Feed;
    if !(running.words.has_any(syntax.axis_words) || has_angle || is_arc && running.words.has_any(CENTRE_WORDS)) {
        let (letter, _, prefix) = syntax.radius;
        return match running.words.peek(letter) {
            // An arc by radius needs an end point.
            Some(radius) if is_arc && plan.motion.is_some() => {
                fail1(radius.at as usize, E::ArcRadius, format_args!("{prefix}{}", radius.value))
            }
            Some(_) | None => Ok(true),
        };
    }
    let motion = running.modals.motion;
    if !(is_arc || matches!(motion, MotionMode::Rapid | MotionMode::Feed)) {
        return Ok(false);
    }
    let mut target = target(running)?;
    if is_arc {
        note_corner(running, syntax, &target, LineAngle::None)?;
        let turn = if motion == MotionMode::ArcClockwise { -1 } else { 1 };
        let arc = arc_move(running, syntax, target, turn)?;
        running.ops.push(arc);
    } else if motion == MotionMode::Feed {
        let angle = line_angle(running, syntax, &mut target)?;
        note_corner(running, syntax, &target, angle)?;
        let MoveTarget { to, words, incremental, .. } = target;
        let feed = modal_feed(running, syntax)?;
        running.ops.push(Op::Feed { to, feed, words, incremental });
    } else {
        let MoveTarget { to, words, incremental, .. } = target;
        running.ops.push(Op::Rapid { to, feed: None, words, incremental });
    }
    Ok(true)
}

/// G09, G9: what a block does with an exact stop at its end.
pub(super) fn exact_stop_block(
    running: &mut BlockContext<'_, '_>,
    block: impl FnOnce(&mut BlockContext<'_, '_>) -> ReadResult<()>,
) -> ReadResult<()> {
    let path_mode = running.modals.path_mode;
    if path_mode == PathMode::ExactStop {
        return block(running);
    }
    running.ops.push(Op::SetPathMode(PathMode::ExactStop));
    block(running)?;
    running.ops.push(Op::SetPathMode(path_mode));
    Ok(())
}

fn arc_move(running: &BlockContext<'_, '_>, syntax: &MoveSyntax, target: MoveTarget, turn: i8) -> ReadResult<Op> {
    let MoveTarget { from, to, words, incremental } = target;
    let plane = running.modals.plane;
    let ends = ArcEnds { from, to, plane };
    let (first, second) = plane.axes();
    let outside = words.iter().find(|axis| *axis != first && *axis != second);
    // A program for another machine counts on its plane at power-on: XY.
    if running.settings.is_mill() && !running.modals.plane_named {
        let centre = running.words.peek(b'J').map(|word| (word.at as usize, 'J'));
        let end = outside.map(|outside| (first_offset(running, syntax), outside.letter()));
        if let Some((at, letter)) = centre.or(end) {
            return fail1(at, E::PlaneUnnamed, letter);
        }
    }
    // GS, GA: the third axis moves in proportion to the angle, a helix.
    if let Some(outside) = outside.filter(|_| !running.settings.is_mill()) {
        return fail1(first_offset(running, syntax), E::AxisOutsidePlane, outside.letter());
    }
    if let Some(word) = running.words.peek(syntax.refused) {
        return fail1(word.at as usize, E::AxisOutsidePlane, char::from(word.letter));
    }
    let feed = modal_feed(running, syntax)?;
    let (letter, name, prefix) = syntax.radius;
    let offsets = [first, second].map(|axis| running.words.take(centre_letter(axis)));
    let center = match (offsets, running.words.take(letter)) {
        ([None, None], None) => {
            return fail2(first_offset(running, syntax), E::ArcWithoutCentre, prefix, syntax.centre);
        }
        ([None, None], Some(word)) => {
            let radius = (syntax.length_mm)(running, word)?;
            match ends.centre_by_radius(turn, radius, running.settings.arc_tolerance_mm) {
                Some(center) => center,
                None => return fail1(word.at as usize, E::ArcRadius, format_args!("{prefix}{}", word.value)),
            }
        }
        ([one, other], None) => {
            let mut center = from;
            for (axis, word) in [(first, one), (second, other)] {
                center[axis] += word.map_or(Ok(0.0), |word| (syntax.length_mm)(running, word))?;
            }
            let (radius, miss) = ends.radius_and_end_error(center);
            if radius <= f64::EPSILON {
                return fail1(first_offset(running, syntax), E::ArcRadius, "0");
            }
            if miss > running.settings.arc_tolerance_mm + MIN_LENGTH_MM {
                return fail1(first_offset(running, syntax), E::ArcEndOffCircle, format_args!("{miss:.3}"));
            }
            center
        }
        ([one, other], Some(radius)) => {
            let given = if syntax.names_x && second == Axis::X { other.or(one) } else { one.or(other) };
            let centre = given.map_or('I', |word| char::from(word.letter));
            return fail2(radius.at as usize, E::NotTogether, name, centre);
        }
    };
    Ok(Op::Arc { to, center, plane, turn, feed, words, incremental })
}

const fn centre_letter(axis: Axis) -> u8 {
    match axis {
        Axis::X => b'I',
        Axis::Y => b'J',
        Axis::Z => b'K',
    }
}

/// Start, end and plane of an arc whose centre is sought.
pub(super) struct ArcEnds {
    pub from: WorkPos,
    pub to: WorkPos,
    pub plane: Plane,
}

impl ArcEnds {
    /// The centre of an arc by its radius; a negative radius is the major arc. `None` if no such arc reaches the end.
    /// The radius of a half circle may be too small by `tolerance_mm`, the rounding of the text.
    pub(super) fn centre_by_radius(&self, turn: i8, radius: f64, tolerance_mm: f64) -> Option<WorkPos> {
        let (Self { from, to, .. }, (first, second)) = (self, self.plane.axes());
        let (a, b) = (to[first] - from[first], to[second] - from[second]);
        let chord = a.hypot(b);
        let half = chord / 2.0;
        if chord <= MIN_LENGTH_MM || radius.abs() <= f64::EPSILON || radius.abs() + tolerance_mm < half {
            return None;
        }
        let height = (radius * radius - half * half).max(0.0).sqrt();
        // The centre is to the left of the chord for a counter-clockwise minor arc. A negative R is the major arc.
        let side = f64::from(turn) * radius.signum();
        let mut center = *from;
        center[first] = (from[first] + to[first]) / 2.0 - side * height * b / chord;
        center[second] = (from[second] + to[second]) / 2.0 + side * height * a / chord;
        Some(center)
    }

    /// The radius of an arc around a centre, and the distance of its end from the circle, mm.
    fn radius_and_end_error(&self, center: WorkPos) -> (f64, f64) {
        let (first, second) = self.plane.axes();
        let radius = |point: WorkPos| (point[first] - center[first]).hypot(point[second] - center[second]);
        let (start, end) = (radius(self.from), radius(self.to));
        (start, (start - end).abs())
    }
}
