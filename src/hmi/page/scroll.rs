//! Scrolling of a long list; only the visible lines are laid out.

use egui::{Id, Rect, Sense, Ui, vec2};

use crate::hmi::{Area, View, swipe, theme, widget};

/// Scroll position of a list.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scroll {
    /// Lines above the first visible one; fractional while a finger drags.
    pub top: f64,
    /// The operator scrolled: the list no longer follows the cursor.
    pub user_scrolled: bool,
}

/// A list that scrolls.
pub struct ScrollList<'a> {
    /// Id of the list.
    pub id: &'a str,
    /// Rectangle of the list.
    pub rect: Rect,
    /// Height of a row with the gap below it.
    pub row: f32,
    /// Gap below a row.
    pub gap: f32,
    /// Number of rows.
    pub count: usize,
}

/// The visible rows of a list: index and place.
pub type VisibleRows = Vec<(usize, Rect)>;

impl Scroll {
    /// Scrolls by pages, finger and mouse wheel, and draws the bar; returns the view clipped to the list, and the
    /// visible rows.
    pub fn rows<'v>(&mut self, view: &View<'v>, list: &ScrollList<'_>, pages: i32) -> (View<'v>, VisibleRows) {
        let rows = self.visible_rows(view, list, pages);
        self.draw_bar(view, list.rect, list.row, list.count);
        (view.clipped(list.rect), rows)
    }

    /// Scrolls by pages, finger and mouse wheel; returns the visible rows.
    pub fn visible_rows(&mut self, view: &View<'_>, list: &ScrollList<'_>, pages: i32) -> VisibleRows {
        let ScrollList { id, rect, row, gap, count } = *list;
        if pages != 0 {
            self.scroll_pages(pages, rect, row);
        }
        let (first, last) = self.handle_input(view.ui, id, rect, row, count);
        let place = |index: usize| {
            let top = ((index as f64 - self.top) * f64::from(row)) as f32;
            (index, rect.trim_right(8.0).band(top, row - gap))
        };
        (first..last).map(place).collect()
    }

    /// Handles finger and mouse wheel; returns the lines to draw, first and one past the last.
    pub fn handle_input(&mut self, ui: &Ui, id: &str, rect: Rect, line: f32, count: usize) -> (usize, usize) {
        let response = ui.interact(rect, Id::unique(id), Sense::DRAG | Sense::HOVER);
        if response.dragged() {
            swipe::allow_over(ui.ctx(), response.id);
        }
        let mut moved = -widget::drag_delta(&response).y;
        if response.hovered() {
            moved -= ui.input(|input| input.smooth_scroll_delta()).y;
        }
        if moved.abs() > 0.0 {
            self.user_scrolled = true;
            self.top += f64::from(moved / line);
        }
        let visible = (rect.height() / line).floor().max(1.0) as usize;
        self.top = self.top.clamp(0.0, count.saturating_sub(visible) as f64);
        let first = self.top.floor() as usize;
        // An invisible line must not be drawn: it would take no touch but still be announced by a screen reader.
        let last = (self.top + f64::from(rect.height() / line) - 1e-3).ceil() as usize;
        (first, last.clamp(first, count.max(first)))
    }

    /// The lines that are fully visible.
    pub fn visible_lines(&self, rect: Rect, line: f32) -> std::ops::Range<usize> {
        let first = self.top.ceil() as usize;
        first..first + (rect.height() / line).floor() as usize
    }

    /// Scrolls by a number of pages.
    pub fn scroll_pages(&mut self, pages: i32, rect: Rect, line: f32) {
        self.user_scrolled = true;
        self.top += f64::from(pages) * f64::from((rect.height() / line).floor() - 1.0);
    }

    /// Scrolls a line to a third of the height, unless it is well in view.
    pub fn scroll_to(&mut self, row: usize, rect: Rect, line: f32) {
        let visible = f64::from((rect.height() / line).floor());
        let row = row as f64;
        if row < self.top + 1.0 || row > self.top + visible - 3.0 {
            self.top = (row - (visible / 3.0).floor()).max(0.0);
        }
    }

    /// Scrolls by the least amount that makes a line visible.
    pub fn reveal(&mut self, row: usize, rect: Rect, line: f32) {
        let visible = f64::from((rect.height() / line).floor()).max(1.0);
        let row = row as f64;
        self.top = self.top.clamp((row + 1.0 - visible).max(0.0), row);
    }

    /// A slim scroll bar.
    pub fn draw_bar(&self, view: &View<'_>, rect: Rect, line: f32, count: usize) {
        let visible = f64::from(rect.height() / line);
        let all = count as f64;
        if all <= visible {
            return;
        }
        let height = (f64::from(rect.height()) * visible / all).max(24.0) as f32;
        let room = f64::from((rect.height() - height).max(0.0));
        let top = rect.min.y + (self.top / (all - visible).max(1.0) * room).clamp(0.0, room) as f32;
        let bar = Rect::from_min_size(egui::pos2(rect.max.x - 5.0, top), vec2(4.0, height));
        view.painter.rect_filled(bar, theme::RADIUS / 2.0, view.theme.muted);
    }
}
