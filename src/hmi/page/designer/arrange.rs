//! Editing a page on its preview: a touch chooses an entry, dragging moves it to another place, a frame drawn on the picture
//! tells where the picture shows its variable.
//! Source: spec K7.3, K7.4; issue "the face", part 11.

use std::ops::Range;

use egui::accesskit::Role;
use egui::{Id, Pos2, Rect, Sense, TextureId, Vec2, WidgetInfo, vec2};

use super::{DesignerPage, DesignerRequest};
use crate::defs::page_text::{COLUMN_ROWS, PageTextRow};
use crate::defs::text::{Lang, Text, phrase};
use crate::hmi::page::grinding::picture_labels;
use crate::hmi::page::grinding::preview::{PagePreview, PreviewPlaces};
use crate::hmi::page::program::actions::EDIT_FIRST;
use crate::hmi::{Area, PageKey, View, theme};
use crate::link::Command;
use crate::link::files::{FileRequest, Requester};
use crate::link::screens::PictureLabel;

/// Height of the line with the keys below the preview.
const KEYS_HEIGHT: f32 = 46.0;
/// Width of a key in it.
const KEY_WIDTH: f32 = 130.0;
/// Least side of a frame on the picture, pixels of the picture: what is smaller is no frame but a touch.
const LEAST_FRAME: f32 = 8.0;

const CHOOSE_FIRST: Text =
    Text::new("先碰一下左边的一项，再在图上画框", "touch an entry on the left first, then draw its frame");
const CORRECT_FIRST: Text = Text::new("先改正文字中的错误", "correct the errors of the text first");
const ORDER_OF_PAGE_TEXT: Text =
    Text::new("位置由页面文字决定，英文只有名称", "the page text gives the places, the English text the names");

/// What a finger drags over the preview.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PreviewDrag {
    /// An entry, by its place.
    Entry(usize),
    /// A frame on the picture, from here.
    Frame(Pos2),
}

impl DesignerPage {
    /// The preview; while the page is edited its entries and its picture are edited on it.
    pub(super) fn preview(&mut self, rect: Rect, view: &View<'_>, texture: Option<TextureId>, out: &mut Vec<Command>) {
        let (page, keys) = rect.split_bottom(if self.editing { KEYS_HEIGHT } else { 0.0 });
        let (text, number) = (&self.reading.page, self.document.number);
        let preview = PagePreview { text, number, texture, has_all_places: self.editing };
        let places = preview.ui(page.trim_bottom(theme::GAP), view);
        if !self.editing {
            self.preview_drag = None;
            return;
        }
        self.entries(&places, view);
        if texture.is_some() {
            self.picture(&places, view, out);
        }
        self.arrange_keys(keys, view, out);
    }

    /// The entries: touched and dragged.
    fn entries(&mut self, places: &PreviewPlaces, view: &View<'_>) {
        let chosen = self.chosen_entry();
        for (index, place) in places.entries.iter().enumerate() {
            let response = view.ui.interact(*place, Id::unique(("entry", index)), Sense::click_and_drag());
            let name = format!("entry-{}", index + 1);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.clone()));
            if response.clicked() || response.drag_started() {
                self.choose_entry(index);
            }
            if response.drag_started() && self.variable_at(index).is_some() {
                self.preview_drag = Some(PreviewDrag::Entry(index));
            }
            if chosen == Some(index) {
                view.frame(*place, view.theme.focus);
            }
        }
        let Some(PreviewDrag::Entry(from)) = self.preview_drag else { return };
        let (at, is_up) = (view.finger(), view.ui.input(|input| input.pointer.any_released()));
        let target = at.and_then(|at| places.entries.iter().position(|place| place.contains(at)));
        if let (Some(at), Some(held)) = (at, places.entries.get(from)) {
            view.painter.rect_filled(*held, theme::RADIUS, view.theme.glow);
            let ghost = Rect::from_center_size(at, held.size());
            view.filled_card(ghost, view.theme.raised, view.theme.focus);
            let label = self.row_at(from).map_or("", |row| row.label.as_str());
            view.fit_left(ghost.shrink2(vec2(8.0, 2.0)), label, theme::LABEL, view.theme.text);
        }
        if let Some(place) = target.and_then(|target| places.entries.get(target)) {
            view.outline(*place, view.theme.info);
        }
        if is_up {
            self.preview_drag = None;
            if let Some(to) = target.filter(|to| *to != from) {
                self.exchange_entries(from, to);
            }
        }
    }

    /// The picture: frames of the variables; a frame that is drawn is the place of the chosen entry's variable.
    fn picture(&mut self, places: &PreviewPlaces, view: &View<'_>, out: &mut Vec<Command>) {
        let image = places.image;
        let response = view.ui.interact(image, Id::unique("design-picture"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "design-picture"));
        let chosen = self.chosen_entry().and_then(|index| self.variable_at(index));
        let labels = self.labels(view);
        for label in &labels {
            let frame = picture_labels::place(image, label);
            let is_chosen = Some(label.variable) == chosen;
            if is_chosen {
                view.painter.rect_filled(frame, theme::RADIUS, view.theme.glow);
            }
            view.outline(frame, if is_chosen { view.theme.focus } else { view.theme.info });
        }
        if response.drag_started() {
            let from = view.ui.input(|input| input.pointer.press_origin());
            self.preview_drag = from.map(PreviewDrag::Frame);
        }
        let Some(at) = view.finger() else {
            self.preview_drag = None;
            return;
        };
        let frame = match self.preview_drag {
            Some(PreviewDrag::Frame(from)) => Rect::from_two_pos(image.clamp(from), image.clamp(at)),
            _ => Rect::from_min_size(at, Vec2::ZERO),
        };
        if self.preview_drag.is_some() {
            view.outline(frame, view.theme.focus);
        }
        if !response.clicked() && !response.drag_stopped() {
            return;
        }
        self.preview_drag = None;
        let scale = theme::PICTURE.x / image.width();
        let pixel = |at: Pos2| -> Vec2 { ((at - image.min) * scale).round() };
        let (least, most) = (pixel(frame.min), pixel(frame.max));
        if (most - least).min_elem() < LEAST_FRAME {
            let places = labels.iter().map(|label| (label.variable, picture_labels::place(image, label)));
            let touched = picture_labels::nearest(places, at).and_then(|variable| self.entry_of(variable));
            return touched.into_iter().for_each(|entry| self.choose_entry(entry));
        }
        let Some(variable) = chosen else { return self.message.refuse(CHOOSE_FIRST) };
        let area = (least.x as u16, least.y as u16, most.x as u16, most.y as u16);
        self.save_labels(view, variable, Some(PictureLabel { variable, area }), out);
    }

    /// The keys below the preview, or what can be done.
    fn arrange_keys(&mut self, rect: Rect, view: &View<'_>, out: &mut Vec<Command>) {
        let row = rect.trim_top(2.0);
        let entry = self.chosen_entry().filter(|index| self.row_at(*index).is_some());
        let variable = entry.and_then(|index| self.variable_at(index));
        let has_label = self.labels(view).iter().any(|label| Some(label.variable) == variable);
        let (hint, keys) = row.split_right(2.0 * KEY_WIDTH + theme::GAP);
        let words =
            view.text("拖动换位；在图上画框标出所选变量", "drag to move; draw the chosen one's frame on the picture");
        view.text_rows(hint.trim_right(theme::GAP), words, theme::SMALL, view.theme.muted, 2);
        let (remove, unmark) = (view.text("删除该项", "REMOVE"), view.text("删除图标", "NO FRAME"));
        let key = PageKey::new("entry-remove", remove).locked(entry.is_none());
        if self.key(view, keys.cell(0, 2), key)
            && let Some(index) = entry
        {
            self.write_entries(&[(index, String::new())]);
        }
        let key = PageKey::new("frame-remove", unmark).locked(!has_label);
        if self.key(view, keys.cell(1, 2), key)
            && let Some(variable) = variable.filter(|_| has_label)
        {
            self.save_labels(view, variable, None, out);
        }
    }

    /// The places of variables in the picture of this page.
    fn labels(&self, view: &View<'_>) -> Vec<PictureLabel> {
        view.snapshot.screens.find(self.document.number).map(|files| files.labels.clone()).unwrap_or_default()
    }

    /// Saves another place of a variable, or none.
    fn save_labels(&mut self, view: &View<'_>, variable: u16, label: Option<PictureLabel>, out: &mut Vec<Command>) {
        let fault = view.snapshot.screens.find(self.document.number).and_then(|files| files.labels_fault.as_ref());
        if let Some(fault) = fault {
            return self.message.refuse(fault.full_message());
        }
        let (page, base) = (self.document.number, self.labels(view));
        let mut labels = base.clone();
        match (label, labels.iter_mut().find(|known| known.variable == variable)) {
            (Some(label), Some(known)) => *known = label,
            (Some(label), None) => labels.push(label),
            (None, _) => labels.retain(|known| known.variable != variable),
        }
        let request = FileRequest::SavePictureLabels { page, labels, base };
        out.push(self.asking.send(Requester::Designer, DesignerRequest::Labels, request));
    }

    /// The place of the entry that holds the cursor.
    pub(super) fn chosen_entry(&self) -> Option<usize> {
        let cursor = self.document.cursor;
        if let Some((index, _)) = self.empty_place.filter(|(_, place)| *place == cursor) {
            return Some(index);
        }
        (0..self.reading.entry_positions.len())
            .find(|index| self.entry_range(*index).is_some_and(|range| range.start <= cursor && cursor <= range.end))
    }

    /// Puts the cursor into an entry; a place that the text does not reach yet gets its entry.
    fn choose_entry(&mut self, index: usize) {
        self.message.clear();
        self.empty_place = None;
        if index >= self.reading.entry_positions.len() {
            // Nothing is written before something comes here.
            self.document.move_to(self.reading.end.map_or(0, |(line, _)| line as usize - 1), 0);
            self.empty_place = Some((index, self.document.cursor));
            return;
        }
        let Some(range) = self.entry_range(index) else {
            if let Some((line, column)) = self.reading.entry_positions.get(index) {
                self.document.move_to(*line as usize - 1, *column as usize - 1);
            }
            return;
        };
        let label = self.row_at(index).map_or(0, |row| row.label.chars().count());
        self.document.cursor = (range.start + label).min(range.end);
        (self.position.scroll.user_scrolled, self.keys_focused) = (false, false);
    }

    fn row_at(&self, index: usize) -> Option<&PageTextRow> {
        let page = &self.reading.page;
        let column = if index < COLUMN_ROWS { &page.left } else { &page.right };
        column.get(index % COLUMN_ROWS)?.as_ref()
    }

    fn variable_at(&self, index: usize) -> Option<u16> {
        self.row_at(index).map(|row| row.variable)
    }

    fn entry_of(&self, variable: u16) -> Option<usize> {
        (0..2 * COLUMN_ROWS).find(|index| self.variable_at(*index) == Some(variable))
    }

    /// The characters of an entry, without its `;`; none of one that is missing or has no `;`.
    fn entry_range(&self, index: usize) -> Option<Range<usize>> {
        let (line, column) = *self.reading.entry_positions.get(index)?;
        let rope = &self.document.rope;
        let start = rope.try_line_to_char(line as usize - 1).ok()? + column as usize - 1;
        let rest = rope.get_slice(start..)?.chars();
        let length = rest.take_while(|sign| !matches!(sign, '\r' | '\n')).position(|sign| sign == ';')?;
        Some(start..start + length)
    }

    /// Two entries change their places.
    fn exchange_entries(&mut self, from: usize, to: usize) {
        if self.document_lang != Lang::Zh {
            return self.message.refuse(ORDER_OF_PAGE_TEXT);
        }
        let known = self.reading.entry_positions.len();
        if [from, to].into_iter().any(|index| index < known && self.entry_range(index).is_none()) {
            return self.message.refuse(CORRECT_FIRST);
        }
        let text = |index: usize| {
            let range = self.entry_range(index);
            range.map(|range| self.document.rope.slice(range).to_string()).unwrap_or_default()
        };
        let exchanged = [(from, text(to)), (to, text(from))];
        self.write_entries(&exchanged);
        self.choose_entry(to);
        if let Some(row) = self.row_at(to) {
            let name = row.label.clone();
            self.message.tell(phrase!("{name} 已换到这里", "{name} is here now", name));
        }
    }

    /// Writes entries anew, as one change; entries that the text does not have yet are added before its `%`.
    pub(super) fn write_entries(&mut self, entries: &[(usize, String)]) {
        if !self.editing {
            return self.message.refuse(EDIT_FIRST);
        }
        if self.reading.end.is_none() {
            return self.message.refuse(CORRECT_FIRST);
        }
        let (mut rope, known) = (self.document.rope.clone(), self.reading.entry_positions.len());
        // From the end, so that the places before stay where they are.
        let mut sorted: Vec<_> = entries.iter().collect();
        sorted.sort_by_key(|(index, _)| std::cmp::Reverse(*index));
        let last = sorted.first().map_or(0, |(index, _)| *index);
        if let Some((line, column)) = self.reading.end {
            let at = rope.line_to_char(line as usize - 1) + column as usize - 1;
            let end = self.document.line_end();
            let added = (known..=last).map(|index| {
                let text = entries.iter().find(|(of, _)| *of == index).map_or("", |(_, text)| text.as_str());
                format!("{text};{end}")
            });
            rope.insert(at, &added.collect::<String>());
        }
        for (index, text) in sorted {
            if let Some(range) = self.entry_range(*index) {
                rope.remove(range.clone());
                rope.insert(range.start, text);
            }
        }
        self.document.replace_all(rope);
        self.reparse();
    }
}
