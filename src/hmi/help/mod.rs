//! The help for pages, keys, alarms, G and M codes and parameters, searched by number or word. It is a page of its own
//! and an overlay over any other page. All texts are from the tables in `defs`.
//! Source: spec B6, H6, K2.1, K2.4.

mod entries;
mod map;

use egui::accesskit::Role;
use egui::{Align2, Color32, Id, Painter, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

pub use entries::{About, HelpEntry, Section, entries};

use super::entry::Edit;
use super::letters::{self, Letter};
use super::page::Typed;
use super::page::scroll::Scroll;
use super::search::{self, SearchTouch};
use super::theme;
use super::view::{View, card, fit, frame, line, paragraph};
use super::widget::{self, Look, whole_lines};
use crate::defs::kind::Kind;
use crate::defs::page::Page;

/// Height of a line of the list, points.
const ROW: f32 = 46.0;
/// Height of a line of an entry's text, points.
const TEXT: f32 = 23.0;
/// Width of the key that closes the overlay, points.
const CLOSE: f32 = 92.0;
/// Maximum number of characters of a search.
const LONGEST: usize = 20;

/// State of the help.
#[derive(Debug, Default)]
pub struct Help {
    /// The entries of this kind of machine.
    all: Vec<HelpEntry>,
    kind: Option<Kind>,
    section: Section,
    /// The keyboard map is shown instead of a section.
    map: bool,
    search: String,
    /// Typed text goes into the search.
    searching: bool,
    /// Indices of the listed entries.
    listed: Vec<usize>,
    cursor: usize,
    scroll: Scroll,
    /// Scroll position of the selected entry's text, and the index of that entry.
    reading: (Scroll, Option<usize>),
}

impl Help {
    /// Opens at an alarm if given, else at a page.
    pub fn open(&mut self, view: &View<'_>, page: Page, alarm: Option<u16>) {
        self.fill(view);
        (self.map, self.searching) = (false, false);
        self.search.clear();
        let (section, about) = match alarm {
            Some(number) => (Section::Alarms, About::alarm(number)),
            None => (Section::Pages, About::Page(page)),
        };
        self.turn(section);
        self.cursor = self.listed.iter().position(|index| self.all[*index].about == about).unwrap_or(0);
    }

    /// The entry of an alarm.
    #[must_use]
    pub fn alarm(&self, number: u16) -> Option<&HelpEntry> {
        self.all.iter().find(|entry| entry.about == About::alarm(number))
    }

    /// Whether the search is active.
    #[must_use]
    pub const fn searches(&self) -> bool {
        self.searching || !self.search.is_empty()
    }

    fn fill(&mut self, view: &View<'_>) {
        let kind = view.snapshot.kind;
        if self.kind != Some(kind) {
            self.kind = Some(kind);
            self.all = entries(kind);
            self.list();
        }
    }

    fn turn(&mut self, section: Section) {
        (self.section, self.map) = (section, false);
        self.search.clear();
        self.list();
    }

    /// Rebuilds the list: the entries of the section, or the search results of all sections.
    fn list(&mut self) {
        (self.cursor, self.scroll) = (0, Scroll::default());
        let found = |entry: &HelpEntry| match self.search.as_str() {
            "" => entry.section == self.section,
            search => entry.has(search),
        };
        self.listed = (0..self.all.len()).filter(|index| found(&self.all[*index])).collect();
        if !self.search.is_empty() {
            self.listed.sort_by_key(|index| self.all[*index].rank(&self.search));
        }
    }

    /// Draws the help as an overlay; true if it closes.
    pub fn sheet(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, typed: &Typed<'_>) -> bool {
        let cancelled = !self.searching && self.search.is_empty() && typed.edits.contains(&Edit::Cancel);
        ui.interact(rect, Id::unique("help"), Sense::CLICK | Sense::DRAG);
        card(ui.painter(), rect, view.theme.ground, view.theme.focus);
        let bar = Rect::from_min_size(rect.shrink(theme::PAD).min, vec2(rect.width() - 2.0 * theme::PAD, widget::TABS));
        let (_, close) = bar.split_left_right_at_x(bar.max.x - CLOSE);
        self.draw(ui, view, rect, typed, CLOSE + theme::GAP);
        widget::push(ui, view, close, "close-help", view.say("关闭帮助", "CLOSE"), Look::default()) || cancelled
    }

    /// Draws the help as the page 帮助.
    pub fn page(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, typed: &Typed<'_>) {
        self.draw(ui, view, rect, typed, 0.0);
    }

    fn draw(&mut self, ui: &Ui, view: &View<'_>, rect: Rect, typed: &Typed<'_>, room: f32) {
        self.fill(view);
        self.take_typed(typed);
        let inside = rect.shrink(theme::PAD);
        let (bar, rest) = inside.split_top_bottom_at_y(inside.min.y + widget::TABS);
        self.tabs(ui, view, Rect::from_min_max(bar.min, bar.max - vec2(room, 0.0)));
        let rest = Rect::from_min_max(rest.min + vec2(0.0, theme::GAP), rest.max);
        if self.map {
            return map::ui(ui, view, rest);
        }
        let board = if self.searching { letters::SEARCH.height() } else { 0.0 };
        let (body, board) = rest.split_top_bottom_at_y(rest.max.y - board);
        let (left, right) = body.split_left_right_at_fraction(0.42);
        let left = Rect::from_min_max(left.min, left.max - vec2(theme::GAP, 0.0));
        let (field, list) = left.split_top_bottom_at_y(left.min.y + theme::TARGET);
        let hint = view.say("查找 号码/文字", "find number/word");
        match search::field(ui, view, field, hint, &self.search, self.searching) {
            Some(SearchTouch::Field) => self.searching = !self.searching,
            Some(SearchTouch::Clear) => {
                self.search.clear();
                self.list();
            }
            None => {}
        }
        let list = Rect::from_min_max(list.min + vec2(0.0, theme::GAP), list.max);
        self.rows(ui, view, whole_lines(list, ROW), typed.pages);
        self.detail(ui, view, right);
        if self.searching
            && let Some(letter) = letters::ui(ui, view, board, &letters::SEARCH)
        {
            self.letter(&letter);
        }
    }

    fn tabs(&mut self, ui: &Ui, view: &View<'_>, bar: Rect) {
        let mut keys: Vec<_> =
            Section::ALL.iter().map(|section| (section.id(), section.name().get(view.lang).to_owned())).collect();
        keys.push(("help-map", view.say("键盘", "KEYBOARD").to_owned()));
        let here = Section::ALL.iter().position(|section| *section == self.section).unwrap_or(0);
        let chosen = match (self.map, self.search.is_empty()) {
            (true, _) => Section::ALL.len(),
            (false, true) => here,
            // A search covers all sections.
            (false, false) => usize::MAX,
        };
        match widget::tabs(ui, view, bar, &keys, chosen) {
            Some(index) if index < Section::ALL.len() => self.turn(Section::ALL[index]),
            Some(_) => (self.map, self.searching) = (true, false),
            None => {}
        }
    }

    fn take_typed(&mut self, typed: &Typed<'_>) {
        let mut text = typed.text;
        if !self.searching && text.starts_with(|sign: char| sign == '/' || sign.is_alphanumeric()) {
            (self.searching, self.map) = (true, false);
            self.search.clear();
            text = text.strip_prefix('/').unwrap_or(text);
        }
        if self.searching && !text.is_empty() {
            let room = LONGEST.saturating_sub(self.search.chars().count());
            self.search.extend(text.chars().filter(|sign| !sign.is_control()).take(room));
            self.list();
        }
        for edit in typed.edits {
            self.edit(*edit);
        }
    }

    fn edit(&mut self, edit: Edit) {
        let last = self.listed.len().saturating_sub(1);
        match edit {
            Edit::Up => self.choose(self.cursor.saturating_sub(1)),
            Edit::Down => self.choose((self.cursor + 1).min(last)),
            Edit::Back | Edit::Delete if self.searching => self.letter(&Letter::Back),
            Edit::Enter if self.searching => self.searching = false,
            Edit::Cancel if self.searching || !self.search.is_empty() => {
                self.searching = false;
                self.search.clear();
                self.list();
            }
            Edit::Left | Edit::Previous => self.beside(Section::ALL.len()),
            Edit::Right | Edit::Next => self.beside(1),
            Edit::LineStart => self.choose(0),
            Edit::LineEnd => self.choose(last),
            Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::Enter | Edit::Cancel => {}
        }
    }

    /// Moves by so many tabs; the keyboard map is the last tab.
    fn beside(&mut self, by: usize) {
        let count = Section::ALL.len() + 1;
        let here = Section::ALL.iter().position(|section| *section == self.section && !self.map);
        match Section::ALL.get((here.unwrap_or(count - 1) + by) % count) {
            Some(section) => self.turn(*section),
            None => (self.map, self.searching) = (true, false),
        }
    }

    fn choose(&mut self, row: usize) {
        self.cursor = row;
        self.scroll.by_hand = false;
    }

    fn letter(&mut self, letter: &Letter) {
        match letter {
            Letter::Sign(sign) if self.search.chars().count() < LONGEST => self.search.push(*sign),
            Letter::Sign(_) => {}
            Letter::Word(word) => (*word).clone_into(&mut self.search),
            Letter::Back => drop(self.search.pop()),
            Letter::Done => return self.searching = false,
        }
        self.list();
    }

    fn rows(&mut self, ui: &Ui, view: &View<'_>, list: Rect, pages: i32) {
        let count = self.listed.len();
        if count == 0 {
            let words = view.say("没有找到，换一个词或号码", "nothing found: another word or number");
            let place = Rect::from_min_size(list.min + vec2(0.0, theme::PAD), vec2(list.width(), 60.0));
            paragraph(ui.painter(), place, words, theme::LABEL, view.theme.quiet);
            return;
        }
        if pages != 0 {
            self.scroll.page(pages, list, ROW);
        }
        if !self.scroll.by_hand {
            self.scroll.show(self.cursor, list, ROW);
        }
        let (first, last) = self.scroll.follow(ui, "help-list", list, ROW, count);
        for row in first..last {
            let top = list.min.y + ((row as f64 - self.scroll.top) * f64::from(ROW)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width() - 8.0, ROW - 4.0));
            self.row(ui, view, (list, place), row);
        }
        self.scroll.bar(ui, view, list, ROW, count);
    }

    fn row(&mut self, ui: &Ui, view: &View<'_>, (list, place): (Rect, Rect), row: usize) {
        let entry = &self.all[self.listed[row]];
        let painter = &ui.painter().with_clip_rect(list);
        let response = ui.interact(place.intersect(list), Id::unique(("help-entry", row)), Sense::CLICK);
        let name = format!("{} {}", entry.name.get(view.lang), entry.id);
        let chosen = row == self.cursor;
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
        let fill = if chosen { view.theme.raised } else { view.theme.surface };
        card(painter, place, fill, view.theme.line);
        if chosen {
            frame(painter, place, view.theme.focus);
        }
        let inside = place.shrink2(vec2(10.0, 2.0));
        let sign_width = match entry.section {
            Section::Pages => 0.0,
            Section::Keys => 92.0,
            Section::Alarms => 82.0,
            Section::SoftKeys | Section::GCodes | Section::MCodes | Section::Params => 64.0,
        };
        let (sign, words) = inside.split_left_right_at_x(inside.min.x + sign_width);
        let ink = if is_present(view, entry.about) { view.theme.alarm_text } else { view.theme.info };
        let sign = Rect::from_min_max(sign.min, sign.max - vec2(theme::GAP, 0.0).min(sign.size()));
        fit(painter, sign, Align2::LEFT_CENTER, &entry.sign, theme::LABEL, ink);
        name_of(painter, words, entry.name.get(view.lang), theme::LABEL, view.theme.text);
        if response.clicked() {
            self.cursor = row;
            self.scroll.by_hand = true;
        }
    }

    /// Draws the selected entry in full; a long text scrolls by drag.
    fn detail(&mut self, ui: &Ui, view: &View<'_>, rect: Rect) {
        let painter = ui.painter();
        card(painter, rect, view.theme.surface, view.theme.line);
        let Some(index) = self.listed.get(self.cursor).copied() else { return };
        let entry = &self.all[index];
        let response = ui.interact(rect, Id::unique("help-detail"), Sense::HOVER);
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, entry.text(view.lang)));
        let inside = rect.shrink(theme::PAD);
        let head = Rect::from_min_size(inside.min, vec2(inside.width(), 40.0));
        let title = format!("{} {}", entry.sign, entry.name.get(view.lang));
        name_of(painter, head, title.trim(), theme::SECONDARY, view.theme.text);
        let room = Rect::from_min_max(pos2(inside.min.x, head.max.y + theme::GAP), inside.max);
        let lines = lines_of(painter, view, entry, room.width() - 8.0);
        let list = whole_lines(room, TEXT);
        let (scroll, of) = &mut self.reading;
        if *of != Some(index) {
            (*scroll, *of) = (Scroll::default(), Some(index));
        }
        let (first, last) = scroll.follow(ui, "help-text", list, TEXT, lines.len());
        // Some glyphs start left of their position.
        let painter = &painter.with_clip_rect(list.expand2(vec2(2.0, 0.0)));
        for (at, (words, size, ink)) in lines.iter().enumerate().take(last).skip(first) {
            let top = list.min.y + ((at as f64 - scroll.top) * f64::from(TEXT)) as f32;
            let place = Rect::from_min_size(pos2(list.min.x, top), vec2(list.width(), TEXT));
            // A caption is aligned to the text below it.
            let align = if *size < theme::LABEL { Align2::LEFT_BOTTOM } else { Align2::LEFT_CENTER };
            fit(painter, place, align, words, *size, *ink);
        }
        scroll.bar(ui, view, list, TEXT, lines.len());
    }
}

/// The lines of an entry: a caption, then its text wrapped to a width.
fn lines_of(painter: &Painter, view: &View<'_>, entry: &HelpEntry, width: f32) -> Vec<(String, f32, Color32)> {
    let mut lines = Vec::new();
    let mut part = |caption: &str, words: &str, ink: Color32| {
        lines.push((caption.to_owned(), theme::SMALL, view.theme.quiet));
        let size = theme::TITLE - 1.0;
        let text = painter.layout(words.to_owned(), theme::font(size), ink, width);
        lines.extend(text.rows.iter().map(|row| (row.text(), size, ink)));
    };
    if let Some(words) = now(view, entry.about) {
        part(view.say("现在", "now"), &words, view.theme.hold);
    }
    for (caption, said) in &entry.parts {
        part(caption.get(view.lang), said.get(view.lang), view.theme.text);
    }
    lines
}

/// Paints a name in one line, or in two small lines if it is too long.
fn name_of(painter: &Painter, rect: Rect, words: &str, size: f32, ink: Color32) {
    if line(painter, words, theme::SMALL, ink, rect.width()).elided {
        let height = painter.layout(words.to_owned(), theme::font(theme::SMALL), ink, rect.width()).size().y;
        let place = Rect::from_min_max(pos2(rect.min.x, rect.center().y - height / 2.0), rect.max + vec2(0.0, 4.0));
        paragraph(painter, place, words, theme::SMALL, ink);
    } else {
        fit(painter, rect, Align2::LEFT_CENTER, words, size, ink);
    }
}

fn is_present(view: &View<'_>, about: About) -> bool {
    matches!(about, About::Alarm(number) if view.snapshot.alarms.iter().any(|alarm| alarm.number == number))
}

/// Live text of the machine: why a key is refused, the text of an active alarm, the value of a parameter.
fn now(view: &View<'_>, about: About) -> Option<String> {
    match about {
        About::Key(key) => view.snapshot.key(key).blocked.map(|reason| reason.get(view.lang).to_owned()),
        About::Alarm(number) => {
            let alarm = view.snapshot.alarms.iter().find(|alarm| alarm.number == number)?;
            Some(alarm.text.get(view.lang).to_owned())
        }
        About::Param(at) => view.snapshot.params.read(at).ok().map(|value| value.to_string()),
        About::Page(_) | About::Soft(_) | About::Code => None,
    }
}
