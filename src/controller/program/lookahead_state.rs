//! Read-ahead: converts operations to queue items in machine coordinates, or refuses them before their block moves.
//! Source: spec B3, B5, K4.

use std::collections::VecDeque;

use super::move_refusal::MoveRefusal;
use super::queue::{MCall, PlannedMove, ProgrammedFeed, QueueItem, QueuedAction, check_soft_limits};
use crate::controller::axes::oscillation::{MIN_STROKE_MM, OscillationStroke};
use crate::controller::plant::{displayed_per_mm, offset_in_range};
use crate::defs::kind::{Dialect, Kind};
use crate::defs::param::{self, Params};
use crate::defs::text::LocalizedText;
use crate::link::edit::OffsetPart;
use crate::motion::{ArcDirection, CornerMode, MoveShape, ThreadPass};
use crate::nc::op_effect::WorkMove;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{
    ArcMove, AxisSet, BlockLocation, CoordinateChange, Feed, Op, OpEffect, OpMotion, OscillationChange, PathMode,
    ProgramMessage, REFERENCE_POINTS, ThreadMove, WorkOffsets,
};
use crate::units::{Axis, MachinePos, PerAxis, WorkPos};

/// The queue that the operations go to.
type QueueItems = VecDeque<QueueItem>;
/// A value, or why the operation is refused.
type Checked<T = ()> = Result<T, MoveRefusal>;

/// Work offsets, position and modal state at the end of the blocks read so far.
#[derive(Clone, Debug)]
pub struct LookaheadState {
    /// Active work offsets.
    pub work_offsets: WorkOffsets,
    /// Machine position, radius mm.
    pub machine_position: MachinePos,
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
    pub fn new(offsets: WorkOffsets, machine: MachinePos, dress_points: PerAxis<Option<f64>>, path: PathMode) -> Self {
        Self {
            work_offsets: offsets,
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
    pub(super) fn queue_op(&mut self, op: &Op, at: BlockLocation, items: &mut QueueItems, params: &Params) -> Checked {
        let action = match op.effect() {
            OpEffect::Motion(motion) => return self.queue_motion(motion, items, params),
            OpEffect::IndexTurret { station, by } => return self.queue_turret(station, by, items, params),
            OpEffect::PathMode(mode) => {
                self.path = mode;
                return Ok(());
            }
            OpEffect::Coordinates(change) => self.change_coordinates(change, params)?,
            OpEffect::Oscillation(change) => self.change_oscillation(change, params)?,
            OpEffect::MCode(words) => {
                let call = MCall::new(self.dialect, &words).ok_or(MoveRefusal::Unsupported(words.code))?;
                QueuedAction::MCode(call)
            }
            OpEffect::Speed(value, mode) => QueuedAction::WheelSpeed(value, mode),
            OpEffect::SpeedLimit(rpm) => QueuedAction::WheelSpeedLimit(rpm),
            OpEffect::Dwell(seconds) => QueuedAction::Dwell(seconds),
            OpEffect::Variable(variable, value) => QueuedAction::SetVariable(variable, value),
            OpEffect::SystemVariable(number, value) => QueuedAction::SetSystemVariable(number, value),
            OpEffect::Message(message) => match message {
                ProgramMessage::Alarm(number, text) => {
                    QueuedAction::Alarm(number as u16, LocalizedText::of_program(text), at)
                }
                ProgramMessage::Print(text) => QueuedAction::Print(text.clone()),
                ProgramMessage::Show(text) => QueuedAction::Note(LocalizedText::of_program(text)),
                ProgramMessage::Stop(_, text) => QueuedAction::Message(LocalizedText::of_program(text)),
            },
        };
        items.push_back(QueueItem::Action(action));
        Ok(())
    }

    fn queue_motion(&mut self, motion: OpMotion<'_>, items: &mut QueueItems, params: &Params) -> Checked {
        match motion {
            OpMotion::Work(by) => self.queue_work_move(by, items, params),
            OpMotion::Machine { to, feed } => {
                let target = MachinePos::from_fn(|axis| to[axis].unwrap_or(self.machine_position[axis]));
                let named = (motion.named_axes(), AxisSet::NONE);
                self.queue_move(PlannedMove::new(target, MoveShape::Line, speed(feed), named), items, params)
            }
            OpMotion::Reference { number, via, words, incremental } => {
                let target = self.machine_target(via, words);
                let rapid = ProgrammedFeed::Rapid;
                let via = PlannedMove::new(target, MoveShape::Line, rapid, (words, incremental));
                self.queue_move(via, items, params)?;
                let at = reference_points(params)[usize::from(number).clamp(1, REFERENCE_POINTS) - 1];
                let stays = self.machine_position;
                let to = MachinePos::from_fn(|axis| if words.contains(axis) { at[axis] } else { stays[axis] });
                let named = (words, AxisSet::NONE);
                self.queue_move(PlannedMove::new(to, MoveShape::Line, rapid, named), items, params)
            }
            OpMotion::DressPoint { axes, feed } => self.queue_dress_return(axes, feed, items, params),
            OpMotion::Gauge(gauging) => {
                let mut asked = *gauging;
                asked.to += self.work_offsets.machine_minus_work(asked.axis);
                if self.oscillating == Some(asked.axis) {
                    return Err(MoveRefusal::Oscillating(asked.axis));
                }
                check_soft_limits(asked.axis, asked.to, params)?;
                items.push_back(QueueItem::Action(QueuedAction::Gauge(asked)));
                Ok(())
            }
            OpMotion::Thread(threading) => self.queue_thread(threading, items, params),
            OpMotion::HomeSwitch(axes) => {
                for axis in axes.iter() {
                    self.machine_position[axis] = params.get_axis(param::HOME_X, axis);
                    items.push_back(QueueItem::Action(QueuedAction::Home(axis)));
                }
                Ok(())
            }
        }
    }

    /// A line or arc to a work coordinate.
    fn queue_work_move(&mut self, by: WorkMove, items: &mut QueueItems, params: &Params) -> Checked {
        let target = self.machine_target(by.to, by.words);
        let shape = match by.arc {
            None => MoveShape::Line,
            Some(ArcMove { center, plane, turn }) => MoveShape::Arc {
                center: self.work_offsets.machine_from_work(center),
                plane,
                direction: if turn > 0 { ArcDirection::Ccw } else { ArcDirection::Cw },
            },
        };
        let planned = PlannedMove::new(target, shape, speed(by.feed), (by.words, by.incremental));
        self.queue_move(planned, items, params)?;
        if let Some(signal) = by.skip_signal
            && let Some(QueueItem::Move(planned)) = items.pop_back()
        {
            items.push_back(QueueItem::Action(QueuedAction::Skip(planned, signal)));
        }
        Ok(())
    }

    /// G50 takes the position when it is executed; the other changes act at once.
    fn change_coordinates(&mut self, change: CoordinateChange, params: &Params) -> Checked<QueuedAction> {
        match (&change, self.oscillating) {
            // The place of an oscillating axis is by chance.
            (CoordinateChange::Set(values), Some(axis)) if values[axis].is_some() => {
                return Err(MoveRefusal::Oscillating(axis));
            }
            (CoordinateChange::Set(_), _) => {}
            _ => change.apply(&mut self.work_offsets, self.machine_position),
        }
        if let CoordinateChange::AddWear { number, by } = change {
            // K4.1: the same range as on the offset page.
            let wear = self.work_offsets.wear[usize::from(number).clamp(1, TOOL_OFFSET_COUNT) - 1];
            let in_range = |axis| offset_in_range(OffsetPart::Wear, wear[axis] * displayed_per_mm(params, axis));
            if let Some((axis, _)) = by.iter().find(|(axis, _)| !in_range(*axis)) {
                return Err(MoveRefusal::WearOutOfRange(axis, wear[axis]));
            }
        }
        Ok(QueuedAction::ChangeCoordinates(change))
    }

    fn change_oscillation(&mut self, change: OscillationChange, params: &Params) -> Checked<QueuedAction> {
        match change {
            OscillationChange::Cylinder { .. } => Ok(QueuedAction::Cylinder(true)),
            OscillationChange::Off => {
                self.oscillating = None;
                Ok(QueuedAction::Cylinder(false))
            }
            OscillationChange::Axis { axis, to, ramp_ms, strokes_min } => {
                let to = to + self.work_offsets.machine_minus_work(axis);
                if let Some(other) = self.oscillating {
                    return Err(MoveRefusal::Oscillating(other));
                }
                if (to - self.machine_position[axis]).abs() < MIN_STROKE_MM {
                    return Err(MoveRefusal::NoStroke(axis));
                }
                check_soft_limits(axis, to, params)?;
                self.oscillating = Some(axis);
                Ok(QueuedAction::Oscillate(OscillationStroke { axis, to, ramp_ms, strokes_min }))
            }
        }
    }

    /// A thread and its run-out (L5).
    fn queue_thread(&mut self, threading: &ThreadMove, items: &mut QueueItems, params: &Params) -> Checked {
        let out = self.with_y(self.work_offsets.machine_from_work(threading.run_out_start));
        let to = self.with_y(self.work_offsets.machine_from_work(threading.to));
        for axis in [Axis::X, Axis::Z].into_iter().filter(|_| self.soft_limits_active) {
            check_soft_limits(axis, out[axis], params)?;
            check_soft_limits(axis, to[axis], params)?;
        }
        self.machine_position = to;
        let pass = ThreadPass { run_out_start: out, run_out_end: to, lead_mm: threading.lead_mm };
        items.push_back(QueueItem::Action(QueuedAction::Thread(pass)));
        Ok(())
    }

    /// Turns the tool turret. With compensation the slides move in X and Z (L8).
    fn queue_turret(
        &mut self,
        station: u8,
        by: Option<PerAxis<f64>>,
        items: &mut QueueItems,
        params: &Params,
    ) -> Checked {
        self.work_offsets.change_tool(station, by);
        items.push_back(QueueItem::Action(QueuedAction::IndexTurret(station)));
        items.push_back(QueueItem::Action(QueuedAction::ChangeTool(station, by)));
        let Some(by) = by else { return Ok(()) };
        let to = self.machine_position + by;
        let named = (AxisSet::XZ, AxisSet::XZ);
        self.queue_move(PlannedMove::new(to, MoveShape::Line, ProgrammedFeed::Rapid, named), items, params)
    }

    /// The position with Y unchanged from the read-ahead position.
    fn with_y(&self, mut at: MachinePos) -> MachinePos {
        at[Axis::Y] = self.machine_position[Axis::Y];
        at
    }

    /// Machine coordinates of a target; axes that the block does not program stay where they are.
    fn machine_target(&self, to: WorkPos, words: AxisSet) -> MachinePos {
        let machine = self.work_offsets.machine_from_work(to);
        MachinePos::from_fn(|axis| if words.contains(axis) { machine[axis] } else { self.machine_position[axis] })
    }

    /// G27: machine coordinates, independent of active offsets.
    fn queue_dress_return(
        &mut self,
        axes: AxisSet,
        feed: Option<f64>,
        items: &mut QueueItems,
        params: &Params,
    ) -> Checked {
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

    fn queue_move(&mut self, mut planned: PlannedMove, items: &mut QueueItems, params: &Params) -> Checked {
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
pub fn reference_points(params: &Params) -> [MachinePos; REFERENCE_POINTS] {
    [param::HOME_X, param::REFERENCE_2_X, param::REFERENCE_3_X, param::REFERENCE_4_X]
        .map(|x| MachinePos::from_fn(|axis| params.get_axis(x, axis)))
}

const fn speed(feed: Option<Feed>) -> ProgrammedFeed {
    match feed {
        None => ProgrammedFeed::Rapid,
        Some(Feed::PerMinute(mm_min)) => ProgrammedFeed::PerMinute(mm_min),
        Some(Feed::PerRev(mm)) => ProgrammedFeed::PerRev(mm),
    }
}
