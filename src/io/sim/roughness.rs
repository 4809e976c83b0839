//! Roughness and waviness of the surfaces of the part (P5): each turn of the part under the wheel renews them, Ra by the law
//! of `technology::roughness_um`, the waviness by the vibration of the wheel. A blank comes turned.

use serde::Serialize;

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
    /// Waviness from peak to valley, µm; 0 if the wheel runs true.
    pub waviness_um: f64,
}

/// The roughness of one surface as it is ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroundFinish {
    ra_um: f64,
    waviness_um: f64,
    /// What is left of the blank's surface, 1 to 0.
    blank_share: f64,
}

impl GroundFinish {
    pub(super) const fn of_blank() -> Self {
        Self { ra_um: BLANK_UM, waviness_um: 0.0, blank_share: 1.0 }
    }

    /// A share of the surface has been ground to a roughness Ra and a waviness, µm.
    pub(super) fn grind(&mut self, share: f64, ra_um: f64, waviness_um: f64) {
        let share = share.clamp(0.0, 1.0);
        self.ra_um += share * (ra_um - self.ra_um);
        self.waviness_um += share * (waviness_um - self.waviness_um);
        self.blank_share *= 1.0 - share;
    }

    /// The finish of a surface, by its index; none for one that is still blank in places.
    pub(super) fn report(&self, surface: usize) -> Option<SurfaceRoughness> {
        let Self { ra_um, waviness_um, blank_share } = *self;
        (blank_share <= 1.0 - GROUND_SHARE).then_some(SurfaceRoughness { surface, ra_um, waviness_um })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn in 100 ticks leaves 0.99^100 = 37 % of the blank, five turns 0.7 %.
    #[test]
    fn p5_a_surface_is_ground_after_some_turns_of_the_part() {
        let mut finish = GroundFinish::of_blank();
        (0..100).for_each(|_| finish.grind(0.01, 0.4, 1.0));
        assert_eq!(finish.report(0), None);
        (0..900).for_each(|_| finish.grind(0.01, 0.4, 1.0));
        // The rest of the blank: 0.99^1000·2.8 µm = 0.00012, and of the wave that it did not have.
        let report = finish.report(3).unwrap();
        assert_eq!(report.surface, 3);
        assert!((report.ra_um - 0.4).abs() < 0.001 && (report.waviness_um - 1.0).abs() < 0.001);
    }
}
