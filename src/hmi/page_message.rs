//! The last message of a page: what was done, or why something was not done.
//! Source: spec H6, H8.

use egui::Color32;

use super::View;
use crate::defs::text::{Lang, LocalizedText};

/// The message with its tone; empty until there is one.
#[derive(Debug, Default)]
pub struct PageMessage(Option<(LocalizedText, bool)>);

impl PageMessage {
    /// Tells what was done.
    pub fn tell(&mut self, text: impl Into<LocalizedText>) {
        self.0 = Some((text.into(), false));
    }

    /// Tells why something was not done.
    pub fn refuse(&mut self, why: impl Into<LocalizedText>) {
        self.0 = Some((why.into(), true));
    }

    /// Removes the message.
    pub fn clear(&mut self) {
        self.0 = None;
    }

    /// The text.
    pub fn text(&self, lang: Lang) -> Option<String> {
        self.0.as_ref().map(|(text, _)| text.get(lang).into_owned())
    }

    /// The reason, if the message is a refusal.
    pub fn refusal(&self, lang: Lang) -> Option<String> {
        self.0.as_ref().filter(|(_, refused)| *refused).map(|(text, _)| text.get(lang).into_owned())
    }

    /// The message and its colour: red for a refusal, else `ink`.
    pub fn shown(&self, view: &View<'_>, ink: Color32) -> Option<(String, Color32)> {
        let (text, refused) = self.0.as_ref()?;
        Some((text.get(view.lang).into_owned(), if *refused { view.theme.alarm_text } else { ink }))
    }
}
