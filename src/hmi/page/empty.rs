//! Empty states: what is missing and what to do about it; the picture of a page, or why there is none.
//! Source: spec H8.

use egui::{Rect, TextureId, pos2, vec2};

use crate::hmi::pictogram::{self, PictogramShape};
use crate::hmi::{View, theme};
use crate::link::screens::FileFault;

/// A pictogram, a sentence, and the remedy below it.
pub fn show(view: &View<'_>, rect: Rect, marks: &[PictogramShape], what: &str, remedy: &str) {
    let middle = pos2(rect.center().x, rect.min.y + rect.height() * 0.34);
    pictogram::draw(&view.painter, Rect::from_center_size(middle, vec2(72.0, 72.0)), marks, view.theme.muted);
    let line = Rect::from_center_size(middle + vec2(0.0, 68.0), vec2(rect.width() - 24.0, 30.0));
    view.fit_centre(line, what, theme::SECONDARY, view.theme.text);
    let width = (rect.width() - 24.0).min(440.0);
    let below = Rect::from_min_size(pos2(rect.center().x - width / 2.0, line.max.y + 10.0), vec2(width, 120.0));
    view.centred_text(below, remedy, theme::LABEL, view.theme.muted);
}

/// No program is loaded.
pub fn no_program(view: &View<'_>, rect: Rect) {
    let remedy = view.text("按“目录”选择一个程序并装入。", "Choose a program in the directory and load it.");
    show(view, rect, pictogram::NO_PAGE, view.text("没有装入程序", "no program is loaded"), remedy);
}

/// One quiet sentence in the middle of a list without rows.
pub fn note(view: &View<'_>, rect: Rect, words: &str) {
    let line = Rect::from_center_size(rect.center(), vec2(rect.width(), 30.0));
    view.fit_centre(line, words, theme::SECONDARY, view.theme.muted);
}

/// The frame of a picture in its column.
fn picture_frame(rect: Rect) -> Rect {
    let scale = (rect.width() / theme::PICTURE.x).min(1.0);
    Rect::from_min_size(rect.min, theme::PICTURE * scale + vec2(2.0, 2.0))
}

/// Where [`picture`] paints the picture itself.
pub fn picture_place(rect: Rect) -> Rect {
    picture_frame(rect).shrink(1.0)
}

/// The picture of a page in its frame, as large as it fits; otherwise its file name and the fault.
pub fn picture(rect: Rect, view: &View<'_>, texture: Option<TextureId>, file: &str, fault: Option<&FileFault>) {
    let place = picture_frame(rect);
    view.card(place);
    if let Some(texture) = texture {
        let full = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        view.painter.image(texture, picture_place(rect), full, theme::UNTINTED);
        return;
    }
    let words = match fault {
        Some(fault) => fault.full_message().get(view.lang).into_owned(),
        None => format!("{file}：{}", view.text("应为 200×400、24 位", "200×400, 24 bit")),
    };
    show(view, place.shrink(4.0), pictogram::NO_PICTURE, view.text("没有图片", "no picture"), &words);
}
