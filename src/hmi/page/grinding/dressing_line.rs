//! Which dressing point the dressing program of a page will use: the point set by key, else the value of the page.
//! Source: spec K4.2, K7.6.

use egui::Rect;

use crate::defs::page_meaning::PageMeaning;
use crate::defs::page_text::{PageText, PageTextRow};
use crate::defs::param;
use crate::hmi::{View, theme};
use crate::link::Snapshot;
use crate::units::Axis;

/// Height of one line and of two, points.
const HEIGHTS: [f32; 2] = [24.0, 44.0];

/// Where the point of an axis comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PointSource {
    Key,
    /// By key, but the shipped dressing programs refuse it: P98, or it is not below 0.
    RefusedKey,
    Value,
}

/// The axis whose dressing point is the value of a row.
fn axis_of(row: &PageTextRow) -> Option<Axis> {
    match row.meaning()? {
        PageMeaning::DressingPoint(axis) => Some(axis),
        _ => None,
    }
}

/// The point set by key that counts instead of the value of a row: machine coordinate as displayed.
pub fn point_instead_of(snapshot: &Snapshot, row: &PageTextRow) -> Option<(Axis, f64)> {
    let axis = axis_of(row)?;
    Some((axis, snapshot.dressing_point[axis]?))
}

/// The point of an axis, as the dressing programs use it: the value of the wheel axis is that of a new wheel.
fn point_of(snapshot: &Snapshot, text: &PageText, row: &PageTextRow, axis: Axis) -> Option<(f64, PointSource)> {
    if let Some(point) = snapshot.dressing_point[axis] {
        let follows = snapshot.params.get(param::DRESSING_POINT_SIDE) < 0.0 && point < 0.0;
        let is_refused = axis == snapshot.kind.row().wheel_axis && !follows;
        return Some((point, if is_refused { PointSource::RefusedKey } else { PointSource::Key }));
    }
    let value = |variable: u16| snapshot.variables.get(usize::from(variable)).copied().flatten();
    let since_new = snapshot.params.get(param::DRESSING_COUNT) > 0.0;
    let of_wheel = axis == snapshot.kind.row().wheel_axis && since_new;
    let dressed = text.variable(|meaning| meaning == PageMeaning::DressedAmount).filter(|_| of_wheel);
    let dressed = dressed.and_then(value).unwrap_or(0.0);
    value(row.variable).map(|point| (point - dressed, PointSource::Value))
}

/// Height for the values of dressing points that the page has: three axes take two lines; none without any.
pub fn height(text: &PageText) -> Option<f32> {
    match text.rows().filter(|row| axis_of(row).is_some()).count() {
        0 => None,
        1 | 2 => Some(HEIGHTS[0]),
        _ => Some(HEIGHTS[1]),
    }
}

/// Draws the line: coordinate and source of each axis; in amber if a point is missing.
pub fn paint(rect: Rect, view: &View<'_>, text: &PageText) {
    let mut rows: Vec<_> = text.rows().filter_map(|row| Some((axis_of(row)?, row))).collect();
    rows.sort_by_key(|(axis, _)| *axis as usize);
    let mut missing = false;
    let words = rows.into_iter().map(|(axis, row)| match point_of(view.snapshot, text, row, axis) {
        Some((point, source)) => {
            let source = match source {
                PointSource::Key => view.text("按键", "by key"),
                PointSource::RefusedKey => {
                    missing = true;
                    view.text("按键，不能用 (P98)", "by key, refused (P98)")
                }
                PointSource::Value => view.text("数值", "by value"),
            };
            format!("{axis} {} {source}", view.length(point))
        }
        None => {
            missing = true;
            format!("{axis} {}", view.text("未设置", "not set"))
        }
    });
    let words: Vec<String> = words.collect();
    let lines: Vec<String> = words.chunks(2).map(|axes| axes.join(" · ")).collect();
    let words = format!("{} {}", view.text("修整点", "dresses at"), lines.join("\n"));
    let ink = if missing { view.theme.hold } else { view.theme.info };
    if rect.height() > HEIGHTS[0] {
        view.paragraph(rect, &words, theme::LABEL, ink);
    } else {
        view.fit_left(rect, &words, theme::LABEL, ink);
    }
}
