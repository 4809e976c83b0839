//! Date and time of day: six fields, each typed and checked on its own. Source: spec B6, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo};

use super::{group, key_row, title_note};
use crate::defs::date::{DateTime, YEARS, days_in_month};
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::FieldEditor;
use crate::hmi::page::input_line::{self, InputPrompt};
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame};
use crate::hmi::widget::{KeyboardFocus, cell};
use crate::link::Command;
use crate::link::page_command::PageCommand;

/// Name and id of each field.
const FIELDS: [(Text, &str); 6] = [
    (Text::new("年", "year"), "clock-year"),
    (Text::new("月", "month"), "clock-month"),
    (Text::new("日", "day"), "clock-day"),
    (Text::new("时", "hour"), "clock-hour"),
    (Text::new("分", "minute"), "clock-minute"),
    (Text::new("秒", "second"), "clock-second"),
];

/// State of the group.
#[derive(Debug, Default)]
pub struct ClockGroup {
    /// The selected field.
    field: Option<usize>,
    /// The value being typed.
    pub typing: FieldEditor,
}

impl ClockGroup {
    /// Handles edits of the selected field; returns the rest for the keys of the page.
    pub fn handle_edits(&mut self, view: &View<'_>, edits: &[EditKey], out: &mut Vec<Command>) -> Vec<EditKey> {
        let mut rest = Vec::new();
        for edit in edits {
            let Some(field) = self.field else {
                rest.push(*edit);
                continue;
            };
            self.typing.clear_refused(*edit);
            match edit {
                EditKey::Enter => self.enter(view, field, out),
                EditKey::Up | EditKey::Left | EditKey::Previous => self.go((field + FIELDS.len() - 1) % FIELDS.len()),
                EditKey::Down | EditKey::Right | EditKey::Next => self.go((field + 1) % FIELDS.len()),
                EditKey::Cancel if self.typing.text.is_empty() => self.close(),
                other => drop(self.typing.handle_key(*other)),
            }
        }
        rest
    }

    fn go(&mut self, field: usize) {
        self.typing.clear();
        self.field = Some(field);
    }

    fn close(&mut self) {
        self.typing.clear();
        (self.field, self.typing.pad_open) = (None, false);
    }

    /// Sends the typed field at once, then selects the next field.
    fn enter(&mut self, view: &View<'_>, field: usize, out: &mut Vec<Command>) {
        if !self.typing.text.is_empty() {
            match date_with(view.snapshot.date, field, &self.typing.text) {
                Ok(date) => out.push(Command::Page(PageCommand::SetDate(date))),
                Err(said) => return self.typing.refused = Some(said),
            }
        }
        match field + 1 {
            next if next < FIELDS.len() => self.go(next),
            _ => self.close(),
        }
    }

    /// Draws the group.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, (key, walk): (f32, &mut KeyboardFocus)) {
        let (body, free) = group(ui, view, rect, view.text("日期、时间", "date and time"));
        title_note(ui, view, free, view.text("年 月 日 · 时 分 秒", "y m d · h min s"));
        let row = key_row(body, key, 0);
        let painter = ui.painter();
        for (index, (name, id)) in FIELDS.iter().enumerate() {
            let place = cell(row, index, FIELDS.len());
            let (chosen, entered) = walk.item();
            let response = ui.interact(place, Id::unique(("clock", index)), Sense::CLICK);
            let word = format!("{} {id}", name.get(view.lang));
            response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &word));
            if response.clicked() || entered {
                self.go(index);
                // The keyboard needs no pad.
                self.typing.pad_open |= response.clicked();
            }
            card(painter, place, view.theme.raised, view.theme.line);
            let typed = self.field == Some(index);
            if typed && self.typing.refused.is_some() {
                focus_frame(painter, place, view.theme.alarm);
            } else if typed || chosen {
                focus_frame(painter, place, if typed { view.theme.focus } else { view.theme.info });
            }
            let shown = match view.snapshot.date {
                _ if typed && !self.typing.text.is_empty() => self.typing.text.clone(),
                Some(date) if index == 0 => date.parts()[0].to_string(),
                Some(date) => format!("{:02}", date.parts()[index]),
                None => "—".to_owned(),
            };
            let ink = if typed && self.typing.refused.is_some() { view.theme.alarm_text } else { view.theme.text };
            fit_text(painter, place.shrink(4.0), Align2::CENTER_CENTER, &shown, theme::SECONDARY, ink);
        }
    }

    /// The input line at the foot of the page.
    pub fn input_line(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let hint = view.text("触摸年月日时分秒可修改", "touch a part of the date to set it");
        let Some(field) = self.field else {
            return input_line::ui(ui, view, rect, &self.typing, &InputPrompt { label: "", name: "", range: hint });
        };
        let name = FIELDS[field].0.get(view.lang);
        let (least, most) = range(view.snapshot.date, field);
        let old = view.snapshot.date.map_or(0, |date| date.parts()[field]);
        let range = format!("{least} … {most}  {} {old}", view.text("原值", "old"));
        input_line::ui(
            ui,
            view,
            rect,
            &self.typing,
            &InputPrompt { label: &format!("{name}="), name: "", range: &range },
        );
    }
}

/// Least and greatest value of a field; for the day they depend on year and month.
fn range(date: Option<DateTime>, field: usize) -> (i64, i64) {
    let [year, month, ..] = date.unwrap_or_default().parts();
    match field {
        0 => (*YEARS.start(), *YEARS.end()),
        1 => (1, 12),
        2 => (1, days_in_month(year, month)),
        3 => (0, 23),
        _ => (0, 59),
    }
}

/// The date with one field replaced.
fn date_with(date: Option<DateTime>, field: usize, text: &str) -> Result<DateTime, LocalizedText> {
    let Some(date) = date else { return Err(LocalizedText::new("没有系统时钟", "the computer tells no time")) };
    let (least, most) = range(Some(date), field);
    let value = text.parse::<i64>().map_err(|_| LocalizedText::new("只能输入整数", "whole numbers only"))?;
    if !(least..=most).contains(&value) {
        return Err(LocalizedText::new(format!("超出范围 {least} … {most}"), format!("out of range {least} … {most}")));
    }
    let mut parts = date.parts();
    parts[field] = value;
    DateTime::from_parts(parts).ok_or_else(|| {
        let day = parts[2];
        LocalizedText::new(
            format!("该月没有 {day} 日，请先改日"),
            format!("that month has no day {day}: change the day first"),
        )
    })
}
