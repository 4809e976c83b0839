//! A question whose answer may need a password. Source: spec H8, B6.

use egui::Rect;

use super::{EditKey, Login, Question, QuestionDialog, View};
use crate::defs::param::AccessLevel;
use crate::link::page_command::PasswordScope;

/// The question, and whether its answer waits for a password.
#[derive(Debug, Default)]
pub struct GuardedQuestion {
    dialog: QuestionDialog<()>,
    needs_password: bool,
}

impl GuardedQuestion {
    /// Opens a question.
    pub fn ask(&mut self, question: Question) {
        self.dialog.ask((), question);
    }

    /// Whether the question is open and takes the input.
    pub const fn is_open(&self) -> bool {
        self.dialog.is_open()
    }

    /// Draws the question. True once it is confirmed and `level` is unlocked; else `login` asks for its password.
    pub fn ui(
        &mut self,
        rect: Rect,
        view: &View<'_>,
        edits: &[EditKey],
        (level, login): (AccessLevel, &mut Login),
    ) -> bool {
        let is_unlocked = view.snapshot.access.level >= level;
        if let Some(((), Some(_))) = self.dialog.ui(rect, view, edits) {
            self.needs_password = true;
            if let Some(scope) = PasswordScope::for_level(level).filter(|_| !is_unlocked) {
                login.unlock(view, scope);
            }
        }
        let is_answered = self.needs_password && !login.is_open();
        self.needs_password &= !is_answered;
        is_answered && is_unlocked
    }
}
