//! A modal question over a page: text and keys. The page beneath takes no touches until it is answered.
//! Source: spec H8, B6 (delete and overwrite ask first).

use egui::{Rect, pos2, vec2};

use super::{Area, EditKey, KeyboardFocus, PageKey, View, theme};
use crate::defs::text::{LocalizedText, Text};

/// Height of a question, the lines of details that it has room for, and the height of one more.
const HEIGHT: f32 = 230.0;
const USUAL_LINES: usize = 4;
const LINE_HEIGHT: f32 = 26.0;

/// The open question of a page, with its subject; empty if none is open.
#[derive(Debug)]
pub struct QuestionDialog<A>(Option<(A, Question)>);

impl<A> Default for QuestionDialog<A> {
    fn default() -> Self {
        Self(None)
    }
}

impl<A> QuestionDialog<A> {
    /// Opens a question; replaces an open one.
    pub fn ask(&mut self, about: A, question: Question) {
        self.0 = Some((about, question));
    }

    /// Closes the question without an answer.
    pub fn close(&mut self) {
        self.0 = None;
    }

    /// Whether a question is open; it then takes all keyboard input of the page.
    pub const fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Draws the question. When answered, returns its subject and the index of the pressed key; `None` for CANCEL (取消).
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey]) -> Option<(A, Option<usize>)> {
        let key = self.0.as_mut()?.1.ui(rect, view, edits)?;
        let (about, question) = self.0.take()?;
        Some((about, Some(key).filter(|key| key + 1 < question.keys.len())))
    }
}

/// A question.
#[derive(Clone, Debug)]
pub struct Question {
    /// The question.
    title: Text,
    /// Details.
    body: LocalizedText,
    /// The keys: accessible name and label; the last one only closes.
    keys: Vec<(&'static str, Text)>,
    /// Lines of the details that have their own height.
    lines: usize,
    focus: KeyboardFocus,
}

impl Question {
    /// A question with one action key and CANCEL (取消).
    pub fn new(title: Text, body: LocalizedText, yes: (&'static str, Text)) -> Self {
        Self::with_keys(title, body, &[yes])
    }

    /// A question with several action keys and CANCEL (取消).
    pub fn with_keys(title: Text, body: LocalizedText, keys: &[(&'static str, Text)]) -> Self {
        let mut keys = keys.to_vec();
        keys.push(("question-no", Text::new("取消", "CANCEL")));
        let mut walk = KeyboardFocus::default();
        // CANCEL is preselected: Enter alone does nothing, an action key must be selected first.
        walk.select(keys.len() - 1, keys.len());
        Self { title, body, keys, lines: 0, focus: walk }
    }

    /// With room for so many lines of details.
    #[must_use]
    pub fn with_lines(self, lines: usize) -> Self {
        Self { lines, ..self }
    }

    /// Draws the question; returns the index of the pressed key, the last one is CANCEL (取消).
    fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey]) -> Option<usize> {
        let place = view.dialog(
            rect,
            "question-veil",
            vec2(520.0, HEIGHT + LINE_HEIGHT * self.lines.saturating_sub(USUAL_LINES) as f32),
            view.theme.hold,
        );
        let (title, rest) = place.shrink2(vec2(20.0, 14.0)).split_top(32.0);
        view.fit_left(title, self.title.get(view.lang), theme::SECONDARY, view.theme.text);
        let (body, keys) = rest.split_bottom(56.0);
        view.paragraph(body.trim_top(6.0), &self.body.get(view.lang), theme::LABEL, view.theme.text);
        self.focus.begin_frame(edits);
        let last = self.keys.len() - 1;
        let width = ((keys.width() + theme::GAP) / self.keys.len() as f32).min(170.0);
        let left = keys.max.x + theme::GAP - width * self.keys.len() as f32;
        let mut chosen = edits.contains(&EditKey::Cancel).then_some(last);
        for (index, (name, label)) in self.keys.iter().enumerate() {
            let corner = pos2(left + index as f32 * width, keys.min.y + 4.0);
            let place = Rect::from_min_size(corner, vec2(width - theme::GAP, 52.0));
            if self.focus.button(view, place, PageKey::new(name, label.get(view.lang))) {
                chosen = Some(index);
            }
        }
        chosen
    }
}
