//! Which dressing point the dressing program of a page will use: the point set by key, else the value of the page.
//! Source: spec K4.2, K7.6.

use egui::Rect;

use crate::defs::page_meaning::PageMeaning;
use crate::defs::page_text::{PageText, PageTextRow};
use crate::defs::param;
use crate::defs::text::phrase;
use crate::hmi::{View, theme};
use crate::link::Snapshot;
use crate::units::Axis;

/// Height of one line and of two, points.
const HEIGHTS: [f32; 2] = [24.0, 44.0];

/// Where the point of an axis comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PointSource {
    Key,
    /// By key, but the shipped dressing programs refuse it: P98, or it is not below 0.
    RefusedKey,
    /// The value of the page, less what has been dressed off the new wheel, mm.
    Value {
        dressed: f64,
    },
}

/// The dressing point of an axis as the dressing programs use it: machine coordinate as displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActingPoint {
    axis: Axis,
    position: f64,
    source: PointSource,
}

/// The axis whose dressing point is the value of a row.
fn axis_of(row: &PageTextRow) -> Option<Axis> {
    match row.meaning()? {
        PageMeaning::DressingPoint(axis) => Some(axis),
        _ => None,
    }
}

/// The point set by key that counts instead of the value of a row: machine coordinate as displayed.
pub fn point_by_key(snapshot: &Snapshot, row: &PageTextRow) -> Option<f64> {
    snapshot.dressing_point[axis_of(row)?]
}

impl ActingPoint {
    /// The point of a row; none if the row is no dressing point or nothing is set.
    pub fn of(snapshot: &Snapshot, text: &PageText, row: &PageTextRow) -> Option<Self> {
        let axis = axis_of(row)?;
        let is_wheel_axis = axis == snapshot.kind.row().wheel_axis;
        if let Some(position) = point_by_key(snapshot, row) {
            let follows = snapshot.params.get(param::DRESSING_POINT_SIDE) < 0.0 && position < 0.0;
            let source = if is_wheel_axis && !follows { PointSource::RefusedKey } else { PointSource::Key };
            return Some(Self { axis, position, source });
        }
        let value = |variable: u16| snapshot.variables.get(usize::from(variable)).copied().flatten();
        // On the wheel axis the value is that of a new wheel.
        let of_wheel = is_wheel_axis && snapshot.params.get(param::DRESSING_COUNT) > 0.0;
        let dressed = text.variable(|meaning| meaning == PageMeaning::DressedAmount).filter(|_| of_wheel);
        let dressed = dressed.and_then(value).unwrap_or(0.0);
        let position = value(row.variable)? - dressed;
        Some(Self { axis, position, source: PointSource::Value { dressed } })
    }

    /// Whether the dressing programs refuse it (P98).
    pub fn is_refused(self) -> bool {
        self.source == PointSource::RefusedKey
    }

    /// What the input line tells of the row, where the point is not its value.
    pub fn note(self, view: &View<'_>, row: &PageTextRow) -> Option<String> {
        let Self { axis, position, source } = self;
        let point = view.length(position);
        match source {
            PointSource::Key | PointSource::RefusedKey => {
                let words = view.text("按键设置的点有效", "set by key:");
                let unused = view.text("未用", "unused");
                let (name, value) = (view.variable_name(row.variable), view.page_value(row));
                Some(format!("{words} {axis} {point} · {name} {value} {unused}"))
            }
            PointSource::Value { dressed } if dressed.abs() > 0.0 => {
                let off = view.length(dressed);
                Some(view.phrase(&phrase!(
                    "新砂轮的值，已修整 {off} → {axis} {point}",
                    "value of a new wheel, {off} dressed off → {axis} {point}",
                    off,
                    axis,
                    point
                )))
            }
            PointSource::Value { .. } => None,
        }
    }

    /// `X -320.050 by value (-0.050)`
    pub fn words(self, view: &View<'_>) -> String {
        let point = view.length(self.position);
        let source = match self.source {
            PointSource::Key => view.text("按键", "by key").to_owned(),
            PointSource::RefusedKey => view.text("按键，不能用 (P98)", "by key, refused (P98)").to_owned(),
            PointSource::Value { dressed } if dressed.abs() > 0.0 => {
                format!("{} ({})", view.text("数值", "by value"), view.length(-dressed))
            }
            PointSource::Value { .. } => view.text("数值", "by value").to_owned(),
        };
        format!("{} {point} {source}", self.axis)
    }
}

/// Height for the values of dressing points that the page has: three axes take two lines; none without any.
pub fn height(text: &PageText) -> Option<f32> {
    match text.rows().filter(|row| axis_of(row).is_some()).count() {
        0 => None,
        1 | 2 => Some(HEIGHTS[0]),
        _ => Some(HEIGHTS[1]),
    }
}

/// Draws the line: coordinate and source of each axis; in amber if a point is missing or refused.
pub fn paint(rect: Rect, view: &View<'_>, text: &PageText) {
    let mut rows: Vec<_> = text.rows().filter_map(|row| Some((axis_of(row)?, row))).collect();
    rows.sort_by_key(|(axis, _)| *axis as usize);
    let mut is_ready = true;
    let words = rows.into_iter().map(|(axis, row)| {
        let point = ActingPoint::of(view.snapshot, text, row);
        is_ready &= point.is_some_and(|point| point.source != PointSource::RefusedKey);
        point.map_or_else(|| format!("{axis} {}", view.text("未设置", "not set")), |point| point.words(view))
    });
    let words: Vec<String> = words.collect();
    let lines: Vec<String> = words.chunks(2).map(|axes| axes.join(" · ")).collect();
    let words = format!("{} {}", view.text("修整点", "dresses at"), lines.join("\n"));
    let ink = if is_ready { view.theme.info } else { view.theme.hold };
    if rect.height() > HEIGHTS[0] {
        view.paragraph(rect, &words, theme::LABEL, ink);
    } else {
        view.fit_left(rect, &words, theme::LABEL, ink);
    }
}
