//! Values typed on pages: accepted, or refused with a reason. The page gets an answer either way (H6).
//! Source: spec K7.5, K7.7.

use super::edit_protection::{check_not_running, check_unlocked};
use super::{Edited, Panel, Parts, PartsView, offsets};
use crate::defs::page::Page;
use crate::defs::text::arg::Arg;
use crate::defs::text::phrase;
use crate::defs::value_bound::TYPED_VALUE_LIMIT;
use crate::link::PageCommand;
use crate::link::command::Command;
use crate::link::edit::OffsetView;
use crate::link::snapshot::{Message, Snapshot, Tone};
use crate::nc::{CommonVariables, OriginPlace};
use crate::units::PerAxis;

impl Panel {
    /// Executes an edit of a page and answers it.
    pub fn handle_edit(&mut self, parts: &mut Parts<'_>, command: &Command) {
        let done = match command {
            Command::EnterVariable(variable, value) => self.edit_variable(parts, *variable, *value),
            Command::Offset(command) => offsets::handle_offset_command(parts, *command),
            &Command::AddWear { number, axis, increment } => {
                offsets::edit_wear_increment(parts, number, axis, increment)
            }
            &Command::Part(command) => self.handle_part_command(parts, command),
            &Command::Order(command) => self.handle_order_command(parts, command),
            &Command::ChangeWheel { diameter_mm, width_mm, rated_m_s } => {
                self.change_wheel(parts, [diameter_mm, width_mm, rated_m_s])
            }
            &Command::Wheel(command) => self.handle_wheel_command(parts, command),
            Command::PrepareMdi(line) => parts.program.prepare_mdi(parts.plant, line),
            Command::Page(command) => self.edit_param_on_page(parts, command),
            _ => return,
        };
        self.edit_answer.count = self.edit_answer.count.wrapping_add(1);
        self.edit_answer.refused = done.as_ref().err().cloned();
        match done {
            Ok(message) => parts.plant.show_note(message),
            Err(why) => parts.plant.refuse(why),
        }
    }

    /// A value typed on the open page for one of the page's variables (K7.5, K7.7).
    fn edit_variable(&mut self, parts: &mut Parts<'_>, variable: u16, value: Option<f64>) -> Edited {
        let name = Arg::Variable(u32::from(variable), parts.plant.kind.dialect());
        let shows = match parts.plant.operator.page {
            Page::Grinding | Page::Technology => self.page_shows(parts.view(), variable),
            Page::Macro => CommonVariables::contains(u32::from(variable)),
            _ => false,
        };
        match (shows, parts.plant.operator.page) {
            (false, Page::Macro) => return Err(phrase!("{name} 是只读变量", "{name} is read-only", name)),
            (false, _) => return Err(phrase!("当前页面没有 {name}", "the open page does not show {name}", name)),
            (true, Page::Macro) => check_unlocked(parts.view())?,
            (true, _) => {}
        }
        check_not_running(parts.view())?;
        self.check_typed_size(parts.plant, variable)?;
        if value.is_some_and(|value| value.is_nan() || value.abs() > TYPED_VALUE_LIMIT) {
            return Err(phrase!("应为 ±{TYPED_VALUE_LIMIT}", "must be ±{TYPED_VALUE_LIMIT}", TYPED_VALUE_LIMIT));
        }
        if !parts.program.set_variable(parts.plant, variable, value) {
            // The reason is already shown.
            return Err(parts.plant.outbox.message.text.clone());
        }
        if let Some(mm) = value.filter(|_| !parts.program.is_open()) {
            self.judge_by_page(parts.plant, variable, mm);
        }
        Ok(match value {
            Some(value) if self.point_by_key_counts(parts.view(), variable) => phrase!(
                "{name} = {value:.3}，未用：按键设置的修整点有效",
                "{name} = {value:.3}, unused: the dressing point set by key counts",
                name,
                value
            ),
            Some(value) if parts.program.is_open() => phrase!(
                "{name} = {value:.3}，从下一个读入的段起有效，已预读的段不变",
                "{name} = {value:.3}, acts from the next block read; blocks read ahead keep the old value",
                name,
                value
            ),
            Some(value) => phrase!("{name} = {value:.3}", "{name} = {value:.3}", name, value),
            None => phrase!("{name} = ", "{name} = ", name),
        })
    }

    /// A parameter typed on its page. The result is taken from the message that the command has shown.
    fn edit_param_on_page(&mut self, parts: &mut Parts<'_>, command: &PageCommand) -> Edited {
        parts.plant.outbox.message = Message::default();
        self.handle_page_command(parts, command);
        let text = parts.plant.outbox.message.text.clone();
        match parts.plant.outbox.message.tone {
            Tone::Info | Tone::Warning => Ok(text),
            Tone::Refused => Err(text),
        }
    }

    /// Writes the snapshot fields of the offset, variable and MDI pages.
    pub fn edit_view(&self, parts: PartsView<'_>, out: &mut Snapshot) {
        if out.edit_answer != self.edit_answer {
            out.edit_answer.clone_from(&self.edit_answer);
        }
        let waiting = parts.program.mdi.waiting_text();
        if out.prepared_mdi != waiting {
            waiting.clone_into(&mut out.prepared_mdi);
        }
        for (index, row) in out.offsets.tools.iter_mut().enumerate() {
            *row = OffsetView {
                geometry: parts.plant.displayed(parts.plant.work.offsets.geometry[index]),
                wear: parts.plant.displayed(parts.plant.work.offsets.wear[index]),
                radius_mm: parts.plant.work.offsets.cutter[index].radius_mm,
                tip: parts.plant.work.offsets.cutter[index].tip,
            };
        }
        for (row, origin) in out.offsets.origins.iter_mut().enumerate() {
            if let Some(place) = OriginPlace::at(row) {
                *origin = parts.plant.displayed(parts.plant.work.offsets.origin(place));
            }
        }
        out.offsets.active_origin = OriginPlace::of_active(&parts.plant.work.offsets).map(OriginPlace::index);
        out.offsets.active_tool = parts.plant.work.offsets.tool_offset;
        out.modals = parts.program.modal_view(parts.plant);
        let points = parts.plant.work.dress_points;
        out.dressing_point = PerAxis::from_fn(|axis| points[axis].map(|at| at * parts.plant.displayed_per_mm(axis)));
    }
}
