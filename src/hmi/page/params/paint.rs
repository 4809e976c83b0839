//! Drawing of the parameters: rows of bits, rows of numbers, details of the selected one, the input line.
//! Source: spec B6, H4, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Painter, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::list::{Line, List};
use super::{BIT_NAMES, SPACE};
use crate::defs::param::{Level, ParamAddress};
use crate::defs::param_row::{ParamRow, Sort};
use crate::defs::port;
use crate::defs::text::Said;
use crate::hmi::keycap::{self, Face};
use crate::hmi::letters;
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit, frame, put};
use crate::hmi::widget::{self, Look};

/// Height of a line with the gap below it.
pub const LINE: f32 = 50.0;
/// Heights of the details of the selected parameter and of each bit below them.
const DETAIL: f32 = 54.0;
const BIT: f32 = 24.0;
/// Width of the number at the start of a line.
const NUMBER: f32 = 64.0;

/// Rectangles of the page.
pub struct Places {
    pub tabs: Rect,
    pub search: Rect,
    pub level: Rect,
    pub list: Rect,
    pub detail: Rect,
    pub input: Rect,
    pub letters: Rect,
}

impl Places {
    /// `bits` of the selected parameter are listed in two columns; a single bit needs no list.
    pub fn new(rect: Rect, searching: bool, bits: usize) -> Self {
        let (main, input) = rect.split_top_bottom_at_y(rect.max.y - theme::INPUT);
        let pad = if searching { letters::SEARCH.height() } else { 0.0 };
        let (main, letters) = main.split_top_bottom_at_y(main.max.y - pad);
        let inside = main.shrink(theme::PAD);
        let (top, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        let (tabs, right) = top.split_left_right_at_fraction(0.56);
        let (search, level) = right.split_left_right_at_x(right.max.x - 136.0);
        let lines = if searching || bits < 2 { 0 } else { bits.div_ceil(2) };
        let search = Rect::from_min_max(search.min + vec2(SPACE, 0.0), search.max - vec2(SPACE, 0.0));
        let (list, detail) = rest.split_top_bottom_at_y(rest.max.y - DETAIL - lines as f32 * BIT);
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max - vec2(0.0, theme::GAP));
        Self { tabs, search, level, list, detail, input, letters: letters.shrink2(vec2(theme::GAP, 0.0)) }
    }
}

/// Data that the lines are drawn from.
pub struct Drawn<'a> {
    pub list: &'a List,
    pub cursor: usize,
    pub text: &'a str,
    pub refused: bool,
}

/// Key with the unlocked level; a touch unlocks or locks.
pub fn level_key(ui: &Ui, view: &View<'_>, rect: Rect, level: Level) -> bool {
    let open = level > Level::Operator;
    let words = if open {
        format!("{} {}", level.name().get(view.lang), view.say("锁定", "LOCK"))
    } else {
        view.say("输入密码", "UNLOCK").to_owned()
    };
    widget::push(ui, view, rect, "param-level", &words, Look { on: open, locked: !open })
}

/// Nothing was found: shows what to do.
pub fn nothing(painter: &Painter, view: &View<'_>, rect: Rect) {
    let words = view.say("没有找到参数", "no parameter found");
    let remedy = view.say("换一个词，或用号码查找，例如 P270", "try another word, or a number such as P270");
    let line = Rect::from_min_size(rect.center_top() + vec2(-rect.width() / 2.0, 16.0), vec2(rect.width(), 30.0));
    fit(painter, line, Align2::CENTER_CENTER, words, theme::SECONDARY, view.theme.text);
    let line = line.translate(vec2(0.0, 34.0));
    fit(painter, line, Align2::CENTER_CENTER, remedy, theme::LABEL, view.theme.quiet);
}

/// One line; returns the touched row.
pub fn line(ui: &Ui, view: &View<'_>, places: (Rect, Rect), index: usize, drawn: &Drawn<'_>) -> Option<usize> {
    match drawn.list.lines.get(index)? {
        Line::Bits(number, bits) => bit_line(ui, view, places, *number, bits, drawn),
        Line::One(row) => number_line(ui, view, places, *row, drawn).then_some(*row),
    }
}

fn bit_line(
    ui: &Ui,
    view: &View<'_>,
    (list, place): (Rect, Rect),
    number: u16,
    bits: &[Option<usize>; 8],
    drawn: &Drawn<'_>,
) -> Option<usize> {
    let painter = &ui.painter().with_clip_rect(list);
    let (name, cells) = place.split_left_right_at_x(place.min.x + NUMBER);
    put(
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
            card(painter, cell, view.theme.ground, view.theme.line);
            put(painter, tag, Align2::CENTER_CENTER, BIT_NAMES[column], theme::SMALL, view.theme.dim);
            put(painter, value, Align2::CENTER_CENTER, "·", theme::TITLE, view.theme.dim);
            continue;
        };
        let at = drawn.list.rows[row].at;
        let response = ui.interact(cell.intersect(list), Id::unique(("param", row)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, at.to_string()));
        if response.clicked() {
            touched = Some(row);
        }
        let chosen = row == drawn.cursor;
        let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
        keycap::plate(painter, view.theme, cell, face);
        let found = drawn.list.found[row];
        let ink = if found { view.theme.text } else { view.theme.quiet };
        put(painter, tag, Align2::CENTER_CENTER, BIT_NAMES[column], theme::SMALL, view.theme.quiet);
        let (words, ink) = shown(view, at, ink, chosen.then_some(drawn));
        put(painter, value, Align2::CENTER_CENTER, &words, theme::SECONDARY, ink);
        if chosen {
            frame(painter, cell, if drawn.refused { view.theme.alarm } else { view.theme.focus });
        }
    }
    touched
}

fn number_line(ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), row: usize, drawn: &Drawn<'_>) -> bool {
    let painter = &ui.painter().with_clip_rect(list);
    let known = &drawn.list.rows[row];
    let response = ui.interact(place.intersect(list), Id::unique(("param", row)), Sense::CLICK);
    let name = known.name.get(view.lang);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, known.at.to_string()));
    let chosen = row == drawn.cursor;
    let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
    keycap::plate(painter, view.theme, place, face);
    let inside = place.shrink2(vec2(8.0, 0.0));
    let (number, rest) = inside.split_left_right_at_x(place.min.x + NUMBER);
    put(painter, number, Align2::LEFT_CENTER, &known.at.to_string(), theme::TITLE, view.theme.text);
    let (words, right) = rest.split_left_right_at_x(rest.max.x - 268.0);
    let words = Rect::from_min_max(words.min, words.max - vec2(theme::GAP, 0.0));
    fit(painter, words, Align2::LEFT_CENTER, name, theme::LABEL, view.theme.text);
    let (value, unit) = right.split_left_right_at_x(right.min.x + 130.0);
    let (text, ink) = shown(view, known.at, view.theme.text, chosen.then_some(drawn));
    fit(painter, value, Align2::RIGHT_CENTER, &text, theme::SECONDARY, ink);
    let (unit, mark) = Rect::from_min_max(unit.min + vec2(8.0, 0.0), unit.max).split_left_right_at_x(unit.max.x - 62.0);
    match twice(view, known) {
        Some(port) => fit(
            painter,
            unit.union(mark),
            Align2::LEFT_CENTER,
            &format!("⚠ {} {port}", view.say("冲突", "conflict")),
            theme::LABEL,
            view.theme.hold,
        ),
        None => {
            fit(painter, mark, Align2::RIGHT_CENTER, known.level.name().get(view.lang), theme::SMALL, view.theme.quiet);
            fit(painter, unit, Align2::LEFT_CENTER, known.unit, theme::LABEL, view.theme.quiet)
        }
    };
    if chosen {
        frame(painter, place, if drawn.refused { view.theme.alarm } else { view.theme.focus });
    }
    response.clicked()
}

/// The value, or the text typed over it.
fn shown(view: &View<'_>, at: ParamAddress, ink: egui::Color32, typed: Option<&Drawn<'_>>) -> (String, egui::Color32) {
    match typed {
        Some(drawn) if drawn.refused => (drawn.text.to_owned(), view.theme.alarm_text),
        Some(drawn) if !drawn.text.is_empty() => (format!("{}_", drawn.text), view.theme.info),
        _ => (value(view, at), ink),
    }
}

fn value(view: &View<'_>, at: ParamAddress) -> String {
    view.snapshot.params.read(at).map_or_else(|_| "—".to_owned(), |value| value.to_string())
}

/// The port that this function shares with another one.
fn twice(view: &View<'_>, row: &ParamRow) -> Option<u8> {
    let (params, kind) = (&view.snapshot.params, view.snapshot.kind);
    match row.sort {
        Sort::Input(input) => {
            let found = port::input_conflicts(params).into_iter().find(|found| found.functions.contains(&input));
            found.map(|found| found.port)
        }
        Sort::Output(output) => {
            let found =
                port::output_conflicts(kind, params).into_iter().find(|found| found.functions.contains(&output));
            found.map(|found| found.port)
        }
        Sort::Bit | Sort::Number => None,
    }
}

/// The other functions on the same port.
fn company(view: &View<'_>, row: &ParamRow) -> Option<String> {
    let (params, kind) = (&view.snapshot.params, view.snapshot.kind);
    let names: Vec<&str> = match row.sort {
        Sort::Input(input) => {
            let found = port::input_conflicts(params).into_iter().find(|found| found.functions.contains(&input))?;
            found
                .functions
                .into_iter()
                .filter(|other| *other != input)
                .map(|other| other.name().get(view.lang))
                .collect()
        }
        Sort::Output(output) => {
            let found =
                port::output_conflicts(kind, params).into_iter().find(|found| found.functions.contains(&output))?;
            found
                .functions
                .into_iter()
                .filter(|other| *other != output)
                .map(|other| other.name().get(view.lang))
                .collect()
        }
        Sort::Bit | Sort::Number => return None,
    };
    Some(format!("⚠ {} {}", view.say("端口也用于", "port also used for"), names.join(view.say("、", ", "))))
}

/// Details of the selected parameter: name, factory value, level, conflict.
pub fn detail(painter: &Painter, view: &View<'_>, places: &Places, list: &List, cursor: usize) {
    let Some(row) = list.rows.get(cursor).filter(|_| !list.lines.is_empty()) else { return };
    let (place, others) = places.detail.split_top_bottom_at_y(places.detail.min.y + DETAIL);
    company_of_bits(painter, view, others, list, row);
    painter.hline(place.x_range(), place.min.y, Stroke::new(theme::HAIR, view.theme.line));
    let (top, below) = place.split_top_bottom_at_y(place.min.y + 28.0);
    let title = format!("{}  {}", row.at, row.name.get(view.lang));
    fit(painter, top, Align2::LEFT_CENTER, &title, theme::TITLE, view.theme.text);
    if let Some(words) = company(view, row) {
        fit(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.hold);
        return;
    }
    let closed = row.level > view.snapshot.access.level;
    let level = if closed {
        format!("{} · {}", row.level.name().get(view.lang), view.say("需要密码", "password needed"))
    } else {
        row.level.name().get(view.lang).to_owned()
    };
    let words = format!(
        "{} {} {} · {} {level}",
        view.say("出厂值", "factory"),
        row.factory,
        row.unit,
        view.say("级别", "level")
    );
    fit(painter, below, Align2::LEFT_CENTER, &words, theme::LABEL, view.theme.quiet);
}

/// All bits of the parameter with value and meaning, in two columns.
fn company_of_bits(painter: &Painter, view: &View<'_>, rect: Rect, list: &List, row: &ParamRow) {
    if rect.height() < BIT {
        return;
    }
    let bits = list.rows.iter().filter(|other| other.at.number == row.at.number && other.at.bit.is_some());
    let lines = (rect.height() / BIT).round() as usize;
    for (index, other) in bits.rev().enumerate() {
        let corner = rect.min + vec2((index / lines) as f32 * rect.width() / 2.0, (index % lines) as f32 * BIT);
        let place = Rect::from_min_size(corner, vec2(rect.width() / 2.0 - theme::PAD, BIT));
        let ink = if other.at == row.at { view.theme.info } else { view.theme.text };
        let (name, words) = place.split_left_right_at_x(place.min.x + 80.0);
        let bit = format!("BIT{} = {}", other.at.bit.unwrap_or(0), value(view, other.at));
        fit(painter, name, Align2::LEFT_CENTER, &bit, theme::LABEL, ink);
        fit(painter, words, Align2::LEFT_CENTER, other.name.get(view.lang), theme::LABEL, ink);
    }
}

/// `数据输入: P270=3000_   范围 0 … 60000 ms · 原值 3000`
pub fn input_line(
    painter: &Painter,
    view: &View<'_>,
    rect: Rect,
    row: Option<&ParamRow>,
    text: &str,
    refused: Option<&Said>,
) {
    painter.rect_filled(rect, 0.0, view.theme.surface);
    painter.hline(rect.x_range(), rect.min.y + 0.5, Stroke::new(theme::HAIR, view.theme.line));
    let Some(row) = row else { return };
    let line = rect.shrink2(vec2(theme::PAD, 2.0));
    let (left, right) = line.split_left_right_at_fraction(0.42);
    let words = format!("{} {}={text}", view.say("数据输入:", "INPUT:"), row.at);
    let (ink, told) = match refused {
        Some(reason) => (view.theme.alarm_text, (reason.get(view.lang).to_owned(), view.theme.alarm_text)),
        None => {
            let (range, old) = (row.range(), value(view, row.at));
            let range = range.get(view.lang);
            let words = format!("{} {range} · {} {old}", view.say("范围", "range"), view.say("原值", "was"));
            (view.theme.text, (words, view.theme.quiet))
        }
    };
    fit(painter, left, Align2::LEFT_CENTER, &words, theme::TITLE, ink);
    fit(
        painter,
        Rect::from_min_max(pos2(right.min.x, right.min.y), right.max),
        Align2::RIGHT_CENTER,
        &told.0,
        theme::LABEL,
        told.1,
    );
}
