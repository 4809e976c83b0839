//! A value being typed: its text, and its refusal by the page or by the core.
//! A value refused by the core returns to its field in red with the reason, like a value refused by the page (H6).

use super::entry::Edit;
use crate::defs::text::{Lang, Said};
use crate::link::edit::EditAnswer;

/// Maximum number of characters of a value.
const LONGEST: usize = 11;

/// The answer of the core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heard {
    /// No new answer for this field.
    Nothing,
    /// The text of this field was accepted.
    Taken(usize, String),
    /// The text sent from this field was refused.
    Refused(usize),
}

/// The text of the selected field.
#[derive(Clone, Debug, Default)]
pub struct Typing {
    /// The text typed so far.
    pub text: String,
    /// Whether the numeric pad is open.
    pub pad: bool,
    /// Why the text was refused; cleared by the next key.
    pub refused: Option<Said>,
    /// Field and text sent to the core, not answered yet.
    sent: Option<(usize, String)>,
    /// Number of answers seen so far.
    seen: u32,
}

impl Typing {
    /// Clears the text; for another field.
    pub fn clear(&mut self) {
        self.text.clear();
        self.refused = None;
    }

    /// The next key clears a refused text, unless the key edits it.
    pub fn next_key(&mut self, edit: Edit) {
        if self.refused.take().is_some() && !matches!(edit, Edit::Back | Edit::Delete | Edit::Sign) {
            self.text.clear();
        }
    }

    /// Handles digits, sign, backspace and cancel; false for any other key.
    pub fn key(&mut self, edit: Edit) -> bool {
        match edit {
            Edit::Char(sign) => {
                let point_again = sign == '.' && self.text.contains('.');
                if self.text.len() < LONGEST && !point_again {
                    self.text.push(sign);
                }
            }
            Edit::Sign => match self.text.strip_prefix('-') {
                Some(rest) => self.text = rest.to_owned(),
                None => self.text.insert(0, '-'),
            },
            Edit::Back | Edit::Delete => {
                self.text.pop();
            }
            Edit::Cancel if self.text.is_empty() => self.pad = false,
            Edit::Cancel => self.text.clear(),
            Edit::Enter | Edit::Up | Edit::Down | Edit::Left | Edit::Right => return false,
            Edit::LineStart | Edit::LineEnd | Edit::Next | Edit::Previous => {
                return false;
            }
        }
        true
    }

    /// Parses the text as a number within ± `most`.
    ///
    /// # Errors
    /// The reason, in both languages.
    pub fn number(&self, most: f64) -> Result<f64, Said> {
        let Ok(value) = self.text.parse::<f64>() else {
            return Err(Said::new("不是数字", "not a number"));
        };
        if !value.is_finite() || value.abs() > most {
            return Err(Said::new(format!("超出范围 ±{most:.3}"), format!("out of range ±{most:.3}")));
        }
        Ok(value)
    }

    /// Marks the text of a field as sent to the core.
    pub fn send(&mut self, field: usize) {
        self.sent = Some((field, std::mem::take(&mut self.text)));
    }

    /// Polls the core's answer. A refused text is restored unless another one is being typed.
    pub fn hear(&mut self, answer: &EditAnswer) -> Heard {
        if std::mem::replace(&mut self.seen, answer.count) == answer.count {
            return Heard::Nothing;
        }
        match (self.sent.take(), &answer.refused) {
            (None, _) => Heard::Nothing,
            (Some((field, text)), None) => Heard::Taken(field, text),
            (Some((field, text)), Some(why)) if self.text.is_empty() => {
                (self.text, self.refused) = (text, Some(why.clone()));
                Heard::Refused(field)
            }
            (Some(_), Some(_)) => Heard::Nothing,
        }
    }

    /// The reason of a refusal in a language.
    #[must_use]
    pub fn reason(&self, lang: Lang) -> Option<&str> {
        self.refused.as_ref().map(|said| said.get(lang))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn h6_what_the_core_refuses_comes_back_with_its_reason() {
        let mut typing = Typing { text: "1.5".into(), ..Typing::default() };
        typing.send(7);
        assert!(typing.text.is_empty());
        let no = EditAnswer { count: 1, refused: Some(Said::new("不行", "no")) };
        assert_eq!(typing.hear(&no), Heard::Refused(7));
        assert_eq!((typing.text.as_str(), typing.reason(Lang::En)), ("1.5", Some("no")));
        assert_eq!(typing.hear(&no), Heard::Nothing, "an answer counts once");
    }

    #[test]
    fn h6_a_refusal_does_not_disturb_what_is_being_typed() {
        let mut typing = Typing { text: "1".into(), ..Typing::default() };
        typing.send(0);
        typing.key(Edit::Char('9'));
        assert_eq!(typing.hear(&EditAnswer { count: 1, refused: Some(Said::new("不行", "no")) }), Heard::Nothing);
        assert_eq!((typing.text.as_str(), typing.refused), ("9", None));
    }
}
