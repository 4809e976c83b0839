//! The queue of a run: moves with machine coordinates, and everything else in program order.
//! Source: spec B2, B5.

use super::move_refusal::MoveRefusal;
use crate::controller::axes::oscillation::OscillationStroke;
use crate::controller::axes::{SECONDS_PER_MINUTE, soft_limits};
use crate::defs::kind::Dialect;
use crate::defs::mcode::{MCode, MCodeAction, Request};
use crate::defs::param::Params;
use crate::defs::system_variable;
use crate::defs::text::LocalizedText;
use crate::defs::text::arg::Arg;
use crate::motion::{ArcDirection, CornerMode, MotionSpeed, MoveShape, ThreadPass};
use crate::nc::{AxisSet, BlockLocation, CoordinateChange, GaugeMove, MCodeWords, SpeedMode};
use crate::units::{Axis, MachinePos, PerAxis};

/// The axes that a block programs, and those of them that it programs incrementally.
pub type NamedAxes = (AxisSet, AxisSet);

/// A move with machine coordinates.
#[derive(Clone, Debug)]
pub struct PlannedMove {
    /// End point, machine coordinates, radius mm.
    pub to: MachinePos,
    /// Line or arc.
    pub shape: MoveShape,
    /// Its speed.
    pub speed: ProgrammedFeed,
    /// Exact stop, or blending within a tolerance band.
    pub end: CornerMode,
    /// Tag in the planner, once handed over.
    pub tag: Option<u32>,
    /// The axes that the block programs.
    pub named_axes: AxisSet,
    /// Those of them that it programs incrementally.
    pub incremental_axes: AxisSet,
}

impl PlannedMove {
    /// A move with exact stop, not yet handed to the planner.
    #[must_use]
    pub const fn new(to: MachinePos, shape: MoveShape, speed: ProgrammedFeed, named: NamedAxes) -> Self {
        let (named_axes, incremental_axes) = named;
        Self { to, shape, speed, end: CornerMode::ExactStop, tag: None, named_axes, incremental_axes }
    }

    /// Checks the soft limits of a move that starts at `from`: its end point, and the extreme points of an arc.
    ///
    /// # Errors
    /// The axis, its position and the limit.
    pub fn check_soft_limits(&self, from: MachinePos, params: &Params) -> Result<(), MoveRefusal> {
        for axis in Axis::ALL {
            if (self.to[axis] - from[axis]).abs() > 0.0 {
                check_soft_limits(axis, self.to[axis], params)?;
            }
        }
        let MoveShape::Arc { center, plane, direction } = self.shape else { return Ok(()) };
        let (first, second) = plane.axes();
        let arc = PlaneArc { from, to: self.to, center, first, second, ccw: direction == ArcDirection::Ccw };
        let radius = (from[first] - center[first]).hypot(from[second] - center[second]);
        for (axis, sign) in [(first, 1.0), (first, -1.0), (second, 1.0), (second, -1.0)] {
            let mut summit = center;
            summit[axis] += sign * radius;
            if arc.passes(summit) {
                check_soft_limits(axis, summit[axis], params)?;
            }
        }
        Ok(())
    }
}

/// The speed of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProgrammedFeed {
    /// Rapid.
    Rapid,
    /// mm/min.
    PerMinute(f64),
    /// mm per revolution of the workpiece; converted when the move is handed over.
    PerRev(f64),
}

impl ProgrammedFeed {
    /// The rate at a workpiece speed, rpm, up to `most_mm_min`; `None` for feed per revolution without rotation.
    #[must_use]
    pub fn rate(self, drive_rpm: f64, most_mm_min: f64) -> Option<MotionSpeed> {
        let feed = |mm_min: f64| MotionSpeed::Feed { mm_s: mm_min.min(most_mm_min) / SECONDS_PER_MINUTE };
        match self {
            Self::Rapid => Some(MotionSpeed::Rapid),
            Self::PerMinute(mm_min) => Some(feed(mm_min)),
            Self::PerRev(mm) if drive_rpm > 0.0 => Some(feed(mm * drive_rpm)),
            Self::PerRev(_) => None,
        }
    }
}

/// A programmed M code with its words.
#[derive(Clone, Copy, Debug)]
pub struct MCall {
    /// The code.
    pub row: &'static MCode,
    /// Speed, rpm (M63).
    pub s: Option<f64>,
    /// Port (M20 to M22), already checked by the interpreter.
    pub p: u8,
    /// Pulse length, ms (M20).
    pub l_ms: u32,
}

impl MCall {
    /// The row and the words of a code; `None` if the dialect does not have the code.
    #[must_use]
    pub fn new(dialect: Dialect, words: &MCodeWords) -> Option<Self> {
        let row = dialect.m_code(u16::from(words.code))?;
        Some(Self { row, s: words.s, p: words.p.unwrap_or(0.0) as u8, l_ms: words.l.unwrap_or(0.0) as u32 })
    }

    /// The machine request of the code, if it has one.
    #[must_use]
    pub const fn request(&self) -> Option<Request> {
        match self.row.action {
            MCodeAction::Request(request) => Some(request),
            MCodeAction::Port(on) => Some(Request::Port(self.p, on)),
            MCodeAction::Pulse => Some(Request::Pulse(self.p, self.l_ms)),
            MCodeAction::ProgramStop | MCodeAction::OptionalStop | MCodeAction::ProgramEnd => None,
            MCodeAction::CountWorkpiece | MCodeAction::AwaitInput(_) | MCodeAction::ProgramFlow => None,
        }
    }
}

/// Everything other than a move.
#[derive(Clone, Debug)]
pub enum QueuedAction {
    /// Set a macro variable.
    SetVariable(u32, Option<f64>),
    /// Write a system variable.
    SetSystemVariable(u32, Option<f64>),
    /// Change the work coordinates; G50 at the position of its execution.
    ChangeCoordinates(CoordinateChange),
    /// Change to the tool of a turret station; with compensation the slides move by this displacement.
    ChangeTool(u8, Option<PerAxis<f64>>),
    /// An M code.
    MCode(MCall),
    /// G78; its end is a machine coordinate.
    Gauge(GaugeMove),
    /// G35 by servo.
    Oscillate(OscillationStroke),
    /// G35 by cylinder (true), and G36 of either.
    Cylinder(bool),
    /// Thread with run-out, machine coordinates.
    Thread(ThreadPass),
    /// Home an axis to its switch (lathe G36, G37, G39).
    Home(Axis),
    /// Index the tool post to a station.
    IndexTurret(u8),
    /// Dwell, s.
    Dwell(f64),
    /// S: wheel speed in the unit of the mode.
    WheelSpeed(f64, SpeedMode),
    /// G50 S: maximum wheel speed under G96, rpm.
    WheelSpeedLimit(f64),
    /// G31: move until a signal comes: the move and the gauge signal (1 to 6).
    Skip(PlannedMove, u8),
    /// Alarm raised by the program: number, text, block position.
    Alarm(u16, LocalizedText, BlockLocation),
    /// Program message, shown until it is replaced; an empty text ends it.
    Note(LocalizedText),
    /// DPRNT: a line for the file of printed lines.
    Print(Arg),
    /// Message of the program; the run stops until cycle start.
    Message(LocalizedText),
    /// The program ends without M30.
    EndOfText,
}

impl QueuedAction {
    /// Whether the moves behind it wait until it is executed.
    #[must_use]
    pub fn waits_for_motion(&self) -> bool {
        match self {
            Self::SetVariable(..) | Self::Note(_) | Self::Print(_) | Self::ChangeTool(..) => false,
            Self::WheelSpeed(..) | Self::WheelSpeedLimit(_) => false,
            Self::ChangeCoordinates(change) => matches!(change, CoordinateChange::Set(_)),
            Self::SetSystemVariable(number, _) => !system_variable::is_display_only(*number),
            Self::MCode(..) | Self::Gauge(_) | Self::Oscillate(_) => true,
            Self::Cylinder(_) | Self::Thread(_) | Self::Home(_) | Self::IndexTurret(_) | Self::Dwell(_) => true,
            Self::Skip(..) | Self::Alarm(..) | Self::Message(_) | Self::EndOfText => true,
        }
    }
}

/// An item read but not yet executed.
#[derive(Clone, Debug)]
pub enum QueueItem {
    /// Start of a block.
    BlockStart(BlockLocation),
    /// A move.
    Move(PlannedMove),
    /// Any other action.
    Action(QueuedAction),
    /// End of a block.
    BlockEnd,
}

/// Rounding tolerance of a soft limit, mm; far below the resolution.
const LIMIT_SLACK_MM: f64 = 1e-6;

pub fn check_soft_limits(axis: Axis, at: f64, params: &Params) -> Result<(), MoveRefusal> {
    let (low, high) = soft_limits(params, axis);
    if at < low - LIMIT_SLACK_MM {
        return Err(MoveRefusal::SoftLimit(axis, at, low));
    }
    if at > high + LIMIT_SLACK_MM {
        return Err(MoveRefusal::SoftLimit(axis, at, high));
    }
    Ok(())
}

/// An arc in the plane of two axes.
struct PlaneArc {
    from: MachinePos,
    to: MachinePos,
    center: MachinePos,
    first: Axis,
    second: Axis,
    ccw: bool,
}

impl PlaneArc {
    /// Whether the arc passes through a point of its circle.
    fn passes(&self, point: MachinePos) -> bool {
        let Self { from, to, center, first, second, ccw } = *self;
        let angle = |at: MachinePos| (at[second] - center[second]).atan2(at[first] - center[first]);
        let sense = if ccw { 1.0 } else { -1.0 };
        let swept = |to: f64| (sense * (to - angle(from))).rem_euclid(std::f64::consts::TAU);
        let whole = swept(angle(to));
        whole < 1e-9 || swept(angle(point)) < whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b5_an_arc_is_checked_where_it_bulges() {
        // From angle 0 (Z+) counter-clockwise to 180°: it passes the summit at X+, not the one at X−.
        let center = MachinePos::new([0.0, 0.0, 0.0]);
        let (from, to) = (MachinePos::new([0.0, 0.0, 10.0]), MachinePos::new([0.0, 0.0, -10.0]));
        let passes =
            |from, to, ccw, point| PlaneArc { from, to, center, first: Axis::Z, second: Axis::X, ccw }.passes(point);
        let (up, down) = (MachinePos::new([10.0, 0.0, 0.0]), MachinePos::new([-10.0, 0.0, 0.0]));
        assert!(passes(from, to, true, up) && !passes(from, to, true, down));
        assert!(passes(from, to, false, down) && !passes(from, to, false, up));
        assert!(passes(from, from, true, down), "a full circle passes everything");
    }

    #[test]
    fn b2_a_feed_per_revolution_needs_a_turning_workpiece() {
        assert_eq!(ProgrammedFeed::PerRev(0.1).rate(0.0, 6_000.0), None);
        // 0.1 mm/rev × 120 rpm = 12 mm/min = 0.2 mm/s
        let Some(MotionSpeed::Feed { mm_s }) = ProgrammedFeed::PerRev(0.1).rate(120.0, 6_000.0) else {
            panic!("no feed")
        };
        assert!((mm_s - 0.2).abs() < 1e-12);
    }
}
