//! Empty states: what is missing and what to do about it; the picture of a page, or why there is none.
//! Source: spec H8.

use egui::{Align2, Rect, TextureId, Ui, pos2, vec2};

use crate::hmi::pictogram::{self, PictogramShape};
use crate::hmi::theme;
use crate::hmi::view::{View, card, centred_text, fit_text};
use crate::link::command::FileFault;

/// A pictogram, a sentence, and the remedy below it.
pub fn show(ui: &Ui, view: &View<'_>, rect: Rect, marks: &[PictogramShape], what: &str, remedy: &str) {
    let painter = ui.painter();
    let middle = pos2(rect.center().x, rect.min.y + rect.height() * 0.34);
    let sign = Rect::from_center_size(middle, vec2(72.0, 72.0));
    pictogram::draw(painter, sign, marks, view.theme.muted);
    let line = Rect::from_center_size(middle + vec2(0.0, 68.0), vec2(rect.width() - 24.0, 30.0));
    fit_text(painter, line, Align2::CENTER_CENTER, what, theme::SECONDARY, view.theme.text);
    let width = (rect.width() - 24.0).min(440.0);
    let below = Rect::from_min_size(pos2(rect.center().x - width / 2.0, line.max.y + 10.0), vec2(width, 120.0));
    centred_text(painter, below, remedy, theme::LABEL, view.theme.muted);
}

/// The picture of a page in its frame, as large as it fits; otherwise its file name and the fault.
pub fn picture(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    texture: Option<TextureId>,
    (file, fault): (&str, Option<&FileFault>),
) {
    let scale = (rect.width() / theme::PICTURE.x).min(1.0);
    let place = Rect::from_min_size(rect.min, theme::PICTURE * scale + vec2(2.0, 2.0));
    card(ui.painter(), place, view.theme.surface, view.theme.line);
    if let Some(texture) = texture {
        let full = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture, place.shrink(1.0), full, theme::UNTINTED);
        return;
    }
    let words = match fault {
        Some(fault) => fault.full_message().get(view.lang).into_owned(),
        None => format!("{file}：{}", view.text("应为 200×400、24 位", "200×400, 24 bit")),
    };
    show(ui, view, place.shrink(4.0), pictogram::NO_PICTURE, view.text("没有图片", "no picture"), &words);
}
