//! Commands from the operator, a story or the disk, and why they are refused.
//! Source: spec B6, K7.5, K7.7.

use super::{Controller, Effect};
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::mcode::Request;
use crate::defs::program;
use crate::defs::r_parameter;
use crate::defs::screw::ScrewTable;
use crate::defs::text::Said;
use crate::link::PageCommand;
use crate::link::command::Command;
use crate::machine::Answer;
use crate::machine::press::NOT_IN_RUN;
use crate::nc::frames::OFFSETS;
use crate::nc::{Source, VariableError};
use crate::units::{Axis, PerAxis};

/// Maximum characters of an MDI line.
pub(super) const MDI_MOST: usize = 500;

impl Controller {
    /// Executes one command.
    pub(super) fn take(&mut self, command: &Command) {
        if self.restart.is_some() && changes_data(command) {
            self.restart = None;
            self.say(Said::new("数据已修改，请重新选择起始段", "data were changed: choose the block again"));
        }
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
            Command::ShowCoordinates(coordinates) => self.show_coordinates(*coordinates),
            Command::TurnSoftRow(row) => self.turn_soft_row(*row),
            Command::TurnSheet(sheet) => self.turn_sheet(*sheet),
            Command::LoadProgram(number) => self.load_program(*number),
            Command::RestartAt(line) => self.restart_at(*line),
            Command::ResumeInterrupted => self.resume_interrupted(),
            Command::Mdi(line) => self.mdi(line),
            Command::TypeVariable(..)
            | Command::Offset(_)
            | Command::AddWear { .. }
            | Command::ChangeWheel { .. }
            | Command::ReadyMdi(_)
            | Command::Page(PageCommand::EditParam(..) | PageCommand::EditScrew(..)) => self.take_edit(command),
            Command::SetVariable(variable, value) => {
                self.set_variable(*variable, *value);
            }
            Command::SetParam(at, value) => self.set_param(*at, *value),
            Command::SetFrame(index, origin) => self.set_frame(*index, *origin),
            Command::SetGeometry(number, geometry) => self.set_geometry(*number, *geometry),
            Command::SetStock(stock) => self.files.stock.clone_from(stock),
            Command::SetScrew(axis, table) => self.set_screw(*axis, table),
            Command::ClearRelative(axis) => self.relative_zero[*axis] = self.axes.actual()[*axis],
            Command::Screens(screens) => {
                self.screens.clone_from(screens);
                self.check_page_files();
            }
            Command::Stored(_) | Command::Simulate(_) => {}
            Command::DiskFailed(why) => self.raise(alarm::STORE_FAILED, Some(why.clone())),
            Command::Page(command) => self.take_page(command),
            Command::Teach(command) => self.take_teach(*command),
            Command::Calendar(told) => {
                if let Some(power_on) = self.calendar.hear(self.now, *told) {
                    self.alarms.know_power_on(power_on);
                }
            }
            Command::Alive => self.screen_heard = Some(self.now),
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

    /// Replaces the leadscrew table of an axis; the correction is applied by a ramp. Refused while a run is open.
    pub(super) fn set_screw(&mut self, axis: Axis, table: &ScrewTable) {
        if self.run.is_some() {
            return self.refuse(NOT_IN_RUN);
        }
        self.axes.set_screw(axis, table.clone());
        self.effects.push(Effect::Screw(axis, table.clone()));
        let points = table.points().len();
        self.say(Said::new(
            format!("{axis} 轴丝杠补偿表：{points} 点"),
            format!("screw table of axis {axis}: {points} points"),
        ));
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

    /// Sets a common variable. False: refused, with the reason shown.
    pub(super) fn set_variable(&mut self, variable: u16, value: Option<f64>) -> bool {
        let number = u32::from(variable);
        if let Err(error) = self.store_variable(number, value) {
            let name = r_parameter::name_on(number, self.kind);
            let zh = match error {
                VariableError::Unknown(_) => format!("{name} 不存在或不能修改"),
                VariableError::Switch(_) => format!("{name} 只能输入 0 或 1"),
                VariableError::NotFinite(_) => format!("{name} 的值不是数字"),
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

    pub(super) fn load_program(&mut self, number: u32) {
        if self.run.is_some() {
            return self.refuse(NOT_IN_RUN);
        }
        if self.programs.get(number).is_none() {
            // For a named program only the number is known.
            let title = if program::is_named(number) { String::new() } else { program::title(number) };
            return self.refuse(match title.as_str() {
                "" => Said::new("程序目录中没有这个程序", "the programs folder has no such program"),
                title => Said::new(format!("程序目录中没有 {title}"), format!("the programs folder has no {title}")),
            });
        }
        self.current = number;
        self.restart = None;
        self.place = crate::nc::Place::default();
        self.effects.push(Effect::CurrentProgram(number));
        self.check_page_files();
        let title = self.title(number);
        self.say(Said::new(format!("当前程序 {title}"), format!("current program {title}")));
    }

    /// The title of a program.
    pub(super) fn title(&self, number: u32) -> String {
        self.programs.get(number).map_or_else(|| program::title(number), |program| program.source.title())
    }

    pub(super) fn mdi(&mut self, line: &str) {
        if self.mode != Mode::Mdi {
            return self.refuse(Said::new("录入方式下才能执行", "MDI lines work in mode MDI"));
        }
        if !matches!(self.phase, super::Phase::Idle) {
            return self.refuse(NOT_IN_RUN);
        }
        if line.chars().count() > MDI_MOST {
            return self.refuse(Said::new("录入行太长", "the MDI line is too long"));
        }
        if let Some(why) = self.retract_forbids_start() {
            return self.refuse(why);
        }
        if matches!(self.ask(Request::MdiStart), Answer::Taken) {
            let source = std::sync::Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec()));
            self.open_run(source, super::run::Origin::Mdi);
        }
    }
}

/// Whether a command changes data on which a prepared program restart is based (B5).
const fn changes_data(command: &Command) -> bool {
    matches!(
        command,
        Command::TypeVariable(..)
            | Command::Offset(_)
            | Command::AddWear { .. }
            | Command::ChangeWheel { .. }
            | Command::SetVariable(..)
            | Command::SetParam(..)
            | Command::SetFrame(..)
            | Command::SetGeometry(..)
            | Command::Page(PageCommand::EditParam(..))
    )
}
