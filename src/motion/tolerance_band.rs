//! Tolerance band: the contour of a run of moves, the allowed deviation from it, and the bounds of each axis.
//!
//! Holds the moves in order and the distance along them. Knows nothing of speed. Within the tolerance the curve may
//! deviate to either side of the contour, but never beyond a reversal point of an axis: the wheel would cut into
//! material that the program leaves.

use super::path_segment::{MIN_LENGTH_MM, PathSegment, distance, square_distance};
use super::{dot, per_coordinate};

/// Corners of more than 8° (cosine) are sharp.
pub const SHARP_COSINE: f64 = 0.99;
/// Number of further moves searched beyond the best when looking for the nearest.
const SEARCH_BEYOND: usize = 2;

/// One move of the band.
#[derive(Clone, Copy, Debug)]
pub struct BandMove {
    /// Its geometry.
    pub segment: PathSegment,
    /// Serial numbers of the first and the last queued move that it consists of, since power-on.
    pub numbers: (u64, u64),
    /// Maximum speed by geometry and axis limits, mm/s.
    pub max_speed: f64,
    /// Programmed speed, mm/s.
    pub programmed_speed: f64,
    /// Programmed speed times override, mm/s.
    pub feed: f64,
    /// The lower of `max_speed` and `feed`, mm/s.
    pub top_speed: f64,
    /// Allowed deviation of the curve from the queued moves, mm, and how far those lie beside it.
    pub programmed_tolerance: f64,
    pub joined_deviation: f64,
    /// Allowed deviation of the curve from it, mm.
    pub tolerance: f64,
}

impl BandMove {
    /// The same move under a feed override, 1 for the programmed feed.
    pub fn with_override(self, feed_override: f64) -> Self {
        let feed = self.programmed_speed * feed_override;
        Self { feed, top_speed: feed.min(self.max_speed), ..self }
    }
}

/// Bounds of each axis, mm: low and high.
pub type AxisBounds = [(f64, f64); 3];

/// The point of the contour nearest to a given point.
#[derive(Clone, Copy, Debug)]
pub struct NearestPoint {
    /// Distance from the start of the contour, mm.
    pub along: f64,
    /// The nearest point, mm.
    pub point: [f64; 3],
    /// Distance between the two points, mm.
    pub deviation: f64,
    /// Index of the move it lies on.
    pub segment: usize,
}

/// Reversal points of one axis, found as the contour grows. Waves smaller than the tolerance are ignored.
#[derive(Clone, Debug, Default)]
struct ReversalPoints {
    /// Distance along the contour and coordinate of each reversal point, mm; the first may lie before the band.
    reversals: Vec<(f64, f64)>,
    /// Direction of motion: 1 plus, -1 minus, 0 not known yet.
    direction: f64,
    /// The extreme points so far: lowest and highest while the direction is unknown, otherwise both the same.
    low: (f64, f64),
    high: (f64, f64),
}

impl ReversalPoints {
    fn begin(&mut self, at: f64) {
        self.reversals.clear();
        self.direction = 0.0;
        (self.low, self.high) = ((0.0, at), (0.0, at));
    }

    fn add_point(&mut self, along: f64, at: f64, least: f64) {
        if at > self.high.1 {
            self.high = (along, at);
        }
        if at < self.low.1 {
            self.low = (along, at);
        }
        if self.direction <= 0.0 && at > self.low.1 + least {
            self.reversals.push(self.low);
            (self.direction, self.high) = (1.0, (along, at));
        } else if self.direction >= 0.0 && at < self.high.1 - least {
            self.reversals.push(self.high);
            (self.direction, self.low) = (-1.0, (along, at));
        }
        if self.direction > 0.0 {
            self.low = self.high;
        } else if self.direction < 0.0 {
            self.high = self.low;
        }
    }

    /// The bounds of the axis around a distance along the contour.
    fn bounds(&self, along: f64) -> (f64, f64) {
        let next = self.reversals.partition_point(|turn| turn.0 <= along);
        let open = (self.low.1, self.high.1);
        if self.reversals.is_empty() {
            return open;
        }
        let before = self.reversals[next.max(1) - 1].1;
        let after = self.reversals.get(next.max(1)).map(|turn| turn.1);
        after.map_or_else(|| (before.min(open.0), before.max(open.1)), |after| (before.min(after), before.max(after)))
    }
}

/// The tolerance band of a run of moves.
#[derive(Clone, Debug, Default)]
pub struct ToleranceBand {
    /// The moves in order.
    pub moves: Vec<BandMove>,
    /// Distance from the start of the contour to the start of each move, mm, and to the end of the last.
    pub starts: Vec<f64>,
    /// For each move, start and end of the sequence of moves without a sharp corner that it belongs to, mm.
    smooth_run: Vec<(f64, f64)>,
    reversals: [ReversalPoints; 3],
    /// Where the curve ends, mm along the contour.
    pub end: f64,
}

impl ToleranceBand {
    /// An empty band with capacity for a number of moves.
    pub fn with_capacity(moves: usize) -> Self {
        let turns = || ReversalPoints { reversals: Vec::with_capacity(5 * moves), ..ReversalPoints::default() };
        Self {
            moves: Vec::with_capacity(moves),
            starts: Vec::with_capacity(moves + 1),
            smooth_run: Vec::with_capacity(moves),
            reversals: [turns(), turns(), turns()],
            end: 0.0,
        }
    }

    /// Removes all moves.
    pub fn clear(&mut self) {
        self.moves.clear();
        self.starts.clear();
        self.starts.push(0.0);
        self.smooth_run.clear();
        self.reversals.iter_mut().for_each(|turns| turns.reversals.clear());
        self.end = 0.0;
    }

    /// Starts as the continuation of another band from its move `first` on; earlier reversal points are kept.
    pub fn continue_from(&mut self, other: &Self, first: usize) {
        self.clear();
        let Some(piece) = other.moves.get(first) else { return };
        let (start, shift) = (piece.segment.at(0.0), other.starts[first]);
        for (x, turns) in self.reversals.iter_mut().enumerate() {
            turns.begin(start[x]);
            let before = &other.reversals[x];
            let count = before.reversals.partition_point(|turn| turn.0 <= shift);
            let Some(last) = before.reversals[..count].last() else { continue };
            turns.reversals.push((last.0 - shift, last.1));
            let next = before.reversals.get(count).map_or(before.high.1, |turn| turn.1);
            turns.direction = if next > last.1 { 1.0 } else { -1.0 };
        }
    }

    /// Adds a move.
    pub fn add(&mut self, piece: BandMove) {
        let start = self.length();
        if self.moves.is_empty() && self.reversals.iter().all(|turns| turns.reversals.is_empty()) {
            let at = piece.segment.at(0.0);
            (0..3).for_each(|x| self.reversals[x].begin(at[x]));
        }
        let corner = self.moves.last().is_some_and(|last| cosine(&last.segment, &piece.segment) < SHARP_COSINE);
        let begins = if corner { start } else { self.smooth_run.last().map_or(0.0, |run| run.0) };
        self.smooth_run.push((begins, f64::INFINITY));
        let (points, count) = piece.segment.turning_points();
        for (along, at) in &points[..count] {
            for (x, turns) in self.reversals.iter_mut().enumerate() {
                turns.add_point(start + along, at[x], piece.tolerance);
            }
        }
        self.starts.push(start + piece.segment.length());
        self.moves.push(piece);
        self.end = self.length();
    }

    /// Called after the last move: sets the ends of the sequences between sharp corners.
    pub fn finish(&mut self) {
        for k in (1..self.moves.len()).rev() {
            let (start, end) = self.smooth_run[k];
            self.smooth_run[k - 1].1 = if start < self.starts[k] { end } else { self.starts[k] };
        }
    }

    /// Ends the band at a distance along the contour; later moves are removed.
    pub fn truncate_at(&mut self, along: f64) {
        let count = self.segment_at(along) + 1;
        self.moves.truncate(count);
        self.smooth_run.truncate(count);
        self.starts.truncate(count + 1);
        self.end = along.min(self.length());
    }

    /// Length of all moves, mm.
    pub fn length(&self) -> f64 {
        self.starts.last().copied().unwrap_or(0.0)
    }

    /// Whether the curve ends at the end of the last move.
    pub fn ends_at_move_end(&self) -> bool {
        self.end >= self.length() - MIN_LENGTH_MM
    }

    /// Index of the move at a distance from the start.
    pub fn segment_at(&self, along: f64) -> usize {
        self.starts.partition_point(|start| *start <= along).clamp(1, self.moves.len().max(1)) - 1
    }

    /// The point at a distance from the start, mm.
    pub fn at(&self, along: f64) -> [f64; 3] {
        let k = self.segment_at(along);
        self.moves[k].segment.at(along - self.starts[k])
    }

    /// The exact end point, mm.
    pub fn end_point(&self) -> [f64; 3] {
        match self.moves.last() {
            Some(last) if self.ends_at_move_end() => last.segment.at(f64::INFINITY),
            Some(_) | None => self.at(self.end),
        }
    }

    /// The bounds of each axis around a distance along the contour.
    pub fn bounds(&self, along: f64) -> AxisBounds {
        per_coordinate(|x| self.reversals[x].bounds(along))
    }

    /// Start and end of the sequence without a sharp corner that a move belongs to, mm along the contour.
    pub fn smooth_run(&self, segment: usize) -> (f64, f64) {
        self.smooth_run[segment]
    }

    /// The end of a stroke after one distance along the contour and up to another, mm: a reversal point of an axis at which
    /// the contour turns back beside itself, so near that a curve between the two ways is within the tolerance of both.
    pub fn stroke_end(&self, after: f64, up_to: f64) -> Option<f64> {
        let of_axis = |axis: &ReversalPoints| {
            let first = axis.reversals.partition_point(|turn| turn.0 <= after);
            axis.reversals.get(first).map(|turn| turn.0).filter(|along| *along <= up_to && *along < self.end)
        };
        let turns_back = |along: &f64| {
            let reach = 2.0 * self.moves[self.segment_at(*along)].tolerance;
            let (before, at, after) = (self.at((along - reach).max(0.0)), self.at(*along), self.at(along + reach));
            dot(per_coordinate(|x| at[x] - before[x]), per_coordinate(|x| after[x] - at[x])) < 0.0
        };
        self.reversals.iter().find_map(|axis| of_axis(axis).filter(turns_back))
    }

    /// The point between two distances from the start that is nearest to `point`; the search starts at move `hint`.
    pub fn nearest(&self, point: [f64; 3], low: f64, high: f64, hint: usize) -> NearestPoint {
        let last = self.moves.len() - 1;
        let hint = hint.min(last);
        let mut best = self.on_segment(point, low, high, hint);
        for forward in [true, false] {
            let (mut k, mut worse) = (hint, 0);
            while worse < SEARCH_BEYOND {
                if forward {
                    if k == last || self.starts[k + 1] >= high {
                        break;
                    }
                    k += 1;
                } else {
                    if k == 0 || self.starts[k] <= low {
                        break;
                    }
                    k -= 1;
                }
                let here = self.on_segment(point, low, high, k);
                if here.deviation < best.deviation {
                    (best, worse) = (here, 0);
                } else {
                    worse += 1;
                }
            }
        }
        best.deviation = best.deviation.sqrt();
        best
    }

    /// Distance of a point from a move, mm.
    pub fn deviation_from(&self, segment: usize, point: [f64; 3]) -> f64 {
        distance(self.moves[segment].segment.nearest(point, 0.0, f64::INFINITY).1, point)
    }

    /// The nearest point of one move; its deviation is still squared.
    #[inline]
    fn on_segment(&self, point: [f64; 3], low: f64, high: f64, segment: usize) -> NearestPoint {
        let start = self.starts[segment];
        let (along, on) = self.moves[segment].segment.nearest(point, low - start, high - start);
        NearestPoint { along: start + along, point: on, deviation: square_distance(on, point), segment }
    }
}

/// Cosine of the corner angle between two moves.
pub fn cosine(before: &PathSegment, after: &PathSegment) -> f64 {
    let ([_, a], [b, _]) = (before.directions(), after.directions());
    dot(a, b)
}

/// How far the direction turns between two moves: the angle in rad while it is small.
pub fn turn(before: &BandMove, after: &BandMove) -> f64 {
    let ([_, a], [b, _]) = (before.segment.directions(), after.segment.directions());
    distance(a, b).max(1e-9)
}

/// Estimated speed, mm/s, at which the corner between two moves can be rounded.
pub fn corner_speed(before: &BandMove, after: &BandMove, jerk: f64) -> f64 {
    let turn = turn(before, after);
    // A bend of half-width h deviates by turn · h / 6 and needs the third derivative turn / h². Swinging out before
    // and after within the band makes the bend about two and a half times as wide.
    let width = 2.5 * 6.0 * before.tolerance.min(after.tolerance) / turn;
    (jerk * width * width / turn).cbrt()
}
