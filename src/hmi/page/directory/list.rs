//! The list of the program directory: which programs the search shows, which one is selected, and its rows. The selection
//! is the number of a program: it stays with its program when the folder changes.
//! Source: spec B6 (directory with size and comment, search), H9.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Id, Rect, Sense, WidgetInfo, vec2};

use crate::defs::kind::Kind;
use crate::defs::text::{Lang, phrase};
use crate::hmi::page::{Scroll, ScrollList, empty};
use crate::hmi::{
    Area, EditKey, KeycapState, PageMessage, Search, SearchTouch, View, format_size, keycap, pictogram, round_to_lines,
    theme, widget,
};
use crate::link::snapshot::{DirectoryRow, RunState};

/// Height of the line of title and search.
pub const HEADER_HEIGHT: f32 = widget::KEYS_HEIGHT + 4.0;
/// Height of a row.
const ROW_HEIGHT: f32 = 50.0;
/// Width of the search field.
const SEARCH_WIDTH: f32 = 240.0;
/// Height of the mark of a program of another kind.
const MARK_HEIGHT: f32 = 24.0;

/// The shown programs and the selected one.
#[derive(Debug, Default)]
pub struct ProgramList {
    /// The search: number, name or comment.
    pub search: Search,
    scroll: Scroll,
    /// The directory and the search from which the shown rows were taken.
    read: (Arc<Vec<DirectoryRow>>, String),
    /// The shown rows, by their index in the directory.
    shown: Vec<usize>,
    /// Number of the selected program.
    selected: Option<u32>,
    /// Place of the selected program among the shown ones.
    place: usize,
    /// A program that a request makes: selected as soon as the directory has it.
    expected: Option<u32>,
    /// The selection has changed: scroll to it.
    reveal: bool,
}

impl ProgramList {
    /// Selects a program and scrolls to it.
    pub fn select(&mut self, number: u32) {
        (self.selected, self.reveal) = (Some(number), true);
    }

    /// Selects a program as soon as the directory has it.
    pub const fn expect(&mut self, number: u32) {
        self.expected = Some(number);
    }

    /// Scrolls to the selected program.
    pub const fn reveal(&mut self) {
        self.reveal = true;
    }

    /// The selected program; none if no program is shown.
    pub fn selected(&self) -> Option<&DirectoryRow> {
        self.shown.get(self.place).and_then(|index| self.read.0.get(*index))
    }

    /// Follows the directory and the search.
    pub fn update(&mut self, directory: &Arc<Vec<DirectoryRow>>) {
        let arrived = self.expected.take_if(|number| directory.iter().any(|row| row.number == *number));
        if let Some(number) = arrived {
            // What was just made is shown, whatever was searched before.
            self.search = Search::default();
            self.select(number);
        }
        if !Arc::ptr_eq(&self.read.0, directory) || self.read.1 != self.search.text {
            self.read = (Arc::clone(directory), self.search.text.clone());
            let found = directory.iter().enumerate().filter(|(_, row)| is_found(row, &self.search.text));
            self.shown = found.map(|(index, _)| index).collect();
            self.reveal = true;
        }
        let number_at = |place: usize| self.shown.get(place).map(|index| directory[*index].number);
        let found = (0..self.shown.len()).find(|place| number_at(*place) == self.selected);
        self.place = found.unwrap_or_else(|| self.place.min(self.shown.len().saturating_sub(1)));
        self.selected = number_at(self.place);
    }

    /// Moves the selection by the arrow keys.
    pub fn handle_keys(&mut self, edits: &[EditKey]) {
        for edit in edits {
            match edit {
                EditKey::Up | EditKey::Previous => self.step(-1),
                EditKey::Down | EditKey::Next => self.step(1),
                _ => {}
            }
        }
    }

    fn step(&mut self, by: isize) {
        let place = self.place.saturating_add_signed(by).min(self.shown.len().saturating_sub(1));
        if let Some(index) = self.shown.get(place) {
            self.place = place;
            self.select(self.read.0[*index].number);
        }
    }

    /// Title with the selected program, or why a key did nothing, and the search field; true if the field was touched.
    pub fn header(&mut self, rect: Rect, view: &View<'_>, message: &PageMessage) -> bool {
        let (rest, field) = rect.split_right(SEARCH_WIDTH);
        if let Some((words, ink)) = message.shown(view, view.theme.text) {
            view.fit_left(rest.trim_right(theme::PAD), &words, theme::TITLE, ink);
        } else {
            self.title(rest, view);
        }
        let hint = view.text("查找 号/名称/说明", "find number/name/text");
        self.search.field(view, field.trim_bottom(4.0), hint) == Some(SearchTouch::Field)
    }

    fn title(&self, rest: Rect, view: &View<'_>) {
        let title = view.fit_left(rest, view.text("程序目录", "programs"), theme::SECONDARY, view.theme.text);
        let count = match (self.shown.len(), self.read.0.len()) {
            (shown, all) if shown == all => all.to_string(),
            (shown, all) => format!("{shown} / {all}"),
        };
        let rest = rest.with_min_x(title.max.x + theme::PAD);
        let count = view.line_left(rest, &count, theme::LABEL, view.theme.muted);
        let chosen = rest.with_min_x(count.max.x + theme::PAD).trim_right(theme::PAD);
        if let Some(row) = self.selected() {
            // The keys below act on this program, also while the list is scrolled away from it.
            view.fit_left(chosen, &row.name, theme::SECONDARY, view.theme.focus);
        }
    }

    /// Draws the list; true if the selected program is to be loaded.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, pages: i32) -> bool {
        if self.read.0.is_empty() {
            let remedy = view.text(
                "把程序 O1001.NC … 拷贝到 programs 目录。",
                "Copy programs (O1001.NC …) into the programs folder.",
            );
            empty::show(view, rect, pictogram::NO_PAGE, view.text("没有程序", "no programs"), remedy);
            return false;
        }
        view.card(rect);
        let list = round_to_lines(rect.shrink(4.0), ROW_HEIGHT);
        if self.shown.is_empty() {
            let words = view.text("没有找到：× 清除查找，显示全部", "nothing found: × clears the search and shows all");
            view.note(list.shrink2(vec2(theme::PAD, theme::GAP)), words);
            return false;
        }
        if pages != 0 {
            self.step(pages as isize * ((list.height() / ROW_HEIGHT) as isize - 1).max(1));
        }
        if std::mem::take(&mut self.reveal) {
            self.scroll.scroll_to(self.place, list, ROW_HEIGHT);
        }
        let spec = ScrollList { id: "directory", rect: list, row: ROW_HEIGHT, gap: 4.0, count: self.shown.len() };
        let (clipped, places) = self.scroll.rows(view, &spec, 0);
        let named = places.iter().any(|(place, _)| self.read.0[self.shown[*place]].name.len() > 6);
        let (directory, mut load) = (Arc::clone(&self.read.0), false);
        for (place, rect) in places {
            let row = &directory[self.shown[place]];
            let chosen = place == self.place;
            if clipped.touch_row(rect, ("program", place), chosen, row.name.clone()).clicked() {
                (self.selected, self.place) = (Some(row.number), place);
            }
            load |= paint_row(&clipped, rect, row, &RowLook { chosen, name_width: if named { 150.0 } else { 88.0 } });
        }
        load
    }
}

/// Whether a search shows a program: each of its words stands in the name or in the comment.
fn is_found(row: &DirectoryRow, search: &str) -> bool {
    let text = format!("{} {} {}", row.name, row.comment, row.comment_in(Lang::En)).to_lowercase();
    search.to_lowercase().split_whitespace().all(|word| text.contains(word))
}

/// How a row is painted.
struct RowLook {
    chosen: bool,
    name_width: f32,
}

/// Paints a row; true if its key 装入 is touched.
fn paint_row(view: &View<'_>, place: Rect, row: &DirectoryRow, look: &RowLook) -> bool {
    let current = row.number == view.snapshot.program.number;
    let fits = row.is_for(view.snapshot.kind);
    if look.chosen {
        view.painter.rect_filled(place, theme::RADIUS, view.theme.raised);
        view.frame(place, view.theme.focus);
    }
    let (number, rest) = place.shrink2(vec2(theme::PAD, 3.0)).split_left(look.name_width);
    let text = if fits { view.theme.text } else { view.theme.muted };
    view.fit_left(number, &row.name, theme::SECONDARY, if current { view.theme.run } else { text });
    let (rest, action) = rest.split_right(96.0);
    let (mut comment, details) = rest.split_right(210.0);
    comment = comment.trim_right(theme::PAD);
    if !fits {
        let mark = Rect::from_center_size(comment.center(), vec2(comment.width(), MARK_HEIGHT));
        let mark = view.chip(comment.max.x, mark, &kind_mark(view, &row.kinds), view.theme.raised, view.theme.hold);
        comment = comment.with_max_x(mark.min.x - theme::GAP);
    }
    // A long comment takes two lines of the same size.
    view.text_rows(comment, &shown_comment(view, row), theme::LABEL, text, 2);
    let (size, date) = details.split_left_right_at_fraction(0.34);
    view.line_right(size, &format_size(row.size), theme::LABEL, view.theme.muted);
    view.fit_right(date.trim_right(theme::PAD), &row.modified, theme::LABEL, view.theme.muted);
    if current {
        view.fit_right(action, view.text("当前", "CURRENT"), theme::LABEL, view.theme.run);
        return false;
    }
    look.chosen && load_key(action, view)
}

/// The kinds of machine that a program is for.
fn kind_mark(view: &View<'_>, kinds: &[Kind]) -> String {
    let names: Vec<_> = kinds.iter().map(|kind| kind.short_name()).collect();
    view.phrase(&phrase!("{kinds} 的程序", "for {kinds}", kinds = names.join(" ")))
}

fn shown_comment(view: &View<'_>, row: &DirectoryRow) -> String {
    row.comment_in(view.lang).replace('\u{FFFD}', "?")
}

/// 装入: the only key that loads by touch. The core refuses while a program runs.
fn load_key(action: Rect, view: &View<'_>) -> bool {
    let place = Rect::from_center_size(action.center() + vec2(2.0, 0.0), vec2(96.0, theme::TOUCH_TARGET));
    let words = view.text("装入", "LOAD");
    let running = matches!(view.snapshot.state, RunState::Running | RunState::Held | RunState::Waiting);
    let response = view.ui.interact(place.intersect(view.painter.clip_rect()), Id::unique("load"), Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, !running, format!("{words} load-program")));
    let face =
        KeycapState { pressed: response.is_pointer_button_down_on(), blocked: running, ..KeycapState::default() };
    keycap::paint_body(view, place, face);
    view.outline(place, if running { view.theme.line } else { view.theme.focus });
    view.fit_centre(place, words, theme::TITLE, if running { view.theme.disabled } else { view.theme.text });
    response.clicked()
}
