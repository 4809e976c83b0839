//! The tool path of a program as the check run goes it, in several degrees of detail: however long the program is, a
//! frame draws no more than a screen can show.
//! Source: spec B6 (图形), H8, H9. Lengths: mm, radius, work coordinates.

use std::collections::HashSet;

use super::files::LineFault;
use crate::units::{Axis, PerAxis};

/// Most points of a path that are kept; a longer one is cut.
pub const MOST_POINTS: usize = 4_000_000;
/// Points of one piece, which has a box around it.
pub const PIECE: usize = 256;
/// Degrees of detail: shares of the path's size that may be left out.
const FINENESS: [f32; 3] = [32_768.0, 8_192.0, 2_048.0];
/// A path of fewer points needs no other degree.
const FEW: usize = 10_000;

/// How a point is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// Not at all: the path begins anew here.
    Lift,
    /// At rapid.
    Rapid,
    /// At feed.
    Feed,
}

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// X, Y, Z.
    pub at: [f32; 3],
    /// How it is reached from the point before.
    pub way: Way,
}

/// The box around a piece of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around {
    /// Least coordinates.
    pub low: [f32; 3],
    /// Greatest coordinates.
    pub high: [f32; 3],
}

impl Around {
    const NOTHING: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    fn take(&mut self, at: [f32; 3]) {
        for (axis, value) in at.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
    }

    /// The greatest side.
    #[must_use]
    pub fn size(&self) -> f32 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f32::max)
    }
}

/// One degree of detail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// What may be missing, mm.
    pub tolerance_mm: f32,
    /// The points.
    pub points: Vec<Point>,
    /// The box of each [`PIECE`] points, with the point before them.
    pub pieces: Vec<Around>,
}

impl Level {
    fn of(tolerance_mm: f32, points: Vec<Point>) -> Self {
        let mut pieces = Vec::with_capacity(points.len() / PIECE + 1);
        for (index, piece) in points.chunks(PIECE).enumerate() {
            let mut around = Around::NOTHING;
            if let Some(before) = (index * PIECE).checked_sub(1) {
                around.take(points[before].at);
            }
            piece.iter().for_each(|point| around.take(point.at));
            pieces.push(around);
        }
        Self { tolerance_mm, points, pieces }
    }

    /// The path without what lies closer together than the tolerance, and without what was drawn before.
    fn coarser(&self, tolerance_mm: f32) -> Self {
        let cell = |at: [f32; 3]| at.map(|value| (value / tolerance_mm).round() as i32);
        let mut drawn = HashSet::new();
        let mut points: Vec<Point> = Vec::new();
        let (mut last, mut lifted) = ([i32::MAX; 3], true);
        for point in &self.points {
            let here = cell(point.at);
            if point.way == Way::Lift {
                (last, lifted) = (here, true);
                continue;
            }
            if here == last {
                continue;
            }
            let key = if last < here { (last, here, point.way) } else { (here, last, point.way) };
            if drawn.insert(key) {
                if lifted {
                    points.push(Point { at: last.map(|value| value as f32 * tolerance_mm), way: Way::Lift });
                }
                points.push(Point { at: here.map(|value| value as f32 * tolerance_mm), way: point.way });
                lifted = false;
            } else {
                lifted = true;
            }
            last = here;
        }
        Self::of(tolerance_mm, points)
    }
}

/// A path and what its check run told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// O number.
    pub number: u32,
    /// Stamp of the text.
    pub stamp: u64,
    /// From exact to coarse.
    pub levels: Vec<Level>,
    /// Least and greatest coordinates of all moves; none without a move.
    pub extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
    /// The way of all moves, mm.
    pub length_mm: f64,
    /// The time at programmed feeds, s.
    pub seconds: f64,
    /// Lines of the text.
    pub lines: usize,
    /// The mistakes.
    pub faults: Vec<LineFault>,
    /// Where a tool meets what it must not, work coordinates (L9).
    pub crashes: Vec<[f32; 3]>,
    /// The run came to its end; otherwise it was cancelled, given up or cut.
    pub finished: bool,
}

impl Drawing {
    /// Takes a path; makes the coarser degrees of detail.
    pub fn take_path(&mut self, points: Vec<Point>) {
        let exact = Level::of(0.0, points);
        let size = exact.pieces.iter().fold(Around::NOTHING, |mut all, piece| {
            all.take(piece.low);
            all.take(piece.high);
            all
        });
        self.levels = vec![exact];
        for fineness in FINENESS {
            let Some(finer) = self.levels.last().filter(|level| level.points.len() > FEW) else { break };
            let coarser = finer.coarser((size.size() / fineness).max(1e-6));
            self.levels.push(coarser);
        }
    }

    /// The box around the path.
    #[must_use]
    pub fn around(&self) -> Option<Around> {
        let (low, high) = self.extents?;
        let three = |values: PerAxis<f64>| [Axis::X, Axis::Y, Axis::Z].map(|axis| values[axis] as f32);
        Some(Around { low: three(low), high: three(high) })
    }
}

/// A piece of the part or of what holds it, as a box in work coordinates; where the part turns about Z, X runs from
/// minus to plus the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockBox {
    /// Least coordinates, mm, radius.
    pub low: PerAxis<f64>,
    /// Greatest coordinates.
    pub high: PerAxis<f64>,
    /// It is the part; otherwise it holds it.
    pub part: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A million strokes over 100 mm, each 0.1 µm deeper: no screen shows more than some thousand of them.
    #[test]
    fn h9_a_million_moves_are_some_thousand_on_a_screen() {
        let points = (0..1_000_000_u32).map(|index| {
            let x = if index.is_multiple_of(2) { 0.0 } else { 100.0 };
            let z = index as f32 * 1e-4;
            Point { at: [x, 0.0, z], way: if index == 0 { Way::Lift } else { Way::Feed } }
        });
        let mut drawing = Drawing::default();
        drawing.take_path(points.collect());
        let coarsest = drawing.levels.last().expect("levels");
        // 100 mm / 2048: each row of cells once to and once fro, with its lifts.
        assert!(coarsest.points.len() < 2_048 * 4, "{}", coarsest.points.len());
        // And it reaches as far as the path does.
        let all = coarsest.pieces.iter().fold(Around::NOTHING, |mut all, piece| {
            all.take(piece.low);
            all.take(piece.high);
            all
        });
        assert!(all.high[0] > 99.9 && all.high[2] > 99.9 && all.low[2] < 0.1, "{all:?}");
    }

    #[test]
    fn b6_a_short_path_is_kept_as_it_is() {
        let mut drawing = Drawing::default();
        let points = vec![Point { at: [0.0; 3], way: Way::Lift }, Point { at: [1.0, 0.0, 2.0], way: Way::Feed }];
        drawing.take_path(points.clone());
        assert_eq!((drawing.levels.len(), &drawing.levels[0].points), (1, &points));
        assert_eq!(drawing.levels[0].pieces, [Around { low: [0.0; 3], high: [1.0, 0.0, 2.0] }]);
    }
}
