//! Offset table, shared by offset page and dressing page: cursor, typed value and entry mode.
//! An increment or a measurement applies to one value; the next value is absolute again.
//! Source: spec K4.1, K7.6, H6.

use egui::{Rect, pos2, vec2};

use crate::defs::text::Text;
use crate::hmi::page::{InputPrompt, Scroll, ScrollList, input_line};
use crate::hmi::widget::page_keys;
use crate::hmi::{Area, CoreAnswer, EditKey, FieldEditor, KeyboardInput, View, keycap, pictogram, theme, widget};
use crate::link::Command;
use crate::link::edit::{MAX_INCREMENT, OFFSET_COUNT, OffsetCommand, OffsetPart, OriginChange, origin_name};
use crate::units::Axis;

/// Heights of the two header lines: parts, axes.
const HEAD_HEIGHTS: (f32, f32) = (22.0, 22.0);
/// Highest place of the programmed point.
const MAX_TIP: f64 = 9.0;
/// Width of the offset number.
const NUMBER_WIDTH: f32 = 46.0;
/// Maximum number of columns: two parts of three axes, R and T.
const MAX_COLUMNS: usize = 8;

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetColumn {
    /// Geometry or wear of an axis.
    Length(OffsetPart, Axis),
    /// Radius of the circle for G41 and G42.
    Radius,
    /// Place of the programmed point of that circle.
    Tip,
    /// A coordinate of a work offset.
    Origin(Axis),
}

impl OffsetColumn {
    const fn part(self) -> Option<OffsetPart> {
        match self {
            Self::Length(part, _) => Some(part),
            Self::Radius | Self::Tip | Self::Origin(_) => None,
        }
    }

    const fn axis(self) -> Option<Axis> {
        match self {
            Self::Length(_, axis) | Self::Origin(axis) => Some(axis),
            Self::Radius | Self::Tip => None,
        }
    }

    /// The heading: an axis, R or T.
    const fn letter(self) -> char {
        match self {
            Self::Length(_, axis) | Self::Origin(axis) => axis.letter(),
            Self::Radius => 'R',
            Self::Tip => 'T',
        }
    }

    /// The caption of its group.
    const fn group(self) -> &'static Text {
        match self {
            Self::Length(part, _) => part.name(),
            Self::Radius | Self::Tip => const { &Text::new("半径补偿", "radius") },
            Self::Origin(_) => const { &Text::new("坐标系", "work offset") },
        }
    }

    /// The value of an offset as shown.
    fn shown(self, view: &View<'_>, row: usize) -> String {
        match self {
            Self::Length(part, axis) => view.length(view.snapshot.offsets.tools[row].part(part)[axis]),
            Self::Radius => view.length(view.snapshot.offsets.tools[row].radius_mm),
            Self::Tip => view.snapshot.offsets.tools[row].tip.to_string(),
            Self::Origin(axis) => view.length(view.snapshot.offsets.origins[row][axis]),
        }
    }

    /// The name by which it is found.
    fn id(self, row: usize) -> String {
        match self {
            Self::Length(part, axis) => format!("{}-{:02}-{axis}", part.name().en, row + 1),
            Self::Radius => format!("radius-{:02}", row + 1),
            Self::Tip => format!("tip-{:02}", row + 1),
            Self::Origin(axis) => format!("origin-{}-{axis}", origin_name(row)),
        }
    }
}

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
    pub columns: &'a [OffsetColumn],
    /// Number of lines, and the name of each.
    pub rows: (usize, fn(usize) -> String),
    /// The line that is in force, from 0.
    pub in_force: Option<usize>,
    /// Entry modes that the page offers.
    pub modes: &'a [EntryMode],
    /// Wear, increments and measurements are locked by P22.0.
    pub locked: bool,
}

/// The lines of the tool offsets.
pub const TOOL_OFFSET_ROWS: (usize, fn(usize) -> String) = (OFFSET_COUNT, |row| format!("{:02}", row + 1));

/// The columns of the parts: one for each axis of the machine.
pub fn columns(view: &View<'_>, parts: &[OffsetPart]) -> Vec<OffsetColumn> {
    parts.iter().flat_map(|part| view.axes().map(|axis| OffsetColumn::Length(*part, axis))).collect()
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
    /// The page was opened; the line in force, from 0, is selected.
    pub fn open(&mut self, in_force: usize) {
        *self = Self { row: in_force, ..Self::default() };
    }

    /// The cell that is selected, if it is one of a work offset: its line and axis.
    pub fn selected_origin(&self, form: &OffsetTableSpec<'_>) -> Option<(usize, Axis)> {
        match form.columns.get(self.column) {
            Some(OffsetColumn::Origin(axis)) => Some((self.row, *axis)),
            Some(OffsetColumn::Length(..) | OffsetColumn::Radius | OffsetColumn::Tip) | None => None,
        }
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
        let chosen = form.columns.get(self.column);
        let part = chosen.and_then(|column| column.part()).unwrap_or(OffsetPart::Wear);
        let (part, axis, how) = match sign.to_ascii_uppercase() {
            'U' => (OffsetPart::Wear, Some(Axis::X), EntryMode::Increment),
            'V' => (OffsetPart::Wear, Some(Axis::Y), EntryMode::Increment),
            'W' => (OffsetPart::Wear, Some(Axis::Z), EntryMode::Increment),
            'M' => (part, None, EntryMode::Measured),
            'R' | 'T' => {
                let letter = sign.to_ascii_uppercase();
                let column = form.columns.iter().position(|column| column.letter() == letter);
                self.select_column(column, EntryMode::Absolute);
                return;
            }
            letter => match Axis::from_letter(letter) {
                Some(axis) => (part, Some(axis), self.mode),
                None => return,
            },
        };
        let axis = axis.or(chosen.and_then(|column| column.axis()));
        let is_named =
            |of: &OffsetColumn, axis| *of == OffsetColumn::Length(part, axis) || *of == OffsetColumn::Origin(axis);
        let column = axis.and_then(|axis| form.columns.iter().position(|of| is_named(of, axis)));
        self.select_column(column.filter(|_| form.modes.contains(&how)), how);
    }

    fn select_column(&mut self, column: Option<usize>, how: EntryMode) {
        if let Some(column) = column {
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
        if let Some(cell) = edit.step(cell, form.rows.0 * count, count) {
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
            self.select_cell((cell + 1) % (form.rows.0 * form.columns.len()), form);
            return None;
        }
        let column = *form.columns.get(self.column)?;
        let number = self.row + 1;
        let value = match self.typing.number(self.max_value(column)) {
            Ok(value) => value,
            Err(reason) => {
                self.typing.refused = Some(reason);
                return None;
            }
        };
        let how = form.modes.iter().position(|how| *how == self.mode).unwrap_or(0);
        self.typing.send((self.row * MAX_COLUMNS + self.column) * form.modes.len() + how);
        let mode = std::mem::take(&mut self.mode);
        if mode == EntryMode::Absolute {
            self.select_cell((cell + 1) % (form.rows.0 * form.columns.len()), form);
        }
        let origin = |axis, change| Command::Offset(OffsetCommand::Origin { row: number - 1, axis, change });
        Some(match (mode, column) {
            (EntryMode::Absolute, OffsetColumn::Origin(axis)) => origin(axis, OriginChange::Set(value)),
            (EntryMode::Increment, OffsetColumn::Origin(axis)) => origin(axis, OriginChange::Add(value)),
            (EntryMode::Measured, OffsetColumn::Origin(axis)) => origin(axis, OriginChange::Measure(value)),
            (_, OffsetColumn::Radius) => Command::Offset(OffsetCommand::SetRadius { number, value }),
            (_, OffsetColumn::Tip) => Command::Offset(OffsetCommand::SetTip { number, value }),
            (EntryMode::Absolute, OffsetColumn::Length(part, axis)) => {
                Command::Offset(OffsetCommand::Set { number, part, axis, value })
            }
            (EntryMode::Increment, OffsetColumn::Length(OffsetPart::Wear, axis)) => {
                Command::AddWear { number, axis, increment: value }
            }
            (EntryMode::Increment, OffsetColumn::Length(OffsetPart::Geometry, axis)) => {
                Command::Offset(OffsetCommand::AddGeometry { number, axis, increment: value })
            }
            (EntryMode::Measured, OffsetColumn::Length(_, axis)) => {
                Command::Offset(OffsetCommand::Measure { number, axis, value })
            }
        })
    }

    const fn max_value(&self, column: OffsetColumn) -> f64 {
        match (column, self.mode) {
            (OffsetColumn::Radius, _) => OffsetPart::Wear.max_abs(),
            (OffsetColumn::Tip, _) => MAX_TIP,
            (OffsetColumn::Length(..) | OffsetColumn::Origin(_), EntryMode::Increment) => MAX_INCREMENT,
            (OffsetColumn::Length(part, _), EntryMode::Absolute) => part.max_abs(),
            (OffsetColumn::Length(..) | OffsetColumn::Origin(_), _) => OffsetPart::Geometry.max_abs(),
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
        let list = ScrollList { id: form.id, rect, row: widget::ROW_HEIGHT, gap: 2.0, count: form.rows.0 };
        let (clipped, rows) = self.scroll.rows(view, &list, typed.scroll_pages);
        rows.into_iter().for_each(|(row, place)| self.line(place, &clipped, row, form));
    }

    fn line(&mut self, place: Rect, view: &View<'_>, row: usize, form: &OffsetTableSpec<'_>) {
        let in_force = form.in_force == Some(row);
        let ink = if in_force { view.theme.info } else { view.theme.text };
        if in_force {
            view.edge_bar(place, view.theme.info);
        }
        view.line_centre(place.split_left(NUMBER_WIDTH).0, &(form.rows.1)(row), theme::TITLE, ink);
        for (column, of) in form.columns.iter().enumerate() {
            let cell = cell_rect(place, column, form);
            let response = view.touch(cell, (form.id, row, column), of.id(row));
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
            let old = (of.shown(view, row), view.theme.text);
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
        let Some(&column) = form.columns.get(self.column) else { return };
        let row = (form.rows.1)(self.row);
        let was = format!("{} {}", view.text("原值", "was"), column.shown(view, self.row));
        let (sign, column, then) = match (self.mode, column) {
            (EntryMode::Increment, OffsetColumn::Length(..) | OffsetColumn::Origin(_)) => (" +=", column, was),
            (EntryMode::Measured, OffsetColumn::Length(_, axis) | OffsetColumn::Origin(axis)) => {
                let work = view.length(view.snapshot.axes[axis].work);
                let now = format!("{} {axis} {work}", view.text("当前", "now"));
                let column = match column {
                    OffsetColumn::Origin(_) => column,
                    _ => OffsetColumn::Length(OffsetPart::Geometry, axis),
                };
                (view.text(" 测量值=", " measured="), column, now)
            }
            (EntryMode::Absolute, _) | (_, OffsetColumn::Radius | OffsetColumn::Tip) => ("=", column, was),
        };
        let what = format!("{} {row} {}{sign}", column.group().get(view.lang), column.letter());
        let most = self.max_value(column);
        let range = match column {
            OffsetColumn::Length(..) | OffsetColumn::Origin(_) => format!("±{most:.3}"),
            OffsetColumn::Radius => format!("0–{most:.3}"),
            OffsetColumn::Tip => format!("0–{most:.0}"),
        };
        let range = format!("{} {range} · {then}", view.text("范围", "range"));
        let is_locked = column.part() == Some(OffsetPart::Wear) || self.mode != EntryMode::Absolute;
        let name = if form.locked && is_locked { "P22.0=0" } else { "" };
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
    let first = form.columns.first().map(|column| column.part());
    if form.columns.iter().all(|column| Some(column.part()) == first) { 0.0 } else { HEAD_HEIGHTS.0 }
}

/// Parts above axes; a lock where P22.0 forbids editing.
fn head_line(rect: Rect, view: &View<'_>, form: &OffsetTableSpec<'_>) {
    let (parts, axes) = rect.split_top(parts_height(form));
    let line = |rect: Rect| rect.trim_right(8.0);
    let number = Rect::from_min_size(axes.min, vec2(NUMBER_WIDTH, axes.height()));
    view.line_centre(number, view.text("号", "No."), theme::SMALL, view.theme.muted);
    let mut last = None;
    for (column, of) in form.columns.iter().enumerate() {
        let below = cell_rect(line(axes), column, form).shrink2(vec2(8.0, 0.0));
        view.fit_right(below, &of.letter().to_string(), theme::LABEL, view.theme.text);
        if last.replace(of.part()) == Some(of.part()) || parts_height(form) < HEAD_HEIGHTS.0 {
            continue;
        }
        let above = cell_rect(line(parts), column, form).shrink2(vec2(8.0, 0.0));
        let taken = view.fit_left(above, of.group().get(view.lang), theme::LABEL, view.theme.text);
        if form.locked && of.part() == Some(OffsetPart::Wear) {
            let lock = Rect::from_center_size(pos2(taken.max.x + 12.0, above.center().y), vec2(13.0, 13.0));
            pictogram::draw(&view.painter, lock, pictogram::LOCK, view.theme.muted);
        }
    }
    view.hairline(rect, rect.max.y - 2.0);
}
