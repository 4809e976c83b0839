//! Manual intervention in a feed hold: axes may be jogged, and cycle start continues from where they were left.
//!
//! The jogged distance shifts the rest of the interrupted block and all later blocks, in axes that they program
//! incrementally or not at all. An axis programmed absolutely goes to its target, which ends the shift of that axis.
//! A hold in contact can withdraw the wheel automatically; the return move comes first when the run continues.
//! Source: spec K2.2, K6.3, K5.18.

use super::planned::Forbidden;
use super::run::{Act, Doing, Item, PlannedMove, Run, Speed};
use super::{Controller, Event, Phase};
use crate::controller::axes::Owner;
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::defs::text::Text;
use crate::motion::Shape;
use crate::nc::AxisSet;
use crate::units::{Axis, PerAxis};

/// State of a manual intervention.
#[derive(Clone, Copy, Debug)]
pub struct Parted {
    /// Set-points when it began, machine mm.
    at: PerAxis<f64>,
    /// The axis that the hold has withdrawn, and the distance, mm.
    withdrawn: Option<(Axis, f64)>,
}

const WHEEL_STOPPED: Text = Text::new(
    "暂停中砂轮已停：先启动砂轮，再循环启动",
    "the wheel was stopped in the pause: start it before cycle start",
);
const DRIVE_STOPPED: Text = Text::new(
    "暂停中工件已停转：先启动，再循环启动",
    "the workpiece was stopped in the pause: start it before cycle start",
);

/// Shifts smaller than this, mm, are rounding of a stop.
const MOVED_MM: f64 = 1e-9;

impl Controller {
    /// Whether manual motion is allowed: nothing runs, or the run is held or stopped.
    pub(super) const fn is_free_for_hand(&self) -> bool {
        matches!(self.phase, Phase::Idle | Phase::Held | Phase::Stopped)
    }

    /// Hands the axes over to manual motion; pending moves go back to the run. False while the axes still move.
    pub(super) fn part_from_run(&mut self) -> bool {
        if self.axes.owner() == Owner::Hand {
            return true;
        }
        if !self.axes.path.is_at_rest() {
            return false;
        }
        if let Some(mut run) = self.run.take() {
            self.take_back_moves(&mut run);
            if matches!(run.doing, Doing::Skipping { .. }) {
                run.doing = Doing::Nothing; // the skip move starts again from the new position
            }
            run.gauging = None;
            run.parted = Some(Parted { at: self.axes.program_set(), withdrawn: None });
            self.run = Some(run);
        }
        self.axes.give_to_hand();
        true
    }

    /// K5.18: a hold while the wheel grinds withdraws it by P90, mm.
    pub(super) fn withdraw_wheel(&mut self) {
        let distance = self.params.get(param::HOLD_WITHDRAW);
        let grinds = self.output_set.has(Output::Wheel) && self.run.as_ref().is_some_and(|run| run.is_in_contact());
        if distance <= 0.0 || !grinds || !self.part_from_run() {
            return;
        }
        let axis = self.row.slow_axis;
        self.hand.nudge(axis, distance, &self.axes, &self.params);
        if let Some(Parted { withdrawn, .. }) = self.run.as_mut().and_then(|run| run.parted.as_mut()) {
            *withdrawn = Some((axis, distance));
        }
    }

    /// Hands the axes back to the run: they come to rest, then the jogged distance is applied to the run.
    /// False: not finished, or a shifted block would violate a soft limit; the run is then held again with a message.
    pub(super) fn join_axes(&mut self, run: &mut Run) -> bool {
        if self.axes.owner() == Owner::Path {
            return true;
        }
        self.hand.let_go();
        for axis in Axis::ALL {
            self.axes.movers[axis].stop();
        }
        if !self.axes.is_at_rest() {
            return false;
        }
        match run.parted {
            Some(parted) => {
                if let Err(forbidden) = run.rejoin(parted, self.axes.program_set(), &self.params) {
                    let said = self.forbidden(&forbidden);
                    self.refuse(said);
                    self.happen(Event::Hold);
                    return false;
                }
            }
            // A restarted run already has its approach moves.
            None if !run.items.is_empty() => {}
            None => run.planned.machine = self.axes.program_set(),
        }
        self.axes.give_to_path();
        self.axes.path.resume();
        true
    }

    /// A pause begins: records wheel and workpiece drive. What was running must run again before the run continues.
    pub(super) fn remember_what_turns(&mut self) {
        let turned = self.what_turns();
        if let Some(run) = &mut self.run {
            run.turned = turned;
        }
    }

    pub(super) fn what_turns(&self) -> [bool; 2] {
        let part = self.machine.drive_is_on() || self.machine.spindle_direction().is_some();
        [self.output_set.has(Output::Wheel), part]
    }

    /// The wheel or drive that was stopped in the pause and must be started before cycle start.
    pub(super) fn stopped_in_pause(&self) -> Option<Text> {
        let run = self.run.as_ref().filter(|_| !self.switches.dry_run && !self.switches.mst_lock)?;
        let [wheel, drive] = self.what_turns();
        // The M code at the front is requested again.
        let asked = run.front_request();
        if run.turned[0] && !wheel && asked != Some(Request::WheelStart) {
            return Some(WHEEL_STOPPED);
        }
        let again = matches!(asked, Some(Request::DriveHigh | Request::DriveLow | Request::SpindleStart(_)));
        (run.turned[1] && !drive && !again).then_some(DRIVE_STOPPED)
    }

    /// Cycle start after a hold.
    pub(super) fn resume_run(&mut self) {
        if let Some(run) = &mut self.run
            && run.doing == Doing::Settling
            && !run.is_pulsing()
        {
            run.doing = Doing::Nothing; // a key may have switched the unit in the hold: request it again
        }
        if self.axes.owner() == Owner::Path {
            self.axes.path.resume();
        }
        self.happen(Event::Start);
    }
}

impl Run {
    /// M20 is at the front: a second request would pulse twice.
    fn is_pulsing(&self) -> bool {
        matches!(self.front_request(), Some(Request::Pulse(..)))
    }

    /// The machine request of the M code at the front.
    fn front_request(&self) -> Option<Request> {
        let Some(Item::Do(Act::Machine(call))) = self.items.front() else { return None };
        call.request()
    }

    /// The present block is a feed move or a dwell: the wheel may touch the part.
    fn is_in_contact(&self) -> bool {
        match self.items.front() {
            Some(Item::Move(planned)) => planned.speed != Speed::Rapid,
            Some(Item::Begin(_) | Item::End | Item::Do(_)) | None => matches!(self.doing, Doing::Dwell { .. }),
        }
    }

    /// Continues the run from the present axis positions. On an error nothing is changed.
    fn rejoin(&mut self, parted: Parted, now: PerAxis<f64>, params: &Params) -> Result<(), Forbidden> {
        let mut shift = PerAxis::from_fn(|axis| now[axis] - parted.at[axis]);
        if let Some((axis, distance)) = parted.withdrawn {
            shift[axis] -= distance;
        }
        let begin = PerAxis::from_fn(|axis| parted.at[axis] + shift[axis]);
        let mut items = self.items.clone();
        let back = self.way_back(parted, begin, &shift, params);
        let mut from = begin;
        for item in &mut items {
            if let Item::Do(Act::Thread(thread)) = item {
                // A thread is programmed incrementally.
                thread.shift(&shift);
                from = thread.to;
            }
            if let Some(planned) = item.planned_mut() {
                planned.shift(&mut shift);
                planned.check(from, params)?;
                from = planned.to;
            }
        }
        for planned in back.into_iter().rev() {
            items.push_front(Item::Move(planned));
        }
        self.items = items;
        self.planned.machine = PerAxis::from_fn(|axis| self.planned.machine[axis] + shift[axis]);
        self.parted = None;
        Ok(())
    }

    /// Moves inserted before the rest of the block: return of the withdrawn wheel, and return to the arc that was left.
    fn way_back(&self, parted: Parted, begin: PerAxis<f64>, shift: &PerAxis<f64>, params: &Params) -> Vec<PlannedMove> {
        let mut back = Vec::new();
        let speed = Speed::PerMinute(params.get(param::WHEEL_ON_SPEED));
        let straight = |to| PlannedMove::new(to, Shape::Line, speed, (AxisSet::NONE, AxisSet::NONE));
        if parted.withdrawn.is_some() {
            back.push(straight(begin));
        }
        if let Some(Item::Move(next)) = self.items.front()
            && let Shape::Arc { plane, .. } = next.shape
        {
            let (first, second, _) = plane.axes();
            let mut start = begin;
            for axis in [first, second].into_iter().filter(|axis| !next.follows_hand(*axis)) {
                start[axis] = parted.at[axis];
            }
            let moved = |axis: Axis| shift[axis].abs() > MOVED_MM && !next.follows_hand(axis);
            if moved(first) || moved(second) {
                back.push(straight(start));
            }
        }
        back
    }
}

impl Item {
    /// The move of an item, if it has one.
    fn planned_mut(&mut self) -> Option<&mut PlannedMove> {
        match self {
            Self::Move(planned) => Some(planned),
            Self::Do(Act::Skip(planned, _)) => Some(planned),
            Self::Begin(_) | Self::End | Self::Do(_) => None,
        }
    }
}

impl PlannedMove {
    /// Whether an axis follows the shift: the block programs it incrementally or not at all.
    fn follows_hand(&self, axis: Axis) -> bool {
        !self.words.contains(axis) || self.incremental.contains(axis)
    }

    /// Shifts the move. An axis that it programs absolutely ends the shift of that axis.
    fn shift(&mut self, shift: &mut PerAxis<f64>) {
        for axis in Axis::ALL {
            if self.follows_hand(axis) {
                self.to[axis] += shift[axis];
                if let Shape::Arc { center, .. } = &mut self.shape {
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
    use crate::motion::{Plane, Turn};

    fn line(to: [f64; 3], words: &[Axis], incremental: &[Axis]) -> PlannedMove {
        let set = |axes: &[Axis]| {
            let mut set = AxisSet::NONE;
            axes.iter().for_each(|axis| set.insert(*axis));
            set
        };
        PlannedMove::new(PerAxis(to), Shape::Line, Speed::Rapid, (set(words), set(incremental)))
    }

    #[test]
    fn k6_3_distances_are_shifted_until_a_place_is_named() {
        let mut shift = PerAxis([-0.05, 0.0, 0.2]);
        let mut first = line([10.0, 0.0, 5.0], &[Axis::Z], &[Axis::Z]);
        first.shift(&mut shift);
        assert_eq!(first.to, PerAxis([9.95, 0.0, 5.2]));
        let mut place = line([8.0, 0.0, 5.0], &[Axis::X], &[]);
        place.shift(&mut shift);
        assert_eq!(place.to, PerAxis([8.0, 0.0, 5.2]));
        let mut later = line([7.0, 0.0, 4.0], &[Axis::X, Axis::Z], &[Axis::X, Axis::Z]);
        later.shift(&mut shift);
        assert_eq!(later.to, PerAxis([7.0, 0.0, 4.2]));
    }

    #[test]
    fn k6_3_the_centre_of_an_incremental_arc_goes_with_it() {
        let mut shift = PerAxis([-0.05, 0.0, 0.0]);
        let mut arc = line([0.0, 0.0, 10.0], &[Axis::X, Axis::Z], &[Axis::X, Axis::Z]);
        arc.shape = Shape::Arc { center: PerAxis([5.0, 0.0, 5.0]), plane: Plane::Zx, turn: Turn::Cw };
        arc.shift(&mut shift);
        assert_eq!(arc.to, PerAxis([-0.05, 0.0, 10.0]));
        assert_eq!(arc.shape, Shape::Arc { center: PerAxis([4.95, 0.0, 5.0]), plane: Plane::Zx, turn: Turn::Cw });
    }
}
