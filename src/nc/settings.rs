//! What the machine kind and the parameters tell the interpreter. Source: spec K1, B1, B2.

use crate::units::PerAxis;

/// Which G-code system a machine kind speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// GC: U, V, W are incremental; G90 and G94 are cycles.
    LatheA,
    /// GS and GA: G90 and G91 are modal; U, V, W are incremental as well.
    Mill,
}

/// What a plain S word means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedUnit {
    /// Revolutions a minute.
    Rpm,
    /// Metres a second at the wheel's rim.
    MetresPerSecond,
}

/// Everything outside the text that changes how it is read.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The G-code system of the kind.
    pub system: System,
    /// X and U words are diameters.
    pub diameter: bool,
    /// Which axes the machine has.
    pub axes: PerAxis<bool>,
    /// Lengths without a decimal point count this many millimetres (or inches); `None`: `X100` is 100 mm.
    pub least_increment_mm: Option<f64>,
    /// Start in inches (G20).
    pub inch: bool,
    /// The tolerance of G64, millimetres; the path mode at the start is G64.
    pub tolerance_mm: f64,
    /// How far the end of an arc may lie off its circle, millimetres.
    pub arc_tolerance_mm: f64,
    /// What S means under G97.
    pub speed_unit: SpeedUnit,
    /// Input port of `M91`/`M92` without L; 0 = none.
    pub jump_input: u32,
    /// Tools and offsets of a T word, 1 to this.
    pub tools: u32,
    /// P17.1: G35 moves a cylinder and takes no words.
    pub oscillation_by_cylinder: bool,
    /// Rapid speed of each axis for the time estimate of a check, mm/min.
    pub rapid_mm_min: PerAxis<f64>,
}

impl Settings {
    /// GC as it leaves the factory: X (diameter) and Z.
    #[must_use]
    pub fn lathe() -> Self {
        Self {
            system: System::LatheA,
            diameter: true,
            axes: PerAxis([true, false, true]),
            least_increment_mm: None,
            inch: false,
            tolerance_mm: 0.01,
            arc_tolerance_mm: 0.01,
            speed_unit: SpeedUnit::Rpm,
            jump_input: 0,
            tools: 16,
            oscillation_by_cylinder: false,
            rapid_mm_min: PerAxis([6_000.0; 3]),
        }
    }

    /// GS and GA as they leave the factory: X, Y, Z in radius.
    #[must_use]
    pub fn mill() -> Self {
        Self { system: System::Mill, diameter: false, axes: PerAxis([true; 3]), ..Self::lathe() }
    }

    #[inline]
    pub(crate) fn is_mill(&self) -> bool {
        self.system == System::Mill
    }
}
