//! A run: the program being read ahead, and the queue of items read but not yet executed.
//!
//! Read-ahead converts operations to items in machine coordinates. The executor hands moves to the planner and executes
//! everything else when all motion before it is finished. So variables, work offsets and block numbers change when the
//! machine reaches them, not when they are read.
//! Source: spec B3 (shown as executed), B5, K6.3.

use std::collections::VecDeque;
use std::sync::Arc;

use super::axes::{SECONDS_PER_MINUTE, soft_limits};
use super::gauge::GaugeCycle;
use super::hold::ManualIntervention;
use super::lookahead_state::{LookaheadState, MoveRefusal, NamedAxes};
use super::oscillation::OscillationStroke;
use crate::defs::kind::Dialect;
use crate::defs::mcode::{self, MCode, MCodeAction, Request};
use crate::defs::param::Params;
use crate::defs::text::{Lang, LocalizedText};
use crate::motion::{ArcDirection, CornerMode, MotionSpeed, MoveShape, ThreadPass};
use crate::nc::{
    self, AxisSet, Block, BlockLocation, CommonVariables, GaugeMove, Interpreter, Library, MCodeWords, Source,
    SpeedMode, WorkOffsets,
};
use crate::units::{Axis, Micros, PerAxis};

/// Maximum items read ahead.
pub const MAX_ITEMS: usize = 512;

/// A move with machine coordinates.
#[derive(Clone, Debug)]
pub struct PlannedMove {
    /// End point, machine coordinates, radius mm.
    pub to: PerAxis<f64>,
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
    pub const fn new(
        to: PerAxis<f64>,
        shape: MoveShape,
        speed: ProgrammedFeed,
        (words, incremental): NamedAxes,
    ) -> Self {
        Self {
            to,
            shape,
            speed,
            end: CornerMode::ExactStop,
            tag: None,
            named_axes: words,
            incremental_axes: incremental,
        }
    }

    /// Checks the soft limits of a move that starts at `from`: its end point, and the extreme points of an arc.
    ///
    /// # Errors
    /// The axis, its position and the limit.
    pub fn check_soft_limits(&self, from: PerAxis<f64>, params: &Params) -> Result<(), MoveRefusal> {
        for axis in Axis::ALL {
            if (self.to[axis] - from[axis]).abs() > 0.0 {
                check_soft_limits(axis, self.to[axis], params)?;
            }
        }
        let MoveShape::Arc { center, plane, direction: turn } = self.shape else { return Ok(()) };
        let (first, second) = plane.axes();
        let radius = (from[first] - center[first]).hypot(from[second] - center[second]);
        for (axis, sign) in [(first, 1.0), (first, -1.0), (second, 1.0), (second, -1.0)] {
            let mut summit = center;
            summit[axis] += sign * radius;
            if arc_passes(from, self.to, center, (first, second), turn == ArcDirection::Ccw, summit) {
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
        let row = mcode::find_in(dialect, u16::from(words.code))?;
        Some(Self { row, s: words.s, p: words.p.unwrap_or(0.0) as u8, l_ms: words.l.unwrap_or(0.0) as u32 })
    }

    /// The machine request of the code, if it has one.
    #[must_use]
    pub const fn request(&self) -> Option<Request> {
        match self.row.action {
            MCodeAction::Request(request) => Some(request),
            MCodeAction::Port(on) => Some(Request::Port(self.p, on)),
            MCodeAction::Pulse => Some(Request::Pulse(self.p, self.l_ms)),
            MCodeAction::ProgramStop
            | MCodeAction::OptionalStop
            | MCodeAction::ProgramEnd
            | MCodeAction::CountWorkpiece
            | MCodeAction::AwaitInput(_)
            | MCodeAction::ProgramFlow => None,
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
    /// G50: set the work coordinates of the position at execution, mm.
    SetCoordinateSystem(PerAxis<Option<f64>>),
    /// Activate other work offsets or tool offsets.
    SetWorkOffsets(Arc<WorkOffsets>),
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
    Skip(Box<PlannedMove>, u8),
    /// Alarm raised by the program: number, text, block position.
    Alarm(u16, LocalizedText, BlockLocation),
    /// Program message, shown until it is replaced; an empty text ends it.
    Note(LocalizedText),
    /// Message of the program; the run stops until cycle start.
    Message(LocalizedText),
    /// The program ends without M30.
    EndOfText,
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

/// What the executor is in the middle of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// No action in progress.
    Idle,
    /// G04.
    Dwell { until: Micros },
    /// An M code was accepted and its unit has not settled yet.
    Settling,
    /// M80–M89.
    AwaitInput(crate::defs::signal::Input),
    /// A thread is being cut.
    Threading,
    /// An axis is homing.
    Homing,
    /// G31 is in progress.
    Skipping { tag: u32, latched: bool },
}

/// State of read-ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadAheadStatus {
    /// Blocks are being read.
    Open,
    /// The queue must be executed before the next block is read.
    Barrier,
    /// End of the program text, or a fault.
    Finished,
}

/// Origin of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The current program: has a preflight, obeys single block, repeats by P390.
    Program,
    /// An MDI line.
    Mdi,
    /// O9000 or O9001 of the one-key retract.
    Retract,
}

/// A preflight in progress.
pub struct PendingPreflight {
    /// The preflight.
    pub preflight: nc::ProgramPreflight,
    /// The operator has been informed.
    pub announced: bool,
    /// Work offsets and tool-change point before the start: a refused program changes nothing.
    pub before: (WorkOffsets, Option<PerAxis<f64>>),
}

/// One run of a program or an MDI line.
pub struct ProgramRun {
    /// The interpreter of the program text.
    pub interpreter: Interpreter,
    /// Scratch for the block being read.
    pub block: Block,
    /// The queue: items read but not yet executed, in order.
    pub queue: VecDeque<QueueItem>,
    /// Number of items at the front of the queue that were handed over.
    pub handed_over: usize,
    /// The next planner tag.
    pub next_tag: u32,
    /// Machine state at the end of all items read.
    pub lookahead: LookaheadState,
    /// State of read-ahead.
    pub read_ahead: ReadAheadStatus,
    /// What the executor is in the middle of.
    pub activity: Activity,
    /// Origin of the run.
    pub origin: Origin,
    /// Start time.
    pub started_at: Micros,
    /// Single block was switched on after moves were handed over: the axes stop and the moves are taken back.
    pub splitting: bool,
    /// Start of the in-position wait of the front item.
    pub settling_since: Option<Micros>,
    /// G78 in progress.
    pub gauge_cycle: Option<GaugeCycle>,
    /// Manual intervention in a hold.
    pub intervention: Option<ManualIntervention>,
    /// Running when the run was paused: wheel, workpiece drive (headstock, table, roll) or main spindle.
    pub spindles_before_pause: [bool; 2],
    /// Preflight of the program before anything is executed.
    pub preflight: Option<Box<PendingPreflight>>,
}

impl ProgramRun {
    /// Creates a run from the machine's present state.
    #[must_use]
    pub fn new(
        source: Arc<Source>,
        library: Arc<dyn Library + Send + Sync>,
        (settings, modals): (nc::NcSettings, nc::ModalState),
        (memory, planned): (CommonVariables, LookaheadState),
        now: Micros,
    ) -> Self {
        let block = Block::new(&settings);
        Self {
            interpreter: Interpreter::new(source, library, settings, memory).with_modals(modals),
            block,
            queue: VecDeque::with_capacity(MAX_ITEMS + 64),
            handed_over: 0,
            next_tag: 1,
            lookahead: planned,
            read_ahead: ReadAheadStatus::Open,
            activity: Activity::Idle,
            origin: Origin::Program,
            started_at: now,
            splitting: false,
            settling_since: None,
            gauge_cycle: None,
            intervention: None,
            spindles_before_pause: [false; 2],
            preflight: None,
        }
    }

    /// Ends read-ahead with a program fault; its alarm is raised when everything before it is executed.
    pub fn end_with_fault(&mut self, fault: &nc::ProgramFault) {
        self.read_ahead = ReadAheadStatus::Finished;
        let said = LocalizedText::new(fault.text(Lang::Zh), fault.text(Lang::En));
        self.queue.push_back(QueueItem::Action(QueuedAction::Alarm(fault.alarm(), said, fault.location)));
    }

    /// Converts the block just read to queue items.
    ///
    /// # Errors
    /// The first refused operation. Nothing of the block is queued then.
    pub fn queue_block(&mut self, params: &Params) -> Result<(), MoveRefusal> {
        let kept = self.queue.len();
        let planned = self.lookahead.clone();
        self.queue.push_back(QueueItem::BlockStart(self.block.location));
        let ops = std::mem::take(&mut self.block.ops);
        let mut result = Ok(());
        for op in &ops {
            result = self.lookahead.queue_op(op, self.block.location, &mut self.queue, params);
            if result.is_err() {
                break;
            }
            if op.stops_look_ahead() {
                self.read_ahead = ReadAheadStatus::Barrier;
            }
        }
        self.block.ops = ops;
        match result {
            Ok(()) if self.block.complete => self.queue.push_back(QueueItem::BlockEnd),
            Ok(()) => {}
            Err(_) => {
                self.queue.truncate(kept);
                self.lookahead = planned;
            }
        }
        result
    }
}

/// Rounding tolerance of a soft limit, mm; far below the resolution.
const LIMIT_SLACK_MM: f64 = 1e-6;

pub(super) fn check_soft_limits(axis: Axis, at: f64, params: &Params) -> Result<(), MoveRefusal> {
    let (low, high) = soft_limits(params, axis);
    if at < low - LIMIT_SLACK_MM {
        return Err(MoveRefusal::SoftLimit(axis, at, low));
    }
    if at > high + LIMIT_SLACK_MM {
        return Err(MoveRefusal::SoftLimit(axis, at, high));
    }
    Ok(())
}

/// Whether an arc passes through a point of its circle.
fn arc_passes(
    from: PerAxis<f64>,
    to: PerAxis<f64>,
    center: PerAxis<f64>,
    (first, second): (Axis, Axis),
    ccw: bool,
    point: PerAxis<f64>,
) -> bool {
    let angle = |at: PerAxis<f64>| (at[second] - center[second]).atan2(at[first] - center[first]);
    let sense = if ccw { 1.0 } else { -1.0 };
    let swept = |to: f64| (sense * (to - angle(from))).rem_euclid(std::f64::consts::TAU);
    let whole = swept(angle(to));
    whole < 1e-9 || swept(angle(point)) < whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b5_an_arc_is_checked_where_it_bulges() {
        // From angle 0 (Z+) counter-clockwise to 180°: it passes the summit at X+, not the one at X−.
        let center = PerAxis([0.0, 0.0, 0.0]);
        let (from, to) = (PerAxis([0.0, 0.0, 10.0]), PerAxis([0.0, 0.0, -10.0]));
        let plane = (Axis::Z, Axis::X);
        let (up, down) = (PerAxis([10.0, 0.0, 0.0]), PerAxis([-10.0, 0.0, 0.0]));
        assert!(arc_passes(from, to, center, plane, true, up) && !arc_passes(from, to, center, plane, true, down));
        assert!(arc_passes(from, to, center, plane, false, down) && !arc_passes(from, to, center, plane, false, up));
        assert!(arc_passes(from, from, center, plane, true, down), "a full circle passes everything");
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
