//! Leadscrew table of an axis: backlash and pitch error over position. Points are edited one by one or imported from a
//! CSV file on the USB drive, and drawn as two curves.
//! Source: spec B7, H6.

use egui::accesskit::Role;
use egui::{Align2, Color32, Rect, Shape, Stroke, pos2, vec2};

use crate::defs::leadscrew::{LeadscrewCompensation, LeadscrewPoint, MAX_POINTS};
use crate::defs::param::AccessLevel;
use crate::defs::text::{Text, phrase};
use crate::hmi::page::{InputPrompt, Scroll, ScrollList, input_line};
use crate::hmi::{
    Area, CoreAnswer, EditKey, FieldEditor, KeyboardInput, Login, PageKey, PageMessage, PendingRequests, Question,
    QuestionDialog, View, parse_number, theme, widget,
};
use crate::link::Command;
use crate::link::files::{FileRequest, Requester};
use crate::link::page_command::{PageCommand, PasswordScope};
use crate::units::Axis;

/// Column shares: number, position, backlash, pitch error.
const COLUMN_SHARES: [f32; 4] = [0.5, 1.2, 1.0, 1.0];
/// Values of a row, with the range shown.
const VALUE_COLUMNS: [(Text, &str); 3] = [
    (Text::new("位置", "position"), "-9999 … 9999 mm"),
    (Text::new("反向间隙", "backlash"), "0 … 2 mm"),
    (Text::new("螺距误差", "pitch error"), "-2 … 2 mm"),
];
/// Number of keys below the table.
const KEY_COUNT: usize = 5;
/// Distance of a new point behind the last one, mm.
const NEW_POINT_STEP_MM: f64 = 10.0;

/// Edit that waits for the machine builder's password.
#[derive(Clone, Debug)]
enum PendingEdit {
    /// A table; with the field and the text that changed it.
    Table(LeadscrewCompensation, Option<(usize, String)>),
    Import,
}

/// What the tab edits in this frame, and where its commands go.
struct TabContext<'a> {
    view: &'a View<'a>,
    axis: Axis,
    table: &'a LeadscrewCompensation,
    login: &'a mut Login,
    out: &'a mut Vec<Command>,
}

/// State of the tab.
#[derive(Debug, Default)]
pub struct LeadscrewTab {
    axis: usize,
    row: usize,
    column: usize,
    /// The key below the table that has the keyboard focus.
    focused_key: Option<usize>,
    scroll: Scroll,
    /// The value being typed.
    pub typing: FieldEditor,
    pending_edit: Option<PendingEdit>,
    question: QuestionDialog<()>,
    /// Exports and imports.
    asking: PendingRequests<()>,
    pub message: PageMessage,
}

impl LeadscrewTab {
    /// Draws the tab below the tabs of the page.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, typed: &KeyboardInput, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        let axes: Vec<Axis> = view.axes().collect();
        self.axis = self.axis.min(axes.len().saturating_sub(1));
        let Some(axis) = axes.get(self.axis).copied() else { return out };
        if let CoreAnswer::Refused(field) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            (self.row, self.column) = (field / VALUE_COLUMNS.len(), field % VALUE_COLUMNS.len());
        }
        let table = &view.snapshot.leadscrews[axis];
        let ctx = &mut TabContext { view, axis, table, login, out: &mut out };
        self.handle_answers(ctx);
        if !self.question.is_open() && !ctx.login.is_open() {
            self.handle_letters(&typed.text, &axes);
            typed.edits.iter().for_each(|edit| self.edit(*edit, ctx));
        }
        self.row = self.row.min(table.points().len().saturating_sub(1));
        let (page, input) = input_line::split(rect);
        let (top, rest) = page.trim_sides(theme::PAD).trim_bottom(theme::GAP).split_top(widget::KEYS_HEIGHT);
        let (body, keys) = rest.split_bottom(widget::KEYS_HEIGHT);
        self.axes(top, view, &axes);
        let (list, side) = body.shrink2(vec2(0.0, theme::GAP)).split_left_right_at_fraction(0.56);
        self.list(list.trim_right(theme::GAP), view, table, typed.scroll_pages);
        let (curves, words) = side.split_bottom(74.0);
        paint_curves(curves, view, table, self.row);
        self.hint(words.shrink2(vec2(0.0, theme::GAP)), view, axis);
        self.keys(keys, ctx);
        self.input(input, ctx);
        if let Some(((), Some(_))) = self.question.ui(rect, view, &typed.edits) {
            self.request_edit(PendingEdit::Table(LeadscrewCompensation::default(), None), ctx);
        }
        out
    }

    /// Sends a waiting edit after the password; handles the answer to a file request.
    fn handle_answers(&mut self, ctx: &mut TabContext<'_>) {
        if let Some(edit) = self.pending_edit.take() {
            if ctx.view.snapshot.access.level >= AccessLevel::Builder {
                self.send(edit, ctx);
            } else if ctx.login.is_open() {
                self.pending_edit = Some(edit);
            }
        }
        while let Some(((), answer)) = self.asking.poll(Requester::Leadscrew, &ctx.view.snapshot.files) {
            match answer {
                Ok(completion) => self.message.tell(completion.message),
                Err(refusal) => self.message.refuse(refusal.message()),
            }
        }
    }

    fn request_edit(&mut self, edit: PendingEdit, ctx: &mut TabContext<'_>) {
        self.message.clear();
        if ctx.view.snapshot.access.level >= AccessLevel::Builder {
            self.send(edit, ctx);
        } else {
            self.pending_edit = Some(edit);
            ctx.login.unlock(ctx.view, PasswordScope::Builder);
        }
    }

    fn send(&mut self, edit: PendingEdit, ctx: &mut TabContext<'_>) {
        ctx.out.push(match edit {
            PendingEdit::Table(table, typed) => {
                let (field, text) = typed.unwrap_or_else(|| (self.field(), String::new()));
                self.typing.send_text(field, text);
                Command::Page(PageCommand::EditLeadscrew(ctx.axis, table))
            }
            PendingEdit::Import => self.asking.send(Requester::Leadscrew, (), FileRequest::ImportLeadscrew(ctx.axis)),
        });
    }

    fn edit(&mut self, edit: EditKey, ctx: &mut TabContext<'_>) {
        if let Some(key) = self.focused_key {
            match edit {
                EditKey::Enter => self.press_key(key, ctx),
                EditKey::Up | EditKey::Cancel => self.focused_key = None,
                EditKey::Down => {}
                _ => self.focused_key = Some(edit.step(key, KEY_COUNT, KEY_COUNT).unwrap_or(key)),
            }
            return;
        }
        if self.typing.handle_key(edit) {
            return;
        }
        let last = ctx.table.points().len().saturating_sub(1);
        let (row, column) = (self.row, self.column);
        match edit {
            EditKey::Enter if self.typing.text.is_empty() => self.select_next(last),
            EditKey::Enter => self.enter(ctx),
            EditKey::Up => self.select_cell(row.saturating_sub(1), column),
            // The keys are below the table.
            EditKey::Down if row >= last => self.focused_key = Some(0),
            EditKey::Down => self.select_cell((row + 1).min(last), column),
            EditKey::Left | EditKey::Previous => self.select_cell(row, column.saturating_sub(1)),
            EditKey::Right | EditKey::Next => self.select_cell(row, (column + 1).min(VALUE_COLUMNS.len() - 1)),
            _ => {}
        }
    }

    /// X, Y, Z select the axis.
    fn handle_letters(&mut self, text: &str, axes: &[Axis]) {
        let axis = text.chars().last().and_then(Axis::from_letter);
        if let Some(index) = axis.and_then(|axis| axes.iter().position(|other| *other == axis)) {
            *self = Self { axis: index, ..Self::default() };
        }
    }

    /// The selected field, counted row by row.
    const fn field(&self) -> usize {
        self.row * VALUE_COLUMNS.len() + self.column
    }

    fn select_cell(&mut self, row: usize, column: usize) {
        if (row, column) != (self.row, self.column) {
            self.typing.clear();
        }
        (self.row, self.column) = (row, column);
        let seen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1.0, 6.0 * widget::ROW_HEIGHT));
        self.scroll.scroll_to(row, seen, widget::ROW_HEIGHT);
    }

    /// Selects the next field, row by row.
    fn select_next(&mut self, last: usize) {
        match self.column + 1 {
            column if column < VALUE_COLUMNS.len() => self.select_cell(self.row, column),
            _ => self.select_cell((self.row + 1).min(last), 0),
        }
    }

    /// Checks the whole table with the typed value and sends it.
    fn enter(&mut self, ctx: &mut TabContext<'_>) {
        let value = match parse_number(&self.typing.text) {
            Ok(value) => value,
            Err(message) => return self.typing.refused = Some(message),
        };
        let mut points = ctx.table.points().to_vec();
        let Some(point) = points.get_mut(self.row) else {
            return self.typing.refused =
                Some(Text::new("表中没有点，请先按 加点", "the table is empty: touch ADD POINT").into());
        };
        *value_mut(point, self.column) = value;
        match LeadscrewCompensation::from_points(&points) {
            Ok(table) => {
                let typed = (self.field(), self.typing.text.clone());
                self.select_next(points.len() - 1);
                self.request_edit(PendingEdit::Table(table, Some(typed)), ctx);
            }
            Err(message) => self.typing.refused = Some(message),
        }
    }

    /// Sends a table with other points; false if it is refused.
    fn send_points(&mut self, points: &[LeadscrewPoint], ctx: &mut TabContext<'_>) -> bool {
        match LeadscrewCompensation::from_points(points) {
            Ok(table) => self.request_edit(PendingEdit::Table(table, None), ctx),
            Err(message) => {
                self.message.refuse(message);
                return false;
            }
        }
        true
    }

    /// Inserts a point between the selected one and the next, or behind the last. Its values are interpolated.
    fn add_point(&mut self, ctx: &mut TabContext<'_>) {
        let mut points = ctx.table.points().to_vec();
        if points.len() >= MAX_POINTS {
            let message = phrase!("最多 {most} 点", "at most {most} points", most = MAX_POINTS);
            return self.message.refuse(message);
        }
        let position_mm = match (points.get(self.row), points.get(self.row + 1)) {
            (Some(here), Some(next)) => (here.position_mm + next.position_mm) / 2.0,
            (Some(here), None) => here.position_mm + NEW_POINT_STEP_MM,
            (None, _) => 0.0,
        };
        let at = (self.row + 1).min(points.len());
        let (backlash_mm, pitch_error_mm) = (ctx.table.backlash_mm(position_mm), ctx.table.pitch_error_mm(position_mm));
        points.insert(at, LeadscrewPoint { position_mm, backlash_mm, pitch_error_mm });
        if self.send_points(&points, ctx) {
            self.select_cell(at, 0);
        }
    }

    fn remove_point(&mut self, ctx: &mut TabContext<'_>) {
        let mut points = ctx.table.points().to_vec();
        if self.row < points.len() {
            points.remove(self.row);
            self.send_points(&points, ctx);
        }
    }

    fn axes(&mut self, rect: Rect, view: &View<'_>, axes: &[Axis]) {
        let ids = ["screw-x", "screw-y", "screw-z"];
        let name = |axis: &Axis| {
            let count = view.snapshot.leadscrews[*axis].points().len();
            (ids[*axis as usize], format!("{} {} {count}", axis.letter(), view.text("轴 · 点", "· points")))
        };
        let keys: Vec<(&str, String)> = axes.iter().map(name).collect();
        if let Some(axis) = widget::tabs(view, rect, &keys, self.axis) {
            *self = Self { axis, ..Self::default() };
        }
    }

    fn list(&mut self, rect: Rect, view: &View<'_>, table: &LeadscrewCompensation, pages: i32) {
        let (head, body) = rect.split_top(24.0);
        let head = head.trim_left(theme::GAP).trim_right(theme::PAD);
        let [position, backlash, pitch] = VALUE_COLUMNS.map(|(name, _)| name.get(view.lang));
        widget::table_header(view, head, COLUMN_SHARES, ["#", position, backlash, pitch]);
        let points = table.points();
        if points.is_empty() {
            let words = view.text(
                "没有补偿点：丝杠按无误差处理。按 加点 输入，或按 导入 从 U 盘读入 KT830-SCREW-轴.CSV。",
                "No points: no error is compensated. Touch ADD POINT, or IMPORT to read KT830-SCREW-AXIS.CSV from the USB stick.",
            );
            return view.note(body.shrink(theme::PAD), words);
        }
        let rect = widget::round_to_lines(body, widget::ROW_HEIGHT);
        let list = ScrollList { id: "screw", rect, row: widget::ROW_HEIGHT, gap: 3.0, count: points.len() };
        let (clipped, rows) = self.scroll.rows(view, &list, pages);
        rows.into_iter().for_each(|(index, line)| self.line(line, &clipped, index, &points[index]));
    }

    fn line(&mut self, line: Rect, view: &View<'_>, index: usize, point: &LeadscrewPoint) {
        let [number, places @ ..] = line.trim_left(theme::GAP).columns(COLUMN_SHARES);
        view.fit_left(number, &(index + 1).to_string(), theme::LABEL, view.theme.muted);
        for (column, place) in places.into_iter().enumerate() {
            let word = format!("{} {} screw-{index}-{column}", VALUE_COLUMNS[column].0.get(view.lang), index + 1);
            if view.touch_as(Role::TextInput, place, ("screw", index, column), word).clicked() {
                self.focused_key = None;
                self.select_cell(index, column);
                self.typing.pad_open = true;
            }
            let chosen = (index, column) == (self.row, self.column) && self.focused_key.is_none();
            view.filled_card(place, view.theme.raised, view.theme.line);
            if chosen {
                self.typing.frame(view, place);
            }
            let text = match chosen && !self.typing.text.is_empty() {
                true => self.typing.text.clone(),
                false => value_text(*value_mut(&mut point.clone(), column), column),
            };
            let refused = chosen && self.typing.refused.is_some();
            let ink = if refused { view.theme.alarm_text } else { view.theme.text };
            view.line_right(place.trim_sides(8.0), &text, theme::TITLE, ink);
        }
    }

    fn hint(&self, rect: Rect, view: &View<'_>, axis: Axis) {
        if let Some((words, ink)) = self.message.shown(view, view.theme.run) {
            view.paragraph(rect, &words, theme::LABEL, ink);
        } else if view.snapshot.axes[axis].homed {
            let words = view.text(
                "输入即生效，轴慢速补到位。机床坐标，X 为半径。",
                "Active at once; the axis moves there slowly. Machine coordinates, X as radius.",
            );
            view.note(rect, words);
        } else {
            let words =
                view.text("回零后生效。机床坐标，X 为半径。", "Active after homing. Machine coordinates, X as radius.");
            view.paragraph(rect, words, theme::LABEL, view.theme.hold);
        }
    }

    fn keys(&mut self, rect: Rect, ctx: &mut TabContext<'_>) {
        let view = ctx.view;
        let locked = view.snapshot.access.level < AccessLevel::Builder;
        let labels: [_; KEY_COUNT] = [
            ("screw-add", view.text("加点", "ADD POINT"), locked),
            ("screw-remove", view.text("删点", "REMOVE"), locked),
            ("screw-clear", view.text("清空", "CLEAR"), locked),
            ("screw-import", view.text("导入 CSV", "IMPORT"), locked),
            ("screw-export", view.text("导出 CSV", "EXPORT"), false),
        ];
        for (index, (id, label, locked)) in labels.into_iter().enumerate() {
            let place = rect.cell(index, KEY_COUNT);
            let touched = widget::button(view, place, PageKey::new(id, label).locked(locked));
            if self.focused_key == Some(index) {
                view.frame(place, view.theme.focus);
            }
            if touched {
                self.press_key(index, ctx);
            }
        }
    }

    /// Handles a key below the table.
    fn press_key(&mut self, key: usize, ctx: &mut TabContext<'_>) {
        self.typing.clear();
        self.typing.pad_open = false;
        match key {
            0 => self.add_point(ctx),
            1 => self.remove_point(ctx),
            2 if ctx.table.points().is_empty() => {}
            2 => self.question.ask((), clear_question(ctx.axis, ctx.table)),
            3 => self.request_edit(PendingEdit::Import, ctx),
            _ => {
                let export = FileRequest::ExportLeadscrew(ctx.axis, ctx.table.clone());
                ctx.out.push(self.asking.send(Requester::Leadscrew, (), export));
            }
        }
    }

    fn input(&self, rect: Rect, ctx: &TabContext<'_>) {
        let (view, (name, range)) = (ctx.view, VALUE_COLUMNS[self.column]);
        let (label, range) = ctx.table.points().get(self.row).map_or_else(Default::default, |point| {
            let old = value_text(*value_mut(&mut point.clone(), self.column), self.column);
            let label = format!("{} {} {}=", ctx.axis.letter(), self.row + 1, name.get(view.lang));
            (label, format!("{range}  {} {old}", view.text("原值", "old")))
        });
        input_line::ui(view, rect, &self.typing, &InputPrompt { label: &label, name: "", range: &range });
    }
}

fn clear_question(axis: Axis, table: &LeadscrewCompensation) -> Question {
    let points = table.points().len();
    let body = phrase!(
        "{axis} 轴的 {points} 个补偿点全部删除，可先导出。",
        "All {points} points of axis {axis} will be deleted; export them first if needed.",
        axis,
        points
    );
    Question::new(Text::new("清空补偿表？", "clear the table?"), body, ("question-clear", Text::new("清空", "CLEAR")))
}

const fn value_mut(point: &mut LeadscrewPoint, column: usize) -> &mut f64 {
    match column {
        0 => &mut point.position_mm,
        1 => &mut point.backlash_mm,
        _ => &mut point.pitch_error_mm,
    }
}

/// Positions with three decimals, errors with four: leadscrews are measured to 0.1 µm.
fn value_text(value: f64, column: usize) -> String {
    if column == 0 { format!("{value:.3}") } else { format!("{value:.4}") }
}

/// The colours of backlash and pitch error.
fn paint_legend(legend: Rect, view: &View<'_>, inks: [Color32; 2]) {
    let half = legend.split_left_right_at_fraction(0.5);
    for (place, (name, _), ink) in [(half.0, VALUE_COLUMNS[1], inks[0]), (half.1, VALUE_COLUMNS[2], inks[1])] {
        let mark = Rect::from_min_size(pos2(place.min.x, place.center().y - 1.5), vec2(14.0, 3.0));
        view.painter.rect_filled(mark, 1.0, ink);
        let words = place.with_min_x(place.min.x + 20.0);
        view.fit_left(words, &format!("{} mm", name.get(view.lang)), theme::SMALL, view.theme.muted);
    }
}

/// Backlash and pitch error over position, with the selected point.
fn paint_curves(rect: Rect, view: &View<'_>, table: &LeadscrewCompensation, row: usize) {
    if table.points().is_empty() {
        return;
    }
    view.card(rect);
    let (legend, plot) = rect.shrink(theme::PAD).split_top(22.0);
    let inks = [view.theme.info, view.theme.hold];
    paint_legend(legend, view, inks);
    let points = table.points();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let values = points.iter().flat_map(|point| [point.backlash_mm, point.pitch_error_mm]);
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    // A range of at least 0.01 mm: an accurate leadscrew is a flat line.
    let (low, high) = (low.min(high - 0.01), high);
    let span = (last.position_mm - first.position_mm).max(1.0);
    let (scale, plot) = (plot, Rect::from_min_max(plot.min + vec2(58.0, 6.0), plot.max - vec2(4.0, 24.0)));
    let at = |x: f64, y: f64| {
        let across = ((x - first.position_mm) / span) as f32;
        let up = ((y - low) / (high - low)) as f32;
        pos2(plot.min.x + across * plot.width(), plot.max.y - up * plot.height())
    };
    let hair = Stroke::new(theme::HAIRLINE, view.theme.line);
    for value in [high, 0.0, low] {
        let y = at(first.position_mm, value).y;
        view.painter.hline(plot.x_range(), y, hair);
        let place = Rect::from_min_max(pos2(scale.min.x, y - 9.0), pos2(plot.min.x - 6.0, y + 9.0));
        let near = (value.abs() > 0.0 || low < 0.0 && high > 0.0) && (at(0.0, value).y - at(0.0, 0.0).y).abs() < 16.0;
        if value.abs() < 1e-9 || !near {
            view.fit_right(place, &format!("{value:.3}"), theme::SMALL, view.theme.muted);
        }
    }
    let foot = Rect::from_min_max(pos2(plot.min.x, plot.max.y + 4.0), pos2(plot.max.x, plot.max.y + 24.0));
    for (align, value) in [(Align2::LEFT_CENTER, first.position_mm), (Align2::RIGHT_CENTER, last.position_mm)] {
        view.fit(foot, align, &format!("{value:.1}"), theme::SMALL, view.theme.muted);
    }
    if let Some(point) = points.get(row) {
        let selected = Stroke::new(theme::HAIRLINE, view.theme.focus);
        view.painter.vline(at(point.position_mm, 0.0).x, plot.y_range(), selected);
    }
    for (column, ink) in [(1, inks[0]), (2, inks[1])] {
        let place = |point: &LeadscrewPoint| at(point.position_mm, *value_mut(&mut point.clone(), column));
        let line: Vec<_> = points.iter().map(place).collect();
        view.painter.add(Shape::line(line.clone(), Stroke::new(2.0, ink)));
        for point in line {
            view.painter.circle_filled(point, 3.0, ink);
        }
    }
}
