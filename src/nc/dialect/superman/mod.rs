//! The 超人 (SuperMan) lathe dialect: X, Z absolute, U, W incremental in any mix; X, U, I diameters; one G per block.
//!
//! Order within a block: S, T, M03–M08, the G function, M00 and M02, then jumps, calls and returns.
//! Source: spec superman-lathe.md L1–L8, seed 001.

mod auxiliary;
mod index;
mod motion;
mod thread;

use super::codes;
use super::common::{letter_at, out_of_range, unknown_word};
use super::rules::{BlockContext, DialectRow, DialectRules, FlowAction, PreflightScope, UnexecutedBlock};
use crate::defs::kind::Dialect;
use crate::defs::text::arg::Arg;
use crate::nc::expression::Scope;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::flow::{COUNTED_DEPTH, CallLimit};
use crate::nc::functions::whole_number;
use crate::nc::modal::{ModalCodes, MotionMode};
use crate::nc::settings::NcSettings;
use crate::nc::statement::{self, BlockContent, BlockReader};
use crate::nc::words::{BlockWords, Code, ValueKind, Word, letter_mask};

/// The 超人 lathe.
pub(super) struct SuperMan;

impl DialectRules for SuperMan {
    const ROW: DialectRow = DialectRow {
        settings: || NcSettings {
            exact_stop: true,
            start_is_work_zero: true,
            needs_block_numbers: true,
            tool_count: STATIONS,
            ..NcSettings::two_axes(Dialect::SuperMan)
        },
        modal_codes: ModalCodes::SYSTEM_A,
        index: index::index,
        check_unexecuted,
        executes_lone_blocks: false,
        called_program: |_| None,
        call_in_text: |_| Vec::new(),
        // L7: M98 calls a block of the same text.
        call_text: |_| None,
        program_heading: |_| None,
        new_program_text: |_| "N0010M02\r\n".to_owned(),
        // No program calls another; calls in the same text have their own limit.
        call_limit: |_| CallLimit { depth: COUNTED_DEPTH, name: "M98" },
        preflight_scope: PreflightScope::FullRun,
        required_end_code: Some("M02"),
        refused_words: &[],
        has_labels: false,
        has_macros: false,
    };

    #[inline]
    fn read_block<S: Scope>(reader: BlockReader<'_, '_, S>) -> ReadResult<BlockContent> {
        let content = statement::read_block(BlockReader { cursor: &mut *reader.cursor, ..reader })?;
        // L1: a line is one block. Text after `;` is always a comment.
        reader.cursor.skip_rest_of_line();
        Ok(content)
    }

    #[inline]
    fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        check_format(running.words, running.settings, (running.text, running.at))?;
        if let Some((short, full)) = short_block_number(running.text, running.at) {
            running.scope.warn(running.at, E::BlockNumberShort, [short, full]);
        }
        let code = single_g_code(running.words)?;
        auxiliary::spindle_speed(running)?;
        auxiliary::tool_call(running)?;
        let flow = auxiliary::before_motion(running)?;
        let step = execute_g_code(running, code)?;
        auxiliary::after_motion(running);
        if let Some(unused) = running.words.unused() {
            return unknown_word(running.text, unused);
        }
        match (flow, step) {
            (Some((m, _)), Some(_)) => {
                let named = code.map_or(Arg::None, |code| code.name('G', 2));
                fail2(m.at as usize, E::NotTogether, named, m.name('M', 2))
            }
            (Some((_, flow)), None) => Ok(flow),
            (None, Some(step)) => Ok(step),
            (None, None) => Ok(FlowAction::Next),
        }
    }
}

/// Number of stations of the tool turret.
const STATIONS: u32 = 4;

/// Greatest coordinate that can be programmed, mm.
const MAX_COORDINATE_MM: f64 = 9_999.99;
/// Highest block number, and its number of digits.
const MAX_BLOCK_NUMBER: u32 = 9_999;
const BLOCK_NUMBER_DIGITS: usize = 4;

/// Mask of the address letters X Z U W.
const AXIS_WORDS: u32 = letter_mask(b"XZUW");

/// All G codes; others are refused.
const G_CODES: &[u32] = &[0, 1, 2, 3, 4, 22, 23, 26, 27, 29, 32, 33, 36, 37, 39, 80, 92];

/// Checks format and codes of a block that is not executed.
fn check_unexecuted(words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
    let text: &[u8] = block.source.bytes();
    check_format(words, block.settings, (text, block.at))?;
    let code = single_g_code(words)?;
    words.m.iter().try_for_each(|code| auxiliary::check_m_code(*code, words, block))?;
    auxiliary::check_exclusive_m_codes(words)?;
    motion::check_one_word_per_axis(words)?;
    if let Some(word) = words.list.iter().find(|word| !ADDRESSES.contains(&word.letter)) {
        return unknown_word(text, *word);
    }
    let Some(code) = code else { return Ok(()) };
    match code.number {
        number @ 1..=3 => words
            .peek(b'F')
            .map_or(Ok(()), |word| motion::check_feed(word, MotionMode::from_g(number).unwrap_or_default())),
        4 => words.peek(b'F').map_or(Ok(()), motion::check_dwell),
        22 => auxiliary::check_loop(code, words, block),
        92 => motion::check_preset_words(words, code.at as usize),
        _ => Ok(()),
    }
}

/// The address letters of words, without N, G and M.
const ADDRESSES: &[u8] = b"XZUWIKRFLST";

/// Checks the format of every block: first a four-digit number, literal values, unique addresses (L1).
fn check_format(words: &BlockWords, settings: &NcSettings, (text, at): (&[u8], usize)) -> ReadResult<()> {
    let line = text.get(at..).unwrap_or_default();
    let end = line.iter().position(|byte| matches!(byte, b'\r' | b'\n' | b';' | b'(')).unwrap_or(line.len());
    if let Some(place) = line[..end].iter().position(|byte| matches!(byte, b'#' | b'[')) {
        return fail(at + place, E::NoMacros);
    }
    let first = line.iter().position(|byte| !matches!(byte, b' ' | b'\t')).unwrap_or(0);
    let numbered = matches!(line.get(first), Some(b'N' | b'n'));
    if words.block_number.is_some() && !numbered {
        let place = line[..end].iter().position(|byte| matches!(byte, b'N' | b'n')).unwrap_or(0);
        return fail(at + place, E::BlockNumberNotFirst);
    }
    if let Some(place) = words.address_only {
        return fail1(place as usize, E::MissingNumber, letter_at(text, place));
    }
    if let Some(place) = words.duplicate {
        return fail1(place as usize, E::DoubleWord, letter_at(text, place));
    }
    let digits = number_digits(line, first).len();
    // D: the manual prints N016 once; a number of three digits is accepted with a warning.
    let as_printed = digits == BLOCK_NUMBER_DIGITS || digits + 1 == BLOCK_NUMBER_DIGITS;
    match words.block_number {
        None if settings.needs_block_numbers => fail(at + first, E::BlockNumberMissing),
        Some(n) if n > MAX_BLOCK_NUMBER || settings.needs_block_numbers && !as_printed => {
            fail2(at + first, E::BlockNumberDigits, written_number(line, first), expected_number(n))
        }
        None | Some(_) => Ok(()),
    }
}

/// The digits after the N at byte `first`.
fn number_digits(line: &[u8], first: usize) -> &[u8] {
    let rest = line.get(first + 1..).unwrap_or_default();
    &rest[..rest.iter().take_while(|byte| byte.is_ascii_digit()).count()]
}

fn written_number(line: &[u8], first: usize) -> Arg {
    format_args!("N{}", str::from_utf8(number_digits(line, first)).unwrap_or_default()).into()
}

/// The correct form of a block number.
fn expected_number(n: u32) -> Arg {
    if n > MAX_BLOCK_NUMBER {
        format_args!("N0000–N{MAX_BLOCK_NUMBER}").into()
    } else {
        format_args!("N{n:04}").into()
    }
}

/// A three-digit block number as written, and with four digits.
fn short_block_number(text: &[u8], at: usize) -> Option<(Arg, Arg)> {
    let line = text.get(at..)?;
    let first = line.iter().position(|byte| !matches!(byte, b' ' | b'\t'))?;
    let short = number_digits(line, first).len() + 1 == BLOCK_NUMBER_DIGITS;
    (short && matches!(line.get(first), Some(b'N' | b'n'))).then(|| {
        let written = written_number(line, first);
        let full = format_args!("N0{}", &written.as_name()[1..]).into();
        (written, full)
    })
}

/// The only G code of a block.
fn single_g_code(words: &BlockWords) -> ReadResult<Option<Code>> {
    if let Some(code) = words.g.iter().find(|code| !G_CODES.contains(&code.number)) {
        return codes::refuse_unknown(*code, 'G', 2, G_CODES.iter().copied());
    }
    match words.g[..] {
        [] => Ok(None),
        [code] => Ok(Some(code)),
        [first, second, ..] if first.number == second.number => {
            fail1(second.at as usize, E::DoubleWord, second.name('G', 2))
        }
        [first, second, ..] => fail2(second.at as usize, E::NotTogether, first.name('G', 2), second.name('G', 2)),
    }
}

/// Executes the G function of the block, else the modal one if there are coordinates.
fn execute_g_code(running: &mut BlockContext<'_, '_>, code: Option<Code>) -> ReadResult<Option<FlowAction>> {
    let place = code.map_or(running.at, |code| code.at as usize);
    if let Some(code) = code {
        match code.number {
            4 => motion::dwell(running, place)?,
            22 => return auxiliary::begin_loop(running, place).map(Some),
            26 | 27 | 29 => motion::return_to_tool_change(running, code)?,
            36 | 37 | 39 => motion::home(running, code)?,
            80 => return Ok(Some(FlowAction::EndCountedLoop { at: place })),
            92 => motion::set_coordinate_system(running, place)?,
            number => {
                running.modals.motion = MotionMode::from_g(number).unwrap_or_default();
                modal_move(running, place, true)?;
            }
        }
        return Ok(None);
    }
    modal_move(running, place, false).map(|()| None)
}

/// Executes the modal function with the words of the block; `named`: its G code is in the block.
fn modal_move(running: &mut BlockContext<'_, '_>, place: usize, named: bool) -> ReadResult<()> {
    let by_arc = matches!(running.modals.motion, MotionMode::ArcClockwise | MotionMode::ArcCounterClockwise)
        && running.words.has_any(letter_mask(b"IKR"));
    let moves = running.words.has_any(AXIS_WORDS) || by_arc;
    let threads = matches!(running.modals.motion, MotionMode::InchThread | MotionMode::MetricThread);
    if threads {
        return if moves || named { thread::execute(running, place) } else { Ok(()) };
    }
    let feed = motion::take_feed(running)?;
    if !moves {
        return match running.modals.motion {
            MotionMode::RectangleCycle if named => fail2(place, E::MissingWord, "G23", "X / U, Z / W"),
            _ => Ok(()),
        };
    }
    match running.modals.motion {
        MotionMode::Feed => motion::line(running),
        MotionMode::ArcClockwise => motion::arc_move(running, place, -1),
        MotionMode::ArcCounterClockwise => motion::arc_move(running, place, 1),
        MotionMode::RectangleCycle => motion::rectangle(running, place),
        _ => motion::rapid(running, feed),
    }
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> ReadResult<u32> {
    let name = char::from(word.letter);
    if word.kind != ValueKind::Integer {
        return fail1(word.at as usize, E::NotWhole, name);
    }
    match whole_number(word.value) {
        Some(value) if (i64::from(low)..=i64::from(high)).contains(&value) => Ok(value as u32),
        Some(_) | None => out_of_range(word, format_args!("{low}–{high}")),
    }
}
