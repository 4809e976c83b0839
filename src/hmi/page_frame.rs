//! The areas around every page: header, message line, status line, soft keys.
//! Source: spec H1, H7, K7.1, K7.2.

use egui::{Color32, Rect, pos2, vec2};

use super::pictogram::{self, PictogramShape};
use super::{Area, View, format_feed, format_whole, keycap, theme, widget};
use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::page::Page;
use crate::defs::soft_key::{self, SoftKey, SoftKeyAction};
use crate::defs::text::phrase;
use crate::link::Snapshot;
use crate::link::snapshot::{AlarmView, RunState, Tone};
use crate::units::Micros;

/// How long a message stays in the message line.
const MESSAGE_DURATION: Micros = Micros::from_millis(5_000);

/// The magnifier of the search.
const MAGNIFIER: [PictogramShape; 2] =
    [PictogramShape::Ring(10.0, 10.0, 6.5), PictogramShape::Line(&[(15.0, 15.0), (21.0, 21.0)])];

/// What was touched in the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameTouch {
    /// The key `?`.
    Help,
    /// The title: the home page.
    Home,
    /// The magnifier: the search over everything.
    Search,
    /// The alarm chip, or the message line while it shows an alarm.
    Alarm,
    /// The offer to resume the run that a power cut has ended.
    InterruptedRun,
}

/// The name of the machine without its kind in words.
pub fn machine_name(view: &View<'_>) -> String {
    let name = view.snapshot.kind.name().get(view.lang).split(' ').next().unwrap_or_default();
    let mut letters = name.chars();
    let first: String = letters.next().map(char::to_uppercase).into_iter().flatten().collect();
    first + letters.as_str()
}

/// Draws the header: kind · page, program and block, mode, state, alarms, clock, help.
pub fn header(view: &View<'_>, rect: Rect) -> Option<FrameTouch> {
    view.painter.rect_filled(rect, 0.0, view.theme.surface);
    view.hairline(rect, rect.max.y - 0.5);
    let row = rect.shrink2(vec2(theme::PAD, 9.0));
    let help =
        Rect::from_min_max(pos2(rect.max.x - theme::TOUCH_TARGET - 4.0, rect.min.y + 1.0), rect.max - vec2(4.0, 1.0));
    let key = keycap::plain(view, help, "header-help", "? help");
    view.line_centre(help, "?", theme::SECONDARY, view.theme.text);
    let mut touched = key.clicked().then_some(FrameTouch::Help);
    let search = help.translate(vec2(-help.width() - 4.0, 0.0));
    let key = keycap::plain(view, search, "header-search", "全部查找 header-search");
    pictogram::draw(
        &view.painter,
        Rect::from_center_size(search.center(), vec2(26.0, 26.0)),
        &MAGNIFIER,
        view.theme.text,
    );
    touched = touched.or(key.clicked().then_some(FrameTouch::Search));
    let mut right = search.min.x - theme::GAP;
    let clock = Rect::from_min_max(pos2(right - 66.0, row.min.y), pos2(right, row.max.y));
    view.line_right(clock, view.clock, theme::LABEL, view.theme.muted);
    right = clock.min.x - theme::PAD;
    let (left, chip_touched) = alarm_chip(view, right, row);
    touched = touched.or(chip_touched.then_some(FrameTouch::Alarm));
    right = left;
    let (fill, ink) = state_colours(view);
    let state = view.chip(right, row, view.snapshot.state_name().get(view.lang), fill, ink);
    let mode = view.snapshot.mode.key().label().get(view.lang);
    let mode = view.chip(state.min.x - theme::GAP, row, mode, view.theme.raised, view.theme.text);
    right = mode.min.x - theme::PAD;
    let program = program_label(view);
    // A long program name takes space from the title.
    let wanted = view.layout_line(&program, theme::LABEL, view.theme.text, 180.0).size().x;
    let place = Rect::from_min_max(pos2(right - wanted.max(122.0), row.min.y), pos2(right, row.max.y));
    view.fit_right(place, &program, theme::LABEL, view.theme.text);
    let title = row.with_max_x(place.min.x - theme::PAD);
    let kind = machine_name(view);
    let page = view.snapshot.page.title_on(view.snapshot.kind).get(view.lang);
    let with_kind = format!("{kind} · {page}");
    // The kind makes way for a long title.
    let fits = view.layout_line(&with_kind, theme::TITLE, view.theme.text, f32::INFINITY).size().x <= title.width();
    let home = view.touch(title.expand2(vec2(theme::PAD, 9.0)).intersect(rect), "header-home", "总览 header-home");
    view.fit_left(title, if fits { &with_kind } else { page }, theme::TITLE, view.theme.text);
    touched.or(home.clicked().then_some(FrameTouch::Home))
}

/// `O1001 N0040`; in a subprogram its number and block.
pub fn program_label(view: &View<'_>) -> String {
    let program = &view.snapshot.program;
    if program.number == 0 {
        return view.text("没有程序", "no program").to_owned();
    }
    format!("{} N{:04}", view.snapshot.title(program.running_program()), program.block.unwrap_or(0))
}

/// Paints program and block in a narrow space. If a long name leaves no space for the block, only the name; the header
/// shows both.
pub fn paint_program_label(view: &View<'_>, rect: Rect, size: f32) {
    let word = program_label(view);
    let whole = view.layout_line(&word, theme::SMALL, view.theme.text, f32::INFINITY).size().x;
    let word = if whole <= rect.width() { word } else { view.snapshot.title(view.snapshot.program.running_program()) };
    view.fit_left(rect, &word, size, view.theme.text);
}

/// Only a state other than idle is coloured.
fn state_colours(view: &View<'_>) -> (Color32, Color32) {
    match view.snapshot.state {
        RunState::Idle => (view.theme.raised, view.theme.text),
        RunState::Running => (view.theme.run, view.theme.on_accent),
        RunState::Held | RunState::Stopped | RunState::Waiting => (view.theme.hold, view.theme.on_accent),
        RunState::Homing => (view.theme.info, view.theme.on_accent),
        RunState::Alarm => (view.theme.alarm, view.theme.on_accent),
    }
}

/// Draws number of the first alarm and count of alarms; the space stays empty without an alarm. Returns its left
/// edge and whether it was touched; the touch area has the full height of the header.
fn alarm_chip(view: &View<'_>, right: f32, row: Rect) -> (f32, bool) {
    let left = right - 92.0;
    let Some(first) = leading_alarm(view.snapshot) else { return (left, false) };
    let word = match view.snapshot.alarms.len() {
        1 => format!("⚠ {:03}", first.number),
        count => format!("⚠ {:03} ×{count}", first.number),
    };
    view.chip(right, row, &word, view.theme.alarm, view.theme.on_accent);
    let place = Rect::from_min_max(pos2(left + 4.0, row.min.y - 8.0), pos2(right, row.max.y + 8.0));
    (left, view.touch(place, "alarm-chip", "报警 alarm-chip").clicked())
}

/// The alarm that chip and message line show.
fn leading_alarm(snapshot: &Snapshot) -> Option<&AlarmView> {
    alarm::leading(&snapshot.alarms, |alarm| alarm.number)
}

/// Whether the message is still shown.
pub fn message_is_fresh(snapshot: &Snapshot) -> bool {
    snapshot.now.since(snapshot.message.since) < MESSAGE_DURATION && !snapshot.message.text.zh().is_empty()
}

/// Text and colour of the message line. What the page says itself (`of_page`) is not repeated; an alarm that has just come
/// is an alarm, not a refusal.
fn message(view: &View<'_>, hint: Option<&str>, of_page: Option<&str>) -> Option<(String, Color32)> {
    let lang = view.lang;
    if let Some(hint) = hint {
        return Some((hint.to_owned(), view.theme.hold));
    }
    let message = &view.snapshot.message;
    let fresh = message_is_fresh(view.snapshot) && of_page.is_none_or(|shown| shown != message.text.get(lang));
    let alarms = &view.snapshot.alarms;
    let raised = alarms.iter().find(|alarm| fresh && alarm.text == message.text);
    if fresh && message.tone != Tone::Info && raised.is_none() {
        return Some((message.text.get(lang).into_owned(), view.theme.hold));
    }
    if let Some(alarm) = raised.or_else(|| leading_alarm(view.snapshot)) {
        let (text, remedy) = (alarm.text.get(lang), alarm.remedy.get(lang));
        let arrow = if remedy.is_empty() { "" } else { " → " };
        return Some((format!("{:03} {text}{arrow}{remedy}", alarm.number), view.theme.alarm_text));
    }
    if let Some(waiting) = &view.snapshot.waiting_for {
        return Some((waiting.get(lang).into_owned(), view.theme.hold));
    }
    fresh.then(|| (message.text.get(lang).into_owned(), view.theme.text))
}

/// Draws the message line: a refusal in amber for 5 s, else the alarm that has just come or the first one, with its remedy
/// in red, else what the run waits for, else a note for 5 s. Returns [`FrameTouch::Alarm`] if it was touched while there is an alarm.
pub fn message_line(view: &View<'_>, rect: Rect, hint: Option<&str>, of_page: Option<&str>) -> Option<FrameTouch> {
    view.painter.rect_filled(rect, 0.0, view.theme.surface);
    view.hairline(rect, rect.min.y + 0.5);
    if let Some((words, colour)) = message(view, hint, of_page) {
        let mark = Rect::from_min_size(rect.min + vec2(0.0, 1.0), vec2(4.0, rect.height() - 1.0));
        view.painter.rect_filled(mark, 0.0, colour);
        let room = rect.shrink2(vec2(theme::PAD, 2.0));
        if rect.height() < theme::MESSAGE_OF_TWO_LINES || !view.prompt.borrow().is_empty() {
            let height = room.height().min(theme::MESSAGE_OF_TWO_LINES / 2.0);
            view.fit_left(room.split_top(height).0, &words, theme::LABEL, colour);
        } else {
            view.text_rows(room, &words, theme::LABEL, colour, 2);
        }
    }
    if rect.height() >= theme::MESSAGE_OF_TWO_LINES {
        let room = rect.shrink2(vec2(theme::PAD, 2.0)).split_bottom(theme::MESSAGE_OF_TWO_LINES / 2.0).1;
        view.fit_left(room, &view.prompt.borrow(), theme::LABEL, view.theme.text);
    }
    if view.snapshot.alarms.is_empty() {
        return None;
    }
    view.touch(rect, "message", "报警 alarm-list").clicked().then_some(FrameTouch::Alarm)
}

/// Columns of the status line that the offer to resume takes: mode and state stand in the header, single block is a lit key.
const OFFER_COLUMNS: usize = 3;

/// The offer to resume the run that a power cut has ended, until the operator has resumed it or begun another one (B5). The
/// program page has it above its keys.
fn interrupted_run(view: &View<'_>) -> Option<String> {
    let (program, line) = view.snapshot.interrupted.filter(|_| view.snapshot.page != Page::Program)?;
    let name = view.snapshot.title(program);
    Some(view.phrase(&phrase!("断电续 {name} 第 {line} 行 ▶", "RESUME {name} line {line} ▶", name, line)))
}

/// `手动方式 · 连续 · 停止 · F 100 % · 100 mm/min · S 1260 · 件数 12`; after a power cut the offer to resume is first. Returns
/// whether that was touched.
pub fn status_line(view: &View<'_>, rect: Rect) -> Option<FrameTouch> {
    view.painter.rect_filled(rect, 0.0, view.theme.background);
    view.hairline(rect, rect.min.y + 0.5);
    let snapshot = view.snapshot;
    let blocks = if snapshot.key(Key::SingleBlock).lamp {
        view.text("单段", "single block")
    } else {
        view.text("连续", "continuous")
    };
    let words = [
        snapshot.mode.name().get(view.lang).to_owned(),
        blocks.to_owned(),
        snapshot.state_name().get(view.lang).to_owned(),
        format!("F {} %", snapshot.overrides.feed),
        format!("{} mm/min", format_feed(snapshot.feed_mm_min)),
        format!("S {}", format_whole(snapshot.wheel_rpm)),
        if snapshot.is_storing {
            view.text("正在保存…", "storing …").to_owned()
        } else {
            format!("{} {}", view.text("件数", "parts"), snapshot.parts_counted)
        },
    ];
    // Fixed columns: nothing shifts when a value changes.
    let row = rect.trim_sides(theme::PAD);
    let shares: [f32; 7] = [0.15, 0.13, 0.11, 0.13, 0.21, 0.13, 0.14];
    let mut left = row.min.x;
    let offer = interrupted_run(view);
    let hidden = if offer.is_some() { OFFER_COLUMNS } else { 0 };
    let mut touched = None;
    if let Some(words) = offer {
        let width = row.width() * shares.iter().take(hidden).sum::<f32>();
        let place = Rect::from_min_size(rect.min, vec2(row.min.x - rect.min.x + width - theme::GAP, rect.height()));
        view.painter.rect_filled(place.trim_top(1.0), 0.0, view.theme.hold);
        view.fit_left(place.trim_sides(theme::PAD), &words, theme::LABEL, view.theme.on_accent);
        let offered = view.touch(place, "interrupted-run", "断电续 interrupted-run");
        touched = offered.clicked().then_some(FrameTouch::InterruptedRun);
        left += width;
    }
    let inks =
        [view.theme.text; 6].into_iter().chain([if snapshot.is_storing { view.theme.hold } else { view.theme.text }]);
    for ((word, share), ink) in words.iter().zip(shares).zip(inks).skip(hidden) {
        let place = Rect::from_min_size(pos2(left, row.min.y), vec2(row.width() * share, row.height()));
        if left > row.min.x {
            let stroke = egui::Stroke::new(theme::HAIRLINE, view.theme.line);
            view.painter.vline(left - theme::GAP, rect.min.y + 8.0..=rect.max.y - 7.0, stroke);
        }
        view.fit_left(place.with_max_x(place.max.x - 2.0 * theme::GAP), word, theme::LABEL, ink);
        left = place.max.x;
    }
    touched
}

/// Paints the title inside a page; here so that all titles look the same. Returns the area it covers.
pub fn title(view: &View<'_>, rect: Rect, words: &str) -> Rect {
    view.fit_left(rect, words, theme::SECONDARY, view.theme.text)
}

/// Width of the key of the open page, points.
const OPEN_PAGE_WIDTH: f32 = 96.0;
/// Width of ◀ and ▶ each, points.
const TURN_WIDTH: f32 = theme::TOUCH_TARGET;
/// Width between ◀ and ▶ of the key with the number of the row, which opens the map of the pages, points.
const MAP_WIDTH: f32 = theme::TOUCH_TARGET;

/// Which soft key was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftKeyPress {
    /// One of F1–F5.
    Act(SoftKeyAction),
    /// Shows this row: ◀, ▶, or the key of the open page.
    Row(usize),
    /// Opens the map of the pages, or closes it.
    Map,
}

/// Number of soft key rows of this machine.
pub const fn soft_key_row_count(view: &View<'_>) -> usize {
    soft_key::row_count(view.snapshot.simulated.is_some() || view.snapshot.bus.is_some())
}

/// The soft keys of a row as they act now.
pub fn soft_key_row(view: &View<'_>, row: usize) -> impl Iterator<Item = SoftKey> {
    soft_key::row_now(view.snapshot.kind, row, view.snapshot.state == RunState::Stopped)
}

/// Draws a row of soft keys between the key of the open page and ◀ ▶.
pub fn soft_keys(view: &View<'_>, rect: Rect, row: usize) -> Option<SoftKeyPress> {
    let open = soft_key::key_of_page(view.snapshot.page, view.snapshot.coordinates);
    let (page, rest) = rect.shrink2(vec2(theme::GAP, 3.0)).split_left(OPEN_PAGE_WIDTH);
    let (keys, turn) = rest.split_right(2.0 * TURN_WIDTH + MAP_WIDTH);
    let mut pressed = None;
    for (index, soft) in soft_key_row(view, row).enumerate() {
        if soft_key_ui(view, keys.trim_sides(theme::GAP).cell(index, 5), index, &soft, soft.action == open) {
            pressed = Some(SoftKeyPress::Act(soft.action));
        }
    }
    pressed.or(open_page_key(view, page, open).map(SoftKeyPress::Row)).or(turn_keys(view, turn, row))
}

/// Draws the key of the open page: it is lit in every row and names its place. Returns its row if it is touched.
fn open_page_key(view: &View<'_>, place: Rect, open: SoftKeyAction) -> Option<usize> {
    let label = open.label_on(view.snapshot.kind).get(view.lang);
    let response = view.touch_row(place, "soft-open-page", true, format!("{label} open-page"));
    keycap::plate(view, place, &response);
    let (tag, name) = place.trim_sides(4.0).split_top(18.0);
    let (row, index) = soft_key::place(view.snapshot.kind, open)?;
    let where_ = view.phrase(&phrase!("第 {row} 行 F{index}", "row {row} F{index}", row = row + 1, index = index + 1));
    view.line_centre(tag.trim_top(2.0), &where_, theme::SMALL, view.theme.muted);
    view.fit_centre(name.trim_bottom(3.0), label, theme::TITLE, view.theme.info);
    widget::selected_bar(view, place);
    response.clicked().then_some(row)
}

/// Draws ◀ and ▶ and between them the key with the number of the row, which opens the map of the pages.
fn turn_keys(view: &View<'_>, rect: Rect, row: usize) -> Option<SoftKeyPress> {
    let count = soft_key_row_count(view);
    let (previous, rest) = rect.split_left(TURN_WIDTH);
    let (number, next) = rest.split_right(TURN_WIDTH);
    let map = format!("{} page-map", view.text("全部页面", "all pages"));
    let response = keycap::plain(view, number.shrink2(vec2(2.0, 0.0)), "page-map", map);
    let (grid, figures) = number.split_top(0.52 * number.height());
    map_sign(view, grid.trim_top(6.0));
    view.line_centre(figures, &format!("{}/{count}", row + 1), theme::SMALL, view.theme.muted);
    let key = |place: Rect, sign: &str, name: &str| {
        let response = keycap::plain(view, place, ("soft", name), format!("{sign} {name}"));
        view.line_centre(place, sign, theme::TITLE, view.theme.text);
        response.clicked()
    };
    let back = key(previous, "◀", "previous-row");
    let on = key(next, "▶", "next-row");
    let turned = back.then_some((row + count - 1) % count).or(on.then_some((row + 1) % count));
    turned.map(SoftKeyPress::Row).or(response.clicked().then_some(SoftKeyPress::Map))
}

/// Three by two small keys: the map of the pages.
fn map_sign(view: &View<'_>, rect: Rect) {
    let size = vec2(7.0, 6.0);
    for row in 0..2 {
        for column in 0..3 {
            let off = vec2((column as f32 - 1.0) * (size.x + 2.0), (row as f32 - 0.5) * (size.y + 2.0));
            view.painter.rect_filled(Rect::from_center_size(rect.center() + off, size), 1.0, view.theme.text);
        }
    }
}

fn soft_key_ui(view: &View<'_>, place: Rect, index: usize, soft: &SoftKey, chosen: bool) -> bool {
    let (key, label) = (format!("F{}", index + 1), soft.label.get(view.lang));
    let response = view.touch_row(place, ("soft", &key), chosen, format!("{label} f{}", index + 1));
    keycap::plate(view, place, &response);
    let ink = if chosen { view.theme.info } else { view.theme.text };
    let tag = Rect::from_min_size(place.min + vec2(7.0, 3.0), vec2(30.0, 16.0));
    view.line_left(tag, &key, theme::SMALL, view.theme.muted);
    view.fit_centre(place.trim_sides(4.0).trim_top(16.0).trim_bottom(2.0), label, theme::TITLE, ink);
    if chosen {
        widget::selected_bar(view, place);
    }
    response.clicked()
}
