//! Read-ahead: converts operations to queue items in machine coordinates, or refuses them before their block moves.
//! Source: spec B3, B5, K4.

use std::collections::VecDeque;
use std::sync::Arc;

use super::move_refusal::MoveRefusal;
use super::queue::{MCall, NamedAxes, PlannedMove, ProgrammedFeed, QueueItem, QueuedAction, check_soft_limits};
use crate::controller::axes::oscillation::{MIN_STROKE_MM, OscillationStroke};
use crate::controller::plant::offset_in_range;
use crate::defs::kind::{Dialect, Kind};
use crate::defs::mcode;
use crate::defs::param::{self, Params};
use crate::defs::text::LocalizedText;
use crate::link::edit::OffsetPart;
use crate::motion::{ArcDirection, CornerMode, MotionPlane, MoveShape, ThreadPass};
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{self, AxisSet, BlockLocation, Feed, Op, PathMode, REFERENCE_POINTS, WorkOffsets};
use crate::units::{Axis, PerAxis};

/// Work offsets, position and modal state at the end of the blocks read so far.
#[derive(Clone, Debug)]
pub struct LookaheadState {
    /// Active work offsets; shared until one changes.
    pub work_offsets: Arc<WorkOffsets>,
    /// Machine position, radius mm.
    pub machine_position: PerAxis<f64>,
    /// The dressing points, machine coordinates, radius mm.
    pub dress_points: PerAxis<Option<f64>>,
    /// The oscillating axis.
    pub oscillating: Option<Axis>,
    /// Every axis is homed or need not be.
    pub homed: bool,
    /// The soft limits apply: every axis is homed.
    pub soft_limits_active: bool,
    /// The dialect of the program.
    pub dialect: Dialect,
    path: PathMode,
}

impl LookaheadState {
    /// State at the start of a run.
    #[must_use]
    pub fn new(frames: WorkOffsets, machine: PerAxis<f64>, dress_points: PerAxis<Option<f64>>, path: PathMode) -> Self {
        Self {
            work_offsets: Arc::new(frames),
            machine_position: machine,
            dress_points,
            oscillating: None,
            homed: true,
            soft_limits_active: true,
            dialect: Kind::default().dialect(),
            path,
        }
    }

    /// Converts one operation to queue items.
    pub(super) fn queue_op(
        &mut self,
        op: &Op,
        at: BlockLocation,
        items: &mut VecDeque<QueueItem>,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        let act = match op {
            Op::Rapid { to, feed, words, incremental } => {
                let speed = feed.map_or(ProgrammedFeed::Rapid, speed);
                return self.queue_line(*to, speed, (*words, *incremental), items, params);
            }
            Op::Feed { to, feed, words, incremental } => {
                return self.queue_line(*to, speed(*feed), (*words, *incremental), items, params);
            }
            Op::Arc { .. } => return self.queue_arc(op, items, params),
            Op::MachineMove { to, feed } => {
                let mut named = AxisSet::NONE;
                to.iter().filter(|(_, to)| to.is_some()).for_each(|(axis, _)| named.insert(axis));
                let target = PerAxis::from_fn(|axis| to[axis].unwrap_or(self.machine_position[axis]));
                let speed = feed.map_or(ProgrammedFeed::Rapid, speed);
                return self.queue_move(
                    PlannedMove::new(target, MoveShape::Line, speed, (named, AxisSet::NONE)),
                    items,
                    params,
                );
            }
            Op::ReturnToReference { number, via, words, incremental } => {
                self.queue_line(*via, ProgrammedFeed::Rapid, (*words, *incremental), items, params)?;
                let at = reference_points(params)[usize::from(*number).clamp(1, REFERENCE_POINTS) - 1];
                let to =
                    PerAxis::from_fn(|axis| if words.contains(axis) { at[axis] } else { self.machine_position[axis] });
                let named = (*words, AxisSet::NONE);
                return self.queue_move(
                    PlannedMove::new(to, MoveShape::Line, ProgrammedFeed::Rapid, named),
                    items,
                    params,
                );
            }
            Op::Skip { to, feed, signal, words, incremental } => {
                self.queue_line(*to, speed(*feed), (*words, *incremental), items, params)?;
                let Some(QueueItem::Move(planned)) = items.pop_back() else { return Ok(()) };
                QueuedAction::Skip(Box::new(planned), *signal)
            }
            Op::AddWear { .. }
            | Op::DressReturn { .. }
            | Op::OscillationOn { .. }
            | Op::OscillationOff
            | Op::Gauge(_) => return self.queue_grinding_op(op, items, params),
            Op::Thread(_) | Op::HomeSwitch { .. } | Op::IndexTurret { .. } => {
                return self.queue_lathe_op(op, items, params);
            }
            Op::SetPathMode(mode) => {
                self.path = *mode;
                return Ok(());
            }
            Op::SelectWorkOffset { g } => {
                Arc::make_mut(&mut self.work_offsets).activate(*g);
                QueuedAction::SetWorkOffsets(Arc::clone(&self.work_offsets))
            }
            Op::SetCoordinateSystem { values } => QueuedAction::SetCoordinateSystem(*values),
            Op::T { tool, offset } => {
                Arc::make_mut(&mut self.work_offsets).call_tool(*tool, *offset);
                QueuedAction::SetWorkOffsets(Arc::clone(&self.work_offsets))
            }
            Op::M { code, s, p, l } => {
                let row = mcode::find_in(self.dialect, u16::from(*code)).ok_or(MoveRefusal::Unsupported(*code))?;
                QueuedAction::MCode(MCall { row, s: *s, p: p.unwrap_or(0.0) as u8, l_ms: l.unwrap_or(0.0) as u32 })
            }
            Op::S { value, mode } => QueuedAction::WheelSpeed(*value, *mode),
            Op::SpeedLimit { rpm } => QueuedAction::WheelSpeedLimit(*rpm),
            Op::Dwell { s } => QueuedAction::Dwell(*s),
            Op::SetVariable { variable, value } => QueuedAction::SetVariable(*variable, *value),
            Op::SetSystemVariable { number, value } => QueuedAction::SetSystemVariable(*number, *value),
            Op::Alarm { number, text } => QueuedAction::Alarm(*number as u16, LocalizedText::new(&**text, &**text), at),
            Op::DisplayMessage { text } => QueuedAction::Note(LocalizedText::new(&**text, &**text)),
            Op::StopWithMessage { text, .. } => QueuedAction::Message(LocalizedText::new(&**text, &**text)),
        };
        items.push_back(QueueItem::Action(act));
        Ok(())
    }

    /// The grinding functions (K4).
    fn queue_grinding_op(
        &mut self,
        op: &Op,
        items: &mut VecDeque<QueueItem>,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        let act = match op {
            Op::AddWear { number, by } => {
                Arc::make_mut(&mut self.work_offsets).add_wear(*number, *by);
                // K4.1: the same range as on the offset page.
                let wear = self.work_offsets.wear[usize::from(*number).clamp(1, TOOL_OFFSET_COUNT) - 1];
                let shown =
                    |axis: Axis| if axis == Axis::X && !params.bit(param::RADIUS_PROGRAMMING) { 2.0 } else { 1.0 };
                if let Some(axis) = by
                    .iter()
                    .map(|(axis, _)| axis)
                    .find(|axis| !offset_in_range(OffsetPart::Wear, wear[*axis] * shown(*axis)))
                {
                    return Err(MoveRefusal::WearOutOfRange(axis, wear[axis]));
                }
                QueuedAction::SetWorkOffsets(Arc::clone(&self.work_offsets))
            }
            Op::Gauge(gauging) => {
                let mut asked = *gauging;
                asked.to += self.work_offsets.machine_minus_work(asked.axis);
                if self.oscillating == Some(asked.axis) {
                    return Err(MoveRefusal::Oscillating(asked.axis));
                }
                check_soft_limits(asked.axis, asked.to, params)?;
                QueuedAction::Gauge(asked)
            }
            Op::OscillationOn { stroke: None, .. } => QueuedAction::Cylinder(true),
            Op::OscillationOn { stroke: Some((axis, to)), ramp_ms, strokes_min } => {
                let to = to + self.work_offsets.machine_minus_work(*axis);
                if let Some(other) = self.oscillating {
                    return Err(MoveRefusal::Oscillating(other));
                }
                if (to - self.machine_position[*axis]).abs() < MIN_STROKE_MM {
                    return Err(MoveRefusal::NoStroke(*axis));
                }
                check_soft_limits(*axis, to, params)?;
                self.oscillating = Some(*axis);
                QueuedAction::Oscillate(OscillationStroke {
                    axis: *axis,
                    to,
                    ramp_ms: *ramp_ms,
                    strokes_min: *strokes_min,
                })
            }
            Op::OscillationOff => {
                self.oscillating = None;
                QueuedAction::Cylinder(false)
            }
            Op::DressReturn { axes, feed } => return self.queue_dress_return(*axes, *feed, items, params),
            _ => return Ok(()),
        };
        items.push_back(QueueItem::Action(act));
        Ok(())
    }

    /// The lathe's functions (L5, L6, L8).
    fn queue_lathe_op(&mut self, op: &Op, items: &mut VecDeque<QueueItem>, params: &Params) -> Result<(), MoveRefusal> {
        match op {
            Op::Thread(threading) => {
                let (out, to) = (
                    self.work_offsets.machine_from_work(threading.run_out_start),
                    self.work_offsets.machine_from_work(threading.to),
                );
                let (out, to) = (self.with_y(out), self.with_y(to));
                for axis in [Axis::X, Axis::Z].into_iter().filter(|_| self.soft_limits_active) {
                    check_soft_limits(axis, out[axis], params)?;
                    check_soft_limits(axis, to[axis], params)?;
                }
                self.machine_position = to;
                items.push_back(QueueItem::Action(QueuedAction::Thread(ThreadPass {
                    run_out_start: out,
                    run_out_end: to,
                    lead_mm: threading.lead_mm,
                })));
            }
            Op::HomeSwitch { axes } => {
                for axis in axes.iter() {
                    self.machine_position[axis] = params.get_axis(param::HOME_X, axis);
                    items.push_back(QueueItem::Action(QueuedAction::Home(axis)));
                }
            }
            Op::IndexTurret { station, by } => {
                Arc::make_mut(&mut self.work_offsets).change_tool(*station, *by);
                items.push_back(QueueItem::Action(QueuedAction::IndexTurret(*station)));
                items.push_back(QueueItem::Action(QueuedAction::SetWorkOffsets(Arc::clone(&self.work_offsets))));
                let Some(by) = by else { return Ok(()) };
                let to = PerAxis::from_fn(|axis| self.machine_position[axis] + by[axis]);
                let both = AxisSet::of(Axis::X).with(AxisSet::of(Axis::Z));
                return self.queue_move(
                    PlannedMove::new(to, MoveShape::Line, ProgrammedFeed::Rapid, (both, both)),
                    items,
                    params,
                );
            }
            _ => {}
        }
        Ok(())
    }

    /// The position with Y unchanged from the read-ahead position.
    fn with_y(&self, mut at: PerAxis<f64>) -> PerAxis<f64> {
        at[Axis::Y] = self.machine_position[Axis::Y];
        at
    }

    /// A straight line to a work coordinate.
    fn queue_line(
        &mut self,
        to: PerAxis<f64>,
        speed: ProgrammedFeed,
        named: NamedAxes,
        items: &mut VecDeque<QueueItem>,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        let target = self.machine_target(to, named.0);
        self.queue_move(PlannedMove::new(target, MoveShape::Line, speed, named), items, params)
    }

    /// Machine coordinates of a target; axes that the block does not program stay where they are.
    fn machine_target(&self, to: PerAxis<f64>, words: AxisSet) -> PerAxis<f64> {
        let machine = self.work_offsets.machine_from_work(to);
        PerAxis::from_fn(|axis| if words.contains(axis) { machine[axis] } else { self.machine_position[axis] })
    }

    /// G27: machine coordinates, independent of active offsets.
    fn queue_dress_return(
        &mut self,
        axes: AxisSet,
        feed: Option<f64>,
        items: &mut VecDeque<QueueItem>,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        let mut target = self.machine_position;
        for axis in axes.iter() {
            target[axis] = self.dress_points[axis].ok_or(MoveRefusal::NoDressPoint(axis))?;
        }
        let speed = ProgrammedFeed::PerMinute(feed.unwrap_or_else(|| params.get(param::DRESS_RETURN_SPEED)));
        let planned = PlannedMove::new(target, MoveShape::Line, speed, (axes, AxisSet::NONE));
        let path = std::mem::replace(&mut self.path, PathMode::ExactStop);
        let pushed = self.queue_move(planned, items, params);
        self.path = path;
        pushed
    }

    fn queue_arc(&mut self, op: &Op, items: &mut VecDeque<QueueItem>, params: &Params) -> Result<(), MoveRefusal> {
        let Op::Arc { to, center, plane, turn, feed, words, incremental } = op else { return Ok(()) };
        let target = self.machine_target(*to, *words);
        let center = self.work_offsets.machine_from_work(*center);
        let plane = match plane {
            nc::ArcPlane::Xy => MotionPlane::Xy,
            nc::ArcPlane::Zx => MotionPlane::Zx,
            nc::ArcPlane::Yz => MotionPlane::Yz,
        };
        let turn = if *turn > 0 { ArcDirection::Ccw } else { ArcDirection::Cw };
        let shape = MoveShape::Arc { center, plane, direction: turn };
        self.queue_move(PlannedMove::new(target, shape, speed(*feed), (*words, *incremental)), items, params)
    }

    fn queue_move(
        &mut self,
        mut planned: PlannedMove,
        items: &mut VecDeque<QueueItem>,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        if let Some(axis) = self.oscillating.filter(|axis| planned.named_axes.contains(*axis)) {
            return Err(MoveRefusal::Oscillating(axis)); // K4.3: before the block starts
        }
        if !self.homed {
            return Err(MoveRefusal::NotHomed);
        }
        if self.soft_limits_active {
            planned.check_soft_limits(self.machine_position, params)?;
        }
        planned.end = match (planned.speed, self.path) {
            (ProgrammedFeed::Rapid, _) | (_, PathMode::ExactStop) => CornerMode::ExactStop,
            (_, PathMode::Continuous { tolerance_mm }) => CornerMode::Continuous { tolerance_mm },
        };
        self.machine_position = planned.to;
        items.push_back(QueueItem::Move(planned));
        Ok(())
    }
}

/// The reference points of G28 and G30, machine coordinates, radius mm.
#[must_use]
pub fn reference_points(params: &Params) -> [PerAxis<f64>; REFERENCE_POINTS] {
    [param::HOME_X, param::REFERENCE_2_X, param::REFERENCE_3_X, param::REFERENCE_4_X]
        .map(|x| PerAxis::from_fn(|axis| params.get_axis(x, axis)))
}

const fn speed(feed: Feed) -> ProgrammedFeed {
    match feed {
        Feed::PerMinute(mm_min) => ProgrammedFeed::PerMinute(mm_min),
        Feed::PerRev(mm) => ProgrammedFeed::PerRev(mm),
    }
}
