//! Executes a run. Each tick: actions at the front of the queue, moves to the planner, blocks from the interpreter.
//! Source: spec B3, B5, K3.14.

use super::actions::raise_no_workpiece_drive;
use super::activity::{ActionStatus, Activity, Handover};
use super::move_refusal::MoveRefusal;
use super::queue::{ProgrammedFeed, QueueItem, QueuedAction};
use super::run::{Origin, ProgramRun, ReadAheadStatus};
use super::run_world::RunWorld;
use crate::controller::plant::{ControlEvent, ControlPhase, Plant};
use crate::defs::alarm;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Template, phrase};
use crate::motion::Move;
use crate::nc::{BlockLocation, NextStatus, PreflightStatus};

/// Maximum blocks with operations read per tick: more than the shortest moves take.
const BLOCKS_PER_TICK: usize = 16;
/// Maximum items left behind in a tick while the run brakes and stands.
const PASSED_ITEMS_PER_TICK: usize = 512;
/// Maximum actions executed per tick.
const ACTIONS_PER_TICK: usize = 64;

/// Passes of a loop without a change, and without a question to the machine, that prove that it does not end.
const PASSES_OF_PROOF: u32 = 2;

const REFUSED_BLOCK: &Template =
    &Template::new("{program} 第{line}行 {cause}", "{program} line {line} {cause}", &["program", "line", "cause"]);

impl ProgramRun {
    /// One tick of the run; `suspended` is the run that the retract has suspended. True when the run is over.
    pub fn step(&mut self, plant: &mut Plant, suspended: Option<&mut Self>) -> bool {
        if matches!(plant.execution.phase, ControlPhase::Holding | ControlPhase::Held) {
            self.latch_in_pause(plant);
        }
        self.drop_finished_moves(plant);
        if !matches!(plant.execution.phase, ControlPhase::Running) {
            self.leave_passed_blocks(plant, suspended);
            return false;
        }
        let over = self.execute_front(plant, suspended);
        if !matches!(plant.execution.phase, ControlPhase::Running) {
            return over;
        }
        if self.handover == Handover::TakingBack {
            self.take_back_moves(plant);
        } else if !over && self.preflight_passed(plant) {
            self.feed_planner(plant);
            self.read_ahead(plant);
            self.feed_planner(plant);
        }
        over
    }

    /// Extends a dwell by the time in which the program is held or returns from a hold.
    pub fn extend_dwell(&mut self, plant: &Plant) {
        if let Activity::Dwell { until } = &mut self.activity
            && (!matches!(plant.execution.phase, ControlPhase::Running)
                || matches!(self.queue.front(), Some(QueueItem::Move(_))))
        {
            *until = *until + plant.axes.tick_time();
        }
    }

    /// Removes finished moves from the queue.
    fn drop_finished_moves(&mut self, plant: &mut Plant) {
        let finished = plant.axes.planner.finished_tag();
        while self.handed_over > 0
            && let Some(QueueItem::Move(planned)) = self.queue.front()
            && planned.tag.is_some()
            && planned.tag <= finished
        {
            self.pop_front();
        }
    }

    /// While the run brakes to a hold and stands in it: leaves the blocks that the axes have passed, and does what stands
    /// between them.
    fn leave_passed_blocks(&mut self, plant: &mut Plant, mut suspended: Option<&mut Self>) {
        for _ in 0..PASSED_ITEMS_PER_TICK {
            let finished = plant.axes.planner.finished_tag();
            let next_move = self.queue.iter().take(self.handed_over).find_map(|item| match item {
                QueueItem::Move(planned) => Some(planned),
                _ => None,
            });
            if !next_move.is_some_and(|planned| planned.tag.is_some() && planned.tag <= finished) {
                return;
            }
            match self.queue.front() {
                Some(QueueItem::BlockStart(place)) => Self::enter_block(plant, *place),
                Some(QueueItem::Action(_)) => drop(self.execute_front_action(plant, &mut suspended)),
                Some(QueueItem::Move(_) | QueueItem::BlockEnd) | None => {}
            }
            self.pop_front();
        }
    }

    fn enter_block(plant: &mut Plant, place: BlockLocation) {
        plant.execution.enter_block(place);
        plant.execution.block_count += 1;
    }

    /// Executes the action at the front; it stays there.
    fn execute_front_action(&mut self, plant: &mut Plant, suspended: &mut Option<&mut Self>) -> ActionStatus {
        let Some(QueueItem::Action(action)) = self.queue.pop_front() else { return ActionStatus::Done };
        let status = self.execute_action(plant, &action);
        // A run suspended by the retract has its own copy of the variables.
        if let (QueuedAction::SetVariable(number, value), Some(waiting)) = (&action, suspended) {
            let _ = waiting.interpreter.update_variable(*number, *value);
        }
        self.queue.push_front(QueueItem::Action(action));
        status
    }

    /// Executes the items at the front of the queue. True when the run is over.
    fn execute_front(&mut self, plant: &mut Plant, mut suspended: Option<&mut Self>) -> bool {
        for _ in 0..ACTIONS_PER_TICK {
            self.drop_finished_moves(plant);
            let status = match self.queue.front() {
                None | Some(QueueItem::Move(_)) => return false,
                Some(QueueItem::BlockStart(place)) => {
                    Self::enter_block(plant, *place);
                    ActionStatus::Done
                }
                // While splitting, a block ends without a stop if its successor is already moving.
                Some(QueueItem::BlockEnd)
                    if plant.stops_after_blocks()
                        && self.origin == Origin::Program
                        && self.handover != Handover::TakingBack =>
                {
                    if self.is_settled(plant) {
                        ActionStatus::Stop
                    } else {
                        ActionStatus::Wait
                    }
                }
                Some(QueueItem::BlockEnd) => ActionStatus::Done,
                Some(QueueItem::Action(_)) => self.execute_front_action(plant, &mut suspended),
            };
            match status {
                ActionStatus::Wait => return false,
                ActionStatus::EndRun => return true,
                ActionStatus::Done | ActionStatus::Stop => {
                    self.pop_front();
                    // A block that ends with its own stop (M00) does not stop a second time in single block.
                    if matches!((&status, self.queue.front()), (ActionStatus::Stop, Some(QueueItem::BlockEnd))) {
                        self.pop_front();
                    }
                    self.activity = Activity::Idle;
                }
            }
            if matches!(status, ActionStatus::Stop) {
                plant.transition(ControlEvent::Stop);
                return false;
            }
            if !matches!(plant.execution.phase, ControlPhase::Running) {
                return false;
            }
        }
        false
    }

    fn pop_front(&mut self) {
        self.queue.pop_front();
        self.handed_over = self.handed_over.saturating_sub(1);
    }

    /// Hands moves to the planner, up to the first action that must be executed before them.
    fn feed_planner(&mut self, plant: &mut Plant) {
        while let Some(item) = self.queue.get_mut(self.handed_over) {
            match item {
                QueueItem::Move(planned) => {
                    if plant.axes.planner.free_slots() == 0 {
                        return;
                    }
                    let dry = plant.operator.switches.dry_run && planned.speed != ProgrammedFeed::Rapid;
                    let dry_feed = ProgrammedFeed::PerMinute(plant.params.get(param::DRY_RUN_FEED));
                    let speed = if dry { dry_feed } else { planned.speed };
                    let Some(rate) = speed.rate(plant.workpiece_rpm(), plant.params.get(param::FEED_MAX)) else {
                        // Alarm only at the front of the queue: an earlier item may still start the drive.
                        if self.handed_over == 0 {
                            raise_no_workpiece_drive(plant);
                        }
                        return;
                    };
                    let tag = self.next_tag;
                    let pushed = Move { to: planned.to, shape: planned.shape, speed: rate, corner: planned.end, tag };
                    if plant.axes.planner.push(pushed).is_err() {
                        return;
                    }
                    planned.tag = Some(tag);
                    self.next_tag += 1;
                }
                QueueItem::BlockEnd if plant.stops_after_blocks() && self.origin == Origin::Program => return,
                QueueItem::Action(action) if action.waits_for_motion() => return,
                QueueItem::Action(_) | QueueItem::BlockStart(_) | QueueItem::BlockEnd => {}
            }
            self.handed_over += 1;
        }
    }

    /// Whether the preflight is over. A program error found by it becomes an alarm and the state before is restored.
    fn preflight_passed(&mut self, plant: &mut Plant) -> bool {
        let Some(proving) = self.preflight.as_mut().filter(|pending| !pending.done) else { return true };
        let mut budget = plant.reading_budget();
        let status = proving.preflight.advance(&mut budget);
        plant.charge_reading(budget);
        proving.done = !matches!(status, PreflightStatus::Busy);
        match status {
            PreflightStatus::Busy => {
                if !std::mem::replace(&mut proving.announced, true) {
                    plant.show_note(phrase!("正在检查程序…", "checking the program …"));
                }
                return false;
            }
            PreflightStatus::Passed => {}
            PreflightStatus::Failed(fault) => {
                (plant.work.offsets, plant.work.tool_change_point) = proving.before.clone();
                self.queue.clear();
                self.handed_over = 0;
                self.end_with_fault(&fault);
            }
        }
        true
    }

    /// Reads blocks ahead.
    fn read_ahead(&mut self, plant: &mut Plant) {
        if self.read_ahead == ReadAheadStatus::Barrier && self.queue.is_empty() {
            self.read_ahead = ReadAheadStatus::Open;
        }
        for _ in 0..BLOCKS_PER_TICK {
            if self.read_ahead != ReadAheadStatus::Open || self.is_full() {
                return;
            }
            let drained = self.queue.is_empty() && plant.axes.is_at_rest() && plant.axes.is_in_position(&plant.params);
            let mut budget = plant.reading_budget();
            let mut world = RunWorld::new(plant, &self.lookahead, drained);
            let read = self.interpreter.next_within(&mut world, &mut self.block, &mut budget);
            let passes = self.interpreter.idle_passes();
            if world.was_asked || passes == 0 {
                self.asked_at_pass = passes;
            }
            let repeats = matches!(read, Ok(NextStatus::Busy | NextStatus::Waiting));
            plant.execution.is_endless = repeats && passes > self.asked_at_pass + PASSES_OF_PROOF;
            plant.charge_reading(budget);
            match read {
                Ok(NextStatus::Block) => {
                    if let Err(forbidden) = self.queue_block(&plant.params) {
                        self.read_ahead = ReadAheadStatus::Finished;
                        return self.queue_refusal_alarm(plant, &forbidden);
                    }
                }
                Ok(NextStatus::Drain | NextStatus::Busy | NextStatus::Waiting) => return,
                Ok(NextStatus::End) => {
                    self.queue.push_back(QueueItem::Action(QueuedAction::EndOfText));
                    self.read_ahead = ReadAheadStatus::Finished;
                }
                Err(fault) => self.end_with_fault(&fault),
            }
        }
    }

    /// Refuses a block: nothing of it is executed; its alarm is raised when all blocks before it are done.
    fn queue_refusal_alarm(&mut self, plant: &Plant, forbidden: &MoveRefusal) {
        let at = self.block.location;
        let number = match forbidden {
            MoveRefusal::SoftLimit(..) => alarm::SOFT_LIMIT,
            MoveRefusal::NotHomed => alarm::NOT_HOMED,
            MoveRefusal::Oscillating(_) => alarm::AXIS_OSCILLATES,
            MoveRefusal::NoStroke(_) => alarm::OSCILLATION_REFUSED,
            MoveRefusal::WearOutOfRange(..) => alarm::OFFSET_RANGE,
            MoveRefusal::NoDressPoint(_) => alarm::NO_DRESSING_POINT,
            MoveRefusal::Unsupported(_) => alarm::M_CODE_NOT_AVAILABLE,
        };
        let cause = forbidden.text(&plant.params);
        let place = [plant.program_title(at.program), at.line.into()];
        let message = LocalizedText::phrase_of(REFUSED_BLOCK, place, [cause]);
        self.queue.push_back(QueueItem::Action(QueuedAction::Alarm(number, message, at)));
    }

    /// Once the axes are at rest, takes the unfinished moves back from the planner, to hand them over block by block.
    /// The blocks that they have passed stay at the front, to be left without a stop.
    pub fn take_back_moves(&mut self, plant: &mut Plant) {
        if !plant.axes.planner.is_at_rest() {
            return;
        }
        plant.axes.planner.finish_passed_moves();
        plant.axes.planner.discard_moves();
        let finished = plant.axes.planner.finished_tag();
        let is_passed = |item: &QueueItem| matches!(item, QueueItem::Move(planned) if planned.tag <= finished);
        let last_passed = (0..self.handed_over).rev().find(|at| self.queue.get(*at).is_some_and(is_passed));
        let passed = last_passed.map_or(0, |at| at + 1);
        for item in self.queue.range_mut(passed..self.handed_over) {
            if let QueueItem::Move(planned) = item {
                planned.tag = None;
            }
        }
        self.handed_over = passed;
        if self.handover == Handover::TakingBack && passed == 0 {
            self.handover = Handover::Feeding;
        }
        plant.axes.planner.resume();
    }
}
