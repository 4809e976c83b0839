//! A run: the program being read ahead, and what has been read but not yet executed.
//!
//! Reading turns operations into items with machine coordinates; the executor hands moves to the path planner and does
//! everything else when all motion before it is finished. So variables, frames and block numbers change when the
//! machine gets there, not when the reader does.
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

/// Most items read ahead.
pub const MOST_ITEMS: usize = 512;

/// A move with machine coordinates.
#[derive(Clone, Debug)]
pub struct PlannedMove {
    /// End point, machine frame.
    pub to: PerAxis<f64>,
    /// Its form.
    pub shape: Shape,
    /// Its speed.
    pub speed: Speed,
    /// How its end may be taken.
    pub end: End,
    /// Mark in the path planner, once it is there.
    pub tag: Option<u32>,
    /// The axes that the block names.
    pub words: AxisSet,
    /// Those of them that it names as distances.
    pub incremental: AxisSet,
}

impl PlannedMove {
    /// A move that ends at rest, not yet handed to the planner.
    #[must_use]
    pub const fn new(to: PerAxis<f64>, shape: Shape, speed: Speed, (words, incremental): Named) -> Self {
        Self { to, shape, speed, end: End::ExactStop, tag: None, words, incremental }
    }

    /// Whether it stays within the soft limits from a place on: its end, and an arc where it bulges.
    ///
    /// # Errors
    /// The axis, its place and the limit.
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
    /// As fast as the axes allow.
    Rapid,
    /// mm/min.
    PerMinute(f64),
    /// mm per revolution of the workpiece; known when the move begins.
    PerRev(f64),
}

impl Speed {
    /// The rate at a workpiece speed; none if it turns nothing.
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

/// An M code with its words.
#[derive(Clone, Copy, Debug)]
pub struct MCall {
    /// The code.
    pub row: &'static MCode,
    /// Speed, rpm (M63).
    pub s: Option<f64>,
    /// Port (M20 to M22); the reader has checked it.
    pub p: u8,
    /// Length of a pulse, ms (M20).
    pub l_ms: u32,
}

impl MCall {
    /// The change of the machine that the code asks for, if it asks for one.
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

/// Something other than a move.
#[derive(Clone, Debug)]
pub enum Act {
    /// A macro variable gets its value.
    Set(u32, Option<f64>),
    /// A system variable is written.
    SetSystem(u32, Option<f64>),
    /// G50: the position where the machine then stands is called so.
    Preset(PerAxis<Option<f64>>),
    /// Other frames or offsets are in force from here on.
    Frames(Arc<Frames>),
    /// An M code.
    Machine(MCall),
    /// G78, its end as a machine coordinate.
    Gauge(Gauging),
    /// G35 by servo.
    Oscillate(Stroke),
    /// G35 by cylinder (true), and G36 of either.
    Cylinder(bool),
    /// A thread and its run-out, machine frame.
    Thread(Thread),
    /// An axis to its machine origin by its switch (G36).
    Home(Axis),
    /// The tool post to a station.
    Post(u8),
    /// Stand still, seconds.
    Dwell(f64),
    /// Wheel speed.
    Wheel(f64, SpeedMode),
    /// Most revolutions of the wheel under G96, rpm.
    SpeedLimit(f64),
    /// Move until a signal comes: the move, and which gauge signal.
    Skip(Box<PlannedMove>, u8),
    /// Alarm of the program's own.
    Alarm(u16, Said, Place),
    /// Text that is shown until another one; empty ends it.
    Note(Said),
    /// Message of the program's own; waits for cycle start.
    Message(Said),
    /// The program is over without M30.
    Finish,
}

/// What has been read and not yet executed.
#[derive(Clone, Debug)]
pub enum Item {
    /// A block of text begins.
    Begin(Place),
    /// A move.
    Move(PlannedMove),
    /// Anything else.
    Do(Act),
    /// The block of text is over.
    End,
}

/// What the executor is in the middle of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// Nothing that takes time.
    Nothing,
    /// G04.
    Dwell { until: Micros },
    /// An M code has been asked for and its unit is under way.
    Settling,
    /// M80–M89.
    AwaitInput(crate::defs::signal::Input),
    /// A thread is being cut.
    Threading,
    /// An axis looks for its switch.
    Homing,
    /// G31 is on its way.
    Skipping { tag: u32, latched: bool },
}

/// Why reading has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// It has not.
    Open,
    /// An operation that must be executed before the next block is read.
    Barrier,
    /// The text is over.
    Over,
}

/// What a run was opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The current program: stops after each block in single block, counts parts, ends the day's work with M30.
    Program,
    /// An MDI line.
    Mdi,
    /// O9000 or O9001 of the one-key retract.
    Retract,
}

/// A program that is looked through before it begins.
pub struct Proving {
    /// As far as it has come.
    pub proof: nc::Proof,
    /// The operator knows.
    pub told: bool,
    /// Frames, and the tool-change point of a lathe, before the start: a refused program changes nothing.
    pub before: (Frames, Option<PerAxis<f64>>),
}

/// One run of a program or an MDI line.
pub struct Run {
    /// The reader of the text.
    pub interpreter: Interpreter,
    /// Scratch for the block being read.
    pub block: Block,
    /// Read and not yet executed, in order.
    pub items: VecDeque<Item>,
    /// How many of them, from the front, have been handed on.
    pub fed: usize,
    /// The next mark for a move.
    pub next_tag: u32,
    /// State of the machine at the end of all that has been read.
    pub planned: Planned,
    /// Whether reading goes on.
    pub reading: Reading,
    /// What the executor is in the middle of.
    pub doing: Doing,
    /// What asked for it.
    pub origin: Origin,
    /// When it began.
    pub since: Micros,
    /// Single block was switched on with moves already handed over: the axes stop, and the moves are taken back.
    pub splitting: bool,
    /// In-position wait of the item at the front.
    pub settle_since: Option<Micros>,
    /// G78 under way.
    pub gauging: Option<GaugeRun>,
    /// The hand has the axes, in a hold.
    pub parted: Option<Parted>,
    /// What turned when the run was paused: wheel, headstock (table, roll).
    pub turned: [bool; 2],
    /// The proof of the text before anything of it is done.
    pub proving: Option<Box<Proving>>,
}

impl Run {
    /// Opens a run of a text, from the machine's present state.
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

    /// Nothing more is read: the program's mistake is told when everything before it is done.
    pub fn end_by(&mut self, fault: &nc::Fault) {
        self.reading = Reading::Over;
        let said = Said::new(fault.text(Lang::Zh), fault.text(Lang::En));
        self.items.push_back(Item::Do(Act::Alarm(fault.alarm(), said, fault.place)));
    }

    /// Turns the block just read into items.
    ///
    /// # Errors
    /// The first operation that may not be done; nothing of the block is kept then.
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

/// Rounding slack of a limit, mm: far below the resolution.
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

/// Whether an arc passes a point of its circle.
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
