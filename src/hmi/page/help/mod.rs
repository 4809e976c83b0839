//! The help for pages, keys, alarms, G and M codes and parameters. Its search also finds programs and variables, and its
//! key OPEN goes to the page where the found thing is. It is a page of its own and an overlay over any other page. All
//! texts are from the tables in `defs`.
//! Source: spec B6, H6, K2.1, K2.4.

mod entries;
mod keyboard_map;

use egui::accesskit::Role;
use egui::{Align2, Color32, Id, Rect, Sense, WidgetInfo, vec2};

pub use entries::{CAUSE, HelpEntry, HelpTopic, REMEDY, Section, alarm_entry, entries};

use super::variables::RANGES;
use super::{HandOver, PageContext, PageUi, Scroll, ScrollList, favourites};
use crate::defs::favourite::Favourite;
use crate::defs::fitted::Fitted;
use crate::defs::page::Page;
use crate::defs::soft_key::SoftKeyAction;
use crate::defs::text::{Lang, LocalizedText};
use crate::hmi::{
    Area, EditKey, KeyboardInput, LetterKey, PageKey, Search, SearchTouch, View, letter_pad, round_to_lines, theme,
    widget,
};
use crate::link::Command;
use crate::link::page_command::PageCommand;

/// Height of a line of an entry's text, points.
const TEXT_LINE: f32 = 23.0;
/// Width of the key that closes the overlay, points.
const CLOSE_WIDTH: f32 = 92.0;
/// Width of the name of a section in a row, points.
const SECTION_WIDTH: f32 = 66.0;
/// Width of the codes among the found entries, points.
const SEARCH_SIGN_WIDTH: f32 = 82.0;
/// Width of the key that keeps an entry on the home page, points.
const KEEP_WIDTH: f32 = 132.0;
/// Maximum number of characters of a search.
const MAX_SEARCH_CHARS: usize = 20;

/// Where an entry leads: a page, and what it shows first.
pub type HelpTarget = (Page, Option<HandOver>);

/// What a touch of the help asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HelpTouch {
    /// The overlay closes.
    Close,
    /// The overlay closes, and a page opens.
    Open(HelpTarget),
    /// The home page keeps these favourites.
    Keep(Vec<Favourite>),
}

/// State of the help.
#[derive(Debug, Default)]
pub struct Help {
    /// The entries of this machine, then those of program and folder, then that of a number that is searched.
    entries: Vec<HelpEntry>,
    /// How many are of the machine; how many do not hang on the search.
    fixed: usize,
    known: usize,
    machine: Option<Fitted>,
    /// The language whose words the search knows beside Chinese and English.
    lang: Lang,
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
    fn open(&mut self, view: &View<'_>, _handed_over: Option<HandOver>) {
        self.open_at(view, Page::Help, None);
    }

    fn accepts_text(&self) -> bool {
        self.search.open || !self.search.text.is_empty()
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        match self.draw(ctx.view, ctx.rect, ctx.typed, 0.0) {
            Some(HelpTouch::Open((page, what))) => {
                *ctx.hand_over = what;
                ctx.out.push(Command::OpenPage(page));
            }
            Some(HelpTouch::Keep(kept)) => ctx.out.push(Command::Page(PageCommand::SetFavourites(kept))),
            Some(HelpTouch::Close) | None => {}
        }
    }
}

impl Help {
    /// Opens at an alarm if given, else at a page.
    pub fn open_at(&mut self, view: &View<'_>, page: Page, alarm: Option<u16>) {
        self.load_entries(view);
        (self.keyboard_map_open, self.search.open) = (false, false);
        self.search.text.clear();
        self.load_changing(view);
        let (section, about) = match alarm {
            Some(number) => (Section::Alarms, HelpTopic::for_alarm(number)),
            None => (Section::Pages, HelpTopic::Page(page)),
        };
        self.show_section(section);
        self.cursor = self.visible.iter().position(|index| self.entries[*index].topic == about).unwrap_or(0);
    }

    /// Opens with the search.
    pub fn open_search(&mut self, view: &View<'_>, page: Page) {
        self.open_at(view, page, None);
        self.search.open = true;
    }

    fn load_entries(&mut self, view: &View<'_>) {
        let (machine, lang) = (view.snapshot.fitted(), view.lang);
        if (self.machine, self.lang) != (Some(machine), lang) {
            (self.machine, self.lang) = (Some(machine), lang);
            self.entries = entries(machine);
            self.add_language(0);
            (self.fixed, self.known) = (self.entries.len(), self.entries.len());
            self.refresh_list();
        }
    }

    /// Loads what may have changed since: programs, values of the page.
    fn load_changing(&mut self, view: &View<'_>) {
        self.entries.truncate(self.fixed);
        self.entries.extend(entries::changing_entries(view.snapshot));
        self.add_language(self.fixed);
        self.known = self.entries.len();
    }

    /// The search finds the words of an added language, too, from an entry on.
    fn add_language(&mut self, from: usize) {
        if let lang @ Lang::Added(_) = self.lang {
            self.entries.iter_mut().skip(from).for_each(|entry| entry.add_language(lang));
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
        self.entries.truncate(self.known);
        self.entries.extend(self.searched_variable());
        let found = |entry: &HelpEntry| match self.search.text.as_str() {
            "" => entry.section == self.section,
            search => entry.matches(search),
        };
        self.visible = (0..self.entries.len()).filter(|index| found(&self.entries[*index])).collect();
        if !self.search.text.is_empty() {
            self.visible.sort_by_key(|index| self.entries[*index].rank(&self.search.text));
        }
    }

    /// The variable whose number is searched, if it has no entry: it has no name on the page.
    fn searched_variable(&self) -> Option<HelpEntry> {
        let number: u16 = self.search.text.trim().strip_prefix('#')?.parse().ok()?;
        let is_variable = RANGES.iter().any(|(first, last)| (*first..=*last).contains(&number));
        let has_entry = self.entries.iter().any(|entry| entry.topic == HelpTopic::Variable(number));
        let has_page = self.machine.is_some_and(|machine| Page::Macro.exists_on(machine));
        (is_variable && has_page && !has_entry).then(|| entries::variable_entry(number, LocalizedText::default()))
    }

    /// Draws the help as an overlay; what was asked for.
    pub fn overlay(&mut self, view: &View<'_>, rect: Rect, typed: &KeyboardInput) -> Option<HelpTouch> {
        let cancelled = !self.search.open && self.search.text.is_empty() && typed.edits.contains(&EditKey::Cancel);
        view.ui.interact(rect, Id::unique("help"), Sense::CLICK | Sense::DRAG);
        view.filled_card(rect, view.theme.background, view.theme.focus);
        let (_, close) = rect.shrink(theme::PAD).band(0.0, widget::KEYS_HEIGHT).split_right(CLOSE_WIDTH);
        let touched = self.draw(view, rect, typed, CLOSE_WIDTH + theme::GAP);
        let closed =
            widget::button(view, close, PageKey::new("close-help", view.text("关闭帮助", "CLOSE"))) || cancelled;
        touched.or(closed.then_some(HelpTouch::Close))
    }

    /// Draws the help; returns what the operator wants.
    fn draw(&mut self, view: &View<'_>, rect: Rect, typed: &KeyboardInput, room: f32) -> Option<HelpTouch> {
        self.load_entries(view);
        let entered = self.handle_typed(typed);
        let (bar, rest) = rect.shrink(theme::PAD).split_top(widget::KEYS_HEIGHT);
        self.tabs(view, bar.trim_right(room));
        let rest = rest.trim_top(theme::GAP);
        if self.keyboard_map_open {
            keyboard_map::ui(view, rest);
            return None;
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
        let entry = self.visible.get(self.cursor).map(|index| &self.entries[*index]);
        let target = entry.and_then(|entry| target_of(view, entry));
        let keeps = entry.and_then(favourite_of).filter(|_| target.is_some());
        let room = theme::GAP * if self.search.open { 2.0 } else { 1.0 };
        let (card, key) = right.split_bottom(if target.is_some() { widget::KEYS_HEIGHT + room } else { 0.0 });
        self.detail(view, card);
        let key = key.trim_top(theme::GAP).trim_bottom(if self.search.open { theme::GAP } else { 0.0 });
        let (open, keep) = key.split_right(if keeps.is_some() { KEEP_WIDTH } else { 0.0 });
        let kept = keeps.and_then(|favourite| keep_key(view, keep.trim_left(theme::GAP), &favourite));
        let opened = target.filter(|target| open_key(view, open, *target) || entered);
        if self.search.open
            && let Some(letter) = letter_pad::ui(view, board, &letter_pad::SEARCH_LAYOUT)
        {
            self.handle_letter(&letter);
        }
        opened.map(HelpTouch::Open).or(kept.map(HelpTouch::Keep))
    }

    fn tabs(&mut self, view: &View<'_>, bar: Rect) {
        let mut keys: Vec<_> =
            Section::ALL.iter().map(|section| (section.id(), section.label().get(view.lang).to_owned())).collect();
        keys.push(("help-map", view.text("键盘", "KEYBD").to_owned()));
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

    /// Handles typed input; true if ENTER chooses the selected entry.
    fn handle_typed(&mut self, typed: &KeyboardInput) -> bool {
        let mut text = typed.text.as_str();
        if !self.search.open && text.starts_with(|sign: char| matches!(sign, '/' | '#') || sign.is_alphanumeric()) {
            (self.search.open, self.keyboard_map_open) = (true, false);
            self.search.text.clear();
            text = text.strip_prefix('/').unwrap_or(text);
        }
        if self.search.open && !text.is_empty() {
            let room = MAX_SEARCH_CHARS.saturating_sub(self.search.text.chars().count());
            self.search.text.extend(text.chars().filter(|sign| !sign.is_control()).take(room));
            self.refresh_list();
        }
        typed.edits.iter().fold(false, |entered, edit| {
            let chooses = *edit == EditKey::Enter && !self.search.open;
            self.handle_key(*edit);
            entered || chooses
        })
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
        let searches = !self.search.text.is_empty();
        let sign_width = match entry.section {
            // A search mixes the sections.
            _ if searches => SEARCH_SIGN_WIDTH,
            Section::Pages => 0.0,
            Section::Keys => 92.0,
            Section::Alarms | Section::Programs => SEARCH_SIGN_WIDTH,
            Section::Variables | Section::SoftKeys | Section::GCodes | Section::MCodes | Section::Params => 64.0,
        };
        let (sign, words) = inside.split_left(sign_width);
        let ink = if is_present(view, entry.topic) { view.theme.alarm_text } else { view.theme.info };
        view.fit_left(sign.trim_right(theme::GAP.min(sign_width)), &entry.code, theme::LABEL, ink);
        // A search covers all sections: what the entry is stands beside it.
        let (words, of) = words.split_right(if searches { SECTION_WIDTH } else { 0.0 });
        if searches {
            view.fit_right(of, entry.section.label().get(view.lang), theme::SMALL, view.theme.muted);
        }
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

/// The page of an entry, and what it shows first; none for what has no page.
fn target_of(view: &View<'_>, entry: &HelpEntry) -> Option<HelpTarget> {
    match favourite_of(entry) {
        Some(favourite) => favourites::target(view, &favourite).filter(|(page, _)| *page != Page::Help),
        None => is_present(view, entry.topic).then_some((Page::Alarm, None)),
    }
}

/// An entry as the home page can keep it.
fn favourite_of(entry: &HelpEntry) -> Option<Favourite> {
    Some(match entry.topic {
        HelpTopic::Page(page) | HelpTopic::SoftKey(SoftKeyAction::Open(page)) => Favourite::Page(page),
        HelpTopic::Param(address) => Favourite::Param(address),
        HelpTopic::Variable(number) => Favourite::Variable(number),
        HelpTopic::Program(_) => Favourite::Program(entry.code.clone()),
        HelpTopic::SoftKey(_) | HelpTopic::Key(_) | HelpTopic::Alarm(_) | HelpTopic::GCode | HelpTopic::MCode => {
            return None;
        }
    })
}

/// The key that keeps an entry on the home page, or lets it go; the favourites after its touch.
fn keep_key(view: &View<'_>, rect: Rect, favourite: &Favourite) -> Option<Vec<Favourite>> {
    let after = favourites::toggled(view.favourites, favourite);
    let is_kept = view.favourites.contains(favourite);
    let label = match (is_kept, after.is_some()) {
        (true, _) => view.text("★ 已收藏", "★ KEPT"),
        (false, true) => view.text("☆ 收藏", "☆ KEEP"),
        (false, false) => view.text("收藏已满", "HOME IS FULL"),
    };
    let key = PageKey::new("help-keep", label).on(is_kept).locked(after.is_none());
    widget::button(view, rect, key).then_some(after).flatten()
}

/// The key that goes to the page of an entry.
fn open_key(view: &View<'_>, rect: Rect, (page, _): HelpTarget) -> bool {
    let label = format!("{} {}", view.text("打开", "OPEN"), page.title_on(view.snapshot.kind).get(view.lang));
    widget::button(view, rect, PageKey::new("help-open", &label))
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
        HelpTopic::Page(_)
        | HelpTopic::SoftKey(_)
        | HelpTopic::Variable(_)
        | HelpTopic::Program(_)
        | HelpTopic::GCode
        | HelpTopic::MCode => None,
    }
}
