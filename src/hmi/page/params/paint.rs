//! Drawing of the parameters: rows of bits, rows of numbers, details of the selected one, the input line.
//! Source: spec B6, H4, H6.

use egui::{Rect, vec2};

use super::list::{ParamLine, ParamList};
use super::{BIT_NAMES, ROW_GAP};
use crate::defs::param::{AccessLevel, ParamAddress};
use crate::defs::param_row::{ParamRow, ParamType};
use crate::defs::port_conflict;
use crate::hmi::page::input_line;
use crate::hmi::{Area, FieldEditor, PageKey, ValueField, View, keycap, letter_pad, theme, widget};

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
        let (main, input) = rect.split_bottom(theme::INPUT);
        let pad = if searching { letter_pad::HEIGHT } else { 0.0 };
        let (main, letters) = main.split_bottom(pad);
        let (top, rest) = main.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (tabs, right) = top.split_left_right_at_fraction(0.56);
        let (search, level) = right.split_right(136.0);
        let lines = if searching || bits < 2 { 0 } else { bits.div_ceil(2) };
        let (list, detail) = rest.split_bottom(DETAIL_HEIGHT + lines as f32 * BIT_HEIGHT);
        Self {
            tabs,
            search: search.trim_sides(ROW_GAP),
            level,
            list: list.shrink2(vec2(0.0, theme::GAP)),
            detail,
            input,
            letters: letters.trim_sides(theme::GAP),
        }
    }
}

/// Data that the lines are drawn from.
pub struct ParamListView<'a> {
    pub list: &'a ParamList,
    pub cursor: usize,
    pub typing: &'a FieldEditor,
}

/// Key with the unlocked level; a touch unlocks or locks.
pub fn level_key(view: &View<'_>, rect: Rect, level: AccessLevel) -> bool {
    let open = level > AccessLevel::Operator;
    let words = if open {
        format!("{} {}", level.name().get(view.lang), view.text("锁定", "LOCK"))
    } else {
        view.text("输入密码", "UNLOCK").to_owned()
    };
    widget::button(view, rect, PageKey::new("param-level", &words).on(open).locked(!open))
}

/// Nothing was found: shows what to do.
pub fn no_match(view: &View<'_>, rect: Rect) {
    let words = view.text("没有找到参数", "no parameter found");
    let remedy = view.text("换一个词，或用号码查找，例如 P270", "try another word, or a number such as P270");
    view.fit_centre(rect.band(16.0, 30.0), words, theme::SECONDARY, view.theme.text);
    view.fit_centre(rect.band(50.0, 30.0), remedy, theme::LABEL, view.theme.muted);
}

/// One line; returns the touched row.
pub fn line(view: &View<'_>, place: Rect, index: usize, drawn: &ParamListView<'_>) -> Option<usize> {
    match drawn.list.lines.get(index)? {
        ParamLine::Bits(number, bits) => {
            let (name, cells) = place.split_left(NUMBER_WIDTH);
            view.line_left(name.trim_sides(8.0), &format!("P{number}"), theme::TITLE, view.theme.text);
            bit_cells(view, cells, bits, drawn)
        }
        ParamLine::Single(row) => number_line(view, place, *row, drawn).then_some(*row),
    }
}

fn bit_cells(view: &View<'_>, cells: Rect, bits: &[Option<usize>; 8], drawn: &ParamListView<'_>) -> Option<usize> {
    let width = (cells.width() + 4.0) / 8.0;
    let mut touched = None;
    for (column, row) in bits.iter().enumerate() {
        let corner = cells.min + vec2(column as f32 * width, 0.0);
        let cell = Rect::from_min_size(corner, vec2(width - 4.0, cells.height()));
        let (tag, value) = cell.split_top_bottom_at_fraction(0.42);
        let Some(row) = *row else {
            view.filled_card(cell, view.theme.background, view.theme.line);
            view.line_centre(tag, BIT_NAMES[column], theme::SMALL, view.theme.disabled);
            view.line_centre(value, "·", theme::TITLE, view.theme.disabled);
            continue;
        };
        let at = drawn.list.rows[row].address;
        let response = view.touch(cell, ("param", row), at);
        if response.clicked() {
            touched = Some(row);
        }
        keycap::plate(view, cell, &response);
        view.line_centre(tag, BIT_NAMES[column], theme::SMALL, view.theme.muted);
        let old = value_text(view, at);
        let ink = if drawn.list.matches[row] { view.theme.text } else { view.theme.muted };
        let typing = drawn.typing_in(row);
        let (words, ink) = typing.map_or((old.clone(), ink), |typing| typing.shown(view, (old, ink)));
        view.line_centre(value, &words, theme::SECONDARY, ink);
        typing.inspect(|typing| typing.frame(view, cell));
    }
    touched
}

fn number_line(view: &View<'_>, place: Rect, row: usize, drawn: &ParamListView<'_>) -> bool {
    let known = &drawn.list.rows[row];
    let response = keycap::plain(view, place, ("param", row), known.address);
    let (number, rest) = place.trim_sides(8.0).split_left(NUMBER_WIDTH - 8.0);
    view.line_left(number, &known.address.to_string(), theme::TITLE, view.theme.text);
    let (words, right) = rest.split_right(268.0);
    view.fit_left(words.trim_right(theme::GAP), &known.name.get(view.lang), theme::LABEL, view.theme.text);
    let (value, unit) = right.split_left(130.0);
    let (words, ink) = (value_text(view, known.address), view.theme.text);
    let field = ValueField { plate: place, value, size: theme::SECONDARY, words, ink };
    FieldEditor::paint(drawn.typing_in(row), view, field);
    let unit = unit.trim_left(8.0);
    if let Some((port, _)) = shared_port(view, known) {
        view.fit_left(unit, &format!("⚠ {} {port}", view.text("冲突", "conflict")), theme::LABEL, view.theme.hold);
    } else {
        let (unit, mark) = unit.split_right(62.0);
        view.fit_right(mark, known.level.name().get(view.lang), theme::SMALL, view.theme.muted);
        view.fit_left(unit, known.unit, theme::LABEL, view.theme.muted);
    }
    response.clicked()
}

impl ParamListView<'_> {
    /// The editor of a row, if the row is selected.
    fn typing_in(&self, row: usize) -> Option<&FieldEditor> {
        (row == self.cursor).then_some(self.typing)
    }
}

fn value_text(view: &View<'_>, at: ParamAddress) -> String {
    view.snapshot.params.read(at).map_or_else(|_| "—".to_owned(), |value| value.to_string())
}

/// The port that this function shares with others, and the names of the others.
fn shared_port(view: &View<'_>, row: &ParamRow) -> Option<(u8, Vec<&'static str>)> {
    let params = &view.snapshot.params;
    match row.param_type {
        ParamType::Input(input) => {
            let all = port_conflict::input_conflicts(params);
            let found = all.into_iter().find(|found| found.functions.contains(&input))?;
            let others = found.functions.into_iter().filter(|other| *other != input);
            Some((found.port, others.map(|other| other.name().get(view.lang)).collect()))
        }
        ParamType::Output(output) => {
            let all = port_conflict::output_conflicts(params);
            let found = all.into_iter().find(|found| found.functions.contains(&output))?;
            let others = found.functions.into_iter().filter(|other| *other != output);
            Some((found.port, others.map(|other| other.name().get(view.lang)).collect()))
        }
        ParamType::Bit | ParamType::Number => None,
    }
}

/// Details of the selected parameter: name, factory value, level, conflict.
pub fn detail(view: &View<'_>, places: &ParamLayout, list: &ParamList, cursor: usize) {
    let Some(row) = list.rows.get(cursor).filter(|_| !list.lines.is_empty()) else { return };
    let (place, others) = places.detail.split_top(DETAIL_HEIGHT);
    bit_list(view, others, list, row);
    view.hairline(place, place.min.y);
    let (top, below) = place.split_top(28.0);
    view.fit_left(top, &format!("{}  {}", row.address, row.name.get(view.lang)), theme::TITLE, view.theme.text);
    if let Some((_, names)) = shared_port(view, row) {
        let words =
            format!("⚠ {} {}", view.text("端口也用于", "port also used for"), names.join(view.text("、", ", ")));
        view.fit_left(below, &words, theme::LABEL, view.theme.hold);
        return;
    }
    let factory = format!("{} {} {}", view.text("出厂值", "factory"), row.factory, row.unit);
    let mut words = format!("{factory} · {} {}", view.text("级别", "level"), row.level.name().get(view.lang));
    if row.level > view.snapshot.access.level {
        words = format!("{words} · {}", view.text("需要密码", "password needed"));
    }
    view.fit_left(below, &words, theme::LABEL, view.theme.muted);
}

/// All bits of the parameter with value and meaning, in two columns.
fn bit_list(view: &View<'_>, rect: Rect, list: &ParamList, row: &ParamRow) {
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
        let (name, words) = place.split_left(80.0);
        let bit = format!("BIT{} = {}", other.address.bit.unwrap_or(0), value_text(view, other.address));
        view.fit_left(name, &bit, theme::LABEL, ink);
        view.fit_left(words, &other.name.get(view.lang), theme::LABEL, ink);
    }
}

/// `数据输入: P270=3000   范围 0 … 60000 ms · 原值 3000`
pub fn input_line(view: &View<'_>, rect: Rect, row: Option<&ParamRow>, typing: &FieldEditor) {
    let line = input_line::bar(view, rect);
    let Some(row) = row else { return };
    let (left, right) = line.split_left_right_at_fraction(0.42);
    let ink = input_line::typed_text(view, left, &format!("{}=", row.address), typing);
    let told = match typing.refusal(view.lang) {
        Some(reason) => reason.into_owned(),
        None => view.range_and_old(&row.range().get(view.lang), &value_text(view, row.address)),
    };
    view.fit_right(right, &told, theme::LABEL, ink);
}
