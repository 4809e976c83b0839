//! Core side of the parameter, diagnosis and settings pages: what they show and what they may change.
//!
//! Passwords are never compared here: they go to the disk thread as a request, and the answer comes back as a command.
//! The tick does not wait for it.
//! Source: spec B6, K6.1.

use std::sync::Arc;

use super::{Controller, Effect};
use crate::defs::kind::Kind;
use crate::defs::param::{Level, ParamAddress, Params};
use crate::defs::param_row;
use crate::defs::signal::Output;
use crate::defs::soft_key::Coordinates;
use crate::defs::text::{Said, Text};
use crate::link::internal::{Internal, InternalSet};
use crate::link::page_command::{BRIGHTNESS, Guard, PASSWORD_LENGTH, PageAnswer, PageCommand, PageWish};
use crate::link::snapshot::{Access, RunState, Snapshot};
use crate::units::{Axis, Micros, PerAxis};

/// Consecutive wrong passwords that start a lock-out.
const WRONG_IN_A_ROW: u32 = 3;
/// Length of the lock-out.
const PAUSE: Micros = Micros::from_millis(30_000);

const WRONG: Text = Text::new("密码错误", "wrong password");
const TOO_OFTEN: Text = Text::new("密码错误次数过多，30 秒后再试", "wrong too often: try again in 30 s");
const BUSY: Text = Text::new("正在核对密码，请稍候", "a password is being checked");
const FORM: Text = Text::new("新密码为 4 到 16 位数字", "a new password has 4 to 16 digits");

/// State of the pages kept in the core.
#[derive(Clone, Debug)]
pub struct Pages {
    /// View of the position page.
    pub coordinates: Coordinates,
    /// Index of the displayed soft-key row.
    pub soft_row: usize,
    /// Index of the displayed sheet of the grinding page.
    pub sheet: usize,
    /// Program message (MSG), shown until it is replaced.
    pub note: Option<Said>,
    /// The parameters for display; replaced when one changes.
    params: Arc<Params>,
    access: Access,
    next_kind: Kind,
    wrong: u32,
    closed_until: Micros,
}

impl Pages {
    /// At power-on every level is locked.
    pub fn new(kind: Kind, params: &Params) -> Self {
        Self {
            coordinates: Coordinates::default(),
            soft_row: 0,
            sheet: 0,
            note: None,
            params: Arc::new(params.clone()),
            access: Access::default(),
            next_kind: kind,
            wrong: 0,
            closed_until: Micros::ZERO,
        }
    }

    /// Takes over changed parameters for display.
    pub fn show(&mut self, params: &Params) {
        self.params = Arc::new(params.clone());
    }

    /// Whether the machine builder's password was entered.
    pub fn is_builder(&self) -> bool {
        self.access.level >= Level::Builder
    }

    /// Whether the program password was entered (K6.2).
    pub const fn may_edit_programs(&self) -> bool {
        self.access.program
    }

    /// Answers the page that asked for a password check.
    const fn answer(&mut self, refused: Option<Text>) {
        self.access.asking = false;
        self.access.answers = self.access.answers.wrapping_add(1);
        self.access.refused = refused;
    }
}

impl Controller {
    /// Executes one command of a page.
    pub(super) fn take_page(&mut self, command: &PageCommand) {
        match command {
            PageCommand::EditParam(at, value) => self.edit_param(*at, *value),
            PageCommand::EditScrew(axis, table) => {
                if self.pages.access.level < Level::Builder {
                    return self.refuse(needs(Level::Builder));
                }
                self.set_screw(*axis, table);
            }
            PageCommand::Unlock(guard, secret) => self.ask_disk(PageWish::Check(*guard, secret.clone())),
            PageCommand::Lock => {
                self.pages.access.level = Level::Operator;
                self.pages.access.program = false;
                self.say(Said::new("参数已锁定", "parameters are locked"));
            }
            PageCommand::ChangePassword { of, old, new } => {
                let digits = new.reveal().bytes().all(|sign| sign.is_ascii_digit());
                if !digits || !PASSWORD_LENGTH.contains(&new.reveal().len()) {
                    self.pages.answer(Some(FORM));
                    return self.refuse(FORM);
                }
                self.ask_disk(PageWish::Change { of: *of, old: old.clone(), new: new.clone() });
            }
            PageCommand::KeepKind(kind) => {
                if self.pages.access.level < Level::Builder {
                    return self.refuse(needs(Level::Builder));
                }
                self.effects.push(Effect::Ask(PageWish::KeepKind(*kind)));
            }
            PageCommand::KeepLang(lang) => self.effects.push(Effect::Ask(PageWish::KeepLang(*lang))),
            PageCommand::KeepLight(light) => self.effects.push(Effect::Ask(PageWish::KeepLight(*light))),
            PageCommand::KeepBrightness(percent) => {
                let percent = (*percent).clamp(*BRIGHTNESS.start(), *BRIGHTNESS.end());
                self.effects.push(Effect::Ask(PageWish::KeepBrightness(percent)));
            }
            PageCommand::KeepPort(port) => {
                if self.pages.access.level < Level::Builder {
                    return self.refuse(needs(Level::Builder));
                }
                self.effects.push(Effect::Ask(PageWish::KeepPort(port.clone())));
            }
            PageCommand::SetDate(wanted) => self.set_date(*wanted),
            PageCommand::File(ticket, request) => self.take_file(*ticket, request),
            PageCommand::Answered(answer) => self.hear(answer),
        }
    }

    fn edit_param(&mut self, at: ParamAddress, value: f64) {
        match param_row::level(at) {
            Some(level) if level > self.pages.access.level => self.refuse(needs(level)),
            Some(_) | None => self.set_param(at, value),
        }
    }

    /// Requests a password check: one at a time; after three wrong passwords input is locked for 30 s.
    fn ask_disk(&mut self, wish: PageWish) {
        let refusal = if self.pages.access.asking {
            Some(BUSY)
        } else {
            (self.now < self.pages.closed_until).then_some(TOO_OFTEN)
        };
        if let Some(reason) = refusal {
            if !self.pages.access.asking {
                self.pages.answer(Some(reason));
            }
            return self.refuse(reason);
        }
        self.pages.access.asking = true;
        self.effects.push(Effect::Ask(wish));
    }

    fn hear(&mut self, answer: &PageAnswer) {
        match answer {
            PageAnswer::Checked(guard, true) => {
                self.pages.wrong = 0;
                self.pages.access.level = self.pages.access.level.max(guard.level());
                self.pages.access.program |= *guard == Guard::Program;
                self.pages.answer(None);
                let name = guard.name();
                self.say(Said::new(
                    format!("{}已打开，关机前有效", name.zh),
                    format!("{}: open until power-off", name.en),
                ));
            }
            PageAnswer::Changed(guard, true) => {
                self.pages.wrong = 0;
                self.pages.answer(None);
                let name = guard.name();
                self.say(Said::new(format!("{}密码已修改", name.zh), format!("{}: password changed", name.en)));
            }
            PageAnswer::Checked(_, false) | PageAnswer::Changed(_, false) => {
                self.pages.wrong += 1;
                if self.pages.wrong >= WRONG_IN_A_ROW {
                    self.pages.wrong = 0;
                    self.pages.closed_until = self.now + PAUSE;
                }
                self.pages.answer(Some(WRONG));
                self.refuse(WRONG);
            }
            PageAnswer::KindKept(kind) => {
                self.pages.next_kind = *kind;
                let name = kind.name();
                self.say(Said::new(format!("下次启动为 {}", name.zh), format!("from the next start: {}", name.en)));
            }
            PageAnswer::LangKept => {}
            PageAnswer::File(ticket, answer) => self.hear_file(*ticket, answer),
            PageAnswer::Failed(why) => {
                self.pages.answer(Some(Text::new("保存失败", "could not be stored")));
                self.refuse(why.clone());
            }
        }
    }

    /// Writes the snapshot fields of the parameter, diagnosis and settings pages.
    pub(super) fn page_view(&self, out: &mut Snapshot) {
        out.input_terminals = self.image.terminals;
        out.output_terminals = self.outputs.terminals;
        out.analog_volts = [self.outputs.wheel_volts, self.outputs.analog_2_volts];
        out.internals = self.internals();
        out.access = self.pages.access;
        out.screws = PerAxis::from_fn(|axis| self.axes.screw(axis).clone());
        out.date = self.calendar.date(self.now);
        self.files_view(out);
        out.next_kind = self.pages.next_kind;
        if !Arc::ptr_eq(&out.params, &self.pages.params) {
            out.params.clone_from(&self.pages.params);
        }
        if !Arc::ptr_eq(&out.alarm_history, self.alarms.history()) {
            out.alarm_history.clone_from(self.alarms.history());
        }
    }

    fn internals(&self) -> InternalSet {
        let facts = self.machine.facts(self.now, self.inputs, &self.params);
        let state = self.state();
        let axes = [
            (Axis::X, Internal::HomedX, Internal::MovingX),
            (Axis::Y, Internal::HomedY, Internal::MovingY),
            (Axis::Z, Internal::HomedZ, Internal::MovingZ),
        ];
        let mut set = InternalSet::default();
        for (axis, homed, moving) in axes {
            set = set.with(homed, self.axes.is_homed(axis)).with(moving, self.is_moving(axis));
        }
        set.with(Internal::DrivesOn, self.drives_on)
            .with(Internal::BusAlive, self.image.bus_alive)
            .with(Internal::EmergencyStopped, self.machine.is_e_stopped())
            .with(Internal::ScreenEmergencyStop, self.soft_e_stop)
            .with(Internal::AlarmBlocksStart, self.alarms.block_start())
            .with(Internal::InPosition, self.is_in_position())
            .with(Internal::RunOpen, self.run.is_some())
            .with(Internal::Running, matches!(state, RunState::Running | RunState::Waiting))
            .with(Internal::Held, state == RunState::Held)
            .with(Internal::Waiting, state == RunState::Waiting)
            .with(Internal::Homing, state == RunState::Homing)
            .with(Internal::SingleBlock, self.switches.single_block)
            .with(Internal::BlockSkip, self.switches.block_skip)
            .with(Internal::OptionalStop, self.switches.optional_stop)
            .with(Internal::RapidByHand, self.hand.rapid)
            .with(Internal::WheelRunUp, self.machine.is_working(Output::Wheel))
            .with(Internal::WorkpieceDrive, self.machine.drive_is_on())
            .with(Internal::TailstockMoving, facts.tailstock_moving)
            .with(Internal::TailstockClamped, facts.tailstock_advanced)
            .with(Internal::HydraulicSettled, facts.hydraulic_settled)
            .with(Internal::HydraulicLatched, facts.hydraulic_latched)
    }
}

/// The refusal for a locked level.
fn needs(level: Level) -> Said {
    let guard = Guard::of(level).map_or(level.name(), Guard::name);
    Said::new(format!("需要{}密码", guard.zh), format!("the password for {} is needed", guard.en))
}
