//! Offset table, shared by offset page and dressing page: cursor, typed value and entry mode.
//! An increment or a measurement applies to one value; the next value is absolute again.
//! Source: spec K4.1, K7.6, H6.

use egui::{Rect, pos2, vec2};

use crate::defs::text::Text;
use crate::hmi::page::{InputPrompt, Scroll, ScrollList, input_line};
use crate::hmi::widget::page_keys;
use crate::hmi::{Area, CoreAnswer, EditKey, FieldEditor, KeyboardInput, View, keycap, pictogram, theme, widget};
use crate::link::Command;
use crate::link::edit::{MAX_INCREMENT, OFFSET_COUNT, OffsetCommand, OffsetPart};
use crate::units::Axis;

/// Heights of the two header lines: parts, axes.
const HEAD_HEIGHTS: (f32, f32) = (22.0, 22.0);
/// Width of the offset number.
const NUMBER_WIDTH: f32 = 46.0;
/// Maximum number of columns: two parts of three axes.
const MAX_COLUMNS: usize = 6;

page_keys! {
    /// How a typed value is applied.
    #[derive(Default)]
    EntryMode {
        /// Replaces the old value.
        #[default]
        Absolute = "how-absolute", "绝对值", "VALUE";
        /// Is added to the old value: U, V, W.
        Increment = "how-increment", "增量 U/W", "INCREMENT";
        /// Is the present work coordinate of the axis.
        Measured = "how-measured", "测量值", "MEASURED";
    }
}

/// Configuration of the table by its page.
pub struct OffsetTableSpec<'a> {
    /// Id of the page.
    pub id: &'a str,
    /// Columns from the left.
    pub columns: &'a [(OffsetPart, Axis)],
    /// Entry modes that the page offers.
    pub modes: &'a [EntryMode],
    /// Wear, increments and measurements are locked by P22.0.
    pub locked: bool,
}

/// The columns of the parts: one for each axis of the machine.
pub fn columns(view: &View<'_>, parts: &[OffsetPart]) -> Vec<(OffsetPart, Axis)> {
    parts.iter().flat_map(|part| view.axes().map(|axis| (*part, axis))).collect()
}

/// State of the table.
#[derive(Debug, Default)]
pub struct OffsetTable {
    /// The value being typed.
    pub typing: FieldEditor,
    row: usize,
    column: usize,
    mode: EntryMode,
    scroll: Scroll,
}

impl OffsetTable {
    /// The page was opened; the offset in force is selected.
    pub fn open(&mut self, in_force: usize) {
        *self = Self { row: in_force.saturating_sub(1), ..Self::default() };
    }

    /// Handles the keyboard input of this frame.
    pub fn handle_typed(&mut self, view: &View<'_>, typed: &KeyboardInput, form: &OffsetTableSpec<'_>) -> Vec<Command> {
        self.typing.follow_lock(view.snapshot);
        if let CoreAnswer::Refused(field) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            let cell = field / form.modes.len();
            (self.row, self.column) = (cell / MAX_COLUMNS, cell % MAX_COLUMNS);
            self.mode = form.modes[field % form.modes.len()];
        }
        self.column = self.column.min(form.columns.len().saturating_sub(1));
        let mut out = Vec::new();
        typed.text.chars().for_each(|sign| self.handle_letter(sign, form));
        typed.edits.iter().for_each(|edit| self.edit(*edit, form, &mut out));
        out
    }

    /// U, V, W start an increment of the wear; X, Y, Z select an axis; M starts a measurement.
    fn handle_letter(&mut self, sign: char, form: &OffsetTableSpec<'_>) {
        let part = form.columns.get(self.column).map_or(OffsetPart::Wear, |(part, _)| *part);
        let (part, axis, how) = match sign.to_ascii_uppercase() {
            'U' => (OffsetPart::Wear, Some(Axis::X), EntryMode::Increment),
            'V' => (OffsetPart::Wear, Some(Axis::Y), EntryMode::Increment),
            'W' => (OffsetPart::Wear, Some(Axis::Z), EntryMode::Increment),
            'M' => (part, None, EntryMode::Measured),
            letter => match Axis::from_letter(letter) {
                Some(axis) => (part, Some(axis), self.mode),
                None => return,
            },
        };
        let axis = axis.or(form.columns.get(self.column).map(|(_, axis)| *axis));
        let column = form.columns.iter().position(|column| Some(column.1) == axis && column.0 == part);
        if let (Some(column), true) = (column, form.modes.contains(&how)) {
            self.typing.clear();
            (self.column, self.mode) = (column, how);
        }
    }

    fn edit(&mut self, edit: EditKey, form: &OffsetTableSpec<'_>, out: &mut Vec<Command>) {
        self.typing.clear_refused(edit);
        if edit == EditKey::Cancel && self.typing.text.is_empty() && self.mode != EntryMode::Absolute {
            self.mode = EntryMode::Absolute;
            return;
        }
        if self.typing.handle_key(edit) {
            return;
        }
        let count = form.columns.len();
        let cell = self.row * count + self.column;
        if let Some(cell) = edit.step(cell, OFFSET_COUNT * count, count) {
            self.select_cell(cell, form);
        } else if edit == EditKey::Enter {
            out.extend(self.enter(form));
        }
    }

    fn select_cell(&mut self, cell: usize, form: &OffsetTableSpec<'_>) {
        (self.row, self.column) = (cell / form.columns.len(), cell % form.columns.len());
        self.mode = EntryMode::Absolute;
        self.typing.clear();
        self.scroll.user_scrolled = false;
    }

    fn enter(&mut self, form: &OffsetTableSpec<'_>) -> Option<Command> {
        let cell = self.row * form.columns.len() + self.column;
        if self.typing.text.is_empty() {
            self.select_cell((cell + 1) % (OFFSET_COUNT * form.columns.len()), form);
            return None;
        }
        let (part, axis) = *form.columns.get(self.column)?;
        let number = self.row + 1;
        let value = match self.typing.number(self.max_value(part)) {
            Ok(value) => value,
            Err(reason) => {
                self.typing.refused = Some(reason);
                return None;
            }
        };
        let how = form.modes.iter().position(|how| *how == self.mode).unwrap_or(0);
        self.typing.send((self.row * MAX_COLUMNS + self.column) * form.modes.len() + how);
        let command = match (self.mode, part) {
            (EntryMode::Absolute, _) => {
                self.select_cell((cell + 1) % (OFFSET_COUNT * form.columns.len()), form);
                Command::Offset(OffsetCommand::Set { number, part, axis, value })
            }
            (EntryMode::Increment, OffsetPart::Wear) => Command::AddWear { number, axis, increment: value },
            (EntryMode::Increment, OffsetPart::Geometry) => {
                Command::Offset(OffsetCommand::AddGeometry { number, axis, increment: value })
            }
            (EntryMode::Measured, _) => Command::Offset(OffsetCommand::Measure { number, axis, value }),
        };
        self.mode = EntryMode::Absolute;
        Some(command)
    }

    const fn max_value(&self, part: OffsetPart) -> f64 {
        match self.mode {
            EntryMode::Increment => MAX_INCREMENT,
            EntryMode::Measured => OffsetPart::Geometry.max_abs(),
            EntryMode::Absolute => part.max_abs(),
        }
    }

    /// The keys that select the entry mode of the next value.
    pub fn mode_keys(&mut self, rect: Rect, view: &View<'_>, form: &OffsetTableSpec<'_>) {
        let keys: Vec<_> = form.modes.iter().map(|how| (how.id(), how.label().get(view.lang).to_owned())).collect();
        let chosen = form.modes.iter().position(|how| *how == self.mode).unwrap_or(0);
        if let Some(index) = widget::tabs(view, rect, &keys, chosen) {
            self.typing.clear();
            self.typing.open_pad();
            self.mode = form.modes[index];
        }
    }

    /// Draws header and lines.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, form: &OffsetTableSpec<'_>) {
        let (head, list) = rect.split_top(HEAD_HEIGHTS.1 + parts_height(form));
        head_line(head, view, form);
        let rect = widget::round_to_lines(list, widget::ROW_HEIGHT);
        if !self.scroll.user_scrolled {
            self.scroll.scroll_to(self.row, rect, widget::ROW_HEIGHT);
        }
        let list = ScrollList { id: form.id, rect, row: widget::ROW_HEIGHT, gap: 2.0, count: OFFSET_COUNT };
        let (clipped, rows) = self.scroll.rows(view, &list, typed.scroll_pages);
        rows.into_iter().for_each(|(row, place)| self.line(place, &clipped, row, form));
    }

    fn line(&mut self, place: Rect, view: &View<'_>, row: usize, form: &OffsetTableSpec<'_>) {
        let in_force = view.snapshot.active_offset == row + 1;
        let ink = if in_force { view.theme.info } else { view.theme.text };
        if in_force {
            view.edge_bar(place, view.theme.info);
        }
        view.line_centre(place.split_left(NUMBER_WIDTH).0, &format!("{:02}", row + 1), theme::TITLE, ink);
        for (column, (part, axis)) in form.columns.iter().enumerate() {
            let cell = cell_rect(place, column, form);
            let name = format!("{}-{:02}-{axis}", part.name().en, row + 1);
            let response = view.touch(cell, (form.id, row, column), name);
            if response.clicked() {
                if (row, column) != (self.row, self.column) {
                    let how = if self.typing.refused.is_some() { EntryMode::Absolute } else { self.mode };
                    self.select_cell(row * form.columns.len() + column, form);
                    self.mode = how;
                }
                // After a touch the list must not scroll.
                self.scroll.user_scrolled = true;
                self.typing.open_pad();
            }
            keycap::field(view, cell, &response);
            let old = (view.length(view.snapshot.offsets[row].part(*part)[*axis]), view.theme.text);
            let chosen = (row, column) == (self.row, self.column);
            let (mut words, ink) = if chosen { self.typing.shown(view, old) } else { old };
            let typed = chosen && !self.typing.text.is_empty() && self.typing.refused.is_none();
            if typed && self.mode == EntryMode::Increment {
                words.insert_str(0, "+= ");
            }
            view.fit_right(cell.shrink2(vec2(8.0, 2.0)), &words, theme::TITLE, ink);
            if chosen {
                self.typing.frame(view, cell);
            }
        }
    }

    /// `数据输入: 磨耗 04 X += 0.01   当前 … 范围 …`
    pub fn input_line(&self, rect: Rect, view: &View<'_>, form: &OffsetTableSpec<'_>) {
        let Some((part, axis)) = form.columns.get(self.column) else { return };
        let number = self.row + 1;
        let old = view.length(view.snapshot.offsets[self.row].part(*part)[*axis]);
        let (sign, part, then) = match self.mode {
            EntryMode::Absolute => ("=", *part, format!("{} {old}", view.text("原值", "was"))),
            EntryMode::Increment => (" +=", *part, format!("{} {old}", view.text("原值", "was"))),
            EntryMode::Measured => {
                let work = view.length(view.snapshot.axes[*axis].work);
                let now = format!("{} {axis} {work}", view.text("当前", "now"));
                (view.text(" 测量值=", " measured="), OffsetPart::Geometry, now)
            }
        };
        let what = format!("{} {number:02} {axis}{sign}", part.name().get(view.lang));
        let range = format!("{} ±{:.3} · {then}", view.text("范围", "range"), self.max_value(part));
        let name =
            if form.locked && (part == OffsetPart::Wear || self.mode != EntryMode::Absolute) { "P22.0=0" } else { "" };
        input_line::ui_in_run(view, rect, &self.typing, &InputPrompt { label: &what, name, range: &range });
    }
}

fn cell_rect(line: Rect, column: usize, form: &OffsetTableSpec<'_>) -> Rect {
    let width = (line.width() - NUMBER_WIDTH) / form.columns.len() as f32;
    let corner = pos2(line.min.x + NUMBER_WIDTH + column as f32 * width, line.min.y);
    Rect::from_min_size(corner, vec2(width - 4.0, line.height()))
}

/// A single part needs no caption.
fn parts_height(form: &OffsetTableSpec<'_>) -> f32 {
    let first = form.columns.first().map(|column| column.0);
    if form.columns.iter().all(|column| Some(column.0) == first) { 0.0 } else { HEAD_HEIGHTS.0 }
}

/// Parts above axes; a lock where P22.0 forbids editing.
fn head_line(rect: Rect, view: &View<'_>, form: &OffsetTableSpec<'_>) {
    let (parts, axes) = rect.split_top(parts_height(form));
    let line = |rect: Rect| rect.trim_right(8.0);
    let number = Rect::from_min_size(axes.min, vec2(NUMBER_WIDTH, axes.height()));
    view.line_centre(number, view.text("号", "No."), theme::SMALL, view.theme.muted);
    let mut last = None;
    for (column, (part, axis)) in form.columns.iter().enumerate() {
        let below = cell_rect(line(axes), column, form).shrink2(vec2(8.0, 0.0));
        view.fit_right(below, &axis.to_string(), theme::LABEL, view.theme.text);
        if last.replace(*part) == Some(*part) || parts_height(form) < HEAD_HEIGHTS.0 {
            continue;
        }
        let above = cell_rect(line(parts), column, form).shrink2(vec2(8.0, 0.0));
        let taken = view.fit_left(above, part.name().get(view.lang), theme::LABEL, view.theme.text);
        if form.locked && *part == OffsetPart::Wear {
            let lock = Rect::from_center_size(pos2(taken.max.x + 12.0, above.center().y), vec2(13.0, 13.0));
            pictogram::draw(&view.painter, lock, pictogram::LOCK, view.theme.muted);
        }
    }
    view.hairline(rect, rect.max.y - 2.0);
}
