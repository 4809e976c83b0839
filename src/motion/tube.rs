//! Tolerance band: the contour of a run of moves, the allowed deviation from it, and the bounds of each axis.
//!
//! Holds the moves in order and the distance along them. Knows nothing of speed. Within the tolerance the curve may
//! deviate to either side of the contour, but never beyond a reversal point of an axis: the wheel would cut into
//! material that the program leaves.

use super::contour::{NO_LENGTH_MM, Segment, distance};

/// Corners of more than 8° (cosine) are sharp.
pub const SHARP_COSINE: f64 = 0.99;
/// Number of further moves searched beyond the best when looking for the nearest.
const LOOK_BEYOND: usize = 2;

/// One move of the band.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its geometry.
    pub segment: Segment,
    /// Its serial number in the queue since power-on.
    pub number: u64,
    /// Maximum speed by geometry and axis limits, mm/s.
    pub most: f64,
    /// Programmed speed, mm/s.
    pub programmed: f64,
    /// Programmed speed times override, mm/s.
    pub feed: f64,
    /// The lower of `most` and `feed`, mm/s.
    pub top: f64,
    /// Allowed deviation of the curve, mm.
    pub tolerance: f64,
}

/// Bounds of each axis, mm: low and high.
pub type Room = [(f64, f64); 3];

/// The point of the contour nearest to a given point.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Distance from the start of the contour, mm.
    pub along: f64,
    /// The nearest point, mm.
    pub on: [f64; 3],
    /// Distance between the two points, mm.
    pub off: f64,
    /// Index of the move it lies on.
    pub segment: usize,
}

/// Reversal points of one axis, found as the contour grows. Waves smaller than the tolerance are ignored.
#[derive(Clone, Debug, Default)]
struct Turns {
    /// Distance along the contour and coordinate of each reversal point, mm; the first may lie before the band.
    found: Vec<(f64, f64)>,
    /// Direction of motion: 1 plus, -1 minus, 0 not known yet.
    way: f64,
    /// The extreme points so far: lowest and highest while the direction is unknown, otherwise both the same.
    low: (f64, f64),
    high: (f64, f64),
}

impl Turns {
    fn begin(&mut self, at: f64) {
        self.found.clear();
        self.way = 0.0;
        (self.low, self.high) = ((0.0, at), (0.0, at));
    }

    fn see(&mut self, along: f64, at: f64, least: f64) {
        if at > self.high.1 {
            self.high = (along, at);
        }
        if at < self.low.1 {
            self.low = (along, at);
        }
        if self.way <= 0.0 && at > self.low.1 + least {
            self.found.push(self.low);
            (self.way, self.high) = (1.0, (along, at));
        } else if self.way >= 0.0 && at < self.high.1 - least {
            self.found.push(self.high);
            (self.way, self.low) = (-1.0, (along, at));
        }
        if self.way > 0.0 {
            self.low = self.high;
        } else if self.way < 0.0 {
            self.high = self.low;
        }
    }

    /// The bounds of the axis around a distance along the contour.
    fn room(&self, along: f64) -> (f64, f64) {
        let next = self.found.partition_point(|turn| turn.0 <= along);
        let open = match self.found.last() {
            None => return (self.low.1, self.high.1),
            Some(_) => (self.low.1, self.high.1),
        };
        let before = self.found[next.max(1) - 1].1;
        let after = self.found.get(next.max(1)).map(|turn| turn.1);
        match after {
            Some(after) => (before.min(after), before.max(after)),
            None => (before.min(open.0), before.max(open.1)),
        }
    }
}

/// The tolerance band of a run of moves.
#[derive(Clone, Debug, Default)]
pub struct Tube {
    /// The moves in order.
    pub pieces: Vec<Piece>,
    /// Distance from the start of the contour to the start of each move, mm, and to the end of the last.
    pub along: Vec<f64>,
    /// For each move, start and end of the sequence of moves without a sharp corner that it belongs to, mm.
    smooth_run: Vec<(f64, f64)>,
    turns: [Turns; 3],
    /// Where the curve ends, mm along the contour.
    pub end: f64,
}

impl Tube {
    /// An empty band with capacity for a number of moves.
    pub fn with_capacity(moves: usize) -> Self {
        let turns = || Turns { found: Vec::with_capacity(5 * moves), ..Turns::default() };
        Self {
            pieces: Vec::with_capacity(moves),
            along: Vec::with_capacity(moves + 1),
            smooth_run: Vec::with_capacity(moves),
            turns: [turns(), turns(), turns()],
            end: 0.0,
        }
    }

    /// Removes all moves.
    pub fn clear(&mut self) {
        self.pieces.clear();
        self.along.clear();
        self.along.push(0.0);
        self.smooth_run.clear();
        self.turns.iter_mut().for_each(|turns| turns.found.clear());
        self.end = 0.0;
    }

    /// Starts as the continuation of another band from its move `first` on; earlier reversal points are kept.
    pub fn continue_from(&mut self, other: &Self, first: usize) {
        self.clear();
        let Some(piece) = other.pieces.get(first) else { return };
        let (start, shift) = (piece.segment.at(0.0), other.along[first]);
        for (x, turns) in self.turns.iter_mut().enumerate() {
            turns.begin(start[x]);
            let before = &other.turns[x];
            let count = before.found.partition_point(|turn| turn.0 <= shift);
            let Some(last) = before.found[..count].last() else { continue };
            turns.found.push((last.0 - shift, last.1));
            let next = before.found.get(count).map_or(before.high.1, |turn| turn.1);
            turns.way = if next > last.1 { 1.0 } else { -1.0 };
        }
    }

    /// Adds a move.
    pub fn add(&mut self, piece: Piece) {
        let start = self.length();
        if self.pieces.is_empty() && self.turns.iter().all(|turns| turns.found.is_empty()) {
            let at = piece.segment.at(0.0);
            (0..3).for_each(|x| self.turns[x].begin(at[x]));
        }
        let corner = self.pieces.last().is_some_and(|last| cosine(&last.segment, &piece.segment) < SHARP_COSINE);
        let begins = if corner { start } else { self.smooth_run.last().map_or(0.0, |run| run.0) };
        self.smooth_run.push((begins, f64::INFINITY));
        let (points, count) = piece.segment.turning_points();
        for (along, at) in &points[..count] {
            for (x, turns) in self.turns.iter_mut().enumerate() {
                turns.see(start + along, at[x], piece.tolerance);
            }
        }
        self.along.push(start + piece.segment.length());
        self.pieces.push(piece);
        self.end = self.length();
    }

    /// Called after the last move: sets the ends of the sequences between sharp corners.
    pub fn close(&mut self) {
        for k in (1..self.pieces.len()).rev() {
            let (start, end) = self.smooth_run[k];
            self.smooth_run[k - 1].1 = if start < self.along[k] { end } else { self.along[k] };
        }
    }

    /// Ends the band at a distance along the contour; later moves are removed.
    pub fn cut(&mut self, along: f64) {
        let count = self.segment_at(along) + 1;
        self.pieces.truncate(count);
        self.smooth_run.truncate(count);
        self.along.truncate(count + 1);
        self.end = along.min(self.length());
    }

    /// Length of all moves, mm.
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// Whether the curve ends at the end of the last move.
    pub fn ends_with_a_move(&self) -> bool {
        self.end >= self.length() - NO_LENGTH_MM
    }

    /// Index of the move at a distance from the start.
    pub fn segment_at(&self, along: f64) -> usize {
        self.along.partition_point(|start| *start <= along).clamp(1, self.pieces.len().max(1)) - 1
    }

    /// The point at a distance from the start, mm.
    pub fn at(&self, along: f64) -> [f64; 3] {
        let k = self.segment_at(along);
        self.pieces[k].segment.at(along - self.along[k])
    }

    /// The exact end point, mm.
    pub fn end_point(&self) -> [f64; 3] {
        match self.pieces.last() {
            Some(last) if self.ends_with_a_move() => last.segment.at(f64::INFINITY),
            Some(_) | None => self.at(self.end),
        }
    }

    /// The bounds of each axis around a distance along the contour.
    pub fn room(&self, along: f64) -> Room {
        [0, 1, 2].map(|x| self.turns[x].room(along))
    }

    /// Start and end of the sequence without a sharp corner that a move belongs to, mm along the contour.
    pub fn smooth_run(&self, segment: usize) -> (f64, f64) {
        self.smooth_run[segment]
    }

    /// The point between two distances from the start that is nearest to `point`; the search starts at move `hint`.
    pub fn nearest(&self, point: [f64; 3], low: f64, high: f64, hint: usize) -> Nearest {
        let last = self.pieces.len() - 1;
        let hint = hint.min(last);
        let mut best = self.on_segment(point, low, high, hint);
        for forward in [true, false] {
            let (mut k, mut worse) = (hint, 0);
            while worse < LOOK_BEYOND {
                if forward {
                    if k == last || self.along[k + 1] >= high {
                        break;
                    }
                    k += 1;
                } else {
                    if k == 0 || self.along[k] <= low {
                        break;
                    }
                    k -= 1;
                }
                let here = self.on_segment(point, low, high, k);
                if here.off < best.off {
                    (best, worse) = (here, 0);
                } else {
                    worse += 1;
                }
            }
        }
        best.off = best.off.sqrt();
        best
    }

    /// The nearest point of one move; `off` is still squared.
    fn on_segment(&self, point: [f64; 3], low: f64, high: f64, segment: usize) -> Nearest {
        let start = self.along[segment];
        let (along, on) = self.pieces[segment].segment.nearest(point, low - start, high - start);
        let off = (0..3).map(|x| (on[x] - point[x]) * (on[x] - point[x])).sum();
        Nearest { along: start + along, on, off, segment }
    }
}

/// Cosine of the corner angle between two moves.
pub fn cosine(before: &Segment, after: &Segment) -> f64 {
    let ([_, a], [b, _]) = (before.directions(), after.directions());
    (0..3).map(|x| a[x] * b[x]).sum()
}

/// Estimated speed, mm/s, at which the corner between two moves can be rounded.
pub fn corner_speed(before: &Piece, after: &Piece, jerk: f64) -> f64 {
    let ([_, a], [b, _]) = (before.segment.directions(), after.segment.directions());
    let turn = distance(a, b).max(1e-9);
    // A bend of half-width h deviates by turn · h / 6 and needs the third derivative turn / h². Swinging out before
    // and after within the band makes the bend about two and a half times as wide.
    let width = 2.5 * 6.0 * before.tolerance.min(after.tolerance) / turn;
    (jerk * width * width / turn).cbrt()
}
