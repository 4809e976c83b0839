//! The cells of a surface along one direction (P4): `profile` has one row of them, `plane` two.

use std::ops::Range;

/// Greatest number of cells of a row that a drawing shows.
const SAMPLES: usize = 128;

/// Cells along one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellRow {
    pub(super) from_mm: f64,
    pub(super) cell_mm: f64,
    pub(super) count: usize,
}

impl CellRow {
    /// The whole cells of about this size between two positions; at least one.
    pub(super) fn new(from: f64, to: f64, cell: f64) -> Self {
        let count = ((to - from) / cell).round().max(1.0) as usize;
        Self { from_mm: from, cell_mm: (to - from) / count as f64, count }
    }

    /// Centre of a cell, mm.
    pub(super) fn middle(self, cell: usize) -> f64 {
        self.from_mm + (cell as f64 + 0.5) * self.cell_mm
    }

    /// A drawing's samples of the row: both ends and the middles of the cells, no more than `SAMPLES`.
    pub(super) fn samples(self, sample: impl Fn(f64, usize) -> [f64; 3]) -> Vec<[f64; 3]> {
        let step = self.count.div_ceil(SAMPLES);
        let ends = [(self.from_mm, 0), (self.from_mm + self.length_mm(), self.count - 1)];
        let middles = (0..self.count).step_by(step).map(|cell| (self.middle(cell), cell));
        let places = std::iter::once(ends[0]).chain(middles).chain(std::iter::once(ends[1]));
        places.map(|(place, cell)| sample(place, cell)).collect()
    }

    /// Length of the row, mm.
    pub(super) fn length_mm(self) -> f64 {
        self.cell_mm * self.count as f64
    }

    /// The cells whose centres lie from `from_mm` to below `to_mm`.
    pub(super) fn cells(self, from_mm: f64, to_mm: f64) -> Range<usize> {
        // Positions before the first cell give the first cell, positions beyond the end none.
        let cell =
            |place: f64| (((place - self.from_mm) / self.cell_mm - 0.5).ceil().max(0.0) as usize).min(self.count);
        cell(from_mm)..cell(to_mm)
    }

    /// The two cells next to a position and the weight of the second; `None` outside the row.
    pub(super) fn neighbours(self, place_mm: f64) -> Option<(usize, usize, f64)> {
        let cells = (place_mm - self.from_mm) / self.cell_mm;
        if !(0.0..=self.count as f64).contains(&cells) {
            return None;
        }
        let last = self.count - 1;
        let along = (cells - 0.5).clamp(0.0, last as f64);
        let first = along.floor() as usize;
        Some((first, (first + 1).min(last), along - along.floor()))
    }
}
