//! Date and time of day: six fields, each typed and checked on its own. Source: spec B6, H6.

use egui::Rect;
use egui::accesskit::Role;

use super::SettingsGroup;
use crate::defs::date::{DateTime, YEARS, days_in_month};
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::hmi::page::{InputPrompt, input_line};
use crate::hmi::{Area, EditKey, FieldEditor, KeyboardFocus, View, theme};
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
                EditKey::Cancel if self.typing.text.is_empty() => self.close(),
                other => match other.step(field, FIELDS.len(), 1) {
                    Some(field) => self.go(field),
                    None => drop(self.typing.handle_key(*other)),
                },
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
                Err(message) => return self.typing.refused = Some(message),
            }
        }
        if field + 1 < FIELDS.len() { self.go(field + 1) } else { self.close() }
    }

    /// Draws the group.
    pub fn ui(&mut self, group: &SettingsGroup<'_>, walk: &mut KeyboardFocus) {
        let (view, row) = (group.view, group.row(0));
        group.title_note(view.text("年 月 日 · 时 分 秒", "y m d · h min s"));
        for (index, (name, id)) in FIELDS.iter().enumerate() {
            let place = row.cell(index, FIELDS.len());
            let (chosen, entered) = walk.item();
            let word = format!("{} {id}", name.get(view.lang));
            let response = view.touch_as(Role::TextInput, place, ("clock", index), &word);
            if response.clicked() || entered {
                self.go(index);
                // The keyboard needs no pad.
                self.typing.pad_open |= response.clicked();
            }
            view.filled_card(place, view.theme.raised, view.theme.line);
            let typed = self.field == Some(index);
            if typed {
                self.typing.frame(view, place);
            } else if chosen {
                view.frame(place, view.theme.info);
            }
            let shown = match view.snapshot.date {
                _ if typed && !self.typing.text.is_empty() => self.typing.text.clone(),
                Some(date) if index == 0 => date.parts()[0].to_string(),
                Some(date) => format!("{:02}", date.parts()[index]),
                None => "—".to_owned(),
            };
            let ink = if typed && self.typing.refused.is_some() { view.theme.alarm_text } else { view.theme.text };
            view.fit_centre(place.shrink(4.0), &shown, theme::SECONDARY, ink);
        }
    }

    /// The input line at the foot of the page.
    pub fn input_line(&self, rect: Rect, view: &View<'_>) {
        let hint = view.text("触摸年月日时分秒可修改", "touch a part of the date to set it");
        let Some(field) = self.field else {
            return input_line::ui(view, rect, &self.typing, &InputPrompt { label: "", name: "", range: hint });
        };
        let name = FIELDS[field].0.get(view.lang);
        let (least, most) = range(view.snapshot.date, field);
        let old = view.snapshot.date.map_or(0, |date| date.parts()[field]);
        let range = format!("{least} … {most}  {} {old}", view.text("原值", "old"));
        input_line::ui(view, rect, &self.typing, &InputPrompt { label: &format!("{name}="), name: "", range: &range });
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
    let Some(date) = date else { return Err(phrase!("没有系统时钟", "the computer has no clock")) };
    let (least, most) = range(Some(date), field);
    let value = text.parse::<i64>().map_err(|_| phrase!("只能输入整数", "whole numbers only"))?;
    if !(least..=most).contains(&value) {
        return Err(phrase!("超出范围 {least} … {most}", "out of range {least} … {most}", least, most));
    }
    let mut parts = date.parts();
    parts[field] = value;
    DateTime::from_parts(parts).ok_or_else(|| {
        let day = parts[2];
        phrase!("该月没有 {day} 日，请先改日", "that month has no day {day}: change the day first", day)
    })
}
