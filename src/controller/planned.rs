//! Read-ahead: converts operations to queue items in machine coordinates, or refuses them before their block moves.
//! Source: spec B3, B5, K4.

use std::collections::VecDeque;
use std::sync::Arc;

use super::offsets::in_range;
use super::oscillation::{LEAST_STROKE_MM, Stroke};
use super::run::{Act, Item, MCall, PlannedMove, Speed, within};
use crate::defs::kind::{Kind, System};
use crate::defs::mcode;
use crate::defs::param::{self, Params};
use crate::defs::text::Said;
use crate::link::edit::Part;
use crate::motion::{End, Plane, Shape, Thread, Turn};
use crate::nc::frames::OFFSETS;
use crate::nc::{self, AxisSet, Feed, Frames, Op, PathMode, Place, REFERENCES};
use crate::units::{Axis, PerAxis};

/// Work offsets, position and modal state at the end of the blocks read so far.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Active work offsets; shared until one changes.
    pub frames: Arc<Frames>,
    /// Machine position, radius mm.
    pub machine: PerAxis<f64>,
    /// The dressing points, machine coordinates, radius mm.
    pub dress_points: PerAxis<Option<f64>>,
    /// The oscillating axis.
    pub oscillating: Option<Axis>,
    /// Every axis is homed or need not be.
    pub homed: bool,
    /// The soft limits apply: every axis is homed.
    pub bounded: bool,
    /// The dialect of the program.
    pub system: System,
    path: PathMode,
}

/// The axes that a block programs, and those of them that it programs incrementally.
pub(super) type Named = (AxisSet, AxisSet);

/// Why a move or operation is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum Forbidden {
    /// Target beyond a soft limit: axis, target, limit; machine coordinates, radius mm.
    SoftLimit(Axis, f64, f64),
    /// Move before the axes are homed.
    NotHomed,
    /// Move of an oscillating axis, or oscillation of a second axis.
    Oscillating(Axis),
    /// Oscillation with zero stroke, or of an axis that is not homed.
    NoStroke(Axis),
    /// Wear outside the range of the offset page: axis and sum, mm of slide travel.
    Wear(Axis, f64),
    /// Return to a dressing point that is not set.
    NoDressPoint(Axis),
    /// M code that this version does not support.
    NotYet(u8),
}

impl Planned {
    /// State at the start of a run.
    #[must_use]
    pub fn new(frames: Frames, machine: PerAxis<f64>, dress_points: PerAxis<Option<f64>>, path: PathMode) -> Self {
        Self {
            frames: Arc::new(frames),
            machine,
            dress_points,
            oscillating: None,
            homed: true,
            bounded: true,
            system: Kind::default().system(),
            path,
        }
    }

    /// Converts one operation to queue items.
    pub(super) fn take(
        &mut self,
        op: &Op,
        at: Place,
        items: &mut VecDeque<Item>,
        params: &Params,
    ) -> Result<(), Forbidden> {
        let act = match op {
            Op::Rapid { to, feed, words, incremental } => {
                let speed = feed.map_or(Speed::Rapid, speed);
                return self.line(*to, speed, (*words, *incremental), items, params);
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
            Op::Reference { number, via, words, incremental } => {
                self.line(*via, Speed::Rapid, (*words, *incremental), items, params)?;
                let at = references(params)[usize::from(*number).clamp(1, REFERENCES) - 1];
                let to = PerAxis::from_fn(|axis| if words.contains(axis) { at[axis] } else { self.machine[axis] });
                let named = (*words, AxisSet::NONE);
                return self.push(PlannedMove::new(to, Shape::Line, Speed::Rapid, named), items, params);
            }
            Op::Skip { to, feed, signal, words, incremental } => {
                self.line(*to, speed(*feed), (*words, *incremental), items, params)?;
                let Some(Item::Move(planned)) = items.pop_back() else { return Ok(()) };
                Act::Skip(Box::new(planned), *signal)
            }
            Op::AddWear { .. }
            | Op::DressReturn { .. }
            | Op::OscillationOn { .. }
            | Op::OscillationOff
            | Op::Gauge(_) => return self.take_grinding(op, items, params),
            Op::Thread(_) | Op::HomeSwitch { .. } | Op::Post { .. } => return self.take_turning(op, items, params),
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
                let row = mcode::find_in(self.system, u16::from(*code)).ok_or(Forbidden::NotYet(*code))?;
                Act::Machine(MCall { row, s: *s, p: p.unwrap_or(0.0) as u8, l_ms: l.unwrap_or(0.0) as u32 })
            }
            Op::S { value, mode } => Act::Wheel(*value, *mode),
            Op::SpeedLimit { rpm } => Act::SpeedLimit(*rpm),
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
                // K4.1: the same range as on the offset page.
                let wear = self.frames.wear[usize::from(*number).clamp(1, OFFSETS) - 1];
                let shown =
                    |axis: Axis| if axis == Axis::X && !params.bit(param::RADIUS_PROGRAMMING) { 2.0 } else { 1.0 };
                if let Some(axis) =
                    by.iter().map(|(axis, _)| axis).find(|axis| !in_range(Part::Wear, wear[*axis] * shown(*axis)))
                {
                    return Err(Forbidden::Wear(axis, wear[axis]));
                }
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
                if let Some(other) = self.oscillating {
                    return Err(Forbidden::Oscillating(other));
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

    /// The lathe's functions (L5, L6, L8).
    fn take_turning(&mut self, op: &Op, items: &mut VecDeque<Item>, params: &Params) -> Result<(), Forbidden> {
        match op {
            Op::Thread(threading) => {
                let (out, to) =
                    (self.frames.machine_from_work(threading.out), self.frames.machine_from_work(threading.to));
                let (out, to) = (self.with_y(out), self.with_y(to));
                for axis in [Axis::X, Axis::Z].into_iter().filter(|_| self.bounded) {
                    within(axis, out[axis], params)?;
                    within(axis, to[axis], params)?;
                }
                self.machine = to;
                items.push_back(Item::Do(Act::Thread(Thread { out, to, lead_mm: threading.lead_mm })));
            }
            Op::HomeSwitch { axes } => {
                for axis in axes.iter() {
                    self.machine[axis] = params.of_axis(param::HOME_X, axis);
                    items.push_back(Item::Do(Act::Home(axis)));
                }
            }
            Op::Post { station, by } => {
                Arc::make_mut(&mut self.frames).change_tool(*station, *by);
                items.push_back(Item::Do(Act::Post(*station)));
                items.push_back(Item::Do(Act::Frames(Arc::clone(&self.frames))));
                let Some(by) = by else { return Ok(()) };
                let to = PerAxis::from_fn(|axis| self.machine[axis] + by[axis]);
                let both = AxisSet::of(Axis::X).with(AxisSet::of(Axis::Z));
                return self.push(PlannedMove::new(to, Shape::Line, Speed::Rapid, (both, both)), items, params);
            }
            _ => {}
        }
        Ok(())
    }

    /// The position with Y unchanged from the read-ahead position.
    fn with_y(&self, mut at: PerAxis<f64>) -> PerAxis<f64> {
        at[Axis::Y] = self.machine[Axis::Y];
        at
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

    /// Machine coordinates of a target; axes that the block does not program stay where they are.
    fn target(&self, to: PerAxis<f64>, words: AxisSet) -> PerAxis<f64> {
        let machine = self.frames.machine_from_work(to);
        PerAxis::from_fn(|axis| if words.contains(axis) { machine[axis] } else { self.machine[axis] })
    }

    /// G27: machine coordinates, independent of active offsets.
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
        if self.bounded {
            planned.check(self.machine, params)?;
        }
        planned.end = match (planned.speed, self.path) {
            (Speed::Rapid, _) | (_, PathMode::ExactStop) => End::ExactStop,
            (_, PathMode::Continuous { tolerance_mm }) => End::Continuous { tolerance_mm },
        };
        self.machine = planned.to;
        items.push_back(Item::Move(planned));
        Ok(())
    }
}

/// The reference points of G28 and G30, machine coordinates, radius mm.
#[must_use]
pub fn references(params: &Params) -> [PerAxis<f64>; REFERENCES] {
    [param::HOME_X, param::REFERENCE_2_X, param::REFERENCE_3_X, param::REFERENCE_4_X]
        .map(|x| PerAxis::from_fn(|axis| params.of_axis(x, axis)))
}

const fn speed(feed: Feed) -> Speed {
    match feed {
        Feed::PerMinute(mm_min) => Speed::PerMinute(mm_min),
        Feed::PerRev(mm) => Speed::PerRev(mm),
    }
}
