//! The SINUMERIK 802D dialect, as far as the vertical lathe-grinder's programs use it: R parameters, `X=R20`, labels,
//! `IF … GOTOF`, `MSG("…")`, `L10 P3`.
//!
//! `read` turns a line into words or a statement, `expression` evaluates, `codes` checks the codes, `motion` returns
//! operations. Order within a block: R assignments, modes and work offset, S, M codes that act before the motion, the
//! move or dwell, M codes that act after the motion, then the call or return. Source: spec S1.

mod codes;
mod expression;
mod index;
mod keyword;
mod motion;
mod read;

pub(super) use expression::function_names;

use super::codes::{self as shared_codes, BlockCodes};
use super::common;
use super::rules::{BlockContext, DialectRow, DialectRules, FlowAction, PreflightScope};
use crate::defs::kind::Dialect;
use crate::defs::program_number::{self, L_MAX};
use crate::defs::text::arg::Arg;
use crate::nc::expression::Scope;
use crate::nc::fault::{Capitals, E, ReadResult, fail1, fail2};
use crate::nc::flow::{Call, CallLimit, Callee};
use crate::nc::functions::whole_u32;
use crate::nc::modal::ModalCodes;
use crate::nc::op::Op;
use crate::nc::settings::NcSettings;
use crate::nc::statement::{BlockContent, BlockReader};
use crate::nc::words::{
    BlockWords, CHAMFER, CHAMFER_LENGTH, Code, LINE_ANGLE, MODAL_ROUNDING, ROUNDING, ValueKind, Word,
};
use crate::units::MM_PER_INCH;

/// The vertical lathe-grinder.
pub(super) struct Sinumerik;

impl DialectRules for Sinumerik {
    const ROW: DialectRow = DialectRow {
        settings: || NcSettings {
            exact_stop: true,
            starts_with_feed: true,
            ..NcSettings::two_axes(Dialect::Sinumerik)
        },
        modal_codes: ModalCodes {
            distance_is_modal: true,
            per_minute: 94,
            per_rev: 95,
            inch: 70,
            metric: 71,
            exact_stop: 60,
        },
        index: index::index,
        check_unexecuted: |words, block| check_unexecuted(words, block.source.bytes()),
        executes_lone_blocks: true,
        called_program,
        call_in_text: |_| Vec::new(),
        call_text: |program| program_number::is_l_number(program).then(|| program_number::name_of(program)),
        program_heading: index::program_heading,
        new_program_text: |number| format!("O{number:04}\r\n\r\nM30\r\n"),
        call_limit: |_| CallLimit { depth: L_DEPTH, name: "L" },
        preflight_scope: PreflightScope::TextOnly,
        required_end_code: None,
        refused_words: &read::FOREIGN_WORDS,
        has_labels: true,
        has_macros: true,
    };

    #[inline]
    fn read_block<S: Scope>(reader: BlockReader<'_, '_, S>) -> ReadResult<BlockContent> {
        read::read_block(reader)
    }

    #[inline]
    fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        let plan = codes::read_g_codes(running)?;
        common::refuse_duplicate_address(running)?;
        if let Some(call) = running.words.take(b'L') {
            return subprogram(running, &plan, call);
        }
        refuse_machine_axis(running, &plan)?;
        apply_modes(running, &plan)?;
        if keyword::translate(running)? {
            return running.words.unused().map_or(Ok(FlowAction::Next), |word| unknown_word(running.text, word));
        }
        let changes_tool = tool_call(running)?;
        if running.second_half || !((plan.work_offset || changes_tool) && motion::names_axes(running)) {
            return execute_remainder(running, &plan);
        }
        common::split_block(running, |running| execute_remainder(running, &plan))
    }
}

/// Deepest nesting of L calls: eight levels with the main program (DECISION).
const L_DEPTH: usize = 7;

/// Checks a block that is not executed: known codes, unique and known addresses, a call in a block of its own.
fn check_unexecuted(words: &BlockWords, text: &[u8]) -> ReadResult<()> {
    codes::check_codes(words)?;
    if let Some(at) = words.duplicate {
        return fail1(at as usize, E::DoubleWord, common::letter_at(text, at));
    }
    if let Some(call) = words.peek(b'L') {
        return check_call_alone(words, call);
    }
    let is_known = |letter: u8| ADDRESSES.contains(&letter) || LONG_ADDRESSES.iter().any(|(_, long)| *long == letter);
    match words.list.iter().find(|word| !is_known(word.letter)) {
        Some(word) => unknown_word(text, *word),
        None => check_exclusive_words(words),
    }
}

/// Words of a block that exclude each other: the radius and the centre of an arc, the words of a corner.
const EXCLUSIVE_WORDS: [&[u8]; 3] = [&[CR_ADDRESS, b'I'], &[CR_ADDRESS, b'K'], &[CHAMFER, CHAMFER_LENGTH, ROUNDING]];

/// Refuses words that exclude each other, and increments with G53 or G153, whose coordinates are the machine's.
fn check_exclusive_words(words: &BlockWords) -> ReadResult<()> {
    for letters in EXCLUSIVE_WORDS {
        let mut found = letters.iter().filter_map(|letter| words.peek(*letter));
        if let (Some(first), Some(second)) = (found.next(), found.next()) {
            return fail2(second.at as usize, E::NotTogether, address_name(first), address_name(second));
        }
    }
    let Some(machine) = words.g.iter().find(|code| matches!(code.number, 53 | 153)) else { return Ok(()) };
    let is_incremental = |word: &&Word| {
        b"XYZ".contains(&word.letter)
            && words.is_incremental(word.letter).unwrap_or_else(|| words.g.iter().any(|code| code.number == 91))
    };
    match words.list.iter().find(is_incremental) {
        Some(word) => fail2(word.at as usize, E::NotTogether, machine.name('G', 0), "G91 / IC"),
        None => Ok(()),
    }
}

/// The address letters of words, without N, G, M and L.
const ADDRESSES: &[u8] = b"XYZIJKFSTD";

/// Refuses a call that is not in a block of its own.
fn check_call_alone(words: &BlockWords, call: Word) -> ReadResult<()> {
    let name = || Arg::from(format_args!("L{}", call.value));
    let (g, m) = (words.g.first().map(|code| (code, 'G')), words.m.first().map(|code| (code, 'M')));
    if let Some((code, letter)) = g.or(m) {
        return fail2(code.at as usize, E::NotTogether, name(), code.name(letter, 0));
    }
    match words.list.iter().find(|word| !matches!(word.letter, b'L' | b'P')) {
        Some(word) => fail2(word.at as usize, E::NotTogether, name(), address_name(*word)),
        None => Ok(()),
    }
}

/// The subprogram that a block calls, and the byte of the call. `P0` does not call; `P=R32` is known only in the run.
fn called_program(words: &BlockWords) -> Option<(u32, usize)> {
    let call = words.peek(b'L')?;
    let never = words.peek(b'P').is_some_and(|word| word.kind != ValueKind::Integer || word.value <= 0.0);
    let number = whole_u32(call.value)?;
    (!never && number <= L_MAX).then(|| (program_number::from_l(number), call.at as usize))
}

/// Most repetitions of a subprogram.
const MAX_REPEATS: u32 = 9_999;
/// The internal letter of `CR=`; R itself is never a word.
const CR_ADDRESS: u8 = b'R';
/// The internal letter of `LIMS=`, the one behind Z.
const LIMS_ADDRESS: u8 = b'[';
/// The addresses of several letters.
const LONG_ADDRESSES: [(&str, u8); 7] = [
    ("CR", CR_ADDRESS),
    ("LIMS", LIMS_ADDRESS),
    ("CHF", CHAMFER_LENGTH),
    ("CHR", CHAMFER),
    ("RND", ROUNDING),
    ("RNDM", MODAL_ROUNDING),
    ("ANG", LINE_ANGLE),
];
/// The internal M code of `RET`.
const RETURN_M_CODE: u32 = 17;

/// Executes what follows the modes and the work offset.
fn execute_remainder(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<FlowAction> {
    let changes_tool = running.words.has(b'T') || running.words.has(b'D');
    common::set_compensation(running, plan, (None, changes_tool))?;
    if let Some(word) = running.words.take(LIMS_ADDRESS) {
        if !(0.0..=common::MAX_VALUE).contains(&word.value) {
            return out_of_range(word, "0–99999.999");
        }
        running.ops.push(Op::SpeedLimit { rpm: word.value });
    }
    if !plan.is_one_shot(4) {
        common::set_speed(running)?;
    }
    let flow = execute_m_codes(running, false)?;
    match plan.one_shot {
        Some(code) => motion::one_shot(running, plan, code)?,
        None => motion::modal_move(running, plan)?,
    }
    execute_m_codes(running, true)?;
    running.words.unused().map_or(Ok(flow), |word| unknown_word(running.text, word))
}

/// Sets feed, path mode and work offset. The F of a dwell is a time.
fn apply_modes(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    keyword::apply_modes(running);
    if let Some(word) = running.words.take(MODAL_ROUNDING) {
        let mm = word.value * if running.modals.inch { MM_PER_INCH } else { 1.0 };
        if !(0.0..=common::MAX_VALUE).contains(&mm) {
            return out_of_range(word, "0–99999.999");
        }
        running.modals.rounding = (mm > 0.0).then_some(mm);
    }
    if !plan.is_one_shot(4) {
        let mm = if running.modals.inch_feed { MM_PER_INCH } else { 1.0 };
        common::set_feed(running, mm)?;
    }
    plan.push_modes(running);
    Ok(())
}

/// `T1 D2`: tool, and the edge, here the number of the tool offset (DECISION). A tool without D has D1; D0 cancels the
/// offset. True: the block has one.
fn tool_call(running: &mut BlockContext<'_, '_>) -> ReadResult<bool> {
    let (tool, edge) = (running.words.take(b'T'), running.words.take(b'D'));
    if tool.is_none() && edge.is_none() || running.second_half {
        return Ok(false);
    }
    let count = running.settings.tool_count;
    let number = tool.map(|word| integer(word, 0, count)).transpose()?;
    let offset = match (edge, number) {
        (Some(word), _) => integer(word, 0, count)?,
        (None, Some(0)) => 0,
        (None, _) => 1,
    };
    let (tool, offset) = (number.unwrap_or(0) as u16, offset as u16);
    if tool != 0 {
        running.modals.tool = tool;
    }
    running.modals.offset = offset;
    running.ops.push(Op::T { tool, offset });
    Ok(true)
}

/// `X1=…` names an axis of the machine, in G74 and G75 only.
fn refuse_machine_axis(running: &BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    match keyword::find(running.words, keyword::Keyword::MachineAxis) {
        Some(at) if !plan.is_one_shot(74) && !plan.is_one_shot(75) => {
            fail1(at, E::UnknownWord, format_args!("{}1", common::letter_at(running.text, at as u32)))
        }
        Some(_) | None => Ok(()),
    }
}

/// `L10 P3`: calls a subprogram P times, not at all if P is 0. It must be in a block of its own.
fn subprogram(running: &BlockContext<'_, '_>, plan: &BlockCodes, call: Word) -> ReadResult<FlowAction> {
    let words = running.words;
    let times = words.take(b'P').map_or(Ok(1), |word| integer(word, 0, MAX_REPEATS))?;
    let program = program_number::from_l(integer(call, 0, L_MAX)?);
    check_call_alone(words, call)?;
    assert!(!plan.work_offset && !plan.path_mode, "without G codes there is nothing to change");
    let at = call.at as usize;
    Ok(match times {
        0 => FlowAction::Next,
        times => FlowAction::Call(Call { program, times, callee: Callee::Sub, at }),
    })
}

/// Checks the M codes, adds those that act before (or after) the motion, and returns how the program continues.
fn execute_m_codes(running: &mut BlockContext<'_, '_>, after: bool) -> ReadResult<FlowAction> {
    let words = running.words;
    let mut flow = FlowAction::Next;
    codes::check_exclusive_m_codes(words)?;
    let ends = |code: &&Code| matches!(code.number, 2 | RETURN_M_CODE | 30);
    // `M5 M30`, in either order: the end comes last.
    for code in words.m.iter().filter(|code| !ends(code)).chain(words.m.iter().filter(ends)) {
        check_m_code(*code)?;
        flow = match code.number {
            // Every end of a subprogram except M30 returns to its caller.
            2 | RETURN_M_CODE if !running.flow.is_main() => FlowAction::Return { target: None, at: code.at as usize },
            2 | RETURN_M_CODE | 30 => FlowAction::End,
            _ => flow,
        };
        if after == (code.number == RETURN_M_CODE || shared_codes::acts_after_motion(code.number)) {
            push_m_code(running, *code);
        }
    }
    Ok(flow)
}

fn push_m_code(running: &mut BlockContext<'_, '_>, code: Code) {
    let code = match code.number {
        2 | RETURN_M_CODE if !running.flow.is_main() => return,
        RETURN_M_CODE => 2,
        number => number as u8,
    };
    running.modals.m_code = Some(code);
    running.ops.push(Op::M { code, s: None, p: None, l: None });
}

/// Accepts the M codes of the machine and M17; the error lists the valid codes.
fn check_m_code(code: Code) -> ReadResult<()> {
    let exists = |number: u32| u16::try_from(number).is_ok_and(|code| Dialect::Sinumerik.m_code(code).is_some());
    if code.number == RETURN_M_CODE || exists(code.number) {
        return Ok(());
    }
    let known = (0..100).filter(|number| *number == RETURN_M_CODE || exists(*number));
    shared_codes::refuse_unknown(code, 'M', 0, known)
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> ReadResult<u32> {
    common::integer(address_name(word), word, low, high)
}

/// The address of a word as written.
fn address_name(word: Word) -> &'static str {
    const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    let index = usize::from(word.letter.wrapping_sub(b'A'));
    match LONG_ADDRESSES.iter().find(|(_, letter)| *letter == word.letter) {
        Some((name, _)) => name,
        None => LETTERS.get(index..=index).unwrap_or_default(),
    }
}

#[cold]
fn out_of_range<T>(word: Word, range: impl Into<Arg>) -> ReadResult<T> {
    common::out_of_range_as(address_name(word), word, range)
}

/// Reports an unknown word, as written up to the next blank.
#[cold]
fn unknown_word<T>(text: &[u8], word: Word) -> ReadResult<T> {
    let at = word.at as usize;
    if matches!(word.letter, b'A' | b'B' | b'C' | b'U' | b'V' | b'W') {
        return fail1(at, E::NoAxis, char::from(word.letter));
    }
    let rest = text.get(at..).unwrap_or_default();
    let length = rest.iter().position(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b';')).unwrap_or(rest.len());
    fail1(at, E::UnknownWord, Capitals(&rest[..length]))
}
