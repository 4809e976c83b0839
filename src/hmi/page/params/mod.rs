//! Parameters: bits in rows of eight, numbers and ports, with search. Values are typed here and checked by the core.
//! Source: spec B6, H6, K6.1.

mod leadscrew;
mod list;
mod paint;

use egui::{Rect, vec2};

use super::{HandOver, PageContext, PageUi, Scroll, ScrollList};
use crate::defs::param::AccessLevel;
use crate::defs::param_row::{ParamRow, ParamType};
use crate::defs::text::{Lang, LocalizedText, phrase};
use crate::hmi::{
    CoreAnswer, EditKey, FieldEditor, KeyboardInput, LetterKey, Login, Search, SearchTouch, View, letter_pad,
    parse_number, theme, widget,
};
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};
use list::{FILTERS, ParamList};

/// Maximum length of a search, characters.
const MAX_SEARCH_CHARS: usize = 14;

/// State of the page.
#[derive(Debug, Default)]
pub struct ParamPage {
    /// Index of the tab in `FILTERS`.
    filter: usize,
    search: Search,
    list: ParamList,
    scroll: Scroll,
    /// Index of the selected row.
    cursor: usize,
    typing: FieldEditor,
    /// Row and value that wait for the password of the level.
    pending_value: Option<(usize, f64)>,
    /// The leadscrew tables are shown instead.
    shows_leadscrews: bool,
    /// The leadscrew tab.
    leadscrew: leadscrew::LeadscrewTab,
}

impl PageUi for ParamPage {
    /// Tab and row stay, unless a parameter was handed over; nothing is being typed.
    fn open(&mut self, view: &View<'_>, handed_over: Option<HandOver>) {
        let (part, cursor, screws) = (self.filter, self.cursor, self.shows_leadscrews);
        *self = Self { filter: part, cursor, shows_leadscrews: screws, ..Self::default() };
        if let Some(address) = handed_over.and_then(HandOver::param) {
            // All parameters are shown: the row is there whatever the tab was.
            (self.filter, self.shows_leadscrews) = (0, false);
            self.list.update(view.snapshot.fitted(), self.filter, "");
            let row = self.list.rows.iter().position(|row| row.address == address);
            self.go(row);
        }
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(if self.shows_leadscrews { &self.leadscrew.typing } else { &self.typing })
    }

    fn message(&self, lang: Lang) -> Option<String> {
        self.leadscrew.message.text(lang).filter(|_| self.shows_leadscrews)
    }

    fn accepts_text(&self) -> bool {
        self.search.open
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        if self.shows_leadscrews { self.leadscrew.typing.pad_open } else { self.typing.pad_open && !self.search.open }
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { rect, view, typed, login, out, .. } = ctx;
        // Ctrl+P selects the next tab.
        if typed.ctrl_keys.contains(&egui::Key::P) && !login.is_open() {
            self.select_tab((self.tab() + 1) % (FILTERS.len() + 1));
        }
        if self.shows_leadscrews {
            let places = paint::ParamLayout::new(rect, false, 0);
            self.header(&places, view, login, out);
            out.extend(self.leadscrew.ui(rect.with_min_y(places.tabs.max.y + theme::GAP), view, typed, login));
            return;
        }
        if self.list.update(view.snapshot.fitted(), self.filter, &self.search.text) {
            self.scroll = Scroll::default();
            if !self.list.matches.get(self.cursor).copied().unwrap_or(false) {
                self.select(self.list.first().unwrap_or(0));
            }
            self.reveal(self.cursor);
        }
        if let CoreAnswer::Refused(row) = self.typing.poll_answer(&view.snapshot.edit_answer) {
            self.cursor = row;
            self.reveal(row);
        }
        self.send_pending(view, login, out);
        if !login.is_open() {
            self.handle_typed(typed, view, login, out);
        }
        let rows = &self.list.rows;
        let bit = rows.get(self.cursor).filter(|row| row.param_type == ParamType::Bit);
        let bits = bit.map_or(0, |bit| rows.iter().filter(|row| row.address.number == bit.address.number).count());
        let places = paint::ParamLayout::new(rect, self.search.open, bits);
        self.header(&places, view, login, out);
        self.lines(&places, view, typed);
        paint::detail(view, &places, &self.list, self.cursor);
        paint::input_line(view, places.input, self.list.rows.get(self.cursor), &self.typing);
        if self.search.open
            && let Some(letter) = letter_pad::ui(view, places.letters, &letter_pad::SEARCH_LAYOUT)
        {
            self.search.handle_letter(&letter, MAX_SEARCH_CHARS);
        }
    }
}

impl ParamPage {
    /// Sends the waiting value once its level is unlocked; drops it if the password is not given.
    fn send_pending(&mut self, view: &View<'_>, login: &Login, out: &mut Vec<Command>) {
        let Some((row, value)) = self.pending_value else { return };
        let Some(row) = self.list.rows.get(row) else { return };
        if row.level <= view.snapshot.access.level {
            out.push(Command::Page(PageCommand::EditParam(row.address, value)));
            self.typing.send(self.pending_value.take().map_or(0, |(row, _)| row));
        } else if !login.is_open() {
            self.pending_value = None;
        }
    }

    /// Tabs, search field and access level.
    fn header(&mut self, places: &paint::ParamLayout, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let mut keys: Vec<_> = FILTERS.iter().map(|(id, label, _)| (*id, label.get(view.lang).to_owned())).collect();
        keys.push(("params-screws", view.text("丝杠", "SCREWS").to_owned()));
        if let Some(index) = widget::tabs(view, places.tabs, &keys, self.tab()) {
            self.select_tab(index);
        }
        if self.shows_leadscrews {
            return self.level_key(places, view, login, out);
        }
        let hint = view.text("查找 号码/文字", "find number/text");
        if self.search.field(view, places.search, hint) == Some(SearchTouch::Field) {
            self.typing.text.clear();
        }
        self.level_key(places, view, login, out);
    }

    /// The selected tab.
    const fn tab(&self) -> usize {
        if self.shows_leadscrews { FILTERS.len() } else { self.filter }
    }

    /// Selects a tab; the last one is that of the leadscrews.
    fn select_tab(&mut self, tab: usize) {
        self.shows_leadscrews = tab == FILTERS.len();
        self.filter = if self.shows_leadscrews { self.filter } else { tab };
        (self.typing.pad_open, self.leadscrew.typing.pad_open) = (false, false);
    }

    /// The key that shows, unlocks or locks the access level.
    fn level_key(&self, places: &paint::ParamLayout, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let level = view.snapshot.access.level;
        if paint::level_key(view, places.level, level) {
            if level > AccessLevel::Operator {
                out.push(Command::Page(PageCommand::Lock));
            } else {
                let of_row = self.list.rows.get(self.cursor).and_then(|row| PasswordScope::for_level(row.level));
                let guard = if self.shows_leadscrews { Some(PasswordScope::Builder) } else { of_row };
                login.unlock(view, guard.unwrap_or(PasswordScope::User));
            }
        }
    }

    /// The visible lines.
    fn lines(&mut self, places: &paint::ParamLayout, view: &View<'_>, typed: &KeyboardInput) {
        if self.list.lines.is_empty() {
            return paint::no_match(view, places.list);
        }
        let (rect, count) = (widget::round_to_lines(places.list, paint::LINE_HEIGHT), self.list.lines.len());
        let list = ScrollList { id: "params", rect, row: paint::LINE_HEIGHT, gap: 4.0, count };
        let drawn = paint::ParamListView { list: &self.list, cursor: self.cursor, typing: &self.typing };
        let (clipped, rows) = self.scroll.rows(view, &list, typed.scroll_pages);
        let mut touched = None;
        for (index, place) in rows {
            touched = paint::line(&clipped, place, index, &drawn).or(touched);
        }
        if let Some(row) = touched {
            self.select(row);
            self.typing.pad_open = true;
            self.search.open = false;
        }
    }

    fn select(&mut self, row: usize) {
        if row != self.cursor {
            self.typing.clear();
        }
        self.cursor = row;
    }

    /// Handles typed input: for the search while it is open, else for the value. A letter opens the search.
    fn handle_typed(&mut self, typed: &KeyboardInput, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let begins = |sign: char| sign == '/' || sign.is_alphabetic();
        if !self.search.open && typed.text.starts_with(begins) {
            self.search.open = true;
            self.search.text.clear();
        }
        if self.search.open {
            for sign in typed.text.chars().filter(|sign| *sign != '/' && !sign.is_control()) {
                self.search.handle_letter(&LetterKey::Char(sign), MAX_SEARCH_CHARS);
            }
        }
        for edit in &typed.edits {
            match edit {
                EditKey::Char(_) | EditKey::Sign if self.search.open => {}
                EditKey::Backspace | EditKey::Delete if self.search.open => drop(self.search.text.pop()),
                EditKey::Enter if self.search.open => self.search.open = false,
                EditKey::Cancel if self.search.open => {
                    self.search.open = false;
                    self.search.text.clear();
                }
                EditKey::Up => self.go(self.list.row_lines_down(self.cursor, -1)),
                EditKey::Down => self.go(self.list.row_lines_down(self.cursor, 1)),
                EditKey::Left | EditKey::Previous => self.go(self.list.adjacent_row(self.cursor, false)),
                EditKey::Right | EditKey::Next => self.go(self.list.adjacent_row(self.cursor, true)),
                EditKey::LineStart | EditKey::LineEnd => {}
                _ => self.edit_value(*edit, view, login, out),
            }
        }
    }

    fn go(&mut self, row: Option<usize>) {
        let Some(row) = row else { return };
        self.select(row);
        self.reveal(row);
    }

    /// Scrolls to a row.
    fn reveal(&mut self, row: usize) {
        if let Some(line) = self.list.line_of(row) {
            // An approximate list height: a line more or less does not matter to `show`.
            let seen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1.0, 7.0 * paint::LINE_HEIGHT));
            self.scroll.scroll_to(line, seen, paint::LINE_HEIGHT);
        }
    }

    fn edit_value(&mut self, edit: EditKey, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        self.typing.clear_refused(edit);
        if edit == EditKey::Cancel && self.typing.text.is_empty() && !self.typing.pad_open {
            return self.search.text.clear();
        }
        if !self.typing.handle_key(edit) && edit == EditKey::Enter {
            self.enter(view, login, out);
        }
    }

    /// Checks and sends the value; asks for the password if its level is locked.
    fn enter(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let Some(row) = self.list.rows.get(self.cursor) else { return };
        if self.typing.text.is_empty() {
            return;
        }
        match parse_value(row, &self.typing.text) {
            Err(reason) => self.typing.refused = Some(reason),
            Ok(value) => match PasswordScope::for_level(row.level).filter(|_| row.level > view.snapshot.access.level) {
                Some(guard) => {
                    self.pending_value = Some((self.cursor, value));
                    login.unlock(view, guard);
                }
                None => {
                    out.push(Command::Page(PageCommand::EditParam(row.address, value)));
                    self.typing.send(self.cursor);
                }
            },
        }
    }
}

/// Parses a text as a value of a parameter.
///
/// # Errors
/// The reason, in both languages.
pub fn parse_value(row: &ParamRow, text: &str) -> Result<f64, LocalizedText> {
    let value = parse_number(text)?;
    let whole = !matches!(row.param_type, ParamType::Number);
    if whole && value.fract().abs() > 0.0 {
        return Err(phrase!("只能输入整数", "whole numbers only"));
    }
    if !(row.min..=row.max).contains(&value) {
        return Err(match row.param_type {
            ParamType::Bit => phrase!("只能输入 0 或 1", "only 0 or 1"),
            ParamType::Number | ParamType::Input(_) | ParamType::Output(_) => {
                let (least, most) = (row.min, row.max);
                phrase!("超出范围 {least} … {most}", "out of range {least} … {most}", least, most)
            }
        });
    }
    Ok(value)
}

/// Column captions of a line of bits.
const BIT_NAMES: [&str; 8] = ["BIT7", "BIT6", "BIT5", "BIT4", "BIT3", "BIT2", "BIT1", "BIT0"];

/// Gap between the items of a row.
const ROW_GAP: f32 = theme::GAP;
