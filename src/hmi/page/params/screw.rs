//! Leadscrew table of an axis: backlash and pitch error over position. Points are edited one by one or imported from a
//! CSV file on the USB drive, and drawn as two curves.
//! Source: spec B7, H6.

use egui::accesskit::Role;
use egui::{Align2, Id, Painter, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::defs::param::Level;
use crate::defs::screw::{MOST_POINTS, Point, ScrewTable};
use crate::defs::text::{Said, Text};
use crate::hmi::asking::{Asking, Why};
use crate::hmi::entry::Edit;
use crate::hmi::login::Login;
use crate::hmi::page::Typed;
use crate::hmi::page::input_line::{self, Told};
use crate::hmi::page::scroll::Scroll;
use crate::hmi::question::{Asked, Question};
use crate::hmi::theme;
use crate::hmi::typing::{Heard, Typing};
use crate::hmi::view::{View, card, fit, frame, paragraph, put};
use crate::hmi::widget::{self, Look};
use crate::link::Command;
use crate::link::files::{Asker, FileRequest};
use crate::link::page_command::{Guard, PageCommand};
use crate::units::Axis;

/// Height of a row of the table.
const ROW: f32 = 46.0;
/// Height of the keys.
const KEYS: f32 = 46.0;
/// Column shares: number, position, backlash, pitch error.
const SHARES: [f32; 4] = [0.5, 1.2, 1.0, 1.0];
/// Values of a row, with the range shown.
const VALUES: [(Text, &str); 3] = [
    (Text::new("位置", "position"), "-9999 … 9999 mm"),
    (Text::new("反向间隙", "backlash"), "0 … 2 mm"),
    (Text::new("螺距误差", "pitch error"), "-2 … 2 mm"),
];
/// Number of keys below the table.
const KEY_COUNT: usize = 5;
/// Distance of a new point behind the last one, mm.
const FURTHER_MM: f64 = 10.0;

/// Edit that waits for the machine builder's password.
#[derive(Clone, Debug)]
enum Wish {
    Table(ScrewTable),
    Import,
}

/// Request to export or import a table.
#[derive(Debug)]
struct Carry;

impl Why for Carry {
    const ASKER: Asker = Asker::Screw;
}

/// State of the tab.
#[derive(Debug, Default)]
pub struct Screw {
    axis: usize,
    row: usize,
    column: usize,
    /// The key below the table that has the keyboard focus.
    key: Option<usize>,
    scroll: Scroll,
    /// The value being typed.
    pub typing: Typing,
    waiting: Option<Wish>,
    question: Asked<()>,
    asking: Asking<Carry>,
    told: Option<(Said, bool)>,
}

impl Screw {
    /// Draws the tab below the tabs of the page.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        let axes: Vec<Axis> = Axis::ALL.into_iter().filter(|axis| view.snapshot.axes[*axis].present).collect();
        self.axis = self.axis.min(axes.len().saturating_sub(1));
        let Some(axis) = axes.get(self.axis).copied() else { return out };
        if let Heard::Refused(field) = self.typing.hear(&view.snapshot.edit) {
            (self.row, self.column) = (field / VALUES.len(), field % VALUES.len());
        }
        self.hear(view, axis, login, &mut out);
        let table = &view.snapshot.screws[axis];
        if !self.question.is_open() && !login.is_open() {
            self.letters(typed.text, &axes);
            for edit in typed.edits {
                self.edit(*edit, view, (axis, table), login, &mut out);
            }
        }
        self.row = self.row.min(table.points().len().saturating_sub(1));
        let (page, input) = input_line::split(rect);
        let page = Rect::from_min_max(page.min + vec2(theme::PAD, 0.0), page.max - vec2(theme::PAD, theme::GAP));
        let (top, rest) = page.split_top_bottom_at_y(page.min.y + KEYS);
        let (body, keys) = rest.split_top_bottom_at_y(rest.max.y - KEYS);
        let body = Rect::from_min_max(body.min + vec2(0.0, theme::GAP), body.max - vec2(0.0, theme::GAP));
        self.axes(ui, top, view, &axes);
        let (list, side) = body.split_left_right_at_fraction(0.56);
        let list = Rect::from_min_max(list.min, list.max - vec2(theme::GAP, 0.0));
        self.list(ui, list, view, table, typed.pages);
        let (curves, words) = side.split_top_bottom_at_y(side.max.y - 74.0);
        curve(ui.painter(), curves, view, table, self.row);
        self.words(ui, words.shrink2(vec2(0.0, theme::GAP)), view, axis);
        self.keys(ui, keys, view, (axis, table), (login, &mut out));
        self.input(ui, input, view, axis, table);
        if let Some(((), Some(_))) = self.question.ui(ui, rect, view, typed.edits) {
            self.wish(view, axis, Wish::Table(ScrewTable::default()), login, &mut out);
        }
        out
    }

    /// Sends a waiting edit after the password; handles the answer to a file request.
    fn hear(&mut self, view: &View<'_>, axis: Axis, login: &Login, out: &mut Vec<Command>) {
        if let Some(wish) = self.waiting.take() {
            if view.snapshot.access.level >= Level::Builder {
                self.send(axis, wish, out);
            } else if login.is_open() {
                self.waiting = Some(wish);
            }
        }
        while let Some((Carry, answer)) = self.asking.hear(&view.snapshot.files) {
            self.told = Some(match answer {
                Ok(deed) => (deed.said, false),
                Err(refusal) => (refusal.said(), true),
            });
        }
    }

    fn wish(&mut self, view: &View<'_>, axis: Axis, wish: Wish, login: &mut Login, out: &mut Vec<Command>) {
        self.told = None;
        if view.snapshot.access.level >= Level::Builder {
            self.send(axis, wish, out);
        } else {
            self.waiting = Some(wish);
            login.unlock(view, Guard::Builder);
        }
    }

    fn send(&mut self, axis: Axis, wish: Wish, out: &mut Vec<Command>) {
        match wish {
            Wish::Table(table) => {
                self.typing.send(self.row * VALUES.len() + self.column);
                out.push(Command::Page(PageCommand::EditScrew(axis, table)));
            }
            Wish::Import => {
                out.push(self.asking.ask(Carry, FileRequest::ScrewIn(axis)));
            }
        }
    }

    fn edit(
        &mut self,
        edit: Edit,
        view: &View<'_>,
        (axis, table): (Axis, &ScrewTable),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        if let Some(key) = self.key {
            match edit {
                Edit::Enter => self.press(key, view, (axis, table), login, out),
                Edit::Left | Edit::Previous => self.key = Some((key + KEY_COUNT - 1) % KEY_COUNT),
                Edit::Right | Edit::Next => self.key = Some((key + 1) % KEY_COUNT),
                Edit::Up | Edit::Cancel => self.key = None,
                Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Down => {}
                Edit::Delete | Edit::LineStart | Edit::LineEnd => {}
            }
            return;
        }
        self.typing.next_key(edit);
        if self.typing.key(edit) {
            return;
        }
        let last = table.points().len().saturating_sub(1);
        let (row, column) = (self.row, self.column);
        match edit {
            Edit::Enter if self.typing.text.is_empty() => self.next(last),
            Edit::Enter => self.enter(view, (axis, table), login, out),
            Edit::Up => self.go(row.saturating_sub(1), column),
            // The keys are below the table.
            Edit::Down if row >= last => self.key = Some(0),
            Edit::Down => self.go((row + 1).min(last), column),
            Edit::Left | Edit::Previous => self.go(row, column.saturating_sub(1)),
            Edit::Right | Edit::Next => self.go(row, (column + 1).min(VALUES.len() - 1)),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Cancel => {}
            Edit::Delete | Edit::LineStart | Edit::LineEnd => {}
        }
    }

    /// X, Y, Z select the axis.
    fn letters(&mut self, text: &str, axes: &[Axis]) {
        let axis = text.chars().last().and_then(Axis::from_letter);
        if let Some(index) = axis.and_then(|axis| axes.iter().position(|other| *other == axis)) {
            *self = Self { axis: index, ..Self::default() };
        }
    }

    fn go(&mut self, row: usize, column: usize) {
        if (row, column) != (self.row, self.column) {
            self.typing.clear();
        }
        (self.row, self.column) = (row, column);
        let seen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1.0, 6.0 * ROW));
        self.scroll.show(row, seen, ROW);
    }

    /// Selects the next field, row by row.
    fn next(&mut self, last: usize) {
        match self.column + 1 {
            column if column < VALUES.len() => self.go(self.row, column),
            _ => self.go((self.row + 1).min(last), 0),
        }
    }

    /// Checks the whole table with the typed value and sends it.
    fn enter(
        &mut self,
        view: &View<'_>,
        (axis, table): (Axis, &ScrewTable),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let Ok(value) = self.typing.text.parse::<f64>() else {
            self.typing.refused = Some(Said::new("不是数字", "not a number"));
            return;
        };
        let mut points = table.points().to_vec();
        match points.get_mut(self.row) {
            Some(point) => *value_of(point, self.column) = value,
            None => {
                self.typing.refused = Some(Said::new("表中没有点，请先按 加点", "the table is empty: touch ADD POINT"));
                return;
            }
        }
        match ScrewTable::of(&points) {
            Ok(table) => {
                self.wish(view, axis, Wish::Table(table), login, out);
                self.next(points.len() - 1);
            }
            Err(said) => self.typing.refused = Some(said),
        }
    }

    /// Inserts a point between the selected one and the next, or behind the last. Its values are interpolated.
    fn add(&mut self, view: &View<'_>, (axis, table): (Axis, &ScrewTable), login: &mut Login, out: &mut Vec<Command>) {
        let mut points = table.points().to_vec();
        if points.len() >= MOST_POINTS {
            let said = Said::new(format!("最多 {MOST_POINTS} 点"), format!("at most {MOST_POINTS} points"));
            return self.told = Some((said, true));
        }
        let at_mm = match (points.get(self.row), points.get(self.row + 1)) {
            (Some(here), Some(next)) => (here.at_mm + next.at_mm) / 2.0,
            (Some(here), None) => here.at_mm + FURTHER_MM,
            (None, _) => 0.0,
        };
        let at = (self.row + 1).min(points.len());
        points.insert(at, Point { at_mm, backlash_mm: table.backlash_mm(at_mm), pitch_mm: table.pitch_mm(at_mm) });
        match ScrewTable::of(&points) {
            Ok(table) => {
                self.wish(view, axis, Wish::Table(table), login, out);
                self.go(at, 0);
            }
            Err(said) => self.told = Some((said, true)),
        }
    }

    fn remove(
        &mut self,
        view: &View<'_>,
        (axis, table): (Axis, &ScrewTable),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let mut points = table.points().to_vec();
        if self.row >= points.len() {
            return;
        }
        points.remove(self.row);
        match ScrewTable::of(&points) {
            Ok(table) => self.wish(view, axis, Wish::Table(table), login, out),
            Err(said) => self.told = Some((said, true)),
        }
    }

    fn axes(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, axes: &[Axis]) {
        let ids = ["screw-x", "screw-y", "screw-z"];
        let name = |axis: &Axis| {
            let count = view.snapshot.screws[*axis].points().len();
            (ids[*axis as usize], format!("{} {} {count}", axis.letter(), view.say("轴 · 点", "· points")))
        };
        let keys: Vec<(&str, String)> = axes.iter().map(name).collect();
        if let Some(axis) = widget::tabs(ui, view, rect, &keys, self.axis) {
            *self = Self { axis, ..Self::default() };
        }
    }

    fn list(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, table: &ScrewTable, pages: i32) {
        let (head, body) = rect.split_top_bottom_at_y(rect.min.y + 24.0);
        let head = Rect::from_min_max(head.min + vec2(theme::GAP, 0.0), head.max - vec2(theme::PAD, 0.0));
        let [position, backlash, pitch] = VALUES.map(|(name, _)| name.get(view.lang));
        widget::head(ui.painter(), view, head, SHARES, ["#", position, backlash, pitch]);
        let points = table.points();
        if points.is_empty() {
            let words = view.say(
                "没有补偿点：丝杠按无误差处理。按 加点 输入，或按 导入 从 U 盘读入 KT830-SCREW-轴.CSV。",
                "No points: the screw counts as true. Touch ADD POINT, or IMPORT to read KT830-SCREW-AXIS.CSV from the USB medium.",
            );
            paragraph(ui.painter(), body.shrink(theme::PAD), words, theme::LABEL, view.theme.quiet);
            return;
        }
        let list = widget::whole_lines(body, ROW);
        if pages != 0 {
            self.scroll.page(pages, list, ROW);
        }
        let (first, last) = self.scroll.follow(ui, "screw", list, ROW, points.len());
        for (index, point) in points.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(ROW)) as f32;
            let line = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 3.0));
            self.line(ui, (list, line), view, index, point);
        }
        self.scroll.bar(ui, view, list, ROW, points.len());
    }

    fn line(&mut self, ui: &Ui, (list, line): (Rect, Rect), view: &View<'_>, index: usize, point: &Point) {
        let painter = &ui.painter().with_clip_rect(list);
        let [number, places @ ..] =
            widget::columns(Rect::from_min_max(line.min + vec2(theme::GAP, 0.0), line.max), SHARES);
        fit(painter, number, Align2::LEFT_CENTER, &(index + 1).to_string(), theme::LABEL, view.theme.quiet);
        for (column, place) in places.into_iter().enumerate() {
            let response = ui.interact(place.intersect(list), Id::unique(("screw", index, column)), Sense::CLICK);
            let word = format!("{} {} screw-{index}-{column}", VALUES[column].0.get(view.lang), index + 1);
            response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, &word));
            if response.clicked() {
                self.key = None;
                self.go(index, column);
                self.typing.pad = true;
            }
            let chosen = (index, column) == (self.row, self.column) && self.key.is_none();
            card(painter, place, view.theme.raised, view.theme.line);
            let refused = chosen && self.typing.refused.is_some();
            if chosen {
                frame(painter, place, if refused { view.theme.alarm } else { view.theme.focus });
            }
            let text = match chosen && !self.typing.text.is_empty() {
                true => self.typing.text.clone(),
                false => shown(*value_of(&mut point.clone(), column), column),
            };
            let ink = if refused { view.theme.alarm_text } else { view.theme.text };
            put(painter, place.shrink2(vec2(8.0, 0.0)), Align2::RIGHT_CENTER, &text, theme::TITLE, ink);
        }
    }

    fn words(&self, ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis) {
        let (words, ink) = match &self.told {
            Some((said, true)) => (said.get(view.lang), view.theme.alarm_text),
            Some((said, false)) => (said.get(view.lang), view.theme.run),
            None if !view.snapshot.axes[axis].homed => (
                view.say("回零后生效。机床坐标，X 为半径。", "In force after homing. Machine coordinates, X a radius."),
                view.theme.hold,
            ),
            None => (
                view.say(
                    "输入即生效，轴慢速补到位。机床坐标，X 为半径。",
                    "In force as it is typed; the axis is led there slowly. Machine coordinates, X a radius.",
                ),
                view.theme.quiet,
            ),
        };
        paragraph(ui.painter(), rect, words, theme::LABEL, ink);
    }

    fn keys(
        &mut self,
        ui: &Ui,
        rect: Rect,
        view: &View<'_>,
        (axis, table): (Axis, &ScrewTable),
        (login, out): (&mut Login, &mut Vec<Command>),
    ) {
        let locked = view.snapshot.access.level < Level::Builder;
        let labels: [_; KEY_COUNT] = [
            ("screw-add", view.say("加点", "ADD POINT"), locked),
            ("screw-remove", view.say("删点", "REMOVE"), locked),
            ("screw-clear", view.say("清空", "CLEAR"), locked),
            ("screw-import", view.say("导入 CSV", "IMPORT"), locked),
            ("screw-export", view.say("导出 CSV", "EXPORT"), false),
        ];
        let width = (rect.width() + theme::GAP) / labels.len() as f32;
        for (index, (id, label, locked)) in labels.into_iter().enumerate() {
            let corner = pos2(rect.min.x + index as f32 * width, rect.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, rect.height()));
            let touched = widget::push(ui, view, place, id, label, Look { on: false, locked });
            if self.key == Some(index) {
                frame(ui.painter(), place, view.theme.focus);
            }
            if touched {
                self.press(index, view, (axis, table), login, out);
            }
        }
    }

    /// Handles a key below the table.
    fn press(
        &mut self,
        key: usize,
        view: &View<'_>,
        (axis, table): (Axis, &ScrewTable),
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        self.typing.clear();
        self.typing.pad = false;
        match key {
            0 => self.add(view, (axis, table), login, out),
            1 => self.remove(view, (axis, table), login, out),
            2 if table.points().is_empty() => {}
            2 => self.question.ask((), clearing(axis, table)),
            3 => self.wish(view, axis, Wish::Import, login, out),
            _ => {
                out.push(self.asking.ask(Carry, FileRequest::ScrewOut(axis, table.clone())));
            }
        }
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>, axis: Axis, table: &ScrewTable) {
        let (name, range) = VALUES[self.column];
        let name = name.get(view.lang);
        let told = match table.points().get(self.row) {
            Some(point) => {
                let old = shown(*value_of(&mut point.clone(), self.column), self.column);
                (
                    format!("{} {} {name}=", axis.letter(), self.row + 1),
                    format!("{range}  {} {old}", view.say("原值", "old")),
                )
            }
            None => (String::new(), String::new()),
        };
        input_line::ui(ui, view, rect, &self.typing, &Told { what: &told.0, name: "", range: &told.1 });
    }
}

fn clearing(axis: Axis, table: &ScrewTable) -> Question {
    let points = table.points().len();
    let body = Said::new(
        format!("{axis} 轴的 {points} 个补偿点全部删除，可先导出。"),
        format!("The {points} points of axis {axis} are deleted; export them first if they are wanted."),
    );
    Question::new(Text::new("清空补偿表？", "clear the table?"), body, ("question-clear", Text::new("清空", "CLEAR")))
}

const fn value_of(point: &mut Point, column: usize) -> &mut f64 {
    match column {
        0 => &mut point.at_mm,
        1 => &mut point.backlash_mm,
        _ => &mut point.pitch_mm,
    }
}

/// Positions with three decimals, errors with four: leadscrews are measured to 0.1 µm.
fn shown(value: f64, column: usize) -> String {
    if column == 0 { format!("{value:.3}") } else { format!("{value:.4}") }
}

/// Backlash and pitch error over position, with the selected point.
fn curve(painter: &Painter, rect: Rect, view: &View<'_>, table: &ScrewTable, row: usize) {
    if table.points().is_empty() {
        return;
    }
    card(painter, rect, view.theme.surface, view.theme.line);
    let inside = rect.shrink(theme::PAD);
    let (legend, plot) = inside.split_top_bottom_at_y(inside.min.y + 22.0);
    let half = legend.split_left_right_at_fraction(0.5);
    let inks = [view.theme.info, view.theme.hold];
    for (place, (name, ink)) in
        [half.0, half.1].into_iter().zip([1, 2].map(|column| (VALUES[column].0, inks[column - 1])))
    {
        let mark = Rect::from_min_size(pos2(place.min.x, place.center().y - 1.5), vec2(14.0, 3.0));
        painter.rect_filled(mark, 1.0, ink);
        let words = Rect::from_min_max(pos2(place.min.x + 20.0, place.min.y), place.max);
        fit(
            painter,
            words,
            Align2::LEFT_CENTER,
            &format!("{} mm", name.get(view.lang)),
            theme::SMALL,
            view.theme.quiet,
        );
    }
    let points = table.points();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let values = points.iter().flat_map(|point| [point.backlash_mm, point.pitch_mm]);
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    // A range of at least 0.01 mm: an accurate leadscrew is a flat line.
    let (low, high) = (low.min(high - 0.01), high);
    let span = (last.at_mm - first.at_mm).max(1.0);
    let (scale, plot) = (plot, Rect::from_min_max(plot.min + vec2(58.0, 6.0), plot.max - vec2(4.0, 24.0)));
    let at = |x: f64, y: f64| {
        let across = ((x - first.at_mm) / span) as f32;
        let up = ((y - low) / (high - low)) as f32;
        pos2(plot.min.x + across * plot.width(), plot.max.y - up * plot.height())
    };
    let hair = Stroke::new(theme::HAIR, view.theme.line);
    for value in [high, 0.0, low] {
        let y = at(first.at_mm, value).y;
        painter.hline(plot.x_range(), y, hair);
        let place = Rect::from_min_max(pos2(scale.min.x, y - 9.0), pos2(plot.min.x - 6.0, y + 9.0));
        let near = (value.abs() > 0.0 || low < 0.0 && high > 0.0) && (at(0.0, value).y - at(0.0, 0.0).y).abs() < 16.0;
        if value.abs() < 1e-9 || !near {
            fit(painter, place, Align2::RIGHT_CENTER, &format!("{value:.3}"), theme::SMALL, view.theme.quiet);
        }
    }
    let foot = Rect::from_min_max(pos2(plot.min.x, plot.max.y + 4.0), pos2(plot.max.x, plot.max.y + 24.0));
    for (align, value) in [(Align2::LEFT_CENTER, first.at_mm), (Align2::RIGHT_CENTER, last.at_mm)] {
        fit(painter, foot, align, &format!("{value:.1}"), theme::SMALL, view.theme.quiet);
    }
    if let Some(point) = points.get(row) {
        painter.vline(at(point.at_mm, 0.0).x, plot.y_range(), Stroke::new(theme::HAIR, view.theme.focus));
    }
    for (ink, value) in inks.into_iter().zip([|point: &Point| point.backlash_mm, |point: &Point| point.pitch_mm]) {
        let line: Vec<_> = points.iter().map(|point| at(point.at_mm, value(point))).collect();
        painter.add(Shape::line(line.clone(), Stroke::new(2.0, ink)));
        for point in line {
            painter.circle_filled(point, 3.0, ink);
        }
    }
}
