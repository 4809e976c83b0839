//! One-dimensional surfaces: a diameter, cone or bore r(z), a face z(r) ground by the wheel's side, a wall of a slot,
//! a face z(r) ground by the rim on a rotary table (P4, P5). The contact law is in `surface`.
//!
//! Runout: h is the highest point over a revolution, `floor` the lowest before grinding. Above `floor` only half of the
//! revolution is in contact. The measured height is the mean of h and min(h, floor).

use std::f64::consts::PI;
use std::ops::Range;

use super::cell_row::CellRow;
use super::contact_law::{Cut, WheelMotion, removed_share, removed_share_of_lag};
use super::machine_sections::LayoutFile;
use super::part_file::{FaceDirection, SurfaceFile};
use super::report::{DiameterAt, FaceAt, PartReport};
use super::wheel::{GrindingWheel, Side};
use crate::defs::grinding_workspace::PartSection;
use crate::io::random::SplitMix64;

/// Wavelength of the waviness, mm.
const WAVE_MM: f64 = 7.0;

/// One line of cells.
#[derive(Clone, Debug)]
pub(super) struct ProfileSurface {
    shape: ProfileShape,
    /// Height along the normal: radius of a diameter, minus that of a bore, ±Z of a face, Z of a disc.
    height_mm: Box<[f64]>,
    floor_mm: Box<[f64]>,
    /// Height of the highest cell.
    highest_mm: f64,
    row: CellRow,
}

#[derive(Clone, Copy, Debug)]
enum ProfileShape {
    /// Outer diameter: cells along the wheel's axis.
    Diameter,
    /// Bore: the height is minus the radius; thickness of the material around it, mm.
    Bore { thickness_mm: f64 },
    /// Cells along the infeed, ground by a side of the wheel.
    Face { side: Side, width_mm: f64, thickness_mm: f64, turns: bool, wall: Option<Wall> },
    /// Cells along the radius of a rotary table, ground by the rim.
    Disc,
}

/// Extent along the stroke of a face that does not rotate.
#[derive(Clone, Copy, Debug)]
struct Wall {
    from_mm: f64,
    to_mm: f64,
}

/// Values common to the one-dimensional surfaces of a part file.
struct ProfileSpec {
    from: f64,
    to: f64,
    cell: f64,
    /// +1 or −1: height = normal · stock.
    normal: f64,
    stock: f64,
    /// Height of the other end above the first.
    rise: f64,
    waviness: f64,
    runout: f64,
    shape: ProfileShape,
}

const fn side_of(looks: FaceDirection) -> (Side, f64) {
    match looks {
        FaceDirection::PlusZ => (Side::Left, 1.0),
        FaceDirection::MinusZ => (Side::Right, -1.0),
    }
}

/// The common values of a surface; `None` for a plane.
fn profile_spec(file: &SurfaceFile) -> Option<ProfileSpec> {
    let (normal, rise, waviness, runout) = (1.0, 0.0, 0.0, 0.0);
    let spec =
        |from, to, cell, stock, shape| ProfileSpec { from, to, cell, normal, stock, rise, waviness, runout, shape };
    match *file {
        SurfaceFile::Diameter { z_from, z_to, stock, cell, runout, waviness } => {
            let spec = spec(z_from, z_to, cell, stock / 2.0, ProfileShape::Diameter);
            Some(ProfileSpec { waviness, runout, ..spec })
        }
        SurfaceFile::Cone { z_from, z_to, stock_from, stock_to, cell, runout, waviness } => {
            let spec = spec(z_from, z_to, cell, stock_from / 2.0, ProfileShape::Diameter);
            Some(ProfileSpec { rise: (stock_to - stock_from) / 2.0, waviness, runout, ..spec })
        }
        SurfaceFile::Bore { z_from, z_to, stock_from, stock_to, thickness, cell, runout, waviness } => {
            let spec = spec(z_from, z_to, cell, stock_from / 2.0, ProfileShape::Bore { thickness_mm: thickness });
            Some(ProfileSpec { normal: -1.0, rise: (stock_from - stock_to) / 2.0, waviness, runout, ..spec })
        }
        SurfaceFile::Face { looks, x_from, x_to, stock, cell, waviness, width, thickness, turns } => {
            let (side, normal) = side_of(looks);
            let shape = ProfileShape::Face { side, width_mm: width, thickness_mm: thickness, turns, wall: None };
            Some(ProfileSpec { normal, waviness, ..spec(x_from / 2.0, x_to / 2.0, cell, stock, shape) })
        }
        SurfaceFile::Wall { looks, x_from, x_to, y_from, y_to, stock, cell, thickness, waviness } => {
            let (side, normal) = side_of(looks);
            let wall = Some(Wall { from_mm: x_from, to_mm: x_to });
            let width_mm = x_to - x_from;
            let shape = ProfileShape::Face { side, width_mm, thickness_mm: thickness, turns: false, wall };
            Some(ProfileSpec { normal, waviness, ..spec(y_from, y_to, cell, stock, shape) })
        }
        SurfaceFile::Disc { x_from, x_to, stock, cell, runout, waviness } => {
            Some(ProfileSpec { waviness, runout, ..spec(x_from, x_to, cell, stock, ProfileShape::Disc) })
        }
        SurfaceFile::Plane { .. } => None,
    }
}

impl ProfileSurface {
    /// The surface before grinding; the phase of its waviness is random. `None` if the file describes a plane.
    pub(super) fn new(file: &SurfaceFile, chance: &mut SplitMix64) -> Option<Self> {
        let ProfileSpec { from, to, cell, normal, stock, rise, waviness, runout, shape } = profile_spec(file)?;
        let row = CellRow::new(from, to, cell);
        let count = row.count;
        let phase = chance.next_unit();
        let wave = |i: usize| waviness * (2.0 * PI * (i as f64 * cell / WAVE_MM + phase)).sin();
        let height = |i: usize| normal * stock + rise * (i as f64 + 0.5) / count as f64;
        let mean: Vec<f64> = (0..count).map(|i| height(i) + wave(i)).collect();
        let height_mm: Box<[f64]> = mean.iter().map(|h| h + runout / 2.0).collect();
        Some(Self {
            shape,
            highest_mm: height_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            floor_mm: mean.iter().map(|h| h - runout / 2.0).collect(),
            height_mm,
            row,
        })
    }

    /// Whether the part must rotate for this surface to be ground.
    pub(super) const fn needs_rotation(&self) -> bool {
        !matches!(self.shape, ProfileShape::Face { turns: false, .. })
    }

    /// Whether the rim grinds it, not a side of the wheel.
    pub(super) const fn is_ground_by_rim(&self) -> bool {
        !matches!(self.shape, ProfileShape::Face { .. })
    }

    /// Position along the infeed below which the wheel can touch the surface, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Disc => self.highest_mm,
            ProfileShape::Bore { thickness_mm } => self.outside_mm(thickness_mm),
            ProfileShape::Face { .. } => self.row.from_mm + self.row.length_mm(),
        }
    }

    /// Outer radius of the material around a bore, mm.
    fn outside_mm(&self, thickness_mm: f64) -> f64 {
        thickness_mm - self.height_mm.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Unworn rim over a cell, along the normal, mm.
    fn rim_over(&self, cell: usize, surface: f64, pass: &WheelMotion) -> f64 {
        let back = pass.swivel_tan * (self.row.middle(cell) - pass.left_mm);
        if matches!(self.shape, ProfileShape::Bore { .. }) { surface + back } else { surface - back }
    }

    /// The cells under the wheel, and the wheel's surface along the normal, mm.
    fn cells_under(&self, pass: &WheelMotion, wheel: &GrindingWheel) -> (Range<usize>, f64) {
        match self.shape {
            ProfileShape::Diameter => {
                let cells = self.row.cells(pass.left_mm, pass.left_mm + wheel.width_mm);
                (cells, pass.front_mm)
            }
            ProfileShape::Bore { .. } => {
                let cells = self.row.cells(pass.left_mm, pass.left_mm + wheel.width_mm);
                // The wheel's centre is off the part's axis; the rim on the far side touches the bore.
                (cells, -(pass.front_mm + wheel.radius_mm).abs() - wheel.radius_mm)
            }
            ProfileShape::Disc => {
                // Beyond the table's centre the wheel covers radii on the other side.
                let right = pass.left_mm + wheel.width_mm;
                let (from, to) = if pass.left_mm >= 0.0 {
                    (pass.left_mm, right)
                } else if right <= 0.0 {
                    (-right, -pass.left_mm)
                } else {
                    (0.0, right.max(-pass.left_mm))
                };
                (self.row.cells(from, to), pass.front_mm)
            }
            ProfileShape::Face { side, .. } => {
                let cells = self.row.cells(pass.front_mm + wheel.corner_wear_mm(side), f64::INFINITY);
                let surface = match side {
                    Side::Left => pass.left_mm + wheel.side_wear_mm(side),
                    Side::Right => wheel.side_wear_mm(side) - pass.left_mm - wheel.width_mm,
                };
                (cells, surface)
            }
        }
    }

    /// The slice of the rim over a cell; of two, on both sides of the table's centre, the less worn one.
    fn slice_over(&self, cell: usize, pass: &WheelMotion, wheel: &GrindingWheel) -> Option<usize> {
        let middle = self.row.middle(cell);
        let slice = wheel.slice_at(middle - pass.left_mm);
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } | ProfileShape::Face { .. } => slice,
            ProfileShape::Disc => match (slice, wheel.slice_at(-middle - pass.left_mm)) {
                (Some(a), Some(b)) => Some(if wheel.rim_wear_mm[a] <= wheel.rim_wear_mm[b] { a } else { b }),
                (a, b) => a.or(b),
            },
        }
    }

    /// Share of a wall's length that the wheel's side covers; 1 for other surfaces.
    fn covered_share(&self, pass: &WheelMotion, wheel: &GrindingWheel) -> f64 {
        let ProfileShape::Face { wall: Some(wall), .. } = self.shape else { return 1.0 };
        let half = wheel.half_chord_mm(self.reach_mm() - pass.front_mm);
        let common = wall.to_mm.min(pass.stroke_mm + half) - wall.from_mm.max(pass.stroke_mm - half);
        (common / (wall.to_mm - wall.from_mm)).max(0.0)
    }

    /// Greatest overlap with the wheel, mm; zero without contact.
    pub(super) fn overlap_mm(&self, pass: &WheelMotion, wheel: &GrindingWheel) -> f64 {
        let quick = match self.shape {
            // Limit of the rim, swivelled or not: no slice reaches further.
            ProfileShape::Diameter | ProfileShape::Disc => pass.front_mm - pass.swivel_tan.max(0.0) * wheel.width_mm,
            ProfileShape::Bore { thickness_mm } if pass.front_mm >= self.outside_mm(thickness_mm) => return 0.0,
            ProfileShape::Bore { .. } => self.cells_under(pass, wheel).1 + pass.swivel_tan.min(0.0) * wheel.width_mm,
            ProfileShape::Face { side: Side::Left, .. } => pass.left_mm,
            ProfileShape::Face { side: Side::Right, .. } => -pass.left_mm - wheel.width_mm,
        };
        if quick >= self.highest_mm || self.covered_share(pass, wheel) <= 0.0 {
            return 0.0;
        }
        let (cells, surface) = self.cells_under(pass, wheel);
        let mut greatest = 0.0_f64;
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } | ProfileShape::Disc => {
                for cell in cells {
                    let Some(slice) = self.slice_over(cell, pass, wheel) else { continue };
                    let rim = self.rim_over(cell, surface, pass);
                    greatest = greatest.max(self.height_mm[cell] - rim - wheel.rim_wear_mm[slice]);
                }
            }
            ProfileShape::Face { thickness_mm, .. } => {
                for h in &self.height_mm[cells] {
                    greatest = greatest.max(h - surface);
                }
                if greatest >= thickness_mm + wheel.width_mm {
                    return 0.0; // the whole wheel is behind the face's body
                }
            }
        }
        greatest
    }

    /// Grinds the overlap for one tick.
    pub(super) fn grind(&mut self, pass: &WheelMotion, wheel: &mut GrindingWheel) -> Cut {
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } | ProfileShape::Disc => self.grind_round(pass, wheel),
            ProfileShape::Face { side, width_mm, turns, .. } => {
                self.grind_face(pass, wheel, side, (!turns).then_some(width_mm))
            }
        }
    }

    /// Width of an even contact with the same force, mm: the sum of the overlaps over the greatest.
    fn even_width_mm(&self, cells: Range<usize>, surface: f64, pass: &WheelMotion, wheel: &GrindingWheel) -> f64 {
        let overlap = |cell: usize| {
            let slice = self.slice_over(cell, pass, wheel)?;
            Some(self.height_mm[cell] - self.rim_over(cell, surface, pass) - wheel.rim_wear_mm[slice])
        };
        let (sum, greatest) = cells
            .filter_map(overlap)
            .filter(|mm| *mm > 0.0)
            .fold((0.0, 0.0_f64), |(sum, most), mm| (sum + mm, most.max(mm)));
        if greatest > 0.0 { sum / greatest * self.row.cell_mm } else { 0.0 }
    }

    /// Grinds a rotating part with the rim.
    fn grind_round(&mut self, pass: &WheelMotion, wheel: &mut GrindingWheel) -> Cut {
        let tau = wheel.rim_time_constant_s();
        let dullness_factor = wheel.dullness_factor(tau);
        let lambda = pass.traverse.across_mm * dullness_factor;
        let taken = removed_share(pass.dt_s, tau, pass.across_mm_s / lambda);
        let (cells, surface) = self.cells_under(pass, wheel);
        let wheel_middle_mm = pass.left_mm + wheel.width_mm / 2.0;
        let bending = pass.bending.map(|bending| (bending, self.even_width_mm(cells.clone(), surface, pass, wheel)));
        let (mut volume, mut touched, mut way) = (0.0, 0.0, 0.0);
        for cell in cells {
            let Some(slice) = self.slice_over(cell, pass, wheel) else { continue };
            let h = self.height_mm[cell];
            let overlap = h - self.rim_over(cell, surface, pass) - wheel.rim_wear_mm[slice];
            if overlap <= 0.0 {
                continue;
            }
            let radius = if matches!(self.shape, ProfileShape::Disc) { self.row.middle(cell) } else { h.abs() };
            let lag = bending.map(|(bending, width_mm)| {
                bending.lag_factor(self.row.middle(cell), width_mm, radius, wheel_middle_mm)
            });
            let depth = overlap * lag.map_or(taken, |lag| removed_share_of_lag(taken, lag));
            let share = if h > self.floor_mm[cell] { 0.5 } else { 1.0 };
            let cell_volume = share * 2.0 * PI * radius * self.row.cell_mm * depth;
            self.height_mm[cell] = h - depth;
            wheel.wear_rim(slice, cell_volume, cell_volume / (self.row.cell_mm * pass.dt_s));
            volume += cell_volume;
            touched += self.row.cell_mm;
            way += 2.0 * PI * radius * self.row.cell_mm;
        }
        if touched <= 0.0 {
            return Cut::default();
        }
        let work_mm_s = Some(way / touched * pass.part_turns_s);
        let passed_share = pass.part_turns_s * pass.dt_s * touched / self.row.length_mm();
        Cut { volume_mm3: volume, specific_mm2: volume / touched, dullness_factor, work_mm_s, passed_share }
    }

    /// Grinds a face with the side of the wheel: a wall `wall_mm` wide, which stroke and infeed both traverse, or a
    /// rotating face.
    fn grind_face(&mut self, pass: &WheelMotion, wheel: &mut GrindingWheel, side: Side, wall_mm: Option<f64>) -> Cut {
        let tau = wheel.side_time_constant_s(side);
        let dullness_factor = wheel.dullness_factor(tau);
        let lambda = pass.traverse.face_mm * dullness_factor;
        let covered = self.covered_share(pass, wheel).min(1.0);
        let along_mm_s = pass.infeed_mm_s + pass.stroke_mm_s;
        let taken = removed_share(pass.dt_s * covered, tau, along_mm_s / lambda);
        let (cells, surface) = self.cells_under(pass, wheel);
        let (mut volume, mut engaged, mut way) = (0.0, 0.0, 0.0);
        for cell in cells {
            let overlap = self.height_mm[cell] - surface;
            if overlap <= 0.0 {
                continue;
            }
            let depth = overlap * taken;
            let across = wall_mm.unwrap_or_else(|| 2.0 * PI * self.row.middle(cell));
            self.height_mm[cell] -= depth;
            volume += across * self.row.cell_mm * depth;
            engaged += self.row.cell_mm;
            way += across * self.row.cell_mm;
        }
        let contact = wall_mm.unwrap_or_else(|| engaged.max(self.row.cell_mm));
        wheel.wear_side(side, engaged, volume, volume / (contact * pass.dt_s));
        let turned_mm_s = way / engaged.max(self.row.cell_mm) * pass.part_turns_s;
        let work_mm_s = wall_mm.is_none().then_some(turned_mm_s);
        let turns_s = if wall_mm.is_none() { pass.part_turns_s } else { pass.stroke_mm_s / contact };
        let passed_share = turns_s * pass.dt_s * engaged / self.row.length_mm();
        Cut { volume_mm3: volume, specific_mm2: volume / contact, dullness_factor, work_mm_s, passed_share }
    }

    /// Depth of a point inside the surface along its normal, mm; `None` outside or behind the surface.
    pub(super) fn penetration_mm(&self, at: &WheelMotion) -> Option<f64> {
        match self.shape {
            ProfileShape::Diameter => self.interpolate(at.left_mm, |s, cell| s.height_mm[cell] - at.front_mm),
            ProfileShape::Bore { thickness_mm } => {
                let inside = self.interpolate(at.left_mm, |s, cell| s.height_mm[cell] + at.front_mm.abs());
                inside.filter(|inside| *inside < thickness_mm)
            }
            ProfileShape::Disc => self.interpolate(at.left_mm.abs(), |s, cell| s.height_mm[cell] - at.front_mm),
            ProfileShape::Face { side, thickness_mm, wall, .. } => {
                if wall.is_some_and(|wall| !(wall.from_mm..=wall.to_mm).contains(&at.stroke_mm)) {
                    return None;
                }
                let place = if side == Side::Left { at.left_mm } else { -at.left_mm };
                self.interpolate(at.front_mm, |s, cell| s.height_mm[cell] - place)
                    .filter(|inside| *inside < thickness_mm)
            }
        }
    }

    /// Mean height of a cell over a revolution, mm.
    fn mean(&self, cell: usize) -> f64 {
        0.5 * (self.height_mm[cell] + self.height_mm[cell].min(self.floor_mm[cell]))
    }

    /// Mean diameter at Z, interpolated between the cell centres, mm; `None` outside the surface.
    pub(super) fn diameter_at(&self, z: f64) -> Option<f64> {
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } => {
                self.interpolate(z, |s, cell| 2.0 * s.mean(cell).abs())
            }
            ProfileShape::Face { .. } | ProfileShape::Disc => None,
        }
    }

    /// Z of the face at X, of the given direction if one is given; `None` outside the surface. X is a diameter, on a
    /// disc the radius, on a wall the position along the stroke (measured at half its height).
    pub(super) fn face_at(&self, x: f64, looks: Option<FaceDirection>) -> Option<f64> {
        let (side, wall) = match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } => return None,
            ProfileShape::Disc => return self.height_at(x),
            ProfileShape::Face { side, wall, .. } => (side, wall),
        };
        let (mine, normal) = match side {
            Side::Left => (FaceDirection::PlusZ, 1.0),
            Side::Right => (FaceDirection::MinusZ, -1.0),
        };
        if looks.is_some_and(|looks| looks != mine) {
            return None;
        }
        let place = match wall {
            None => x / 2.0,
            Some(wall) if (wall.from_mm..=wall.to_mm).contains(&x) => self.row.from_mm + 0.5 * self.row.length_mm(),
            Some(_) => return None,
        };
        self.interpolate(place, |s, cell| normal * s.height_mm[cell])
    }

    /// Mean height of a disc at a radius on either side of the centre, mm; `None` outside the disc.
    pub(super) fn height_at(&self, x: f64) -> Option<f64> {
        if matches!(self.shape, ProfileShape::Disc) { self.interpolate(x.abs(), Self::mean) } else { None }
    }

    /// A value between the two cells next to a position; `None` outside the surface.
    fn interpolate(&self, place_mm: f64, value: impl Fn(&Self, usize) -> f64) -> Option<f64> {
        let (a, b, share) = self.row.neighbours(place_mm)?;
        Some(value(self, a) * (1.0 - share) + value(self, b) * share)
    }

    /// The section of the material, as it is now, for the drawing.
    pub(super) fn section(&self, layout: LayoutFile) -> PartSection {
        let (across, infeed) = (layout.across, layout.infeed);
        let (along, height, mirrored) = match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } => (across, infeed, Some(infeed)),
            ProfileShape::Face { turns, .. } => (infeed, across, turns.then_some(infeed)),
            ProfileShape::Disc => (across, infeed, Some(across)),
        };
        let sample = |place: f64, cell: usize| {
            let mean = self.mean(cell);
            let (low, high) = match self.shape {
                ProfileShape::Diameter | ProfileShape::Disc => (0.0, mean),
                ProfileShape::Bore { thickness_mm } => (-mean, self.outside_mm(thickness_mm)),
                ProfileShape::Face { side: Side::Left, thickness_mm, .. } => (mean - thickness_mm, mean),
                ProfileShape::Face { side: Side::Right, thickness_mm, .. } => (-mean, thickness_mm - mean),
            };
            [place, low, high]
        };
        PartSection { along, height, mirrored, samples: self.row.samples(sample) }
    }

    /// Adds the diameters or heights of the first and the last cell to the report.
    pub(super) fn report_ends(&self, report: &mut PartReport) {
        for place in [self.row.from_mm, self.row.from_mm + self.row.length_mm()] {
            report.diameters.extend(self.diameter_at(place).map(|d| DiameterAt { z: place, d }));
            report.faces.extend(self.height_at(place).map(|z| FaceAt { x: place, z }));
        }
    }

    /// Adds the measurements of this surface to the report.
    pub(super) fn report(&self, report: &mut PartReport) {
        let place = |tenths: f64| self.row.from_mm + self.row.length_mm() * tenths / 10.0;
        let thirds = [1.0, 5.0, 9.0];
        match self.shape {
            ProfileShape::Diameter | ProfileShape::Bore { .. } => {
                for z in [1.0, 3.0, 5.0, 7.0, 9.0].map(place) {
                    report.diameters.extend(self.diameter_at(z).map(|d| DiameterAt { z, d }));
                }
            }
            ProfileShape::Disc => {
                for x in thirds.map(place) {
                    report.faces.extend(self.height_at(x).map(|z| FaceAt { x, z }));
                }
            }
            ProfileShape::Face { wall: None, .. } => {
                for x in thirds.map(|tenths| 2.0 * place(tenths)) {
                    report.faces.extend(self.face_at(x, None).map(|z| FaceAt { x, z }));
                }
            }
            ProfileShape::Face { wall: Some(wall), .. } => {
                let x = 0.5 * (wall.from_mm + wall.to_mm);
                report.faces.extend(self.face_at(x, None).map(|z| FaceAt { x, z }));
            }
        }
    }
}
