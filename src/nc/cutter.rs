//! The circle with which a wheel, a dresser or a tool touches a contour, and the side on which it runs.
//! Source: spec B2 (G40 G41 G42).

use crate::geometry::CompensationSide;
use crate::units::Axis;

/// An active G41 or G42.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation {
    /// The side of the contour on which the cutter runs.
    pub side: CompensationSide,
    /// Its circle.
    pub cutter: CutterShape,
}

impl Compensation {
    /// The G code: 41 or 42.
    #[must_use]
    pub const fn g(&self) -> u8 {
        match self.side {
            CompensationSide::Left => 41,
            CompensationSide::Right => 42,
        }
    }
}

/// The circle with which a wheel, a dresser or a tool touches the contour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutterShape {
    /// Radius, mm; 0: the programmed point follows the contour itself.
    pub radius_mm: f64,
    /// Place of the programmed point, as the imaginary tool nose of FANUC: 0 and 9 the centre, 1 to 4 the corners of the
    /// square around the circle (X+Z+, X+Z−, X−Z−, X−Z+), 5 to 8 the ends of its axes (Z+, X+, Z−, X−).
    pub tip: u8,
}

impl CutterShape {
    /// Sets the radius, mm.
    ///
    /// # Errors
    /// Below 0 or above [`MAX_CUTTER_RADIUS_MM`].
    pub fn set_radius(&mut self, radius_mm: f64) -> Result<(), CutterRangeError> {
        if !(0.0..=MAX_CUTTER_RADIUS_MM).contains(&radius_mm) {
            return Err(CutterRangeError);
        }
        self.radius_mm = radius_mm;
        Ok(())
    }

    /// Sets the place of the programmed point.
    ///
    /// # Errors
    /// Not a whole number from 0 to [`MAX_TIP`].
    pub fn set_tip(&mut self, tip: f64) -> Result<(), CutterRangeError> {
        if !(0.0..=f64::from(MAX_TIP)).contains(&tip) || tip.fract().abs() > 0.0 {
            return Err(CutterRangeError);
        }
        self.tip = tip as u8;
        Ok(())
    }

    /// The programmed point minus the centre, mm.
    pub(super) fn tip_from_center(&self, axis: Axis) -> f64 {
        let [x, z] = match self.tip {
            1 => [1.0, 1.0],
            2 => [1.0, -1.0],
            3 => [-1.0, -1.0],
            4 => [-1.0, 1.0],
            5 => [0.0, 1.0],
            6 => [1.0, 0.0],
            7 => [0.0, -1.0],
            8 => [-1.0, 0.0],
            _ => [0.0, 0.0],
        };
        match axis {
            Axis::X => x * self.radius_mm,
            Axis::Y => 0.0,
            Axis::Z => z * self.radius_mm,
        }
    }
}

/// A radius or a tip that no cutter has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("R is 0 to 999.999 mm, T a whole number from 0 to 9")]
pub struct CutterRangeError;

/// Greatest radius, mm.
pub const MAX_CUTTER_RADIUS_MM: f64 = 999.999;
/// Highest place of the programmed point.
pub const MAX_TIP: u8 = 9;
