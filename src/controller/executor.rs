//! Executes a run. Each tick: actions at the front of the queue, moves to the planner, blocks from the interpreter.
//! Source: spec B3, B5, K3.14.

use std::sync::Arc;

use super::acts::Did;
use super::planned::{Forbidden, Planned};
use super::run::{Act, Doing, Item, MOST_ITEMS, Origin, Proving, Reading, Run, Speed};
use super::system::{RunWorld, nc_settings};
use super::{Controller, Event, Phase};
use crate::defs::alarm;
use crate::defs::param;
use crate::defs::text::Said;
use crate::motion::{Move, Override};
use crate::nc::{self, CheckWorld, Modals, Next, Proved, Source};
use crate::units::{Axis, PerAxis};

/// Maximum blocks read per tick.
const BLOCKS_PER_TICK: usize = 16;
/// Maximum actions executed per tick.
const ACTS_PER_TICK: usize = 64;

impl Controller {
    /// Opens a run of the text and starts it.
    pub(super) fn open_run(&mut self, source: Arc<Source>, origin: Origin) {
        let settings = nc_settings(self.kind, &self.params);
        let numbered = settings.numbered && origin != Origin::Mdi;
        let settings = nc::Settings { axes: self.axes.fitted(), numbered, ..settings };
        // A program starts from the power-on modal state; MDI continues from its last line.
        self.forget_note(origin == Origin::Mdi);
        let kept = self.mdi_modals.take().filter(|_| origin == Origin::Mdi);
        let modals = kept.unwrap_or_else(|| Modals::new(&settings));
        let before = (self.frames.clone(), self.lathe.start);
        self.frames.activate(modals.frame);
        if settings.zero_at_start {
            self.begin_turning(origin == Origin::Program);
        }
        if settings.zero_at_start && origin == Origin::Program {
            // L3: at program start, work zero, reference point and start point coincide.
            self.frames.preset(self.axes.set(), &PerAxis([Some(0.0), None, Some(0.0)]));
        }
        let mut planned = Planned::new(self.frames.clone(), self.axes.set(), self.dress.points, modals.path);
        planned.oscillating = self.oscillating_axis();
        planned.bounded = self.axes.all_homed();
        planned.homed = planned.bounded || self.row.starts_unhomed();
        planned.system = self.row.system;
        let start = (self.memory.clone(), planned);
        let library = Arc::clone(&self.programs);
        let proof = (origin == Origin::Program).then(|| self.proof(&source, &settings)).flatten();
        let mut run = Run::new(source, library, (settings, modals), start, self.now);
        run.origin = origin;
        run.proving = proof.map(|proof| Box::new(Proving { proof, told: false, before }));
        // The planner keeps the tag of the last finished move across runs.
        run.next_tag = self.axes.path.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(Box::new(run));
        self.happen(Event::Start);
    }

    /// One tick of the run.
    pub(super) fn step_run(&mut self) {
        let Some(mut run) = self.run.take() else { return };
        let paused = self.phase.is_pause();
        let homing = run.doing == Doing::Homing;
        if matches!(self.phase, Phase::Running) && !homing && !self.join_axes(&mut run) {
            self.run = Some(run);
            return;
        }
        self.stretch_dwell(&mut run);
        self.stretch_waiting_dwell();
        if matches!(self.phase, Phase::Holding | Phase::Held) {
            self.latch_in_pause(&mut run);
        }
        self.retire(&mut run);
        let mut close = false;
        if matches!(self.phase, Phase::Running) {
            close = self.carry_out(&mut run);
        }
        if run.splitting && matches!(self.phase, Phase::Running) {
            self.take_back_moves(&mut run);
        } else if matches!(self.phase, Phase::Running) && !close && self.is_proved(&mut run) {
            self.feed(&mut run);
            self.read_ahead(&mut run);
            self.feed(&mut run);
        }
        let origin = run.origin;
        self.run = Some(run);
        // The program stopped itself (M00) while the run was taken out of `self`.
        if self.phase.is_pause() && !paused {
            self.remember_what_turns();
        }
        match (close, origin) {
            (false, _) => {}
            (true, Origin::Retract) => self.finish_retract(),
            (true, Origin::Program | Origin::Mdi) => {
                self.close_run();
                self.happen(Event::Finish);
                if origin == Origin::Program {
                    self.begin_again();
                }
            }
        }
    }

    /// Extends a dwell by the time in which the program is held or returns from a hold.
    fn stretch_dwell(&self, run: &mut Run) {
        if let Doing::Dwell { until } = &mut run.doing
            && (!matches!(self.phase, Phase::Running) || matches!(run.items.front(), Some(Item::Move(_))))
        {
            *until = *until + self.tick;
        }
    }

    /// Extends a dwell while the one-key retract has suspended the program.
    fn stretch_waiting_dwell(&mut self) {
        let tick = self.tick;
        if let Some(Doing::Dwell { until }) = self.retract.waiting_run().map(|run| &mut run.doing) {
            *until = *until + tick;
        }
    }

    /// Removes finished moves from the queue.
    fn retire(&mut self, run: &mut Run) {
        let finished = self.axes.path.finished_tag();
        while run.fed > 0 {
            match run.items.front() {
                Some(Item::Move(planned)) if planned.tag.is_some() && planned.tag <= finished => {}
                Some(Item::Move(_) | Item::Begin(_) | Item::Do(_) | Item::End) | None => break,
            }
            run.items.pop_front();
            run.fed -= 1;
        }
    }

    /// Executes the items at the front of the queue. True when the run is over.
    fn carry_out(&mut self, run: &mut Run) -> bool {
        for _ in 0..ACTS_PER_TICK {
            self.retire(run);
            let did =
                match run.items.front() {
                    None | Some(Item::Move(_)) => return false,
                    Some(Item::Begin(place)) => {
                        self.place = *place;
                        self.blocks += 1;
                        Did::Done
                    }
                    // While splitting, a block ends without a stop if its successor is already moving.
                    Some(Item::End)
                        if self.switches.single_block && run.origin == Origin::Program && !run.splitting =>
                    {
                        if self.is_settled(run) == Some(true) { Did::Stop } else { Did::Wait }
                    }
                    Some(Item::End) => Did::Done,
                    Some(Item::Do(_)) => {
                        let Some(Item::Do(act)) = run.items.pop_front() else { return false };
                        let did = self.act(run, &act);
                        run.items.push_front(Item::Do(act));
                        did
                    }
                };
            match did {
                Did::Wait => return false,
                Did::Close => return true,
                Did::Done | Did::Stop => {
                    run.items.pop_front();
                    run.fed = run.fed.saturating_sub(1);
                    // A block that ends with its own stop (M00) does not stop a second time in single block.
                    if matches!((&did, run.items.front()), (Did::Stop, Some(Item::End))) {
                        run.items.pop_front();
                        run.fed = run.fed.saturating_sub(1);
                    }
                    run.doing = Doing::Nothing;
                    run.settle_since = None;
                }
            }
            if matches!(did, Did::Stop) {
                self.happen(Event::Stop);
                return false;
            }
            if !matches!(self.phase, Phase::Running) {
                return false;
            }
        }
        false
    }

    /// Hands moves to the planner, up to the first action that must be executed before them.
    fn feed(&mut self, run: &mut Run) {
        while let Some(item) = run.items.get_mut(run.fed) {
            match item {
                Item::Move(planned) => {
                    if self.axes.path.room() == 0 {
                        return;
                    }
                    let dry = self.switches.dry_run && planned.speed != Speed::Rapid;
                    let speed =
                        if dry { Speed::PerMinute(self.params.get(param::DRY_RUN_FEED)) } else { planned.speed };
                    let Some(rate) = speed.rate(self.drive_rpm(), self.params.get(param::FEED_MAX)) else {
                        // Alarm only at the front of the queue: an earlier item may still start the drive.
                        if run.fed == 0 {
                            self.no_drive();
                        }
                        return;
                    };
                    let tag = run.next_tag;
                    let pushed = Move { to: planned.to, shape: planned.shape, rate, end: planned.end, tag };
                    if self.axes.path.push(pushed).is_err() {
                        return;
                    }
                    planned.tag = Some(tag);
                    run.next_tag += 1;
                }
                Item::End if self.switches.single_block && run.origin == Origin::Program => return,
                Item::Do(Act::Set(..) | Act::Note(_) | Act::Frames(_) | Act::Wheel(..) | Act::SpeedLimit(_))
                | Item::Begin(_)
                | Item::End => {}
                Item::Do(
                    Act::SetSystem(..)
                    | Act::Preset(_)
                    | Act::Machine(..)
                    | Act::Gauge(_)
                    | Act::Oscillate(_)
                    | Act::Cylinder(_)
                    | Act::Thread(_)
                    | Act::Home(_)
                    | Act::Post(_)
                    | Act::Dwell(_)
                    | Act::Skip(..)
                    | Act::Alarm(..)
                    | Act::Message(_)
                    | Act::Finish,
                ) => return,
            }
            run.fed += 1;
        }
    }

    /// A preflight of a program from the present state, if its dialect supports it.
    pub(super) fn proof(&self, source: &Arc<Source>, settings: &nc::Settings) -> Option<nc::Proof> {
        let library: Arc<dyn nc::Library + Send + Sync> = Arc::clone(&self.programs) as _;
        let world = CheckWorld::new(settings)
            .with_references(super::references(&self.params))
            .with_frames(self.frames.clone())
            .at(self.frames.work_from_machine(self.axes.set()))
            .with_block_skip(self.switches.block_skip);
        nc::Proof::new(source, &library, settings, world)
    }

    /// Whether the preflight is over. A program error found by it becomes an alarm and the state before is restored.
    fn is_proved(&mut self, run: &mut Run) -> bool {
        let Some(proving) = &mut run.proving else { return true };
        match proving.proof.advance() {
            Proved::Busy => {
                if !std::mem::replace(&mut proving.told, true) {
                    self.say(Said::new("正在检查程序…", "looking through the program …"));
                }
                return false;
            }
            Proved::Clean => {}
            Proved::Wrong(fault) => {
                (self.frames, self.lathe.start) = proving.before.clone();
                run.items.clear();
                run.fed = 0;
                run.end_by(&fault);
            }
        }
        run.proving = None;
        true
    }

    fn read_ahead(&mut self, run: &mut Run) {
        if run.reading == Reading::Barrier && run.items.is_empty() {
            run.reading = Reading::Open;
        }
        for _ in 0..BLOCKS_PER_TICK {
            if run.reading != Reading::Open || run.items.len() >= MOST_ITEMS {
                return;
            }
            let drained = run.items.is_empty() && self.axes.is_at_rest() && self.axes.is_in_position(&self.params);
            let mut world = RunWorld::new(self, &run.planned, drained);
            match run.interpreter.next(&mut world, &mut run.block) {
                Ok(Next::Block) => {
                    if let Err(forbidden) = run.take_block(&self.params) {
                        run.reading = Reading::Over;
                        return self.forbid(run, &forbidden);
                    }
                }
                Ok(Next::Drain | Next::Busy) => return,
                Ok(Next::End) => {
                    run.items.push_back(Item::Do(Act::Finish));
                    run.reading = Reading::Over;
                }
                Err(fault) => run.end_by(&fault),
            }
        }
    }

    /// Refuses a block: nothing of it is executed; its alarm is raised when all blocks before it are done.
    fn forbid(&self, run: &mut Run, forbidden: &Forbidden) {
        let at = run.block.at;
        let (title, line) = (self.title(at.program), at.line);
        let place = Said::new(format!("{title} 第{line}行"), format!("{title} line {line}"));
        let number = match forbidden {
            Forbidden::SoftLimit(..) => alarm::SOFT_LIMIT,
            Forbidden::NotHomed => alarm::NOT_HOMED,
            Forbidden::Oscillating(_) => alarm::OSCILLATING_AXIS,
            Forbidden::NoStroke(_) => alarm::OSCILLATION,
            Forbidden::Wear(..) => alarm::OFFSET_RANGE,
            Forbidden::NoDressPoint(_) => alarm::NO_DRESS_POINT,
            Forbidden::NotYet(_) => alarm::M_NOT_YET,
        };
        let cause = self.forbidden(forbidden);
        let said = Said::new(format!("{} {}", place.zh, cause.zh), format!("{} {}", place.en, cause.en));
        run.items.push_back(Item::Do(Act::Alarm(number, said, at)));
    }

    /// The text of a refusal.
    pub(super) fn forbidden(&self, forbidden: &Forbidden) -> Said {
        match *forbidden {
            Forbidden::SoftLimit(axis, to, limit) => {
                let factor = self.displayed_per_mm(axis);
                let (to, limit) = (to * factor, limit * factor);
                Said::new(
                    format!("{axis} 目标 {to:.3} 超出软限位 {limit:.3} (机床坐标)"),
                    format!("{axis} target {to:.3} is beyond the limit {limit:.3} (machine)"),
                )
            }
            Forbidden::NotHomed => Said::new("先回零", "home the axes first"),
            Forbidden::Oscillating(axis) => Said::new(
                format!("{axis} 轴在振荡中，先用 G36 关闭"),
                format!("{axis} oscillates: end it with G36 first"),
            ),
            Forbidden::NoStroke(axis) => Said::new(
                format!("{axis} 轴没有振荡行程，或未回零"),
                format!("{axis} has no stroke to oscillate, or is not homed"),
            ),
            Forbidden::Wear(axis, sum) => {
                let sum = sum * self.displayed_per_mm(axis);
                Said::new(format!("{axis} 磨耗 {sum:.3}"), format!("wear of {axis} {sum:.3}"))
            }
            Forbidden::NoDressPoint(axis) => {
                Said::new(format!("{axis} 轴没有设置修整点"), format!("{axis} has no dressing point"))
            }
            Forbidden::NotYet(code) => Said::new(
                format!("M{code:02} 在本版本中还没有"),
                format!("M{code:02} is not available in this version"),
            ),
        }
    }

    /// The overrides as factors for this tick.
    pub(super) fn rate(&self) -> Override {
        let rapid = match self.overrides.rapid {
            0 => self.params.get(param::RAPID_F0) / self.params.get(param::RAPID_X),
            percent => f64::from(percent) / 100.0,
        };
        Override { feed: f64::from(self.overrides.feed) / 100.0, rapid: rapid.min(1.0) }
    }

    /// Once the axes are at rest, takes the unfinished moves back from the planner, to hand them over block by block.
    pub(super) fn take_back_moves(&mut self, run: &mut Run) {
        if !self.axes.path.is_at_rest() {
            return;
        }
        let mut taken = Vec::new();
        self.axes.path.drain_unfinished(&mut taken);
        for item in &mut run.items {
            if let Item::Move(planned) = item {
                planned.tag = None;
            }
        }
        run.fed = 0;
        run.splitting = false;
        self.axes.path.resume();
    }

    /// Distance to go of the present block, mm displayed.
    pub(super) fn distance_to_go(&self) -> PerAxis<f64> {
        let way = if self.run.is_some() { self.axes.path.distance_to_go() } else { PerAxis::default() };
        PerAxis::from_fn(|axis: Axis| way[axis] * self.displayed_per_mm(axis))
    }

    /// Whether the run waits for an input (M80–M89).
    pub(super) fn is_waiting(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.doing, Doing::AwaitInput(_)))
    }
}
