//! A plane y(x, z) on the magnet, ground by the rim of a wheel whose axis is along Z while the table strokes along
//! X (P4, P5). The contact law is in `surface`.
//!
//! Over a cell at the distance d along X the rim is about d²/2R above its lowest point (the code uses the exact
//! circle). Within half the contact length it is flat, because wheel and part deform. In a tick the wheel sweeps an
//! interval of X. A cell is cut at the closest approach and counts the sweep length within the contact. A pass over the
//! whole contact length c leaves exp(−c/λ) of the overlap, at any speed and tick time.

use std::f64::consts::PI;
use std::ops::Range;

use super::cell_row::CellRow;
use super::contact_law::{Cut, WheelMotion, removed_share};
use super::machine_sections::LayoutFile;
use super::part_file::SurfaceFile;
use super::report::{HeightAt, PartReport};
use super::wheel::GrindingWheel;
use crate::defs::grinding_workspace::PartSection;
use crate::io::random::SplitMix64;

/// Wavelengths of the waviness along X and along Z, mm.
const WAVES_MM: (f64, f64) = (23.0, 17.0);

/// A two-dimensional field of cells.
#[derive(Clone, Debug)]
pub(super) struct PlaneSurface {
    x: CellRow,
    z: CellRow,
    /// Heights in columns along Z, ordered along X.
    height_mm: Box<[f64]>,
    /// Height of the highest cell.
    pub(super) highest_mm: f64,
    /// Height of the highest cell of each column; columns below the wheel are skipped.
    column_top_mm: Box<[f64]>,
    /// Wear of the rim over each row in this tick; valid only for the rows under the wheel.
    rim_wear_mm: Box<[f64]>,
    /// Depth removed from each row in this tick, mm.
    removed_mm: Box<[f64]>,
}

impl PlaneSurface {
    /// The plane before grinding; the phase of its waviness is random. `None` if the file describes something else.
    pub(super) fn new(file: &SurfaceFile, chance: &mut SplitMix64) -> Option<Self> {
        let SurfaceFile::Plane { x_from, x_to, z_from, z_to, stock, cell, waviness } = *file else { return None };
        let (x, z) = (CellRow::new(x_from, x_to, cell), CellRow::new(z_from, z_to, cell));
        let phases = (chance.next_unit(), chance.next_unit());
        let wave = |place: f64, length: f64, phase: f64| (2.0 * PI * (place / length + phase)).sin();
        let height = |i: usize| {
            let along_x = wave(x.middle(i / z.count), WAVES_MM.0, phases.0);
            let along_z = wave(z.middle(i % z.count), WAVES_MM.1, phases.1);
            stock + 0.5 * waviness * (along_x + along_z)
        };
        let height_mm: Box<[f64]> = (0..x.count * z.count).map(height).collect();
        let highest_mm = height_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let column = |column: &[f64]| column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let column_mm = height_mm.chunks(z.count).map(column).collect();
        let row = vec![0.0; z.count].into_boxed_slice();
        Some(Self { x, z, height_mm, highest_mm, column_top_mm: column_mm, rim_wear_mm: row.clone(), removed_mm: row })
    }

    /// The ranges of cells along X and Z that the wheel may touch in this tick.
    fn cells_under(&self, pass: &WheelMotion, wheel: &GrindingWheel) -> (Range<usize>, Range<usize>) {
        let half = 0.5 * pass.traverse.contact_mm + wheel.half_chord_mm(self.highest_mm - pass.front_mm);
        let (least, most) = pass.sweep_mm();
        let x = self.x.cells(least - half, most + half);
        let z = self.z.cells(pass.left_mm, pass.left_mm + wheel.width_mm);
        (x, z)
    }

    /// Over a column in this tick, both mm: least height of the rim above its lowest point, and the length of the sweep
    /// within the contact.
    fn sweep_over(&self, x: usize, pass: &WheelMotion, wheel: &GrindingWheel) -> (f64, f64) {
        let (middle, flat, (least, most)) = (self.x.middle(x), 0.5 * pass.traverse.contact_mm, pass.sweep_mm());
        let off = ((least - middle).max(middle - most) - flat).max(0.0);
        let radius = wheel.radius_mm;
        let lift = radius - (radius * radius - off * off).max(0.0).sqrt();
        let way = most.min(middle + flat) - least.max(middle - flat);
        (lift, way.max(0.0))
    }

    /// Greatest overlap with the wheel, mm; zero without contact.
    pub(super) fn overlap_mm(&mut self, pass: &WheelMotion, wheel: &GrindingWheel) -> f64 {
        if pass.front_mm >= self.highest_mm {
            return 0.0;
        }
        let (xs, zs) = self.cells_under(pass, wheel);
        if xs.is_empty() || zs.is_empty() {
            return 0.0;
        }
        for z in zs.clone() {
            let slice = wheel.slice_at(self.z.middle(z) - pass.left_mm);
            self.rim_wear_mm[z] = slice.map_or(f64::INFINITY, |slice| wheel.rim_wear_mm[slice]);
        }
        let mut greatest = 0.0_f64;
        for x in xs {
            let surface = pass.front_mm + self.sweep_over(x, pass, wheel).0;
            if surface < self.column_top_mm[x] {
                let heights = &self.height_mm[x * self.z.count..][zs.clone()];
                for (h, rim) in heights.iter().zip(&self.rim_wear_mm[zs.clone()]) {
                    greatest = greatest.max(h - surface - rim);
                }
            }
        }
        greatest
    }

    /// Grinds the overlap for one tick. Call `overlap_mm` first: it updates `rim_mm`.
    pub(super) fn grind(&mut self, pass: &WheelMotion, wheel: &mut GrindingWheel) -> Cut {
        let tau = wheel.rim_time_constant_s();
        let slower = wheel.dullness_factor(tau);
        let across = pass.across_mm_s / (pass.traverse.across_mm * slower);
        let (xs, zs) = self.cells_under(pass, wheel);
        self.removed_mm[zs.clone()].fill(0.0);
        let mut widest = 0;
        for x in xs {
            let (lift, way) = self.sweep_over(x, pass, wheel);
            let surface = pass.front_mm + lift;
            if surface >= self.column_top_mm[x] {
                continue;
            }
            let taken = removed_share(pass.dt_s, tau, across + way / (pass.traverse.plane_mm * slower * pass.dt_s));
            widest = widest.max(self.grind_column(x, &zs, surface, taken));
        }
        let area = self.x.cell_mm * self.z.cell_mm;
        let mut volume = 0.0;
        for z in zs {
            let gave = area * self.removed_mm[z];
            if gave > 0.0
                && let Some(slice) = wheel.slice_at(self.z.middle(z) - pass.left_mm)
            {
                wheel.wear_rim(slice, gave, gave / (self.z.cell_mm * pass.dt_s));
                volume += gave;
            }
        }
        let width = widest as f64 * self.z.cell_mm;
        let specific_mm2 = if widest > 0 { volume / width } else { 0.0 };
        let passed_share = pass.stroke_mm_s * pass.dt_s / self.x.length_mm() * width / self.z.length_mm();
        let work_mm_s = Some(pass.stroke_mm_s);
        Cut { volume_mm3: volume, specific_mm2, dullness_factor: slower, work_mm_s, passed_share }
    }

    /// Removes a share of the overlap in a column; returns the number of cells touched.
    fn grind_column(&mut self, x: usize, zs: &Range<usize>, surface: f64, taken: f64) -> usize {
        let column = &mut self.height_mm[x * self.z.count..][..self.z.count];
        let (rims, gave) = (&self.rim_wear_mm[zs.clone()], &mut self.removed_mm[zs.clone()]);
        let mut touched = 0;
        for ((h, rim), gave) in column[zs.clone()].iter_mut().zip(rims).zip(gave) {
            let overlap = (*h - surface - rim).max(0.0);
            touched += usize::from(overlap > 0.0);
            *h -= overlap * taken;
            *gave += overlap * taken;
        }
        if touched > 0 {
            self.column_top_mm[x] = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        }
        touched
    }

    /// Height at a position, interpolated between the cell centres, mm; `None` outside the plane.
    pub(super) fn height_at(&self, x: f64, z: f64) -> Option<f64> {
        let ((xa, xb, xs), (za, zb, zs)) = (self.x.neighbours(x)?, self.z.neighbours(z)?);
        let across = |x: usize| {
            let column = x * self.z.count;
            self.height_mm[column + za] * (1.0 - zs) + self.height_mm[column + zb] * zs
        };
        Some(across(xa) * (1.0 - xs) + across(xb) * xs)
    }

    /// The sections along Z at the wheel, along X under the middle of the wheel, and from above, for the drawing. A wheel
    /// beside the plane shows the section at its nearest edge.
    pub(super) fn sections(&self, layout: LayoutFile, stroke_mm: f64, left_mm: f64) -> Vec<PartSection> {
        let Some(stroke) = layout.stroke else { return Vec::new() };
        let cell = |row: CellRow, place: f64| {
            let at = (place - row.from_mm) / row.cell_mm;
            (at.max(0.0) as usize).min(row.count - 1)
        };
        let (x, z) = (cell(self.x, stroke_mm), cell(self.z, left_mm));
        let height = |x: usize, z: usize| self.height_mm[x * self.z.count + z];
        let section = |along, height, samples| PartSection { along, height, mirrored: None, samples };
        let (from, to) = (self.z.from_mm, self.z.from_mm + self.z.length_mm());
        vec![
            section(layout.across, layout.infeed, self.z.samples(|place, z| [place, 0.0, height(x, z)])),
            section(stroke, layout.infeed, self.x.samples(|place, x| [place, 0.0, height(x, z)])),
            section(stroke, layout.across, self.x.samples(|place, _| [place, from, to])),
        ]
    }

    /// Adds the heights of this plane to the report: five positions along X by three along Z.
    pub(super) fn report(&self, report: &mut PartReport) {
        let place = |row: CellRow, tenths: f64| row.from_mm + row.length_mm() * tenths / 10.0;
        for z in [1.0, 5.0, 9.0].map(|tenths| place(self.z, tenths)) {
            for x in [1.0, 3.0, 5.0, 7.0, 9.0].map(|tenths| place(self.x, tenths)) {
                report.heights.extend(self.height_at(x, z).map(|y| HeightAt { x, z, y }));
            }
        }
    }
}
