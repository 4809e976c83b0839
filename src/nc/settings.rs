//! What the machine kind and the parameters tell the interpreter. Source: spec K1, B1, B2.

pub use crate::defs::kind::System;
use crate::units::PerAxis;

/// What a plain S word means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedUnit {
    /// Revolutions a minute.
    Rpm,
    /// Metres a second at the wheel's rim.
    MetresPerSecond,
}

/// What the parameters tell programs of the 超人 lathe (L2, L5, L6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// Feed of a straight line without an F, mm/min on Z.
    pub line_feed: f64,
    /// Feed of an arc without an F, mm/min.
    pub arc_feed: f64,
    /// How far Z goes for a millimetre of slide on X while both run in G00.
    pub rapid_z_per_x: f64,
    /// The least increment of a coordinate as written, mm (X a diameter): arcs end less than five of them off.
    pub pulse_mm: f64,
    /// Coordinates of the machine origin that G36, G37, G39 set, radius mm.
    pub origin: PerAxis<f64>,
    /// G02 and G03 turn the other way than ISO has it, as the manual warns.
    pub arcs_opposite: bool,
    /// Speed of the spindle without an S, rpm.
    pub spindle_rpm: f64,
    /// The highest speed of the spindle, rpm.
    pub most_rpm: f64,
    /// Acceleration and jerk of Z, mm/s², mm/s³: the run-up of a thread.
    pub run_up: (f64, f64),
}

impl Default for Turning {
    fn default() -> Self {
        Self {
            line_feed: 300.0,
            arc_feed: 300.0,
            rapid_z_per_x: 2.0,
            pulse_mm: 0.01,
            origin: PerAxis([0.0; 3]),
            arcs_opposite: true,
            spindle_rpm: 200.0,
            most_rpm: 5_000.0,
            run_up: (800.0, 20_000.0),
        }
    }
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
    /// The tolerance of G64, millimetres; the path mode at the start is G64 unless `exact_stop` says otherwise.
    pub tolerance_mm: f64,
    /// How far the end of an arc may lie off its circle, millimetres.
    pub arc_tolerance_mm: f64,
    /// What S means under G97.
    pub speed_unit: SpeedUnit,
    /// Input port of `M91`/`M92` without L; 0 = none.
    pub jump_input: u32,
    /// Tools and offsets of a T word, 1 to this.
    pub tools: u32,
    /// The path mode at the start is exact stop, not G64.
    pub exact_stop: bool,
    /// Where a program begins is its work zero until it says otherwise (L3).
    pub zero_at_start: bool,
    /// Every block of a program of the 超人 lathe begins with a number of four digits (L1); an MDI line needs none.
    pub numbered: bool,
    /// Speeds and places of the 超人 lathe.
    pub turning: Turning,
    /// P17.1: G35 moves a cylinder and takes no words.
    pub oscillation_by_cylinder: bool,
    /// Rapid speed of each axis for the time estimate of a check, mm/min.
    pub rapid_mm_min: PerAxis<f64>,
}

impl Settings {
    #[inline]
    pub(crate) fn is_mill(&self) -> bool {
        self.system.is_mill()
    }
}
