//! Drawing of the parameters: rows of bits, rows of numbers, details of the selected one, the input line.
//! Source: spec B6, H4, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Painter, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::list::{ParamLine, ParamList};
use super::{BIT_NAMES, ROW_GAP};
use crate::defs::param::{AccessLevel, ParamAddress};
use crate::defs::param_row::{ParamRow, ParamType};
use crate::defs::port_conflict;
use crate::defs::text::LocalizedText;
use crate::hmi::keycap::{self, KeycapState};
use crate::hmi::letter_pad;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame, text_line};
use crate::hmi::widget::{self, ButtonState};

/// Height of a line with the gap below it.
pub const LINE_HEIGHT: f32 = 50.0;
/// Heights of the details of the selected parameter and of each bit below them.
const DETAIL_HEIGHT: f32 = 54.0;
const BIT_HEIGHT: f32 = 24.0;
/// Width of the number at the start of a line.
const NUMBER_WIDTH: f32 = 64.0;

/// Rectangles of the page.
pub struct ParamLayout {
    pub tabs: Rect,
    pub search: Rect,
    pub level: Rect,
    pub list: Rect,
    pub detail: Rect,
    pub input: Rect,
    pub letters: Rect,
}

impl ParamLayout {
    /// `bits` of the selected parameter are listed in two columns; a single bit needs no list.
    pub fn new(rect: Rect, searching: bool, bits: usize) -> Self {
        let (main, input) = rect.split_top_bottom_at_y(rect.max.y - theme::INPUT);
        let pad = if searching { letter_pad::SEARCH_LAYOUT.height() } else { 0.0 };
        let (main, letters) = main.split_top_bottom_at_y(main.max.y - pad);
        let inside = main.shrink(theme::PAD);
        let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS_HEIGHT);
        let (tabs, right) = top.split_left_right_at_fraction(0.56);
        let (search, level) = right.split_left_right_at_x(right.max.x - 136.0);
        let lines = if searching || bits < 2 { 0 } else { bits.div_ceil(2) };
        let search = Rect::from_min_max(search.min + vec2(ROW_GAP, 0.0), search.max - vec2(ROW_GAP, 0.0));
        let (list, detail) = rest.split_top_bottom_at_y(rest.max.y - DETAIL_HEIGHT - lines as f32 * BIT_HEIGHT);
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max - vec2(0.0, theme::GAP));
        Self { tabs, search, level, list, detail, input, letters: letters.shrink2(vec2(theme::GAP, 0.0)) }
    }
}

/// Data that the lines are drawn from.
pub struct ParamListView<'a> {
    pub list: &'a ParamList,
    pub cursor: usize,
    pub text: &'a str,
    pub refused: bool,
}

/// Key with the unlocked level; a touch unlocks or locks.
pub fn level_key(ui: &Ui, view: &View<'_>, rect: Rect, level: AccessLevel) -> bool {
    let open = level > AccessLevel::Operator;
    let words = if open {
        format!("{} {}", level.name().get(view.lang), view.text("锁定", "LOCK"))
    } else {
        view.text("输入密码", "UNLOCK").to_owned()
    };
    widget::button(ui, view, rect, "param-level", &words, ButtonState { on: open, locked: !open })
}

/// Nothing was found: shows what to do.
pub fn no_match(painter: &Painter, view: &View<'_>, rect: Rect) {
    let words = view.text("没有找到参数", "no parameter found");
    let remedy = view.text("换一个词，或用号码查找，例如 P270", "try another word, or a number such as P270");
    let line = Rect::from_min_size(rect.center_top() + vec2(-rect.width() / 2.0, 16.0), vec2(rect.width(), 30.0));
    fit_text(painter, line, Align2::CENTER_CENTER, words, theme::SECONDARY, view.theme.text);
    let line = line.translate(vec2(0.0, 34.0));
    fit_text(painter, line, Align2::CENTER_CENTER, remedy, theme::LABEL, view.theme.muted);
}

/// One line; returns the touched row.
pub fn line(ui: &Ui, view: &View<'_>, places: (Rect, Rect), index: usize, drawn: &ParamListView<'_>) -> Option<usize> {
    match drawn.list.lines.get(index)? {
        ParamLine::Bits(number, bits) => bit_line(ui, view, places, *number, bits, drawn),
        ParamLine::Single(row) => number_line(ui, view, places, *row, drawn).then_some(*row),
    }
}

fn bit_line(
    ui: &Ui,
    view: &View<'_>,
    (list, place): (Rect, Rect),
    number: u16,
    bits: &[Option<usize>; 8],
    drawn: &ParamListView<'_>,
) -> Option<usize> {
    let painter = &ui.painter().with_clip_rect(list);
    let (name, cells) = place.split_left_right_at_x(place.min.x + NUMBER_WIDTH);
    text_line(
        painter,
        name.shrink2(vec2(8.0, 0.0)),
        Align2::LEFT_CENTER,
        &format!("P{number}"),
        theme::TITLE,
        view.theme.text,
    );
    let width = (cells.width() + 4.0) / 8.0;
    let mut touched = None;
    for (column, row) in bits.iter().enumerate() {
        let corner = cells.min + vec2(column as f32 * width, 0.0);
        let cell = Rect::from_min_size(corner, vec2(width - 4.0, cells.height()));
        let (tag, value) = cell.split_top_bottom_at_fraction(0.42);
        let Some(row) = *row else {
            card(painter, cell, view.theme.background, view.theme.line);
            text_line(painter, tag, Align2::CENTER_CENTER, BIT_NAMES[column], theme::SMALL, view.theme.disabled);
            text_line(painter, value, Align2::CENTER_CENTER, "·", theme::TITLE, view.theme.disabled);
            continue;
        };
        let at = drawn.list.rows[row].address;
        let response = ui.interact(cell.intersect(list), Id::unique(("param", row)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, at.to_string()));
        if response.clicked() {
            touched = Some(row);
        }
        let chosen = row == drawn.cursor;
        let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
        keycap::paint_body(painter, view.theme, cell, face);
        let found = drawn.list.matches[row];
        let ink = if found { view.theme.text } else { view.theme.muted };
        text_line(painter, tag, Align2::CENTER_CENTER, BIT_NAMES[column], theme::SMALL, view.theme.muted);
        let (words, ink) = shown_value(view, at, ink, chosen.then_some(drawn));
        text_line(painter, value, Align2::CENTER_CENTER, &words, theme::SECONDARY, ink);
        if chosen {
            focus_frame(painter, cell, if drawn.refused { view.theme.alarm } else { view.theme.focus });
        }
    }
    touched
}

fn number_line(ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), row: usize, drawn: &ParamListView<'_>) -> bool {
    let painter = &ui.painter().with_clip_rect(list);
    let known = &drawn.list.rows[row];
    let response = ui.interact(place.intersect(list), Id::unique(("param", row)), Sense::CLICK);
    let name = known.name.get(view.lang);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, known.address.to_string()));
    let chosen = row == drawn.cursor;
    let face = KeycapState { pressed: response.is_pointer_button_down_on(), ..KeycapState::default() };
    keycap::paint_body(painter, view.theme, place, face);
    let inside = place.shrink2(vec2(8.0, 0.0));
    let (number, rest) = inside.split_left_right_at_x(place.min.x + NUMBER_WIDTH);
    text_line(painter, number, Align2::LEFT_CENTER, &known.address.to_string(), theme::TITLE, view.theme.text);
    let (words, right) = rest.split_left_right_at_x(rest.max.x - 268.0);
    let words = Rect::from_min_max(words.min, words.max - vec2(theme::GAP, 0.0));
    fit_text(painter, words, Align2::LEFT_CENTER, &name, theme::LABEL, view.theme.text);
    let (value, unit) = right.split_left_right_at_x(right.min.x + 130.0);
    let (text, ink) = shown_value(view, known.address, view.theme.text, chosen.then_some(drawn));
    fit_text(painter, value, Align2::RIGHT_CENTER, &text, theme::SECONDARY, ink);
    let (unit, mark) = Rect::from_min_max(unit.min + vec2(8.0, 0.0), unit.max).split_left_right_at_x(unit.max.x - 62.0);
    match conflicting_port(view, known) {
        Some(port) => fit_text(
            painter,
            unit.union(mark),
            Align2::LEFT_CENTER,
            &format!("⚠ {} {port}", view.text("冲突", "conflict")),
            theme::LABEL,
            view.theme.hold,
        ),
        None => {
            fit_text(
                painter,
                mark,
                Align2::RIGHT_CENTER,
                known.level.name().get(view.lang),
                theme::SMALL,
                view.theme.muted,
            );
            fit_text(painter, unit, Align2::LEFT_CENTER, known.unit, theme::LABEL, view.theme.muted)
        }
    };
    if chosen {
        focus_frame(painter, place, if drawn.refused { view.theme.alarm } else { view.theme.focus });
    }
    response.clicked()
}

/// The value, or the text typed over it.
fn shown_value(
    view: &View<'_>,
    at: ParamAddress,
    ink: egui::Color32,
    typed: Option<&ParamListView<'_>>,
) -> (String, egui::Color32) {
    match typed {
        Some(drawn) if drawn.refused => (drawn.text.to_owned(), view.theme.alarm_text),
        Some(drawn) if !drawn.text.is_empty() => (format!("{}_", drawn.text), view.theme.info),
        _ => (value_text(view, at), ink),
    }
}

fn value_text(view: &View<'_>, at: ParamAddress) -> String {
    view.snapshot.params.read(at).map_or_else(|_| "—".to_owned(), |value| value.to_string())
}

/// The port that this function shares with another one.
fn conflicting_port(view: &View<'_>, row: &ParamRow) -> Option<u8> {
    let (params, kind) = (&view.snapshot.params, view.snapshot.kind);
    match row.param_type {
        ParamType::Input(input) => {
            let found =
                port_conflict::input_conflicts(params).into_iter().find(|found| found.functions.contains(&input));
            found.map(|found| found.port)
        }
        ParamType::Output(output) => {
            let found = port_conflict::output_conflicts(kind, params)
                .into_iter()
                .find(|found| found.functions.contains(&output));
            found.map(|found| found.port)
        }
        ParamType::Bit | ParamType::Number => None,
    }
}

/// The other functions on the same port.
fn other_functions(view: &View<'_>, row: &ParamRow) -> Option<String> {
    let (params, kind) = (&view.snapshot.params, view.snapshot.kind);
    let names: Vec<&str> = match row.param_type {
        ParamType::Input(input) => {
            let found =
                port_conflict::input_conflicts(params).into_iter().find(|found| found.functions.contains(&input))?;
            found
                .functions
                .into_iter()
                .filter(|other| *other != input)
                .map(|other| other.name().get(view.lang))
                .collect()
        }
        ParamType::Output(output) => {
            let found = port_conflict::output_conflicts(kind, params)
                .into_iter()
                .find(|found| found.functions.contains(&output))?;
            found
                .functions
                .into_iter()
                .filter(|other| *other != output)
                .map(|other| other.name().get(view.lang))
                .collect()
        }
        ParamType::Bit | ParamType::Number => return None,
    };
    Some(format!("⚠ {} {}", view.text("端口也用于", "port also used for"), names.join(view.text("、", ", "))))
}

/// Details of the selected parameter: name, factory value, level, conflict.
pub fn detail(painter: &Painter, view: &View<'_>, places: &ParamLayout, list: &ParamList, cursor: usize) {
    let Some(row) = list.rows.get(cursor).filter(|_| !list.lines.is_empty()) else { return };
    let (place, others) = places.detail.split_top_bottom_at_y(places.detail.min.y + DETAIL_HEIGHT);
    bit_list(painter, view, others, list, row);
    painter.hline(place.x_range(), place.min.y, Stroke::new(theme::HAIRLINE, view.theme.line));
    let (top, below) = place.split_top_bottom_at_y(place.min.y + 28.0);
    let title = format!("{}  {}", row.address, row.name.get(view.lang));
    fit_text(painter, top, Align2::LEFT_CENTER, &title, theme::TITLE, view.theme.text);
    if let Some(words) = other_functions(view, row) {
        fit_text(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.hold);
        return;
    }
    let closed = row.level > view.snapshot.access.level;
    let level = if closed {
        format!("{} · {}", row.level.name().get(view.lang), view.text("需要密码", "password needed"))
    } else {
        row.level.name().get(view.lang).to_owned()
    };
    let words = format!(
        "{} {} {} · {} {level}",
        view.text("出厂值", "factory"),
        row.factory,
        row.unit,
        view.text("级别", "level")
    );
    fit_text(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.muted);
}

/// All bits of the parameter with value and meaning, in two columns.
fn bit_list(painter: &Painter, view: &View<'_>, rect: Rect, list: &ParamList, row: &ParamRow) {
    if rect.height() < BIT_HEIGHT {
        return;
    }
    let bits =
        list.rows.iter().filter(|other| other.address.number == row.address.number && other.address.bit.is_some());
    let lines = (rect.height() / BIT_HEIGHT).round() as usize;
    for (index, other) in bits.rev().enumerate() {
        let corner = rect.min + vec2((index / lines) as f32 * rect.width() / 2.0, (index % lines) as f32 * BIT_HEIGHT);
        let place = Rect::from_min_size(corner, vec2(rect.width() / 2.0 - theme::PAD, BIT_HEIGHT));
        let ink = if other.address == row.address { view.theme.info } else { view.theme.text };
        let (name, words) = place.split_left_right_at_x(place.min.x + 80.0);
        let bit = format!("BIT{} = {}", other.address.bit.unwrap_or(0), value_text(view, other.address));
        fit_text(painter, name, Align2::LEFT_CENTER, &bit, theme::LABEL, ink);
        fit_text(painter, words, Align2::LEFT_CENTER, &other.name.get(view.lang), theme::LABEL, ink);
    }
}

/// `数据输入: P270=3000_   范围 0 … 60000 ms · 原值 3000`
pub fn input_line(
    painter: &Painter,
    view: &View<'_>,
    rect: Rect,
    row: Option<&ParamRow>,
    text: &str,
    refused: Option<&LocalizedText>,
) {
    painter.rect_filled(rect, 0.0, view.theme.surface);
    painter.hline(rect.x_range(), rect.min.y + 0.5, Stroke::new(theme::HAIRLINE, view.theme.line));
    let Some(row) = row else { return };
    let line = rect.shrink2(vec2(theme::PAD, 2.0));
    let (left, right) = line.split_left_right_at_fraction(0.42);
    let words = format!("{} {}={text}", view.text("数据输入:", "INPUT:"), row.address);
    let (ink, told) = match refused {
        Some(reason) => (view.theme.alarm_text, (reason.get(view.lang).into_owned(), view.theme.alarm_text)),
        None => {
            let (range, old) = (row.range(), value_text(view, row.address));
            let range = range.get(view.lang);
            let words = format!("{} {range} · {} {old}", view.text("范围", "range"), view.text("原值", "was"));
            (view.theme.text, (words, view.theme.muted))
        }
    };
    fit_text(painter, left, Align2::LEFT_CENTER, &words, theme::TITLE, ink);
    fit_text(
        painter,
        Rect::from_min_max(pos2(right.min.x, right.min.y), right.max),
        Align2::RIGHT_CENTER,
        &told.0,
        theme::LABEL,
        told.1,
    );
}
