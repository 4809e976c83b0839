//! A run: the program being read ahead, and the queue of items read but not yet executed.
//!
//! Read-ahead converts operations to items in machine coordinates. The executor hands moves to the planner and executes
//! everything else when all motion before it is finished. So variables, work offsets and block numbers change when the
//! machine reaches them, not when they are read.
//! Source: spec B3 (shown as executed), B5, K6.3.

use std::collections::VecDeque;
use std::sync::Arc;

use super::axes::{MINUTE, soft_limits};
use super::gauge::GaugeRun;
use super::hold::Parted;
use super::oscillation::Stroke;
use super::planned::{Forbidden, Named, Planned};
use crate::defs::mcode::{Action, MCode, Request};
use crate::defs::param::Params;
use crate::defs::text::{Lang, Said};
use crate::motion::{End, Rate, Shape, Thread, Turn};
use crate::nc::{self, AxisSet, Block, Frames, Gauging, Interpreter, Library, Memory, Place, Source, SpeedMode};
use crate::units::{Axis, Micros, PerAxis};

/// Maximum items read ahead.
pub const MOST_ITEMS: usize = 512;

/// A move with machine coordinates.
#[derive(Clone, Debug)]
pub struct PlannedMove {
    /// End point, machine coordinates, radius mm.
    pub to: PerAxis<f64>,
    /// Line or arc.
    pub shape: Shape,
    /// Its speed.
    pub speed: Speed,
    /// Exact stop, or blending within a tolerance band.
    pub end: End,
    /// Tag in the planner, once handed over.
    pub tag: Option<u32>,
    /// The axes that the block programs.
    pub words: AxisSet,
    /// Those of them that it programs incrementally.
    pub incremental: AxisSet,
}

impl PlannedMove {
    /// A move with exact stop, not yet handed to the planner.
    #[must_use]
    pub const fn new(to: PerAxis<f64>, shape: Shape, speed: Speed, (words, incremental): Named) -> Self {
        Self { to, shape, speed, end: End::ExactStop, tag: None, words, incremental }
    }

    /// Checks the soft limits of a move that starts at `from`: its end point, and the extreme points of an arc.
    ///
    /// # Errors
    /// The axis, its position and the limit.
    pub fn check(&self, from: PerAxis<f64>, params: &Params) -> Result<(), Forbidden> {
        for axis in Axis::ALL {
            if (self.to[axis] - from[axis]).abs() > 0.0 {
                within(axis, self.to[axis], params)?;
            }
        }
        let Shape::Arc { center, plane, turn } = self.shape else { return Ok(()) };
        let (first, second, _) = plane.axes();
        let radius = (from[first] - center[first]).hypot(from[second] - center[second]);
        for (axis, sign) in [(first, 1.0), (first, -1.0), (second, 1.0), (second, -1.0)] {
            let mut summit = center;
            summit[axis] += sign * radius;
            if passes(from, self.to, center, (first, second), turn == Turn::Ccw, summit) {
                within(axis, summit[axis], params)?;
            }
        }
        Ok(())
    }
}

/// The speed of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Rapid.
    Rapid,
    /// mm/min.
    PerMinute(f64),
    /// mm per revolution of the workpiece; converted when the move is handed over.
    PerRev(f64),
}

impl Speed {
    /// The rate at a workpiece speed, rpm, up to `most_mm_min`; `None` for feed per revolution without rotation.
    #[must_use]
    pub fn rate(self, drive_rpm: f64, most_mm_min: f64) -> Option<Rate> {
        let feed = |mm_min: f64| Rate::Feed { mm_s: mm_min.min(most_mm_min) / MINUTE };
        match self {
            Self::Rapid => Some(Rate::Rapid),
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
    /// The machine request of the code, if it has one.
    #[must_use]
    pub const fn request(&self) -> Option<Request> {
        match self.row.action {
            Action::Ask(request) => Some(request),
            Action::Port(on) => Some(Request::Port(self.p, on)),
            Action::Pulse => Some(Request::Pulse(self.p, self.l_ms)),
            Action::Pause
            | Action::OptionalStop
            | Action::End
            | Action::Count
            | Action::AwaitInput(_)
            | Action::Flow => None,
        }
    }
}

/// Everything other than a move.
#[derive(Clone, Debug)]
pub enum Act {
    /// Set a macro variable.
    Set(u32, Option<f64>),
    /// Write a system variable.
    SetSystem(u32, Option<f64>),
    /// G50: set the work coordinates of the position at execution, mm.
    Preset(PerAxis<Option<f64>>),
    /// Activate other work offsets or tool offsets.
    Frames(Arc<Frames>),
    /// An M code.
    Machine(MCall),
    /// G78; its end is a machine coordinate.
    Gauge(Gauging),
    /// G35 by servo.
    Oscillate(Stroke),
    /// G35 by cylinder (true), and G36 of either.
    Cylinder(bool),
    /// Thread with run-out, machine coordinates.
    Thread(Thread),
    /// Home an axis to its switch (lathe G36, G37, G39).
    Home(Axis),
    /// Index the tool post to a station.
    Post(u8),
    /// Dwell, s.
    Dwell(f64),
    /// S: wheel speed in the unit of the mode.
    Wheel(f64, SpeedMode),
    /// G50 S: maximum wheel speed under G96, rpm.
    SpeedLimit(f64),
    /// G31: move until a signal comes: the move and the gauge signal (1 to 6).
    Skip(Box<PlannedMove>, u8),
    /// Alarm raised by the program: number, text, block position.
    Alarm(u16, Said, Place),
    /// Program message, shown until it is replaced; an empty text ends it.
    Note(Said),
    /// Message of the program; the run stops until cycle start.
    Message(Said),
    /// The program ends without M30.
    Finish,
}

/// An item read but not yet executed.
#[derive(Clone, Debug)]
pub enum Item {
    /// Start of a block.
    Begin(Place),
    /// A move.
    Move(PlannedMove),
    /// Any other action.
    Do(Act),
    /// End of a block.
    End,
}

/// What the executor is in the middle of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// No action in progress.
    Nothing,
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
pub enum Reading {
    /// Blocks are being read.
    Open,
    /// The queue must be executed before the next block is read.
    Barrier,
    /// End of the program text, or a fault.
    Over,
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
pub struct Proving {
    /// The preflight.
    pub proof: nc::Proof,
    /// The operator has been informed.
    pub told: bool,
    /// Work offsets and tool-change point before the start: a refused program changes nothing.
    pub before: (Frames, Option<PerAxis<f64>>),
}

/// One run of a program or an MDI line.
pub struct Run {
    /// The interpreter of the program text.
    pub interpreter: Interpreter,
    /// Scratch for the block being read.
    pub block: Block,
    /// The queue: items read but not yet executed, in order.
    pub items: VecDeque<Item>,
    /// Number of items at the front of the queue that were handed over.
    pub fed: usize,
    /// The next planner tag.
    pub next_tag: u32,
    /// Machine state at the end of all items read.
    pub planned: Planned,
    /// State of read-ahead.
    pub reading: Reading,
    /// What the executor is in the middle of.
    pub doing: Doing,
    /// Origin of the run.
    pub origin: Origin,
    /// Start time.
    pub since: Micros,
    /// Single block was switched on after moves were handed over: the axes stop and the moves are taken back.
    pub splitting: bool,
    /// Start of the in-position wait of the front item.
    pub settle_since: Option<Micros>,
    /// G78 in progress.
    pub gauging: Option<GaugeRun>,
    /// Manual intervention in a hold.
    pub parted: Option<Parted>,
    /// Running when the run was paused: wheel, workpiece drive (headstock, table, roll) or main spindle.
    pub turned: [bool; 2],
    /// Preflight of the program before anything is executed.
    pub proving: Option<Box<Proving>>,
}

impl Run {
    /// Creates a run from the machine's present state.
    #[must_use]
    pub fn new(
        source: Arc<Source>,
        library: Arc<dyn Library + Send + Sync>,
        (settings, modals): (nc::Settings, nc::Modals),
        (memory, planned): (Memory, Planned),
        now: Micros,
    ) -> Self {
        let block = Block::new(&settings);
        Self {
            interpreter: Interpreter::new(source, library, settings, memory).with_modals(modals),
            block,
            items: VecDeque::with_capacity(MOST_ITEMS + 64),
            fed: 0,
            next_tag: 1,
            planned,
            reading: Reading::Open,
            doing: Doing::Nothing,
            origin: Origin::Program,
            since: now,
            splitting: false,
            settle_since: None,
            gauging: None,
            parted: None,
            turned: [false; 2],
            proving: None,
        }
    }

    /// Ends read-ahead with a program fault; its alarm is raised when everything before it is executed.
    pub fn end_by(&mut self, fault: &nc::Fault) {
        self.reading = Reading::Over;
        let said = Said::new(fault.text(Lang::Zh), fault.text(Lang::En));
        self.items.push_back(Item::Do(Act::Alarm(fault.alarm(), said, fault.place)));
    }

    /// Converts the block just read to queue items.
    ///
    /// # Errors
    /// The first refused operation. Nothing of the block is queued then.
    pub fn take_block(&mut self, params: &Params) -> Result<(), Forbidden> {
        let kept = self.items.len();
        let planned = self.planned.clone();
        self.items.push_back(Item::Begin(self.block.at));
        let ops = std::mem::take(&mut self.block.ops);
        let mut result = Ok(());
        for op in &ops {
            result = self.planned.take(op, self.block.at, &mut self.items, params);
            if result.is_err() {
                break;
            }
            if op.is_barrier() {
                self.reading = Reading::Barrier;
            }
        }
        self.block.ops = ops;
        match result {
            Ok(()) if self.block.complete => self.items.push_back(Item::End),
            Ok(()) => {}
            Err(_) => {
                self.items.truncate(kept);
                self.planned = planned;
            }
        }
        result
    }
}

/// Rounding tolerance of a soft limit, mm; far below the resolution.
const LIMIT_SLACK_MM: f64 = 1e-6;

pub(super) fn within(axis: Axis, at: f64, params: &Params) -> Result<(), Forbidden> {
    let (low, high) = soft_limits(params, axis);
    if at < low - LIMIT_SLACK_MM {
        return Err(Forbidden::SoftLimit(axis, at, low));
    }
    if at > high + LIMIT_SLACK_MM {
        return Err(Forbidden::SoftLimit(axis, at, high));
    }
    Ok(())
}

/// Whether an arc passes through a point of its circle.
fn passes(
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
        assert!(passes(from, to, center, plane, true, up) && !passes(from, to, center, plane, true, down));
        assert!(passes(from, to, center, plane, false, down) && !passes(from, to, center, plane, false, up));
        assert!(passes(from, from, center, plane, true, down), "a full circle passes everything");
    }

    #[test]
    fn b2_a_feed_per_revolution_needs_a_turning_workpiece() {
        assert_eq!(Speed::PerRev(0.1).rate(0.0, 6_000.0), None);
        // 0.1 mm/rev × 120 rpm = 12 mm/min = 0.2 mm/s
        let Some(Rate::Feed { mm_s }) = Speed::PerRev(0.1).rate(120.0, 6_000.0) else { panic!("no feed") };
        assert!((mm_s - 0.2).abs() < 1e-12);
    }
}
