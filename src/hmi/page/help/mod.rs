//! The help for pages, keys, alarms, G and M codes and parameters, searched by number or word. It is a page of its own
//! and an overlay over any other page. All texts are from the tables in `defs`.
//! Source: spec B6, H6, K2.1, K2.4.

mod entries;
mod keyboard_map;

use egui::accesskit::Role;
use egui::{Align2, Color32, Id, Rect, Sense, WidgetInfo, vec2};

pub use entries::{CAUSE, HelpEntry, HelpTopic, REMEDY, Section, alarm_entry, entries};

use super::{PageContext, PageUi, Scroll, ScrollList};
use crate::defs::fitted::Fitted;
use crate::defs::page::Page;
use crate::hmi::{
    Area, EditKey, KeyboardInput, LetterKey, PageKey, Search, SearchTouch, View, letter_pad, round_to_lines, theme,
    widget,
};

/// Height of a line of an entry's text, points.
const TEXT_LINE: f32 = 23.0;
/// Width of the key that closes the overlay, points.
const CLOSE_WIDTH: f32 = 92.0;
/// Maximum number of characters of a search.
const MAX_SEARCH_CHARS: usize = 20;

/// State of the help.
#[derive(Debug, Default)]
pub struct Help {
    /// The entries of this machine.
    entries: Vec<HelpEntry>,
    machine: Option<Fitted>,
    section: Section,
    /// The keyboard map is shown instead of a section.
    keyboard_map_open: bool,
    search: Search,
    /// Indices of the listed entries.
    visible: Vec<usize>,
    cursor: usize,
    scroll: Scroll,
    /// Scroll position of the selected entry's text, and the index of that entry.
    detail_scroll: (Scroll, Option<usize>),
}

impl PageUi for Help {
    fn open(&mut self, view: &View<'_>, _handed_over: Option<u32>) {
        self.open_at(view, Page::Help, None);
    }

    fn accepts_text(&self) -> bool {
        self.search.open || !self.search.text.is_empty()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        self.draw(ctx.view, ctx.rect, ctx.typed, 0.0);
    }
}

impl Help {
    /// Opens at an alarm if given, else at a page.
    pub fn open_at(&mut self, view: &View<'_>, page: Page, alarm: Option<u16>) {
        self.load_entries(view);
        (self.keyboard_map_open, self.search.open) = (false, false);
        self.search.text.clear();
        let (section, about) = match alarm {
            Some(number) => (Section::Alarms, HelpTopic::for_alarm(number)),
            None => (Section::Pages, HelpTopic::Page(page)),
        };
        self.show_section(section);
        self.cursor = self.visible.iter().position(|index| self.entries[*index].topic == about).unwrap_or(0);
    }

    fn load_entries(&mut self, view: &View<'_>) {
        let machine = view.snapshot.fitted();
        if self.machine != Some(machine) {
            self.machine = Some(machine);
            self.entries = entries(machine);
            self.refresh_list();
        }
    }

    fn show_section(&mut self, section: Section) {
        (self.section, self.keyboard_map_open) = (section, false);
        self.search.text.clear();
        self.refresh_list();
    }

    /// Rebuilds the list: the entries of the section, or the search results of all sections.
    fn refresh_list(&mut self) {
        (self.cursor, self.scroll) = (0, Scroll::default());
        let found = |entry: &HelpEntry| match self.search.text.as_str() {
            "" => entry.section == self.section,
            search => entry.matches(search),
        };
        self.visible = (0..self.entries.len()).filter(|index| found(&self.entries[*index])).collect();
        if !self.search.text.is_empty() {
            self.visible.sort_by_key(|index| self.entries[*index].rank(&self.search.text));
        }
    }

    /// Draws the help as an overlay; true if it closes.
    pub fn overlay(&mut self, view: &View<'_>, rect: Rect, typed: &KeyboardInput) -> bool {
        let cancelled = !self.search.open && self.search.text.is_empty() && typed.edits.contains(&EditKey::Cancel);
        view.ui.interact(rect, Id::unique("help"), Sense::CLICK | Sense::DRAG);
        view.filled_card(rect, view.theme.background, view.theme.focus);
        let (_, close) = rect.shrink(theme::PAD).band(0.0, widget::KEYS_HEIGHT).split_right(CLOSE_WIDTH);
        self.draw(view, rect, typed, CLOSE_WIDTH + theme::GAP);
        widget::button(view, close, PageKey::new("close-help", view.text("关闭帮助", "CLOSE"))) || cancelled
    }

    fn draw(&mut self, view: &View<'_>, rect: Rect, typed: &KeyboardInput, room: f32) {
        self.load_entries(view);
        self.handle_typed(typed);
        let (bar, rest) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        self.tabs(view, bar.trim_right(room));
        let rest = rest.trim_top(theme::GAP);
        if self.keyboard_map_open {
            return keyboard_map::ui(view, rest);
        }
        let board = if self.search.open { letter_pad::HEIGHT } else { 0.0 };
        let (body, board) = rest.split_bottom(board);
        let (left, right) = body.split_left_right_at_fraction(0.42);
        let (field, list) = left.trim_right(theme::GAP).split_top(theme::TOUCH_TARGET);
        if self.search.field(view, field, view.text("查找 号码/文字", "find number/word")) == Some(SearchTouch::Clear)
        {
            self.refresh_list();
        }
        self.rows(view, round_to_lines(list.trim_top(theme::GAP), widget::ROW_HEIGHT), typed.scroll_pages);
        self.detail(view, right);
        if self.search.open
            && let Some(letter) = letter_pad::ui(view, board, &letter_pad::SEARCH_LAYOUT)
        {
            self.handle_letter(&letter);
        }
    }

    fn tabs(&mut self, view: &View<'_>, bar: Rect) {
        let mut keys: Vec<_> =
            Section::ALL.iter().map(|section| (section.id(), section.label().get(view.lang).to_owned())).collect();
        keys.push(("help-map", view.text("键盘", "KEYBOARD").to_owned()));
        let here = Section::ALL.iter().position(|section| *section == self.section).unwrap_or(0);
        let chosen = match (self.keyboard_map_open, self.search.text.is_empty()) {
            (true, _) => Section::ALL.len(),
            (false, true) => here,
            // A search covers all sections.
            (false, false) => usize::MAX,
        };
        match widget::tabs(view, bar, &keys, chosen) {
            Some(index) if index < Section::ALL.len() => self.show_section(Section::ALL[index]),
            Some(_) => (self.keyboard_map_open, self.search.open) = (true, false),
            None => {}
        }
    }

    fn handle_typed(&mut self, typed: &KeyboardInput) {
        let mut text = typed.text.as_str();
        if !self.search.open && text.starts_with(|sign: char| sign == '/' || sign.is_alphanumeric()) {
            (self.search.open, self.keyboard_map_open) = (true, false);
            self.search.text.clear();
            text = text.strip_prefix('/').unwrap_or(text);
        }
        if self.search.open && !text.is_empty() {
            let room = MAX_SEARCH_CHARS.saturating_sub(self.search.text.chars().count());
            self.search.text.extend(text.chars().filter(|sign| !sign.is_control()).take(room));
            self.refresh_list();
        }
        typed.edits.iter().for_each(|edit| self.handle_key(*edit));
    }

    fn handle_key(&mut self, edit: EditKey) {
        let last = self.visible.len().saturating_sub(1);
        match edit {
            EditKey::Up => self.select(self.cursor.saturating_sub(1)),
            EditKey::Down => self.select((self.cursor + 1).min(last)),
            EditKey::Backspace | EditKey::Delete if self.search.open => self.handle_letter(&LetterKey::Backspace),
            EditKey::Enter if self.search.open => self.search.open = false,
            EditKey::Cancel if self.search.open || !self.search.text.is_empty() => {
                self.search.open = false;
                self.search.text.clear();
                self.refresh_list();
            }
            EditKey::Left | EditKey::Previous => self.step_tab(Section::ALL.len()),
            EditKey::Right | EditKey::Next => self.step_tab(1),
            EditKey::LineStart => self.select(0),
            EditKey::LineEnd => self.select(last),
            _ => {}
        }
    }

    /// Moves by so many tabs; the keyboard map is the last tab.
    fn step_tab(&mut self, by: usize) {
        let count = Section::ALL.len() + 1;
        let here = Section::ALL.iter().position(|section| *section == self.section && !self.keyboard_map_open);
        match Section::ALL.get((here.unwrap_or(count - 1) + by) % count) {
            Some(section) => self.show_section(*section),
            None => (self.keyboard_map_open, self.search.open) = (true, false),
        }
    }

    fn select(&mut self, row: usize) {
        self.cursor = row;
        self.scroll.user_scrolled = false;
    }

    fn handle_letter(&mut self, letter: &LetterKey) {
        self.search.handle_letter(letter, MAX_SEARCH_CHARS);
        if *letter != LetterKey::Done {
            self.refresh_list();
        }
    }

    fn rows(&mut self, view: &View<'_>, list: Rect, pages: i32) {
        let count = self.visible.len();
        if count == 0 {
            let words = view.text("没有找到，换一个词或号码", "nothing found: try another word or number");
            return view.note(list.band(theme::PAD, 60.0), words);
        }
        if !self.scroll.user_scrolled {
            self.scroll.scroll_to(self.cursor, list, widget::ROW_HEIGHT);
        }
        let list = ScrollList { id: "help-list", rect: list, row: widget::ROW_HEIGHT, gap: 4.0, count };
        let (clipped, rows) = self.scroll.rows(view, &list, pages);
        rows.into_iter().for_each(|(row, place)| self.row(&clipped, place, row));
    }

    fn row(&mut self, view: &View<'_>, place: Rect, row: usize) {
        let entry = &self.entries[self.visible[row]];
        let chosen = row == self.cursor;
        let name = format!("{} {}", entry.name.get(view.lang), entry.id);
        let response = view.touch_row(place, ("help-entry", row), chosen, name);
        view.row_card(place, chosen);
        let inside = place.shrink2(vec2(10.0, 2.0));
        let sign_width = match entry.section {
            Section::Pages => 0.0,
            Section::Keys => 92.0,
            Section::Alarms => 82.0,
            Section::SoftKeys | Section::GCodes | Section::MCodes | Section::Params => 64.0,
        };
        let (sign, words) = inside.split_left(sign_width);
        let ink = if is_present(view, entry.topic) { view.theme.alarm_text } else { view.theme.info };
        view.fit_left(sign.trim_right(theme::GAP.min(sign_width)), &entry.code, theme::LABEL, ink);
        paint_name(view, words, &entry.name.get(view.lang), theme::LABEL, view.theme.text);
        if response.clicked() {
            self.cursor = row;
            self.scroll.user_scrolled = true;
        }
    }

    /// Draws the selected entry in full; a long text scrolls by drag.
    fn detail(&mut self, view: &View<'_>, rect: Rect) {
        view.card(rect);
        let Some(index) = self.visible.get(self.cursor).copied() else { return };
        let entry = &self.entries[index];
        let response = view.ui.interact(rect, Id::unique("help-detail"), Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, entry.text(view.lang)));
        let inside = rect.shrink(theme::PAD);
        let head = inside.band(0.0, 40.0);
        let title = format!("{} {}", entry.code, entry.name.get(view.lang));
        paint_name(view, head, title.trim(), theme::SECONDARY, view.theme.text);
        let room = inside.with_min_y(head.max.y + theme::GAP);
        let lines = lines_of(view, entry, room.width() - 8.0);
        let list = round_to_lines(room, TEXT_LINE);
        let (scroll, of) = &mut self.detail_scroll;
        if *of != Some(index) {
            (*scroll, *of) = (Scroll::default(), Some(index));
        }
        // Some glyphs start left of their position.
        let clipped = view.clipped(list.expand2(vec2(2.0, 0.0)));
        let spec = ScrollList { id: "help-text", rect: list, row: TEXT_LINE, gap: 0.0, count: lines.len() };
        for (at, place) in scroll.rows(view, &spec, 0).1 {
            let (words, size, ink) = &lines[at];
            // A caption is aligned to the text below it.
            let align = if *size < theme::LABEL { Align2::LEFT_BOTTOM } else { Align2::LEFT_CENTER };
            clipped.fit(place, align, words, *size, *ink);
        }
    }
}

/// The lines of an entry: a caption, then its text wrapped to a width.
fn lines_of(view: &View<'_>, entry: &HelpEntry, width: f32) -> Vec<(String, f32, Color32)> {
    let mut lines = Vec::new();
    let mut part = |caption: &str, words: &str, ink: Color32| {
        lines.push((caption.to_owned(), theme::SMALL, view.theme.muted));
        let size = theme::TITLE - 1.0;
        let text = view.painter.layout(words.to_owned(), theme::font(size), ink, width);
        lines.extend(text.rows.iter().map(|row| (row.text(), size, ink)));
    };
    if let Some(words) = live_text(view, entry.topic) {
        part(view.text("现在", "now"), &words, view.theme.hold);
    }
    for (caption, words) in &entry.paragraphs {
        part(caption.get(view.lang), &words.get(view.lang), view.theme.text);
    }
    lines
}

/// Paints a name in one line, or in two small lines if it is too long.
fn paint_name(view: &View<'_>, rect: Rect, words: &str, size: f32, ink: Color32) {
    if view.layout_line(words, theme::SMALL, ink, rect.width()).elided {
        let height = view.painter.layout(words.to_owned(), theme::font(theme::SMALL), ink, rect.width()).size().y;
        view.paragraph(rect.with_min_y(rect.center().y - height / 2.0).trim_bottom(-4.0), words, theme::SMALL, ink);
    } else {
        view.fit_left(rect, words, size, ink);
    }
}

fn is_present(view: &View<'_>, about: HelpTopic) -> bool {
    matches!(about, HelpTopic::Alarm(number) if view.snapshot.alarms.iter().any(|alarm| alarm.number == number))
}

/// Live text of the machine: why a key is refused, the text of an active alarm, the value of a parameter.
fn live_text(view: &View<'_>, about: HelpTopic) -> Option<String> {
    match about {
        HelpTopic::Key(key) => view.snapshot.key(key).blocked.map(|reason| reason.get(view.lang).to_owned()),
        HelpTopic::Alarm(number) => {
            let alarm = view.snapshot.alarms.iter().find(|alarm| alarm.number == number)?;
            Some(alarm.text.get(view.lang).into_owned())
        }
        HelpTopic::Param(at) => view.snapshot.params.read(at).ok().map(|value| value.to_string()),
        HelpTopic::Page(_) | HelpTopic::SoftKey(_) | HelpTopic::GCode | HelpTopic::MCode => None,
    }
}
