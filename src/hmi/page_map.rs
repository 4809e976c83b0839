//! All pages by their rows of soft keys, over the page: any of them is two touches away. Source: spec H1, K7.1.

use egui::{Id, Rect, Sense};

use super::page_frame::soft_key_row_count;
use super::widget::{self, KeyboardFocus, PageKey};
use super::{Area, EditKey, View, theme};
use crate::defs::soft_key::{self, SoftKeyAction};
use crate::defs::text::Text;

/// Keys of a row: F1 to F5.
const COLUMNS: usize = 5;
/// Width of the number of a row, points.
const NUMBER_WIDTH: f32 = 30.0;
/// Least and greatest height of a key, points.
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
        let rows = rows(view);
        let open = rows.iter().flatten().position(|(action, _)| *action == open_action(view));
        self.focus = KeyboardFocus::default();
        if let Some(open) = open {
            self.focus.select(open, rows.iter().flatten().count());
        }
    }

    /// Closes it.
    pub const fn close(&mut self) {
        self.open = false;
    }

    /// The cursor walks along the rows, and up and down between them.
    fn follow_cursor_keys(&mut self, edits: &[EditKey], rows: &[Vec<MapKey>]) {
        for edit in edits {
            let down = match edit {
                EditKey::Down => 1,
                EditKey::Up => rows.len() - 1,
                _ => continue,
            };
            let Some(at) = self.focus.selected() else { continue };
            let (row, column) = place(rows, at);
            let wanted = (row + down) % rows.len();
            let before: usize = rows.iter().take(wanted).map(Vec::len).sum();
            let last = rows[wanted].len().saturating_sub(1);
            self.focus.select(before + column.min(last), rows.iter().flatten().count());
        }
        let others: Vec<_> =
            edits.iter().copied().filter(|edit| !matches!(edit, EditKey::Up | EditKey::Down)).collect();
        self.focus.begin_frame(&others);
    }

    /// Draws it over the page; returns what the touched key does.
    pub fn ui(&mut self, view: &View<'_>, page: Rect, edits: &[EditKey]) -> Option<SoftKeyAction> {
        let rect = page.shrink(theme::GAP);
        view.ui.interact(rect, Id::unique("page-map-card"), Sense::CLICK | Sense::DRAG);
        view.filled_card(rect, view.theme.background, view.theme.focus);
        let rows = rows(view);
        self.follow_cursor_keys(edits, &rows);
        let (head, body) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        let (title, close) = head.split_right(CLOSE_WIDTH);
        view.fit_left(title, view.text("全部页面", "all pages"), theme::SECONDARY, view.theme.text);
        let height = body.trim_top(theme::GAP).height() / rows.len() as f32 - theme::GAP;
        let height = height.clamp(KEY_HEIGHTS.0, KEY_HEIGHTS.1);
        let (open, mut touched) = (open_action(view), None);
        for (row, keys) in rows.iter().enumerate() {
            let line = body.band(theme::GAP + row as f32 * (height + theme::GAP), height);
            let (number, line) = line.split_left(NUMBER_WIDTH);
            view.line_centre(number, &(row + 1).to_string(), theme::LABEL, view.theme.muted);
            for (index, (action, label)) in keys.iter().enumerate() {
                let name = format!("map-{}-{}", row + 1, index + 1);
                let key = PageKey::new(&name, label.get(view.lang)).on(*action == open);
                if self.focus.button(view, line.cell(index, COLUMNS), key) {
                    touched = Some(*action);
                }
            }
        }
        let closed = widget::button(view, close, PageKey::new("close-map", view.text("返回", "BACK")));
        if closed || touched.is_some() || edits.contains(&EditKey::Cancel) {
            self.open = false;
        }
        touched
    }
}

/// A page of the map: what its key does, and its label.
type MapKey = (SoftKeyAction, Text);

/// The keys of each row that open a page. A program that waits has no part in it: F1 of a lathe continues it elsewhere.
fn rows(view: &View<'_>) -> Vec<Vec<MapKey>> {
    let keys = |row| soft_key::row(view.snapshot.kind, row).filter(|soft| soft.action.opens_page());
    (0..soft_key_row_count(view)).map(|row| keys(row).map(|soft| (soft.action, soft.label)).collect()).collect()
}

/// The key of the open page.
const fn open_action(view: &View<'_>) -> SoftKeyAction {
    soft_key::key_of_page(view.snapshot.page, view.snapshot.coordinates)
}

/// Row and column of a key that is counted through all rows.
fn place(rows: &[Vec<MapKey>], mut at: usize) -> (usize, usize) {
    for (row, keys) in rows.iter().enumerate() {
        if at < keys.len() {
            return (row, at);
        }
        at -= keys.len();
    }
    (0, 0)
}
