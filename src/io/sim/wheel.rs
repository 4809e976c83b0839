//! The wheel's shape: a rectangle whose rim is stored slice by slice along its width, and whose two sides
//! wear (P2, P6).
//!
//! Wear: removing a part volume V costs the wheel the volume V/G. On a slice of width b at diameter D the rim wears by
//! V/(G·π·D·b); a side engaged to the depth e wears by V/(G·π·D·e). Under load grains break out: G falls with the removal rate
//! per width, G(Q'w) = G·Q'w^−g. At the corners of the rim grains have bond on one side only: it wears `corner_wear` times as
//! much there. Source: F. Klocke, Manufacturing Processes 2, 2009, section "tool wear" (radial and edge wear).
//! Dullness: 0 sharp to 1 dull, rising by V/`dull_after_mm3`; with it the time constant of the contact rises from
//! `sharp_s` to `dull_s`. A pass of the diamond sharpens only the slices that it cuts.

use std::f64::consts::PI;

use super::machine_sections::{CuttingFile, WheelFile};
use crate::technology::DressingPass;

/// Number of slices along the width.
const SLICES: usize = 20;
/// How a new wheel was dressed: depth of the last pass, mm, and its overlap ratio. DECISION: for an Ra of 0.4 µm.
const NEW_DEPTH_MM: f64 = 0.02;
const NEW_OVERLAP: f64 = 4.0;
/// Length of a corner along the rim, mm. DECISION.
const CORNER_MM: f64 = 3.0;
/// Density of a vitrified corundum wheel, kg/mm³.
const DENSITY_KG_MM3: f64 = 2.2e-6;
/// Smallest engagement depth used for the wear of a side, mm.
const LEAST_ENGAGEMENT_MM: f64 = 1.0;

/// Side of the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The side towards −Z.
    Left,
    /// The side towards +Z.
    Right,
}

/// The wheel.
#[derive(Clone, Debug)]
pub(super) struct GrindingWheel {
    /// Radius when new, mm.
    pub(super) radius_mm: f64,
    /// Width when new, mm.
    pub(super) width_mm: f64,
    slices_per_mm: f64,
    grinding_ratio: f64,
    /// g of G(Q'w) = G·Q'w^−g.
    wear_exponent: f64,
    corner_wear: f64,
    /// Wear of a slice per removed volume, mm/mm³.
    rim_wear_per_mm3: f64,
    dullness_per_mm3: f64,
    /// Wear of each slice of the rim (dressing included), from −Z to +Z, mm.
    pub(super) rim_wear_mm: [f64; SLICES],
    /// Sum of `rim_wear_mm`, mm.
    rim_wear_sum_mm: f64,
    side_wear_mm: [f64; 2],
    /// Dullness of the rim, 0 to 1.
    pub(super) rim_dullness: f64,
    side_dullness: [f64; 2],
    sharp_s: f64,
    dull_s: f64,
    /// The last pass of the diamond over the rim.
    pub(super) dressed_by: DressingPass,
}

impl GrindingWheel {
    /// A new, sharp wheel.
    pub(super) fn new(file: &WheelFile, cutting: &CuttingFile) -> Self {
        let slice_mm = file.width_mm / SLICES as f64;
        Self {
            radius_mm: file.diameter_mm / 2.0,
            width_mm: file.width_mm,
            slices_per_mm: slice_mm.recip(),
            grinding_ratio: file.grinding_ratio,
            wear_exponent: file.wear_exponent,
            corner_wear: file.corner_wear,
            rim_wear_per_mm3: (file.grinding_ratio * PI * file.diameter_mm * slice_mm).recip(),
            dullness_per_mm3: cutting.dull_after_mm3.recip(),
            rim_wear_mm: [0.0; SLICES],
            rim_wear_sum_mm: 0.0,
            side_wear_mm: [0.0; 2],
            rim_dullness: 0.0,
            side_dullness: [0.0; 2],
            sharp_s: cutting.sharp_s,
            dull_s: cutting.dull_s,
            dressed_by: DressingPass::of_overlap(NEW_DEPTH_MM, NEW_OVERLAP),
        }
    }

    /// Scales the grinding ratio and the volume that dulls the wheel by these factors: another batch of the same wheel.
    pub(super) fn set_batch_factors(&mut self, file: &WheelFile, cutting: &CuttingFile, factors: [f64; 2]) {
        let whole = Self::new(file, cutting);
        self.grinding_ratio = file.grinding_ratio * factors[0];
        self.rim_wear_per_mm3 = whole.rim_wear_per_mm3 / factors[0];
        self.dullness_per_mm3 = whole.dullness_per_mm3 / factors[1];
    }

    /// Half the chord of the wheel at a height above its lowest point, mm.
    pub(super) fn half_chord_mm(&self, up_mm: f64) -> f64 {
        let up = up_mm.clamp(0.0, self.radius_mm);
        (up * (2.0 * self.radius_mm - up)).sqrt()
    }

    /// Turns per second at a peripheral speed.
    pub(super) fn turns_s(&self, peripheral_m_s: f64) -> f64 {
        1_000.0 * peripheral_m_s / (PI * self.diameter_mm())
    }

    /// Mass of the new wheel, kg.
    pub(super) fn mass_kg(&self) -> f64 {
        DENSITY_KG_MM3 * PI * self.radius_mm * self.radius_mm * self.width_mm
    }

    /// Mean diameter, mm.
    pub(super) fn diameter_mm(&self) -> f64 {
        2.0 * (self.radius_mm - self.rim_wear_sum_mm / SLICES as f64)
    }

    /// Slice of the rim at a distance from the left side; `None` beyond the width.
    pub(super) fn slice_at(&self, from_left_mm: f64) -> Option<usize> {
        let slice = from_left_mm * self.slices_per_mm;
        (slice >= 0.0 && slice < SLICES as f64).then_some(slice as usize)
    }

    /// Volume of a slice to a depth, mm³.
    pub(super) fn slice_volume_mm3(&self, depth_mm: f64) -> f64 {
        2.0 * PI * self.radius_mm * depth_mm / self.slices_per_mm
    }

    /// Slices of the rim over an interval that begins at a distance from the left side; one slice if its width is zero.
    pub(super) fn slices_over(&self, from_left_mm: f64, width_mm: f64) -> std::ops::Range<usize> {
        let first = (from_left_mm * self.slices_per_mm).floor();
        let last = ((from_left_mm + width_mm) * self.slices_per_mm).floor();
        if last < 0.0 || first >= SLICES as f64 {
            return 0..0;
        }
        (first.max(0.0) as usize)..(last as usize + 1).min(SLICES)
    }

    /// Distance from a place, mm from the left side, to the nearest point of a slice; 0 over it.
    pub(super) fn distance_to_slice_mm(&self, slice: usize, from_left_mm: f64) -> f64 {
        let (from, to) = (slice as f64 / self.slices_per_mm, (slice + 1) as f64 / self.slices_per_mm);
        (from - from_left_mm).max(from_left_mm - to).max(0.0)
    }

    /// Wear of the rim at the corner next to a side, mm.
    pub(super) fn corner_wear_mm(&self, side: Side) -> f64 {
        self.rim_wear_mm[if side == Side::Left { 0 } else { SLICES - 1 }]
    }

    /// Wear of a side, mm.
    pub(super) const fn side_wear_mm(&self, side: Side) -> f64 {
        self.side_wear_mm[side as usize]
    }

    /// Time constant of the contact at the rim, s.
    pub(super) fn rim_time_constant_s(&self) -> f64 {
        self.sharp_s + (self.dull_s - self.sharp_s) * self.rim_dullness
    }

    /// Time constant of the contact at a side, s.
    pub(super) fn side_time_constant_s(&self, side: Side) -> f64 {
        self.sharp_s + (self.dull_s - self.sharp_s) * self.side_dullness[side as usize]
    }

    /// Ratio of a time constant to that of a sharp wheel.
    pub(super) fn dullness_factor(&self, time_constant_s: f64) -> f64 {
        time_constant_s / self.sharp_s
    }

    /// By how much more the wheel wears at a removal rate per width, mm³/(mm·s), than at 1 mm³/(mm·s).
    fn wear_factor(&self, removal_mm2_s: f64) -> f64 {
        if self.wear_exponent > 0.0 { removal_mm2_s.powf(self.wear_exponent) } else { 1.0 }
    }

    /// Wears a slice of the rim by the volume that it removed, at a removal rate per width, mm³/(mm·s).
    pub(super) fn wear_rim(&mut self, slice: usize, volume_mm3: f64, removal_mm2_s: f64) {
        let from_side = slice.min(SLICES - 1 - slice) as f64 / self.slices_per_mm;
        let at_corner = from_side < CORNER_MM;
        let corner = if at_corner { self.corner_wear } else { 1.0 };
        let worn_mm = volume_mm3 * self.rim_wear_per_mm3 * self.wear_factor(removal_mm2_s) * corner;
        self.rim_wear_mm[slice] += worn_mm;
        self.rim_wear_sum_mm += worn_mm;
        self.rim_dullness = (self.rim_dullness + volume_mm3 * self.dullness_per_mm3).min(1.0);
    }

    /// Wears a side, engaged to a depth along the infeed, by the volume that it removed, at a removal rate per width.
    pub(super) fn wear_side(&mut self, side: Side, engaged_mm: f64, volume_mm3: f64, removal_mm2_s: f64) {
        let ring = self.grinding_ratio * 2.0 * PI * self.radius_mm * engaged_mm.max(LEAST_ENGAGEMENT_MM);
        self.side_wear_mm[side as usize] += volume_mm3 / ring * self.wear_factor(removal_mm2_s);
        let dull = &mut self.side_dullness[side as usize];
        *dull = (*dull + volume_mm3 * self.dullness_per_mm3).min(1.0);
    }

    /// Dresses a slice by a depth. A cut sharpens this share of the rim; at an edge it also sharpens the side.
    /// `sharpened` ranges from 0 (touch only) to 1 (cut of full sharpening depth).
    pub(super) fn dress(&mut self, slice: usize, depth_mm: f64, sharpened: f64) {
        self.rim_wear_mm[slice] += depth_mm;
        self.rim_wear_sum_mm += depth_mm;
        self.rim_dullness = (self.rim_dullness - sharpened / SLICES as f64).max(0.0);
        let side = match slice {
            0 => Side::Left,
            last if last == SLICES - 1 => Side::Right,
            _ => return,
        };
        let dull = &mut self.side_dullness[side as usize];
        *dull = (*dull - sharpened).max(0.0);
    }

    /// Sets the dullness of rim and sides, 0 to 1.
    pub(super) fn set_dullness(&mut self, dull: f64) {
        let dull = dull.clamp(0.0, 1.0);
        self.rim_dullness = dull;
        self.side_dullness = [dull; 2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defs::kind::Kind;
    use crate::io::sim::MachineFile;

    fn wheel() -> GrindingWheel {
        let file = MachineFile::builtin(Kind::Gc).unwrap();
        GrindingWheel::new(&file.wheel, &file.cutting)
    }

    #[test]
    fn p2_wear_is_the_removed_volume_over_the_grinding_ratio() {
        let mut wheel = wheel();
        for slice in 0..SLICES {
            wheel.wear_rim(slice, 1_508.0 / SLICES as f64, 4.0);
        }
        // 1508/(40·π·600·20) = 0.0010 mm of radius, at any removal rate.
        assert!((600.0 - wheel.diameter_mm() - 0.002).abs() < 1e-6, "{}", wheel.diameter_mm());
    }

    /// g = 0.5: at 4 mm³/(mm·s) G is half of that at 1, at 0.25 twice.
    #[test]
    fn p2_a_soft_bond_wears_more_under_load() {
        let file = MachineFile::of_text("(wear_exponent: Some(0.5))", Kind::Gc).unwrap();
        let worn_um = |removal_mm2_s: f64| {
            let mut wheel = GrindingWheel::new(&file.wheel, &file.cutting);
            (0..SLICES).for_each(|slice| wheel.wear_rim(slice, 1_508.0 / SLICES as f64, removal_mm2_s));
            (600.0 - wheel.diameter_mm()) * 1_000.0
        };
        assert!([(0.25, 1.0), (1.0, 2.0), (4.0, 4.0)].iter().all(|(rate, um)| (worn_um(*rate) - um).abs() < 0.001));
    }

    /// 2 µm between the corners as in the first test, 3 times as much at them.
    #[test]
    fn p2_a_wheel_loses_its_corners_first() {
        let machine = MachineFile::of_text("(corner_wear: Some(3.0))", Kind::Gc).unwrap();
        let mut wheel = GrindingWheel::new(&machine.wheel, &machine.cutting);
        (0..SLICES).for_each(|slice| wheel.wear_rim(slice, 1_508.0 / SLICES as f64, 1.0));
        let radius_um = |slice: usize| 1_000.0 * wheel.rim_wear_mm[slice];
        // Slices of 1 mm: three at each corner.
        for (slice, um) in [(0, 3.0), (2, 3.0), (3, 1.0), (SLICES - 4, 1.0), (SLICES - 3, 3.0), (SLICES - 1, 3.0)] {
            assert!((radius_um(slice) - um).abs() < 0.001, "{slice}: {}", radius_um(slice));
        }
    }

    #[test]
    fn p6_a_dull_wheel_is_slower_and_the_diamond_sharpens_where_it_cuts() {
        let mut wheel = wheel();
        wheel.set_dullness(1.0);
        assert!((wheel.rim_time_constant_s() - 2.0).abs() < 1e-12);
        for slice in 0..SLICES / 2 {
            wheel.dress(slice, 0.02, 1.0);
        }
        assert!((wheel.rim_time_constant_s() - 1.4).abs() < 1e-9, "half the rim is sharp");
        wheel.dress(SLICES - 1, 0.001, 0.0);
        assert!((wheel.side_time_constant_s(Side::Right) - 2.0).abs() < 1e-12, "a touch does not sharpen");
        assert!((wheel.side_time_constant_s(Side::Left) - 0.8).abs() < 1e-12);
    }
}
