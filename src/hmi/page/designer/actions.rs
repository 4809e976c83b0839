//! Actions of the keys of the page designer, and the list of variables that the page lacks.
//! Source: spec K7.3, K7.4, K6.2.

use egui::Rect;

use super::{DesignerPage, DesignerQuestion, DesignerTab};
use crate::defs::page::Page;
use crate::defs::page_text::{COLUMN_ROWS, VariableUse};
use crate::defs::text::{Lang, Text, phrase};
use crate::defs::variable_name;
use crate::hmi::page::program::actions::{EDIT_FIRST, NOTHING_TO_SAVE};
use crate::hmi::widget::{self, page_keys};
use crate::hmi::{Area, PageKey, View, requests};
use crate::link::Command;
use crate::link::screens::ScreenFiles;

page_keys! {
    /// Action of a key.
    DesignerAction {
        Edit = "page-edit", "编辑", "EDIT";
        Keyboard = "page-board", "键盘", "KEYS";
        Undo = "page-undo", "撤销", "UNDO";
        Redo = "page-redo", "重做", "REDO";
        Save = "page-save", "保存", "SAVE";
        Discard = "page-discard", "放弃", "DISCARD";
        End = "page-end", "结束", "END";
        /// Shows the English text of the page, or the page text again.
        SwitchText = "page-language", "英文", "ENGLISH";
        /// Opens the grinding page.
        OpenGrinding = "page-show", "磨削页面", "GRINDING";
    }
}

use DesignerAction::{Discard, Edit, End, Keyboard, OpenGrinding, Redo, Save, SwitchText, Undo};

const VIEWING: &[DesignerAction] = &[Edit, SwitchText, OpenGrinding];
const EDITING: &[DesignerAction] = &[Keyboard, Undo, Redo, Save, Discard, End];

/// Action of a keyboard key with Ctrl, as on the program page.
pub const fn from_shortcut(key: egui::Key) -> Option<DesignerAction> {
    Some(match key {
        egui::Key::S => Save,
        egui::Key::Z => Undo,
        egui::Key::Y => Redo,
        egui::Key::E => Edit,
        _ => return None,
    })
}

/// Draws the keys; returns the pressed one.
pub fn ui(view: &View<'_>, rect: Rect, page: &mut DesignerPage) -> Option<DesignerAction> {
    let actions = if page.editing { EDITING } else { VIEWING };
    let (undo, redo) = page.document.can_undo_redo();
    let row = rect.band(0.0, widget::KEYS_HEIGHT - 2.0);
    let mut pressed = None;
    for (index, action) in actions.iter().enumerate() {
        let on = (*action == Keyboard && page.keyboard_open)
            || (*action == Save && page.document.changed)
            || (*action == SwitchText && page.lang == Lang::En);
        let locked = (*action == Undo && !undo) || (*action == Redo && !redo);
        let key = PageKey::new(action.id(), action.label().get(view.lang)).on(on).locked(locked);
        if page.key(view, row.cell(index, EDITING.len()), key) {
            pressed = Some(*action);
        }
    }
    pressed
}

/// A variable in the list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VariableRow {
    pub variable: u16,
    pub reads: bool,
    pub writes: bool,
    /// Program and line of its first use.
    pub place: Option<(u32, u32)>,
    /// The comment beside its first use.
    pub comment: String,
    /// Its label on the page.
    pub label: Option<String>,
    /// Another page that shows it.
    pub elsewhere: Option<u32>,
    /// It is read, never written, and on no page. A variable read by the program itself must be on its own page; one
    /// read by a called program may be on another page.
    pub missing: bool,
}

impl DesignerPage {
    /// Variables of program and page: missing ones first, internal ones of the program last.
    pub(super) fn variables(&self, view: &View<'_>) -> Vec<VariableRow> {
        let uses = self.file.as_ref().and_then(|file| file.uses.as_deref()).unwrap_or_default();
        let label =
            |variable: u16| self.reading.page.rows().find(|row| row.variable == variable).map(|row| row.label.clone());
        let number = self.document.number;
        let offers = |variable: u16| {
            let of_page = |(other, files): &&(u32, ScreenFiles)| {
                let text = files.text.as_ref().ok().filter(|_| *other != number);
                text.is_some_and(|text| text.rows().any(|row| row.variable == variable))
            };
            view.snapshot.screens.pages.iter().find(of_page).map(|(other, _)| *other)
        };
        let row = |used: &VariableUse| {
            let (label, elsewhere) = (label(used.variable), offers(used.variable).filter(|_| used.place.0 != number));
            let VariableUse { variable, reads, writes, place, comment } = used.clone();
            let missing = reads && !writes && label.is_none() && elsewhere.is_none();
            VariableRow { variable, reads, writes, place: Some(place), comment, label, elsewhere, missing }
        };
        let mut rows: Vec<_> = uses.iter().map(row).collect();
        for row in self.reading.page.rows() {
            if rows.iter().all(|known| known.variable != row.variable) {
                let label = Some(row.label.clone());
                rows.push(VariableRow { variable: row.variable, label, ..VariableRow::default() });
            }
        }
        rows.sort_by_key(|row| (!row.missing, row.label.is_none(), row.variable));
        rows
    }

    pub(super) fn perform(&mut self, action: DesignerAction, view: &View<'_>, out: &mut Vec<Command>) {
        self.message.clear();
        if !self.editing && !matches!(action, Edit | SwitchText | OpenGrinding) {
            return self.message.refuse(EDIT_FIRST);
        }
        match action {
            Edit => self.request_edit(view, out),
            Keyboard => self.keyboard_open = !self.keyboard_open,
            Undo => self.document.undo(),
            Redo => self.document.redo(),
            Save if !self.document.changed => self.message.tell(NOTHING_TO_SAVE),
            Save => self.save(false, out),
            Discard if self.document.changed => {
                let name = self.file.as_ref().map_or("", |file| file.name.as_str());
                self.question.ask(DesignerQuestion::Discard, requests::discard_question(name));
            }
            Discard | End => (self.editing, self.keyboard_open, self.keys_focused) = (false, false, false),
            SwitchText => self.switch_text(),
            OpenGrinding => out.push(Command::OpenPage(Page::Grinding)),
        }
    }

    /// Adds a page entry for a variable: in the first empty entry, else before the `%`.
    pub(super) fn add_variable(&mut self, view: &View<'_>, row: &VariableRow) {
        if !self.editing {
            return self.message.refuse(EDIT_FIRST);
        }
        let name = variable_name::variable_name_on(u32::from(row.variable), view.snapshot.kind);
        let label: String = row.comment.chars().filter(|sign| !";#%；＃％".contains(*sign)).take(16).collect();
        let label = if label.trim().is_empty() { view.text("参数", "value") } else { label.trim() }.to_owned();
        let beyond = self.chosen_entry().filter(|index| *index >= self.reading.entry_positions.len());
        if let Some(index) = beyond {
            self.write_entries(&[(index, format!("{label} {name}"))]);
            return self.message.tell(phrase!("已加入 {name}，请改名称", "{name} added: edit its name", name));
        }
        let page = &self.reading.page;
        let slots = page.left.iter().chain(&page.right);
        let faulty = |line: u32| self.reading.faults.iter().any(|fault| fault.line == line);
        let free = slots.zip(&self.reading.entry_positions).enumerate();
        let free = free.filter(|(_, (slot, (line, _)))| slot.is_none() && !faulty(*line));
        // The chosen place comes first.
        let chosen = self.chosen_entry();
        let free = free.min_by_key(|(index, _)| Some(*index) != chosen).map(|(_, free)| free);
        let at = match (free, self.reading.end) {
            (Some((_, (line, column))), _) => Ok((*line, *column, format!("{label} {name}"))),
            (None, Some((line, column))) if self.reading.entry_positions.len() < 2 * COLUMN_ROWS => {
                Ok((line, column, format!("{label} {name};{}", self.document.line_end())))
            }
            (None, Some(_)) => Err(phrase!("页面已满：左右各十项", "the page is full: ten in each column")),
            (None, None) => Err(phrase!("先改正错误：缺少 %", "correct the errors first: the % is missing")),
        };
        match at {
            Ok((line, column, text)) => {
                self.document.move_to(line as usize - 1, column as usize - 1);
                let at = self.document.cursor;
                self.document.replace(at, at, &text);
                self.position.scroll.user_scrolled = false;
                self.message.tell(phrase!("已加入 {name}，请改名称", "{name} added: edit its name", name));
                self.tab = DesignerTab::Variables;
            }
            Err(why) => self.message.refuse(why),
        }
    }
}
