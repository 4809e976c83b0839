//! Parameters: bits in rows of eight, numbers and ports, with search. Values are typed here and checked by the core.
//! Source: spec B6, H6, K6.1.

mod list;
mod paint;
mod screw;

use egui::{Rect, Ui, pos2, vec2};

use super::Typed;
use super::scroll::Scroll;
use crate::defs::param::Level;
use crate::defs::param_row::{ParamRow, Sort};
use crate::defs::text::Said;
use crate::hmi::entry::Edit;
use crate::hmi::letters::{self, Letter};
use crate::hmi::login::Login;
use crate::hmi::search::{self, SearchTouch};
use crate::hmi::theme;
use crate::hmi::typing::{Heard, Typing};
use crate::hmi::view::View;
use crate::hmi::widget;
use crate::link::Command;
use crate::link::page_command::{Guard, PageCommand};
use list::{List, Part};

/// Maximum length of a search, characters.
const LONGEST: usize = 14;
/// Filters of the tabs.
const PARTS: [Part; 4] = [Part::All, Part::Bits, Part::Numbers, Part::Ports];

/// State of the page.
#[derive(Debug, Default)]
pub struct Params {
    part: Part,
    search: String,
    /// Typed characters go to the search.
    searching: bool,
    list: List,
    scroll: Scroll,
    /// Index of the selected row.
    cursor: usize,
    /// The value being typed.
    pub typing: Typing,
    /// Row and value that wait for the password of the level.
    waiting: Option<(usize, f64)>,
    /// The leadscrew tables are shown instead.
    screws: bool,
    /// The leadscrew tab.
    pub screw: screw::Screw,
}

impl Params {
    /// The page was opened: nothing is being typed.
    pub fn open(&mut self) {
        let (part, cursor, screws) = (self.part, self.cursor, self.screws);
        *self = Self { part, cursor, screws, ..Self::default() };
    }

    /// The value being typed.
    #[must_use]
    pub const fn typing(&self) -> &Typing {
        if self.screws { &self.screw.typing } else { &self.typing }
    }

    /// Whether a search is being typed.
    #[must_use]
    pub const fn searches(&self) -> bool {
        self.searching
    }

    /// Whether the numeric pad is shown.
    #[must_use]
    pub const fn wants_pad(&self) -> bool {
        if self.screws { self.screw.typing.pad } else { self.typing.pad && !self.searching }
    }

    /// Draws the page; returns its commands.
    pub fn ui(&mut self, ui: &Ui, rect: Rect, view: &View<'_>, typed: &Typed<'_>, login: &mut Login) -> Vec<Command> {
        let mut out = Vec::new();
        // Ctrl+P selects the next tab.
        if typed.controls.contains(&egui::Key::P) && !login.is_open() {
            let tab =
                if self.screws { PARTS.len() } else { PARTS.iter().position(|part| *part == self.part).unwrap_or(0) };
            self.turn_to((tab + 1) % (PARTS.len() + 1));
        }
        if self.screws {
            let places = paint::Places::new(rect, false, 0);
            self.top(ui, &places, view, login, &mut out);
            let below = Rect::from_min_max(pos2(rect.min.x, places.tabs.max.y + theme::GAP), rect.max);
            out.extend(self.screw.ui(ui, below, view, typed, login));
            return out;
        }
        if self.list.update(view.snapshot.kind, self.part, &self.search) {
            self.scroll = Scroll::default();
            let shown = self.list.found.get(self.cursor).copied().unwrap_or(false);
            if !shown {
                self.choose(self.list.first().unwrap_or(0));
            }
            self.reveal(self.cursor);
        }
        if let Heard::Refused(row) = self.typing.hear(&view.snapshot.edit) {
            self.cursor = row;
            self.reveal(row);
        }
        self.send_waiting(view, login, &mut out);
        if !login.is_open() {
            self.take(typed, view, login, &mut out);
        }
        let number = self.list.rows.get(self.cursor).filter(|row| row.sort == Sort::Bit).map(|row| row.at.number);
        let bits = self.list.rows.iter().filter(|row| Some(row.at.number) == number).count();
        let places = paint::Places::new(rect, self.searching, bits);
        self.top(ui, &places, view, login, &mut out);
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
            && let Some(letter) = letters::ui(ui, view, places.letters, &letters::SEARCH)
        {
            self.letter(&letter);
        }
        out
    }

    /// Sends the waiting value once its level is unlocked; drops it if the password is not given.
    fn send_waiting(&mut self, view: &View<'_>, login: &Login, out: &mut Vec<Command>) {
        let Some((row, value)) = self.waiting else { return };
        let Some(row) = self.list.rows.get(row) else { return };
        if row.level <= view.snapshot.access.level {
            out.push(Command::Page(PageCommand::EditParam(row.at, value)));
            self.typing.send(self.waiting.take().map_or(0, |(row, _)| row));
        } else if !login.is_open() {
            self.waiting = None;
        }
    }

    /// Tabs, search field and access level.
    fn top(&mut self, ui: &Ui, places: &paint::Places, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let keys = [
            ("params-all", view.say("全部", "ALL").to_owned()),
            ("params-bits", view.say("位", "BITS").to_owned()),
            ("params-numbers", view.say("数值", "VALUES").to_owned()),
            ("params-ports", view.say("端口", "PORTS").to_owned()),
            ("params-screws", view.say("丝杠", "SCREWS").to_owned()),
        ];
        let chosen = PARTS.iter().position(|part| *part == self.part).unwrap_or(0);
        let chosen = if self.screws { PARTS.len() } else { chosen };
        if let Some(index) = widget::tabs(ui, view, places.tabs, &keys, chosen) {
            self.turn_to(index);
        }
        if self.screws {
            return self.level(ui, places, view, login, out);
        }
        let hint = view.say("查找 号码/文字", "find number/text");
        match search::field(ui, view, places.search, hint, &self.search, self.searching) {
            Some(SearchTouch::Field) => {
                self.searching = !self.searching;
                self.typing.text.clear();
            }
            Some(SearchTouch::Clear) => self.search.clear(),
            None => {}
        }
        self.level(ui, places, view, login, out);
    }

    /// Selects a tab; the last one is that of the leadscrews.
    fn turn_to(&mut self, tab: usize) {
        self.screws = tab == PARTS.len();
        self.part = PARTS.get(tab).copied().unwrap_or(self.part);
        (self.typing.pad, self.screw.typing.pad) = (false, false);
    }

    /// The key that shows, unlocks or locks the access level.
    fn level(&self, ui: &Ui, places: &paint::Places, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let level = view.snapshot.access.level;
        if paint::level_key(ui, view, places.level, level) {
            if level > Level::Operator {
                out.push(Command::Page(PageCommand::Lock));
            } else {
                let guard = self.list.rows.get(self.cursor).and_then(|row| Guard::of(row.level));
                let guard = guard.filter(|_| !self.screws).or(self.screws.then_some(Guard::Builder));
                login.unlock(view, guard.unwrap_or(Guard::User));
            }
        }
    }

    /// The visible lines.
    fn lines(&mut self, ui: &Ui, places: &paint::Places, view: &View<'_>, typed: &Typed<'_>) {
        if self.list.lines.is_empty() {
            paint::nothing(ui.painter(), view, places.list);
            return;
        }
        let list = widget::whole_lines(places.list, paint::LINE);
        if typed.pages != 0 {
            self.scroll.page(typed.pages, list, paint::LINE);
        }
        let (first, last) = self.scroll.follow(ui, "params", list, paint::LINE, self.list.lines.len());
        let mut touched = None;
        for index in first..last {
            let top = list.min.y + ((index as f64 - self.scroll.top) * f64::from(paint::LINE)) as f32;
            let size = vec2(list.width() - 8.0, paint::LINE - 4.0);
            let place = Rect::from_min_size(egui::pos2(list.min.x, top), size);
            let drawn = paint::Drawn {
                list: &self.list,
                cursor: self.cursor,
                text: &self.typing.text,
                refused: self.typing.refused.is_some(),
            };
            touched = paint::line(ui, view, (list, place), index, &drawn).or(touched);
        }
        self.scroll.bar(ui, view, list, paint::LINE, self.list.lines.len());
        if let Some(row) = touched {
            self.choose(row);
            self.typing.pad = true;
            self.searching = false;
        }
    }

    fn choose(&mut self, row: usize) {
        if row != self.cursor {
            self.typing.clear();
        }
        self.cursor = row;
    }

    /// Handles typed input: for the search while it is open, else for the value. A letter opens the search.
    fn take(&mut self, typed: &Typed<'_>, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let begins = |sign: char| sign == '/' || sign.is_alphabetic();
        if !self.searching && typed.text.starts_with(begins) {
            self.searching = true;
            self.search.clear();
        }
        if self.searching {
            for sign in typed.text.chars().filter(|sign| *sign != '/' && !sign.is_control()) {
                self.letter(&Letter::Sign(sign));
            }
        }
        for edit in typed.edits {
            match edit {
                Edit::Char(_) | Edit::Sign if self.searching => {}
                Edit::Back | Edit::Delete if self.searching => self.letter(&Letter::Back),
                Edit::Enter if self.searching => self.searching = false,
                Edit::Cancel if self.searching => {
                    self.searching = false;
                    self.search.clear();
                }
                Edit::Up => self.go(self.list.below(self.cursor, -1)),
                Edit::Down => self.go(self.list.below(self.cursor, 1)),
                Edit::Left | Edit::Previous => self.go(self.list.beside(self.cursor, false)),
                Edit::Right | Edit::Next => self.go(self.list.beside(self.cursor, true)),
                Edit::LineStart | Edit::LineEnd => {}
                Edit::Char(_) | Edit::Sign | Edit::Back | Edit::Delete | Edit::Enter | Edit::Cancel => {
                    self.value(*edit, view, login, out);
                }
            }
        }
    }

    fn go(&mut self, row: Option<usize>) {
        let Some(row) = row else { return };
        self.choose(row);
        self.reveal(row);
    }

    /// Scrolls to a row.
    fn reveal(&mut self, row: usize) {
        if let Some(line) = self.list.line_of(row) {
            // An approximate list height: a line more or less does not matter to `show`.
            let seen = Rect::from_min_size(egui::Pos2::ZERO, vec2(1.0, 7.0 * paint::LINE));
            self.scroll.show(line, seen, paint::LINE);
        }
    }

    fn letter(&mut self, letter: &Letter) {
        match letter {
            Letter::Sign(sign) if self.search.chars().count() < LONGEST => self.search.push(*sign),
            Letter::Sign(_) => {}
            Letter::Word(word) => (*word).clone_into(&mut self.search),
            Letter::Back => {
                self.search.pop();
            }
            Letter::Done => self.searching = false,
        }
    }

    fn value(&mut self, edit: Edit, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        self.typing.next_key(edit);
        if edit == Edit::Cancel && self.typing.text.is_empty() && !self.typing.pad {
            return self.search.clear();
        }
        if !self.typing.key(edit) && edit == Edit::Enter {
            self.enter(view, login, out);
        }
    }

    /// Checks and sends the value; asks for the password if its level is locked.
    fn enter(&mut self, view: &View<'_>, login: &mut Login, out: &mut Vec<Command>) {
        let Some(row) = self.list.rows.get(self.cursor) else { return };
        if self.typing.text.is_empty() {
            return;
        }
        match check(row, &self.typing.text) {
            Err(reason) => self.typing.refused = Some(reason),
            Ok(value) => match Guard::of(row.level).filter(|_| row.level > view.snapshot.access.level) {
                Some(guard) => {
                    self.waiting = Some((self.cursor, value));
                    login.unlock(view, guard);
                }
                None => {
                    out.push(Command::Page(PageCommand::EditParam(row.at, value)));
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
pub fn check(row: &ParamRow, text: &str) -> Result<f64, Said> {
    let Ok(value) = text.parse::<f64>() else {
        return Err(Said::new("不是数字", "not a number"));
    };
    let whole = !matches!(row.sort, Sort::Number);
    if whole && value.fract().abs() > 0.0 {
        return Err(Said::new("只能输入整数", "whole numbers only"));
    }
    if !(row.min..=row.max).contains(&value) {
        return Err(match row.sort {
            Sort::Bit => Said::new("只能输入 0 或 1", "only 0 or 1"),
            Sort::Number | Sort::Input(_) | Sort::Output(_) => Said::new(
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
const SPACE: f32 = theme::GAP;
