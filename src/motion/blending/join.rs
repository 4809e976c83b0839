//! Joining: consecutive lines that are too short to shape the curve become one line of the tolerance band.
//!
//! The joined line lasts no longer than a fraction of the knot spacing, and every end point of the lines lies on it in order
//! and within a small share of the tolerance. What they lie beside it is taken from its tolerance, so the curve stays within
//! the programmed tolerance of the programmed lines. Knows nothing of the horizon.

use super::super::lookahead_window::knot_spacing_s;
use super::super::path_segment::{MIN_LENGTH_MM, PathSegment};
use super::super::queued_move::{MoveQueue, QueuedMove};
use super::super::tolerance_band::BandMove;
use super::super::{CornerMode, MotionLimits, MoveShape, dot, per_coordinate};
use super::{Continuation, band_move, continuation};
use crate::units::WorkBudget;

/// Maximum number of joined lines.
const MAX_JOINED: usize = 64;
/// Maximum time of a joined line at its programmed speed, in knot spacings: the curve has no shape between knots.
const MAX_KNOTS: f64 = 0.5;
/// Share of the tolerance that joining may use; and the higher one for lines that would be shorter than `FINE_KNOTS` knot
/// spacings with the first: points on a grid as wide as that share.
const FINE_SHARE: f64 = 0.02;
const COARSE_SHARE: f64 = 0.12;
const FINE_KNOTS: f64 = 0.1;
/// Work units of one line looked at.
const COST_LINE: usize = 60;

/// The lines that could be joined: for each, the index of its move in the queue.
struct Candidates {
    places: [usize; MAX_JOINED],
    count: usize,
}

/// The move at a queue index, joined with those after it as far as that is allowed.
pub fn join(moves: &MoveQueue, place: usize, limits: &MotionLimits, budget: &mut WorkBudget) -> BandMove {
    let first = &moves[place];
    let alone = band_move(first, limits);
    let CornerMode::Continuous { tolerance_mm } = first.programmed.corner else { return alone };
    if first.segment.curvature() > 0.0 {
        return alone;
    }
    let speed = alone.max_speed.min(alone.programmed_speed);
    let knot_mm = speed * knot_spacing_s(limits, tolerance_mm);
    let candidates = Candidates::collect(moves, place, MAX_KNOTS * knot_mm);
    budget.spend(candidates.count * COST_LINE);
    let fine = candidates.longest(moves, FINE_SHARE * tolerance_mm);
    let is_short = fine.as_ref().is_none_or(|joined| joined.line.length() < FINE_KNOTS * knot_mm);
    let coarse = if is_short { candidates.longest(moves, COARSE_SHARE * tolerance_mm) } else { None };
    let Some(joined) = coarse.or(fine) else { return alone };
    BandMove {
        segment: joined.line,
        numbers: (first.number, moves[joined.last].number),
        joined_deviation: joined.deviation_mm,
        max_speed: joined.line.limits(limits).velocity_mm_s,
        ..alone
    }
}

/// Lines as one.
struct JoinedLine {
    line: PathSegment,
    /// Queue index of the last line.
    last: usize,
    /// How far the end points of the lines lie beside it at most, mm.
    deviation_mm: f64,
}

impl Candidates {
    /// The line at `place` and those after it with the same speed and tolerance, up to a length.
    fn collect(moves: &MoveQueue, place: usize, most_mm: f64) -> Self {
        let first = &moves[place];
        let is_alike = |next: &QueuedMove| {
            next.programmed.speed == first.programmed.speed
                && next.programmed.corner == first.programmed.corner
                && next.segment.curvature() <= 0.0
        };
        let mut this = Self { places: [place; MAX_JOINED], count: 1 };
        let mut length_mm = first.segment.length();
        while this.count < MAX_JOINED
            && let Continuation::ContinuesAt(next) = continuation(moves, this.places[this.count - 1])
            && let Some(queued) = moves.get(next).filter(|queued| is_alike(queued))
        {
            length_mm += queued.segment.length();
            if length_mm > most_mm {
                break;
            }
            this.places[this.count] = next;
            this.count += 1;
        }
        this
    }

    /// The longest beginning of the lines that are one line within a deviation, by halving; not always the very longest.
    fn longest(&self, moves: &MoveQueue, most_mm: f64) -> Option<JoinedLine> {
        let (mut good, mut bad) = (1, self.count + 1);
        let mut longest = None;
        let mut count = self.count;
        while good + 1 < bad {
            match self.as_line(moves, count, most_mm) {
                Some(joined) => (good, longest) = (count, Some(joined)),
                None => bad = count,
            }
            count = usize::midpoint(good, bad);
        }
        longest
    }

    /// The first `count` lines as one, if their end points follow each other along it and lie beside it by no more than
    /// `most_mm`.
    fn as_line(&self, moves: &MoveQueue, count: usize, most_mm: f64) -> Option<JoinedLine> {
        let last = self.places[count - 1];
        let start = moves[self.places[0]].segment.at(0.0);
        let line = PathSegment::new(start, moves[last].programmed.to, MoveShape::Line);
        if line.length() < MIN_LENGTH_MM {
            return None;
        }
        let direction = line.directions()[0];
        let (mut along_mm, mut deviation_mm) = (0.0, 0.0_f64);
        for place in &self.places[..count] {
            let end = moves[*place].programmed.to.coordinates();
            let from_start = per_coordinate(|x| end[x] - start[x]);
            let here_mm = dot(from_start, direction);
            let beside = per_coordinate(|x| from_start[x] - here_mm * direction[x]);
            deviation_mm = deviation_mm.max(dot(beside, beside).sqrt());
            if here_mm <= along_mm || deviation_mm > most_mm {
                return None;
            }
            along_mm = here_mm;
        }
        Some(JoinedLine { line, last, deviation_mm })
    }
}
