//! Tools and bar of a lathe: shape and sizes of the four tools, as used for the interference check, and the bar.
//! Source: spec L9 (tool and bar definitions).

use egui::{Pos2, Rect, Shape as Drawn, Stroke, pos2, vec2};

use super::{HandOver, InputPrompt, PageContext, PageUi, input_line};
use crate::defs::param::{self, NumberParam};
use crate::defs::text::Text;
use crate::defs::turning_tool::{TOOL_PARAMS, TurningTool, TurningToolShape};
use crate::hmi::{Area, CoreAnswer, EditKey, FieldEditor, ValueField, View, keycap, param_range, theme};
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
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<HandOver>) {
        *self = Self::default();
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(&self.typing)
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, out, .. } = ctx;
        if let CoreAnswer::Accepted(field, _) = self.typing.poll_answer(&view.snapshot.edit_answer)
            && field == self.cursor
        {
            self.go((field + 1) % FIELD_COUNT);
        }
        typed.edits.iter().for_each(|edit| self.edit(*edit, out));
        let (page, input) = input_line::split(rect);
        let inside = page.shrink2(vec2(theme::PAD, theme::GAP));
        let (tools, bar) = inside.split_bottom((inside.height() * 0.2).clamp(64.0, 104.0));
        for station in 0..TOOL_COUNT {
            self.tool(tools.trim_bottom(theme::GAP).cell(station, TOOL_COUNT), view, station, out);
        }
        self.bar(bar, view, out);
        self.input(input, view);
    }
}

impl ToolsPage {
    fn edit(&mut self, edit: EditKey, out: &mut Vec<Command>) {
        if self.typing.handle_key(edit) {
            return;
        }
        if let Some(field) = edit.step(self.cursor, FIELD_COUNT, 1) {
            self.go(field);
        } else if edit == EditKey::Enter {
            self.store(out);
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

    fn tool(&mut self, rect: Rect, view: &View<'_>, station: usize, out: &mut Vec<Command>) {
        let in_front = view.snapshot.tool_station == Some(station as u32 + 1);
        view.filled_card(rect, view.theme.surface, if in_front { view.theme.info } else { view.theme.line });
        let (title, rest) = rect.shrink(theme::GAP).split_top(26.0);
        let ink = if in_front { view.theme.info } else { view.theme.text };
        view.line_left(title, &format!("T{}", station + 1), theme::TITLE, ink);
        if in_front {
            view.line_right(title, view.text("当前", "current"), theme::SMALL, ink);
        }
        let drawn = (rest.height() - FIELD_HEIGHT * TOOL_FIELDS as f32).max(rest.height() * DRAWING_SHARE);
        let (drawing, fields) = rest.split_top(drawn);
        draw_tool(drawing, view, &TurningTool::of_station(&view.snapshot.params, station));
        let height = ((fields.height() + 4.0) / TOOL_FIELDS as f32).min(FIELD_HEIGHT);
        for index in 0..TOOL_FIELDS {
            self.field(fields.band(index as f32 * height, height - 4.0), view, station * TOOL_FIELDS + index, out);
        }
    }

    fn bar(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        view.card(rect);
        let inside = rect.shrink(theme::GAP);
        let (fields, note) = inside.split_top(FIELD_HEIGHT.min(inside.height() * 0.6));
        for index in 0..BAR_FIELDS.len() {
            self.field(fields.cell(index, BAR_FIELDS.len()), view, TOOL_COUNT * TOOL_FIELDS + index, out);
        }
        let words = view.text(
            "直径 0：按程序自带的棒料。棒料端面中心为 X0 Z0；装入程序或改尺寸时换上新料。",
            "Diameter 0: the bar of the program. Its face is X0 Z0; loading a program or changing a size mounts a new bar.",
        );
        view.paragraph(note.trim_left(2.0).trim_top(4.0), words, theme::SMALL, view.theme.muted);
    }

    /// One field. A touch selects it; a touch on a shape changes to the next shape.
    fn field(&mut self, rect: Rect, view: &View<'_>, field: usize, out: &mut Vec<Command>) {
        let (row, name) = field_param(field);
        let value = view.snapshot.params.get(row);
        let response = keycap::plain(view, rect, ("tool-field", field), format!("field P{}", row.number));
        let (label, value_rect) = rect.trim_sides(6.0).split_left_right_at_fraction(0.42);
        view.fit_left(label, name.get(view.lang), theme::LABEL, view.theme.muted);
        let words = match (value as usize).saturating_sub(1).min(TurningToolShape::ALL.len() - 1) {
            shape if is_shape(field) => TurningToolShape::ALL[shape].name().get(view.lang).to_owned(),
            _ => value.to_string(),
        };
        let typing = (self.cursor == field).then_some(&self.typing);
        let ink = view.theme.text;
        FieldEditor::paint(typing, view, ValueField { plate: rect, value: value_rect, size: theme::TITLE, words, ink });
        if !response.clicked() {
            return;
        }
        self.typing.pad_open = !is_shape(field);
        if is_shape(field) {
            let next = value % TurningToolShape::ALL.len() as f64 + 1.0;
            out.push(Command::Page(PageCommand::EditParam(row.address(), next)));
        }
        if self.cursor != field {
            self.go(field);
        }
    }

    fn input(&self, rect: Rect, view: &View<'_>) {
        let (row, name) = field_param(self.cursor);
        let tool = match self.cursor / TOOL_FIELDS {
            station if station < TOOL_COUNT => format!("T{} {}", station + 1, name.get(view.lang)),
            _ => name.get(view.lang).to_owned(),
        };
        let range = format!("{} {}", view.text("范围", "range"), param_range(row));
        let what = format!("P{}=", row.number);
        input_line::ui(view, rect, &self.typing, &InputPrompt { label: &what, name: &tool, range: &range });
    }
}

/// Draws a tool above the part line: shank grey, edge bright, tip a dot.
fn draw_tool(rect: Rect, view: &View<'_>, tool: &TurningTool) {
    let view = &view.clipped(rect);
    let outline = tool.outline_mm();
    let (Some(first), Some(last)) = (outline.first(), outline.last()) else { return };
    let (low, high) = (first.0.min(0.0), last.0);
    let tall = tool.edge_mm * 2.0 + 4.0;
    let scale = ((rect.width() - 12.0) / (high - low) as f32).min((rect.height() - 14.0) / tall as f32);
    let left = rect.center().x - (low + high) as f32 / 2.0 * scale;
    let ground = rect.max.y - 6.0;
    let at = |z: f64, height: f64| -> Pos2 { pos2(left + z as f32 * scale, ground - height as f32 * scale) };
    let mut body: Vec<Pos2> = outline.iter().map(|(z, height)| at(*z, *height)).collect();
    view.hairline(rect, ground);
    // One trapezium per segment, because the outline need not be convex.
    for pair in outline.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let quad = vec![at(a.0, a.1), at(b.0, b.1), at(b.0, tall), at(a.0, tall)];
        view.painter.add(Drawn::convex_polygon(quad, view.theme.raised, Stroke::NONE));
    }
    body.push(at(last.0, tall));
    body.insert(0, at(first.0, tall));
    view.painter.add(Drawn::line(body, Stroke::new(theme::HAIRLINE * 1.5, view.theme.text)));
    view.painter.circle_filled(at(0.0, 0.0), 3.0, view.theme.hold);
}
