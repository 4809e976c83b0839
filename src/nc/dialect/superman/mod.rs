//! The 超人 (SuperMan) lathe dialect: X, Z absolute, U, W incremental in any mix; X, U, I diameters; one G per block.
//!
//! Order within a block: S, T, M03–M08, the G function, M00 and M02, then jumps, calls and returns.
//! Source: spec superman-lathe.md L1–L8, seed 001.

mod auxiliary;
mod motion;
mod thread;

use super::{Running, Step, Unrun};
use crate::defs::program_error::ProgramError as E;
use crate::nc::fault::{Outcome, wrong, wrong1, wrong2};
use crate::nc::modal::Motion;
use crate::nc::settings::Settings;
use crate::nc::words::{Code, Kind, Word, Words};

/// Greatest coordinate that can be programmed, mm.
const LIMIT: f64 = 9_999.99;
/// Highest block number, and its number of digits.
const NUMBERS: u32 = 9_999;
const DIGITS: usize = 4;

/// Mask of the address letters X Z U W.
const AXIS_WORDS: u32 = bit(b'X') | bit(b'Z') | bit(b'U') | bit(b'W');

const fn bit(letter: u8) -> u32 {
    1 << (letter - b'A')
}

/// All G codes; others are refused.
const G_CODES: &[u32] = &[0, 1, 2, 3, 4, 22, 23, 26, 27, 29, 32, 33, 36, 37, 39, 80, 92];

/// Executes a block of words.
pub(super) fn run(running: &mut Running<'_, '_>) -> Outcome<Step> {
    check_writing(running.words, running.settings, (running.text, running.at))?;
    if let Some((short, full)) = short_number(running.text, running.at) {
        running.scope.note(running.at, E::BlockNumberShort, [short, full]);
    }
    let code = g_code(running.words)?;
    auxiliary::speed(running)?;
    auxiliary::tool(running)?;
    let flow = auxiliary::before_motion(running)?;
    let step = function(running, code)?;
    auxiliary::after_motion(running);
    if let Some(unused) = running.words.unused() {
        return unknown_word(running.text, unused);
    }
    match (flow, step) {
        (Some((m, _)), Some(_)) => {
            let (first, second) = (name(code), format!("M{:02}", m.number));
            wrong2(m.at as usize, E::NotTogether, first, second)
        }
        (Some((_, flow)), None) => Ok(flow),
        (None, Some(step)) => Ok(step),
        (None, None) => Ok(Step::Next),
    }
}

/// Checks format and codes of a block that is not executed.
pub(super) fn look(words: &Words, settings: &Settings, block: &Unrun<'_>) -> Outcome<()> {
    let text: &[u8] = block.source.bytes();
    check_writing(words, settings, (text, block.at))?;
    let code = g_code(words)?;
    words.m().iter().try_for_each(|code| auxiliary::look(*code, words, block))?;
    auxiliary::alone(words)?;
    motion::one_word_each(words)?;
    if let Some(word) = words.list().iter().find(|word| !LETTERS.contains(&word.letter)) {
        return unknown_word(text, *word);
    }
    let Some(code) = code else { return Ok(()) };
    let feed = |motion| words.look(b'F').map_or(Ok(()), |word| motion::feed_in_range(word, motion));
    match code.number {
        1 => feed(Motion::Feed),
        2 => feed(Motion::ArcClockwise),
        3 => feed(Motion::ArcCounterClockwise),
        4 => words.look(b'F').map_or(Ok(()), motion::dwell_in_range),
        22 => auxiliary::look_at_loop(code, words, block),
        92 => motion::whole_preset(words, code.at as usize),
        _ => Ok(()),
    }
}

/// The address letters of words, without N, G and M.
const LETTERS: &[u8] = b"XZUWIKRFLST";

/// Checks the format of every block: first a four-digit number, literal values, unique addresses (L1).
fn check_writing(words: &Words, settings: &Settings, (text, at): (&[u8], usize)) -> Outcome<()> {
    let line = text.get(at..).unwrap_or_default();
    let end = line.iter().position(|byte| matches!(byte, b'\r' | b'\n' | b';' | b'(')).unwrap_or(line.len());
    if let Some(place) = line[..end].iter().position(|byte| matches!(byte, b'#' | b'[')) {
        return wrong(at + place, E::NoMacros);
    }
    let first = line.iter().position(|byte| !matches!(byte, b' ' | b'\t')).unwrap_or(0);
    let numbered = matches!(line.get(first), Some(b'N' | b'n'));
    if words.n.is_some() && !numbered {
        let place = line[..end].iter().position(|byte| matches!(byte, b'N' | b'n')).unwrap_or(0);
        return wrong(at + place, E::NumberFirst);
    }
    let letter = |place: u32| char::from(text.get(place as usize).copied().unwrap_or(b'?')).to_ascii_uppercase();
    if let Some(place) = words.bare {
        return wrong1(place as usize, E::MissingNumber, letter(place));
    }
    if let Some(place) = words.double {
        return wrong1(place as usize, E::DoubleWord, letter(place));
    }
    let digits = line.iter().skip(first + 1).take_while(|byte| byte.is_ascii_digit()).count();
    // D: the manual prints N016 once; a number of three digits is accepted with a warning.
    let as_printed = digits == DIGITS || digits + 1 == DIGITS;
    match words.n {
        None if settings.numbered => wrong(at + first, E::BlockNumberMissing),
        Some(n) if n > NUMBERS || settings.numbered && !as_printed => {
            wrong2(at + first, E::BlockNumberDigits, written_number(line, first, digits), best_number(n))
        }
        None | Some(_) => Ok(()),
    }
}

fn written_number(line: &[u8], first: usize, digits: usize) -> String {
    let digits = line.get(first + 1..first + 1 + digits).unwrap_or_default();
    format!("N{}", String::from_utf8_lossy(digits))
}

/// The correct form of a block number.
fn best_number(n: u32) -> String {
    if n > NUMBERS { format!("N0000–N{NUMBERS}") } else { format!("N{n:04}") }
}

/// A three-digit block number as written, and with four digits.
fn short_number(text: &[u8], at: usize) -> Option<(String, String)> {
    let line = text.get(at..)?;
    let first = line.iter().position(|byte| !matches!(byte, b' ' | b'\t'))?;
    let digits = line.iter().skip(first + 1).take_while(|byte| byte.is_ascii_digit()).count();
    let short = matches!(line.get(first), Some(b'N' | b'n')) && digits + 1 == DIGITS;
    short.then(|| {
        let written = written_number(line, first, digits);
        let full = format!("N0{}", &written[1..]);
        (written, full)
    })
}

/// The only G code of a block.
fn g_code(words: &Words) -> Outcome<Option<Code>> {
    if let Some(code) = words.g().iter().find(|code| !G_CODES.contains(&code.number)) {
        let known: Vec<_> = G_CODES.iter().map(|code| format!("G{code:02}")).collect();
        return wrong2(code.at as usize, E::NoSuchCode, format!("G{:02}", code.number), known.join(" "));
    }
    match *words.g() {
        [] => Ok(None),
        [code] => Ok(Some(code)),
        [first, second, ..] if first.number == second.number => {
            wrong1(second.at as usize, E::DoubleWord, format!("G{:02}", second.number))
        }
        [first, second, ..] => {
            let names = [first, second].map(|code| format!("G{:02}", code.number));
            let [first, other] = names;
            wrong2(second.at as usize, E::NotTogether, first, other)
        }
    }
}

/// The name of a code, or an empty text.
fn name(code: Option<Code>) -> String {
    code.map_or_else(String::new, |code| format!("G{:02}", code.number))
}

/// Executes the G function of the block, else the modal one if there are coordinates.
fn function(running: &mut Running<'_, '_>, code: Option<Code>) -> Outcome<Option<Step>> {
    let place = code.map_or(running.at, |code| code.at as usize);
    if let Some(code) = code {
        match code.number {
            4 => motion::dwell(running, place)?,
            22 => return auxiliary::begin_loop(running, place).map(Some),
            26 => motion::return_to_start(running, place, true, true)?,
            27 => motion::return_to_start(running, place, true, false)?,
            29 => motion::return_to_start(running, place, false, true)?,
            36 => motion::home(running, place, true, true)?,
            37 => motion::home(running, place, true, false)?,
            39 => motion::home(running, place, false, true)?,
            80 => return Ok(Some(Step::EndLoop { at: place })),
            92 => motion::preset(running, place)?,
            number => {
                running.modals.motion = match number {
                    0 => Motion::Rapid,
                    1 => Motion::Feed,
                    2 => Motion::ArcClockwise,
                    3 => Motion::ArcCounterClockwise,
                    23 => Motion::RectangleCycle,
                    32 => Motion::InchThread,
                    _ => Motion::MetricThread,
                };
                modal(running, place, true)?;
            }
        }
        return Ok(None);
    }
    modal(running, place, false).map(|()| None)
}

/// Executes the modal function with the words of the block; `named`: its G code is in the block.
fn modal(running: &mut Running<'_, '_>, place: usize, named: bool) -> Outcome<()> {
    let arc = bit(b'I') | bit(b'K') | bit(b'R');
    let by_arc = matches!(running.modals.motion, Motion::ArcClockwise | Motion::ArcCounterClockwise)
        && running.words.has_any(arc);
    let moves = running.words.has_any(AXIS_WORDS) || by_arc;
    let threads = matches!(running.modals.motion, Motion::InchThread | Motion::MetricThread);
    if threads {
        return if moves || named { thread::run(running, place) } else { Ok(()) };
    }
    let feed = motion::take_feed(running)?;
    if !moves {
        return match running.modals.motion {
            Motion::RectangleCycle if named => wrong2(place, E::MissingWord, "G23", "X / U, Z / W"),
            _ => Ok(()),
        };
    }
    match running.modals.motion {
        Motion::Feed => motion::line(running),
        Motion::ArcClockwise => motion::arc(running, place, 1),
        Motion::ArcCounterClockwise => motion::arc(running, place, -1),
        Motion::RectangleCycle => motion::rectangle(running, place),
        _ => motion::rapid(running, feed),
    }
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> Outcome<u32> {
    let name = char::from(word.letter);
    if word.kind != Kind::Digits {
        return wrong1(word.at as usize, E::NotWhole, name);
    }
    match crate::nc::expression::whole(word.value) {
        Some(value) if (i64::from(low)..=i64::from(high)).contains(&value) => Ok(value as u32),
        Some(_) | None => out_of_range(word, &format!("{low}–{high}")),
    }
}

#[cold]
fn out_of_range<T>(word: Word, range: &str) -> Outcome<T> {
    wrong2(word.at as usize, E::OutOfRange, format!("{}{}", char::from(word.letter), word.value), range)
}

/// Reports an unknown word, as written up to the next letter or blank.
#[cold]
fn unknown_word<T>(text: &[u8], word: Word) -> Outcome<T> {
    let at = word.at as usize;
    let rest = text.get(at..).unwrap_or_default();
    let ends = |byte: &u8| !matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+');
    let length = rest.iter().skip(1).position(ends).map_or(rest.len(), |length| length + 1);
    wrong1(at, E::UnknownWord, String::from_utf8_lossy(&rest[..length]).to_ascii_uppercase())
}
