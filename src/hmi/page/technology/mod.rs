//! Technology page: what a plunge should be ground with, and what limits each value; taken over to the grinding page.
//! The sizes of the part are those of the grinding page; the words of its labels tell what its values mean.
//! Source: spec K7.5; issue "a good part, always", part D.

mod proposal_table;
pub(super) mod task;
mod task_column;

use super::{HandOver, InputPrompt, PageContext, PageUi, empty, input_line};
use crate::defs::page_meaning::PageMeaning;
use crate::defs::text::Text;
use crate::hmi::{Area, CoreAnswer, EditKey, FieldEditor, View, param_range, pictogram, theme};
use crate::link::Command;
use crate::link::page_command::PageCommand;
use task_column::FIELDS;

/// Share of the page for the task.
const TASK_SHARE: f32 = 0.42;

/// State of the page.
#[derive(Debug, Default)]
pub struct TechnologyPage {
    typing: FieldEditor,
    cursor: usize,
}

impl PageUi for TechnologyPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        let Some(text) = view
            .snapshot
            .page_files()
            .and_then(|files| files.text.as_deref().ok())
            .filter(|text| task::is_plunge(text))
        else {
            let remedy = view.text(
                "装入一个切入磨程序，如 O1002、O1004：页面上有毛坯直径、成品直径、粗磨速度。",
                "Load a plunge program such as O1002 or O1004: its page has blank diameter, finished diameter and roughing feed.",
            );
            let what = view.text("这个程序没有可建议的数值", "this program has no values to propose");
            return empty::show(view, rect, pictogram::NO_PAGE, what, remedy);
        };
        if let CoreAnswer::Accepted(field, _) = self.typing.poll_answer(&view.snapshot.edit_answer)
            && field == self.cursor
        {
            self.go((field + 1) % FIELDS.len());
        }
        typed.edits.iter().for_each(|edit| self.edit(*edit, view, out));
        let (page, input) = input_line::split(rect);
        let (left, right) = page.shrink(theme::PAD).split_left_right_at_fraction(TASK_SHARE);
        if let Some(field) = task_column::ui(left.trim_right(theme::PAD / 2.0), view, text, (self.cursor, &self.typing))
        {
            self.touch(field, view, out);
        }
        let take = proposal_table::ui(right.trim_left(theme::PAD / 2.0), view, text);
        out.extend(take.into_iter().map(|(variable, value)| Command::EnterVariable(variable, Some(value))));
        self.input(input, view);
    }
}

impl TechnologyPage {
    fn edit(&mut self, edit: EditKey, view: &View<'_>, out: &mut Vec<Command>) {
        if self.typing.handle_key(edit) {
            return;
        }
        if let Some(field) = edit.step(self.cursor, FIELDS.len(), 1) {
            self.go(field);
        } else if edit == EditKey::Enter {
            self.store(view, out);
        }
    }

    fn go(&mut self, field: usize) {
        self.cursor = field;
        self.typing.clear();
    }

    /// A touch chooses the field; of the material it takes the next one.
    fn touch(&mut self, field: usize, view: &View<'_>, out: &mut Vec<Command>) {
        if self.cursor != field {
            self.go(field);
        }
        self.typing.pad_open = field != task_column::MATERIAL_FIELD;
        if field == task_column::MATERIAL_FIELD {
            next_material(view, out);
        }
    }

    fn store(&mut self, view: &View<'_>, out: &mut Vec<Command>) {
        if self.typing.text.is_empty() {
            if self.cursor == task_column::MATERIAL_FIELD {
                return next_material(view, out);
            }
            return self.go((self.cursor + 1) % FIELDS.len());
        }
        let (row, _) = FIELDS[self.cursor];
        match self.typing.param_value(row) {
            Ok(value) => {
                self.typing.send(self.cursor);
                out.push(Command::Page(PageCommand::EditParam(row.address(), value)));
            }
            Err(reason) => self.typing.refused = Some(reason),
        }
    }

    fn input(&self, rect: egui::Rect, view: &View<'_>) {
        let (row, name) = FIELDS[self.cursor];
        let range = format!("{} {} {}", view.text("范围", "range"), param_range(row), row.unit);
        let told = InputPrompt { label: &format!("P{}=", row.number), name: name.get(view.lang), range: &range };
        input_line::ui(view, rect, &self.typing, &told);
    }
}

fn next_material(view: &View<'_>, out: &mut Vec<Command>) {
    let (row, _) = FIELDS[task_column::MATERIAL_FIELD];
    let next = view.snapshot.params.get(row) % row.max + 1.0;
    out.push(Command::Page(PageCommand::EditParam(row.address(), next)));
}

/// What is proposed, in the order of the table, with its name and unit.
const PROPOSED: [(PageMeaning, Text); 6] = [
    (PageMeaning::RoughAllowance, Text::new("粗磨余量", "roughing from")),
    (PageMeaning::RoughFeed, Text::new("粗磨速度", "roughing feed")),
    (PageMeaning::FinishAllowance, Text::new("精磨余量", "finishing from")),
    (PageMeaning::FinishFeed, Text::new("精磨速度", "finishing feed")),
    (PageMeaning::SparkOut, Text::new("光磨时间", "spark-out")),
    (PageMeaning::DressingInterval, Text::new("修整间隔", "parts to dressing")),
];
