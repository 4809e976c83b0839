//! The help for pages, keys, alarms, G and M codes and parameters, searched by number or word. It is a page of its own
//! and an overlay over any other page. All texts are from the tables in `defs`.
//! Source: spec B6, H6, K2.1, K2.4.

mod entries;
mod keyboard_map;

use egui::accesskit::Role;
use egui::{Align2, Color32, Id, Painter, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

pub use entries::{HelpEntry, HelpTopic, Section, alarm_entry, entries};

use super::scroll::Scroll;
use super::{PageContext, PageUi, TypedInput};
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::hmi::edit_key::EditKey;
use crate::hmi::letter_pad::{self, LetterKey};
use crate::hmi::search_field::{self, SearchField, SearchTouch};
use crate::hmi::theme;
use crate::hmi::view::{View, card, fit_text, focus_frame, layout_line, paragraph};
use crate::hmi::widget::{self, ButtonState, round_to_lines};

/// Height of a line of the list, points.
const ROW: f32 = 46.0;
/// Height of a line of an entry's text, points.
const TEXT_LINE: f32 = 23.0;
/// Width of the key that closes the overlay, points.
const CLOSE_WIDTH: f32 = 92.0;
/// Maximum number of characters of a search.
const MAX_SEARCH_CHARS: usize = 20;

/// State of the help.
#[derive(Debug, Default)]
pub struct Help {
    /// The entries of this kind of machine.
    entries: Vec<HelpEntry>,
    kind: Option<Kind>,
    section: Section,
    /// The keyboard map is shown instead of a section.
    keyboard_map_open: bool,
    search: String,
    /// Typed text goes into the search.
    searching: bool,
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
        self.searching || !self.search.is_empty()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        self.draw(ctx.ui, ctx.view, ctx.rect, ctx.typed, 0.0);
    }
}

impl Help {
    /// Opens at an alarm if given, else at a page.
    pub fn open_at(&mut self, view: &View<'_>, page: Page, alarm: Option<u16>) {
        self.load_entries(view);
        (self.keyboard_map_open, self.searching) = (false, false);
        self.search.clear();
        let (section, about) = match alarm {
            Some(number) => (Section::Alarms, HelpTopic::for_alarm(number)),
            None => (Section::Pages, HelpTopic::Page(page)),
        };
        self.show_section(section);
        self.cursor = self.visible.iter().position(|index| self.entries[*index].topic == about).unwrap_or(0);
    }

    fn load_entries(&mut self, view: &View<'_>) {
        let kind = view.snapshot.kind;
        if self.kind != Some(kind) {
            self.kind = Some(kind);
            self.entries = entries(kind);
            self.refresh_list();
        }
    }

    fn show_section(&mut self, section: Section) {
        (self.section, self.keyboard_map_open) = (section, false);
        self.search.clear();
        self.refresh_list();
    }

    /// Rebuilds the list: the entries of the section, or the search results of all sections.
    fn refresh_list(&mut self) {
        (self.cursor, self.scroll) = (0, Scroll::default());
        let found = |entry: &HelpEntry| match self.search.as_str() {
            "" => entry.section == self.section,
            search => entry.matches(search),
        };
        self.visible = (0..self.entries.len()).filter(|index| found(&self.entries[*index])).collect();
        if !self.search.is_empty() {
            self.visible.sort_by_key(|index| self.entries[*index].rank(&self.search));
        }
    }

    /// Draws the help as an overlay; true if it closes.
    pub fn overlay(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, typed: &TypedInput<'_>) -> bool {
        let cancelled = !self.searching && self.search.is_empty() && typed.edits.contains(&EditKey::Cancel);
        ui.interact(rect, Id::unique("help"), Sense::CLICK | Sense::DRAG);
        card(ui.painter(), rect, view.theme.background, view.theme.focus);
        let bar = Rect::from_min_size(
            rect.shrink(theme::PAD).min,
            vec2(rect.width() - 2.0 * theme::PAD, widget::TABS_HEIGHT),
        );
        let (_, close) = bar.split_left_right_at_x(bar.max.x - CLOSE_WIDTH);
        self.draw(ui, view, rect, typed, CLOSE_WIDTH + theme::GAP);
        widget::button(ui, view, close, "close-help", view.text("关闭帮助", "CLOSE"), ButtonState::default())
            || cancelled
    }

    fn draw(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, typed: &TypedInput<'_>, room: f32) {
        self.load_entries(view);
        self.handle_typed(typed);
        let inside = rect.shrink(theme::PAD);
        let (bar, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS_HEIGHT);
        self.tabs(ui, view, Rect::from_min_max(bar.min, bar.max - vec2(room, 0.0)));
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::GAP), rest.max);
        if self.keyboard_map_open {
            return keyboard_map::ui(ui, view, rest);
        }
        let board = if self.searching { letter_pad::SEARCH_LAYOUT.height() } else { 0.0 };
        let (body, board) = rest.split_top_bottom_at_y(rest.max.y - board);
        let (left, right) = body.split_left_right_at_fraction(0.42);
        let left = Rect::from_min_max(left.min, left.max - vec2(theme::GAP, 0.0));
        let (field, list) = left.split_top_bottom_at_y(left.min.y + theme::TOUCH_TARGET);
        let hint = view.text("查找 号码/文字", "find number/word");
        let shown = SearchField { hint, text: &self.search, open: self.searching };
        match search_field::field(ui, view, field, shown) {
            Some(SearchTouch::Field) => self.searching = !self.searching,
            Some(SearchTouch::Clear) => {
                self.search.clear();
                self.refresh_list();
            }
            None => {}
        }
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max);
        self.rows(ui, view, round_to_lines(list, ROW), typed.scroll_pages);
        self.detail(ui, view, right);
        if self.searching
            && let Some(letter) = letter_pad::ui(ui, view, board, &letter_pad::SEARCH_LAYOUT)
        {
            self.handle_letter(&letter);
        }
    }

    fn tabs(&mut self, ui: &Ui, view: &View<'_>, bar: Rect) {
        let mut keys: Vec<_> =
            Section::ALL.iter().map(|section| (section.id(), section.name().get(view.lang).to_owned())).collect();
        keys.push(("help-map", view.text("键盘", "KEYBOARD").to_owned()));
        let here = Section::ALL.iter().position(|section| *section == self.section).unwrap_or(0);
        let chosen = match (self.keyboard_map_open, self.search.is_empty()) {
            (true, _) => Section::ALL.len(),
            (false, true) => here,
            // A search covers all sections.
            (false, false) => usize::MAX,
        };
        match widget::tabs(ui, view, bar, &keys, chosen) {
            Some(index) if index < Section::ALL.len() => self.show_section(Section::ALL[index]),
            Some(_) => (self.keyboard_map_open, self.searching) = (true, false),
            None => {}
        }
    }

    fn handle_typed(&mut self, typed: &TypedInput<'_>) {
        let mut text = typed.text;
        if !self.searching && text.starts_with(|sign: char| sign == '/' || sign.is_alphanumeric()) {
            (self.searching, self.keyboard_map_open) = (true, false);
            self.search.clear();
            text = text.strip_prefix('/').unwrap_or(text);
        }
        if self.searching && !text.is_empty() {
            let room = MAX_SEARCH_CHARS.saturating_sub(self.search.chars().count());
            self.search.extend(text.chars().filter(|sign| !sign.is_control()).take(room));
            self.refresh_list();
        }
        for edit in typed.edits {
            self.handle_key(*edit);
        }
    }

    fn handle_key(&mut self, edit: EditKey) {
        let last = self.visible.len().saturating_sub(1);
        match edit {
            EditKey::Up => self.select(self.cursor.saturating_sub(1)),
            EditKey::Down => self.select((self.cursor + 1).min(last)),
            EditKey::Backspace | EditKey::Delete if self.searching => self.handle_letter(&LetterKey::Backspace),
            EditKey::Enter if self.searching => self.searching = false,
            EditKey::Cancel if self.searching || !self.search.is_empty() => {
                self.searching = false;
                self.search.clear();
                self.refresh_list();
            }
            EditKey::Left | EditKey::Previous => self.step_tab(Section::ALL.len()),
            EditKey::Right | EditKey::Next => self.step_tab(1),
            EditKey::LineStart => self.select(0),
            EditKey::LineEnd => self.select(last),
            EditKey::Char(_)
            | EditKey::Sign
            | EditKey::Backspace
            | EditKey::Delete
            | EditKey::Enter
            | EditKey::Cancel => {}
        }
    }

    /// Moves by so many tabs; the keyboard map is the last tab.
    fn step_tab(&mut self, by: usize) {
        let count = Section::ALL.len() + 1;
        let here = Section::ALL.iter().position(|section| *section == self.section && !self.keyboard_map_open);
        match Section::ALL.get((here.unwrap_or(count - 1) + by) % count) {
            Some(section) => self.show_section(*section),
            None => (self.keyboard_map_open, self.searching) = (true, false),
        }
    }

    fn select(&mut self, row: usize) {
        self.cursor = row;
        self.scroll.user_scrolled = false;
    }

    fn handle_letter(&mut self, letter: &LetterKey) {
        match letter {
            LetterKey::Char(sign) if self.search.chars().count() < MAX_SEARCH_CHARS => self.search.push(*sign),
            LetterKey::Char(_) => {}
            LetterKey::Word(word) => (*word).clone_into(&mut self.search),
            LetterKey::Backspace => drop(self.search.pop()),
            LetterKey::Done => return self.searching = false,
        }
        self.refresh_list();
    }

    fn rows(&mut self, ui: &Ui, view: &View<'_>, list: Rect, pages: i32) {
        let count = self.visible.len();
        if count == 0 {
            let words = view.text("没有找到，换一个词或号码", "nothing found: another word or number");
            let place = Rect::from_min_size(list.min + vec2(0.0, theme::PAD), vec2(list.width(), 60.0));
            paragraph(ui.painter(), place, words, theme::LABEL, view.theme.muted);
            return;
        }
        if pages != 0 {
            self.scroll.scroll_pages(pages, list, ROW);
        }
        if !self.scroll.user_scrolled {
            self.scroll.scroll_to(self.cursor, list, ROW);
        }
        let (first, last) = self.scroll.handle_input(ui, "help-list", list, ROW, count);
        for row in first..last {
            let top = list.min.y + ((row as f64 - self.scroll.top) * f64::from(ROW)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 4.0));
            self.row(ui, view, (list, place), row);
        }
        self.scroll.draw_bar(ui, view, list, ROW, count);
    }

    fn row(&mut self, ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), row: usize) {
        let entry = &self.entries[self.visible[row]];
        let painter = &ui.painter().with_clip_rect(list);
        let response = ui.interact(place.intersect(list), Id::unique(("help-entry", row)), Sense::CLICK);
        let name = format!("{} {}", entry.name.get(view.lang), entry.id);
        let chosen = row == self.cursor;
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
        let fill = if chosen { view.theme.raised } else { view.theme.surface };
        card(painter, place, fill, view.theme.line);
        if chosen {
            focus_frame(painter, place, view.theme.focus);
        }
        let inside = place.shrink2(vec2(10.0, 2.0));
        let sign_width = match entry.section {
            Section::Pages => 0.0,
            Section::Keys => 92.0,
            Section::Alarms => 82.0,
            Section::SoftKeys | Section::GCodes | Section::MCodes | Section::Params => 64.0,
        };
        let (sign, words) = inside.split_left_right_at_x(inside.min.x + sign_width);
        let ink = if is_present(view, entry.topic) { view.theme.alarm_text } else { view.theme.info };
        let sign = Rect::from_min_max(sign.min, sign.max - vec2(theme::GAP, 0.0).min(sign.size()));
        fit_text(painter, sign, Align2::LEFT_CENTER, &entry.code, theme::LABEL, ink);
        paint_name(painter, words, entry.name.get(view.lang), theme::LABEL, view.theme.text);
        if response.clicked() {
            self.cursor = row;
            self.scroll.user_scrolled = true;
        }
    }

    /// Draws the selected entry in full; a long text scrolls by drag.
    fn detail(&mut self, ui: &Ui, view: &View<'_>, rect: Rect) {
        let painter = ui.painter();
        card(painter, rect, view.theme.surface, view.theme.line);
        let Some(index) = self.visible.get(self.cursor).copied() else { return };
        let entry = &self.entries[index];
        let response = ui.interact(rect, Id::unique("help-detail"), Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, entry.text(view.lang)));
        let inside = rect.shrink(theme::PAD);
        let head = Rect::from_min_size(inside.min, vec2(inside.width(), 40.0));
        let title = format!("{} {}", entry.code, entry.name.get(view.lang));
        paint_name(painter, head, title.trim(), theme::SECONDARY, view.theme.text);
        let room = Rect::from_min_max(pos2(inside.min.x, head.max.y + theme::GAP), inside.max);
        let lines = lines_of(painter, view, entry, room.width() - 8.0);
        let list = round_to_lines(room, TEXT_LINE);
        let (scroll, of) = &mut self.detail_scroll;
        if *of != Some(index) {
            (*scroll, *of) = (Scroll::default(), Some(index));
        }
        let (first, last) = scroll.handle_input(ui, "help-text", list, TEXT_LINE, lines.len());
        // Some glyphs start left of their position.
        let painter = &painter.with_clip_rect(list.expand2(vec2(2.0, 0.0)));
        for (at, (words, size, ink)) in lines.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((at as f64 - scroll.top) * f64::from(TEXT_LINE)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), TEXT_LINE));
            // A caption is aligned to the text below it.
            let align = if *size < theme::LABEL { Align2::LEFT_BOTTOM } else { Align2::LEFT_CENTER };
            fit_text(painter, place, align, words, *size, *ink);
        }
        scroll.draw_bar(ui, view, list, TEXT_LINE, lines.len());
    }
}

/// The lines of an entry: a caption, then its text wrapped to a width.
fn lines_of(painter: &Painter, view: &View<'_>, entry: &HelpEntry, width: f32) -> Vec<(String, f32, Color32)> {
    let mut lines = Vec::new();
    let mut part = |caption: &str, words: &str, ink: Color32| {
        lines.push((caption.to_owned(), theme::SMALL, view.theme.muted));
        let size = theme::TITLE - 1.0;
        let text = painter.layout(words.to_owned(), theme::font(size), ink, width);
        lines.extend(text.rows.iter().map(|row| (row.text(), size, ink)));
    };
    if let Some(words) = live_text(view, entry.topic) {
        part(view.text("现在", "now"), &words, view.theme.hold);
    }
    for (caption, said) in &entry.paragraphs {
        part(caption.get(view.lang), said.get(view.lang), view.theme.text);
    }
    lines
}

/// Paints a name in one line, or in two small lines if it is too long.
fn paint_name(painter: &Painter, rect: Rect, words: &str, size: f32, ink: Color32) {
    if layout_line(painter, words, theme::SMALL, ink, rect.width()).elided {
        let height = painter.layout(words.to_owned(), theme::font(theme::SMALL), ink, rect.width()).size().y;
        let place = Rect::from_min_max(pos2(rect.min.x, rect.center().y - height / 2.0), rect.max + vec2(0.0, 4.0));
        paragraph(painter, place, words, theme::SMALL, ink);
    } else {
        fit_text(painter, rect, Align2::LEFT_CENTER, words, size, ink);
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
            Some(alarm.text.get(view.lang).to_owned())
        }
        HelpTopic::Param(at) => view.snapshot.params.read(at).ok().map(|value| value.to_string()),
        HelpTopic::Page(_) | HelpTopic::SoftKey(_) | HelpTopic::Code => None,
    }
}
