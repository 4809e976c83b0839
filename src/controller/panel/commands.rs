//! Commands from the operator, a story or the disk, and why they are refused.
//! Source: spec B6, K7.5, K7.7.

use super::{Panel, Parts, offsets};
use crate::controller::manual::turn_handwheel;
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::ParamAddress;
use crate::defs::program_number;
use crate::defs::text::{Text, phrase};
use crate::link::PageCommand;
use crate::link::command::Command;
use crate::link::files::{Requester, Ticket};
use crate::link::part_result::PartCommand;
use crate::link::snapshot::Tone;
use crate::link::teach::TeachCommand;
use crate::link::wheels::WheelCommand;
use crate::machine::panel_key::NOT_IN_RUN;
use crate::nc::OriginPlace;
use crate::nc::work_offsets::TOOL_OFFSET_COUNT;
use crate::units::{Axis, PerAxis};

const PARAMS_IN_RUN: Text = Text::new("运行中不能修改参数", "parameters cannot be changed while a program runs");
const DATA_CHANGED: Text = Text::new("数据已修改，请重新选择起始段", "data were changed: choose the block again");

impl Panel {
    /// Executes one command.
    pub fn handle_command(&mut self, parts: &mut Parts<'_>, command: &Command) {
        if parts.program.restart.is_some() && invalidates_restart(command) {
            parts.program.abandon_restart();
            parts.plant.show_note(DATA_CHANGED);
        }
        match command {
            Command::Press(key) => self.press_key(parts, *key),
            Command::EmergencyStop(pressed) => parts.plant.inputs.set_screen_e_stop(*pressed),
            Command::Release(key) => {
                if let Some((axis, _)) = key.jog_direction() {
                    parts.plant.jog.release_jog_key(axis);
                }
            }
            Command::StillHeld(key) => parts.plant.jog.keep_alive(*key, parts.plant.now),
            Command::Handwheel(detents) => turn_handwheel(parts.plant, parts.program, *detents),
            Command::OpenPage(page) => self.open_page(parts, *page),
            Command::ShowCoordinates(coordinates) => self.show_coordinates(parts, *coordinates),
            Command::ShowSoftKeyRow(row) => self.show_soft_row(*row),
            Command::ShowGrindingSheet(sheet) => self.show_sheet(parts, *sheet),
            Command::LoadProgram(number) => self.load_program(parts, *number),
            Command::RestartAt(line) => parts.program.restart_at(parts.plant, *line),
            Command::ResumeInterrupted => self.resume_interrupted(parts),
            Command::Mdi(line) => parts.program.run_mdi(parts.plant, line),
            Command::EnterVariable(..) | Command::Offset(_) | Command::AddWear { .. } | Command::Part(_) => {
                self.handle_edit(parts, command)
            }
            Command::ProposeOrder(proposal) => self.propose_order(parts, *proposal),
            Command::ChangeWheel { .. } | Command::Wheel(_) | Command::PrepareMdi(_) | Command::Order(_) => {
                self.handle_edit(parts, command)
            }
            Command::PartInspected(found) => self.production.inspect(parts.plant, *found),
            Command::Page(PageCommand::EditParam(..) | PageCommand::EditLeadscrew(..)) => {
                self.handle_edit(parts, command)
            }
            Command::SetVariable(variable, value) => {
                parts.program.set_variable(parts.plant, *variable, *value);
            }
            Command::SetParam(at, value) => Self::set_param(parts, *at, *value),
            Command::SetWorkOffset(index, origin) => Self::set_work_offset(parts, *index, *origin),
            Command::SetGeometry(number, geometry) => Self::set_geometry(parts, *number, *geometry),
            &Command::SetCutter(number, radius_mm, tip) => offsets::preset_cutter(parts, number, radius_mm, tip),
            Command::PartMounted => Self::tell_part_mounted(parts),
            Command::SetStock(stock) => self.files.stock.clone_from(stock),
            Command::SetLeadscrew(axis, table) => Self::set_leadscrew_table(parts, *axis, table),
            Command::ClearRelative(axis) => self.relative_zero[*axis] = parts.plant.axes.actual()[*axis],
            Command::ScreensLoaded(screens) => {
                self.screens.clone_from(screens);
                self.check_page_files(parts);
            }
            Command::Stored(mark) => parts.plant.outbox.unstored.stored(*mark),
            Command::Simulate(_) | Command::ClearBusCounters => {}
            Command::DiskFailed(why) => parts.plant.raise(alarm::STORE_FAILED, Some(why.clone())),
            Command::Page(command) => self.handle_page_command(parts, command),
            Command::Teach(command) => self.handle_teach_command(parts, *command),
            Command::WallClock(told) => self.take_clock(parts, *told),
            // The host ends its story.
            Command::TakeOver => {}
            Command::KeepAlive => parts.plant.operator.screen_alive_at = Some(parts.plant.now),
        }
    }

    fn handle_teach_command(&mut self, parts: &mut Parts<'_>, command: TeachCommand) {
        let run_open = parts.program.is_open();
        if let Some(request) = parts.manual.teach.command(parts.plant, run_open, command) {
            self.handle_file_request(parts, Ticket::without_reply(Requester::Teach), &request);
        }
    }

    /// Changes a parameter. Refused while a run is open.
    pub fn set_param(parts: &mut Parts<'_>, at: ParamAddress, value: f64) {
        if parts.program.is_open() {
            return parts.plant.refuse(PARAMS_IN_RUN);
        }
        match parts.plant.change_param(at, value) {
            Ok(()) => parts.plant.show_note(phrase!("{at} = {value}", "{at} = {value}", at, value)),
            Err(why) => parts.plant.refuse(why),
        }
    }

    fn set_work_offset(parts: &mut Parts<'_>, index: usize, origin: PerAxis<f64>) {
        match OriginPlace::of_stored_index(index) {
            Some(_) if parts.program.is_open() => parts.plant.refuse(NOT_IN_RUN),
            Some(place) => {
                parts.plant.work.offsets.set_origin(place, origin);
                parts.plant.store_origin(place);
            }
            None => parts.plant.refuse(phrase!("没有此工件坐标系", "there is no such work offset")),
        }
    }

    /// Replaces the leadscrew table of an axis; the correction is applied by a ramp. Refused while a run is open.
    pub fn set_leadscrew_table(parts: &mut Parts<'_>, axis: Axis, table: &LeadscrewCompensation) {
        if parts.program.is_open() {
            return parts.plant.refuse(NOT_IN_RUN);
        }
        parts.plant.axes.set_leadscrew_table(axis, table.clone());
        parts.plant.store(StorageRequest::LeadscrewTable(axis, table.clone()));
        let points = table.points().len();
        let note =
            phrase!("{axis} 轴丝杠补偿表：{points} 点", "screw table of axis {axis}: {points} points", axis, points);
        parts.plant.show_note(note);
    }

    /// The simulated machine has mounted the part of the current program: the work coordinates may have jumped.
    fn tell_part_mounted(parts: &mut Parts<'_>) {
        let title = parts.plant.program_title(parts.plant.execution.current_program);
        parts.plant.show_note(phrase!(
            "当前程序 {title}；已装其工件，工件坐标已按其设置",
            "current program {title}; its part is mounted, the work coordinates are set for it",
            title
        ));
    }

    fn set_geometry(parts: &mut Parts<'_>, number: usize, geometry: PerAxis<f64>) {
        match number.checked_sub(1).filter(|index| *index < TOOL_OFFSET_COUNT) {
            Some(_) if parts.program.is_open() => parts.plant.refuse(NOT_IN_RUN),
            Some(index) => {
                parts.plant.work.offsets.geometry[index] = geometry;
                parts.plant.store_offset(index);
            }
            None => parts.plant.refuse(phrase!("刀补号应为 1-16", "tool offset numbers are 1 to 16")),
        }
    }

    /// Makes a program of the folder the current one.
    pub fn load_program(&mut self, parts: &mut Parts<'_>, number: u32) {
        if parts.program.is_open() {
            return parts.plant.refuse(NOT_IN_RUN);
        }
        if parts.plant.work.programs.get(number).is_none() {
            // For a named program only the number is known.
            let title = if program_number::is_named(number) { String::new() } else { program_number::name_of(number) };
            return parts.plant.refuse(match title.as_str() {
                "" => phrase!("程序目录中没有这个程序", "the program is not in the programs folder"),
                title => {
                    phrase!("程序目录中没有 {title}", "{title} is not in the programs folder", title)
                }
            });
        }
        parts.program.abandon_restart();
        parts.plant.set_current_program(number);
        self.check_page_files(parts);
        let title = parts.plant.program_title(number);
        let kind = parts.plant.kind;
        let is_for = self.directory.iter().find(|row| row.number == number).is_none_or(|row| row.is_for(kind));
        if is_for {
            parts.plant.show_note(phrase!("当前程序 {title}", "current program {title}", title));
        } else {
            let words = phrase!(
                "当前程序 {title}：不是本机 {own} 的程序",
                "current program {title}: it is not for this machine, {own}",
                title,
                own = kind.short_name()
            );
            parts.plant.show(words, Tone::Warning);
        }
    }

    /// Resumes the run that a power failure interrupted.
    pub fn resume_interrupted(&mut self, parts: &mut Parts<'_>) {
        let Some((program, line)) = parts.program.power_cut.interrupted else {
            return parts.plant.refuse(phrase!("没有断电中断的程序", "no program was interrupted by a power failure"));
        };
        if parts.plant.execution.current_program != program {
            self.load_program(parts, program);
        }
        if parts.plant.execution.current_program == program {
            parts.program.restart_at(parts.plant, line);
        }
    }
}

/// Whether a command forbids every start of its tick: whoever stops the machine must not see it start.
pub fn voids_starts(command: &Command) -> bool {
    matches!(command, Command::Press(Key::Reset | Key::EmergencyStop) | Command::EmergencyStop(true))
}

/// Whether a command changes data on which a prepared program restart is based (B5).
const fn invalidates_restart(command: &Command) -> bool {
    matches!(
        command,
        Command::EnterVariable(..)
            | Command::Offset(_)
            | Command::AddWear { .. }
            | Command::Part(PartCommand::Correct { .. })
            | Command::ChangeWheel { .. }
            | Command::Wheel(WheelCommand::Mount(_))
            | Command::SetVariable(..)
            | Command::SetParam(..)
            | Command::SetWorkOffset(..)
            | Command::SetGeometry(..)
            | Command::SetCutter(..)
            | Command::Page(PageCommand::EditParam(..))
    )
}
