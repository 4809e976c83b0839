//! Texts that a program gives beside its blocks, as comments: its English title, the English of what it shows, and cause,
//! remedy and variables of the alarms that it raises with `#3000`.
//!
//! A row is a comment alone in its line; other controls skip it.
//!
//! ```text
//! (EN: plunge grinding)
//! (#3000=1 #505 GE 0 #506 GE 0 原因: 左卡余量小于 0)
//! (#3000=1 处理: 在磨削页面改为 0 或正数)
//! (#3000=1 EN: a grinding allowance is below 0)
//! (#3000=1 CAUSE: an allowance of the left jaw is below 0)
//! (#3000=1 REMEDY: enter 0 or more on the grinding page)
//! (#3006=2 EN: turn the part over)
//! ;MSG("错误01:转速过高") EN: error 01: speed too high
//! ```
//!
//! The rows are read when the program is loaded, never in the tick. Source: spec B8, H9.

use std::sync::Arc;

use super::functions::Comparison;
use crate::defs::alarm::USER_ALARM_FIRST;
use crate::defs::page_text::is_allowed_on_page;
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, SharedWords, Words};
use crate::defs::value_bound::{BoundLimit, BoundSide, ValueBound};

/// What the rows of a program belong to.
#[derive(Clone, Debug, PartialEq, Eq)]
enum MessageKey {
    /// The program.
    Title,
    /// `#3000=n`: alarm 3000 + n.
    Alarm(u32),
    /// `#3006=n`.
    Stop(u32),
    /// `MSG("text")`.
    Message(String),
}

/// What a row gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowKind {
    English,
    CauseZh,
    CauseEn,
    RemedyZh,
    RemedyEn,
}

/// The words of the rows.
const ROW_WORDS: [(&str, RowKind); 5] = [
    ("EN", RowKind::English),
    ("原因", RowKind::CauseZh),
    ("CAUSE", RowKind::CauseEn),
    ("处理", RowKind::RemedyZh),
    ("REMEDY", RowKind::RemedyEn),
];

/// What must hold for a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VariableRule {
    variable: u16,
    /// The comparison and what it compares with; none: the variable is named without a rule.
    must: Option<(Comparison, BoundLimit)>,
}

/// What a program says of an alarm that it raises with `#3000`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AlarmHelp {
    /// The English text, for an alarm without a text in its block; empty if there is none.
    pub text: LocalizedText,
    /// Cause; empty if there is none.
    pub cause: SharedWords,
    /// Remedy; empty if there is none.
    pub remedy: SharedWords,
    rules: Vec<VariableRule>,
}

impl AlarmHelp {
    /// The variable whose value is wrong: the first one whose rule does not hold, else the first one named.
    #[must_use]
    pub fn variable(&self, value_of: impl Fn(u16) -> Option<f64>) -> Option<u16> {
        let wrong = self.rules.iter().find(|rule| !rule.holds(&value_of));
        wrong.or(self.rules.first()).map(|rule| rule.variable)
    }
}

impl VariableRule {
    /// Whether the rule holds. An empty variable counts as 0, as in the conditions of a program.
    fn holds(&self, value_of: impl Fn(u16) -> Option<f64>) -> bool {
        let Some((comparison, limit)) = self.must else { return true };
        let value_of = |variable| value_of(variable).unwrap_or(0.0);
        let limit = match limit {
            BoundLimit::Number(number) => number,
            BoundLimit::Variable(variable) => value_of(variable),
        };
        comparison.holds(value_of(self.variable), limit)
    }

    /// The bounds that the rule is, of its variable and of a variable that this is compared with; none for = and ≠.
    fn bounds(&self) -> impl Iterator<Item = ValueBound> + use<> {
        let bound = self.bound();
        let mirrored = bound.and_then(|bound| match bound.limit {
            BoundLimit::Number(_) => None,
            BoundLimit::Variable(variable) => {
                let side = match bound.side {
                    BoundSide::Least => BoundSide::Most,
                    BoundSide::Most => BoundSide::Least,
                };
                Some(ValueBound { variable, side, limit: BoundLimit::Variable(bound.variable), ..bound })
            }
        });
        bound.into_iter().chain(mirrored)
    }

    fn bound(&self) -> Option<ValueBound> {
        let (comparison, limit) = self.must?;
        let (side, is_strict) = match comparison {
            Comparison::Ge => (BoundSide::Least, false),
            Comparison::Gt => (BoundSide::Least, true),
            Comparison::Le => (BoundSide::Most, false),
            Comparison::Lt => (BoundSide::Most, true),
            Comparison::Eq | Comparison::Ne => return None,
        };
        Some(ValueBound { variable: self.variable, side, is_strict, limit })
    }
}

/// A row of texts that does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextRowFault {
    /// Line, from 1.
    pub line: u32,
    /// Cause and remedy.
    pub message: LocalizedText,
}

/// One row, as written.
struct Row {
    key: MessageKey,
    rules: Vec<VariableRule>,
    kind: RowKind,
    text: String,
}

/// The rows of one key.
#[derive(Clone, Debug)]
struct MessageEntry {
    key: MessageKey,
    /// Line of the first row, from 1.
    line: u32,
    english: String,
    /// Cause and remedy, each Chinese and English.
    texts: [String; 4],
    help: AlarmHelp,
}

/// The texts that a program gives beside its blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct MessageTexts {
    entries: Vec<MessageEntry>,
    /// Lines, from 1, of rows that are not understood.
    bad_rows: Vec<u32>,
    /// The bounds of values that its alarms name.
    bounds: Arc<[ValueBound]>,
}

impl MessageTexts {
    /// Reads the rows of a program: the lines, from 1, of comments that may be rows, and the comments.
    pub(super) fn read(comments: impl Iterator<Item = (u32, String)>) -> Self {
        let mut texts = Self::default();
        for (line, comment) in comments {
            match row(comment.trim()) {
                Some(row) => texts.add(row, line),
                None if means_row(&comment) => texts.bad_rows.push(line),
                None => {}
            }
        }
        for entry in &mut texts.entries {
            let [cause_zh, cause_en, remedy_zh, remedy_en] = &entry.texts;
            entry.help.text = LocalizedText::same(&entry.english);
            (entry.help.cause, entry.help.remedy) =
                (SharedWords::either(cause_zh, cause_en), SharedWords::either(remedy_zh, remedy_en));
        }
        let rules = texts.entries.iter().flat_map(|entry| &entry.help.rules);
        texts.bounds = rules.flat_map(VariableRule::bounds).collect();
        texts
    }

    fn add(&mut self, row: Row, line: u32) {
        let entry = self.entry(row.key, line);
        entry.help.rules.extend(row.rules);
        let place = match row.kind {
            RowKind::English => &mut entry.english,
            RowKind::CauseZh => &mut entry.texts[0],
            RowKind::CauseEn => &mut entry.texts[1],
            RowKind::RemedyZh => &mut entry.texts[2],
            RowKind::RemedyEn => &mut entry.texts[3],
        };
        *place = row.text;
    }

    /// The entry of a key; a new one is empty.
    fn entry(&mut self, key: MessageKey, line: u32) -> &mut MessageEntry {
        let index = self.entries.iter().position(|entry| entry.key == key).unwrap_or_else(|| {
            let (english, texts, help) = (String::new(), Default::default(), AlarmHelp::default());
            self.entries.push(MessageEntry { key, line, english, texts, help });
            self.entries.len() - 1
        });
        &mut self.entries[index]
    }

    fn find(&self, key: &MessageKey) -> Option<&MessageEntry> {
        self.entries.iter().find(|entry| entry.key == *key)
    }

    /// The English title.
    pub(super) fn english_title(&self) -> Option<&str> {
        self.find(&MessageKey::Title).map(|entry| entry.english.as_str()).filter(|title| !title.is_empty())
    }

    /// The bounds of values that the alarms of the program name.
    pub(super) const fn bounds(&self) -> &Arc<[ValueBound]> {
        &self.bounds
    }

    /// What the program says of an alarm, 3000 to 3999.
    pub(super) fn alarm_help(&self, number: u32) -> Option<&AlarmHelp> {
        self.find(&MessageKey::Alarm(number)).map(|entry| &entry.help)
    }

    /// A text that the program shows, with its English. `before` are the bytes before it in its line.
    pub(super) fn translate(&self, before: &[u8], text: Arg) -> Arg {
        let key = numbered_message(before).unwrap_or_else(|| MessageKey::Message(text.as_name().to_owned()));
        match self.find(&key).filter(|entry| !entry.english.is_empty()) {
            Some(entry) => Arg::Words(Arc::new(Words::new(text.as_name(), &entry.english))),
            None => text,
        }
    }

    /// An alarm without a row that names a variable is about the first variable in its text.
    pub(super) fn name_variable(&mut self, before: &[u8], text: &Arg) {
        let Some(MessageKey::Alarm(number)) = numbered_message(before) else { return };
        let named = text.as_name().split('#').skip(1).find_map(|rest| {
            let end = rest.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(rest.len());
            rest[..end].parse::<u16>().ok().filter(|variable| is_allowed_on_page(*variable))
        });
        if let Some(variable) = named {
            let rules = &mut self.entry(MessageKey::Alarm(number), 0).help.rules;
            if rules.is_empty() {
                rules.push(VariableRule { variable, must: None });
            }
        }
    }

    /// Whether the program has no rows of texts: then none can be wrong.
    pub(super) fn has_no_rows(&self) -> bool {
        self.bad_rows.is_empty() && self.entries.iter().all(|entry| entry.line == 0)
    }

    /// Rows that are not understood, and rows of alarms and messages that the program does not have. `code` is the text
    /// of its lines without comments, `shown` are the texts that it shows.
    pub(super) fn faults<'t>(
        &self,
        code: impl Iterator<Item = String>,
        shown: impl Iterator<Item = &'t Arg>,
    ) -> Vec<TextRowFault> {
        let bad = self.bad_rows.iter().map(|line| {
            let zh = "看不懂的文字行：应写成 (#3000=n #变量 原因: …)，关键字为 原因、处理、EN、CAUSE、REMEDY";
            let en = "text row not understood: write (#3000=n #variable CAUSE: …) with 原因, 处理, EN, CAUSE or REMEDY";
            TextRowFault { line: *line, message: LocalizedText::new(zh, en) }
        });
        let shown = ShownMessages::new(code, shown);
        let unused = self.entries.iter().filter(|entry| entry.line > 0 && !shown.has(&entry.key)).map(|entry| {
            let what = match &entry.key {
                MessageKey::Title => String::new(),
                MessageKey::Alarm(number) => format!("#3000={}", number - u32::from(USER_ALARM_FIRST)),
                MessageKey::Stop(number) => format!("#3006={number}"),
                MessageKey::Message(text) => format!("MSG(\"{text}\")"),
            };
            let zh = format!("程序中没有 {what}：请更正文字行的号或文字，或删除该行");
            let en = format!("the program has no {what}: correct number or text of this row, or delete the row");
            TextRowFault { line: entry.line, message: LocalizedText::new(zh, en) }
        });
        let mut all: Vec<_> = bad.chain(unused).collect();
        all.sort_by_key(|fault| fault.line);
        all
    }
}

/// The messages that a program has in its blocks.
#[derive(Default)]
struct ShownMessages {
    keys: Vec<MessageKey>,
    /// A number is computed (`#3000=#101`, H99): it may be any.
    computed: bool,
}

impl ShownMessages {
    fn new<'t>(code: impl Iterator<Item = String>, texts: impl Iterator<Item = &'t Arg>) -> Self {
        let mut shown = Self::default();
        shown.keys.extend(texts.map(|text| MessageKey::Message(text.as_name().to_owned())));
        for line in code {
            let code: String = line.chars().filter(|sign| !sign.is_whitespace()).collect();
            shown.computed |= code.contains("G65H99");
            for name in ["#3000=", "#3006="] {
                for (at, _) in code.match_indices(name) {
                    let digits = code[at + name.len()..].bytes().take_while(u8::is_ascii_digit).count();
                    let end = at + name.len() + digits;
                    match numbered_message(&code.as_bytes()[at..end]) {
                        Some(key) => shown.keys.push(key),
                        None => shown.computed = true,
                    }
                }
            }
        }
        shown
    }

    fn has(&self, key: &MessageKey) -> bool {
        let numbered = matches!(key, MessageKey::Alarm(_) | MessageKey::Stop(_));
        *key == MessageKey::Title || self.keys.contains(key) || (self.computed && numbered)
    }
}

/// Whether a comment may be a row, by its first bytes.
pub(super) fn is_row_start(comment: &[u8]) -> bool {
    let starts = |word: &[u8]| comment.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    starts(b"#3000=") || starts(b"#3006=") || starts(b"MSG(") || starts(b"EN:") || starts("EN：".as_bytes())
}

/// The message whose number stands at the end of some bytes: `… #3000=12`.
fn numbered_message(before: &[u8]) -> Option<MessageKey> {
    let before = before.trim_ascii_end();
    let digits = before.iter().rev().take_while(|byte| byte.is_ascii_digit()).count();
    let (head, number) = before.split_at(before.len() - digits);
    let number: u32 = std::str::from_utf8(number).ok()?.parse().ok().filter(|number| *number <= 999)?;
    let head = head.trim_ascii_end().strip_suffix(b"=")?.trim_ascii_end();
    match head.strip_suffix(b"#3000") {
        Some(_) => Some(MessageKey::Alarm(u32::from(USER_ALARM_FIRST) + number)),
        None => head.strip_suffix(b"#3006").map(|_| MessageKey::Stop(number)),
    }
}

/// Whether a comment that cannot be read as a row is meant as one: not a block that was commented out,
/// `(#3000=1(STOP: no part))`.
fn means_row(comment: &str) -> bool {
    let is_block = comment.strip_prefix('#').is_some_and(|block| block.contains('('));
    let upper = comment.to_ascii_uppercase();
    !is_block && ["CAUSE", "REMEDY", "原因", "处理", ":", "："].iter().any(|word| upper.contains(word))
}

/// Reads a row.
fn row(comment: &str) -> Option<Row> {
    let (key, rest) = match comment.get(..4) {
        Some(head) if head.eq_ignore_ascii_case("MSG(") => {
            let (text, rest) = comment[4..].split_once(')')?;
            let text = text.trim().trim_matches(['"', '“', '”']);
            (MessageKey::Message(text.to_owned()), rest)
        }
        Some(head) if head.starts_with('#') => {
            let digits = comment.get(6..)?.bytes().take_while(u8::is_ascii_digit).count();
            let (head, rest) = comment.split_at(6 + digits);
            (numbered_message(head.as_bytes())?, rest)
        }
        _ => (MessageKey::Title, comment),
    };
    let (head, text) = rest.split_once([':', '：'])?;
    let (rules, word) = variable_rules(head)?;
    let kind = ROW_WORDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word))?.1;
    let fits = match key {
        MessageKey::Alarm(_) => true,
        MessageKey::Title | MessageKey::Stop(_) | MessageKey::Message(_) => {
            kind == RowKind::English && rules.is_empty()
        }
    };
    let text = text.trim().to_owned();
    (fits && !text.is_empty()).then_some(Row { key, rules, kind, text })
}

/// Variables with their rules, `#505 GE 0 #506`, and the word after them.
fn variable_rules(head: &str) -> Option<(Vec<VariableRule>, &str)> {
    let (mut rules, mut words) = (Vec::new(), head.split_ascii_whitespace().peekable());
    loop {
        let word = words.next()?;
        let Some(variable) = variable(word) else {
            return words.next().is_none().then_some((rules, word));
        };
        let comparison = words.peek().and_then(|word| comparison(word));
        let must = match comparison {
            None => None,
            Some(comparison) => {
                words.next();
                let limit = words.next()?;
                let number = || limit.parse().ok().filter(|number: &f64| number.is_finite()).map(BoundLimit::Number);
                Some((comparison, self::variable(limit).map(BoundLimit::Variable).or_else(number)?))
            }
        };
        rules.push(VariableRule { variable, must });
    }
}

/// A variable of a page or of the memory of the program: `#505`.
fn variable(word: &str) -> Option<u16> {
    word.strip_prefix('#')?.parse().ok().filter(|variable| (100..=999).contains(variable))
}

fn comparison(word: &str) -> Option<Comparison> {
    Some(match word.to_ascii_uppercase().as_str() {
        "EQ" => Comparison::Eq,
        "NE" => Comparison::Ne,
        "GE" => Comparison::Ge,
        "GT" => Comparison::Gt,
        "LE" => Comparison::Le,
        "LT" => Comparison::Lt,
        _ => return None,
    })
}
