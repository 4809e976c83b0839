//! Commands from the operator, a story or the disk, and why they are refused.
//! Source: spec B6, K7.5, K7.7.

use super::{Controller, StorageRequest};
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::mcode::Request;
use crate::defs::program_number;
use crate::defs::text::LocalizedText;
use crate::defs::variable_name;
use crate::link::PageCommand;
use crate::link::command::Command;
use crate::machine::RequestResult;
use crate::machine::panel_key::NOT_IN_RUN;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::nc::{Source, VariableError};
use crate::units::{Axis, PerAxis};

/// Maximum characters of an MDI line.
pub(super) const MAX_MDI_CHARS: usize = 500;

impl Controller {
    /// Executes one command.
    pub(super) fn handle_command(&mut self, command: &Command) {
        if self.restart.is_some() && invalidates_restart(command) {
            self.restart = None;
            self.show_note(LocalizedText::new(
                "数据已修改，请重新选择起始段",
                "data were changed: choose the block again",
            ));
        }
        match command {
            Command::Press(key) => self.press_key(*key),
            Command::Release(key) => {
                if let Some((axis, _)) = key.jog_direction() {
                    self.jog.release_jog_key(axis);
                }
            }
            Command::StillHeld(key) => self.jog.keep_alive(*key, self.now),
            Command::Handwheel(detents) => self.turn_handwheel(*detents),
            Command::OpenPage(page) => self.open_page(*page),
            Command::ShowCoordinates(coordinates) => self.show_coordinates(*coordinates),
            Command::ShowSoftKeyRow(row) => self.show_soft_row(*row),
            Command::ShowGrindingSheet(sheet) => self.show_sheet(*sheet),
            Command::LoadProgram(number) => self.load_program(*number),
            Command::RestartAt(line) => self.restart_at(*line),
            Command::ResumeInterrupted => self.resume_interrupted(),
            Command::Mdi(line) => self.run_mdi(line),
            Command::EnterVariable(..)
            | Command::Offset(_)
            | Command::AddWear { .. }
            | Command::ChangeWheel { .. }
            | Command::PrepareMdi(_)
            | Command::Page(PageCommand::EditParam(..) | PageCommand::EditLeadscrew(..)) => self.handle_edit(command),
            Command::SetVariable(variable, value) => {
                self.set_variable(*variable, *value);
            }
            Command::SetParam(at, value) => self.set_param(*at, *value),
            Command::SetWorkOffset(index, origin) => self.set_work_offset(*index, *origin),
            Command::SetGeometry(number, geometry) => self.set_geometry(*number, *geometry),
            Command::SetStock(stock) => self.files.stock.clone_from(stock),
            Command::SetLeadscrew(axis, table) => self.set_leadscrew_table(*axis, table),
            Command::ClearRelative(axis) => self.relative_zero[*axis] = self.axes.actual()[*axis],
            Command::ScreensLoaded(screens) => {
                self.screens.clone_from(screens);
                self.check_page_files();
            }
            Command::Stored(_) | Command::Simulate(_) => {}
            Command::DiskFailed(why) => self.raise(alarm::STORE_FAILED, Some(why.clone())),
            Command::Page(command) => self.handle_page_command(command),
            Command::Teach(command) => self.handle_teach_command(*command),
            Command::WallClock(told) => {
                if let Some(power_on) = self.calendar.sync(self.now, *told) {
                    self.alarms.set_power_on_date(power_on);
                }
            }
            Command::KeepAlive => self.screen_alive_at = Some(self.now),
        }
    }

    fn set_work_offset(&mut self, index: usize, origin: PerAxis<f64>) {
        match self.work_offsets.work.get_mut(index) {
            Some(_) if self.run.is_some() => self.refuse(NOT_IN_RUN),
            Some(frame) => {
                *frame = origin;
                self.storage_requests.push(StorageRequest::WorkOffset(index, origin));
            }
            None => self.refuse(LocalizedText::new("没有此工件坐标系", "there is no such work frame")),
        }
    }

    /// Replaces the leadscrew table of an axis; the correction is applied by a ramp. Refused while a run is open.
    pub(super) fn set_leadscrew_table(&mut self, axis: Axis, table: &LeadscrewCompensation) {
        if self.run.is_some() {
            return self.refuse(NOT_IN_RUN);
        }
        self.axes.set_leadscrew_table(axis, table.clone());
        self.storage_requests.push(StorageRequest::LeadscrewTable(axis, table.clone()));
        let points = table.points().len();
        self.show_note(LocalizedText::new(
            format!("{axis} 轴丝杠补偿表：{points} 点"),
            format!("screw table of axis {axis}: {points} points"),
        ));
    }

    fn set_geometry(&mut self, number: usize, geometry: PerAxis<f64>) {
        match number.checked_sub(1).filter(|index| *index < TOOL_OFFSET_COUNT) {
            Some(_) if self.run.is_some() => self.refuse(NOT_IN_RUN),
            Some(index) => {
                self.work_offsets.geometry[index] = geometry;
                self.storage_requests.push(StorageRequest::Offset {
                    number,
                    geometry,
                    wear: self.work_offsets.wear[index],
                });
            }
            None => self.refuse(LocalizedText::new("刀补号应为 1-16", "offsets are numbered 1 to 16")),
        }
    }

    /// Sets a common variable. False: refused, with the reason shown.
    pub(super) fn set_variable(&mut self, variable: u16, value: Option<f64>) -> bool {
        let number = u32::from(variable);
        if let Err(error) = self.store_variable(number, value) {
            let name = variable_name::variable_name_on(number, self.kind);
            let zh = match error {
                VariableError::Unknown(_) => format!("{name} 不存在或不能修改"),
                VariableError::Switch(_) => format!("{name} 只能输入 0 或 1"),
                VariableError::NotFinite(_) => format!("{name} 的值不是数字"),
            };
            self.refuse(LocalizedText::new(zh, error.to_string()));
            return false;
        }
        if let Some(run) = &mut self.run
            && run.interpreter.update_variable(number, value).is_err()
        {
            self.refuse(LocalizedText::new("程序没有接受此值", "the running program did not take the value"));
            return false;
        }
        true
    }

    pub(super) fn load_program(&mut self, number: u32) {
        if self.run.is_some() {
            return self.refuse(NOT_IN_RUN);
        }
        if self.programs.get(number).is_none() {
            // For a named program only the number is known.
            let title = if program_number::is_named(number) { String::new() } else { program_number::name_of(number) };
            return self.refuse(match title.as_str() {
                "" => LocalizedText::new("程序目录中没有这个程序", "the programs folder has no such program"),
                title => {
                    LocalizedText::new(format!("程序目录中没有 {title}"), format!("the programs folder has no {title}"))
                }
            });
        }
        self.current_program = number;
        self.restart = None;
        self.current_block = crate::nc::BlockLocation::default();
        self.storage_requests.push(StorageRequest::CurrentProgram(number));
        self.check_page_files();
        let title = self.program_title(number);
        self.show_note(LocalizedText::new(format!("当前程序 {title}"), format!("current program {title}")));
    }

    /// The title of a program.
    pub(super) fn program_title(&self, number: u32) -> String {
        self.programs.get(number).map_or_else(|| program_number::name_of(number), |program| program.source.title())
    }

    pub(super) fn run_mdi(&mut self, line: &str) {
        if self.mode != Mode::Mdi {
            return self.refuse(LocalizedText::new("录入方式下才能执行", "MDI lines work in mode MDI"));
        }
        if !matches!(self.phase, super::ControlPhase::Idle) {
            return self.refuse(NOT_IN_RUN);
        }
        if line.chars().count() > MAX_MDI_CHARS {
            return self.refuse(LocalizedText::new("录入行太长", "the MDI line is too long"));
        }
        if let Some(why) = self.retract_blocks_start() {
            return self.refuse(why);
        }
        if matches!(self.request(Request::MdiStart), RequestResult::Accepted) {
            let source = std::sync::Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec(), self.kind_row.dialect));
            self.open_run(source, super::run::Origin::Mdi);
        }
    }
}

/// Whether a command changes data on which a prepared program restart is based (B5).
const fn invalidates_restart(command: &Command) -> bool {
    matches!(
        command,
        Command::EnterVariable(..)
            | Command::Offset(_)
            | Command::AddWear { .. }
            | Command::ChangeWheel { .. }
            | Command::SetVariable(..)
            | Command::SetParam(..)
            | Command::SetWorkOffset(..)
            | Command::SetGeometry(..)
            | Command::Page(PageCommand::EditParam(..))
    )
}
