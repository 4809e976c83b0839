//! Date and time of day: six fields, each typed and checked on its own. Source: spec B6, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Ui, WidgetInfo};

use super::{beside, cell, group, row_of};
use crate::defs::date::{Date, YEARS, days_of};
use crate::defs::text::{Said, Text};
use crate::hmi::entry::Edit;
use crate::hmi::page::input_line::{self, Told};
use crate::hmi::theme;
use crate::hmi::typing::Typing;
use crate::hmi::view::{View, card, fit, frame};
use crate::hmi::widget::Walk;
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
pub struct Clock {
    /// The selected field.
    field: Option<usize>,
    /// The value being typed.
    pub typing: Typing,
}

impl Clock {
    /// Handles edits of the selected field; returns the rest for the keys of the page.
    pub fn take(&mut self, view: &View<'_>, edits: &[Edit], out: &mut Vec<Command>) -> Vec<Edit> {
        let mut rest = Vec::new();
        for edit in edits {
            let Some(field) = self.field else {
                rest.push(*edit);
                continue;
            };
            self.typing.next_key(*edit);
            match edit {
                Edit::Enter => self.enter(view, field, out),
                Edit::Up | Edit::Left | Edit::Previous => self.go((field + FIELDS.len() - 1) % FIELDS.len()),
                Edit::Down | Edit::Right | Edit::Next => self.go((field + 1) % FIELDS.len()),
                Edit::Cancel if self.typing.text.is_empty() => self.close(),
                other => drop(self.typing.key(*other)),
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
        (self.field, self.typing.pad) = (None, false);
    }

    /// Sends the typed field at once, then selects the next field.
    fn enter(&mut self, view: &View<'_>, field: usize, out: &mut Vec<Command>) {
        if !self.typing.text.is_empty() {
            match wanted(view.snapshot.date, field, &self.typing.text) {
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
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, (key, walk): (f32, &mut Walk)) {
        let (body, free) = group(ui, view, rect, view.say("日期、时间", "date and time"));
        beside(ui, view, free, view.say("年 月 日 · 时 分 秒", "y m d · h min s"));
        let row = row_of(body, key, 0);
        let painter = ui.painter();
        for (index, (name, id)) in FIELDS.iter().enumerate() {
            let place = cell(row, index, FIELDS.len());
            let (chosen, entered) = walk.pass();
            let response = ui.interact(place, Id::unique(("clock", index)), Sense::CLICK);
            let word = format!("{} {id}", name.get(view.lang));
            response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &word));
            if response.clicked() || entered {
                self.go(index);
                // The keyboard needs no pad.
                self.typing.pad |= response.clicked();
            }
            card(painter, place, view.theme.raised, view.theme.line);
            let typed = self.field == Some(index);
            if typed && self.typing.refused.is_some() {
                frame(painter, place, view.theme.alarm);
            } else if typed || chosen {
                frame(painter, place, if typed { view.theme.focus } else { view.theme.info });
            }
            let shown = match view.snapshot.date {
                _ if typed && !self.typing.text.is_empty() => self.typing.text.clone(),
                Some(date) if index == 0 => date.parts()[0].to_string(),
                Some(date) => format!("{:02}", date.parts()[index]),
                None => "—".to_owned(),
            };
            let ink = if typed && self.typing.refused.is_some() { view.theme.alarm_text } else { view.theme.text };
            fit(painter, place.shrink(4.0), Align2::CENTER_CENTER, &shown, theme::SECONDARY, ink);
        }
    }

    /// The input line at the foot of the page.
    pub fn line(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let hint = view.say("触摸年月日时分秒可修改", "touch a part of the date to set it");
        let Some(field) = self.field else {
            return input_line::ui(ui, view, rect, &self.typing, &Told { what: "", name: "", range: hint });
        };
        let name = FIELDS[field].0.get(view.lang);
        let (least, most) = range(view.snapshot.date, field);
        let old = view.snapshot.date.map_or(0, |date| date.parts()[field]);
        let range = format!("{least} … {most}  {} {old}", view.say("原值", "old"));
        input_line::ui(ui, view, rect, &self.typing, &Told { what: &format!("{name}="), name: "", range: &range });
    }
}

/// Least and greatest value of a field; for the day they depend on year and month.
fn range(date: Option<Date>, field: usize) -> (i64, i64) {
    let [year, month, ..] = date.unwrap_or_default().parts();
    match field {
        0 => (*YEARS.start(), *YEARS.end()),
        1 => (1, 12),
        2 => (1, days_of(year, month)),
        3 => (0, 23),
        _ => (0, 59),
    }
}

/// The date with one field replaced.
fn wanted(date: Option<Date>, field: usize, text: &str) -> Result<Date, Said> {
    let Some(date) = date else { return Err(Said::new("没有系统时钟", "the computer tells no time")) };
    let (least, most) = range(Some(date), field);
    let value = text.parse::<i64>().map_err(|_| Said::new("只能输入整数", "whole numbers only"))?;
    if !(least..=most).contains(&value) {
        return Err(Said::new(format!("超出范围 {least} … {most}"), format!("out of range {least} … {most}")));
    }
    let mut parts = date.parts();
    parts[field] = value;
    Date::of(parts).ok_or_else(|| {
        let day = parts[2];
        Said::new(format!("该月没有 {day} 日，请先改日"), format!("that month has no day {day}: change the day first"))
    })
}
