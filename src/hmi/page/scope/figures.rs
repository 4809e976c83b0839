//! What the evaluations of a recording have in common: figures beside the picture, ways of the slide.

use egui::Rect;

use crate::hmi::{Area, View, theme};
use crate::link::scope::ScopeRecording;
use crate::units::Axis;

/// Width of the figures beside the picture.
pub const WIDTH: f32 = 232.0;
/// Height of a line of them.
const LINE_HEIGHT: f32 = 34.0;

/// Shows names with their values.
pub fn show(rect: Rect, view: &View<'_>, lines: &[(&str, String)]) {
    for (index, (name, value)) in lines.iter().enumerate() {
        let line = rect.band(index as f32 * LINE_HEIGHT, LINE_HEIGHT).trim_right(theme::PAD);
        let taken = view.fit_left(line, name, theme::LABEL, view.theme.muted);
        view.fit_right(line.with_min_x(taken.max.x + theme::GAP), value, theme::SECONDARY, view.theme.text);
    }
}

/// A length in micrometres.
pub fn um(mm: f64) -> String {
    format!("{:.1} µm", mm * 1_000.0)
}

/// The way of the slide that a recorded millimetre of an axis is: a diameter is halved.
pub fn way_of_slide(recording: &ScopeRecording, axis: Axis) -> f64 {
    if axis == Axis::X && recording.x_as_diameter { 0.5 } else { 1.0 }
}
