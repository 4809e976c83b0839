//! Accepting retained data after damage or loss (alarms 300 and 305): a key on the alarm page, a question with the consequence, the
//! builder's password. Source: safety stance; spec B6.

use egui::Rect;

use crate::defs::alarm;
use crate::defs::param::AccessLevel;
use crate::defs::text::{LocalizedText, Text};
use crate::hmi::{EditKey, GuardedQuestion, Login, PageKey, Question, View, widget};
use crate::link::Command;
use crate::link::page_command::PageCommand;

/// State of the key, its question and its password.
#[derive(Debug, Default)]
pub struct AcceptData {
    question: GuardedQuestion,
}

impl AcceptData {
    /// Whether there is something to accept.
    pub fn is_due(view: &View<'_>) -> bool {
        let asks = [alarm::RETAINED_DATA_DAMAGED, alarm::VALUES_DROPPED];
        view.snapshot.alarms.iter().any(|alarm| asks.contains(&alarm.number))
    }

    /// Whether the question is open and takes the input.
    pub const fn is_open(&self) -> bool {
        self.question.is_open()
    }

    /// Draws the key; a touch opens the question.
    pub fn key(&mut self, rect: Rect, view: &View<'_>) {
        if widget::button(view, rect, PageKey::new("accept-data", view.text("接受数据", "ACCEPT DATA"))) {
            let body = LocalizedText::new(
                "参数、刀补、修整点、坐标系可能是旧值或出厂值：已逐项核对，或从备份恢复了。",
                "Parameters, offsets, dressing points and work offsets may be old or factory values: they have been \
                 checked one by one, or restored from a backup.",
            );
            let yes = ("accept-yes", Text::new("接受", "ACCEPT"));
            self.question.ask(Question::new(Text::new("接受现在的数据？", "accept the data as they are?"), body, yes));
        }
    }

    /// Draws the question; sends the acceptance once the builder's level is unlocked.
    pub fn ui(&mut self, rect: Rect, view: &View<'_>, edits: &[EditKey], login: &mut Login, out: &mut Vec<Command>) {
        let is_accepted = self.question.ui(rect, view, edits, (AccessLevel::Builder, login));
        out.extend(is_accepted.then_some(Command::Page(PageCommand::AcceptData)));
    }
}
