//! What happened to retained data that were damaged or gone: kept with what took their place until a person has accepted it.
//! Source: spec B6, K4.2; safety stance.

use crate::defs::text::{LocalizedText, Template, Text, phrase};

/// In the row of a loss: a person has chosen what took the place, or what was chosen could not be used.
const CHOSEN: &str = "chosen";
const MISSED: &str = "missed";
/// In the row of a loss: what took its place.
const JOURNAL: &str = "journal";
const EARLIER: &str = "earlier";

/// What happened to the retained data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataLoss {
    /// The copy of a damaged file; none: the file was gone.
    pub copy: Option<String>,
    /// Time of the state that took its place; none: factory values.
    pub state_of: Option<String>,
    /// What a person has chosen in its place.
    pub choice: LossChoice,
    /// What took its place at first.
    pub source: LossSource,
}

/// What takes the place of lost data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossSource {
    /// Nothing: factory values.
    None,
    /// The journal: the last acknowledged values.
    Journal,
    /// An earlier state.
    EarlierState,
}

/// Whether a person has chosen the data that took the place of lost ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LossChoice {
    /// Nobody has chosen.
    None,
    /// They are those that were chosen.
    Made,
    /// What was chosen could not be read or written.
    Missed,
}

impl DataLoss {
    /// The text of the database row.
    pub(super) fn row(&self) -> String {
        let word = |of: &Option<String>| of.clone().unwrap_or_default();
        let choice = match self.choice {
            LossChoice::None => "",
            LossChoice::Made => CHOSEN,
            LossChoice::Missed => MISSED,
        };
        let source = match self.source {
            LossSource::None => "",
            LossSource::Journal => JOURNAL,
            LossSource::EarlierState => EARLIER,
        };
        format!("{}|{}|{choice}|{source}", word(&self.copy), word(&self.state_of))
    }

    pub(super) fn from_row(row: &str) -> Self {
        let mut words = row.split('|');
        let mut next = || words.next().map(str::to_owned).filter(|word| !word.is_empty());
        let (copy, state_of, choice, source) = (next(), next(), next(), next());
        let source = match source.as_deref() {
            Some(JOURNAL) => LossSource::Journal,
            Some(EARLIER) => LossSource::EarlierState,
            // Rows of earlier versions do not say it.
            Some(_) | None if state_of.is_some() => LossSource::EarlierState,
            Some(_) | None => LossSource::None,
        };
        let choice = match choice.as_deref() {
            Some(CHOSEN) => LossChoice::Made,
            Some(MISSED) => LossChoice::Missed,
            Some(_) | None => LossChoice::None,
        };
        Self { copy, state_of, choice, source }
    }

    /// What happened and what is used, for the alarm.
    #[must_use]
    pub fn message(&self) -> LocalizedText {
        const LOSS: &Template = &Template::new("{what}，{by}{used}", "{what}; {by}{used}", &["what", "by", "used"]);
        let what = match &self.copy {
            Some(copy) => phrase!("文件损坏（副本 {copy}）", "file damaged (copy {copy})", copy = copy.to_string()),
            None => phrase!("文件被删除", "file gone"),
        };
        let used = match &self.state_of {
            Some(time) => phrase!("用 {time} 的数据", "values of {time}", time = time.to_string()),
            None => phrase!("用出厂值", "factory values"),
        };
        let by = match self.choice {
            LossChoice::None => Text::new("", ""),
            LossChoice::Made => Text::new("已选", "chosen: "),
            LossChoice::Missed => Text::new("所选数据不能用，", "the chosen data could not be used; "),
        };
        LocalizedText::phrase_of(LOSS, [], [what, by.into(), used])
    }
}
