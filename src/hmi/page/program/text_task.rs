//! Tasks over a whole text: search, replace all, renumber. They run in slices so that no frame waits.
//! Source: spec B6 (search O/N/word), H8 (nothing blocks the frame for more than 16 ms).

use std::collections::BTreeMap;
use std::ops::Range;

use ropey::{Rope, RopeBuilder};

use super::document::{Document, content_len};
use crate::defs::text::{LocalizedText, Text, phrase};

/// Lines per slice: a few milliseconds.
const SLICE_LINES: usize = 4_000;
/// Maximum number of characters searched per line; lines of a program are far shorter.
const MAX_SEARCHED_CHARS: usize = 20_000;
/// The largest block number that is assigned.
const MAX_BLOCK_NUMBER: u64 = 99_999_999;

/// Result of a slice.
#[derive(Debug)]
pub enum TaskStep {
    /// In progress, per mille.
    Running(u16),
    /// Found: its characters.
    Found(Range<usize>),
    /// No match in the text.
    NotFound,
    /// A new text, and the number of changes.
    Changed(Rope, usize),
    /// Not possible, with the reason.
    Refused(LocalizedText),
}

/// A task in progress.
#[derive(Debug)]
pub enum TextTask {
    /// Searches a word from a position on, once around the text.
    Find { what: String, from: usize, done: usize },
    /// Searches the block with a number.
    Block { number: u64, line: usize },
    /// Replaces all matches.
    Replace { what: String, with: String, line: usize, count: usize, built: Option<RopeBuilder> },
    /// Renumbers the blocks.
    Renumber(Renumbering),
}

impl TextTask {
    /// Searches a word from the cursor on.
    pub fn find(what: &str, document: &Document) -> Self {
        Self::Find { what: what.to_owned(), from: document.cursor, done: 0 }
    }

    /// Searches the block N with this number.
    pub const fn find_block(number: u64) -> Self {
        Self::Block { number, line: 0 }
    }

    /// Replaces all matches.
    pub fn replace(what: &str, with: &str) -> Self {
        let (what, with, built) = (what.to_owned(), with.to_owned(), Some(RopeBuilder::new()));
        Self::Replace { what, with, line: 0, count: 0, built }
    }

    /// Renumbers the blocks from `first` in steps of `by`.
    pub fn renumber(first: u64, by: u64) -> Self {
        Self::Renumber(Renumbering { first, by, ..Renumbering::default() })
    }

    /// Name of the task.
    pub const fn name(&self) -> Text {
        match self {
            Self::Find { .. } | Self::Block { .. } => Text::new("正在查找", "searching"),
            Self::Replace { .. } => Text::new("正在替换", "replacing"),
            Self::Renumber(_) => Text::new("正在重排段号", "renumbering"),
        }
    }

    /// Runs one slice.
    pub fn step(&mut self, text: &Rope) -> TaskStep {
        match self {
            Self::Find { what, from, done } => find(text, what, *from, done),
            Self::Block { number, line } => find_block(text, *number, line),
            Self::Replace { what, with, line, count, built } => {
                let Some(builder) = built else { return TaskStep::NotFound };
                let end = (*line + SLICE_LINES).min(text.len_lines());
                for index in *line..end {
                    *count += replace_in(&text.line(index).to_string(), what, with, builder);
                }
                *line = end;
                if end < text.len_lines() {
                    return TaskStep::Running(permille(end, text.len_lines()));
                }
                match (built.take(), *count) {
                    (Some(built), 1..) => TaskStep::Changed(built.finish(), *count),
                    (Some(_) | None, _) => TaskStep::NotFound,
                }
            }
            Self::Renumber(task) => task.step(text),
        }
    }
}

fn permille(done: usize, all: usize) -> u16 {
    (done * 1_000 / all.max(1)).min(1_000) as u16
}

/// Byte position of a word in a text at or after `from`, ignoring case.
fn find_in_line(text: &str, what: &str, from: usize) -> Option<usize> {
    let (text, what) = (text.as_bytes(), what.as_bytes());
    if what.is_empty() {
        return None;
    }
    (from..=text.len().checked_sub(what.len())?).find(|at| text[*at..*at + what.len()].eq_ignore_ascii_case(what))
}

/// Searches one slice of a text in so many turns, `done` so far; `found` looks at the line of a turn.
fn search(text: &Rope, turns: usize, done: &mut usize, found: impl Fn(usize) -> Option<Range<usize>>) -> TaskStep {
    for _ in 0..SLICE_LINES {
        if *done >= turns {
            return TaskStep::NotFound;
        }
        *done += 1;
        if let Some(place) = found(*done - 1) {
            return TaskStep::Found(place);
        }
    }
    TaskStep::Running(permille(*done, text.len_lines()))
}

/// The searched part of a line.
fn searched(text: &Rope, line: usize) -> String {
    let slice = text.line(line);
    slice.slice(..content_len(slice).min(MAX_SEARCHED_CHARS)).into()
}

/// Searches a word once around: the cursor's line comes first, from the cursor on, and last, from its start.
fn find(text: &Rope, what: &str, from: usize, done: &mut usize) -> TaskStep {
    let lines = text.len_lines();
    let start = text.char_to_line(from.min(text.len_chars()));
    let column = from - text.line_to_char(start);
    search(text, lines + 1, done, |turn| {
        let line = (start + turn) % lines;
        let part = searched(text, line);
        let begin = if turn == 0 { part.char_indices().nth(column).map_or(part.len(), |(at, _)| at) } else { 0 };
        let at = find_in_line(&part, what, begin)?;
        let from = text.line_to_char(line) + part[..at].chars().count();
        Some(from..from + what.chars().count())
    })
}

/// Searches a block: N is its first word, `N0040` is 40. A longer number with the same digits in front does not match.
fn find_block(text: &Rope, number: u64, line: &mut usize) -> TaskStep {
    search(text, text.len_lines(), line, |line| {
        let at = text.line_to_char(line);
        (split_block_number(&searched(text, line)).1 == Some(number)).then_some(at..at)
    })
}

/// Appends a line with all matches replaced; returns their number.
fn replace_in(line: &str, what: &str, with: &str, builder: &mut RopeBuilder) -> usize {
    let (mut at, mut count) = (0, 0);
    while let Some(found) = find_in_line(line, what, at) {
        builder.append(&line[at..found]);
        builder.append(with);
        at = found + what.len();
        count += 1;
    }
    builder.append(&line[at..]);
    count
}

/// Splits a line into leading blanks and `/`, the block number if there is one, and the rest.
fn split_block_number(line: &str) -> (&str, Option<u64>, &str) {
    let (lead, rest) = line.split_at(line.len() - line.trim_start_matches([' ', '\t', '/']).len());
    let Some(after) = rest.strip_prefix(['N', 'n']) else { return (lead, None, rest) };
    let digits = after.bytes().take_while(u8::is_ascii_digit).count();
    after[..digits].parse().map_or((lead, None, rest), |number| (lead, Some(number), &after[digits..]))
}

/// Whether a line gets a number when no block of the program has one.
fn is_block(rest: &str) -> bool {
    rest.trim_end().chars().next().is_some_and(|sign| !matches!(sign, '%' | 'O' | 'o' | '(' | ';'))
}

/// Renumbering of the blocks: first all block numbers are read, then the new ones are written.
#[derive(Debug, Default)]
pub struct Renumbering {
    first: u64,
    by: u64,
    /// The next line of the pass.
    line: usize,
    /// The new number of each old one.
    map: BTreeMap<u64, u64>,
    /// Numbers that two blocks have.
    twice: Vec<u64>,
    /// Number of blocks of the pass.
    blocks: u64,
    /// The new text; none in the first pass.
    built: Option<RopeBuilder>,
}

impl Renumbering {
    /// Runs one slice.
    fn step(&mut self, text: &Rope) -> TaskStep {
        let lines = text.len_lines();
        let Some(mut builder) = self.built.take() else {
            return match self.read_numbers(text) {
                Ok(true) => {
                    (self.line, self.blocks, self.built) = (0, 0, Some(RopeBuilder::new()));
                    TaskStep::Running(500)
                }
                Ok(false) => TaskStep::Running(permille(self.line, lines) / 2),
                Err(why) => TaskStep::Refused(why),
            };
        };
        let end = (self.line + SLICE_LINES).min(lines);
        (self.line..end).for_each(|index| self.write_numbered(&text.line(index).to_string(), &mut builder));
        self.line = end;
        if end < lines {
            self.built = Some(builder);
            return TaskStep::Running(500 + permille(end, lines) / 2);
        }
        TaskStep::Changed(builder.finish(), self.blocks as usize)
    }

    /// First pass: reads the block numbers and checks that all jumps can be updated. True when all lines are read.
    fn read_numbers(&mut self, text: &Rope) -> Result<bool, LocalizedText> {
        let end = (self.line + SLICE_LINES).min(text.len_lines());
        for index in self.line..end {
            let line = text.line(index).to_string();
            let (lead, number, rest) = split_block_number(&line);
            if lead.ends_with("//") {
                continue;
            }
            if let Some(number) = number {
                if self.map.insert(number, self.first + self.blocks * self.by).is_some() {
                    self.twice.push(number);
                }
                self.blocks += 1;
            }
            let upper = without_comments(rest).to_ascii_uppercase();
            let jumps = [("M99", 'P'), ("M01", 'L'), ("M1", 'L'), ("M91", 'P'), ("M92", 'P'), ("G65", 'H')];
            let by_code = jumps.iter().any(|(code, word)| upper.contains(code) && upper.contains(*word));
            let target = upper.split("GOTO").nth(1).map(str::trim_start);
            if by_code || target.is_some_and(|target| target.starts_with(['#', '['])) {
                let line = index + 1;
                return Err(phrase!(
                    "第{line}行的跳转目标不能自动更改，请手工改段号",
                    "the jump target in line {line} cannot be adapted: renumber by hand",
                    line
                ));
            }
        }
        self.line = end;
        if end < text.len_lines() {
            return Ok(false);
        }
        if let Some(number) = self.twice.first() {
            let zh = format!("段号 N{number} 出现两次，请先改正");
            return Err(LocalizedText::new(zh, format!("N{number} occurs twice: correct that first")));
        }
        if self.first + self.by * text.len_lines() as u64 > MAX_BLOCK_NUMBER {
            return Err(phrase!("段号太大，请减小步长", "the numbers get too large: use a smaller step"));
        }
        Ok(true)
    }

    /// Second pass: appends a line with its new number and with the target of its jump.
    fn write_numbered(&mut self, line: &str, builder: &mut RopeBuilder) {
        let (lead, number, rest) = split_block_number(line);
        builder.append(lead);
        let comment = lead.ends_with("//");
        // If no block has a number, all get one.
        if !comment && (number.is_some() || (self.map.is_empty() && is_block(rest))) {
            builder.append(&format!("N{:04}", self.first + self.blocks * self.by));
            if number.is_none() {
                builder.append(" ");
            }
            self.blocks += 1;
        } else if let Some(number) = number {
            builder.append(&format!("N{number}"));
        }
        let target = find_in_line(rest, "GOTO", 0).map(|at| at + 4).filter(|_| !comment);
        let Some(at) = target else { return builder.append(rest) };
        let digits_at = rest.len() - jump_target(&rest[at..]).len();
        let digits = rest[digits_at..].bytes().take_while(u8::is_ascii_digit).count();
        let old = rest[digits_at..digits_at + digits].parse::<u64>().ok();
        match old.and_then(|old| self.map.get(&old)) {
            Some(new) => {
                builder.append(&rest[..digits_at]);
                builder.append(&format!("{new}"));
                builder.append(&rest[digits_at + digits..]);
            }
            None => builder.append(rest),
        }
    }
}

/// The text behind GOTO from the digits of its block number on: `GOTO 10`, `GOTON10`, `GOTOF N10` (802D).
fn jump_target(behind: &str) -> &str {
    let name = behind.strip_prefix(['F', 'f', 'B', 'b']).unwrap_or(behind).trim_start();
    name.strip_prefix(['N', 'n']).unwrap_or(name).trim_start()
}

fn without_comments(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut depth = 0;
    for sign in text.chars() {
        match sign {
            '(' => depth += 1,
            ')' => depth = 0,
            ';' if depth == 0 => break,
            _ if depth == 0 => plain.push(sign),
            _ => {}
        }
    }
    plain
}
