//! All pages by their rows of soft keys, over the page: any of them is two touches away. Source: spec H1, K7.1.

use egui::{Id, Rect, Sense};

use super::page_frame::{soft_key_row, soft_key_row_count};
use super::widget::{self, KeyboardFocus, PageKey};
use super::{Area, EditKey, View, theme};
use crate::defs::soft_key::{self, SoftKeyAction};

/// Keys of a row: F1 to F5.
const COLUMNS: usize = 5;
/// Width of the number of a row, points.
const NUMBER_WIDTH: f32 = 30.0;
/// Height of a key, points.
const KEY_HEIGHTS: (f32, f32) = (theme::TOUCH_TARGET, 84.0);
/// Width of the key that closes it, points.
const CLOSE_WIDTH: f32 = 110.0;

/// The map of the pages over a page.
#[derive(Debug, Default)]
pub struct PageMap {
    open: bool,
    focus: KeyboardFocus,
}

impl PageMap {
    /// Whether it lies over the page.
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// Opens it with the focus on the open page, or closes it.
    pub fn toggle(&mut self, view: &View<'_>) {
        self.open = !self.open;
        let keys: Vec<_> = keys(view).collect();
        let open = keys.iter().position(|(_, action)| *action == open_action(view));
        self.focus.select(open.unwrap_or(0), keys.len());
    }

    /// Closes it.
    pub const fn close(&mut self) {
        self.open = false;
    }

    /// Draws it over the page; returns what the touched key does.
    pub fn ui(&mut self, view: &View<'_>, page: Rect, edits: &[EditKey]) -> Option<SoftKeyAction> {
        let rect = page.shrink(theme::GAP);
        view.ui.interact(rect, Id::unique("page-map-card"), Sense::CLICK | Sense::DRAG);
        view.filled_card(rect, view.theme.background, view.theme.focus);
        self.focus.begin_frame(&in_columns(edits));
        let (head, body) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (title, close) = head.split_right(CLOSE_WIDTH);
        view.fit_left(title, view.text("全部页面", "all pages"), theme::SECONDARY, view.theme.text);
        let rows = soft_key_row_count(view);
        let height = (body.trim_top(theme::GAP).height() / rows as f32).min(KEY_HEIGHTS.1 + theme::GAP);
        let height = height.max(KEY_HEIGHTS.0 + theme::GAP);
        let (open, mut touched) = (open_action(view), None);
        for row in 0..rows {
            let line = body.band(theme::GAP + row as f32 * height, height - theme::GAP);
            let (number, line) = line.split_left(NUMBER_WIDTH);
            view.line_centre(number, &(row + 1).to_string(), theme::LABEL, view.theme.muted);
            for (index, soft) in soft_key_row(view, row).enumerate() {
                let (name, label) = (format!("map-{}-{}", row + 1, index + 1), soft.label.get(view.lang));
                let key = PageKey::new(&name, label).on(soft.action == open);
                if self.focus.button(view, line.cell(index, COLUMNS), key) {
                    touched = Some(soft.action);
                }
            }
        }
        let closed = widget::button(view, close, PageKey::new("close-map", view.text("关闭", "CLOSE")));
        if closed || touched.is_some() || edits.contains(&EditKey::Cancel) {
            self.open = false;
        }
        touched
    }
}

/// The keys of all rows: row and action.
fn keys<'a>(view: &'a View<'_>) -> impl Iterator<Item = (usize, SoftKeyAction)> + 'a {
    (0..soft_key_row_count(view)).flat_map(move |row| soft_key_row(view, row).map(move |soft| (row, soft.action)))
}

/// The key of the open page.
const fn open_action(view: &View<'_>) -> SoftKeyAction {
    soft_key::key_of_page(view.snapshot.page, view.snapshot.coordinates)
}

/// The cursor keys up and down as so many steps to the side: the focus walks along the rows.
fn in_columns(edits: &[EditKey]) -> Vec<EditKey> {
    let steps = |edit: &EditKey| match edit {
        EditKey::Up => [EditKey::Left; COLUMNS].to_vec(),
        EditKey::Down => [EditKey::Right; COLUMNS].to_vec(),
        other => vec![*other],
    };
    edits.iter().flat_map(steps).collect()
}
