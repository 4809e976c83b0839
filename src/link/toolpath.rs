//! The tool path of a program from its check run, at several levels of detail. However long the program is, a frame
//! draws no more points than a screen can show.
//! Source: spec B6 (图形), H8, H9. Lengths: mm, radius, work coordinates.

use std::collections::HashSet;

use super::line_fault::LineFault;
use crate::units::{Axis, WorkPos};

/// Maximum number of points of a path; a longer path is truncated.
pub const MAX_POINTS: usize = 4_000_000;
/// Points of one chunk; every chunk has a bounding box.
pub const CHUNK_POINTS: usize = 256;
/// Levels of detail: the tolerance is the size of the path divided by this.
const DETAIL_FRACTIONS: [f32; 3] = [32_768.0, 8_192.0, 2_048.0];
/// A path with fewer points needs no coarser level.
const MIN_POINTS_TO_SIMPLIFY: usize = 10_000;

/// How a point is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MoveKind {
    /// No move: the path starts anew here.
    Break,
    /// Rapid traverse.
    Rapid,
    /// Feed move.
    Feed,
}

/// A point of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// X, Y, Z.
    pub at: [f32; 3],
    /// The move from the previous point.
    pub kind: MoveKind,
}

/// The bounding box of a part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Minimum coordinates.
    pub low: [f32; 3],
    /// Maximum coordinates.
    pub high: [f32; 3],
}

impl BoundingBox {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    fn include(&mut self, at: [f32; 3]) {
        for (axis, value) in at.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
    }

    /// The longest side.
    #[must_use]
    pub fn longest_side(&self) -> f32 {
        (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f32::max)
    }
}

/// One level of detail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetailLevel {
    /// Maximum deviation from the exact path, mm.
    pub tolerance_mm: f32,
    /// The points.
    pub points: Vec<PathPoint>,
    /// The bounding box of each [`CHUNK_POINTS`] points, including the point before them.
    pub chunk_boxes: Vec<BoundingBox>,
}

impl DetailLevel {
    fn new(tolerance_mm: f32, points: Vec<PathPoint>) -> Self {
        let mut pieces = Vec::with_capacity(points.len() / CHUNK_POINTS + 1);
        for (index, piece) in points.chunks(CHUNK_POINTS).enumerate() {
            let mut around = BoundingBox::EMPTY;
            if let Some(before) = (index * CHUNK_POINTS).checked_sub(1) {
                around.include(points[before].at);
            }
            piece.iter().for_each(|point| around.include(point.at));
            pieces.push(around);
        }
        Self { tolerance_mm, points, chunk_boxes: pieces }
    }

    fn bounding_box(&self) -> BoundingBox {
        let mut all = BoundingBox::EMPTY;
        self.chunk_boxes.iter().flat_map(|piece| [piece.low, piece.high]).for_each(|at| all.include(at));
        all
    }

    /// The path without points closer together than the tolerance and without segments that are already drawn.
    fn simplified(&self, tolerance_mm: f32) -> Self {
        let cell = |at: [f32; 3]| at.map(|value| (value / tolerance_mm).round() as i32);
        let mut drawn = HashSet::new();
        let mut points: Vec<PathPoint> = Vec::new();
        let (mut last, mut lifted) = ([i32::MAX; 3], true);
        for point in &self.points {
            let here = cell(point.at);
            if point.kind == MoveKind::Break {
                (last, lifted) = (here, true);
                continue;
            }
            if here == last {
                continue;
            }
            let key = if last < here { (last, here, point.kind) } else { (here, last, point.kind) };
            if drawn.insert(key) {
                if lifted {
                    points.push(PathPoint { at: last.map(|value| value as f32 * tolerance_mm), kind: MoveKind::Break });
                }
                points.push(PathPoint { at: here.map(|value| value as f32 * tolerance_mm), kind: point.kind });
                lifted = false;
            } else {
                lifted = true;
            }
            last = here;
        }
        Self::new(tolerance_mm, points)
    }
}

/// How long a program takes, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CycleTime {
    /// Of a run on the simulated machine: with acceleration, waits for units of the machine, gauge and part.
    Simulated(f64),
    /// The path at the programmed feeds, without acceleration and waits.
    AtFeeds(f64),
}

impl Default for CycleTime {
    fn default() -> Self {
        Self::AtFeeds(0.0)
    }
}

impl CycleTime {
    /// Seconds.
    #[must_use]
    pub const fn seconds(self) -> f64 {
        let (Self::Simulated(seconds) | Self::AtFeeds(seconds)) = self;
        seconds
    }
}

/// A path and the results of its check run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Toolpath {
    /// O number.
    pub number: u32,
    /// Checksum of the text.
    pub stamp: u64,
    /// Levels of detail, from exact to coarse.
    pub levels: Vec<DetailLevel>,
    /// Minimum and maximum coordinates of all moves; none without a move.
    pub extents: Option<(WorkPos, WorkPos)>,
    /// Length of all moves, mm.
    pub length_mm: f64,
    /// How long the program takes.
    pub cycle_time: CycleTime,
    /// Number of lines of the text.
    pub lines: usize,
    /// The errors found.
    pub faults: Vec<LineFault>,
    /// Places where a tool collides, work coordinates (L9).
    pub crashes: Vec<[f32; 3]>,
    /// The check run reached the end; otherwise it was cancelled, aborted or truncated.
    pub finished: bool,
}

impl Toolpath {
    /// Sets the path and computes the coarser levels of detail.
    pub fn set_path(&mut self, points: Vec<PathPoint>) {
        let exact = DetailLevel::new(0.0, points);
        let size = exact.bounding_box();
        self.levels = vec![exact];
        for fineness in DETAIL_FRACTIONS {
            let Some(finer) = self.levels.last().filter(|level| level.points.len() > MIN_POINTS_TO_SIMPLIFY) else {
                break;
            };
            let coarser = finer.simplified((size.longest_side() / fineness).max(1e-6));
            self.levels.push(coarser);
        }
    }

    /// The bounding box of the path.
    #[must_use]
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        let (low, high) = self.extents?;
        let three = |values: WorkPos| [Axis::X, Axis::Y, Axis::Z].map(|axis| values[axis] as f32);
        Some(BoundingBox { low: three(low), high: three(high) })
    }
}

/// A box of the workpiece or its fixture in work coordinates. Where the workpiece turns about Z, X runs from
/// minus to plus the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockBox {
    /// Minimum coordinates, mm, radius.
    pub low: WorkPos,
    /// Maximum coordinates.
    pub high: WorkPos,
    /// True for the workpiece, false for the fixture.
    pub is_workpiece: bool,
}
