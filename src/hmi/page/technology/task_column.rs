//! The left column: the part as the grinding page has it, what is typed here, the wheel.

use egui::{Rect, vec2};

use super::task;
use crate::defs::page_text::PageText;
use crate::defs::param::{self, NumberParam};
use crate::defs::text::Text;
use crate::hmi::{Area, FieldEditor, ValueField, View, format_value, keycap, theme};

/// The fields: parameter and name.
pub const FIELDS: [(NumberParam, Text); 5] = [
    (param::GROUND_MATERIAL, Text::new("材料", "material")),
    (param::GROUND_WIDTH, Text::new("磨削宽度", "ground width")),
    (param::GROUND_ROUGHNESS, Text::new("粗糙度 Ra", "roughness Ra")),
    (param::WHEEL_MOTOR_POWER, Text::new("砂轮电机", "wheel motor")),
    (param::CONTACT_TIME_CONSTANT, Text::new("时间常数", "time constant")),
];
/// Decimals of a size.
const DECIMALS: usize = 3;
/// The field of the material.
pub const MATERIAL_FIELD: usize = 0;
/// Greatest height of a field, and height of a line.
const FIELD_HEIGHT: f32 = 50.0;
const LINE_HEIGHT: f32 = 28.0;
/// Lines of the part and of the wheel, with their headings.
const LINES: usize = 8;

/// Draws the column; returns the field that is touched.
pub fn ui(rect: Rect, view: &View<'_>, text: &PageText, typing: (usize, &FieldEditor)) -> Option<usize> {
    view.card(rect);
    let inside = rect.shrink(theme::PAD);
    let task = task::task(view, text);
    let length = |value: f64| format!("{value:.3}");
    let part = [
        (view.text("成品直径", "finished diameter"), length(task.part.diameter_mm), "mm"),
        (view.text("余量 (直径)", "stock on diameter"), length(task.part.stock_mm), "mm"),
        (view.text("公差", "tolerance"), length(task.part.tolerance_mm), "mm"),
    ];
    let wheel = [
        (view.text("直径 P77", "diameter P77"), format_value(task.wheel.diameter_mm, DECIMALS), "mm"),
        (view.text("宽度 P78", "width P78"), format_value(task.wheel.width_mm, DECIMALS), "mm"),
        (view.text("转速 P73", "speed P73"), format_value(task.wheel.rpm, 1), "r/min"),
    ];
    let spare = inside.height() - LINES as f32 * LINE_HEIGHT - 2.0 * theme::GAP;
    let height = (spare / FIELDS.len() as f32).min(FIELD_HEIGHT);
    let (part_place, rest) = inside.split_top(4.0 * LINE_HEIGHT + theme::GAP);
    lines(part_place, view, view.text("工件 (磨削页面)", "part (grinding page)"), &part);
    let mut touched = None;
    for index in 0..FIELDS.len() {
        if field(rest.band(index as f32 * height, height - theme::GAP), view, index, typing) {
            touched = Some(index);
        }
    }
    let wheel_place = rest.trim_top(FIELDS.len() as f32 * height + theme::GAP).split_top(4.0 * LINE_HEIGHT).0;
    lines(wheel_place, view, view.text("砂轮", "wheel"), &wheel);
    touched
}

/// A heading, then name, value and unit in each line.
fn lines(rect: Rect, view: &View<'_>, heading: &str, rows: &[(&str, String, &str)]) {
    view.fit_left(rect.band(0.0, LINE_HEIGHT), heading, theme::TITLE, view.theme.text);
    for (index, (name, value, unit)) in rows.iter().enumerate() {
        let line = rect.band((index + 1) as f32 * LINE_HEIGHT, LINE_HEIGHT);
        let (number, unit_place) = line.split_right(44.0);
        let shown = view.line_right(number.trim_right(theme::GAP), value, theme::LABEL, view.theme.text);
        view.fit_left(line.with_max_x(shown.min.x - theme::GAP), name, theme::LABEL, view.theme.muted);
        view.fit_left(unit_place, unit, theme::SMALL, view.theme.muted);
    }
}

/// One field; true if it was touched.
fn field(rect: Rect, view: &View<'_>, index: usize, (cursor, typing): (usize, &FieldEditor)) -> bool {
    let (row, name) = FIELDS[index];
    let response = keycap::plain(view, rect, ("technology-field", index), format!("field P{}", row.number));
    let (label, rest) = rect.shrink2(vec2(theme::GAP, 0.0)).split_left_right_at_fraction(0.45);
    let (value, unit) = rest.split_right(if row.unit.is_empty() { 0.0 } else { 34.0 });
    view.fit_left(label, name.get(view.lang), theme::LABEL, view.theme.muted);
    if !row.unit.is_empty() {
        view.fit_left(unit.trim_left(4.0), row.unit, theme::SMALL, view.theme.muted);
    }
    let words = match index == MATERIAL_FIELD {
        true => task::material(view).name.get(view.lang).to_owned(),
        false => view.snapshot.params.get(row).to_string(),
    };
    let ink = view.theme.text;
    let shown = ValueField { plate: rect, value, size: theme::TITLE, words, ink };
    FieldEditor::paint((cursor == index).then_some(typing), view, shown);
    response.clicked()
}
