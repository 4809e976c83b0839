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
use super::oscillation::{LEAST_STROKE_MM, Stroke};
use crate::defs::mcode::{self, Action, MCode, Request};
use crate::defs::param::{self, Params};
use crate::defs::text::Said;
use crate::motion::{End, Plane, Rate, Shape, Turn};
use crate::nc::{
    self, AxisSet, Block, Feed, Frames, Gauging, Interpreter, Library, Memory, Op, PathMode, Place, Source, SpeedMode,
};
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
    /// Stand still, seconds.
    Dwell(f64),
    /// Wheel speed.
    Wheel(f64, SpeedMode),
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
    /// An MDI line, not a program.
    pub mdi: bool,
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
}

/// Frames and position at the end of what has been read.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Frames in force there; shared until one changes.
    pub frames: Arc<Frames>,
    /// Machine position there.
    pub machine: PerAxis<f64>,
    /// The dressing points; they do not change in a run.
    pub dress_points: PerAxis<Option<f64>>,
    /// The axis that oscillates there.
    pub oscillating: Option<Axis>,
    /// Every axis is homed.
    pub homed: bool,
    path: PathMode,
}

/// The axes that a block names, and those of them that it names as distances.
type Named = (AxisSet, AxisSet);

/// What a move may not do.
#[derive(Clone, Debug, PartialEq)]
pub enum Forbidden {
    /// Leave the soft limits: axis, target, limit, all machine coordinates in radius mm.
    SoftLimit(Axis, f64, f64),
    /// Move before homing.
    NotHomed,
    /// Move an axis that oscillates, or oscillate a second one.
    Oscillating(Axis),
    /// Oscillate over no length, or an axis that is not homed.
    NoStroke(Axis),
    /// Return to a dressing point that was never set.
    NoDressPoint(Axis),
    /// A code that this version does not have.
    NotYet(u8),
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
            mdi: false,
            since: now,
            splitting: false,
            settle_since: None,
            gauging: None,
            parted: None,
        }
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

impl Planned {
    /// The beginning of a run.
    #[must_use]
    pub fn new(frames: Frames, machine: PerAxis<f64>, dress_points: PerAxis<Option<f64>>, path: PathMode) -> Self {
        Self { frames: Arc::new(frames), machine, dress_points, oscillating: None, homed: true, path }
    }

    /// Turns one operation into items.
    fn take(&mut self, op: &Op, at: Place, items: &mut VecDeque<Item>, params: &Params) -> Result<(), Forbidden> {
        let act = match op {
            Op::Rapid { to, words, incremental } => {
                return self.line(*to, Speed::Rapid, (*words, *incremental), items, params);
            }
            Op::Feed { to, feed, words, incremental } => {
                return self.line(*to, speed(*feed), (*words, *incremental), items, params);
            }
            Op::Arc { .. } => return self.arc(op, items, params),
            Op::MachineMove { to, feed } => {
                let mut named = AxisSet::NONE;
                to.iter().filter(|(_, to)| to.is_some()).for_each(|(axis, _)| named.insert(axis));
                let target = PerAxis::from_fn(|axis| to[axis].unwrap_or(self.machine[axis]));
                let speed = feed.map_or(Speed::Rapid, speed);
                return self.push(PlannedMove::new(target, Shape::Line, speed, (named, AxisSet::NONE)), items, params);
            }
            Op::Reference { via, words, incremental } => {
                self.line(*via, Speed::Rapid, (*words, *incremental), items, params)?;
                let home = |axis: Axis| params.of_axis(param::HOME_X, axis);
                let to = PerAxis::from_fn(|axis| if words.contains(axis) { home(axis) } else { self.machine[axis] });
                let named = (*words, AxisSet::NONE);
                return self.push(PlannedMove::new(to, Shape::Line, Speed::Rapid, named), items, params);
            }
            Op::Skip { to, feed, signal, words, incremental } => {
                self.line(*to, speed(*feed), (*words, *incremental), items, params)?;
                match items.pop_back() {
                    Some(Item::Move(planned)) => Act::Skip(Box::new(planned), *signal),
                    _ => return Ok(()),
                }
            }
            Op::AddWear { .. }
            | Op::DressReturn { .. }
            | Op::OscillationOn { .. }
            | Op::OscillationOff
            | Op::Gauge(_) => return self.take_grinding(op, items, params),
            Op::Path(mode) => {
                self.path = *mode;
                return Ok(());
            }
            Op::Frame { g } => {
                Arc::make_mut(&mut self.frames).activate(*g);
                Act::Frames(Arc::clone(&self.frames))
            }
            Op::Preset { values } => Act::Preset(*values),
            Op::T { tool, offset } => {
                Arc::make_mut(&mut self.frames).call_tool(*tool, *offset);
                Act::Frames(Arc::clone(&self.frames))
            }
            Op::M { code, s, p, l } => {
                let row = mcode::find_in_any(u16::from(*code)).ok_or(Forbidden::NotYet(*code))?;
                Act::Machine(MCall { row, s: *s, p: p.unwrap_or(0.0) as u8, l_ms: l.unwrap_or(0.0) as u32 })
            }
            Op::S { value, mode } => Act::Wheel(*value, *mode),
            Op::SpeedLimit { .. } => return Ok(()),
            Op::Dwell { s } => Act::Dwell(*s),
            Op::Set { variable, value } => Act::Set(*variable, *value),
            Op::SetSystem { number, value } => Act::SetSystem(*number, *value),
            Op::Alarm { number, text } => Act::Alarm(*number as u16, Said::new(&**text, &**text), at),
            Op::Note { text } => Act::Note(Said::new(&**text, &**text)),
            Op::Message { text, .. } => Act::Message(Said::new(&**text, &**text)),
        };
        items.push_back(Item::Do(act));
        Ok(())
    }

    /// The grinding functions (K4).
    fn take_grinding(&mut self, op: &Op, items: &mut VecDeque<Item>, params: &Params) -> Result<(), Forbidden> {
        let act = match op {
            Op::AddWear { number, by } => {
                Arc::make_mut(&mut self.frames).add_wear(*number, *by);
                Act::Frames(Arc::clone(&self.frames))
            }
            Op::Gauge(gauging) => {
                let mut asked = *gauging;
                asked.to += self.frames.machine_minus_work(asked.axis);
                if self.oscillating == Some(asked.axis) {
                    return Err(Forbidden::Oscillating(asked.axis));
                }
                within(asked.axis, asked.to, params)?;
                Act::Gauge(asked)
            }
            Op::OscillationOn { stroke: None, .. } => Act::Cylinder(true),
            Op::OscillationOn { stroke: Some((axis, to)), ramp_ms, strokes_min } => {
                let to = to + self.frames.machine_minus_work(*axis);
                if self.oscillating.is_some() {
                    return Err(Forbidden::Oscillating(*axis));
                }
                if (to - self.machine[*axis]).abs() < LEAST_STROKE_MM {
                    return Err(Forbidden::NoStroke(*axis));
                }
                within(*axis, to, params)?;
                self.oscillating = Some(*axis);
                Act::Oscillate(Stroke { axis: *axis, to, ramp_ms: *ramp_ms, strokes_min: *strokes_min })
            }
            Op::OscillationOff => {
                self.oscillating = None;
                Act::Cylinder(false)
            }
            Op::DressReturn { axes, feed } => return self.dress_return(*axes, *feed, items, params),
            _ => return Ok(()),
        };
        items.push_back(Item::Do(act));
        Ok(())
    }

    /// A straight line to a work coordinate.
    fn line(
        &mut self,
        to: PerAxis<f64>,
        speed: Speed,
        named: Named,
        items: &mut VecDeque<Item>,
        params: &Params,
    ) -> Result<(), Forbidden> {
        let target = self.target(to, named.0);
        self.push(PlannedMove::new(target, Shape::Line, speed, named), items, params)
    }

    /// Machine coordinates of a target; axes that the block does not name stay where they are.
    fn target(&self, to: PerAxis<f64>, words: AxisSet) -> PerAxis<f64> {
        let machine = self.frames.machine_from_work(to);
        PerAxis::from_fn(|axis| if words.contains(axis) { machine[axis] } else { self.machine[axis] })
    }

    /// G27: machine coordinates, whatever offsets are in force.
    fn dress_return(
        &mut self,
        axes: AxisSet,
        feed: Option<f64>,
        items: &mut VecDeque<Item>,
        params: &Params,
    ) -> Result<(), Forbidden> {
        let mut target = self.machine;
        for axis in axes.iter() {
            target[axis] = self.dress_points[axis].ok_or(Forbidden::NoDressPoint(axis))?;
        }
        let speed = Speed::PerMinute(feed.unwrap_or_else(|| params.get(param::DRESS_RETURN_SPEED)));
        let planned = PlannedMove::new(target, Shape::Line, speed, (axes, AxisSet::NONE));
        let path = std::mem::replace(&mut self.path, PathMode::ExactStop);
        let pushed = self.push(planned, items, params);
        self.path = path;
        pushed
    }

    fn arc(&mut self, op: &Op, items: &mut VecDeque<Item>, params: &Params) -> Result<(), Forbidden> {
        let Op::Arc { to, center, plane, turn, feed, words, incremental } = op else { return Ok(()) };
        let target = self.target(*to, *words);
        let center = self.frames.machine_from_work(*center);
        let plane = match plane {
            nc::Plane::Xy => Plane::Xy,
            nc::Plane::Zx => Plane::Zx,
            nc::Plane::Yz => Plane::Yz,
        };
        let turn = if *turn > 0 { Turn::Ccw } else { Turn::Cw };
        let shape = Shape::Arc { center, plane, turn };
        self.push(PlannedMove::new(target, shape, speed(*feed), (*words, *incremental)), items, params)
    }

    fn push(&mut self, mut planned: PlannedMove, items: &mut VecDeque<Item>, params: &Params) -> Result<(), Forbidden> {
        if let Some(axis) = self.oscillating.filter(|axis| planned.words.contains(*axis)) {
            return Err(Forbidden::Oscillating(axis)); // K4.3: before the block starts
        }
        if !self.homed {
            return Err(Forbidden::NotHomed);
        }
        planned.check(self.machine, params)?;
        planned.end = match (planned.speed, self.path) {
            (Speed::Rapid, _) | (_, PathMode::ExactStop) => End::ExactStop,
            (_, PathMode::Continuous { tolerance_mm }) => End::Continuous { tolerance_mm },
        };
        self.machine = planned.to;
        items.push_back(Item::Move(planned));
        Ok(())
    }
}

const fn speed(feed: Feed) -> Speed {
    match feed {
        Feed::PerMinute(mm_min) => Speed::PerMinute(mm_min),
        Feed::PerRev(mm) => Speed::PerRev(mm),
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
