//! Values typed on pages: accepted, or refused with a reason. The page gets an answer either way (H6).
//! Source: spec K7.5, K7.7.

use std::sync::Arc;

use super::Controller;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::link::PageCommand;
use crate::link::command::Command;
use crate::link::edit::{EditAnswer, OffsetView};
use crate::link::snapshot::{Message, Snapshot, Tone};
use crate::nc::CommonVariables;
use crate::units::PerAxis;

const LOCKED: Text = Text::new("P22.0=0：不允许修改", "P22.0 is 0: locked");
const NOT_IN_RUN: Text = Text::new("程序运行中不能修改 (P6.3)", "not while a program runs (P6.3)");

/// State of the edits made on pages.
#[derive(Clone, Debug)]
pub struct EditState {
    /// Answer to the last edit.
    answer: EditAnswer,
    /// The MDI line that waits for cycle start; empty if none.
    pub mdi_ready: Arc<str>,
}

impl Default for EditState {
    fn default() -> Self {
        Self { answer: EditAnswer::default(), mdi_ready: Arc::from("") }
    }
}

impl Controller {
    /// Executes an edit of a page and answers it.
    pub(super) fn handle_edit(&mut self, command: &Command) {
        let done = match command {
            Command::EnterVariable(variable, value) => self.edit_variable(*variable, *value),
            Command::Offset(command) => self.handle_offset_command(*command),
            Command::AddWear { number, axis, increment: by } => self.edit_wear_increment(*number, *axis, *by),
            Command::ChangeWheel { diameter_mm, width_mm, rated_m_s } => {
                self.change_wheel(*diameter_mm, *width_mm, *rated_m_s)
            }
            Command::PrepareMdi(line) => self.prepare_mdi(line),
            Command::Page(command) => self.edit_param_on_page(command),
            _ => return,
        };
        self.edits.answer.count = self.edits.answer.count.wrapping_add(1);
        self.edits.answer.refused = done.as_ref().err().cloned();
        match done {
            Ok(said) => self.show_note(said),
            Err(why) => self.refuse(why),
        }
    }

    /// A value typed on the open page for one of the page's variables (K7.5, K7.7).
    fn edit_variable(&mut self, variable: u16, value: Option<f64>) -> Result<LocalizedText, LocalizedText> {
        let name = crate::defs::variable_name::variable_name_on(u32::from(variable), self.kind);
        let shows = match self.page {
            Page::Grinding => self.page_shows(variable),
            Page::Macro => CommonVariables::contains(u32::from(variable)),
            _ => false,
        };
        if !shows {
            return Err(if self.page == Page::Macro {
                LocalizedText::new(format!("{name} 是只读变量"), format!("{name} is read-only"))
            } else {
                LocalizedText::new(format!("当前页面没有 {name}"), format!("the open page does not show {name}"))
            });
        }
        if self.page == Page::Macro {
            self.check_unlocked()?;
        }
        self.check_not_running()?;
        if !self.set_variable(variable, value) {
            // The reason is already shown.
            return Err(self.message.text.clone());
        }
        let shown = value.map_or_else(String::new, |value| format!("{value:.3}"));
        Ok(LocalizedText::new(format!("{name} = {shown}"), format!("{name} = {shown}")))
    }

    /// A parameter typed on its page. The result is taken from the message that the command has shown.
    fn edit_param_on_page(&mut self, command: &PageCommand) -> Result<LocalizedText, LocalizedText> {
        self.message = Message::default();
        self.handle_page_command(command);
        let text = self.message.text.clone();
        match self.message.tone {
            Tone::Info => Ok(text),
            Tone::Refused => Err(text),
        }
    }

    /// K7.7: protection (P22.0) of wear and variables on the offset and the macro page.
    pub(super) fn check_unlocked(&self) -> Result<(), LocalizedText> {
        if self.params.bit(param::EDIT_OFFSETS) { Ok(()) } else { Err(LOCKED.into()) }
    }

    /// K7.7: no edit while a run is open, unless P6.3 allows it.
    pub(super) fn check_not_running(&self) -> Result<(), LocalizedText> {
        if self.run.is_none() || self.params.bit(param::EDIT_VALUES_IN_RUN) { Ok(()) } else { Err(NOT_IN_RUN.into()) }
    }

    /// Writes the snapshot fields of the offset, variable and MDI pages.
    pub(super) fn edit_view(&self, out: &mut Snapshot) {
        if out.edit_answer != self.edits.answer {
            out.edit_answer.clone_from(&self.edits.answer);
        }
        if out.prepared_mdi != self.edits.mdi_ready {
            out.prepared_mdi.clone_from(&self.edits.mdi_ready);
        }
        for (index, row) in out.offsets.iter_mut().enumerate() {
            *row = OffsetView {
                geometry: self.displayed(&self.work_offsets.geometry[index]),
                wear: self.displayed(&self.work_offsets.wear[index]),
            };
        }
        out.active_offset = self.work_offsets.tool_offset;
        out.modals = self.modal_view();
        let points = self.dressing.points;
        out.dressing_point = PerAxis::from_fn(|axis| points[axis].map(|at| at * self.displayed_per_mm(axis)));
    }
}
