//! The column of the picture: the picture that answers, the contact of the wheel in a run, the part at the end of a cycle,
//! the key of the page designer.
//! Source: spec K7.2–K7.4, H8.

use egui::{Rect, TextureId, pos2};

use super::{VariableEntry, empty, field_of, part_card, picture_labels, show_picture};
use crate::defs::page::Page;
use crate::hmi::scene::{self, MachineScene, Magnifier};
use crate::hmi::{Area, PageKey, View, theme, widget};
use crate::link::Command;
use crate::link::screens::ScreenFiles;

/// Least height of the view of the contact below the picture.
const LEAST_CONTACT_VIEW: f32 = 90.0;
/// Height of the key of the page designer.
const KEY_HEIGHT: f32 = 48.0;

/// The column and what it shows.
pub struct PictureColumn<'a> {
    pub rect: Rect,
    pub view: &'a View<'a>,
    /// The page of the picture.
    pub number: u32,
    pub files: Option<&'a ScreenFiles>,
    pub texture: Option<TextureId>,
}

impl PictureColumn<'_> {
    /// Draws the column and handles its touches.
    pub fn ui(&self, entry: &mut VariableEntry, part: &mut part_card::PartCard, out: &mut Vec<Command>) {
        let Self { rect, view, number, files, texture } = *self;
        show_picture(rect, view, number, files, texture);
        part.poll_answer(view);
        let has_part = part.shown(view.snapshot).is_some();
        let hidden = texture.is_none() || has_part && card_covers(rect);
        let text = files.and_then(|files| files.text.as_ref().ok());
        if let Some((files, text)) = files.zip(text).filter(|_| !hidden) {
            let chosen = text.rows().nth(entry.cursor).map(|row| row.variable);
            let touched = picture_labels::ui(empty::picture_place(rect), view, files, text, chosen);
            if let Some(field) = touched.and_then(|variable| field_of(view.snapshot, variable)) {
                entry.select(field);
            }
        }
        // Of size and value one is typed.
        let was_typing = part.types_size;
        if !has_part && contact_view(rect, view) {
            return;
        }
        let row = text.and_then(|text| text.rows().nth(entry.cursor)).filter(|_| !has_part);
        if let Some((line, row)) = caption_line(rect).zip(row) {
            picture_labels::caption(line, view, row);
        }
        if design_key(rect, view, part, out) {
            out.push(Command::OpenPage(Page::Designer));
        }
        if part.types_size && !was_typing {
            entry.editor.pad_open = false;
        }
    }
}

/// The line below the picture, where there is room above the key.
fn caption_line(column: Rect) -> Option<Rect> {
    let below = column.with_min_y(empty::picture_place(column).max.y + theme::GAP);
    let line = below.split_top(picture_labels::CAPTION).0;
    (line.max.y + theme::GAP <= column.max.y - KEY_HEIGHT).then_some(line)
}

/// Whether there is no room below the picture for the card of a part: it stands in the place of the picture.
fn card_covers(column: Rect) -> bool {
    column.height() < theme::PICTURE.y + theme::GAP + part_card::HEIGHT
}

/// Below the picture: the part of the last cycle, and the key of the page designer where there is room; true if the key
/// is touched.
fn design_key(column: Rect, view: &View<'_>, part: &mut part_card::PartCard, out: &mut Vec<Command>) -> bool {
    let key = column.with_min_y(column.max.y - KEY_HEIGHT);
    let below = column.min.y + theme::PICTURE.y + theme::GAP;
    let mut room = key.min.y > below;
    if part.shown(view.snapshot).is_some() {
        room &= key.min.y - theme::GAP - part_card::HEIGHT > below;
        let bottom = if room { key.min.y - theme::GAP } else { column.max.y };
        let top = if card_covers(column) { column.min.y } else { bottom - part_card::HEIGHT };
        part.ui(Rect::from_min_max(pos2(column.min.x, top), pos2(column.max.x, bottom)), view, out);
    }
    room && widget::button(view, key, PageKey::new("design-page", view.text("页面设计", "PAGE DESIGN")))
}

/// Below the picture while a run is open: the contact of the wheel, magnified, or the machine where the wheel is away; as
/// large as there is room. Returns whether something is shown.
fn contact_view(column: Rect, view: &View<'_>) -> bool {
    let room = column.with_min_y(column.min.y + theme::PICTURE.y + theme::GAP);
    let shown = view.snapshot.program.is_open && room.height() >= LEAST_CONTACT_VIEW;
    let Some(scene) = MachineScene::of(view.snapshot).filter(|_| shown) else { return false };
    match Magnifier::of(&scene, view.snapshot) {
        Some(magnifier) => magnifier.paint(room, view),
        None => {
            view.card(room);
            scene::paint_follow(room.shrink(theme::FRAME), view);
        }
    }
    true
}
