//! The modal state. Source: spec B2, B3 (#4001…).

use super::cutter::Compensation;
use super::op::{Feed, PathMode, SpeedMode};
use super::settings::{NcSettings, SpeedUnit};
use super::work_offsets::EXTRA_G;
use crate::units::{MM_PER_INCH, PerAxis, Plane};

/// The active function of group 01, by its G code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionMode {
    /// G00.
    #[default]
    Rapid = 0,
    /// G01.
    Feed = 1,
    /// G02.
    ArcClockwise = 2,
    /// G03.
    ArcCounterClockwise = 3,
    /// G90 on GC: turning cycle along Z.
    LongitudinalCycle = 90,
    /// G94 on GC: facing cycle along X.
    FaceCycle = 94,
    /// G23 of the 超人 lathe: rectangle cycle.
    RectangleCycle = 23,
    /// G32 of the 超人 lathe: thread, F in turns per inch.
    InchThread = 32,
    /// G33 of the 超人 lathe: thread, F is the lead in mm.
    MetricThread = 33,
}

impl MotionMode {
    /// The G code.
    #[must_use]
    pub const fn g(self) -> u8 {
        self as u8
    }

    /// Whether a block with axis words is a cycle of several moves.
    #[must_use]
    pub const fn is_cycle(self) -> bool {
        matches!(self, Self::LongitudinalCycle | Self::FaceCycle | Self::RectangleCycle)
    }

    #[inline]
    pub(crate) const fn from_g(code: u32) -> Option<Self> {
        match code {
            0 => Some(Self::Rapid),
            1 => Some(Self::Feed),
            2 => Some(Self::ArcClockwise),
            3 => Some(Self::ArcCounterClockwise),
            90 => Some(Self::LongitudinalCycle),
            94 => Some(Self::FaceCycle),
            23 => Some(Self::RectangleCycle),
            32 => Some(Self::InchThread),
            33 => Some(Self::MetricThread),
            _ => None,
        }
    }
}

/// How X words of SINUMERIK are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum DiameterProgramming {
    /// DIAMON: diameters.
    #[default]
    On,
    /// DIAMOF: radii.
    Off,
    /// DIAM90: absolute ones diameters, incremental ones radii.
    Absolute,
}

/// The modal words of a canned cycle, radius mm: later blocks reuse them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CycleWords {
    pub x: Option<f64>,
    pub z: Option<f64>,
    pub taper: f64,
}

/// The stored settings of the repetitive cycles G71–G75, radius mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RepetitiveCycleState {
    /// G71, G72: depth of a stroke and retract at 45°.
    pub depth: Option<f64>,
    pub escape: f64,
    /// G73: stock to remove in X and Z, and the number of passes.
    pub shift: Option<(f64, f64)>,
    pub passes: Option<u32>,
    /// G74, G75: retract of a peck.
    pub peck_back: f64,
}

/// The G codes of modal states in a dialect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModalCodes {
    /// G90 and G91 are modal.
    pub distance_is_modal: bool,
    /// Feed per minute and per revolution.
    pub per_minute: u8,
    pub per_rev: u8,
    /// Inches and millimetres.
    pub inch: u8,
    pub metric: u8,
    /// Exact stop.
    pub exact_stop: u8,
}

impl ModalCodes {
    /// The codes of lathe system A.
    pub const SYSTEM_A: Self =
        Self { distance_is_modal: false, per_minute: 98, per_rev: 99, inch: 20, metric: 21, exact_stop: 61 };
}

/// The modal state. It is copied into every block, so that the pages show the state of the executed block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalState {
    /// Group 01.
    pub motion: MotionMode,
    /// G17, G18, G19.
    pub plane: Plane,
    /// The program has said which.
    pub(crate) plane_named: bool,
    /// G91: incremental (GS, GA, SINUMERIK).
    pub incremental: bool,
    /// Feed per revolution (G99, SINUMERIK G95) instead of per minute.
    pub per_rev: bool,
    /// The program has said which of them.
    pub(crate) feed_unit_named: bool,
    /// F, mm/min or mm per revolution.
    pub feed: Option<f64>,
    /// G20, G70, G700: lengths in inches.
    pub inch: bool,
    /// G20, G700: feeds in inches, too.
    pub inch_feed: bool,
    /// Work offset, 54–59; G54.1 P1–P48 as 101–148.
    pub work_offset: u8,
    /// G61 or G64.
    pub path_mode: PathMode,
    /// G41 or G42; `None` for G40.
    pub compensation: Option<Compensation>,
    /// The radius between all lines and arcs, mm (SINUMERIK RNDM).
    pub(crate) rounding: Option<f64>,
    /// G96 or G97, and the unit of S.
    pub speed_mode: SpeedMode,
    /// S.
    pub speed: Option<f64>,
    /// Tool of the last T.
    pub tool: u16,
    /// Offset of the last T.
    pub offset: u16,
    /// How X words are read (SINUMERIK).
    pub(crate) diameter: DiameterProgramming,
    /// The programmable zero offset, radius mm (SINUMERIK TRANS).
    pub(crate) local: PerAxis<f64>,
    /// The last M code.
    pub m_code: Option<u8>,
    /// A G66 modal call is active.
    pub modal_call: bool,
    pub(crate) g97_mode: SpeedMode,
    pub(crate) cycle: CycleWords,
    pub(crate) repetitive: RepetitiveCycleState,
    /// Lead of the last thread, mm (L5).
    pub(crate) thread_lead_mm: Option<f64>,
    /// Direction of the last X move before a thread: 1, −1, or 0 without one (L5).
    pub(crate) infeed_direction: i8,
    /// The program has started the main spindle (L5).
    pub(crate) spindle_on: bool,
    /// K5.11: a second tool was called; G50 is refused.
    pub(crate) several_tools: bool,
    /// K5.11: G50 was used; a second tool is refused.
    pub(crate) g50_used: bool,
}

impl ModalState {
    /// The state at power-on and after reset.
    #[must_use]
    pub fn new(settings: &NcSettings) -> Self {
        let rotation = match settings.speed_unit {
            SpeedUnit::Rpm => SpeedMode::Rpm,
            SpeedUnit::MetresPerSecond => SpeedMode::MetresPerSecond,
        };
        Self {
            motion: if settings.starts_with_feed { MotionMode::Feed } else { MotionMode::Rapid },
            plane: Plane::Zx,
            plane_named: false,
            incremental: false,
            per_rev: false,
            feed_unit_named: false,
            feed: None,
            inch: settings.inch,
            inch_feed: settings.inch,
            work_offset: 54,
            path_mode: if settings.exact_stop {
                PathMode::ExactStop
            } else {
                PathMode::Continuous { tolerance_mm: settings.tolerance_mm }
            },
            compensation: None,
            rounding: None,
            speed_mode: rotation,
            speed: None,
            tool: 0,
            offset: 0,
            diameter: DiameterProgramming::default(),
            local: PerAxis::default(),
            m_code: None,
            modal_call: false,
            g97_mode: rotation,
            cycle: CycleWords::default(),
            repetitive: RepetitiveCycleState::default(),
            thread_lead_mm: None,
            infeed_direction: 0,
            spindle_on: false,
            several_tools: false,
            g50_used: false,
        }
    }

    /// The active feed.
    #[must_use]
    #[inline]
    pub fn feed(&self) -> Option<Feed> {
        self.feed.map(if self.per_rev { Feed::PerRev } else { Feed::PerMinute })
    }

    /// #4001…#4130: a modal value; `None` for an undefined number.
    pub(crate) fn variable(&self, number: u32, mill: bool) -> Option<Option<f64>> {
        let code = |code: u8| Some(Some(f64::from(code)));
        let surface = if self.speed_mode == SpeedMode::SurfaceSpeed { 96 } else { 97 };
        match number {
            4001 => code(self.motion.g()),
            4002 if mill => code(self.plane.g()),
            4002 => code(surface),
            4003 if mill => code(if self.incremental { 91 } else { 90 }),
            // DECISION: the lathe has no group 03; null, so that `G#4003` of a macro that restores the modes is no word.
            4003 => Some(None),
            4005 => code(if self.per_rev { 99 } else { 98 }),
            4006 => code(if self.inch { 20 } else { 21 }),
            4007 => code(self.compensation.map_or(40, |active| active.g())),
            // There is no drilling cycle.
            4009 if mill => code(80),
            4010 if !mill => code(80),
            4012 => code(if self.modal_call { 66 } else { 67 }),
            4014 => match self.work_offset.checked_sub(EXTRA_G) {
                None | Some(0) => code(self.work_offset),
                Some(_) => Some(Some(54.1)),
            },
            4130 => code(self.work_offset.saturating_sub(EXTRA_G)),
            4015 => code(if self.path_mode == PathMode::ExactStop { 61 } else { 64 }),
            4016 => code(self.plane.g()),
            // As programmed: a macro gives it back with `F#4109`.
            4109 => Some(self.feed.map(|feed| if self.inch_feed { feed / MM_PER_INCH } else { feed })),
            4113 => Some(self.m_code.map(f64::from)),
            4119 => Some(self.speed),
            4120 => Some(Some(f64::from(self.tool) * 100.0 + f64::from(self.offset))),
            _ => None,
        }
    }
}
