//! The search field of pages with a search: text, and a cross that clears it.
//! Source: spec B6 (search), H6.

use egui::Rect;
use egui::accesskit::Role;

use super::{Area, LetterKey, PageKey, View, keycap, theme, widget};

/// Between the field and its cross.
const SPACE: f32 = 4.0;

/// What was touched in the search field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchTouch {
    /// The field.
    Field,
    /// The cross that clears it.
    Clear,
}

/// A search as it is typed.
#[derive(Debug, Default)]
pub struct Search {
    /// The typed text.
    pub text: String,
    /// It takes the typed text now.
    pub open: bool,
}

impl Search {
    /// Handles a key of the letter pad; the text has `most` characters at most.
    pub fn handle_letter(&mut self, letter: &LetterKey, most: usize) {
        match letter {
            LetterKey::Char(sign) if self.text.chars().count() < most => self.text.push(*sign),
            LetterKey::Char(_) => {}
            LetterKey::Word(word) => (*word).clone_into(&mut self.text),
            LetterKey::Backspace => drop(self.text.pop()),
            LetterKey::Done => self.open = false,
        }
    }

    /// Draws the field, with a hint while it is empty, and handles its touches; returns what was touched.
    pub fn field(&mut self, view: &View<'_>, rect: Rect, hint: &str) -> Option<SearchTouch> {
        let (field, cross) = rect.split_right(theme::TOUCH_TARGET + SPACE);
        let field = if self.text.is_empty() { rect } else { field };
        if !self.text.is_empty() && widget::button(view, cross.trim_left(SPACE), PageKey::new("search-clear", "×")) {
            self.text.clear();
            return Some(SearchTouch::Clear);
        }
        let touched = draw(view, field, self, hint);
        self.open ^= touched;
        touched.then_some(SearchTouch::Field)
    }
}

fn draw(view: &View<'_>, rect: Rect, search: &Search, hint: &str) -> bool {
    let response = view.touch_as(Role::SearchInput, rect, "search", format!("{} search", view.text("查找", "find")));
    keycap::plate(view, rect, &response);
    if search.open {
        view.frame(rect, view.theme.focus);
    }
    let inside = rect.trim_sides(theme::PAD);
    match (search.text.as_str(), search.open) {
        ("", false) => view.fit_left(inside, hint, theme::LABEL, view.theme.muted),
        (text, false) => view.fit_left(inside, text, theme::TITLE, view.theme.info),
        (text, true) => view.fit_left(inside, &format!("{text}_"), theme::TITLE, view.theme.info),
    };
    response.clicked()
}
