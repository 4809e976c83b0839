//! The grinding page as the page designer shows it, and where its entries and its picture are. Nothing in it reacts to input.
//! Source: spec K7.2–K7.4.

use egui::{Rect, TextureId};

use super::{FieldLayout, cell_places, cells, field, heading, label_width, line_count, show_picture};
use crate::defs::page_text::{COLUMN_ROWS, PageText};
use crate::hmi::page::empty;
use crate::hmi::{Area, KeycapState, View, keycap, page_frame, theme};

/// Sizes of the picture, over its size on the grinding page.
const SCALES: [f32; 5] = [1.0, 0.9, 0.75, 0.6, 0.5];

/// A page to be shown.
pub struct PagePreview<'a> {
    pub text: &'a PageText,
    /// 1000 plus the number of its files.
    pub number: u32,
    pub texture: Option<TextureId>,
    /// All twenty entries have their place, empty ones too.
    pub has_all_places: bool,
}

/// Where the preview shows what can be edited.
pub struct PreviewPlaces {
    /// The entries, left column first: twenty with all places.
    pub entries: Vec<Rect>,
    /// The picture.
    pub image: Rect,
}

impl PagePreview<'_> {
    /// Draws title, fields and picture of the page.
    pub fn ui(&self, rect: Rect, view: &View<'_>) -> PreviewPlaces {
        let Self { text, number, texture, has_all_places } = *self;
        let columns = [&text.left, &text.right];
        let split = |scale: f32| {
            let (middle, picture) = rect.split_right(theme::PICTURE.x * scale + 2.0);
            (middle.trim_right(theme::GAP), picture)
        };
        // On the grinding page every label fits. The preview has less room, so it shrinks the picture.
        let fits = |middle: Rect| {
            let room = (middle.width() - theme::GAP) / 2.0 - 16.0;
            columns.into_iter().flatten().flatten().all(|row| label_width(view, row, theme::SMALL) <= room)
        };
        let is_high_enough = |scale: f32| theme::PICTURE.y * scale + 2.0 <= rect.height();
        let scales = SCALES.into_iter().filter(|scale| is_high_enough(*scale));
        let scale = scales.into_iter().find(|scale| fits(split(*scale).0)).unwrap_or(SCALES[SCALES.len() - 1]);
        let (middle, picture) = split(scale);
        let (title, body) = middle.split_top(34.0);
        page_frame::title(view, title, &heading(view, text));
        let lines = if has_all_places { COLUMN_ROWS } else { line_count(columns) };
        let layout = FieldLayout::of(view, body, columns, lines);
        for (place, row) in cells(body, columns, lines) {
            match row {
                Some(row) => {
                    keycap::paint_body(view, place, KeycapState::default());
                    field(place, view, row, layout, None);
                }
                None if has_all_places => view.outline(place.shrink(1.0), view.theme.line),
                None => {}
            }
        }
        let files = view.snapshot.screens.find(number);
        let picture = Rect::from_min_size(picture.min, theme::PICTURE * scale);
        show_picture(picture, view, number, files, texture);
        PreviewPlaces { entries: cell_places(body, lines).collect(), image: empty::picture_place(picture) }
    }
}
