//! Executes a run. Each tick: actions at the front of the queue, moves to the planner, blocks from the interpreter.
//! Source: spec B3, B5, K3.14.

use std::sync::Arc;

use super::actions::ActionStatus;
use super::lookahead_state::{LookaheadState, MoveRefusal};
use super::run::{
    Activity, MAX_ITEMS, Origin, PendingPreflight, ProgramRun, ProgrammedFeed, QueueItem, QueuedAction, ReadAheadStatus,
};
use super::system_variables::{RunWorld, nc_settings};
use super::{ControlEvent, ControlPhase, Controller};
use crate::defs::alarm;
use crate::defs::param;
use crate::defs::text::LocalizedText;
use crate::motion::{Move, Override};
use crate::nc::{self, ModalState, NextStatus, OfflineMachine, PreflightStatus, Source};
use crate::units::{Axis, PerAxis};

/// Maximum blocks read per tick.
const BLOCKS_PER_TICK: usize = 16;
/// Maximum actions executed per tick.
const ACTIONS_PER_TICK: usize = 64;

impl Controller {
    /// Opens a run of the text and starts it.
    pub(super) fn open_run(&mut self, source: Arc<Source>, origin: Origin) {
        let settings = nc_settings(self.kind, &self.params);
        let numbered = settings.needs_block_numbers && origin != Origin::Mdi;
        let settings = nc::NcSettings { axes: self.axes.fitted(), needs_block_numbers: numbered, ..settings };
        // A program starts from the power-on modal state; MDI continues from its last line.
        self.clear_program_message(origin == Origin::Mdi);
        let kept = self.mdi_modals.take().filter(|_| origin == Origin::Mdi);
        let modals = kept.unwrap_or_else(|| ModalState::new(&settings));
        let before = (self.work_offsets.clone(), self.lathe.tool_change_point);
        self.work_offsets.activate(modals.work_offset);
        if settings.start_is_work_zero {
            self.start_lathe_program(origin == Origin::Program);
        }
        if settings.start_is_work_zero && origin == Origin::Program {
            // L3: at program start, work zero, reference point and start point coincide.
            self.work_offsets.set_coordinates(self.axes.set_point(), &PerAxis([Some(0.0), None, Some(0.0)]));
        }
        let mut planned = LookaheadState::new(
            self.work_offsets.clone(),
            self.axes.set_point(),
            self.dressing.points,
            modals.path_mode,
        );
        planned.oscillating = self.oscillating_axis();
        planned.soft_limits_active = self.axes.all_homed();
        planned.homed = planned.soft_limits_active || self.kind_row.may_start_unhomed();
        planned.dialect = self.kind_row.dialect;
        let start = (self.memory.clone(), planned);
        let library = Arc::clone(&self.programs);
        let proof = (origin == Origin::Program).then(|| self.new_preflight(&source, &settings)).flatten();
        let mut run = ProgramRun::new(source, library, (settings, modals), start, self.now);
        run.origin = origin;
        run.preflight = proof.map(|proof| Box::new(PendingPreflight { preflight: proof, announced: false, before }));
        // The planner keeps the tag of the last finished move across runs.
        run.next_tag = self.axes.planner.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(Box::new(run));
        self.transition(ControlEvent::Start);
    }

    /// One tick of the run.
    pub(super) fn step_run(&mut self) {
        let Some(mut run) = self.run.take() else { return };
        let paused = self.phase.is_pause();
        let homing = run.activity == Activity::Homing;
        if matches!(self.phase, ControlPhase::Running) && !homing && !self.return_axes_to_run(&mut run) {
            self.run = Some(run);
            return;
        }
        self.extend_dwell(&mut run);
        self.extend_suspended_dwell();
        if matches!(self.phase, ControlPhase::Holding | ControlPhase::Held) {
            self.latch_in_pause(&mut run);
        }
        self.drop_finished_moves(&mut run);
        let mut close = false;
        if matches!(self.phase, ControlPhase::Running) {
            close = self.execute_front(&mut run);
        }
        if run.splitting && matches!(self.phase, ControlPhase::Running) {
            self.take_back_moves(&mut run);
        } else if matches!(self.phase, ControlPhase::Running) && !close && self.preflight_passed(&mut run) {
            self.feed_planner(&mut run);
            self.read_ahead(&mut run);
            self.feed_planner(&mut run);
        }
        let origin = run.origin;
        self.run = Some(run);
        // The program stopped itself (M00) while the run was taken out of `self`.
        if self.phase.is_pause() && !paused {
            self.record_running_spindles();
        }
        match (close, origin) {
            (false, _) => {}
            (true, Origin::Retract) => self.finish_retract(),
            (true, Origin::Program | Origin::Mdi) => {
                self.close_run();
                self.transition(ControlEvent::Finish);
                if origin == Origin::Program {
                    self.repeat_program();
                }
            }
        }
    }

    /// Extends a dwell by the time in which the program is held or returns from a hold.
    fn extend_dwell(&self, run: &mut ProgramRun) {
        if let Activity::Dwell { until } = &mut run.activity
            && (!matches!(self.phase, ControlPhase::Running) || matches!(run.queue.front(), Some(QueueItem::Move(_))))
        {
            *until = *until + self.tick_time;
        }
    }

    /// Extends a dwell while the one-key retract has suspended the program.
    fn extend_suspended_dwell(&mut self) {
        let tick = self.tick_time;
        if let Some(Activity::Dwell { until }) = self.retract.suspended_run().map(|run| &mut run.activity) {
            *until = *until + tick;
        }
    }

    /// Removes finished moves from the queue.
    fn drop_finished_moves(&mut self, run: &mut ProgramRun) {
        let finished = self.axes.planner.finished_tag();
        while run.handed_over > 0 {
            match run.queue.front() {
                Some(QueueItem::Move(planned)) if planned.tag.is_some() && planned.tag <= finished => {}
                Some(QueueItem::Move(_) | QueueItem::BlockStart(_) | QueueItem::Action(_) | QueueItem::BlockEnd)
                | None => break,
            }
            run.queue.pop_front();
            run.handed_over -= 1;
        }
    }

    /// Executes the items at the front of the queue. True when the run is over.
    fn execute_front(&mut self, run: &mut ProgramRun) -> bool {
        for _ in 0..ACTIONS_PER_TICK {
            self.drop_finished_moves(run);
            let did = match run.queue.front() {
                None | Some(QueueItem::Move(_)) => return false,
                Some(QueueItem::BlockStart(place)) => {
                    self.current_block = *place;
                    self.block_count += 1;
                    ActionStatus::Done
                }
                // While splitting, a block ends without a stop if its successor is already moving.
                Some(QueueItem::BlockEnd)
                    if self.switches.single_block && run.origin == Origin::Program && !run.splitting =>
                {
                    if self.is_settled(run) == Some(true) { ActionStatus::Stop } else { ActionStatus::Wait }
                }
                Some(QueueItem::BlockEnd) => ActionStatus::Done,
                Some(QueueItem::Action(_)) => {
                    let Some(QueueItem::Action(act)) = run.queue.pop_front() else { return false };
                    let did = self.execute_action(run, &act);
                    run.queue.push_front(QueueItem::Action(act));
                    did
                }
            };
            match did {
                ActionStatus::Wait => return false,
                ActionStatus::EndRun => return true,
                ActionStatus::Done | ActionStatus::Stop => {
                    run.queue.pop_front();
                    run.handed_over = run.handed_over.saturating_sub(1);
                    // A block that ends with its own stop (M00) does not stop a second time in single block.
                    if matches!((&did, run.queue.front()), (ActionStatus::Stop, Some(QueueItem::BlockEnd))) {
                        run.queue.pop_front();
                        run.handed_over = run.handed_over.saturating_sub(1);
                    }
                    run.activity = Activity::Idle;
                    run.settling_since = None;
                }
            }
            if matches!(did, ActionStatus::Stop) {
                self.transition(ControlEvent::Stop);
                return false;
            }
            if !matches!(self.phase, ControlPhase::Running) {
                return false;
            }
        }
        false
    }

    /// Hands moves to the planner, up to the first action that must be executed before them.
    fn feed_planner(&mut self, run: &mut ProgramRun) {
        while let Some(item) = run.queue.get_mut(run.handed_over) {
            match item {
                QueueItem::Move(planned) => {
                    if self.axes.planner.free_slots() == 0 {
                        return;
                    }
                    let dry = self.switches.dry_run && planned.speed != ProgrammedFeed::Rapid;
                    let speed = if dry {
                        ProgrammedFeed::PerMinute(self.params.get(param::DRY_RUN_FEED))
                    } else {
                        planned.speed
                    };
                    let Some(rate) = speed.rate(self.workpiece_rpm(), self.params.get(param::FEED_MAX)) else {
                        // Alarm only at the front of the queue: an earlier item may still start the drive.
                        if run.handed_over == 0 {
                            self.raise_no_workpiece_drive();
                        }
                        return;
                    };
                    let tag = run.next_tag;
                    let pushed = Move { to: planned.to, shape: planned.shape, speed: rate, corner: planned.end, tag };
                    if self.axes.planner.push(pushed).is_err() {
                        return;
                    }
                    planned.tag = Some(tag);
                    run.next_tag += 1;
                }
                QueueItem::BlockEnd if self.switches.single_block && run.origin == Origin::Program => return,
                QueueItem::Action(
                    QueuedAction::SetVariable(..)
                    | QueuedAction::Note(_)
                    | QueuedAction::SetWorkOffsets(_)
                    | QueuedAction::WheelSpeed(..)
                    | QueuedAction::WheelSpeedLimit(_),
                )
                | QueueItem::BlockStart(_)
                | QueueItem::BlockEnd => {}
                QueueItem::Action(
                    QueuedAction::SetSystemVariable(..)
                    | QueuedAction::SetCoordinateSystem(_)
                    | QueuedAction::MCode(..)
                    | QueuedAction::Gauge(_)
                    | QueuedAction::Oscillate(_)
                    | QueuedAction::Cylinder(_)
                    | QueuedAction::Thread(_)
                    | QueuedAction::Home(_)
                    | QueuedAction::IndexTurret(_)
                    | QueuedAction::Dwell(_)
                    | QueuedAction::Skip(..)
                    | QueuedAction::Alarm(..)
                    | QueuedAction::Message(_)
                    | QueuedAction::EndOfText,
                ) => return,
            }
            run.handed_over += 1;
        }
    }

    /// A preflight of a program from the present state, if its dialect supports it.
    pub(super) fn new_preflight(
        &self,
        source: &Arc<Source>,
        settings: &nc::NcSettings,
    ) -> Option<nc::ProgramPreflight> {
        let library: Arc<dyn nc::Library + Send + Sync> = Arc::clone(&self.programs) as _;
        let world = OfflineMachine::new(settings)
            .with_references(super::reference_points(&self.params))
            .with_work_offsets(self.work_offsets.clone())
            .with_position(self.work_offsets.work_from_machine(self.axes.set_point()))
            .with_block_skip(self.switches.block_skip);
        nc::ProgramPreflight::new(source, &library, settings, world)
    }

    /// Whether the preflight is over. A program error found by it becomes an alarm and the state before is restored.
    fn preflight_passed(&mut self, run: &mut ProgramRun) -> bool {
        let Some(proving) = &mut run.preflight else { return true };
        match proving.preflight.advance() {
            PreflightStatus::Busy => {
                if !std::mem::replace(&mut proving.announced, true) {
                    self.show_note(LocalizedText::new("正在检查程序…", "looking through the program …"));
                }
                return false;
            }
            PreflightStatus::Passed => {}
            PreflightStatus::Failed(fault) => {
                (self.work_offsets, self.lathe.tool_change_point) = proving.before.clone();
                run.queue.clear();
                run.handed_over = 0;
                run.end_with_fault(&fault);
            }
        }
        run.preflight = None;
        true
    }

    fn read_ahead(&mut self, run: &mut ProgramRun) {
        if run.read_ahead == ReadAheadStatus::Barrier && run.queue.is_empty() {
            run.read_ahead = ReadAheadStatus::Open;
        }
        for _ in 0..BLOCKS_PER_TICK {
            if run.read_ahead != ReadAheadStatus::Open || run.queue.len() >= MAX_ITEMS {
                return;
            }
            let drained = run.queue.is_empty() && self.axes.is_at_rest() && self.axes.is_in_position(&self.params);
            let mut world = RunWorld::new(self, &run.lookahead, drained);
            match run.interpreter.next(&mut world, &mut run.block) {
                Ok(NextStatus::Block) => {
                    if let Err(forbidden) = run.queue_block(&self.params) {
                        run.read_ahead = ReadAheadStatus::Finished;
                        return self.queue_refusal_alarm(run, &forbidden);
                    }
                }
                Ok(NextStatus::Drain | NextStatus::Busy) => return,
                Ok(NextStatus::End) => {
                    run.queue.push_back(QueueItem::Action(QueuedAction::EndOfText));
                    run.read_ahead = ReadAheadStatus::Finished;
                }
                Err(fault) => run.end_with_fault(&fault),
            }
        }
    }

    /// Refuses a block: nothing of it is executed; its alarm is raised when all blocks before it are done.
    fn queue_refusal_alarm(&self, run: &mut ProgramRun, forbidden: &MoveRefusal) {
        let at = run.block.location;
        let (title, line) = (self.program_title(at.program), at.line);
        let place = LocalizedText::new(format!("{title} 第{line}行"), format!("{title} line {line}"));
        let number = match forbidden {
            MoveRefusal::SoftLimit(..) => alarm::SOFT_LIMIT,
            MoveRefusal::NotHomed => alarm::NOT_HOMED,
            MoveRefusal::Oscillating(_) => alarm::AXIS_OSCILLATES,
            MoveRefusal::NoStroke(_) => alarm::OSCILLATION_REFUSED,
            MoveRefusal::WearOutOfRange(..) => alarm::OFFSET_RANGE,
            MoveRefusal::NoDressPoint(_) => alarm::NO_DRESSING_POINT,
            MoveRefusal::Unsupported(_) => alarm::M_CODE_NOT_AVAILABLE,
        };
        let cause = self.refusal_text(forbidden);
        let said = LocalizedText::new(format!("{} {}", place.zh, cause.zh), format!("{} {}", place.en, cause.en));
        run.queue.push_back(QueueItem::Action(QueuedAction::Alarm(number, said, at)));
    }

    /// The text of a refusal.
    pub(super) fn refusal_text(&self, forbidden: &MoveRefusal) -> LocalizedText {
        match *forbidden {
            MoveRefusal::SoftLimit(axis, to, limit) => {
                let factor = self.displayed_per_mm(axis);
                let (to, limit) = (to * factor, limit * factor);
                LocalizedText::new(
                    format!("{axis} 目标 {to:.3} 超出软限位 {limit:.3} (机床坐标)"),
                    format!("{axis} target {to:.3} is beyond the limit {limit:.3} (machine)"),
                )
            }
            MoveRefusal::NotHomed => LocalizedText::new("先回零", "home the axes first"),
            MoveRefusal::Oscillating(axis) => LocalizedText::new(
                format!("{axis} 轴在振荡中，先用 G36 关闭"),
                format!("{axis} oscillates: end it with G36 first"),
            ),
            MoveRefusal::NoStroke(axis) => LocalizedText::new(
                format!("{axis} 轴没有振荡行程，或未回零"),
                format!("{axis} has no stroke to oscillate, or is not homed"),
            ),
            MoveRefusal::WearOutOfRange(axis, sum) => {
                let sum = sum * self.displayed_per_mm(axis);
                LocalizedText::new(format!("{axis} 磨耗 {sum:.3}"), format!("wear of {axis} {sum:.3}"))
            }
            MoveRefusal::NoDressPoint(axis) => {
                LocalizedText::new(format!("{axis} 轴没有设置修整点"), format!("{axis} has no dressing point"))
            }
            MoveRefusal::Unsupported(code) => LocalizedText::new(
                format!("M{code:02} 在本版本中还没有"),
                format!("M{code:02} is not available in this version"),
            ),
        }
    }

    /// The overrides as factors for this tick.
    pub(super) fn override_factors(&self) -> Override {
        let rapid = match self.overrides.rapid {
            0 => self.params.get(param::RAPID_F0) / self.params.get(param::RAPID_X),
            percent => f64::from(percent) / 100.0,
        };
        Override { feed: f64::from(self.overrides.feed) / 100.0, rapid: rapid.min(1.0) }
    }

    /// Once the axes are at rest, takes the unfinished moves back from the planner, to hand them over block by block.
    pub(super) fn take_back_moves(&mut self, run: &mut ProgramRun) {
        if !self.axes.planner.is_at_rest() {
            return;
        }
        let mut taken = Vec::new();
        self.axes.planner.drain_unfinished(&mut taken);
        for item in &mut run.queue {
            if let QueueItem::Move(planned) = item {
                planned.tag = None;
            }
        }
        run.handed_over = 0;
        run.splitting = false;
        self.axes.planner.resume();
    }

    /// Distance to go of the present block, mm displayed.
    pub(super) fn distance_to_go(&self) -> PerAxis<f64> {
        let way = if self.run.is_some() { self.axes.planner.distance_to_go() } else { PerAxis::default() };
        PerAxis::from_fn(|axis: Axis| way[axis] * self.displayed_per_mm(axis))
    }

    /// Whether the run waits for an input (M80–M89).
    pub(super) fn is_awaiting_input(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.activity, Activity::AwaitInput(_)))
    }
}
