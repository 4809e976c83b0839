//! Leadscrew table of an axis: backlash and pitch error over position. Points are edited one by one or imported from a
//! CSV file on the USB drive, and drawn as two curves.
//! Source: spec B7, H6.

use egui::accesskit::Role;
use egui::{Align2, Color32, Id, Painter, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::defs::leadscrew::{LeadscrewCompensation, LeadscrewPoint, MAX_POINTS};
use crate::defs::param::AccessLevel;
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::{CoreAnswer, FieldEditor};
use crate::hmi::login::Login;
use crate::hmi::page::TypedInput;
use crate::hmi::page::input_line::{self, InputPrompt};
use crate::hmi::page::scroll::Scroll;
use crate::hmi::question::{Question, QuestionDialog};
use crate::hmi::requests::{PendingRequests, RequestReason};
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame, paragraph, text_line};
use crate::hmi::widget::{self, ButtonState};
use crate::link::Command;
use crate::link::files::{FileRequest, Requester};
use crate::link::page_command::{PageCommand, PasswordScope};
use crate::units::Axis;

/// Height of a row of the table.
const ROW_HEIGHT: f32 = 46.0;
/// Height of the keys.
const KEYS_HEIGHT: f32 = 46.0;
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

/// Request to export or import a table.
#[derive(Debug)]
struct LeadscrewRequest;

impl RequestReason for LeadscrewRequest {
    const REQUESTER: Requester = Requester::Leadscrew;
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
    asking: PendingRequests<LeadscrewRequest>,
    message: Option<(LocalizedText, bool)>,
}

impl LeadscrewTab {
    /// Draws the tab below the tabs of the page.
    pub fn ui(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        typed: &TypedInput<'_>,
        login: &mut Login,
    ) -> Vec<Command> {
        let mut out = Vec::new();
        let axes: Vec<Axis> = Axis::ALL.into_iter().filter(|axis| view.snapshot.axes[*axis].present).collect();
        self.axis = self.axis.min(axes.len().saturating_sub(1));
        let Some(axis) = axes.get(self.axis).copied() else { return out };
        if let CoreAnswer::Refused(field) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            (self.row, self.column) = (field / VALUE_COLUMNS.len(), field % VALUE_COLUMNS.len());
        }
        self.handle_answers(view, axis, login, &mut out);
        let table = &view.snapshot.leadscrews[axis];
        if !self.question.is_open() && !login.is_open() {
            self.handle_letters(typed.text, &axes);
            for edit in typed.edits {
                self.edit(*edit, view, (axis, table), login, &mut out);
            }
        }
        self.row = self.row.min(table.points().len().saturating_sub(1));
        let (page, input) = input_line::split(rect);
        let page = Rect::from_min_max(page.min + vec2(theme::PAD, 0.0), page.max - vec2(theme::PAD, theme::GAP));
        let (top, rest) = page.split_top_bottom_at_y(page.min.y + KEYS_HEIGHT);
        let (body, keys) = rest.split_top_bottom_at_y(rest.max.y - KEYS_HEIGHT);
        let body = Rect::from_min_max(body.min + vec2(0.0, theme::GAP), body.max - vec2(0.0, theme::GAP));
        self.axes(ui, top, view, &axes);
        let (list, side) = body.split_left_right_at_fraction(0.56);
        let list = Rect::from_min_max(list.min, list.max - vec2(theme::GAP, 0.0));
        self.list(ui, list, view, table, typed.scroll_pages);
        let (curves, words) = side.split_top_bottom_at_y(side.max.y - 74.0);
        paint_curves(ui.painter(), curves, view, table, self.row);
        self.hint(ui, words.shrink2(vec2(0.0, theme::GAP)), view, axis);
        self.keys(ui, keys, view, (axis, table), (login, &mut out));
        self.input(ui, input, view, axis, table);
        if let Some(((), Some(_))) = self.question.ui(ui, rect, view, typed.edits) {
            let empty = PendingEdit::Table(LeadscrewCompensation::default(), None);
            self.request_edit(view, axis, empty, login, &mut out);
        }
        out
    }

    /// Sends a waiting edit after the password; handles the answer to a file request.
    fn handle_answers(&mut self, view: &View<'_>, axis: Axis, login: &Login, out: &mut Vec<Command>) {
        if let Some(wish) = self.pending_edit.take() {
            if view.snapshot.access.level >= AccessLevel::Builder {
                self.send(axis, wish, out);
            } else if login.is_open() {
                self.pending_edit = Some(wish);
            }
        }
        while let Some((LeadscrewRequest, answer)) = self.asking.poll(&view.snapshot.files) {
            self.message = Some(match answer {
                Ok(deed) => (deed.message, false),
                Err(refusal) => (refusal.message(), true),
            });
        }
    }

    fn request_edit(
        &mut self,
        view: &View<'_>,
        axis: Axis,
        wish: PendingEdit,
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        self.message = None;
        if view.snapshot.access.level >= AccessLevel::Builder {
            self.send(axis, wish, out);
        } else {
            self.pending_edit = Some(wish);
            login.unlock(view, PasswordScope::Builder);
        }
    }

    fn send(&mut self, axis: Axis, wish: PendingEdit, out: &mut Vec<Command>) {
        match wish {
            PendingEdit::Table(table, typed) => {
                let (field, text) = typed.unwrap_or_else(|| (self.field(), String::new()));
                self.typing.send_text(field, text);
                out.push(Command::Page(PageCommand::EditLeadscrew(axis, table)));
            }
            PendingEdit::Import => {
                out.push(self.asking.send(LeadscrewRequest, FileRequest::ImportLeadscrew(axis)));
            }
        }
    }

    fn edit(
        &mut self,
        edit: EditKey,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        if let Some(key) = self.focused_key {
            match edit {
                EditKey::Enter => self.press_key(key, view, (axis, table), login, out),
                EditKey::Left | EditKey::Previous => self.focused_key = Some((key + KEY_COUNT - 1) % KEY_COUNT),
                EditKey::Right | EditKey::Next => self.focused_key = Some((key + 1) % KEY_COUNT),
                EditKey::Up | EditKey::Cancel => self.focused_key = None,
                EditKey::Char(_) | EditKey::Sign | EditKey::Backspace | EditKey::Down => {}
                EditKey::Delete | EditKey::LineStart | EditKey::LineEnd => {}
            }
            return;
        }
        self.typing.clear_refused(edit);
        if self.typing.handle_key(edit) {
            return;
        }
        let last = table.points().len().saturating_sub(1);
        let (row, column) = (self.row, self.column);
        match edit {
            EditKey::Enter if self.typing.text.is_empty() => self.select_next(last),
            EditKey::Enter => self.enter(view, (axis, table), login, out),
            EditKey::Up => self.select_cell(row.saturating_sub(1), column),
            // The keys are below the table.
            EditKey::Down if row >= last => self.focused_key = Some(0),
            EditKey::Down => self.select_cell((row + 1).min(last), column),
            EditKey::Left | EditKey::Previous => self.select_cell(row, column.saturating_sub(1)),
            EditKey::Right | EditKey::Next => self.select_cell(row, (column + 1).min(VALUE_COLUMNS.len() - 1)),
            EditKey::Char(_) | EditKey::Sign | EditKey::Backspace | EditKey::Cancel => {}
            EditKey::Delete | EditKey::LineStart | EditKey::LineEnd => {}
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
        let seen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1.0, 6.0 * ROW_HEIGHT));
        self.scroll.scroll_to(row, seen, ROW_HEIGHT);
    }

    /// Selects the next field, row by row.
    fn select_next(&mut self, last: usize) {
        match self.column + 1 {
            column if column < VALUE_COLUMNS.len() => self.select_cell(self.row, column),
            _ => self.select_cell((self.row + 1).min(last), 0),
        }
    }

    /// Checks the whole table with the typed value and sends it.
    fn enter(
        &mut self,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let Ok(value) = self.typing.text.parse::<f64>() else {
            self.typing.refused = Some(LocalizedText::new("不是数字", "not a number"));
            return;
        };
        let mut points = table.points().to_vec();
        match points.get_mut(self.row) {
            Some(point) => *value_mut(point, self.column) = value,
            None => {
                self.typing.refused =
                    Some(LocalizedText::new("表中没有点，请先按 加点", "the table is empty: touch ADD POINT"));
                return;
            }
        }
        match LeadscrewCompensation::from_points(&points) {
            Ok(table) => {
                let typed = (self.field(), self.typing.text.clone());
                self.select_next(points.len() - 1);
                self.request_edit(view, axis, PendingEdit::Table(table, Some(typed)), login, out);
            }
            Err(said) => self.typing.refused = Some(said),
        }
    }

    /// Inserts a point between the selected one and the next, or behind the last. Its values are interpolated.
    fn add_point(
        &mut self,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let mut points = table.points().to_vec();
        if points.len() >= MAX_POINTS {
            let said = LocalizedText::new(format!("最多 {MAX_POINTS} 点"), format!("at most {MAX_POINTS} points"));
            return self.message = Some((said, true));
        }
        let at_mm = match (points.get(self.row), points.get(self.row + 1)) {
            (Some(here), Some(next)) => (here.position_mm + next.position_mm) / 2.0,
            (Some(here), None) => here.position_mm + NEW_POINT_STEP_MM,
            (None, _) => 0.0,
        };
        let at = (self.row + 1).min(points.len());
        points.insert(
            at,
            LeadscrewPoint {
                position_mm: at_mm,
                backlash_mm: table.backlash_mm(at_mm),
                pitch_error_mm: table.pitch_error_mm(at_mm),
            },
        );
        match LeadscrewCompensation::from_points(&points) {
            Ok(table) => {
                self.request_edit(view, axis, PendingEdit::Table(table, None), login, out);
                self.select_cell(at, 0);
            }
            Err(said) => self.message = Some((said, true)),
        }
    }

    fn remove_point(
        &mut self,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let mut points = table.points().to_vec();
        if self.row >= points.len() {
            return;
        }
        points.remove(self.row);
        match LeadscrewCompensation::from_points(&points) {
            Ok(table) => self.request_edit(view, axis, PendingEdit::Table(table, None), login, out),
            Err(said) => self.message = Some((said, true)),
        }
    }

    fn axes(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, axes: &[Axis]) {
        let ids = ["screw-x", "screw-y", "screw-z"];
        let name = |axis: &Axis| {
            let count = view.snapshot.leadscrews[*axis].points().len();
            (ids[*axis as usize], format!("{} {} {count}", axis.letter(), view.text("轴 · 点", "· points")))
        };
        let keys: Vec<(&str, String)> = axes.iter().map(name).collect();
        if let Some(axis) = widget::tabs(ui, view, rect, &keys, self.axis) {
            *self = Self { axis, ..Self::default() };
        }
    }

    fn list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, table: &LeadscrewCompensation, pages: i32) {
        let (head, body) = rect.split_top_bottom_at_y(rect.min.y + 24.0);
        let head = Rect::from_min_max(head.min + vec2(theme::GAP, 0.0), head.max - vec2(theme::PAD, 0.0));
        let [position, backlash, pitch] = VALUE_COLUMNS.map(|(name, _)| name.get(view.lang));
        widget::table_header(ui.painter(), view, head, COLUMN_SHARES, ["#", position, backlash, pitch]);
        let points = table.points();
        if points.is_empty() {
            let words = view.text(
                "没有补偿点：丝杠按无误差处理。按 加点 输入，或按 导入 从 U 盘读入 KT830-SCREW-轴.CSV。",
                "No points: the screw counts as true. Touch ADD POINT, or IMPORT to read KT830-SCREW-AXIS.CSV from the USB medium.",
            );
            paragraph(ui.painter(), body.shrink(theme::PAD), words, theme::LABEL, view.theme.muted);
            return;
        }
        let list = widget::round_to_lines(body, ROW_HEIGHT);
        if pages != 0 {
            self.scroll.scroll_pages(pages, list, ROW_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "screw", list, ROW_HEIGHT, points.len());
        for (index, point) in points.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(ROW_HEIGHT)) as f32;
            let line = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW_HEIGHT - 3.0));
            self.line(ui, (list, line), view, index, point);
        }
        self.scroll.draw_bar(ui, view, list, ROW_HEIGHT, points.len());
    }

    fn line(&mut self, ui: &Ui, (list, line): (Rect, Rect), view: &View<'_>, index: usize, point: &LeadscrewPoint) {
        let painter = &ui.painter().with_clip_rect(list);
        let [number, places @ ..] =
            widget::columns(Rect::from_min_max(line.min + vec2(theme::GAP, 0.0), line.max), COLUMN_SHARES);
        fit_text(painter, number, Align2::LEFT_CENTER, &(index + 1).to_string(), theme::LABEL, view.theme.muted);
        for (column, place) in places.into_iter().enumerate() {
            let response = ui.interact(place.intersect(list), Id::unique(("screw", index, column)), Sense::CLICK);
            let word = format!("{} {} screw-{index}-{column}", VALUE_COLUMNS[column].0.get(view.lang), index + 1);
            response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &word));
            if response.clicked() {
                self.focused_key = None;
                self.select_cell(index, column);
                self.typing.pad_open = true;
            }
            let chosen = (index, column) == (self.row, self.column) && self.focused_key.is_none();
            card(painter, place, view.theme.raised, view.theme.line);
            let refused = chosen && self.typing.refused.is_some();
            if chosen {
                focus_frame(painter, place, if refused { view.theme.alarm } else { view.theme.focus });
            }
            let text = match chosen && !self.typing.text.is_empty() {
                true => self.typing.text.clone(),
                false => value_text(*value_mut(&mut point.clone(), column), column),
            };
            let ink = if refused { view.theme.alarm_text } else { view.theme.text };
            text_line(painter, place.shrink2(vec2(8.0, 0.0)), Align2::RIGHT_CENTER, &text, theme::TITLE, ink);
        }
    }

    fn hint(&self, ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis) {
        let (words, ink) = match &self.message {
            Some((said, true)) => (said.get(view.lang), view.theme.alarm_text),
            Some((said, false)) => (said.get(view.lang), view.theme.run),
            None if !view.snapshot.axes[axis].homed => (
                view.text(
                    "回零后生效。机床坐标，X 为半径。",
                    "In force after homing. Machine coordinates, X a radius.",
                ),
                view.theme.hold,
            ),
            None => (
                view.text(
                    "输入即生效，轴慢速补到位。机床坐标，X 为半径。",
                    "In force as it is typed; the axis is led there slowly. Machine coordinates, X a radius.",
                ),
                view.theme.muted,
            ),
        };
        paragraph(ui.painter(), rect, words, theme::LABEL, ink);
    }

    fn keys(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        (login, out): (&mut Login, &mut Vec<Command>),
    ) {
        let locked = view.snapshot.access.level < AccessLevel::Builder;
        let labels: [_; KEY_COUNT] = [
            ("screw-add", view.text("加点", "ADD POINT"), locked),
            ("screw-remove", view.text("删点", "REMOVE"), locked),
            ("screw-clear", view.text("清空", "CLEAR"), locked),
            ("screw-import", view.text("导入 CSV", "IMPORT"), locked),
            ("screw-export", view.text("导出 CSV", "EXPORT"), false),
        ];
        let width = (rect.width() + theme::GAP) / labels.len() as f32;
        for (index, (id, label, locked)) in labels.into_iter().enumerate() {
            let corner = pos2(rect.min.x + index as f32 * width, rect.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, rect.height()));
            let touched = widget::button(ui, view, place, id, label, ButtonState { on: false, locked });
            if self.focused_key == Some(index) {
                focus_frame(ui.painter(), place, view.theme.focus);
            }
            if touched {
                self.press_key(index, view, (axis, table), login, out);
            }
        }
    }

    /// Handles a key below the table.
    fn press_key(
        &mut self,
        key: usize,
        view: &View<'_>,
        (axis, table): (Axis, &LeadscrewCompensation),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        self.typing.clear();
        self.typing.pad_open = false;
        match key {
            0 => self.add_point(view, (axis, table), login, out),
            1 => self.remove_point(view, (axis, table), login, out),
            2 if table.points().is_empty() => {}
            2 => self.question.ask((), clear_question(axis, table)),
            3 => self.request_edit(view, axis, PendingEdit::Import, login, out),
            _ => {
                out.push(self.asking.send(LeadscrewRequest, FileRequest::ExportLeadscrew(axis, table.clone())));
            }
        }
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis, table: &LeadscrewCompensation) {
        let (name, range) = VALUE_COLUMNS[self.column];
        let name = name.get(view.lang);
        let told = match table.points().get(self.row) {
            Some(point) => {
                let old = value_text(*value_mut(&mut point.clone(), self.column), self.column);
                (
                    format!("{} {} {name}=", axis.letter(), self.row + 1),
                    format!("{range}  {} {old}", view.text("原值", "old")),
                )
            }
            None => (String::new(), String::new()),
        };
        input_line::ui(ui, view, rect, &self.typing, &InputPrompt { label: &told.0, name: "", range: &told.1 });
    }
}

fn clear_question(axis: Axis, table: &LeadscrewCompensation) -> Question {
    let points = table.points().len();
    let body = LocalizedText::new(
        format!("{axis} 轴的 {points} 个补偿点全部删除，可先导出。"),
        format!("The {points} points of axis {axis} are deleted; export them first if they are wanted."),
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
fn paint_legend(painter: &Painter, legend: Rect, view: &View<'_>, inks: [Color32; 2]) {
    let half = legend.split_left_right_at_fraction(0.5);
    for (place, (name, ink)) in
        [half.0, half.1].into_iter().zip([1, 2].map(|column| (VALUE_COLUMNS[column].0, inks[column - 1])))
    {
        let mark = Rect::from_min_size(pos2(place.min.x, place.center().y - 1.5), vec2(14.0, 3.0));
        painter.rect_filled(mark, 1.0, ink);
        let words = Rect::from_min_max(pos2(place.min.x + 20.0, place.min.y), place.max);
        fit_text(
            painter,
            words,
            Align2::LEFT_CENTER,
            &format!("{} mm", name.get(view.lang)),
            theme::SMALL,
            view.theme.muted,
        );
    }
}

/// Backlash and pitch error over position, with the selected point.
fn paint_curves(painter: &Painter, rect: Rect, view: &View<'_>, table: &LeadscrewCompensation, row: usize) {
    if table.points().is_empty() {
        return;
    }
    card(painter, rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink(theme::PAD);
    let (legend, plot) = inside.split_top_bottom_at_y(inside.min.y + 22.0);
    let inks = [view.theme.info, view.theme.hold];
    paint_legend(painter, legend, view, inks);
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
        painter.hline(plot.x_range(), y, hair);
        let place = Rect::from_min_max(pos2(scale.min.x, y - 9.0), pos2(plot.min.x - 6.0, y + 9.0));
        let near = (value.abs() > 0.0 || low < 0.0 && high > 0.0) && (at(0.0, value).y - at(0.0, 0.0).y).abs() < 16.0;
        if value.abs() < 1e-9 || !near {
            fit_text(painter, place, Align2::RIGHT_CENTER, &format!("{value:.3}"), theme::SMALL, view.theme.muted);
        }
    }
    let foot = Rect::from_min_max(pos2(plot.min.x, plot.max.y + 4.0), pos2(plot.max.x, plot.max.y + 24.0));
    for (align, value) in [(Align2::LEFT_CENTER, first.position_mm), (Align2::RIGHT_CENTER, last.position_mm)] {
        fit_text(painter, foot, align, &format!("{value:.1}"), theme::SMALL, view.theme.muted);
    }
    if let Some(point) = points.get(row) {
        painter.vline(at(point.position_mm, 0.0).x, plot.y_range(), Stroke::new(theme::HAIRLINE, view.theme.focus));
    }
    for (ink, value) in inks
        .into_iter()
        .zip([|point: &LeadscrewPoint| point.backlash_mm, |point: &LeadscrewPoint| point.pitch_error_mm])
    {
        let line: Vec<_> = points.iter().map(|point| at(point.position_mm, value(point))).collect();
        painter.add(Shape::line(line.clone(), Stroke::new(2.0, ink)));
        for point in line {
            painter.circle_filled(point, 3.0, ink);
        }
    }
}
