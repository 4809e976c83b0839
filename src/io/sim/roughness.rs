//! Roughness of the surfaces of the part (P5): each turn of the part under the wheel renews it, by the law of
//! `technology::roughness_um`. A blank comes turned.

use serde::Serialize;

use crate::technology::{DressingPass, roughness_um};

/// Ra of a turned blank, µm. DECISION: an even finish of a lathe.
const BLANK_UM: f64 = 3.2;
/// A surface counts as ground once the wheel has gone over this share of it.
const GROUND_SHARE: f64 = 0.99;

/// Roughness of a surface of the part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SurfaceRoughness {
    /// Index of the surface in the part file, from 0.
    pub surface: usize,
    /// Ra, µm.
    pub ra_um: f64,
}

/// The roughness of one surface as it is ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundFinish {
    ra_um: f64,
    /// What is left of the blank's surface, 1 to 0.
    blank_share: f64,
}

impl GroundFinish {
    pub(super) const fn of_blank() -> Self {
        Self { ra_um: BLANK_UM, blank_share: 1.0 }
    }

    /// A share of the surface has been ground at a removal rate, mm³/(mm·s).
    pub(super) fn grind(&mut self, share: f64, pass: DressingPass, removal_mm2_s: f64, wheel_m_s: f64) {
        let share = share.clamp(0.0, 1.0);
        self.ra_um += share * (roughness_um(pass, removal_mm2_s, wheel_m_s) - self.ra_um);
        self.blank_share *= 1.0 - share;
    }

    /// Ra, µm; none for a surface that is still blank in places.
    pub(super) fn ra_um(&self) -> Option<f64> {
        (self.blank_share <= 1.0 - GROUND_SHARE).then_some(self.ra_um)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn in 100 ticks leaves 0.99^100 = 37 % of the blank, five turns 0.7 %.
    #[test]
    fn p5_a_surface_is_ground_after_some_turns_of_the_part() {
        let mut finish = GroundFinish::of_blank();
        let pass = DressingPass::of_overlap(0.02, 4.0);
        (0..100).for_each(|_| finish.grind(0.01, pass, 0.5, 34.6));
        assert_eq!(finish.ra_um(), None);
        (0..900).for_each(|_| finish.grind(0.01, pass, 0.5, 34.6));
        // The rest of the blank: 0.99^1000·2.8 µm = 0.00012.
        assert!((finish.ra_um().unwrap() - 0.4).abs() < 0.001);
    }
}
