//! Settings of the interpreter from machine kind and parameters. Source: spec K1, B1, B2.

pub use crate::defs::kind::Dialect;
use crate::defs::program_number;
use crate::units::{Axis, PerAxis};

/// The meaning of S under G97.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedUnit {
    /// Revolutions per minute.
    Rpm,
    /// Peripheral speed of the wheel, m/s.
    MetresPerSecond,
}

/// What follows the contour under G41 and G42 without a D word (P416, P417).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutterSource {
    /// The corner of the wheel: R of the active tool offset.
    ToolOffset,
    /// The dresser: R of this tool offset.
    Offset(u32),
    /// The whole wheel: half its diameter.
    WholeWheel,
}

/// Codes that call a macro, each with its program; code 0 is none (FANUC 6050 to 6059, 6080 to 6089).
pub type CodeMacros = [(u16, u16); 10];

/// Settings for programs of the 超人 lathe (L2, L5, L6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuperManSettings {
    /// Feed of a line without F, mm/min on Z.
    pub line_feed: f64,
    /// Feed of an arc without F, mm/min.
    pub arc_feed: f64,
    /// Travel of Z per millimetre of X slide travel while both move in G00, mm.
    pub rapid_z_per_x: f64,
    /// Least increment of a programmed coordinate, mm (X a diameter). An arc's end error is below five of them.
    pub increment_mm: f64,
    /// Work coordinates that G36, G37, G39 set at the machine origin, radius mm.
    pub origin: PerAxis<f64>,
    /// G02 and G03 turn opposite to ISO, also seen with X up (P5.4=0).
    pub arcs_reversed: bool,
    /// Spindle speed without S, rpm.
    pub spindle_rpm: f64,
    /// Highest spindle speed, rpm.
    pub max_rpm: f64,
    /// Acceleration and jerk of Z, mm/s² and mm/s³, for the run-up of a thread.
    pub z_accel_jerk: (f64, f64),
}

impl Default for SuperManSettings {
    fn default() -> Self {
        Self {
            line_feed: 300.0,
            arc_feed: 300.0,
            rapid_z_per_x: 2.0,
            increment_mm: 0.01,
            origin: PerAxis([0.0; 3]),
            arcs_reversed: false,
            spindle_rpm: 200.0,
            max_rpm: 5_000.0,
            z_accel_jerk: (800.0, 20_000.0),
        }
    }
}

/// All settings outside the text that change how it is read.
#[derive(Clone, Debug)]
pub struct NcSettings {
    /// The dialect of the machine kind.
    pub dialect: Dialect,
    /// X and U words are diameters.
    pub diameter: bool,
    /// The axes of the machine.
    pub axes: PerAxis<bool>,
    /// Unit of lengths without a decimal point, millimetres; a tenth of it in inches. `None`: `X100` is 100 mm.
    pub least_increment_mm: Option<f64>,
    /// Start in inches (G20).
    pub inch: bool,
    /// The tolerance of G64, millimetres.
    pub tolerance_mm: f64,
    /// Greatest distance of an arc's end from its circle, millimetres.
    pub arc_tolerance_mm: f64,
    /// The unit of S under G97.
    pub speed_unit: SpeedUnit,
    /// Input port of `M91`/`M92` without L; 0 = none.
    pub jump_input: u32,
    /// Highest tool and offset number of a T word.
    pub tool_count: u32,
    /// The highest O number that a program can call; by its digits (P418).
    pub program_limit: u32,
    /// The initial path mode is exact stop (G61, G60), not G64.
    pub exact_stop: bool,
    /// The initial function of group 01 is G1, not G00.
    pub starts_with_feed: bool,
    /// The start position is the work zero until the program changes it (L3).
    pub start_is_work_zero: bool,
    /// 超人 lathe: every block begins with a four-digit number (L1). An MDI line needs none.
    pub needs_block_numbers: bool,
    /// M99 of the main program ends it instead of starting it again: a run for the time of one pass.
    pub runs_once: bool,
    /// Settings of the 超人 lathe.
    pub superman: SuperManSettings,
    /// The cutter of G41 and G42.
    pub cutter_source: CutterSource,
    /// G codes that call a macro (P420 …).
    pub g_macros: CodeMacros,
    /// M codes that call a macro (P440 …).
    pub m_macros: CodeMacros,
    /// P17.1: G35 moves a cylinder and has no words.
    pub oscillation_by_cylinder: bool,
    /// P238 and P239: the oscillation that M35 alone starts (K4.3), axis and other end, radius mm.
    pub oscillation_stroke: (Axis, f64),
    /// Rapid speed of each axis, mm/min; for the time estimate of a check.
    pub rapid_mm_min: PerAxis<f64>,
}

impl NcSettings {
    /// Settings that a dialect changes: those of a lathe with two axes, X a diameter.
    pub(crate) fn two_axes(dialect: Dialect) -> Self {
        Self {
            dialect,
            diameter: true,
            axes: PerAxis([true, false, true]),
            least_increment_mm: None,
            inch: false,
            tolerance_mm: 0.01,
            arc_tolerance_mm: 0.01,
            speed_unit: SpeedUnit::Rpm,
            jump_input: 0,
            tool_count: 16,
            program_limit: program_number::o_limit(program_number::O_DIGITS),
            exact_stop: false,
            starts_with_feed: false,
            start_is_work_zero: false,
            needs_block_numbers: false,
            runs_once: false,
            superman: SuperManSettings::default(),
            cutter_source: CutterSource::ToolOffset,
            g_macros: [(0, 0); 10],
            m_macros: [(0, 0); 10],
            oscillation_by_cylinder: false,
            oscillation_stroke: (Axis::X, 0.0),
            rapid_mm_min: PerAxis([6_000.0; 3]),
        }
    }

    #[inline]
    pub(crate) fn is_mill(&self) -> bool {
        self.dialect.is_mill()
    }
}
