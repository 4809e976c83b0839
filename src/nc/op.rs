//! Canonical operations: what a program does, independent of its dialect and notation.
//! Lengths are radius millimetres in active work coordinates. Feeds are true slide travel. Source: spec T4, K1.

use crate::defs::mcode::{self, MCodeAction};
use crate::defs::system_variable;
use crate::defs::text::arg::Arg;
use crate::units::{Axis, PerAxis, Plane, WorkPos};

/// A set of axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct AxisSet(u8);

impl AxisSet {
    /// No axis.
    pub const NONE: Self = Self(0);

    /// Whether the set contains an axis.
    #[must_use]
    #[inline]
    pub const fn contains(self, axis: Axis) -> bool {
        self.0 & (1 << axis as u8) != 0
    }

    /// X and Z.
    pub const XZ: Self = Self::of(Axis::X).with(Self::of(Axis::Z));

    /// The axes that have a value.
    #[must_use]
    pub fn of_some<T>(values: PerAxis<Option<T>>) -> Self {
        let mut set = Self::NONE;
        values.iter().filter(|(_, value)| value.is_some()).for_each(|(axis, _)| set.insert(axis));
        set
    }

    /// Adds an axis.
    #[inline]
    pub const fn insert(&mut self, axis: Axis) {
        self.0 |= 1 << axis as u8;
    }

    /// The set with one axis.
    #[must_use]
    #[inline]
    pub const fn of(axis: Axis) -> Self {
        Self(1 << axis as u8)
    }

    /// The union of both sets.
    #[must_use]
    #[inline]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The axes that are in both sets.
    #[must_use]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether the set is empty.
    #[must_use]
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The axes, X first.
    pub fn iter(self) -> impl Iterator<Item = Axis> {
        Axis::ALL.into_iter().filter(move |axis| self.contains(*axis))
    }
}

/// A programmed feed, greater than zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feed {
    /// mm/min.
    PerMinute(f64),
    /// mm per revolution.
    PerRev(f64),
}

/// How consecutive blocks are blended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathMode {
    /// G61: exact stop at the end of every block.
    ExactStop,
    /// G64: corners are rounded within the tolerance.
    Continuous {
        /// Greatest deviation from the programmed path, mm.
        tolerance_mm: f64,
    },
}

/// The meaning and unit of an S value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedMode {
    /// G97: revolutions per minute.
    Rpm,
    /// G97 if the parameter selects it: peripheral speed of the wheel, m/s.
    MetresPerSecond,
    /// G96: constant surface speed, m/min.
    SurfaceSpeed,
}

/// G78: positioning by a gauge (K4.5). Work coordinates in radius mm, feeds in mm/min.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeMove {
    /// Z, on GS also Y.
    pub axis: Axis,
    /// The limit of the approach.
    pub to: f64,
    /// Feed of the fast approach and the retract.
    pub fast_mm_min: f64,
    /// Feed of the fine approach.
    pub fine_mm_min: f64,
    /// Gauge input of the first (or only) contact, 1–6.
    pub first_input: u8,
    /// Gauge input of the second stage, 1–6; only with multi-point gauging.
    pub second_input: Option<u8>,
    /// Retract distance.
    pub retract_mm: f64,
}

/// The skip signal (G31 P) of the wheel's contact monitor (P358).
pub const CONTACT_SKIP_SIGNAL: u8 = 9;

/// Number of reference points: the machine zero (G28) and three more (G30 P2 to P4).
pub const REFERENCE_POINTS: usize = 4;

/// A thread synchronised with the spindle, and its run-out. Work coordinates, radius mm (L5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadMove {
    /// End of the block: the end of the thread in Z, the retracted position in X.
    pub to: WorkPos,
    /// Start of the run-out.
    pub run_out_start: WorkPos,
    /// Lead along Z, mm.
    pub lead_mm: f64,
}

impl ThreadMove {
    /// The highest spindle speed for a lead, rpm.
    #[must_use]
    pub fn max_spindle_rpm(lead_mm: f64) -> f64 {
        1_200.0 / lead_mm - 80.0
    }
}

/// A canonical operation.
///
/// In moves, `words` holds the axes that the block names. `incremental` holds those that it names as distances.
/// Axes outside `words` do not move; `to` holds their position when the block was read.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what their names say, in the units of the variant")]
pub enum Op {
    /// G00. On the 超人 lathe the block may contain a feed (L2).
    Rapid { to: WorkPos, feed: Option<Feed>, words: AxisSet, incremental: AxisSet },
    /// G01.
    Feed { to: WorkPos, feed: Feed, words: AxisSet, incremental: AxisSet },
    /// G02 (turn −1, clockwise) and G03 (turn 1), seen with the plane's first axis to the right and the second up.
    /// Only the two plane axes of `center` are used. If the end equals the start, the arc is a full circle.
    Arc { to: WorkPos, center: WorkPos, plane: Plane, turn: i8, feed: Feed, words: AxisSet, incremental: AxisSet },
    /// G04, seconds.
    Dwell { s: f64 },
    /// G61, G64.
    SetPathMode(PathMode),
    /// G54–G59; G54.1 P1–P48 as 101–148.
    SelectWorkOffset { g: u8 },
    /// G52: the local zero of the named axes.
    SetLocalZero { values: PerAxis<Option<f64>> },
    /// G50: assigns these work coordinates to the present position; clears the wear of the active tool offset (K5.10).
    SetCoordinateSystem { values: PerAxis<Option<f64>> },
    /// G50 S: speed limit under G96, rpm.
    SpeedLimit { rpm: f64 },
    /// G53: a move in machine coordinates, radius mm; at rapid speed if there is no feed.
    MachineMove { to: PerAxis<Option<f64>>, feed: Option<Feed> },
    /// G28 (number 1: machine zero) and G30 (2 to 4): the named axes move via `via` to a reference point.
    ReturnToReference { number: u8, via: WorkPos, words: AxisSet, incremental: AxisSet },
    /// G31: feeds until the signal (1–6) becomes active.
    Skip { to: WorkPos, feed: Feed, signal: u8, words: AxisSet, incremental: AxisSet },
    /// G10: adds to the wear of an offset, radius mm (K4.1).
    AddWear { number: u8, by: PerAxis<f64> },
    /// G27: to the stored dressing point, machine coordinates; feed in mm/min (K4.2).
    DressReturn { axes: AxisSet, feed: Option<f64> },
    /// G35: axis and other reversal point (none with a cylinder), ms to 10 m/min, strokes per minute (K4.3, K4.4).
    OscillationOn { stroke: Option<(Axis, f64)>, ramp_ms: Option<f64>, strokes_min: Option<f64> },
    /// G36.
    OscillationOff,
    /// G78.
    Gauge(GaugeMove),
    /// G32 and G33 of the 超人 lathe.
    Thread(ThreadMove),
    /// G36, G37, G39: homes these axes by their switches, X first (L6).
    HomeSwitch { axes: AxisSet },
    /// Turns the tool turret to a station. With compensation the slides move by `by`, so that the new tip is where the
    /// old tip was (L8). Work coordinates do not change.
    IndexTurret { station: u8, by: Option<PerAxis<f64>> },
    /// An M code and its parameter words.
    M { code: u8, s: Option<f64>, p: Option<f64>, l: Option<f64> },
    /// S.
    S { value: f64, mode: SpeedMode },
    /// T: tool 0 keeps the active tool, offset 0 cancels the offset.
    T { tool: u16, offset: u16 },
    /// Sets a common variable (100–433, 500–999) when execution reaches this point.
    SetVariable { variable: u32, value: Option<f64> },
    /// Writes a system variable (#434–#439, #1100…, #2001…, #3001…, #3901…).
    SetSystemVariable { number: u32, value: Option<f64> },
    /// `#3000=n(text)`: raises alarm 3000–3999 and stops.
    Alarm { number: u32, text: Arg },
    /// MSG: a text that is shown until the next one; an empty text clears it.
    DisplayMessage { text: Arg },
    /// A line for the file of printed lines (DPRNT).
    Print { text: Arg },
    /// `#3006=n(text)`: stops with a message; cycle start continues.
    StopWithMessage { number: u32, text: Arg },
}

impl Op {
    /// Shifts a move by what the operator has moved by hand: an axis that it does not name, or names as a distance, keeps
    /// the shift, an absolute word ends it (K6.3).
    pub(super) fn shift_by_hand(&mut self, shift: &mut PerAxis<f64>) {
        let (to, mut center, words, incremental) = match self {
            Self::Rapid { to, words, incremental, .. }
            | Self::Feed { to, words, incremental, .. }
            | Self::Skip { to, words, incremental, .. }
            | Self::ReturnToReference { via: to, words, incremental, .. } => (to, None, *words, *incremental),
            Self::Arc { to, center, words, incremental, .. } => (to, Some(center), *words, *incremental),
            _ => return,
        };
        for axis in Axis::ALL {
            if words.contains(axis) && !incremental.contains(axis) {
                shift[axis] = 0.0;
            }
            to[axis] += shift[axis];
            center.iter_mut().for_each(|center| center[axis] += shift[axis]);
        }
    }

    /// Whether look-ahead stops: no further block is read until this operation is done.
    #[must_use]
    pub fn stops_look_ahead(&self) -> bool {
        match self {
            Self::SetSystemVariable { number, .. } => !system_variable::is_display_only(*number),
            Self::Skip { .. } | Self::ReturnToReference { .. } => true,
            Self::Gauge(_) | Self::OscillationOn { .. } | Self::OscillationOff => true,
            Self::Alarm { .. } | Self::StopWithMessage { .. } => true,
            Self::M { code, .. } => mcode::find(u16::from(*code)).is_some_and(|row| match row.action {
                MCodeAction::ProgramStop | MCodeAction::OptionalStop | MCodeAction::ProgramEnd => true,
                MCodeAction::AwaitInput(_) => true,
                MCodeAction::CountWorkpiece | MCodeAction::Request(_) | MCodeAction::ProgramFlow => false,
                MCodeAction::Port(_) | MCodeAction::Pulse => false,
            }),
            Self::Rapid { .. } | Self::Feed { .. } | Self::Arc { .. } | Self::Dwell { .. } | Self::SetPathMode(_) => {
                false
            }
            Self::SetCoordinateSystem { .. } | Self::HomeSwitch { .. } => true,
            Self::Thread(_) | Self::IndexTurret { .. } => false,
            Self::SelectWorkOffset { .. }
            | Self::SetLocalZero { .. }
            | Self::SpeedLimit { .. }
            | Self::MachineMove { .. } => false,
            Self::S { .. } | Self::T { .. } | Self::SetVariable { .. } => false,
            Self::DisplayMessage { .. } | Self::Print { .. } => false,
            Self::AddWear { .. } | Self::DressReturn { .. } => false,
        }
    }
}
