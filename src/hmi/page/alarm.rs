//! The alarms: those present with cause and remedy, and what came and went, also before the last power-off.
//! Source: spec B6, B8, H7.

use std::sync::Arc;

use egui::{Align2, Rect, Ui, pos2, vec2};

use super::Typed;
use super::scroll::Scroll;
use crate::defs::alarm::ALARMS;
use crate::defs::history::PastAlarm;
use crate::defs::text::Lang;
use crate::hmi::entry::Edit;
use crate::hmi::view::{View, card, fit, moment, paragraph, put};
use crate::hmi::widget::Look;
use crate::hmi::{theme, widget};
use crate::link::Command;
use crate::link::files::{Asker, FileRequest, Ticket};
use crate::link::page_command::PageCommand;
use crate::link::snapshot::AlarmView;

/// Height of an alarm that is present, and of a line of the history.
const PRESENT: f32 = 138.0;
const PAST: f32 = 56.0;

/// What the page keeps.
#[derive(Debug, Default)]
pub struct Alarms {
    history: bool,
    scroll: Scroll,
}

impl Alarms {
    /// Shows what is present first, from the top.
    pub fn open(&mut self) {
        *self = Self::default();
    }

    /// Draws the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>) -> Vec<Command> {
        let mut out = Vec::new();
        let inside = rect.shrink(theme::PAD);
        let (bar, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        let (present, past) = (&view.snapshot.alarms, &view.snapshot.alarm_history);
        let keys = [
            ("alarms-present", format!("{} {}", view.say("当前", "PRESENT"), present.len())),
            ("alarm-history", format!("{} {}", view.say("历史", "HISTORY"), past.len())),
        ];
        let bar = Rect::from_min_size(bar.min, vec2(bar.width().min(420.0), bar.height()));
        let touched = widget::tabs(ui, view, bar, &keys, usize::from(self.history)).map(|index| index == 1);
        let turned = typed.edits.iter().any(|edit| matches!(edit, Edit::Left | Edit::Right | Edit::Next));
        let wanted = touched.unwrap_or(self.history != turned);
        if wanted != self.history {
            (self.history, self.scroll) = (wanted, Scroll::default());
        }
        if self.history {
            let key = Rect::from_min_max(pos2(inside.max.x - 150.0, bar.min.y), pos2(inside.max.x, bar.max.y));
            let look = Look { on: false, locked: past.is_empty() };
            if widget::push(ui, view, key, "alarm-export", view.say("导出 CSV", "EXPORT CSV"), look) && !past.is_empty()
            {
                let (ticket, request) = (Ticket::unheard(Asker::Screen), FileRequest::Table(table(view.lang, past)));
                out.push(Command::Page(PageCommand::File(ticket, request)));
            }
        }
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::PAD), rest.max);
        let count = if self.history { past.len() } else { present.len() };
        if count == 0 {
            let words = if self.history {
                view.say("没有报警记录", "no alarm is remembered")
            } else {
                view.say("没有报警", "no alarm")
            };
            let line = Rect::from_center_size(rest.center(), vec2(rest.width(), 30.0));
            fit(ui.painter(), line, Align2::CENTER_CENTER, words, theme::SECONDARY, view.theme.quiet);
            return out;
        }
        let line = if self.history { PAST } else { PRESENT };
        let list = widget::whole_lines(rest, line);
        if typed.pages != 0 {
            self.scroll.page(typed.pages, list, line);
        }
        let (first, last) = self.scroll.follow(ui, "alarms", list, line, count);
        for index in first..last {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(line)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, line - theme::GAP));
            let ui_painter = ui.painter().with_clip_rect(list);
            if self.history {
                // The latest on top.
                past.iter().rev().nth(index).into_iter().for_each(|past| gone(&ui_painter, view, place, past));
            } else if let Some(alarm) = present.get(index) {
                present_row(&ui_painter, view, place, alarm);
            }
        }
        self.scroll.bar(ui, view, list, line, count);
        out
    }
}

/// `O1001 第7行`, or nothing outside a run.
fn place_word(view: &View<'_>, place: Option<(u32, u32)>) -> Option<String> {
    place.map(|(program, line)| (view.snapshot.title(program), line)).map(|(program, line)| match view.lang {
        Lang::Zh => format!("{program} 第{line}行"),
        Lang::En => format!("{program} line {line}"),
    })
}

fn present_row(painter: &egui::Painter, view: &View<'_>, place: Rect, alarm: &AlarmView) {
    card(painter, place, view.theme.surface, view.theme.line);
    painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, view.theme.alarm);
    let inside = place.shrink2(vec2(theme::PAD, theme::GAP));
    let (number, words) = inside.split_left_right_at_x(inside.min.x + 60.0);
    let (top, below) = words.split_top_bottom_at_y(words.min.y + 30.0);
    let (title, when) = top.split_left_right_at_x(top.max.x - 196.0);
    let head = Rect::from_min_size(number.min, vec2(number.width(), top.height()));
    put(painter, head, Align2::LEFT_CENTER, &format!("{:03}", alarm.number), theme::SECONDARY, view.theme.alarm_text);
    fit(painter, title, Align2::LEFT_CENTER, alarm.text.get(view.lang), theme::TITLE, view.theme.text);
    let mut word = view.time(alarm.since);
    if let Some(place) = place_word(view, alarm.place) {
        word = format!("{place} · {word}");
    }
    fit(painter, when, Align2::RIGHT_CENTER, &word, theme::LABEL, view.theme.quiet);
    let cause = ALARMS.iter().find(|row| row.number == alarm.number).map_or("", |row| row.cause.get(view.lang));
    let parts = [(view.say("原因", "cause"), cause), (view.say("处理", "remedy"), alarm.remedy.get(view.lang))];
    let mut top = below.min.y;
    for (name, words) in parts.into_iter().filter(|(_, words)| !words.is_empty()) {
        let label = Rect::from_min_size(pos2(below.min.x, top), vec2(60.0, 22.0));
        fit(painter, label, Align2::LEFT_TOP, name, theme::LABEL, view.theme.quiet);
        let room = Rect::from_min_max(pos2(below.min.x + 64.0, top), pos2(below.max.x, top + 44.0));
        top = paragraph(painter, room, words, theme::LABEL, view.theme.text).max.y + 2.0;
    }
}

fn gone(painter: &egui::Painter, view: &View<'_>, place: Rect, past: &PastAlarm) {
    let here = past.ended.is_none();
    card(painter, place, view.theme.surface, view.theme.line);
    let edge = if here { view.theme.alarm } else { view.theme.line };
    painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, edge);
    let inside = place.shrink2(vec2(theme::PAD, 3.0));
    let (number, words) = inside.split_left_right_at_x(inside.min.x + 60.0);
    let ink = if here { view.theme.alarm_text } else { view.theme.text };
    put(painter, number, Align2::LEFT_CENTER, &format!("{:03}", past.number), theme::SECONDARY, ink);
    let (top, below) = words.split_top_bottom_at_fraction(0.54);
    fit(painter, top, Align2::LEFT_CENTER, past.text.get(view.lang), theme::LABEL, view.theme.text);
    let (times, where_) = below.split_left_right_at_fraction(0.7);
    let word = format!("{} → {}", moment(past.came), ended(view, past));
    fit(painter, times, Align2::LEFT_CENTER, &word, theme::LABEL, view.theme.quiet);
    if let Some(word) = place_word(view, past.place) {
        fit(painter, where_, Align2::RIGHT_CENTER, &word, theme::LABEL, view.theme.quiet);
    }
}

/// `15:01:56 复位`, with the day where it is another one.
fn ended(view: &View<'_>, past: &PastAlarm) -> String {
    let Some((how, when)) = past.ended else { return view.say("仍在", "present").to_owned() };
    let how = how.name().get(view.lang);
    match when {
        None => how.to_owned(),
        Some(when) if when.parts()[..3] == past.came.parts()[..3] => format!("{} {how}", when.time()),
        Some(when) => format!("{} {how}", moment(when)),
    }
}

/// The history as a table for a computer: UTF-8 with a mark, so that spreadsheets know it.
fn table(lang: Lang, history: &[Arc<PastAlarm>]) -> String {
    let head = match lang {
        Lang::Zh => "序号,报警号,出现,消除,方式,程序,行,内容",
        Lang::En => "count,number,came,ended,how,program,line,text",
    };
    let mut text = format!("\u{FEFF}{head}\r\n");
    for past in history {
        let (how, when) = past.ended.map_or(("", None), |(how, when)| (how.name().get(lang), when));
        let when = when.map(moment).unwrap_or_default();
        let (program, line) =
            past.place.map(|(program, line)| (program.to_string(), line.to_string())).unwrap_or_default();
        let words = past.text.get(lang).replace('"', "\"\"").replace(['\r', '\n'], " ");
        let (count, number, came) = (past.count, past.number, moment(past.came));
        text.push_str(&format!("{count},{number},{came},{when},{how},{program},{line},\"{words}\"\r\n"));
    }
    text
}
