//! Executing a run: acts at the front, moves to the path planner, blocks from the reader – in this order each tick.
//! Source: spec B3, B5, K3.14.

use std::sync::Arc;

use super::axes::MINUTE;
use super::gauge::SIGNALS;
use super::oscillation::Stroke;
use super::run::{Act, Doing, Forbidden, Item, MCall, MOST_ITEMS, Planned, PlannedMove, Reading, Run, Speed};
use super::system::{RunWorld, nc_settings};
use super::{Controller, Effect, Event, Phase, Switches};
use crate::defs::alarm;
use crate::defs::mcode::{Action, Request};
use crate::defs::param;
use crate::defs::signal::{Input, Output};
use crate::defs::text::{Lang, Said};
use crate::machine::Answer;
use crate::motion::{End, Move, Override};
use crate::nc::{self, Memory, Modals, Next, Source, SpeedMode, VariableError};
use crate::units::{Axis, Micros, PerAxis};

/// Most blocks read in a tick.
const BLOCKS_PER_TICK: usize = 16;
/// Most acts carried out in a tick.
const ACTS_PER_TICK: usize = 64;

/// What an act has come to.
pub(super) enum Did {
    Done,
    /// Not yet; ask again next tick.
    Wait,
    /// Done; the run stands until cycle start.
    Stop,
    /// The run is over.
    Close,
}

impl Controller {
    /// Opens a run of the text and starts it.
    pub(super) fn open_run(&mut self, source: Arc<Source>, mdi: bool) {
        let settings = nc::Settings { axes: self.axes.fitted(), ..nc_settings(self.kind, &self.params) };
        // A program begins from the power-on state of the codes; MDI goes on from its last line.
        self.forget_note(mdi);
        let kept = self.mdi_modals.take().filter(|_| mdi);
        let modals = kept.unwrap_or_else(|| Modals::new(&settings));
        self.frames.activate(modals.frame);
        let mut planned = Planned::new(self.frames.clone(), self.axes.set(), self.dress.points, modals.path);
        planned.oscillating = self.oscillating_axis();
        planned.homed = self.axes.all_homed();
        let start = (self.memory.clone(), planned);
        let library = Arc::clone(&self.programs);
        let mut run = Run::new(source, library, (settings, modals), start, self.now);
        run.mdi = mdi;
        // The planner remembers what it has finished, runs gone by included.
        run.next_tag = self.axes.path.finished_tag().map_or(1, |tag| tag + 1);
        self.run = Some(Box::new(run));
        self.happen(Event::Start);
    }

    /// One tick of the run.
    pub(super) fn step_run(&mut self) {
        let Some(mut run) = self.run.take() else { return };
        if matches!(self.phase, Phase::Running) && !self.join_axes(&mut run) {
            self.run = Some(run);
            return;
        }
        self.stretch_dwell(&mut run);
        self.retire(&mut run);
        let mut close = false;
        if matches!(self.phase, Phase::Running) {
            close = self.carry_out(&mut run);
        }
        if run.splitting && matches!(self.phase, Phase::Running) {
            self.take_back_moves(&mut run);
        } else if matches!(self.phase, Phase::Running) && !close {
            self.feed(&mut run);
            self.read_ahead(&mut run);
            self.feed(&mut run);
        }
        self.run = Some(run);
        if close {
            self.close_run();
            self.happen(Event::Finish);
        }
    }

    /// A dwell does not run on while the program is held, or comes back from a hold.
    fn stretch_dwell(&self, run: &mut Run) {
        if let Doing::Dwell { until } = &mut run.doing
            && (!matches!(self.phase, Phase::Running) || matches!(run.items.front(), Some(Item::Move(_))))
        {
            *until = *until + self.tick;
        }
    }

    /// Forgets the moves that are finished.
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

    /// Carries out what stands at the front; true when the run is over.
    fn carry_out(&mut self, run: &mut Run) -> bool {
        for _ in 0..ACTS_PER_TICK {
            self.retire(run);
            let did = match run.items.front() {
                None | Some(Item::Move(_)) => return false,
                Some(Item::Begin(place)) => {
                    self.place = *place;
                    self.blocks += 1;
                    Did::Done
                }
                // While splitting, a block whose successor is under way is over without a stop.
                Some(Item::End) if self.switches.single_block && !run.mdi && !run.splitting => {
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

    fn act(&mut self, run: &mut Run, act: &Act) -> Did {
        match act {
            Act::Set(variable, value) => {
                // The reader has checked number and value; it refuses what this would.
                let _ = self.store_variable(*variable, *value);
                Did::Done
            }
            Act::SetSystem(number, value) => {
                self.write_system(*number, *value);
                Did::Done
            }
            Act::Preset(values) => self.preset(run, values),
            Act::Frames(frames) => {
                self.put_frames(frames);
                Did::Done
            }
            Act::Machine(call) => self.m_code(run, *call),
            Act::Gauge(asked) => self.gauge(run, asked),
            Act::Oscillate(stroke) => self.oscillate(run, *stroke),
            Act::Cylinder(on) => self.cylinder(*on),
            Act::Dwell(seconds) => self.dwell(run, *seconds),
            Act::Wheel(..) if self.switches.mst_lock => Did::Done,
            Act::Wheel(value, mode) => {
                self.set_wheel_speed(*value, *mode);
                Did::Done
            }
            Act::Skip(planned, signal) => self.skip(run, planned, *signal),
            Act::Alarm(number, text, place) => {
                self.place = *place;
                self.raise(*number, Some(text.clone()));
                Did::Wait
            }
            Act::Note(text) => self.tell_note(text),
            Act::Message(text) => match self.is_settled(run) {
                Some(true) => {
                    self.say(text.clone());
                    Did::Stop
                }
                _ => Did::Wait,
            },
            Act::Finish => match self.is_settled(run) {
                Some(true) => Did::Close,
                _ => Did::Wait,
            },
        }
    }

    fn oscillate(&mut self, run: &mut Run, stroke: Stroke) -> Did {
        match self.is_settled(run) {
            Some(true) => {
                self.begin_oscillation(stroke);
                Did::Done
            }
            Some(false) | None => Did::Wait,
        }
    }

    /// G35 with a cylinder, and G36: the stroke ends at its starting end, then the next block runs (K4.3).
    fn cylinder(&mut self, on: bool) -> Did {
        let done = if on {
            matches!(self.ask(Request::CylinderOn), Answer::Taken | Answer::NoEffect(_))
        } else {
            self.axes.is_at_rest() && self.end_oscillation()
        };
        if done { Did::Done } else { Did::Wait }
    }

    /// G50: what the present position is called, once the machine stands there.
    fn preset(&mut self, run: &mut Run, values: &PerAxis<Option<f64>>) -> Did {
        match self.is_settled(run) {
            Some(true) => {
                let mut frames = self.frames.clone();
                frames.preset(self.axes.set(), values);
                self.put_frames(&frames);
                run.planned.frames = Arc::new(frames);
                Did::Done
            }
            Some(false) | None => Did::Wait,
        }
    }

    /// S: revolutions, or the speed of the wheel's rim by its diameter P77.
    fn set_wheel_speed(&mut self, value: f64, mode: SpeedMode) {
        let girth_m = std::f64::consts::PI * self.params.get(param::WHEEL_DIAMETER) / 1_000.0;
        self.wheel_rpm = match mode {
            SpeedMode::Rpm => value,
            SpeedMode::MetresPerSecond => value * MINUTE / girth_m,
            SpeedMode::SurfaceSpeed => value / girth_m,
        };
        if self.output_set.has(Output::Wheel) && self.wheel_rpm_given() < self.commanded_wheel_rpm() {
            self.refuse(Said::new(
                "S 超过砂轮额定线速度，按额定转速运行 (P77 P79)",
                "S exceeds the wheel's rating: it runs at the rating (P77, P79)",
            ));
        }
    }

    /// Whether all motion is over and the axes stand in position; `None` after the time-out, with the alarm raised.
    pub(super) fn is_settled(&mut self, run: &mut Run) -> Option<bool> {
        if !self.axes.is_at_rest() {
            return Some(false);
        }
        if self.axes.is_in_position(&self.params) {
            return Some(true);
        }
        let since = *run.settle_since.get_or_insert(self.now);
        if self.now.since(since) > Micros::from_millis_f64(self.params.get(param::DRAIN_TIME)) {
            self.raise(alarm::IN_POSITION_TIMEOUT, None);
            return None;
        }
        Some(false)
    }

    fn m_code(&mut self, run: &mut Run, call: MCall) -> Did {
        if let Some(request) = call.request() {
            return self.m_request(run, call, request);
        }
        match call.row.action {
            Action::OptionalStop if !self.switches.optional_stop => Did::Done,
            Action::Pause | Action::OptionalStop => match self.is_settled(run) {
                Some(true) => Did::Stop,
                Some(false) | None => Did::Wait,
            },
            Action::Count => {
                self.count_part();
                Did::Done
            }
            Action::End => match self.is_settled(run) {
                Some(true) => {
                    self.end_program(run.mdi);
                    Did::Close
                }
                Some(false) | None => Did::Wait,
            },
            Action::AwaitInput(_) if self.switches.mst_lock => Did::Done,
            Action::AwaitInput(input) => self.await_input(run, input),
            Action::Flow | Action::Ask(_) | Action::Port(_) | Action::Pulse => Did::Done,
        }
    }

    /// M30 (K3.14, K5.17).
    fn end_program(&mut self, mdi: bool) {
        self.machine.program_end(&self.params);
        if self.params.bit(param::COUNT_ON_M30) {
            self.count_part();
        }
        let Switches { machine_lock, mst_lock, dry_run, .. } = self.switches;
        let really = !mdi && !machine_lock && !mst_lock && !dry_run;
        if really && self.params.bit(param::WHEEL_UNDRESSED) && self.around().dressing {
            self.keep_param(param::WHEEL_UNDRESSED.address(), 0.0);
        }
    }

    fn m_request(&mut self, run: &mut Run, call: MCall, request: Request) -> Did {
        if run.doing == Doing::Settling {
            return if self.machine.is_settled(request) { Did::Done } else { Did::Wait };
        }
        if self.switches.mst_lock {
            return Did::Done;
        }
        let answer = self.ask(request);
        if let (Some(rpm), Answer::Taken, Request::DriveHigh | Request::DriveLow) = (call.s, answer, request) {
            self.analog_2_rpm = rpm; // K3.4: M63 S
        }
        match answer {
            Answer::Taken if call.row.waits => {
                run.doing = Doing::Settling;
                if self.machine.is_settled(request) { Did::Done } else { Did::Wait }
            }
            Answer::Taken | Answer::NoEffect(_) => Did::Done,
            // The block waits as in a feed hold; cycle start asks again.
            Answer::Denied(_) => {
                self.happen(Event::Hold);
                Did::Wait
            }
            Answer::Refused(..) => Did::Wait,
        }
    }

    fn await_input(&mut self, run: &mut Run, input: Input) -> Did {
        if self.inputs.has(input) {
            self.waiting_for = None;
            return Did::Done;
        }
        if run.doing == Doing::Nothing {
            let (name, port) = (input.name(), self.params.input_port(input));
            if port == 0 {
                self.raise(alarm::INPUT_MISSING, Some(name.into()));
                return Did::Wait;
            }
            run.doing = Doing::AwaitInput(input);
            let what =
                Said::new(format!("等待{}，输入口 {port}", name.zh), format!("waiting for {}, port {port}", name.en));
            self.say(what.clone());
            self.waiting_for = Some(what);
        }
        Did::Wait
    }

    fn dwell(&mut self, run: &mut Run, seconds: f64) -> Did {
        match run.doing {
            Doing::Dwell { until } if self.now >= until => Did::Done,
            Doing::Dwell { .. } => Did::Wait,
            Doing::Nothing | Doing::Settling | Doing::AwaitInput(_) | Doing::Skipping { .. } => {
                if self.axes.is_at_rest() {
                    run.doing = Doing::Dwell { until: self.now + Micros::from_secs_f64(seconds) };
                }
                Did::Wait
            }
        }
    }

    /// G31: the position is latched in the tick of the edge, then the axes brake.
    fn skip(&mut self, run: &mut Run, planned: &PlannedMove, signal: u8) -> Did {
        let input = SIGNALS[usize::from(signal.clamp(1, 6)) - 1];
        match run.doing {
            Doing::Nothing | Doing::Settling | Doing::Dwell { .. } | Doing::AwaitInput(_) => {
                let tag = run.next_tag;
                let most = self.params.get(param::SKIP_SPEED_MAX);
                let Some(rate) = planned.speed.rate(self.drive_rpm(), most) else { return self.no_drive() };
                let pushed = Move { to: planned.to, shape: planned.shape, rate, end: End::ExactStop, tag };
                if self.axes.path.push(pushed).is_ok() {
                    run.next_tag += 1;
                    run.doing = Doing::Skipping { tag, latched: false };
                }
                Did::Wait
            }
            Doing::Skipping { tag, latched: false } => {
                if self.raw.has(input) {
                    self.skip_position = self.work();
                    self.axes.path.abort();
                    run.doing = Doing::Skipping { tag, latched: true };
                } else if self.axes.path.finished_tag() >= Some(tag) {
                    self.skip_position = self.work();
                    return Did::Done;
                }
                Did::Wait
            }
            Doing::Skipping { latched: true, .. } if self.axes.is_at_rest() => {
                run.planned.machine = self.axes.set();
                Did::Done
            }
            Doing::Skipping { latched: true, .. } => Did::Wait,
        }
    }

    fn no_drive(&mut self) -> Did {
        self.raise(
            alarm::DRIVE_BLOCKED,
            Some(Said::new("每转进给需要头架转动", "a feed per revolution needs the headstock turning")),
        );
        Did::Wait
    }

    /// Hands moves to the path planner, up to the first act that must happen first.
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
                        // The front of the queue only: what comes before it may start the drive.
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
                Item::End if self.switches.single_block && !run.mdi => return,
                Item::Do(Act::Set(..) | Act::Note(_) | Act::Frames(_) | Act::Wheel(..))
                | Item::Begin(_)
                | Item::End => {}
                Item::Do(
                    Act::SetSystem(..)
                    | Act::Preset(_)
                    | Act::Machine(..)
                    | Act::Gauge(_)
                    | Act::Oscillate(_)
                    | Act::Cylinder(_)
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
                Err(fault) => {
                    run.reading = Reading::Over;
                    let said = Said::new(fault.text(Lang::Zh), fault.text(Lang::En));
                    run.items.push_back(Item::Do(Act::Alarm(fault.alarm(), said, fault.place)));
                }
            }
        }
    }

    /// A block that may not be done: the alarm comes when everything before it is done, nothing of it is.
    fn forbid(&self, run: &mut Run, forbidden: &Forbidden) {
        let at = run.block.at;
        let (title, line) = (self.title(at.program), at.line);
        let place = Said::new(format!("{title} 第{line}行"), format!("{title} line {line}"));
        let number = match forbidden {
            Forbidden::SoftLimit(..) => alarm::SOFT_LIMIT,
            Forbidden::NotHomed => alarm::NOT_HOMED,
            Forbidden::Oscillating(_) => alarm::OSCILLATING_AXIS,
            Forbidden::NoStroke(_) => alarm::OSCILLATION,
            Forbidden::NoDressPoint(_) => alarm::NO_DRESS_POINT,
            Forbidden::NotYet(_) => alarm::M_NOT_YET,
        };
        let cause = self.forbidden(forbidden);
        let said = Said::new(format!("{} {}", place.zh, cause.zh), format!("{} {}", place.en, cause.en));
        run.items.push_back(Item::Do(Act::Alarm(number, said, at)));
    }

    /// What may not be done, in words.
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
            Forbidden::NoDressPoint(axis) => {
                Said::new(format!("{axis} 轴没有设置修整点"), format!("{axis} has no dressing point"))
            }
            Forbidden::NotYet(code) => Said::new(
                format!("M{code:02} 在本版本中还没有"),
                format!("M{code:02} is not available in this version"),
            ),
        }
    }

    /// Overrides as factors of this tick.
    pub(super) fn rate(&self) -> Override {
        let rapid = match self.overrides.rapid {
            0 => self.params.get(param::RAPID_F0) / self.params.get(param::RAPID_X),
            percent => f64::from(percent) / 100.0,
        };
        Override { feed: f64::from(self.overrides.feed) / 100.0, rapid: rapid.min(1.0) }
    }

    /// A common variable gets a value as executed; retained ones go to the disk.
    pub(super) fn store_variable(&mut self, variable: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.memory.set(variable, value)?;
        if Memory::is_retained(variable) {
            self.effects.push(Effect::Variable(variable, value));
        }
        Ok(())
    }

    fn put_frames(&mut self, frames: &super::Frames) {
        for number in 1..=crate::nc::frames::OFFSETS {
            let (geometry, wear) = (frames.geometry[number - 1], frames.wear[number - 1]);
            if wear != self.frames.wear[number - 1] {
                self.effects.push(Effect::Offset { number, geometry, wear });
            }
        }
        self.frames.clone_from(frames);
    }

    pub(super) fn count_part(&mut self) {
        self.parts += 1;
        self.effects.push(Effect::Parts(self.parts));
    }

    /// Once the axes stand, the moves handed over go back to the run, which then gives out one block at a time.
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

    /// Where the block under way still leads, displayed.
    pub(super) fn distance_to_go(&self) -> PerAxis<f64> {
        let way = if self.run.is_some() { self.axes.path.distance_to_go() } else { PerAxis::default() };
        PerAxis::from_fn(|axis: Axis| way[axis] * self.displayed_per_mm(axis))
    }

    /// Whether the run waits for an input (M80–M89).
    pub(super) fn is_waiting(&self) -> bool {
        self.run.as_ref().is_some_and(|run| matches!(run.doing, Doing::AwaitInput(_)))
    }
}
