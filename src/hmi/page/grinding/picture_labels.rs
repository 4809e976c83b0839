//! The picture answers: the number of the chosen value glows in it, with its name below, and a touch of a number chooses
//! its value. Where the
//! numbers stand says D00nn.RON; a picture without that file is only looked at.
//! Source: spec K7.3, K7.4, H6.

use egui::{Pos2, Rect, vec2};

use crate::defs::page_text::{PageText, PageTextRow};
use crate::hmi::{View, theme};
use crate::link::screens::{PictureLabel, ScreenFiles};

/// How far beside a number a touch still means it, points.
const REACH: f32 = 26.0;
/// Height of the line below the picture.
pub const CAPTION: f32 = 26.0;

/// Draws the chosen value in the picture at `image`. Returns the variable whose number is touched.
pub fn ui(image: Rect, view: &View<'_>, files: &ScreenFiles, text: &PageText, chosen: Option<u16>) -> Option<u16> {
    let on_page = |label: &&PictureLabel| text.rows().any(|row| row.variable == label.variable);
    let labels = || files.labels.iter().filter(on_page).map(|label| (label.variable, place(image, label)));
    labels().next()?;
    let response = view.touch(image, "picture", "picture-labels");
    for (_, area) in labels().filter(|(variable, _)| Some(*variable) == chosen) {
        let frame = area.expand2(vec2(3.0, 0.0));
        view.painter.rect_filled(frame, theme::RADIUS, view.theme.glow);
        view.outline(frame, view.theme.focus);
    }
    let at = response.clicked().then(|| response.interact_pointer_pos()).flatten()?;
    nearest(labels(), at)
}

/// Name and number of the chosen value, in a line below the picture.
pub fn caption(line: Rect, view: &View<'_>, row: &PageTextRow) {
    let number = view.fit_right(line, &view.variable_name(row.variable), theme::LABEL, view.theme.info);
    view.fit_left(line.with_max_x(number.min.x - theme::GAP), row.name_in(view.lang), theme::LABEL, view.theme.text);
}

/// The variable whose number is nearest to a touch, within reach.
pub fn nearest(labels: impl Iterator<Item = (u16, Rect)>, at: Pos2) -> Option<u16> {
    let distances = labels.map(|(variable, area)| (variable, area.distance_to_pos(at)));
    let reached = distances.filter(|(_, distance)| *distance <= REACH);
    reached.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(variable, _)| variable)
}

/// The place of a label on the screen.
pub fn place(image: Rect, label: &PictureLabel) -> Rect {
    let (left, top, right, bottom) = label.area;
    let scale = image.width() / theme::PICTURE.x;
    let point = |x: u16, y: u16| image.min + vec2(f32::from(x), f32::from(y)) * scale;
    Rect::from_min_max(point(left, top), point(right, bottom))
}
