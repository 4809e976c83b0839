//! Commands and keys: what a press does, or why it does nothing.
//! Source: spec K2, K2.2, K2.4, B5.

use super::frames::OFFSETS;
use super::hand::HandLimits;
use super::homing::{Homing, HomingPlan, Progress};
use super::{Controller, Cycle, Effect, MINUTE_HZ};
use crate::defs::alarm;
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::page::Page;
use crate::defs::param::{self, Bit};
use crate::defs::signal::{Input, Output};
use crate::defs::text::{Said, Text};
use crate::link::command::{Command, FileFault};
use crate::machine::Answer;
use crate::nc::{Source, VariableError};
use crate::units::{Axis, PerAxis};

/// Highest overrides, percent, and their step.
const FEED_OVERRIDE_MOST: u16 = 150;
const SPINDLE_OVERRIDE: std::ops::RangeInclusive<u16> = 50..=120;
const OVERRIDE_STEP: u16 = 10;
/// Programs with a grinding page.
const PAGED_PROGRAMS: std::ops::RangeInclusive<u32> = 1_001..=1_020;
/// Most characters of an MDI line.
const MDI_MOST: usize = 500;

/// The coarsest step by hand on the wheel axis while the wheel turns, mm displayed (K5.9).
const FINE_STEP_MM: f64 = 0.010_5;

const INTO_LIMIT: Text = Text::new("限位方向，请向反方向移开", "onto the limit switch: move the other way");
const OPEN_RUN: Text =
    Text::new("轴还在运动或程序未结束，先复位", "axes still move, or a program is open: press RESET");
const NOT_IN_RUN: Text = Text::new("程序运行中，按键无效", "dead while a program runs");
const NOT_ON_KIND: Text = Text::new("本机型没有此功能", "this kind of machine does not have it");
const NOT_YET: Text = Text::new("此功能在本版本中还没有", "not available in this version");

impl Controller {
    /// Takes one command.
    pub(super) fn take(&mut self, command: &Command) {
        match command {
            Command::Press(key) => self.press(*key),
            Command::Release(key) => {
                if let Some((axis, _)) = key.jog() {
                    self.hand.release(axis);
                }
            }
            Command::Hold(key) => self.hand.keep(*key, self.now),
            Command::Handwheel(detents) => self.turn_handwheel(*detents),
            Command::OpenPage(page) => self.open_page(*page),
            Command::LoadProgram(number) => self.load_program(*number),
            Command::Mdi(line) => self.mdi(line),
            Command::TypeVariable(variable, value) => self.type_variable(*variable, *value),
            Command::SetVariable(variable, value) => {
                self.set_variable(*variable, *value);
            }
            Command::SetParam(at, value) => self.set_param(*at, *value),
            Command::SetFrame(index, origin) => self.set_frame(*index, *origin),
            Command::SetGeometry(number, geometry) => self.set_geometry(*number, *geometry),
            Command::ClearRelative(axis) => self.relative_zero[*axis] = self.axes.actual()[*axis],
            Command::Screens(screens) => {
                self.screens.clone_from(screens);
                self.check_page_files();
            }
            Command::Stored(_) => {}
            Command::DiskFailed(why) => self.raise(alarm::STORE_FAILED, Some(why.clone())),
            Command::Page(command) => self.take_page(command),
            Command::Alive => self.screen_heard = Some(self.now),
        }
    }

    /// Why a key would do nothing now, if it would.
    pub(super) fn blocked(&self, key: Key) -> Option<Text> {
        let row = key.row();
        if !key.is_on(self.kind) {
            return Some(NOT_ON_KIND);
        }
        if matches!(self.cycle, Cycle::Running | Cycle::Aborting) && !row.in_run {
            return Some(NOT_IN_RUN);
        }
        if !is_in_this_version(key) {
            return Some(NOT_YET);
        }
        if let Some((axis, _)) = key.jog()
            && !self.axes.is_present(axis)
        {
            return Some(NOT_ON_KIND);
        }
        let request = self.request_of(key)?;
        let facts = self.machine.facts(self.now, self.inputs, &self.params);
        crate::machine::interlock::forbidding(request, &facts).map(|rule| rule.reason)
    }

    /// The change that a key asks for.
    fn request_of(&self, key: Key) -> Option<Request> {
        let toggle = |output: Output| Request::Switch(output, !self.output_set.has(output));
        Some(match key {
            Key::CycleStart => Request::CycleStart,
            Key::WheelStart => Request::WheelStart,
            Key::WheelStop => Request::WheelStop,
            Key::HeadstockHigh => Request::DriveHigh,
            Key::HeadstockLow => Request::DriveLow,
            Key::HeadstockStop => Request::DriveStop,
            Key::TailstockAdvance => Request::TailstockAdvance,
            Key::TailstockRetract => Request::TailstockRetract,
            Key::Hydraulic if self.output_set.has(Output::Hydraulic) => Request::HydraulicOff,
            Key::Hydraulic => Request::HydraulicOn,
            Key::Coolant => toggle(Output::Coolant),
            Key::Lubrication => toggle(Output::Lubrication),
            Key::RadialGauge => toggle(Output::RadialGauge),
            Key::AxialGauge => toggle(Output::AxialGauge),
            Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => match self.mode {
                Mode::Home => Request::HomeAxes,
                _ => Request::MoveByHand,
            },
            _ => return None,
        })
    }

    fn press(&mut self, key: Key) {
        if let Some(reason) = self.blocked(key)
            && self.request_of(key).is_none_or(|_| matches!(reason, NOT_IN_RUN | NOT_ON_KIND | NOT_YET))
        {
            return self.refuse(reason);
        }
        match key {
            Key::ModeEdit => self.choose(Mode::Edit),
            Key::ModeAuto => self.choose(Mode::Auto),
            Key::ModeMdi => self.choose(Mode::Mdi),
            Key::ModeHome => self.choose(Mode::Home),
            Key::ModeHandwheel => self.choose(Mode::Handwheel),
            Key::ModeStep => self.choose(Mode::Step),
            Key::ModeManual => self.choose(Mode::Manual),
            Key::SingleBlock => self.switch_single_block(),
            Key::BlockSkip => self.switches.block_skip = !self.switches.block_skip,
            Key::OptionalStop => self.switches.optional_stop = !self.switches.optional_stop,
            Key::CycleStart => self.cycle_start(),
            Key::FeedHold => self.feed_hold(),
            Key::Reset => self.reset(),
            Key::EmergencyStop => self.soft_e_stop = !self.soft_e_stop,
            Key::Rapid => self.hand.rapid = !self.hand.rapid,
            Key::HandwheelX => self.choose_handwheel(Axis::X),
            Key::HandwheelY => self.choose_handwheel(Axis::Y),
            Key::HandwheelZ => self.choose_handwheel(Axis::Z),
            Key::Step0001 => self.hand.step_mm = 0.001,
            Key::Step001 => self.hand.step_mm = 0.01,
            Key::Step01 => self.hand.step_mm = 0.1,
            Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => self.axis_key(key),
            Key::F1 => self.open_page(Page::Position),
            Key::F4 => self.open_page(Page::Grinding),
            _ => self.press_override(key),
        }
    }

    fn press_override(&mut self, key: Key) {
        let overrides = &mut self.overrides;
        match key {
            Key::FeedOverrideUp => overrides.feed = (overrides.feed + OVERRIDE_STEP).min(FEED_OVERRIDE_MOST),
            Key::FeedOverrideDown => overrides.feed = overrides.feed.saturating_sub(OVERRIDE_STEP),
            Key::RapidF0 => overrides.rapid = 0,
            Key::Rapid25 => overrides.rapid = 25,
            Key::Rapid50 => overrides.rapid = 50,
            Key::Rapid100 => overrides.rapid = 100,
            Key::SpindleOverrideUp => {
                overrides.spindle = (overrides.spindle + OVERRIDE_STEP).min(*SPINDLE_OVERRIDE.end());
            }
            Key::SpindleOverrideDown => {
                overrides.spindle = (overrides.spindle - OVERRIDE_STEP).max(*SPINDLE_OVERRIDE.start());
            }
            key => {
                if let Some(request) = self.request_of(key) {
                    self.ask(request);
                }
            }
        }
    }

    /// Asks the machine logic and says what came of it.
    pub(super) fn ask(&mut self, request: Request) -> Answer {
        let answer = self.machine.ask(request, self.now, self.inputs, &self.params);
        match answer {
            Answer::Taken if matches!(request, Request::DriveHigh | Request::DriveLow | Request::DriveStop) => {
                self.analog_2_rpm = 0.0;
            }
            Answer::Taken => {}
            Answer::NoEffect(reason) | Answer::Denied(reason) => self.refuse(reason),
            Answer::Refused(number, reason) => {
                self.refuse(reason);
                // Alarm 180 is raised by the supervision, which also knows when it may go (K3.7).
                if number != alarm::HYDRAULIC {
                    self.raise(number, Some(reason.into()));
                }
            }
        }
        answer
    }

    fn choose(&mut self, mode: Mode) {
        // K2.2, K6.3: a held run survives a change of mode; cycle start resumes it from any.
        if !matches!(self.cycle, Cycle::Idle | Cycle::Held | Cycle::Stopped) && mode != self.mode {
            return self.refuse(Said::new("轴还在运动，不能换方式", "the axes still move: no change of mode"));
        }
        self.hand.let_go();
        self.mode = mode;
    }

    fn switch_single_block(&mut self) {
        self.switches.single_block = !self.switches.single_block;
        if self.switches.single_block
            && matches!(self.cycle, Cycle::Running)
            && let Some(run) = &mut self.run
            && run.fed > 0
        {
            self.axes.path.hold();
            run.splitting = true;
        }
    }

    fn cycle_start(&mut self) {
        match self.cycle {
            Cycle::Running => return self.refuse(Said::new("程序已在运行", "the program is running")),
            Cycle::Holding | Cycle::Aborting | Cycle::Homing { .. } => {
                return self.refuse(Said::new("轴还在运动，请稍候", "the axes still move"));
            }
            Cycle::Idle if self.mode != Mode::Auto => {
                return self.refuse(Said::new("自动方式下才能循环启动", "cycle start works in mode AUTO"));
            }
            Cycle::Idle | Cycle::Held | Cycle::Stopped => {}
        }
        if !matches!(self.ask(Request::CycleStart), Answer::Taken) {
            return;
        }
        match self.cycle {
            Cycle::Held | Cycle::Stopped => {
                self.axes.path.resume();
                self.cycle = Cycle::Running;
            }
            _ => self.start_program(),
        }
    }

    fn start_program(&mut self) {
        let number = self.current;
        match self.programs.get(number) {
            Some(program) => {
                let source = std::sync::Arc::clone(&program.source);
                self.open_run(source, false);
            }
            None => self.refuse(Said::new(
                format!("没有程序 O{number:04}：先在目录中选择程序"),
                format!("there is no program O{number:04}: choose one in the directory"),
            )),
        }
    }

    fn feed_hold(&mut self) {
        match self.cycle {
            Cycle::Running => {
                self.axes.path.hold();
                self.cycle = Cycle::Holding;
            }
            Cycle::Homing { .. } => self.abort_run(),
            Cycle::Idle | Cycle::Holding | Cycle::Held | Cycle::Stopped | Cycle::Aborting => {}
        }
    }

    fn reset(&mut self) {
        self.abort_run();
        self.machine.reset();
        let e_stop = self.machine.is_e_stopped();
        let bus = self.image.bus_alive;
        let (inputs, limits) = (self.inputs, self.limits);
        let drives = [Input::DriveX, Input::DriveY, Input::DriveZ].into_iter().any(|input| inputs.has(input));
        self.alarms.reset(|number| match number {
            alarm::EMERGENCY_STOP => e_stop,
            alarm::BUS_LOST => !bus,
            alarm::DRIVE_FAULT => drives,
            alarm::HARD_LIMIT => limits != 0,
            _ => false,
        });
        self.drives_on = !e_stop && bus && !drives;
        self.message = Default::default();
    }

    fn choose_handwheel(&mut self, axis: Axis) {
        if self.axes.is_present(axis) {
            self.hand.axis = axis;
        } else {
            self.refuse(NOT_ON_KIND);
        }
    }

    /// Detents of the handwheel: each changes the displayed coordinate by the step (K2.3).
    pub(super) fn turn_handwheel(&mut self, detents: i32) {
        if self.mode != Mode::Handwheel {
            return self.refuse(Said::new("手轮方式下手轮才有效", "the handwheel works in mode HANDWHEEL"));
        }
        if !matches!(self.cycle, Cycle::Idle) {
            return self.refuse(OPEN_RUN);
        }
        if !matches!(self.ask(Request::MoveByHand), Answer::Taken) {
            return;
        }
        let axis = self.hand.axis;
        let distance = f64::from(detents) * self.hand.step_mm / self.displayed_per_mm(axis);
        self.step_by(axis, distance);
    }

    /// Whether a direction leads further onto a limit switch that is pressed.
    fn runs_into_limit(&self, axis: Axis, direction: f64) -> bool {
        let side = if direction > 0.0 { 0 } else { 1 };
        self.limits >> (2 * axis as u8 + side) & 1 == 1
    }

    /// A detent or a step by hand. K5.9: with the wheel on, the wheel axis takes no coarse steps.
    fn step_by(&mut self, axis: Axis, distance: f64) {
        let coarse = self.hand.step_mm > FINE_STEP_MM;
        if coarse && axis == self.row.slow_axis && self.output_set.has(Output::Wheel) {
            return self.refuse(Said::new(
                "砂轮启动后该轴倍率只能为 ×0.01",
                "with the wheel on this axis takes ×0.01 and finer",
            ));
        }
        if self.runs_into_limit(axis, distance) {
            return self.refuse(INTO_LIMIT);
        }
        self.hand.nudge(axis, distance, &self.axes, &self.params);
    }

    fn axis_key(&mut self, key: Key) {
        let Some((axis, direction)) = key.jog() else { return };
        match self.mode {
            Mode::Home => self.home_axis(axis),
            Mode::Manual | Mode::Step if !matches!(self.cycle, Cycle::Idle) => {
                self.refuse(OPEN_RUN);
            }
            Mode::Manual => {
                if self.runs_into_limit(axis, direction) {
                    self.refuse(INTO_LIMIT);
                } else if matches!(self.ask(Request::MoveByHand), Answer::Taken) {
                    self.hand.hold(axis, direction, self.now);
                }
            }
            Mode::Step => {
                if matches!(self.ask(Request::MoveByHand), Answer::Taken) {
                    let distance = direction * self.hand.step_mm / self.displayed_per_mm(axis);
                    self.step_by(axis, distance);
                }
            }
            Mode::Edit | Mode::Auto | Mode::Mdi | Mode::Handwheel => {
                self.refuse(Said::new("手动、单步或机械零点方式下轴键才有效", "axis keys work in JOG, STEP and HOME"));
            }
        }
    }

    /// Homes an axis; the wheel axis always first (K5.16).
    fn home_axis(&mut self, axis: Axis) {
        if !matches!(self.ask(Request::HomeAxes), Answer::Taken) {
            return;
        }
        let mut wanted = PerAxis::default();
        wanted[axis] = true;
        let first = self.row.home_order.first().copied().unwrap_or(axis);
        if !self.axes.is_homed(first) {
            wanted[first] = true;
        }
        match &mut self.cycle {
            Cycle::Homing { next, now } => {
                if now.axis != axis {
                    next[axis] = true;
                }
            }
            Cycle::Idle => self.next_homing(wanted),
            Cycle::Running | Cycle::Holding | Cycle::Held | Cycle::Stopped | Cycle::Aborting => {
                self.refuse(OPEN_RUN);
            }
        }
    }

    fn next_homing(&mut self, mut wanted: PerAxis<bool>) {
        let Some(axis) = self.row.home_order.iter().copied().find(|axis| wanted[*axis]) else {
            self.cycle = Cycle::Idle;
            return;
        };
        wanted[axis] = false;
        let minus: Bit = [param::HOME_MINUS_X, param::HOME_MINUS_Y, param::HOME_MINUS_Z][axis as usize];
        let plan = HomingPlan {
            direction: if self.params.bit(minus) { -1.0 } else { 1.0 },
            fast_mm_s: self.params.get(param::HOME_FAST) * MINUTE_HZ,
            slow_mm_s: self.params.get(param::HOME_SLOW) * MINUTE_HZ,
            travel_mm: self.params.get(param::HOMING_TRAVEL),
            coordinate: self.params.of_axis(param::HOME_X, axis),
            width_mm: self.params.get(param::IN_POSITION),
        };
        self.axes.give_to_hand();
        self.axes.unbound(axis);
        self.cycle = Cycle::Homing { now: Homing::new(axis, plan), next: wanted };
    }

    /// Jog, handwheel or homing, one tick.
    pub(super) fn step_hand(&mut self) {
        const SWITCHES: [Input; 3] = [Input::HomeX, Input::HomeY, Input::HomeZ];
        if let Cycle::Homing { now, next } = &mut self.cycle {
            let (axis, next) = (now.axis, *next);
            let switch = SWITCHES[axis as usize];
            let at = self.axes.actual()[axis];
            let mover = &mut self.axes.movers[axis];
            match now.tick(mover, self.inputs.has(switch), self.raw.has(switch), at) {
                Progress::Going => {}
                Progress::SetZero { edge } => {
                    let coordinate = self.params.of_axis(param::HOME_X, axis);
                    self.axes.set_zero(axis, edge, coordinate, &self.params);
                }
                Progress::Done => self.next_homing(next),
                Progress::Failed => {
                    self.raise(alarm::HOMING_FAILED, Some(Said::new(axis.to_string(), axis.to_string())));
                }
            }
        } else if matches!(self.cycle, Cycle::Idle) {
            let limits = HandLimits {
                feed: f64::from(self.overrides.feed) / 100.0,
                rapid: self.rate().rapid,
                slow: self.output_set.has(Output::Wheel).then_some(self.row.slow_axis),
            };
            let (mode, now) = (self.mode, self.now);
            self.axes.give_to_hand();
            if self.hand.tick(&mut self.axes, mode, now, &self.params, limits) {
                self.refuse(Said::new("按键信号中断，轴已停止", "the key was lost: the axis has stopped"));
            }
        }
    }

    fn open_page(&mut self, page: Page) {
        self.page = page;
        self.check_page_files();
    }

    /// K7.3: alarm 66 when the page opens; it goes when the files are right or the page is left.
    fn check_page_files(&mut self) {
        self.alarms.clear(alarm::PAGE_FILES);
        if self.page != Page::Grinding || !PAGED_PROGRAMS.contains(&self.current) {
            return;
        }
        let nn = self.current - 1_000;
        let missing = |file: String| FileFault {
            file,
            place: None,
            said: Said::new("文件不存在，请拷入 screens 目录", "missing: copy it into the screens folder"),
        };
        let faults: Vec<Said> = match self.screens.find(self.current) {
            Some(files) => [files.text.as_ref().err(), files.picture.as_ref().err()]
                .into_iter()
                .flatten()
                .map(FileFault::said)
                .collect(),
            None => vec![missing(format!("C{nn:04}.TXT")).said(), missing(format!("B{nn:04}.BMP")).said()],
        };
        if let Some(first) = faults.first() {
            let rest = &faults[1..];
            let detail = rest.iter().fold(first.clone(), |all, fault| {
                Said::new(format!("{}；{}", all.zh, fault.zh), format!("{}; {}", all.en, fault.en))
            });
            self.raise(alarm::PAGE_FILES, Some(detail));
        }
    }

    fn load_program(&mut self, number: u32) {
        if self.run.is_some() {
            return self.refuse(NOT_IN_RUN);
        }
        if self.programs.get(number).is_none() {
            return self.refuse(Said::new(
                format!("程序目录中没有 O{number:04}"),
                format!("the programs folder has no O{number:04}"),
            ));
        }
        self.current = number;
        self.place = crate::nc::Place::default();
        self.effects.push(Effect::CurrentProgram(number));
        self.check_page_files();
        self.say(Said::new(format!("当前程序 O{number:04}"), format!("current program O{number:04}")));
    }

    fn mdi(&mut self, line: &str) {
        if self.mode != Mode::Mdi {
            return self.refuse(Said::new("录入方式下才能执行", "MDI lines work in mode MDI"));
        }
        if !matches!(self.cycle, Cycle::Idle) {
            return self.refuse(NOT_IN_RUN);
        }
        if line.chars().count() > MDI_MOST {
            return self.refuse(Said::new("录入行太长", "the MDI line is too long"));
        }
        if matches!(self.ask(Request::CycleStart), Answer::Taken) {
            let source = std::sync::Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec()));
            self.open_run(source, true);
        }
    }

    fn set_frame(&mut self, index: usize, origin: PerAxis<f64>) {
        match self.frames.work.get_mut(index) {
            Some(_) if self.run.is_some() => self.refuse(NOT_IN_RUN),
            Some(frame) => {
                *frame = origin;
                self.effects.push(Effect::Frame(index, origin));
            }
            None => self.refuse(Said::new("没有此工件坐标系", "there is no such work frame")),
        }
    }

    fn set_geometry(&mut self, number: usize, geometry: PerAxis<f64>) {
        match number.checked_sub(1).filter(|index| *index < OFFSETS) {
            Some(_) if self.run.is_some() => self.refuse(NOT_IN_RUN),
            Some(index) => {
                self.frames.geometry[index] = geometry;
                self.effects.push(Effect::Offset { number, geometry, wear: self.frames.wear[index] });
            }
            None => self.refuse(Said::new("刀补号应为 1-16", "offsets are numbered 1 to 16")),
        }
    }

    /// A value typed on the open page (K7.5, K7.7).
    fn type_variable(&mut self, variable: u16, value: Option<f64>) {
        if self.page != Page::Grinding || !self.page_shows(variable) {
            return self.refuse(Said::new(
                format!("当前页面没有 #{variable}"),
                format!("the open page does not show #{variable}"),
            ));
        }
        if self.run.is_some() && !self.params.bit(param::EDIT_VALUES_IN_RUN) {
            return self.refuse(Said::new("程序运行中不能修改 (P6.3)", "not while a program runs (P6.3)"));
        }
        if self.set_variable(variable, value) {
            let shown = value.map_or_else(String::new, |value| format!("{value:.3}"));
            self.say(Said::new(format!("#{variable} = {shown}"), format!("#{variable} = {shown}")));
        }
    }

    fn page_shows(&self, variable: u16) -> bool {
        self.screens
            .find(self.current)
            .and_then(|files| files.text.as_ref().ok())
            .is_some_and(|page| page.rows().any(|row| row.variable == variable))
    }

    /// False: refused, and said why.
    fn set_variable(&mut self, variable: u16, value: Option<f64>) -> bool {
        let number = u32::from(variable);
        if let Err(error) = self.store_variable(number, value) {
            let zh = match error {
                VariableError::Unknown(_) => format!("#{variable} 不存在或不能修改"),
                VariableError::Switch(_) => format!("#{variable} 只能输入 0 或 1"),
                VariableError::NotFinite(_) => format!("#{variable} 的值不是数字"),
            };
            self.refuse(Said::new(zh, error.to_string()));
            return false;
        }
        if let Some(run) = &mut self.run
            && run.interpreter.variable_edited(number, value).is_err()
        {
            self.refuse(Said::new("程序没有接受此值", "the running program did not take the value"));
            return false;
        }
        true
    }
}

/// Keys that this version draws but does not drive yet.
const fn is_in_this_version(key: Key) -> bool {
    !matches!(
        key,
        Key::MachineLock
            | Key::MstLock
            | Key::DryRun
            | Key::SecondSpindle
            | Key::Oscillation
            | Key::DressReturn
            | Key::WheelRetract
            | Key::F2
            | Key::F3
            | Key::F5
            | Key::AddressX
            | Key::AddressY
            | Key::AddressZ
            | Key::Input
            | Key::Cancel
            | Key::NextRow
    )
}
