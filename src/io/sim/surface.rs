//! The surfaces of the part as height fields, and how the wheel wears them down (P4, P5).
//!
//! Contact law. A cell of the surface stands at the height h along its normal, the wheel's own surface over it at p.
//! Their overlap o = h − p is what the infeed has asked for and the contact has not yet given: o = infeed − d. P5
//! says ḋ = (infeed − d)/τ, so ȯ = ḟ − o/τ with the feed ḟ, and over a tick of dt
//!
//!   o ← o · exp(−dt · (1/τ + |v|/λ)),   h ← p + o.
//!
//! The first term is the plunge: at the feed f the size lags by f·τ, and sparks out with τ. The second is the
//! traverse: when the wheel is drawn along the surface at the speed v, ever new grains of its corner pass over the
//! cell, and a cell that was passed over on the length n·λ keeps exp(−n) of its overlap, however fast the pass.
//! λ is `traverse_face_mm` across a face (the corner does the work, so a stroke with a few millimetres of overrun
//! leaves little) and `traverse_cylinder_mm` along a cylinder; it grows with τ as the wheel gets dull.
//! Removed volume wears the wheel (`wheel.rs`), loads its motor and, per width of contact, may burn the part.
//!
//! Runout: h is the highest radius over a turn, `floor` the lowest before grinding; between them only half the turn
//! is touched. The diameter measured is the mean, h + min(h, floor).

use std::f64::consts::PI;

use super::part_file::{Looks, SurfaceFile};
use super::report::{DiameterAt, FaceAt};
use super::wheel::{Side, Wheel};
use crate::io::random::SplitMix64;

/// Wavelength of the waviness, mm.
const WAVE_MM: f64 = 7.0;

/// Where the wheel is and how it moves in this tick, part coordinates, radius.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Front of a new wheel.
    pub front_mm: f64,
    /// Left side of a new wheel.
    pub left_mm: f64,
    /// Speeds along X and Z, without sign.
    pub vx_mm_s: f64,
    pub vz_mm_s: f64,
    pub dt_s: f64,
    /// λ along a cylinder and across a face, sharp wheel.
    pub traverse_mm: (f64, f64),
}

/// What came of a cut.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cut {
    pub volume_mm3: f64,
    /// Volume over the width of contact, mm².
    pub specific_mm2: f64,
}

/// One surface with its cells.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    shape: Shape,
    /// Height along the normal: radius of a diameter, ±Z of a face.
    height_mm: Box<[f64]>,
    floor_mm: Box<[f64]>,
    /// No cell stands higher.
    highest_mm: f64,
    from_mm: f64,
    cell_mm: f64,
    /// Contact as it was in the tick before.
    pub(super) touch: Touch,
}

/// What a surface has told about its present contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Touch {
    pub burnt: bool,
    pub flat: bool,
    pub crashed: bool,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Cells along Z.
    Diameter,
    /// Cells along the radius.
    Face { side: Side, width_mm: f64, thickness_mm: f64, turns: bool },
}

impl Surface {
    /// The surface before grinding; its waviness begins by chance.
    pub(super) fn new(file: &SurfaceFile, chance: &mut SplitMix64) -> Self {
        let (from, to, cell, normal, stock, waviness, runout) = match *file {
            SurfaceFile::Diameter { z_from, z_to, stock, cell, runout, waviness } => {
                (z_from, z_to, cell, 1.0, stock / 2.0, waviness, runout)
            }
            SurfaceFile::Face { looks, x_from, x_to, stock, cell, waviness, .. } => {
                let normal = if looks == Looks::PlusZ { 1.0 } else { -1.0 };
                (x_from / 2.0, x_to / 2.0, cell, normal, stock, waviness, 0.0)
            }
        };
        let shape = match *file {
            SurfaceFile::Diameter { .. } => Shape::Diameter,
            SurfaceFile::Face { looks, width, thickness, turns, .. } => {
                let side = if looks == Looks::PlusZ { Side::Left } else { Side::Right };
                Shape::Face { side, width_mm: width, thickness_mm: thickness, turns }
            }
        };
        let count = ((to - from) / cell).round().max(1.0) as usize;
        let phase = chance.unit();
        let wave = |i: usize| waviness * (2.0 * PI * (i as f64 * cell / WAVE_MM + phase)).sin();
        let mean: Vec<f64> = (0..count).map(|i| normal * stock + wave(i)).collect();
        let height_mm: Box<[f64]> = mean.iter().map(|h| h + runout / 2.0).collect();
        Self {
            shape,
            highest_mm: height_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            floor_mm: mean.iter().map(|h| h - runout / 2.0).collect(),
            height_mm,
            from_mm: from,
            cell_mm: (to - from) / count as f64,
            touch: Touch::default(),
        }
    }

    /// Whether the part must turn for this surface to be ground.
    pub(super) const fn turns(&self) -> bool {
        match self.shape {
            Shape::Diameter => true,
            Shape::Face { turns, .. } => turns,
        }
    }

    /// Radius from which the wheel can touch it, mm.
    pub(super) fn reach_mm(&self) -> f64 {
        match self.shape {
            Shape::Diameter => self.highest_mm,
            Shape::Face { .. } => self.from_mm + self.cell_mm * self.height_mm.len() as f64,
        }
    }

    fn middle(&self, cell: usize) -> f64 {
        self.from_mm + (cell as f64 + 0.5) * self.cell_mm
    }

    /// First cell whose middle lies at or beyond a place.
    fn cell_from(&self, place_mm: f64) -> usize {
        let cell = ((place_mm - self.from_mm) / self.cell_mm - 0.5).ceil();
        // Negative places are the first cell, those beyond the end none.
        (cell.max(0.0) as usize).min(self.height_mm.len())
    }

    /// The cells under the wheel and, for a face, the wheel's surface along the normal.
    fn under(&self, pass: &Pass, wheel: &Wheel) -> (std::ops::Range<usize>, f64) {
        match self.shape {
            Shape::Diameter => {
                let cells = self.cell_from(pass.left_mm)..self.cell_from(pass.left_mm + wheel.width_mm());
                (cells, pass.front_mm)
            }
            Shape::Face { side, .. } => {
                let from = self.cell_from(pass.front_mm + wheel.corner_mm(side));
                let surface = match side {
                    Side::Left => pass.left_mm + wheel.side_mm(side),
                    Side::Right => wheel.side_mm(side) - pass.left_mm - wheel.width_mm(),
                };
                (from..self.height_mm.len(), surface)
            }
        }
    }

    /// Greatest overlap with the wheel, mm; zero or less is none.
    pub(super) fn overlap_mm(&self, pass: &Pass, wheel: &Wheel) -> f64 {
        let quick = match self.shape {
            Shape::Diameter => pass.front_mm,
            Shape::Face { side: Side::Left, .. } => pass.left_mm,
            Shape::Face { side: Side::Right, .. } => -pass.left_mm - wheel.width_mm(),
        };
        if quick >= self.highest_mm {
            return 0.0;
        }
        let (cells, surface) = self.under(pass, wheel);
        let mut greatest = 0.0_f64;
        match self.shape {
            Shape::Diameter => {
                for cell in cells {
                    let Some(slice) = wheel.slice_at(self.middle(cell) - pass.left_mm) else { continue };
                    greatest = greatest.max(self.height_mm[cell] - surface - wheel.rim_mm(slice));
                }
            }
            Shape::Face { thickness_mm, .. } => {
                for h in &self.height_mm[cells] {
                    greatest = greatest.max(h - surface);
                }
                if greatest >= thickness_mm + wheel.width_mm() {
                    return 0.0; // the whole wheel is behind the face's body
                }
            }
        }
        greatest
    }

    /// Grinds what overlaps for one tick.
    pub(super) fn grind(&mut self, pass: &Pass, wheel: &mut Wheel) -> Cut {
        match self.shape {
            Shape::Diameter => self.grind_diameter(pass, wheel),
            Shape::Face { side, width_mm, turns, .. } => self.grind_face(pass, wheel, side, (width_mm, turns)),
        }
    }

    fn grind_diameter(&mut self, pass: &Pass, wheel: &mut Wheel) -> Cut {
        let tau = wheel.rim_s();
        let lambda = pass.traverse_mm.0 * wheel.slower(tau);
        let taken = taken(pass.dt_s, tau, pass.vz_mm_s / lambda);
        let (cells, surface) = self.under(pass, wheel);
        let (mut volume, mut touched) = (0.0, 0.0);
        for cell in cells {
            let Some(slice) = wheel.slice_at(self.middle(cell) - pass.left_mm) else { continue };
            let h = self.height_mm[cell];
            let overlap = h - surface - wheel.rim_mm(slice);
            if overlap <= 0.0 {
                continue;
            }
            let depth = overlap * taken;
            let share = if h > self.floor_mm[cell] { 0.5 } else { 1.0 };
            let cell_volume = share * 2.0 * PI * h * self.cell_mm * depth;
            self.height_mm[cell] = h - depth;
            wheel.wear_rim(slice, cell_volume);
            volume += cell_volume;
            touched += self.cell_mm;
        }
        Cut { volume_mm3: volume, specific_mm2: if touched > 0.0 { volume / touched } else { 0.0 } }
    }

    fn grind_face(&mut self, pass: &Pass, wheel: &mut Wheel, side: Side, (width_mm, turns): (f64, bool)) -> Cut {
        let tau = wheel.side_s(side);
        let lambda = pass.traverse_mm.1 * wheel.slower(tau);
        let taken = taken(pass.dt_s, tau, pass.vx_mm_s / lambda);
        let (cells, surface) = self.under(pass, wheel);
        let (mut volume, mut engaged) = (0.0, 0.0);
        for cell in cells {
            let overlap = self.height_mm[cell] - surface;
            if overlap <= 0.0 {
                continue;
            }
            let depth = overlap * taken;
            let across = if turns { 2.0 * PI * self.middle(cell) } else { width_mm };
            self.height_mm[cell] -= depth;
            volume += across * self.cell_mm * depth;
            engaged += self.cell_mm;
        }
        wheel.wear_side(side, engaged, volume);
        let contact = if turns { engaged.max(self.cell_mm) } else { width_mm };
        Cut { volume_mm3: volume, specific_mm2: volume / contact }
    }

    /// Mean diameter at a place along Z, between the middles of the cells; `None` beside the surface.
    pub(super) fn diameter_at(&self, z: f64) -> Option<f64> {
        match self.shape {
            Shape::Diameter => self.between(z, |s, cell| s.height_mm[cell] + s.height_mm[cell].min(s.floor_mm[cell])),
            Shape::Face { .. } => None,
        }
    }

    /// Z of the face at a diameter, for a face that looks as asked; `None` beside the surface.
    pub(super) fn face_at(&self, x: f64, looks: Option<Looks>) -> Option<f64> {
        let Shape::Face { side, .. } = self.shape else { return None };
        let (mine, normal) = match side {
            Side::Left => (Looks::PlusZ, 1.0),
            Side::Right => (Looks::MinusZ, -1.0),
        };
        if looks.is_some_and(|looks| looks != mine) {
            return None;
        }
        self.between(x / 2.0, |s, cell| normal * s.height_mm[cell])
    }

    fn between(&self, place_mm: f64, value: impl Fn(&Self, usize) -> f64) -> Option<f64> {
        let last = self.height_mm.len() - 1;
        let cells = (place_mm - self.from_mm) / self.cell_mm;
        if !(0.0..=self.height_mm.len() as f64).contains(&cells) {
            return None;
        }
        let along = (cells - 0.5).clamp(0.0, last as f64);
        let (a, b) = (along.floor() as usize, (along.floor() as usize + 1).min(last));
        let part = along - along.floor();
        Some(value(self, a) * (1.0 - part) + value(self, b) * part)
    }

    /// Adds what the report wants of this surface.
    pub(super) fn report(&self, diameters: &mut Vec<DiameterAt>, faces: &mut Vec<FaceAt>) {
        let length = self.cell_mm * self.height_mm.len() as f64;
        let place = |tenths: f64| self.from_mm + length * tenths / 10.0;
        match self.shape {
            Shape::Diameter => {
                for z in [1.0, 3.0, 5.0, 7.0, 9.0].map(place) {
                    diameters.extend(self.diameter_at(z).map(|d| DiameterAt { z, d }));
                }
            }
            Shape::Face { .. } => {
                for x in [1.0, 5.0, 9.0].map(|tenths| 2.0 * place(tenths)) {
                    faces.extend(self.face_at(x, None).map(|z| FaceAt { x, z }));
                }
            }
        }
    }
}

/// Share of the overlap that goes in a tick: 1 − exp(−dt·(1/τ + v/λ)).
fn taken(dt_s: f64, tau_s: f64, passes_per_s: f64) -> f64 {
    -(-dt_s * (tau_s.recip() + passes_per_s)).exp_m1()
}
