//! Tools and bar of a lathe: shape and sizes of the four tools, as used for the interference check, and the bar.
//! Source: spec L9 (tool and bar definitions).

use egui::accesskit::Role;
use egui::{Align2, Id, Pos2, Rect, Sense, Shape as Drawn, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::input_line::{self, InputPrompt};
use super::{PageContext, PageUi};
use crate::defs::param::{self, NumberParam};
use crate::defs::text::Text;
use crate::defs::turning_tool::{TOOL_PARAMS, TurningTool, TurningToolShape};
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::{CoreAnswer, FieldEditor, param_range};
use crate::hmi::keycap::{self, KeycapState};
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame, text_line};
use crate::link::Command;
use crate::link::page_command::PageCommand;

/// Fields of a tool; fields of the bar and of the run.
const TOOL_FIELDS: usize = 4;
const BAR_FIELDS: [(NumberParam, Text); 3] = [
    (param::BAR_DIAMETER, Text::new("棒料直径", "bar diameter")),
    (param::BAR_LENGTH, Text::new("伸出长度", "length")),
    (param::PROGRAM_REPEATS, Text::new("循环次数", "runs")),
];
const TOOL_COUNT: usize = TOOL_PARAMS.len();
const FIELD_COUNT: usize = TOOL_COUNT * TOOL_FIELDS + BAR_FIELDS.len();
const TOOL_FIELD_NAMES: [Text; TOOL_FIELDS] =
    [Text::new("形状", "shape"), Text::new("刃宽", "width"), Text::new("刃高", "edge"), Text::new("刀杆", "shank")];
/// Maximum height of a field.
const FIELD_HEIGHT: f32 = 54.0;
/// Minimum share of a card for the drawing of its tool.
const DRAWING_SHARE: f32 = 0.3;

/// State of the page.
#[derive(Debug, Default)]
pub struct ToolsPage {
    /// The value being typed.
    typing: FieldEditor,
    cursor: usize,
}

/// Parameter and name of a field: tools first, then the bar.
fn field_param(field: usize) -> (NumberParam, Text) {
    match field.checked_sub(TOOL_COUNT * TOOL_FIELDS) {
        None => (TOOL_PARAMS[field / TOOL_FIELDS][field % TOOL_FIELDS], TOOL_FIELD_NAMES[field % TOOL_FIELDS]),
        Some(bar) => BAR_FIELDS[bar % BAR_FIELDS.len()],
    }
}

const fn is_shape(field: usize) -> bool {
    field < TOOL_COUNT * TOOL_FIELDS && field.is_multiple_of(TOOL_FIELDS)
}

impl PageUi for ToolsPage {
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        *self = Self::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, out, .. } = ctx;
        if let CoreAnswer::Accepted(field, _) = self.typing.poll_answer(&view.snapshot.edit_answer)
            && field == self.cursor
        {
            self.go((field + 1) % FIELD_COUNT);
        }
        for edit in typed.edits {
            self.edit(*edit, out);
        }
        let (page, input) = input_line::split(rect);
        let inside = page.shrink2(vec2(theme::PAD, theme::GAP));
        let bar_height = (inside.height() * 0.2).clamp(64.0, 104.0);
        let (tools, bar) = inside.split_top_bottom_at_y(inside.max.y - bar_height);
        let width = (tools.width() + theme::GAP) / TOOL_COUNT as f32;
        for station in 0..TOOL_COUNT {
            let corner = pos2(tools.min.x + station as f32 * width, tools.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, tools.height() - theme::GAP));
            self.tool(ui, place, view, station, out);
        }
        self.bar(ui, bar, view, out);
        self.input(ui, input, view);
    }
}

impl ToolsPage {
    fn edit(&mut self, edit: EditKey, out: &mut Vec<Command>) {
        self.typing.clear_refused(edit);
        if self.typing.handle_key(edit) {
            return;
        }
        match edit {
            EditKey::Enter => self.store(out),
            EditKey::Up | EditKey::Previous | EditKey::Left => self.go((self.cursor + FIELD_COUNT - 1) % FIELD_COUNT),
            EditKey::Down | EditKey::Next | EditKey::Right => self.go((self.cursor + 1) % FIELD_COUNT),
            EditKey::Char(_)
            | EditKey::Sign
            | EditKey::Backspace
            | EditKey::Delete
            | EditKey::LineStart
            | EditKey::LineEnd
            | EditKey::Cancel => {}
        }
    }

    fn go(&mut self, field: usize) {
        self.cursor = field;
        self.typing.clear();
    }

    fn store(&mut self, out: &mut Vec<Command>) {
        if self.typing.text.is_empty() {
            return self.go((self.cursor + 1) % FIELD_COUNT);
        }
        let (row, _) = field_param(self.cursor);
        match self.typing.param_value(row) {
            Ok(value) => {
                self.typing.send(self.cursor);
                out.push(Command::Page(PageCommand::EditParam(row.address(), value)));
            }
            Err(reason) => self.typing.refused = Some(reason),
        }
    }

    fn tool(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, station: usize, out: &mut Vec<Command>) {
        let in_front = view.snapshot.tool_station == Some(station as u32 + 1);
        let edge = if in_front { view.theme.info } else { view.theme.line };
        card(ui.painter(), rect, view.theme.surface, edge);
        let inside = rect.shrink(theme::GAP);
        let (title, rest) = inside.split_top_bottom_at_y(inside.min.y + 26.0);
        let words = format!("T{}", station + 1);
        let ink = if in_front { view.theme.info } else { view.theme.text };
        text_line(ui.painter(), title, Align2::LEFT_CENTER, &words, theme::TITLE, ink);
        if in_front {
            text_line(ui.painter(), title, Align2::RIGHT_CENTER, view.text("当前", "in front"), theme::SMALL, ink);
        }
        let drawn = (rest.height() - FIELD_HEIGHT * TOOL_FIELDS as f32).max(rest.height() * DRAWING_SHARE);
        let (drawing, fields) = rest.split_top_bottom_at_y(rest.min.y + drawn);
        draw_tool(ui, drawing, view, &TurningTool::of_station(&view.snapshot.params, station));
        let height = ((fields.height() + 4.0) / TOOL_FIELDS as f32).min(FIELD_HEIGHT);
        for index in 0..TOOL_FIELDS {
            let corner = pos2(fields.min.x, fields.min.y + index as f32 * height);
            let place = Rect::from_min_size(corner, vec2(fields.width(), height - 4.0));
            self.field(ui, place, view, station * TOOL_FIELDS + index, out);
        }
    }

    fn bar(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        card(ui.painter(), rect, view.theme.surface, view.theme.line);
        let inside = rect.shrink(theme::GAP);
        let (fields, note) = inside.split_top_bottom_at_y(inside.min.y + FIELD_HEIGHT.min(inside.height() * 0.6));
        let width = (fields.width() + theme::GAP) / BAR_FIELDS.len() as f32;
        for index in 0..BAR_FIELDS.len() {
            let corner = pos2(fields.min.x + index as f32 * width, fields.min.y);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, fields.height()));
            self.field(ui, place, view, TOOL_COUNT * TOOL_FIELDS + index, out);
        }
        let words = view.text(
            "直径 0：按程序自带的棒料。棒料端面中心为 X0 Z0；装入程序或改尺寸时换上新料。",
            "Diameter 0: the bar that comes with the program. Its face is X0 Z0; a new one comes with a program or a size.",
        );
        let note = Rect::from_min_max(note.min + vec2(2.0, 4.0), note.max);
        crate::hmi::view::paragraph(ui.painter(), note, words, theme::SMALL, view.theme.muted);
    }

    /// One field. A touch selects it; a touch on a shape changes to the next shape.
    fn field(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, field: usize, out: &mut Vec<Command>) {
        let (row, name) = field_param(field);
        let value = view.snapshot.params.get(row);
        let response = ui.interact(rect, Id::unique(("tool-field", field)), Sense::CLICK);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("field P{}", row.number)));
        let painter = ui.painter();
        let pressed = response.is_pointer_button_down_on();
        keycap::paint_body(painter, view.theme, rect, KeycapState { pressed, ..KeycapState::default() });
        let inside = rect.shrink2(vec2(6.0, 0.0));
        let (label, shown) = inside.split_left_right_at_fraction(0.42);
        fit_text(painter, label, Align2::LEFT_CENTER, name.get(view.lang), theme::LABEL, view.theme.muted);
        let chosen = self.cursor == field;
        let refused = chosen && self.typing.refused.is_some();
        let (words, ink) = match chosen && !self.typing.text.is_empty() {
            true if refused => (self.typing.text.clone(), view.theme.alarm_text),
            true => (format!("{}_", self.typing.text), view.theme.info),
            false if is_shape(field) => {
                let shape =
                    TurningToolShape::ALL[(value as usize).saturating_sub(1).min(TurningToolShape::ALL.len() - 1)];
                (shape.name().get(view.lang).to_owned(), view.theme.text)
            }
            false => (value.to_string(), view.theme.text),
        };
        fit_text(painter, shown, Align2::RIGHT_CENTER, &words, theme::TITLE, ink);
        if chosen {
            focus_frame(painter, rect, if refused { view.theme.alarm } else { view.theme.focus });
        }
        if !response.clicked() {
            return;
        }
        if is_shape(field) {
            let next = value % TurningToolShape::ALL.len() as f64 + 1.0;
            out.push(Command::Page(PageCommand::EditParam(row.address(), next)));
            self.typing.pad_open = false;
        } else {
            self.typing.pad_open = true;
        }
        if self.cursor != field {
            self.go(field);
        }
    }

    fn input(&self, ui: &Ui, rect: Rect, view: &View<'_>) {
        let (row, name) = field_param(self.cursor);
        let tool = match self.cursor / TOOL_FIELDS {
            station if station < TOOL_COUNT => format!("T{} {}", station + 1, name.get(view.lang)),
            _ => name.get(view.lang).to_owned(),
        };
        let range = format!("{} {}", view.text("范围", "range"), param_range(row));
        let what = format!("P{}=", row.number);
        input_line::ui(ui, view, rect, &self.typing, &InputPrompt { label: &what, name: &tool, range: &range });
    }
}

/// Draws a tool above the part line: shank grey, edge bright, tip a dot.
fn draw_tool(ui: &Ui, rect: Rect, view: &View<'_>, tool: &TurningTool) {
    let painter = ui.painter().with_clip_rect(rect);
    let outline = tool.outline_mm();
    let (Some(first), Some(last)) = (outline.first(), outline.last()) else { return };
    let (low, high) = (first.0.min(0.0), last.0);
    let tall = tool.edge_mm * 2.0 + 4.0;
    let scale = ((rect.width() - 12.0) / (high - low) as f32).min((rect.height() - 14.0) / tall as f32);
    let left = rect.center().x - (low + high) as f32 / 2.0 * scale;
    let ground = rect.max.y - 6.0;
    let at = |z: f64, height: f64| -> Pos2 { pos2(left + z as f32 * scale, ground - height as f32 * scale) };
    let mut body: Vec<Pos2> = outline.iter().map(|(z, height)| at(*z, *height)).collect();
    painter.hline(rect.x_range(), ground, Stroke::new(theme::HAIRLINE, view.theme.line));
    // One trapezium per segment, because the outline need not be convex.
    for pair in outline.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let quad = vec![at(a.0, a.1), at(b.0, b.1), at(b.0, tall), at(a.0, tall)];
        painter.add(Drawn::convex_polygon(quad, view.theme.raised, Stroke::NONE));
    }
    body.push(at(last.0, tall));
    body.insert(0, at(first.0, tall));
    painter.add(Drawn::line(body, Stroke::new(theme::HAIRLINE * 1.5, view.theme.text)));
    painter.circle_filled(at(0.0, 0.0), 3.0, view.theme.hold);
}
