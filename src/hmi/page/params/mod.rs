//! Parameters: bits in rows of eight, numbers and ports, with search. Values are typed here and checked by the core.
//! Source: spec B6, H6, K6.1.

mod leadscrew;
mod list;
mod paint;

use egui::{Rect, Ui, pos2, vec2};

use super::scroll::Scroll;
use super::{PageContext, PageUi, TypedInput};
use crate::defs::param::AccessLevel;
use crate::defs::param_row::{ParamRow, ParamType};
use crate::defs::text::LocalizedText;
use crate::hmi::edit_key::EditKey;
use crate::hmi::field_editor::{CoreAnswer, FieldEditor};
use crate::hmi::letter_pad::{self, LetterKey};
use crate::hmi::login::Login;
use crate::hmi::search_field::{self, SearchField, SearchTouch};
use crate::hmi::theme;
use crate::hmi::view::View;
use crate::hmi::widget;
use crate::link::Command;
use crate::link::page_command::{PageCommand, PasswordScope};
use list::{ParamFilter, ParamList};

/// Maximum length of a search, characters.
const MAX_SEARCH_CHARS: usize = 14;
/// Filters of the tabs.
const FILTERS: [ParamFilter; 4] = [ParamFilter::All, ParamFilter::Bits, ParamFilter::Numbers, ParamFilter::Ports];

/// State of the page.
#[derive(Debug, Default)]
pub struct ParamPage {
    filter: ParamFilter,
    search: String,
    /// Typed characters go to the search.
    searching: bool,
    list: ParamList,
    scroll: Scroll,
    /// Index of the selected row.
    cursor: usize,
    /// The value being typed.
    typing: FieldEditor,
    /// Row and value that wait for the password of the level.
    pending_value: Option<(usize, f64)>,
    /// The leadscrew tables are shown instead.
    shows_leadscrews: bool,
    /// The leadscrew tab.
    leadscrew: leadscrew::LeadscrewTab,
}

impl PageUi for ParamPage {
    /// Tab and row stay; nothing is being typed.
    fn open(&mut self, _view: &View<'_>, _handed_over: Option<u32>) {
        let (part, cursor, screws) = (self.filter, self.cursor, self.shows_leadscrews);
        *self = Self { filter: part, cursor, shows_leadscrews: screws, ..Self::default() };
    }

    fn typing(&self) -> Option<&FieldEditor> {
        Some(if self.shows_leadscrews { &self.leadscrew.typing } else { &self.typing })
    }

    fn accepts_text(&self) -> bool {
        self.searching
    }

    fn wants_pad(&self, _view: &View<'_>) -> bool {
        if self.shows_leadscrews { self.leadscrew.typing.pad_open } else { self.typing.pad_open && !self.searching }
    }

    fn ui(&mut self, ctx: PageContext<'_>) {
        let PageContext { ui, rect, view, typed, login, out, .. } = ctx;
        // Ctrl+P selects the next tab.
        if typed.ctrl_keys.contains(&egui::Key::P) && !login.is_open() {
            let tab = if self.shows_leadscrews {
                FILTERS.len()
            } else {
                FILTERS.iter().position(|part| *part == self.filter).unwrap_or(0)
            };
            self.select_tab((tab + 1) % (FILTERS.len() + 1));
        }
        if self.shows_leadscrews {
            let places = paint::ParamLayout::new(rect, false, 0);
            self.header(ui, &places, view, login, out);
            let below = Rect::from_min_max(pos2(rect.min.x, places.tabs.max.y + theme::GAP), rect.max);
            out.extend(self.leadscrew.ui(ui, below, view, typed, login));
            return;
        }
        if self.list.update(view.snapshot.kind, self.filter, &self.search) {
            self.scroll = Scroll::default();
            let shown = self.list.matches.get(self.cursor).copied().unwrap_or(false);
            if !shown {
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
        let number = self
            .list
            .rows
            .get(self.cursor)
            .filter(|row| row.param_type == ParamType::Bit)
            .map(|row| row.address.number);
        let bits = self.list.rows.iter().filter(|row| Some(row.address.number) == number).count();
        let places = paint::ParamLayout::new(rect, self.searching, bits);
        self.header(ui, &places, view, login, out);
        self.lines(ui, &places, view, typed);
        paint::detail(ui.painter(), view, &places, &self.list, self.cursor);
        paint::input_line(
            ui.painter(),
            view,
            places.input,
            self.list.rows.get(self.cursor),
            &self.typing.text,
            self.typing.refused.as_ref(),
        );
        if self.searching
            && let Some(letter) = letter_pad::ui(ui, view, places.letters, &letter_pad::SEARCH_LAYOUT)
        {
            self.letter(&letter);
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
    fn header(
        &mut self,
        ui: &Ui,
        places: &paint::ParamLayout,
        view: &View<'_>,
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let keys = [
            ("params-all", view.text("全部", "ALL").to_owned()),
            ("params-bits", view.text("位", "BITS").to_owned()),
            ("params-numbers", view.text("数值", "VALUES").to_owned()),
            ("params-ports", view.text("端口", "PORTS").to_owned()),
            ("params-screws", view.text("丝杠", "SCREWS").to_owned()),
        ];
        let chosen = FILTERS.iter().position(|part| *part == self.filter).unwrap_or(0);
        let chosen = if self.shows_leadscrews { FILTERS.len() } else { chosen };
        if let Some(index) = widget::tabs(ui, view, places.tabs, &keys, chosen) {
            self.select_tab(index);
        }
        if self.shows_leadscrews {
            return self.level_key(ui, places, view, login, out);
        }
        let hint = view.text("查找 号码/文字", "find number/text");
        let shown = SearchField { hint, text: &self.search, open: self.searching };
        match search_field::field(ui, view, places.search, shown) {
            Some(SearchTouch::Field) => {
                self.searching = !self.searching;
                self.typing.text.clear();
            }
            Some(SearchTouch::Clear) => self.search.clear(),
            None => {}
        }
        self.level_key(ui, places, view, login, out);
    }

    /// Selects a tab; the last one is that of the leadscrews.
    fn select_tab(&mut self, tab: usize) {
        self.shows_leadscrews = tab == FILTERS.len();
        self.filter = FILTERS.get(tab).copied().unwrap_or(self.filter);
        (self.typing.pad_open, self.leadscrew.typing.pad_open) = (false, false);
    }

    /// The key that shows, unlocks or locks the access level.
    fn level_key(
        &self,
        ui: &Ui,
        places: &paint::ParamLayout,
        view: &View<'_>,
        login: &mut Login,
        out: &mut Vec<Command>,
    ) {
        let level = view.snapshot.access.level;
        if paint::level_key(ui, view, places.level, level) {
            if level > AccessLevel::Operator {
                out.push(Command::Page(PageCommand::Lock));
            } else {
                let guard = self.list.rows.get(self.cursor).and_then(|row| PasswordScope::for_level(row.level));
                let guard = guard
                    .filter(|_| !self.shows_leadscrews)
                    .or(self.shows_leadscrews.then_some(PasswordScope::Builder));
                login.unlock(view, guard.unwrap_or(PasswordScope::User));
            }
        }
    }

    /// The visible lines.
    fn lines(&mut self, ui: &Ui, places: &paint::ParamLayout, view: &View<'_>, typed: &TypedInput<'_>) {
        if self.list.lines.is_empty() {
            paint::no_match(ui.painter(), view, places.list);
            return;
        }
        let list = widget::round_to_lines(places.list, paint::LINE_HEIGHT);
        if typed.scroll_pages != 0 {
            self.scroll.scroll_pages(typed.scroll_pages, list, paint::LINE_HEIGHT);
        }
        let (first, last) = self.scroll.handle_input(ui, "params", list, paint::LINE_HEIGHT, self.list.lines.len());
        let mut touched = None;
        for index in first..last {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(paint::LINE_HEIGHT)) as f32;
            let size = vec2(list.width() - 8.0, paint::LINE_HEIGHT - 4.0);
            let place = Rect::from_min_size(egui::pos2(list.min.x, top), size);
            let drawn = paint::ParamListView {
                list: &self.list,
                cursor: self.cursor,
                text: &self.typing.text,
                refused: self.typing.refused.is_some(),
            };
            touched = paint::line(ui, view, (list, place), index, &drawn).or(touched);
        }
        self.scroll.draw_bar(ui, view, list, paint::LINE_HEIGHT, self.list.lines.len());
        if let Some(row) = touched {
            self.select(row);
            self.typing.pad_open = true;
            self.searching = false;
        }
    }

    fn select(&mut self, row: usize) {
        if row != self.cursor {
            self.typing.clear();
        }
        self.cursor = row;
    }

    /// Handles typed input: for the search while it is open, else for the value. A letter opens the search.
    fn handle_typed(&mut self, typed: &TypedInput<'_>, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let begins = |sign: char| sign == '/' || sign.is_alphabetic();
        if !self.searching && typed.text.starts_with(begins) {
            self.searching = true;
            self.search.clear();
        }
        if self.searching {
            for sign in typed.text.chars().filter(|sign| *sign != '/' && !sign.is_control()) {
                self.letter(&LetterKey::Char(sign));
            }
        }
        for edit in typed.edits {
            match edit {
                EditKey::Char(_) | EditKey::Sign if self.searching => {}
                EditKey::Backspace | EditKey::Delete if self.searching => self.letter(&LetterKey::Backspace),
                EditKey::Enter if self.searching => self.searching = false,
                EditKey::Cancel if self.searching => {
                    self.searching = false;
                    self.search.clear();
                }
                EditKey::Up => self.go(self.list.row_lines_down(self.cursor, -1)),
                EditKey::Down => self.go(self.list.row_lines_down(self.cursor, 1)),
                EditKey::Left | EditKey::Previous => self.go(self.list.adjacent_row(self.cursor, false)),
                EditKey::Right | EditKey::Next => self.go(self.list.adjacent_row(self.cursor, true)),
                EditKey::LineStart | EditKey::LineEnd => {}
                EditKey::Char(_)
                | EditKey::Sign
                | EditKey::Backspace
                | EditKey::Delete
                | EditKey::Enter
                | EditKey::Cancel => {
                    self.edit_value(*edit, view, login, out);
                }
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

    fn letter(&mut self, letter: &LetterKey) {
        match letter {
            LetterKey::Char(sign) if self.search.chars().count() < MAX_SEARCH_CHARS => self.search.push(*sign),
            LetterKey::Char(_) => {}
            LetterKey::Word(word) => (*word).clone_into(&mut self.search),
            LetterKey::Backspace => {
                self.search.pop();
            }
            LetterKey::Done => self.searching = false,
        }
    }

    fn edit_value(&mut self, edit: EditKey, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        self.typing.clear_refused(edit);
        if edit == EditKey::Cancel && self.typing.text.is_empty() && !self.typing.pad_open {
            return self.search.clear();
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
    let Ok(value) = text.parse::<f64>() else {
        return Err(LocalizedText::new("不是数字", "not a number"));
    };
    let whole = !matches!(row.param_type, ParamType::Number);
    if whole && value.fract().abs() > 0.0 {
        return Err(LocalizedText::new("只能输入整数", "whole numbers only"));
    }
    if !(row.min..=row.max).contains(&value) {
        return Err(match row.param_type {
            ParamType::Bit => LocalizedText::new("只能输入 0 或 1", "only 0 or 1"),
            ParamType::Number | ParamType::Input(_) | ParamType::Output(_) => LocalizedText::new(
                format!("超出范围 {} … {}", row.min, row.max),
                format!("out of range {} … {}", row.min, row.max),
            ),
        });
    }
    Ok(value)
}

/// Column captions of a line of bits.
const BIT_NAMES: [&str; 8] = ["BIT7", "BIT6", "BIT5", "BIT4", "BIT3", "BIT2", "BIT1", "BIT0"];

/// Gap between the items of a row.
const ROW_GAP: f32 = theme::GAP;
