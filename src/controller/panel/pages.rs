//! Core side of the parameter, diagnosis and settings pages: what they show and what they may change.
//!
//! Source: spec B6, K6.1.

use std::sync::Arc;

use super::snapshot::run_state;
use super::{Panel, Parts, PartsView};
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::param::{AccessLevel, ParamAddress, Params};
use crate::defs::param_row;
use crate::defs::signal::Output;
use crate::defs::soft_key::CoordinateView;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::internal_signal::{InternalSignal, InternalSignalSet};
use crate::link::page_command::{
    BRIGHTNESS, DataChoice, KeptState, PASSWORD_LENGTH, PageCommand, PasswordCheck, PasswordScope, SettingsRequest,
    StorageAnswer, ZOOMS,
};
use crate::link::snapshot::{RunState, Snapshot};
use crate::link::terminals::TerminalView;
use crate::machine::panel_key::NOT_IN_RUN;
use crate::units::Axis;

const FORM: Text = Text::new("新密码为 4 到 16 位数字", "a new password has 4 to 16 digits");

/// The views that the operator has selected.
#[derive(Clone, Debug, Default)]
pub struct PageState {
    /// View of the position page.
    pub coordinates: CoordinateView,
    /// Index of the displayed soft-key row.
    pub soft_row: usize,
    /// Index of the displayed sheet of the grinding page.
    pub sheet: usize,
    /// Kind of machine from the next power-on.
    next_kind: Kind,
    /// Earlier states that may take the place of lost data.
    kept_states: Arc<[KeptState]>,
}

impl PageState {
    /// At power-on.
    pub fn new(kind: Kind, kept_states: &Arc<[KeptState]>) -> Self {
        Self { next_kind: kind, kept_states: Arc::clone(kept_states), ..Self::default() }
    }
}

impl Panel {
    /// Executes one command of a page.
    pub fn handle_page_command(&mut self, parts: &mut Parts<'_>, command: &PageCommand) {
        let mut save = |request| parts.plant.store(StorageRequest::Page(request));
        match command {
            PageCommand::EditLeadscrew(..)
            | PageCommand::SetNextKind(_)
            | PageCommand::SetSerialPort(_)
            | PageCommand::AcceptData(_)
                if !self.access.is_builder() =>
            {
                parts.plant.refuse(password_needed(AccessLevel::Builder))
            }
            PageCommand::EditParam(at, value) => self.edit_param(parts, *at, *value),
            PageCommand::EditLeadscrew(axis, table) => Self::set_leadscrew_table(parts, *axis, table),
            PageCommand::Unlock(guard, secret) => {
                self.request_password_check(parts, SettingsRequest::CheckPassword(*guard, secret.clone()))
            }
            PageCommand::Lock => {
                self.access.lock();
                parts.plant.show_note(phrase!("参数已锁定", "parameters are locked"));
            }
            PageCommand::ChangePassword { scope: of, old, new } => {
                let digits = new.reveal().bytes().all(|sign| sign.is_ascii_digit());
                if !digits || !PASSWORD_LENGTH.contains(&new.reveal().len()) {
                    self.access.answer(Some(FORM));
                    return parts.plant.refuse(FORM);
                }
                let request = SettingsRequest::ChangePassword { scope: *of, old: old.clone(), new: new.clone() };
                self.request_password_check(parts, request);
            }
            PageCommand::AcceptData(choice) => save(SettingsRequest::AcceptData(choice.clone())),
            PageCommand::SetNextKind(kind) => save(SettingsRequest::SaveKind(*kind)),
            PageCommand::SetLang(lang) => save(SettingsRequest::SaveLang(*lang)),
            PageCommand::SetLightTheme(light) => save(SettingsRequest::SaveLightTheme(*light)),
            PageCommand::SetZoom(percent) if !ZOOMS.contains(percent) => {}
            PageCommand::SetZoom(percent) => save(SettingsRequest::SaveZoom(*percent)),
            PageCommand::SetBrightness(percent) => {
                save(SettingsRequest::SaveBrightness((*percent).clamp(*BRIGHTNESS.start(), *BRIGHTNESS.end())));
            }
            PageCommand::SetSerialPort(port) => save(SettingsRequest::SaveSerialPort(port.clone())),
            PageCommand::SetFavourites(favourites) => save(SettingsRequest::SaveFavourites(favourites.clone())),
            PageCommand::Scope(command) => self.scope.command(parts.plant, *command),
            PageCommand::SetDate(wanted) => self.set_date(parts, *wanted),
            PageCommand::TakeDressPoint(..) | PageCommand::ClearDressPoints if parts.program.is_open() => {
                parts.plant.refuse(NOT_IN_RUN)
            }
            PageCommand::TakeDressPoint(axis, shown) => parts.manual.take_dress_point(parts.plant, *axis, *shown),
            PageCommand::ClearDressPoints => parts.manual.clear_dress_points(parts.plant),
            PageCommand::SetDowntimeReason(reason) => self.set_downtime_reason(parts, *reason),
            PageCommand::File(ticket, request) => self.handle_file_request(parts, *ticket, request),
            PageCommand::StorageAnswered(answer) => self.handle_page_answer(parts, answer),
        }
    }

    fn edit_param(&mut self, parts: &mut Parts<'_>, at: ParamAddress, value: f64) {
        match param_row::access_level(at) {
            Some(level) if level > self.access.view().level => parts.plant.refuse(password_needed(level)),
            Some(_) | None => Self::set_param(parts, at, value),
        }
    }

    /// Requests a password check: one at a time; after three wrong passwords input is locked for 30 s.
    fn request_password_check(&mut self, parts: &mut Parts<'_>, request: SettingsRequest) {
        match self.access.begin_check(parts.plant.now) {
            Ok(()) => parts.plant.store(StorageRequest::Page(request)),
            Err(reason) => parts.plant.refuse(reason),
        }
    }

    /// Stores the number of wrong passwords in a row, if it differs from that before.
    fn store_wrong_passwords(&self, parts: &mut Parts<'_>, count: u32) {
        if count > 0 || self.access.wrong_passwords() > 0 {
            parts.plant.store(StorageRequest::WrongPasswords(count));
        }
    }

    fn handle_page_answer(&mut self, parts: &mut Parts<'_>, answer: &StorageAnswer) {
        match answer {
            StorageAnswer::PasswordChecked(guard, check @ (PasswordCheck::Right | PasswordCheck::Initial)) => {
                self.store_wrong_passwords(parts, 0);
                self.access.unlock(*guard);
                let name = guard.name();
                parts.plant.show_note(match check {
                    PasswordCheck::Initial if *guard != PasswordScope::Program => phrase!(
                        "{name}已打开；仍是出厂密码，请在“设置”页修改",
                        "{name}: unlocked; the password is still the initial one: change it on the page SETTINGS",
                        name
                    ),
                    _ => phrase!("{name}已打开，关机前有效", "{name}: unlocked until power-off", name),
                });
            }
            StorageAnswer::PasswordChanged(guard, true) => {
                self.store_wrong_passwords(parts, 0);
                self.access.accept();
                let name = guard.name();
                parts.plant.show_note(phrase!("{name}密码已修改", "{name}: password changed", name));
            }
            StorageAnswer::PasswordChecked(_, PasswordCheck::Wrong) | StorageAnswer::PasswordChanged(_, false) => {
                let wrong = self.access.reject(parts.plant.now);
                self.store_wrong_passwords(parts, self.access.wrong_passwords());
                parts.plant.refuse(wrong);
            }
            StorageAnswer::DataAccepted(choice) => accept_data(parts, choice),
            StorageAnswer::KindSaved(kind) => {
                parts.plant.alarms.clear(alarm::SETTINGS_INVALID);
                self.pages.next_kind = *kind;
                let name = &kind.row().name;
                parts.plant.show_note(phrase!("下次启动为 {name}", "from the next start: {name}", name));
            }
            StorageAnswer::LangSaved => {}
            StorageAnswer::File(ticket, answer) => self.handle_file_answer(parts, *ticket, answer),
            StorageAnswer::Failed(why) => {
                self.access.answer(Some(Text::new("保存失败", "could not be stored")));
                parts.plant.refuse(why.clone());
            }
        }
    }

    /// Writes the snapshot fields of the parameter, diagnosis and settings pages.
    pub fn page_view(&self, parts: PartsView<'_>, out: &mut Snapshot) {
        let image = &parts.plant.outputs.image;
        out.terminals = TerminalView {
            inputs: parts.plant.inputs.image.terminals,
            outputs: image.terminals,
            analog_volts: [image.wheel_volts, image.analog_2_volts],
        };
        out.internals = internal_signals(parts);
        out.access = self.access.view();
        for axis in Axis::ALL {
            let table = parts.plant.axes.leadscrew_table(axis);
            if out.leadscrews[axis] != *table {
                out.leadscrews[axis].clone_from(table);
            }
        }
        out.date = self.calendar.date(parts.plant.now);
        self.files_view(out);
        out.next_kind = self.pages.next_kind;
        if !Arc::ptr_eq(&out.kept_states, &self.pages.kept_states) {
            out.kept_states = Arc::clone(&self.pages.kept_states);
        }
        copy_changed(&mut out.params, &parts.plant.params);
        out.alarm_history.copy_from(parts.plant.alarms.history());
    }
}

/// A person has decided what takes the place of lost data. What comes with the next start stands as the alarm until then.
fn accept_data(parts: &mut Parts<'_>, choice: &DataChoice) {
    let chosen = match choice {
        DataChoice::Present => None,
        DataChoice::Kept(state) => {
            let time = state.time.as_str();
            Some(phrase!(
                "下次启动用 {time} 的数据：请关机再开机",
                "the values of {time} come with the next start: switch off and on",
                time
            ))
        }
        DataChoice::Factory => Some(phrase!(
            "下次启动用出厂值：请关机再开机",
            "factory values come with the next start: switch off and on"
        )),
    };
    parts.plant.alarms.clear(alarm::RETAINED_DATA_DAMAGED);
    match chosen {
        Some(chosen) => parts.plant.raise(alarm::RETAINED_DATA_DAMAGED, Some(chosen)),
        None => {
            parts.plant.alarms.clear(alarm::VALUES_DROPPED);
            parts.plant.show_note(phrase!("保存数据已接受", "the retained data are accepted"));
        }
    }
}

/// The internal signals of the diagnosis page.
fn internal_signals(parts: PartsView<'_>) -> InternalSignalSet {
    let plant = parts.plant;
    let inputs = plant.machine.interlock_inputs(plant.now, plant.inputs.filtered, &plant.params);
    let state = run_state(parts);
    let axes = [
        (Axis::X, InternalSignal::HomedX, InternalSignal::MovingX),
        (Axis::Y, InternalSignal::HomedY, InternalSignal::MovingY),
        (Axis::Z, InternalSignal::HomedZ, InternalSignal::MovingZ),
    ];
    let mut set = InternalSignalSet::default();
    for (axis, homed, moving) in axes {
        set = set.with(homed, plant.axes.is_homed(axis)).with(moving, plant.is_moving(axis));
    }
    set.with(InternalSignal::DrivesOn, plant.drives_follow())
        .with(InternalSignal::BusAlive, plant.inputs.image.bus_alive)
        .with(InternalSignal::EmergencyStopped, plant.machine.is_e_stopped())
        .with(InternalSignal::ScreenEmergencyStop, plant.inputs.screen_e_stop())
        .with(InternalSignal::AlarmBlocksStart, plant.alarms.blocks_start())
        .with(InternalSignal::InPosition, plant.is_in_position())
        .with(InternalSignal::ProgramOpen, parts.program.is_open())
        .with(InternalSignal::Running, matches!(state, RunState::Running | RunState::Waiting))
        .with(InternalSignal::Held, state == RunState::Held)
        .with(InternalSignal::Waiting, state == RunState::Waiting)
        .with(InternalSignal::Homing, state == RunState::Homing)
        .with(InternalSignal::SingleBlock, plant.operator.switches.single_block)
        .with(InternalSignal::BlockSkip, plant.operator.switches.block_skip)
        .with(InternalSignal::OptionalStop, plant.operator.switches.optional_stop)
        .with(InternalSignal::RapidJog, plant.operator.rapid_jog)
        .with(InternalSignal::WheelRunUp, plant.machine.awaits_feedback(Output::Wheel))
        .with(InternalSignal::WorkpieceDrive, plant.machine.drive_is_on())
        .with(InternalSignal::TailstockMoving, inputs.tailstock_moving)
        .with(InternalSignal::TailstockClamped, inputs.tailstock_advanced)
        .with(InternalSignal::HydraulicSettled, inputs.hydraulic_settled)
        .with(InternalSignal::HydraulicLatched, inputs.hydraulic_latched)
}

/// The refusal for a locked level.
fn password_needed(level: AccessLevel) -> LocalizedText {
    let guard = PasswordScope::for_level(level).map_or(level.name(), PasswordScope::name);
    phrase!("需要{guard}密码", "the password for {guard} is needed", guard)
}

/// Copies the parameters if they have changed: in place, unless a reader still holds the older values.
fn copy_changed(shown: &mut Arc<Params>, params: &Params) {
    if **shown != *params {
        match Arc::get_mut(shown) {
            Some(shown) => shown.copy_from(params),
            None => *shown = Arc::new(params.clone()),
        }
    }
}
