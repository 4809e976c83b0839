//! Manual intervention in a feed hold: axes may be jogged, and cycle start continues from where they were left.
//!
//! The jogged distance shifts the rest of the interrupted block and all later blocks, in axes that they program
//! incrementally or not at all. An axis programmed absolutely goes to its target, which ends the shift of that axis.
//! A hold in contact can withdraw the wheel automatically; the return move comes first when the run continues.
//! Source: spec K2.2, K6.3, K5.18.

use super::Program;
use super::activity::{Activity, Handover, ManualIntervention};
use super::move_refusal::MoveRefusal;
use super::queue::{PlannedMove, ProgrammedFeed, QueueItem, QueuedAction};
use super::run::ProgramRun;
use crate::controller::axes::AxisOwner;
use crate::controller::plant::{ControlEvent, Plant};
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::defs::text::Text;
use crate::motion::MoveShape;
use crate::nc::AxisSet;
use crate::units::{Axis, MachinePos, PerAxis};

const WHEEL_STOPPED: Text = Text::new(
    "暂停中砂轮已停：先启动砂轮，再循环启动",
    "the wheel was stopped during the hold: start it before cycle start",
);
const DRIVE_STOPPED: Text = Text::new(
    "暂停中工件已停转：先启动，再循环启动",
    "the workpiece was stopped during the hold: start it before cycle start",
);

/// Shifts smaller than this, mm, are rounding of a stop.
const MOVED_MM: f64 = 1e-9;

impl Program {
    /// Hands the axes over to manual motion; pending moves go back to the run. False while the axes still move.
    pub fn detach_from_run(&mut self, plant: &mut Plant) -> bool {
        if plant.axes.owner() == AxisOwner::Manual {
            return true;
        }
        if !plant.axes.planner.is_at_rest() {
            return false;
        }
        if let Some(run) = &mut self.run {
            run.take_back_moves(plant);
            if matches!(run.activity, Activity::Skip { .. } | Activity::Gauge(_)) {
                run.activity = Activity::Idle; // the move starts again from the new position
            }
            let start = plant.axes.program_set_point();
            run.handover = Handover::Detached(ManualIntervention { start, withdrawn: None });
        }
        plant.axes.switch_to_manual();
        true
    }

    /// K5.18: a hold while the wheel grinds withdraws it by P90, mm.
    pub fn withdraw_wheel(&mut self, plant: &mut Plant) {
        let distance = plant.params.get(param::HOLD_RETRACT_DISTANCE);
        let grinds = plant.outputs.on.has(Output::Wheel) && self.run.as_ref().is_some_and(|run| run.is_in_contact());
        if distance <= 0.0 || !grinds || !self.detach_from_run(plant) {
            return;
        }
        let axis = plant.kind.row().wheel_axis;
        plant.jog.move_by(axis, distance, &plant.axes, &plant.params);
        if let Some(Handover::Detached(parted)) = self.run.as_mut().map(|run| &mut run.handover) {
            parted.withdrawn = Some((axis, distance));
        }
    }

    /// The wheel or drive that was stopped in the pause and must be started before cycle start.
    pub fn spindle_stopped_in_pause(&self, plant: &Plant) -> Option<Text> {
        let switches = plant.operator.switches;
        let run = self.run.as_ref().filter(|_| !switches.dry_run && !switches.aux_function_lock)?;
        let [wheel, drive] = plant.running_spindles();
        // The M code at the front is requested again.
        let asked = run.front_request();
        if plant.execution.spindles_before_pause[0] && !wheel && asked != Some(Request::WheelStart) {
            return Some(WHEEL_STOPPED);
        }
        let again = matches!(asked, Some(Request::WorkDriveHigh | Request::WorkDriveLow | Request::SpindleStart(_)));
        (plant.execution.spindles_before_pause[1] && !drive && !again).then_some(DRIVE_STOPPED)
    }

    /// Cycle start after a hold.
    pub fn resume_run(&mut self, plant: &mut Plant) {
        if let Some(run) = &mut self.run
            && run.activity == Activity::AwaitUnit
            && !run.is_pulsing()
        {
            run.activity = Activity::Idle; // a key may have switched the unit in the hold: request it again
        }
        // Moves that are taken back wait for the planner at rest.
        let takes_back = self.run.as_ref().is_some_and(|run| run.handover == Handover::TakingBack);
        if plant.axes.owner() == AxisOwner::Program && !takes_back {
            plant.axes.planner.resume();
        }
        plant.transition(ControlEvent::Start);
    }
}

impl ProgramRun {
    /// Hands the axes back to the run: they come to rest, then the jogged distance is applied to the run.
    /// False: not finished, or a shifted block would violate a soft limit; the run is then held again with a message.
    pub fn return_axes_to_run(&mut self, plant: &mut Plant) -> bool {
        if plant.axes.owner() == AxisOwner::Program {
            return true;
        }
        plant.jog.stop_all();
        for axis in Axis::ALL {
            plant.axes.movers[axis].stop();
        }
        if !plant.axes.is_at_rest() {
            return false;
        }
        match self.handover {
            Handover::Detached(parted) => {
                let now = plant.axes.program_set_point();
                if let Err(forbidden) = self.shift_by_intervention(parted, now, &plant.params) {
                    let message = forbidden.text(&plant.params);
                    plant.refuse(message);
                    plant.transition(ControlEvent::Hold);
                    return false;
                }
            }
            // A restarted run already has its approach moves.
            Handover::Feeding | Handover::TakingBack if !self.queue.is_empty() => {}
            Handover::Feeding | Handover::TakingBack => {
                self.lookahead.machine_position = plant.axes.program_set_point()
            }
        }
        plant.axes.switch_to_program();
        plant.axes.planner.resume();
        true
    }

    /// M20 is at the front: a second request would pulse twice.
    fn is_pulsing(&self) -> bool {
        matches!(self.front_request(), Some(Request::Pulse(..)))
    }

    /// The machine request of the M code at the front.
    fn front_request(&self) -> Option<Request> {
        let Some(QueueItem::Action(QueuedAction::MCode(call))) = self.queue.front() else { return None };
        call.request()
    }

    /// The present block is a feed move or a dwell: the wheel may touch the part.
    fn is_in_contact(&self) -> bool {
        match self.queue.front() {
            Some(QueueItem::Move(planned)) => planned.speed != ProgrammedFeed::Rapid,
            Some(QueueItem::BlockStart(_) | QueueItem::BlockEnd | QueueItem::Action(_)) | None => {
                matches!(self.activity, Activity::Dwell { .. })
            }
        }
    }

    /// Continues the run from the present axis positions. On an error nothing is changed.
    fn shift_by_intervention(
        &mut self,
        parted: ManualIntervention,
        now: MachinePos,
        params: &Params,
    ) -> Result<(), MoveRefusal> {
        let mut shift = now - parted.start;
        if let Some((axis, distance)) = parted.withdrawn {
            shift[axis] -= distance;
        }
        let begin = parted.start + shift;
        let back = self.return_moves(parted, begin, &shift, params);
        // Tried first: an error changes nothing.
        self.check_shift(shift, begin, params)?;
        self.queue.range_mut(self.handed_over..).for_each(|item| item.shift(&mut shift));
        for planned in back.into_iter().rev().flatten() {
            self.queue.insert(self.handed_over, QueueItem::Move(planned));
        }
        self.lookahead.machine_position = self.lookahead.machine_position + shift;
        self.interpreter.shift_by_hand(shift);
        self.handover = Handover::Feeding;
        Ok(())
    }

    /// Whether every move stays within the soft limits with a shift; `from` is where the first one begins.
    fn check_shift(&self, mut shift: PerAxis<f64>, mut from: MachinePos, params: &Params) -> Result<(), MoveRefusal> {
        for item in self.queue.range(self.handed_over..) {
            match item {
                QueueItem::Move(planned) | QueueItem::Action(QueuedAction::Skip(planned, _)) => {
                    let mut moved = planned.clone();
                    moved.shift(&mut shift);
                    moved.check_soft_limits(from, params)?;
                    from = moved.to;
                }
                QueueItem::Action(QueuedAction::Thread(thread)) => {
                    let mut moved = *thread;
                    moved.shift_by(&shift);
                    from = moved.run_out_end;
                }
                QueueItem::BlockStart(_) | QueueItem::BlockEnd | QueueItem::Action(_) => {}
            }
        }
        Ok(())
    }

    /// Moves inserted before the rest of the block: return of the withdrawn wheel, and return to the arc that was left.
    fn return_moves(
        &self,
        parted: ManualIntervention,
        begin: MachinePos,
        shift: &PerAxis<f64>,
        params: &Params,
    ) -> [Option<PlannedMove>; 2] {
        let speed = ProgrammedFeed::PerMinute(params.get(param::WHEEL_ON_INFEED_SPEED));
        let straight = |to| PlannedMove::new(to, MoveShape::Line, speed, (AxisSet::NONE, AxisSet::NONE));
        let mut back = [parted.withdrawn.map(|_| straight(begin)), None];
        if let Some(QueueItem::Move(next)) = self.queue.get(self.handed_over)
            && let MoveShape::Arc { plane, .. } = next.shape
        {
            let (first, second) = plane.axes();
            let mut start = begin;
            for axis in [first, second].into_iter().filter(|axis| !next.follows_manual_shift(*axis)) {
                start[axis] = parted.start[axis];
            }
            let moved = |axis: Axis| shift[axis].abs() > MOVED_MM && !next.follows_manual_shift(axis);
            if moved(first) || moved(second) {
                back[1] = Some(straight(start));
            }
        }
        back
    }
}

impl QueueItem {
    /// Shifts what the item moves.
    fn shift(&mut self, shift: &mut PerAxis<f64>) {
        match self {
            Self::Move(planned) | Self::Action(QueuedAction::Skip(planned, _)) => planned.shift(shift),
            // A thread is programmed incrementally.
            Self::Action(QueuedAction::Thread(thread)) => thread.shift_by(shift),
            Self::BlockStart(_) | Self::BlockEnd | Self::Action(_) => {}
        }
    }
}

impl PlannedMove {
    /// Whether an axis follows the shift: the block programs it incrementally or not at all.
    fn follows_manual_shift(&self, axis: Axis) -> bool {
        !self.named_axes.contains(axis) || self.incremental_axes.contains(axis)
    }

    /// Shifts the move. An axis that it programs absolutely ends the shift of that axis.
    fn shift(&mut self, shift: &mut PerAxis<f64>) {
        for axis in Axis::ALL {
            if self.follows_manual_shift(axis) {
                self.to[axis] += shift[axis];
                if let MoveShape::Arc { center, .. } = &mut self.shape {
                    center[axis] += shift[axis];
                }
            } else {
                shift[axis] = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::ArcDirection;
    use crate::units::Plane;

    fn line(to: [f64; 3], words: &[Axis], incremental: &[Axis]) -> PlannedMove {
        let set = |axes: &[Axis]| {
            let mut set = AxisSet::NONE;
            axes.iter().for_each(|axis| set.insert(*axis));
            set
        };
        PlannedMove::new(MachinePos::new(to), MoveShape::Line, ProgrammedFeed::Rapid, (set(words), set(incremental)))
    }

    #[test]
    fn k6_3_distances_are_shifted_until_a_place_is_named() {
        let mut shift = PerAxis([-0.05, 0.0, 0.2]);
        let mut first = line([10.0, 0.0, 5.0], &[Axis::Z], &[Axis::Z]);
        first.shift(&mut shift);
        assert_eq!(first.to, MachinePos::new([9.95, 0.0, 5.2]));
        let mut place = line([8.0, 0.0, 5.0], &[Axis::X], &[]);
        place.shift(&mut shift);
        assert_eq!(place.to, MachinePos::new([8.0, 0.0, 5.2]));
        let mut later = line([7.0, 0.0, 4.0], &[Axis::X, Axis::Z], &[Axis::X, Axis::Z]);
        later.shift(&mut shift);
        assert_eq!(later.to, MachinePos::new([7.0, 0.0, 4.2]));
    }

    #[test]
    fn k6_3_the_centre_of_an_incremental_arc_goes_with_it() {
        let mut shift = PerAxis([-0.05, 0.0, 0.0]);
        let mut arc = line([0.0, 0.0, 10.0], &[Axis::X, Axis::Z], &[Axis::X, Axis::Z]);
        let center = MachinePos::new([5.0, 0.0, 5.0]);
        arc.shape = MoveShape::Arc { center, plane: Plane::Zx, direction: ArcDirection::Cw };
        arc.shift(&mut shift);
        assert_eq!(arc.to, MachinePos::new([-0.05, 0.0, 10.0]));
        let center = MachinePos::new([4.95, 0.0, 5.0]);
        assert_eq!(arc.shape, MoveShape::Arc { center, plane: Plane::Zx, direction: ArcDirection::Cw });
    }
}
