//! The roughing cycles G71 and G72: strokes to the contour, level by level, then one pass along it.
//!
//! The contour falls and rises along the strokes (FANUC type II, with pockets), or falls only (type I). Lengths are
//! radius millimetres in work coordinates. Source: spec B2 (G71, G72).

use super::contour_segment::{ContourSegment, MIN_LENGTH_MM, feed_to, other_axis, rapid_to, return_to_start};
use super::op::{Feed, Op};
use crate::defs::program_error::ProgramError as E;
use crate::units::{Axis, PerAxis, WorkPos};

/// Most strokes of one cycle.
const MAX_STROKES: usize = 2_000;

/// A roughing cycle.
pub(super) struct RoughingCycle {
    pub infeed: Axis,
    pub depth: f64,
    pub escape: f64,
    pub feed: Feed,
    pub start: WorkPos,
    pub allowance: PerAxis<f64>,
    /// Type II: the contour may rise again.
    pub has_pockets: bool,
}

/// Memory for contours with pockets.
#[derive(Default)]
pub(super) struct PocketMemory {
    /// The contour in parts that only fall or only rise, with its allowance.
    parts: Vec<ContourSegment>,
    /// Strokes that wait; the last one is next.
    waiting: Vec<RoughingStroke>,
}

/// A mistake of a contour, and the segment that makes it; without one the contour as a whole does.
pub(super) type RoughingMistake = (E, Option<ContourSegment>);

/// A stroke: a stretch at a level where the contour is deeper.
#[derive(Clone, Copy, Debug)]
struct RoughingStroke {
    /// The number of the level, from 1.
    number: usize,
    /// Coordinates along the stroke.
    begin: f64,
    end: f64,
    /// It begins beside the part, not in a pocket.
    is_open: bool,
}

/// The directions of a cycle, and whether its infeeds are at rapid speed.
#[derive(Clone, Copy)]
struct Directions {
    down: f64,
    along: f64,
    rapid_infeed: bool,
}

impl RoughingCycle {
    /// Appends the operations of the cycle. With `leads_out` the last segment only leads away from the contour.
    ///
    /// # Errors
    /// The mistake of the contour.
    pub fn expand(
        &self,
        segments: &[ContourSegment],
        leads_out: bool,
        memory: &mut PocketMemory,
        ops: &mut Vec<Op>,
    ) -> Result<(), RoughingMistake> {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let [first, all @ ..] = segments else { return Err((E::ContourEmpty, None)) };
        let rest = &all[..all.len() - usize::from(leads_out && all.len() > 1)];
        let (Some(last), at) = (rest.last(), first.to) else { return Err((E::ContourEmpty, None)) };
        let way = |from: f64, to: f64| if (to - from).abs() > MIN_LENGTH_MM { (to - from).signum() } else { 0.0 };
        let along = way(at[b], last.to[b]);
        // A last block that leads back to where the contour begins turns back along the strokes.
        let far = rest
            .iter()
            .map(|segment| segment.to[b])
            .max_by(|one, other| (one - at[b]).abs().total_cmp(&(other - at[b]).abs()));
        let outward = far.map_or(0.0, |far| way(at[b], far));
        if outward != 0.0 && along * outward <= 0.0 {
            return Err((E::ContourNotMonotone, Some(*last)));
        }
        // A contour with pockets may begin at the height of the start: its first other point tells the direction.
        let others = rest.iter().map(|segment| segment.to[a]).take_while(|_| self.has_pockets);
        let mut ways = std::iter::once(at[a]).chain(others).map(|to| way(self.start[a], to));
        let down = ways.find(|way| way.abs() > 0.0).unwrap_or(0.0);
        if down == 0.0 || along == 0.0 || (at[b] - self.start[b]) * along < -MIN_LENGTH_MM {
            return Err((E::ContourStart, None));
        }
        // With its allowance the contour must still lie below the start, and within its own length. Its end may rise.
        let is_above =
            |segment: &&ContourSegment| (segment.to[a] + self.allowance[a] - self.start[a]) * down < -MIN_LENGTH_MM;
        if let Some(above) = std::iter::once(first).chain(&rest[..rest.len() - 1]).find(is_above) {
            return Err((E::ContourAboveStart, Some(*above)));
        }
        if self.allowance[b].abs() > (last.to[b] - at[b]).abs() {
            return Err((E::ContourAllowance, None));
        }
        let directions = Directions { down, along, rapid_infeed: first.rapid };
        if self.has_pockets {
            self.rough_pockets(rest, directions, memory, ops)?;
        } else {
            self.rough_falling(rest, at, directions, ops)?;
        }
        self.push_contour_pass(ops, first, all);
        Ok(())
    }

    /// The level of a stroke on the infeed axis.
    fn level(&self, number: usize, directions: Directions) -> f64 {
        self.start[self.infeed] + directions.down * self.depth * number as f64
    }

    /// Type I: the contour begins at its deepest point and only rises.
    fn rough_falling(
        &self,
        rest: &[ContourSegment],
        at: WorkPos,
        directions: Directions,
        ops: &mut Vec<Op>,
    ) -> Result<(), RoughingMistake> {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let Directions { down, along, .. } = directions;
        let mut allowed = PerAxis::default();
        (allowed[a], allowed[b]) = (-down, along);
        if let Some(wrong) = rest.iter().find(|segment| !segment.is_monotone(allowed)) {
            let falls = wrong.goes_along(b, along);
            return Err((if falls { E::ContourPocket } else { E::ContourNotMonotone }, Some(*wrong)));
        }
        let (bottom, mut position) = (at[a] + self.allowance[a], self.start);
        for number in 1..=MAX_STROKES {
            let level = self.level(number, directions);
            if (bottom - level) * down <= MIN_LENGTH_MM {
                return Ok(());
            }
            let meets = rest.iter().find_map(|segment| segment.shifted(self.allowance).crossing_at(a, level));
            let last = rest.last().map_or(at[b], |last| last.to[b]);
            let end = meets.unwrap_or(last + self.allowance[b]);
            let stroke = RoughingStroke { number, begin: self.start[b], end, is_open: true };
            self.push_stroke(ops, &mut position, stroke, directions);
        }
        Err((E::ContourStrokes, None))
    }

    /// Type II: a pocket is emptied before the next one; a stroke lies within the one above it.
    fn rough_pockets(
        &self,
        rest: &[ContourSegment],
        directions: Directions,
        memory: &mut PocketMemory,
        ops: &mut Vec<Op>,
    ) -> Result<(), RoughingMistake> {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let Directions { down, along, .. } = directions;
        if let Some(back) = rest.iter().find(|segment| !segment.goes_along(b, along)) {
            return Err((E::ContourNotMonotone, Some(*back)));
        }
        let PocketMemory { parts, waiting } = memory;
        parts.clear();
        let split = rest.iter().flat_map(|segment| segment.shifted(self.allowance).split_at_extreme(a)).flatten();
        parts.extend(split);
        let deepest = parts.iter().flat_map(|part| [part.from[a], part.to[a]]);
        let bottom = deepest.fold(0.0_f64, |deepest, at| deepest.max((at - self.start[a]) * down));
        // The summit of an arc counts, too.
        if let Some(above) = parts.iter().find(|part| (part.from[a] - self.start[a]) * down < -MIN_LENGTH_MM) {
            return Err((E::ContourAboveStart, Some(*above)));
        }
        waiting.clear();
        let end = parts.last().map_or(self.start[b], |part| part.to[b]);
        self.push_below(
            RoughingStroke { number: 0, begin: self.start[b], end, is_open: true },
            parts,
            directions,
            waiting,
        );
        let (mut strokes, mut position) = (0, self.start);
        while let Some(stroke) = waiting.pop() {
            if bottom - self.depth * stroke.number as f64 <= MIN_LENGTH_MM {
                continue;
            }
            strokes += 1;
            if strokes > MAX_STROKES {
                return Err((E::ContourStrokes, None));
            }
            self.push_stroke(ops, &mut position, stroke, directions);
            self.push_below(stroke, parts, directions, waiting);
        }
        Ok(())
    }

    /// Adds the strokes one level below a stroke: where the contour is as deep, within its stretch.
    fn push_below(
        &self,
        above: RoughingStroke,
        parts: &[ContourSegment],
        directions: Directions,
        waiting: &mut Vec<RoughingStroke>,
    ) {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let Directions { down, along, .. } = directions;
        let number = above.number + 1;
        let level = self.level(number, directions);
        let is_free = |at: f64| (at - level) * down >= -MIN_LENGTH_MM;
        let first = waiting.len();
        // At the start there is air down to where the contour begins. An allowance may put its beginning before the start.
        let is_air_at_start = parts.first().is_none_or(|part| (level - part.from[a]) * down <= MIN_LENGTH_MM);
        let from_start = |at: f64| if (at - self.start[b]) * along < 0.0 { self.start[b] } else { at };
        let add = |begin: f64, end: f64, waiting: &mut Vec<RoughingStroke>| {
            let begin = from_start(begin);
            let is_within =
                (begin - above.begin) * along >= -MIN_LENGTH_MM && (above.end - end) * along >= -MIN_LENGTH_MM;
            if is_within && (end - begin) * along > MIN_LENGTH_MM {
                let is_open = above.is_open && is_air_at_start && (begin - self.start[b]).abs() <= MIN_LENGTH_MM;
                waiting.push(RoughingStroke { number, begin, end, is_open });
            }
        };
        // Before the contour there is air.
        let mut begin = Some(self.start[b]);
        for part in parts {
            let crossing = || part.crossing_at(a, level).unwrap_or(part.from[b]);
            match (is_free(part.from[a]), is_free(part.to[a])) {
                (true, true) => begin = begin.or(Some(part.from[b])),
                (true, false) => add(begin.take().unwrap_or(part.from[b]), crossing(), waiting),
                (false, true) => begin = Some(crossing()),
                // Nothing of the level lies before a contour that begins higher.
                (false, false) => begin = None,
            }
        }
        if let (Some(begin), Some(last)) = (begin, parts.last()) {
            add(begin, last.to[b], waiting);
        }
        // The first one is taken first.
        waiting[first..].reverse();
    }

    /// One stroke from the position `at`: infeed to its level, along it, retract at 45°, return.
    fn push_stroke(&self, ops: &mut Vec<Op>, at: &mut WorkPos, stroke: RoughingStroke, directions: Directions) {
        let RoughingStroke { number, begin, end, is_open } = stroke;
        let Directions { down, along, rapid_infeed } = directions;
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let level = self.level(number, directions);
        if (end - begin) * along <= MIN_LENGTH_MM {
            return;
        }
        if !is_open {
            // Out of the part, above the pocket, down into what is cut already, and the rest at feed.
            at[a] = self.start[a];
            ops.push(rapid_to(*at, &[a]));
            at[b] = begin;
            ops.push(rapid_to(*at, &[b]));
            let cut = self.depth * (number - 1) as f64;
            at[a] += down * (cut - self.escape.min(cut));
            ops.push(rapid_to(*at, &[a]));
        }
        at[a] = level;
        ops.push(if rapid_infeed && is_open { rapid_to(*at, &[a]) } else { feed_to(*at, self.feed, &[a]) });
        at[b] = end;
        ops.push(feed_to(*at, self.feed, &[b]));
        // The retract must not pass the start in either axis.
        let room = ((level - self.start[a]) * down).min((end - begin) * along);
        let escape = self.escape.min(room.max(0.0));
        at[a] -= down * escape;
        at[b] -= along * escape;
        ops.push(feed_to(*at, self.feed, &[a, b]));
        match is_open {
            true => at[b] = self.start[b],
            false => at[a] = self.start[a],
        }
        ops.push(rapid_to(*at, &[if is_open { b } else { a }]));
    }

    /// One pass along the contour with its allowance, and return to the start.
    fn push_contour_pass(&self, ops: &mut Vec<Op>, first: &ContourSegment, rest: &[ContourSegment]) {
        let (a, b) = (self.infeed, other_axis(self.infeed));
        let mut at = self.start;
        at[b] = first.to[b] + self.allowance[b];
        ops.push(rapid_to(at, &[a, b]));
        at[a] = first.to[a] + self.allowance[a];
        ops.push(if first.rapid { rapid_to(at, &[a]) } else { feed_to(at, self.feed, &[a]) });
        rest.iter().for_each(|segment| ops.push(segment.to_op(self.allowance, self.feed)));
        return_to_start(ops, self.start, a);
    }
}
