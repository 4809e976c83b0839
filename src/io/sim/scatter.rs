//! Random variation between machines, wheels and strokes, drawn from the seed; the machine file sets its size (P8).
//! The same seed gives the same machine.

use std::f64::consts::TAU;

use super::SimulatedMachine;
use super::machine_sections::ScatterFile;
use crate::io::random::SplitMix64;
use crate::units::Axis;

/// Separates these random numbers from those of contacts and parts.
const SCATTER_SEED: u64 = 0x5CA7_7E12;
/// Wavelength of a leadscrew's error, mm: several revolutions.
const SCREW_WAVE_MM: f64 = 70.0;

/// Uniformly distributed from −1 to 1.
fn symmetric_unit(chance: &mut SplitMix64) -> f64 {
    2.0 * chance.next_unit() - 1.0
}

/// Random position error of a slide.
#[derive(Clone, Debug)]
pub(super) struct SlideScatter {
    screw_mm: f64,
    phase: f64,
    servo_mm: f64,
    rng: SplitMix64,
}

impl SlideScatter {
    fn new(file: ScatterFile, chance: &mut SplitMix64) -> Self {
        Self {
            screw_mm: file.screw_um / 1_000.0 * symmetric_unit(chance),
            phase: chance.next_unit(),
            servo_mm: file.servo_um / 1_000.0,
            rng: SplitMix64::new(chance.next()),
        }
    }

    /// Position error of the slide at a position in this tick, mm.
    pub(super) fn deviation_mm(&mut self, place_mm: f64) -> f64 {
        let screw = self.screw_mm * (TAU * (place_mm / SCREW_WAVE_MM + self.phase)).sin();
        screw + self.servo_mm * symmetric_unit(&mut self.rng)
    }
}

/// Random depth of the diamond in each stroke.
#[derive(Clone, Debug)]
pub(super) struct DiamondScatter {
    amplitude_mm: f64,
    /// Extra depth of cut in this stroke, mm.
    pub(super) extra_depth_mm: f64,
    rng: SplitMix64,
}

impl DiamondScatter {
    /// Draws the depth of the next stroke.
    pub(super) fn next_stroke(&mut self) {
        self.extra_depth_mm = self.amplitude_mm * symmetric_unit(&mut self.rng);
    }
}

impl SimulatedMachine {
    /// Gives the wheels, in use and parked, the properties of their batch.
    fn set_wheel_batch(&mut self) {
        let Self { file, wheel_factors: factors, .. } = self;
        let (cutting, outer) = (&file.cutting, &file.wheel);
        let inner = self.internal.as_ref().map(|internal| internal.wheel(outer));
        self.wheel.set_batch_factors(inner.as_ref().unwrap_or(outer), cutting, *factors);
        if let Some(wheel) = &mut self.outer_wheel {
            wheel.set_batch_factors(outer, cutting, *factors);
        }
        if let Some((internal, wheel)) = &mut self.inner_wheel {
            wheel.set_batch_factors(&internal.wheel(outer), cutting, *factors);
        }
    }

    /// Draws the deviations from the machine file; none if the file has no scatter.
    pub(super) fn apply_scatter(&mut self, seed: u64) {
        let Some(file) = self.file.scatter else { return };
        let chance = &mut SplitMix64::new(seed ^ SCATTER_SEED);
        let factors = [0, 0].map(|_: u8| 1.0 + file.wheel * symmetric_unit(chance));
        self.wheel_factors = factors;
        self.set_wheel_batch();
        for axis in Axis::ALL {
            let slide = SlideScatter::new(file, chance);
            if let Some(sim) = &mut self.axes[axis] {
                sim.scatter = Some(slide);
            }
        }
        let amplitude_mm = file.dressing_um / 1_000.0;
        let rng = SplitMix64::new(chance.next());
        self.grinding.diamond = Some(DiamondScatter { amplitude_mm, extra_depth_mm: 0.0, rng });
    }
}
