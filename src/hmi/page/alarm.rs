//! Alarm page: active alarms with cause and remedy, and the history, also from before the last power-off. One alarm can
//! be selected: help opens at it, and the history shows its cause, its remedy and how it is cleared. An alarm of a
//! program leads to the value that is wrong.
//! Source: spec B6, B8, H7.

use std::borrow::Cow;

use egui::{Align2, Rect, pos2, vec2};

use super::accept_data::AcceptData;
use super::help::{self, CAUSE, HelpEntry, REMEDY};
use super::variables::entry_page;
use super::{HandOver, PageContext, PageUi, Scroll, ScrollList, empty};
use crate::defs::alarm;
use crate::defs::alarm_history::PastAlarm;
use crate::defs::text::{Lang, Text};
use crate::hmi::{Area, EditKey, KeyboardInput, PageKey, View, file_command, format_date_time, theme, widget};
use crate::link::Command;
use crate::link::files::{FileRequest, Requester};
use crate::link::snapshot::AlarmView;
use crate::units::Micros;

/// Heights of a row of an active alarm and of a row of the history.
const PRESENT_HEIGHT: f32 = 158.0;
const PAST_HEIGHT: f32 = 56.0;
/// Width of the captions beside cause and remedy.
const CAPTION_WIDTH: f32 = 80.0;
/// Width of the key that opens the entry of a variable.
const ENTRY_KEY_WIDTH: f32 = 132.0;

/// Identifies an alarm while its place in the list changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AlarmRef {
    Present(u16, Micros),
    Past(u64),
}

/// State of the page.
#[derive(Debug, Default)]
pub struct AlarmPage {
    shows_history: bool,
    selected: Option<AlarmRef>,
    scroll: Scroll,
    accept: AcceptData,
    /// Alarm whose text was looked up last, and its help.
    looked_up: Option<(u16, Option<HelpEntry>)>,
}

impl PageUi for AlarmPage {
    /// Shows the active alarms from the top.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn help_alarm(&self, view: &View<'_>) -> Option<u16> {
        self.selected_number(view)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, hand_over, login, .. } = ctx;
        let free = KeyboardInput::default();
        let is_asking = self.accept.is_open() || login.is_open();
        let (typed, asked) = if is_asking { (&free, typed) } else { (typed, &free) };
        self.list(rect, view, typed, (hand_over, out));
        self.accept.ui(rect, view, &asked.edits, login, out);
    }
}

impl AlarmPage {
    /// The tabs and the rows.
    fn list(
        &mut self,
        rect: Rect,
        view: &View<'_>,
        typed: &KeyboardInput,
        to: (&mut Option<HandOver>, &mut Vec<Command>),
    ) {
        let (hand_over, out) = to;
        let (bar, rest) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        out.extend(self.bar(bar, view, typed));
        let rest = rest.trim_top(theme::PAD);
        let rows = self.rows(view);
        if rows.is_empty() {
            let words = if self.shows_history {
                view.text("没有报警记录", "no alarm in the history")
            } else {
                view.text("没有报警", "no alarm")
            };
            return empty::note(view, rest, words);
        }
        let line = if self.shows_history { PAST_HEIGHT } else { PRESENT_HEIGHT };
        let entered = self.move_selection(&rows, &typed.edits, widget::round_to_lines(rest, line), line);
        let chosen = self.selected.filter(|chosen| rows.contains(chosen));
        let told = chosen.filter(|_| self.shows_history).and(self.selected_number(view));
        let own = chosen.map_or_else(Vec::new, |row| own_words(view, row));
        let below = told.and_then(|number| self.help_of(number)).map_or(0.0, |entry| {
            let parts = entry.paragraphs.iter().map(|(caption, words)| (caption.get(view.lang), words.get(view.lang)));
            // What the program said stands for the general words about its alarms.
            let general = parts.filter(|(caption, _)| own.is_empty() || !is_remedy(caption));
            let place = Rect::from_min_max(pos2(rest.min.x, rest.min.y + rest.height() / 3.0), rest.max);
            detail(view, place, own.iter().cloned().chain(general).collect())
        });
        let list = widget::round_to_lines(rest.trim_bottom(below), line);
        if let Some(at) = rows.iter().position(|row| Some(*row) == chosen).filter(|_| !self.scroll.user_scrolled) {
            self.scroll.reveal(at, list, line);
        }
        let list = ScrollList { id: "alarms", rect: list, row: line, gap: theme::GAP, count: rows.len() };
        let (clipped, places) = self.scroll.rows(view, &list, typed.scroll_pages);
        let touched = places.into_iter().filter_map(|(index, place)| self.row(&clipped, place, rows[index])).last();
        let entered = entered.and_then(|row| find_present(view, row)).and_then(|alarm| alarm.variable);
        if let Some(variable) = touched.or(entered) {
            *hand_over = Some(HandOver::Variable(variable));
            out.push(Command::OpenPage(entry_page(view, variable)));
        }
    }

    /// Number of the selected alarm; without a selection the first active one.
    fn selected_number(&self, view: &View<'_>) -> Option<u16> {
        let (present, past) = (&view.snapshot.alarms, &view.snapshot.alarm_history);
        let chosen = self.selected.and_then(|chosen| match chosen {
            AlarmRef::Present(number, _) => Some(number),
            AlarmRef::Past(count) => past.iter().find(|past| past.count == count).map(|past| past.number),
        });
        chosen.or_else(|| present.first().map(|alarm| alarm.number))
    }

    /// The help of an alarm; looked up once.
    fn help_of(&mut self, number: u16) -> Option<&HelpEntry> {
        if self.looked_up.as_ref().is_none_or(|(known, _)| *known != number) {
            self.looked_up = Some((number, help::alarm_entry(number)));
        }
        self.looked_up.as_ref()?.1.as_ref()
    }

    /// The tabs, and the key that exports the history.
    fn bar(&mut self, bar: Rect, view: &View<'_>, typed: &KeyboardInput) -> Option<Command> {
        let (present, past) = (&view.snapshot.alarms, &view.snapshot.alarm_history);
        let keys = [
            ("alarms-present", format!("{} {}", view.text("当前", "ACTIVE"), present.len())),
            ("alarm-history", format!("{} {}", view.text("历史", "HISTORY"), past.len())),
        ];
        let tabs = Rect::from_min_size(bar.min, vec2(bar.width().min(420.0), bar.height()));
        let touched = widget::tabs(view, tabs, &keys, usize::from(self.shows_history)).map(|index| index == 1);
        let turned = typed.edits.iter().any(|edit| matches!(edit, EditKey::Left | EditKey::Right | EditKey::Next));
        let wanted = touched.unwrap_or(self.shows_history != turned);
        if wanted != self.shows_history {
            *self = Self { shows_history: wanted, ..Self::default() };
        }
        if !self.shows_history && AcceptData::is_due(view) {
            self.accept.key(bar.with_min_x(bar.max.x - 200.0), view);
        }
        if self.shows_history {
            let key = bar.with_min_x(bar.max.x - 150.0);
            let key_look = PageKey::new("alarm-export", view.text("导出 CSV", "EXPORT CSV")).locked(past.is_empty());
            if widget::button(view, key, key_look) && !past.is_empty() {
                return Some(file_command(Requester::Screen, FileRequest::SaveTable(history_csv(view.lang, past))));
            }
        }
        None
    }

    /// Rows of the tab; the history has the latest on top.
    fn rows(&self, view: &View<'_>) -> Vec<AlarmRef> {
        if self.shows_history {
            view.snapshot.alarm_history.iter().rev().map(|past| AlarmRef::Past(past.count)).collect()
        } else {
            view.snapshot.alarms.iter().map(|alarm| AlarmRef::Present(alarm.number, alarm.since)).collect()
        }
    }

    /// Moves the selection; 取消 clears it. Returns the selected row on which 输入 was pressed.
    fn move_selection(&mut self, rows: &[AlarmRef], edits: &[EditKey], list: Rect, line: f32) -> Option<AlarmRef> {
        let mut entered = None;
        for edit in edits {
            let at = self.selected.and_then(|chosen| rows.iter().position(|row| *row == chosen));
            // Without a selection the first visible row is next.
            let first = self.scroll.visible_lines(list, line).start;
            let to = match (edit, at) {
                (EditKey::Down | EditKey::Up | EditKey::Enter, None) => first,
                (EditKey::Down, Some(at)) => at + 1,
                (EditKey::Up, Some(at)) => at.saturating_sub(1),
                (EditKey::LineStart, _) => 0,
                (EditKey::LineEnd, _) => rows.len(),
                (EditKey::Cancel, _) => {
                    self.selected = None;
                    continue;
                }
                (EditKey::Enter, Some(_)) => {
                    entered = self.selected;
                    continue;
                }
                _ => continue,
            };
            self.selected = rows.get(to.min(rows.len() - 1)).copied();
            self.scroll.user_scrolled = false;
        }
        entered
    }

    /// Draws a row. Returns the variable whose key was touched.
    fn row(&mut self, view: &View<'_>, place: Rect, row: AlarmRef) -> Option<u16> {
        let chosen = self.selected == Some(row);
        let alarm = find_present(view, row);
        let name = match (row, alarm) {
            (AlarmRef::Present(number, _), alarm) => {
                present_row(view, place, alarm?, chosen);
                format!("{number:03} {} alarm-{number}", alarm?.text.get(view.lang))
            }
            (AlarmRef::Past(count), _) => {
                let past = view.snapshot.alarm_history.iter().find(|past| past.count == count)?;
                past_row(view, place, past, chosen);
                format!("{:03} {} past-{count}", past.number, past.text.get(view.lang))
            }
        };
        let variable = alarm.and_then(|alarm| alarm.variable);
        let card = if variable.is_some() { place.trim_right(ENTRY_KEY_WIDTH + theme::PAD) } else { place };
        if view.touch_row(card, ("alarm-row", &name), chosen, &name).clicked() {
            self.selected = (!chosen).then_some(row);
            // The detail card must not cover the row.
            self.scroll.user_scrolled = false;
        }
        alarm.and_then(|alarm| alarm.variable.filter(|variable| entry_key(view, place, (alarm.number, *variable))))
    }
}

/// Cause and remedy that a program gave for an alarm of the history.
fn own_words<'v>(view: &View<'v>, row: AlarmRef) -> Vec<(&'static str, Cow<'v, str>)> {
    let AlarmRef::Past(count) = row else { return Vec::new() };
    let past = view.snapshot.alarm_history.iter().find(|past| past.count == count);
    let words = past.map_or_else(Vec::new, |past| vec![(CAUSE, &past.cause), (REMEDY, &past.remedy)]);
    let words = words.into_iter().filter(|(_, words)| !words.is_empty());
    words.map(|(caption, words)| (caption.get(view.lang), words.get(view.lang).into())).collect()
}

/// Whether a caption of the help is that of the remedy.
fn is_remedy(caption: &str) -> bool {
    [REMEDY.zh, REMEDY.en].contains(&caption)
}

/// The active alarm of a row.
fn find_present<'v>(view: &View<'v>, row: AlarmRef) -> Option<&'v AlarmView> {
    let AlarmRef::Present(number, since) = row else { return None };
    view.snapshot.alarms.iter().find(|alarm| alarm.number == number && alarm.since == since)
}

/// The key of an alarm that opens the entry of its variable; true if it is touched.
fn entry_key(view: &View<'_>, row: Rect, (alarm, variable): (u16, u16)) -> bool {
    let right = row.split_right(ENTRY_KEY_WIDTH + theme::PAD).1;
    let place = Rect::from_min_size(pos2(right.min.x, row.max.y - 56.0), vec2(ENTRY_KEY_WIDTH, theme::TOUCH_TARGET));
    if place.intersect(view.painter.clip_rect()).height() < 20.0 {
        return false;
    }
    let label = format!("{} {}", view.text("修改", "EDIT"), view.variable_name(variable));
    widget::button(view, place, PageKey::new(&format!("alarm-entry-{alarm}"), &label))
}

/// Card of a row: red edge while the alarm is active, frame while it is selected. Returns the places of the number
/// and of the texts.
fn row_card(view: &View<'_>, place: Rect, here: bool, chosen: bool) -> (Rect, Rect) {
    view.filled_card(place, if chosen { view.theme.raised } else { view.theme.surface }, view.theme.line);
    view.edge_bar(place, if here { view.theme.alarm } else { view.theme.line });
    if chosen {
        view.frame(place, view.theme.focus);
    }
    place.shrink2(vec2(theme::PAD, 3.0)).split_left(60.0)
}

/// Captioned texts, one below the other; returns the top of the next item.
fn captioned_texts(view: &View<'_>, room: Rect, parts: &[(&str, Cow<'_, str>)]) -> f32 {
    let mut top = room.min.y;
    for (caption, words) in parts.iter().filter(|(_, words)| !words.is_empty()) {
        let label = Rect::from_min_size(pos2(room.min.x, top), vec2(CAPTION_WIDTH - 4.0, 22.0));
        view.fit(label, Align2::LEFT_TOP, caption, theme::LABEL, view.theme.muted);
        let words_room = Rect::from_min_max(pos2(room.min.x + CAPTION_WIDTH, top), pos2(room.max.x, top + 44.0));
        top = view.paragraph(words_room, words, theme::LABEL, view.theme.text).max.y + 2.0;
    }
    top
}

/// Card with the texts of the selected alarm, at the lower edge of `room`, as high as the texts need. Returns its
/// height and the gap above it.
fn detail(view: &View<'_>, room: Rect, parts: Vec<(&str, Cow<'_, str>)>) -> f32 {
    let width = room.width() - 2.0 * theme::PAD - CAPTION_WIDTH;
    let height = |words: &str| {
        let text = view.painter.layout(words.to_owned(), theme::font(theme::LABEL), view.theme.text, width);
        text.size().y.min(44.0) + 2.0
    };
    let all = parts.iter().map(|(_, words)| height(words)).sum::<f32>() + 2.0 * theme::GAP + 22.0;
    let place = Rect::from_min_max(pos2(room.min.x, (room.max.y - all).max(room.min.y)), room.max);
    view.filled_card(place, view.theme.surface, view.theme.focus);
    let inside = place.shrink2(vec2(theme::PAD, theme::GAP));
    let top = captioned_texts(view, inside, &parts);
    let hint = Rect::from_min_size(pos2(inside.min.x + CAPTION_WIDTH, top), vec2(width, 20.0));
    view.fit_left(hint, view.text("? 帮助中打开这一条", "? opens its help"), theme::SMALL, view.theme.muted);
    place.height() + theme::PAD
}

fn present_row(view: &View<'_>, place: Rect, alarm: &AlarmView, chosen: bool) {
    let (number, words) = row_card(view, place, true, chosen);
    let (top, below) = words.split_top(33.0);
    let (title, when) = top.split_right(196.0);
    let head = Rect::from_min_size(number.min, vec2(number.width(), top.height()));
    view.line_left(head, &format!("{:03}", alarm.number), theme::SECONDARY, view.theme.alarm_text);
    view.fit_left(title, &alarm.text.get(view.lang), theme::TITLE, view.theme.text);
    let mut word = view.time(alarm.since);
    if let Some(place) = view.program_line(alarm.place) {
        word = format!("{place} · {word}");
    }
    view.fit_right(when, &word, theme::LABEL, view.theme.muted);
    let parts = [
        (CAUSE.get(view.lang), alarm.cause.get(view.lang)),
        (REMEDY.get(view.lang), alarm.remedy.get(view.lang)),
        (view.text("清除", "cleared"), alarm::reset_rule(alarm.number).name().get(view.lang).into()),
    ];
    let key = if alarm.variable.is_some() { ENTRY_KEY_WIDTH + theme::PAD } else { 0.0 };
    captioned_texts(view, below.trim_right(key), &parts);
}

fn past_row(view: &View<'_>, place: Rect, past: &PastAlarm, chosen: bool) {
    let here = past.ended.is_none();
    let (number, words) = row_card(view, place, here, chosen);
    let ink = if here { view.theme.alarm_text } else { view.theme.text };
    view.line_left(number, &format!("{:03}", past.number), theme::SECONDARY, ink);
    let (top, below) = words.split_top_bottom_at_fraction(0.54);
    view.fit_left(top, &past.text.get(view.lang), theme::LABEL, view.theme.text);
    let (times, where_) = below.split_left_right_at_fraction(0.7);
    let word = format!("{} → {}", format_date_time(past.came), end_text(view, past));
    view.fit_left(times, &word, theme::LABEL, view.theme.muted);
    if let Some(word) = view.program_line(past.place) {
        view.fit_right(where_, &word, theme::LABEL, view.theme.muted);
    }
}

/// `15:01:56 复位`, with the date if the alarm ended on another day.
fn end_text(view: &View<'_>, past: &PastAlarm) -> String {
    let Some((how, when)) = past.ended else { return view.text("仍在", "active").to_owned() };
    let how = how.name().get(view.lang);
    match when {
        None => how.to_owned(),
        Some(when) if when.parts()[..3] == past.came.parts()[..3] => format!("{} {how}", when.time()),
        Some(when) => format!("{} {how}", format_date_time(when)),
    }
}

/// The history as CSV: UTF-8 with byte order mark, so that spreadsheets detect the encoding.
fn history_csv(lang: Lang, history: &[PastAlarm]) -> String {
    let head =
        Text::new("序号,报警号,出现,消除,方式,程序,行,内容", "count,number,raised,cleared,how,program,line,text")
            .get(lang);
    let mut text = format!("\u{FEFF}{head}\r\n");
    for past in history {
        let (how, when) = past.ended.map_or(("", None), |(how, when)| (how.name().get(lang), when));
        let when = when.map(format_date_time).unwrap_or_default();
        let (program, line) =
            past.place.map(|(program, line)| (program.to_string(), line.to_string())).unwrap_or_default();
        let words = past.text.get(lang).replace('"', "\"\"").replace(['\r', '\n'], " ");
        let (count, number, came) = (past.count, past.number, format_date_time(past.came));
        text.push_str(&format!("{count},{number},{came},{when},{how},{program},{line},\"{words}\"\r\n"));
    }
    text
}
