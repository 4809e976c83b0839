//! A value being typed: its text, and its refusal by the page or by the core.
//! A value refused by the core returns to its field in red with the reason, like a value refused by the page (H6).

use std::borrow::Cow;

use egui::{Color32, Rect};

use super::{EditKey, View};
use crate::defs::param::NumberParam;
use crate::defs::text::{Lang, LocalizedText, phrase};
use crate::link::Snapshot;
use crate::link::edit::{EditAnswer, LOCKED_IN_RUN};

/// Maximum number of characters of a value.
const MAX_CHARS: usize = 11;

/// The answer of the core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CoreAnswer {
    /// No new answer for this field.
    Nothing,
    /// The text of this field was accepted.
    Accepted(usize, String),
    /// The text sent from this field was refused.
    Refused(usize),
}

/// A field as it is painted: its plate; place, text size, words and colour of its value.
pub(crate) struct ValueField {
    pub plate: Rect,
    pub value: Rect,
    pub size: f32,
    pub words: String,
    pub ink: Color32,
}

/// The text of the selected field.
#[derive(Clone, Debug, Default)]
pub struct FieldEditor {
    /// The text typed so far.
    pub text: String,
    /// Whether the numeric pad is open.
    pub pad_open: bool,
    /// Why the text was refused; cleared by the next key.
    pub refused: Option<LocalizedText>,
    /// Field and text sent to the core, not answered yet.
    sent: Option<(usize, String)>,
    /// Number of answers seen so far.
    answers_seen: u32,
    /// Whether the run that is open locks values (K7.7).
    locked: bool,
}

impl FieldEditor {
    /// Clears the text; for another field.
    pub fn clear(&mut self) {
        self.text.clear();
        self.refused = None;
    }

    /// The next key clears a refused text, unless the key edits it.
    pub fn clear_refused(&mut self, edit: EditKey) {
        if self.refused.take().is_some() && !matches!(edit, EditKey::Backspace | EditKey::Delete | EditKey::Sign) {
            self.text.clear();
        }
    }

    /// Handles digits, sign, backspace and cancel; false for any other key. Every key clears a refusal.
    pub fn handle_key(&mut self, edit: EditKey) -> bool {
        self.clear_refused(edit);
        match edit {
            EditKey::Char(sign) => {
                let point_again = sign == '.' && self.text.contains('.');
                if self.text.len() < MAX_CHARS && !point_again {
                    self.text.push(sign);
                }
            }
            EditKey::Sign => match self.text.strip_prefix('-') {
                Some(rest) => self.text = rest.to_owned(),
                None => self.text.insert(0, '-'),
            },
            EditKey::Backspace | EditKey::Delete => {
                self.text.pop();
            }
            EditKey::Cancel if self.text.is_empty() => self.pad_open = false,
            EditKey::Cancel => self.text.clear(),
            EditKey::Enter | EditKey::Up | EditKey::Down | EditKey::Left | EditKey::Right => return false,
            EditKey::LineStart | EditKey::LineEnd | EditKey::Next | EditKey::Previous => return false,
        }
        true
    }

    /// Parses the text as a number within ± `most`.
    ///
    /// # Errors
    /// The reason, in both languages.
    pub fn number(&self, most: f64) -> Result<f64, LocalizedText> {
        parse_within(&self.text, most)
    }

    /// Marks the text of a field as sent to the core.
    pub fn send(&mut self, field: usize) {
        self.sent = Some((field, std::mem::take(&mut self.text)));
    }

    /// Marks a text that was typed before as sent to the core.
    pub fn send_text(&mut self, field: usize, text: String) {
        self.sent = Some((field, text));
    }

    /// Parses the text as a value of a parameter.
    ///
    /// # Errors
    /// The range, in both languages.
    pub fn param_value(&self, row: NumberParam) -> Result<f64, LocalizedText> {
        let range = param_range(row);
        let refusal = || phrase!("应为 {range}", "it should be {range}", range);
        self.number(row.max).ok().filter(|value| *value >= row.min).ok_or_else(refusal)
    }

    /// A field is touched: the pad opens, unless the run that is open locks values.
    pub const fn open_pad(&mut self) {
        self.pad_open = !self.locked;
    }

    /// Follows the lock of a run, for pages whose values P6.3 locks: the pad closes; a text that the lock
    /// refused goes with it.
    pub fn follow_lock(&mut self, snapshot: &Snapshot) {
        let was_locked = std::mem::replace(&mut self.locked, snapshot.values_locked());
        match (was_locked, self.locked) {
            (false, true) => self.pad_open = false,
            (true, false) if self.refused.as_ref().is_some_and(|why| *why == LOCKED_IN_RUN.into()) => self.clear(),
            _ => {}
        }
    }

    /// Polls the core's answer. A refused text is restored unless another one is being typed.
    pub fn poll_answer(&mut self, answer: &EditAnswer) -> CoreAnswer {
        if std::mem::replace(&mut self.answers_seen, answer.count) == answer.count {
            return CoreAnswer::Nothing;
        }
        match (self.sent.take(), &answer.refused) {
            (None, _) => CoreAnswer::Nothing,
            (Some((field, text)), None) => CoreAnswer::Accepted(field, text),
            (Some((field, text)), Some(why)) if self.text.is_empty() => {
                (self.text, self.refused) = (text, Some(why.clone()));
                CoreAnswer::Refused(field)
            }
            (Some(_), Some(_)) => CoreAnswer::Nothing,
        }
    }

    /// What the selected field shows and its colour: the text typed or refused, else its old value.
    #[must_use]
    pub fn shown(&self, view: &View<'_>, old: (String, Color32)) -> (String, Color32) {
        match (self.text.is_empty(), &self.refused) {
            (true, _) => old,
            (false, Some(_)) => (self.text.clone(), view.theme.alarm_text),
            (false, None) => (format!("{}_", self.text), view.theme.info),
        }
    }

    /// Paints a field. The selected one, with its editor in `typing`, has a frame and shows the typed text instead.
    pub(crate) fn paint(typing: Option<&Self>, view: &View<'_>, field: ValueField) {
        let old = (field.words, field.ink);
        let (words, ink) = if let Some(typing) = typing { typing.shown(view, old) } else { old };
        view.fit_right(field.value, &words, field.size, ink);
        typing.inspect(|typing| typing.frame(view, field.plate));
    }

    /// Paints the frame of the selected field, red after a refusal.
    pub fn frame(&self, view: &View<'_>, rect: Rect) {
        view.frame(rect, if self.refused.is_some() { view.theme.alarm } else { view.theme.focus });
    }

    /// The reason of a refusal in a language.
    #[must_use]
    pub fn refusal(&self, lang: Lang) -> Option<Cow<'_, str>> {
        self.refused.as_ref().map(|message| message.get(lang))
    }
}

/// Parses a text as a number.
///
/// # Errors
/// It is not a number; in both languages.
pub fn parse_number(text: &str) -> Result<f64, LocalizedText> {
    text.parse().map_err(|_| phrase!("不是数字", "not a number"))
}

/// Parses a text as a number within ± `most`.
///
/// # Errors
/// The reason, in both languages.
pub fn parse_within(text: &str, most: f64) -> Result<f64, LocalizedText> {
    let value = parse_number(text)?;
    if !value.is_finite() || value.abs() > most {
        return Err(phrase!("超出范围 ±{most:.3}", "out of range ±{most:.3}", most));
    }
    Ok(value)
}

/// Range and unit of a parameter, as shown.
#[must_use]
pub fn param_range(row: NumberParam) -> String {
    format!("{} … {} {}", row.min, row.max, row.unit)
}
