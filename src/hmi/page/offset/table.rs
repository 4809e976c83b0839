//! Offset table, shared by offset page and dressing page: cursor, typed value and entry mode.
//! An increment or a measurement applies to one value; the next value is absolute again.
//! Source: spec K4.1, K7.6, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::hmi::entry::Edit;
use crate::hmi::keycap::{self, Face};
use crate::hmi::page::Typed;
use crate::hmi::page::input_line::{self, Told};
use crate::hmi::page::scroll::Scroll;
use crate::hmi::typing::{Heard, Typing};
use crate::hmi::view::{View, fit, frame, length, put};
use crate::hmi::{pictogram, theme, widget};
use crate::link::Command;
use crate::link::edit::{MOST_INCREMENT, OFFSETS, OffsetCommand, Part};
use crate::units::Axis;

/// Height of a line.
const LINE: f32 = 46.0;
/// Heights of the two header lines: parts, axes.
const HEAD: (f32, f32) = (22.0, 22.0);
/// Width of the offset number.
const NUMBER: f32 = 46.0;
/// Maximum number of columns: two parts of three axes.
const COLUMNS: usize = 6;

/// How a typed value is applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum How {
    /// Replaces the old value.
    #[default]
    Absolute,
    /// Is added to the old value: U, V, W.
    Increment,
    /// Is the present work coordinate of the axis.
    Measured,
}

/// Configuration of the table by its page.
pub struct Form<'a> {
    /// Id of the page.
    pub id: &'a str,
    /// Columns from the left.
    pub columns: &'a [(Part, Axis)],
    /// Entry modes that the page offers.
    pub hows: &'a [How],
    /// Wear, increments and measurements are locked by P22.0.
    pub locked: bool,
}

/// The columns of the parts: one for each axis of the machine.
#[must_use]
pub fn columns(view: &View<'_>, parts: &[Part]) -> Vec<(Part, Axis)> {
    let axes = || Axis::ALL.into_iter().filter(|axis| view.snapshot.axes[*axis].present);
    parts.iter().flat_map(|part| axes().map(|axis| (*part, axis))).collect()
}

/// State of the table.
#[derive(Debug, Default)]
pub struct Table {
    /// The value being typed.
    pub typing: Typing,
    row: usize,
    column: usize,
    how: How,
    scroll: Scroll,
}

impl Table {
    /// The page was opened; the offset in force is selected.
    pub fn open(&mut self, in_force: usize) {
        *self = Self { row: in_force.saturating_sub(1), ..Self::default() };
    }

    /// Handles the keyboard input of this frame.
    pub fn take(&mut self, view: &View<'_>, typed: &Typed<'_>, form: &Form<'_>) -> Vec<Command> {
        if let Heard::Refused(field) = self.typing.hear(&view.snapshot.edit) {
            let cell = field / form.hows.len();
            (self.row, self.column) = (cell / COLUMNS, cell % COLUMNS);
            self.how = form.hows[field % form.hows.len()];
        }
        self.column = self.column.min(form.columns.len().saturating_sub(1));
        let mut out = Vec::new();
        for sign in typed.text.chars() {
            self.letter(sign, form);
        }
        for edit in typed.edits {
            self.edit(*edit, form, &mut out);
        }
        out
    }

    /// U, V, W start an increment of the wear; X, Y, Z select an axis; M starts a measurement.
    fn letter(&mut self, sign: char, form: &Form<'_>) {
        let part = form.columns.get(self.column).map_or(Part::Wear, |(part, _)| *part);
        let (part, axis, how) = match sign.to_ascii_uppercase() {
            'U' => (Part::Wear, Some(Axis::X), How::Increment),
            'V' => (Part::Wear, Some(Axis::Y), How::Increment),
            'W' => (Part::Wear, Some(Axis::Z), How::Increment),
            'M' => (part, None, How::Measured),
            letter => match Axis::from_letter(letter) {
                Some(axis) => (part, Some(axis), self.how),
                None => return,
            },
        };
        let axis = axis.or(form.columns.get(self.column).map(|(_, axis)| *axis));
        let column = form.columns.iter().position(|column| Some(column.1) == axis && column.0 == part);
        if let (Some(column), true) = (column, form.hows.contains(&how)) {
            self.typing.clear();
            (self.column, self.how) = (column, how);
        }
    }

    fn edit(&mut self, edit: Edit, form: &Form<'_>, out: &mut Vec<Command>) {
        self.typing.next_key(edit);
        if edit == Edit::Cancel && self.typing.text.is_empty() && self.how != How::Absolute {
            self.how = How::Absolute;
            return;
        }
        if self.typing.key(edit) {
            return;
        }
        let count = form.columns.len();
        let cell = self.row * count + self.column;
        let cells = OFFSETS * count;
        match edit {
            Edit::Enter => out.extend(self.enter(form)),
            Edit::Up => self.go((cell + cells - count) % cells, form),
            Edit::Down => self.go((cell + count) % cells, form),
            Edit::Left | Edit::Previous => self.go((cell + cells - 1) % cells, form),
            Edit::Right | Edit::Next => self.go((cell + 1) % cells, form),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::LineStart | Edit::LineEnd | Edit::Cancel => {
            }
        }
    }

    fn go(&mut self, cell: usize, form: &Form<'_>) {
        (self.row, self.column) = (cell / form.columns.len(), cell % form.columns.len());
        self.how = How::Absolute;
        self.typing.clear();
        self.scroll.by_hand = false;
    }

    fn enter(&mut self, form: &Form<'_>) -> Option<Command> {
        let cell = self.row * form.columns.len() + self.column;
        if self.typing.text.is_empty() {
            self.go((cell + 1) % (OFFSETS * form.columns.len()), form);
            return None;
        }
        let (part, axis) = *form.columns.get(self.column)?;
        let number = self.row + 1;
        let value = match self.typing.number(self.most(part)) {
            Ok(value) => value,
            Err(reason) => {
                self.typing.refused = Some(reason);
                return None;
            }
        };
        let how = form.hows.iter().position(|how| *how == self.how).unwrap_or(0);
        self.typing.send((self.row * COLUMNS + self.column) * form.hows.len() + how);
        let command = match (self.how, part) {
            (How::Absolute, _) => {
                self.go((cell + 1) % (OFFSETS * form.columns.len()), form);
                Command::Offset(OffsetCommand::Set { number, part, axis, value })
            }
            (How::Increment, Part::Wear) => Command::AddWear { number, axis, by: value },
            (How::Increment, Part::Geometry) => Command::Offset(OffsetCommand::AddGeometry { number, axis, by: value }),
            (How::Measured, _) => Command::Offset(OffsetCommand::Measure { number, axis, value }),
        };
        self.how = How::Absolute;
        Some(command)
    }

    const fn most(&self, part: Part) -> f64 {
        match self.how {
            How::Increment => MOST_INCREMENT,
            How::Measured => Part::Geometry.most(),
            How::Absolute => part.most(),
        }
    }

    /// The keys that select the entry mode of the next value.
    pub fn hows(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, form: &Form<'_>) {
        let key = |how: &How| match how {
            How::Absolute => ("how-absolute", view.say("绝对值", "VALUE").to_owned()),
            How::Increment => ("how-increment", view.say("增量 U/W", "INCREMENT").to_owned()),
            How::Measured => ("how-measured", view.say("测量值", "MEASURED").to_owned()),
        };
        let keys: Vec<_> = form.hows.iter().map(key).collect();
        let chosen = form.hows.iter().position(|how| *how == self.how).unwrap_or(0);
        if let Some(index) = widget::tabs(ui, view, rect, &keys, chosen) {
            self.typing.clear();
            self.typing.pad = true;
            self.how = form.hows[index];
        }
    }

    /// Draws header and lines.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, form: &Form<'_>) {
        let (head, list) = rect.split_top_bottom_at_y(rect.min.y + HEAD.1 + parts_height(form));
        head_line(ui, head, view, form);
        let list = widget::whole_lines(list, LINE);
        if typed.pages != 0 {
            self.scroll.page(typed.pages, list, LINE);
        }
        if !self.scroll.by_hand {
            self.scroll.show(self.row, list, LINE);
        }
        let (first, last) = self.scroll.follow(ui, form.id, list, LINE, OFFSETS);
        for row in first..last {
            let top = list.min.y + ((row as f64 - self.scroll.top) * f64::from(LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, LINE - 2.0));
            self.line(ui, (list, place), view, row, form);
        }
        self.scroll.bar(ui, view, list, LINE, OFFSETS);
    }

    fn line(&mut self, ui: &Ui, (list, place): (Rect, Rect), view: &View<'_>, row: usize, form: &Form<'_>) {
        let painter = &ui.painter().with_clip_rect(list);
        let in_force = view.snapshot.offset_in_force == row + 1;
        let number = Rect::from_min_size(place.min, vec2(NUMBER, place.height()));
        let ink = if in_force { view.theme.info } else { view.theme.text };
        if in_force {
            painter.rect_filled(Rect::from_min_size(place.min, vec2(4.0, place.height())), 0.0, view.theme.info);
        }
        let words = format!("{:02}", row + 1);
        put(painter, number, Align2::CENTER_CENTER, &words, theme::TITLE, ink);
        for (column, (part, axis)) in form.columns.iter().enumerate() {
            let cell = cell(place, column, form);
            let touch = cell.intersect(list);
            let response = ui.interact(touch, Id::unique((form.id, row, column)), Sense::CLICK);
            let name = format!("{}-{:02}-{axis}", part.name().en, row + 1);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            if response.clicked() {
                if (row, column) != (self.row, self.column) {
                    let how = if self.typing.refused.is_some() { How::Absolute } else { self.how };
                    self.go(row * form.columns.len() + column, form);
                    self.how = how;
                }
                // After a touch the list must not scroll.
                self.scroll.by_hand = true;
                self.typing.pad = true;
            }
            let chosen = (row, column) == (self.row, self.column);
            let face = Face { pressed: response.is_pointer_button_down_on(), ..Face::default() };
            keycap::plate(painter, view.theme, cell, face);
            let inside = cell.shrink2(vec2(8.0, 2.0));
            let old = length(view.snapshot.offsets[row].part(*part)[*axis]);
            let (words, ink) = match chosen && !self.typing.text.is_empty() {
                true if self.typing.refused.is_some() => (self.typing.text.clone(), view.theme.alarm_text),
                true if self.how == How::Increment => (format!("+= {}_", self.typing.text), view.theme.info),
                true => (format!("{}_", self.typing.text), view.theme.info),
                false => (old, view.theme.text),
            };
            fit(painter, inside, Align2::RIGHT_CENTER, &words, theme::TITLE, ink);
            if chosen {
                let refused = self.typing.refused.is_some();
                frame(painter, cell, if refused { view.theme.alarm } else { view.theme.focus });
            }
        }
    }

    /// `数据输入: 磨耗 04 X += 0.01   当前 … 范围 …`
    pub fn input_line(&self, ui: &Ui, rect: Rect, view: &View<'_>, form: &Form<'_>) {
        let Some((part, axis)) = form.columns.get(self.column) else { return };
        let number = self.row + 1;
        let old = length(view.snapshot.offsets[self.row].part(*part)[*axis]);
        let (sign, part, then) = match self.how {
            How::Absolute => ("=", *part, format!("{} {old}", view.say("原值", "was"))),
            How::Increment => (" +=", *part, format!("{} {old}", view.say("原值", "was"))),
            How::Measured => {
                let work = length(view.snapshot.axes[*axis].work);
                (
                    view.say(" 测量值=", " measured="),
                    Part::Geometry,
                    format!("{} {axis} {work}", view.say("当前", "now")),
                )
            }
        };
        let what = format!("{} {number:02} {axis}{sign}", part.name().get(view.lang));
        let range = format!("{} ±{:.3} · {then}", view.say("范围", "range"), self.most(part));
        let name = if form.locked && (part == Part::Wear || self.how != How::Absolute) { "P22.0=0" } else { "" };
        input_line::ui(ui, view, rect, &self.typing, &Told { what: &what, name, range: &range });
    }
}

fn cell(line: Rect, column: usize, form: &Form<'_>) -> Rect {
    let width = (line.width() - NUMBER) / form.columns.len() as f32;
    let corner = pos2(line.min.x + NUMBER + column as f32 * width, line.min.y);
    Rect::from_min_size(corner, vec2(width - 4.0, line.height()))
}

/// A single part needs no caption.
fn parts_height(form: &Form<'_>) -> f32 {
    let first = form.columns.first().map(|column| column.0);
    if form.columns.iter().all(|column| Some(column.0) == first) { 0.0 } else { HEAD.0 }
}

/// Parts above axes; a lock where P22.0 forbids editing.
fn head_line(ui: &Ui, rect: Rect, view: &View<'_>, form: &Form<'_>) {
    let painter = ui.painter();
    let (parts, axes) = rect.split_top_bottom_at_y(rect.min.y + parts_height(form));
    let line = |rect: Rect| Rect::from_min_max(rect.min, rect.max - vec2(8.0, 0.0));
    let number = Rect::from_min_size(axes.min, vec2(NUMBER, axes.height()));
    put(painter, number, Align2::CENTER_CENTER, view.say("号", "No."), theme::SMALL, view.theme.quiet);
    let mut last = None;
    for (column, (part, axis)) in form.columns.iter().enumerate() {
        let below = cell(line(axes), column, form).shrink2(vec2(8.0, 0.0));
        fit(painter, below, Align2::RIGHT_CENTER, &axis.to_string(), theme::LABEL, view.theme.text);
        if last.replace(*part) == Some(*part) || parts_height(form) < HEAD.0 {
            continue;
        }
        let above = cell(line(parts), column, form).shrink2(vec2(8.0, 0.0));
        let taken = fit(painter, above, Align2::LEFT_CENTER, part.name().get(view.lang), theme::LABEL, view.theme.text);
        if form.locked && *part == Part::Wear {
            let lock = Rect::from_center_size(pos2(taken.max.x + 12.0, above.center().y), vec2(13.0, 13.0));
            pictogram::draw(painter, lock, pictogram::LOCK, view.theme.quiet);
        }
    }
    painter.hline(rect.x_range(), rect.max.y - 2.0, Stroke::new(theme::HAIR, view.theme.line));
}
