//! The KT-820/KT-830 dialect: lathe system A on GC, modal G90/G91 on GS and GA.
//!
//! Order within a block (DECISION): modes, work offset, T, S, M codes that act before the motion, the move, dwell or
//! G50, M codes that act after the motion, then the jump or call. Source: spec B2, B4, K1, K3.14, K3.15.

mod auxiliary;
mod calls;
mod codes;
mod coordinates;
mod cycles;
mod data_input;
mod grinding;
mod index;
mod macro_a;
mod motion;

use super::codes::BlockCodes;
use super::common::{self, MAX_VALUE, out_of_range};
use super::rules::{BlockContext, DialectRow, DialectRules, FlowAction, PreflightScope, UnexecutedBlock};
use crate::defs::kind::Dialect;
use crate::defs::program_number::{self, O_DIGITS, O_MAX_DIGITS, o_limit};
use crate::nc::contour::PendingCycle;
use crate::nc::fault::{Capitals, E, ReadResult, fail1, fail2};
use crate::nc::flow::{CallLimit, Callee};
use crate::nc::modal::{ModalCodes, MotionMode};
use crate::nc::settings::NcSettings;
use crate::nc::source_index::o_number;
use crate::nc::words::{BlockWords, Code, ValueKind, Word, letter_mask};
use crate::units::{Axis, MM_PER_INCH, PerAxis};

/// GC: lathe system A. With `MILL`, GS and GA: modal G90 and G91, three axes in radius.
pub(super) struct Grinder<const MILL: bool>;

impl<const MILL: bool> DialectRules for Grinder<MILL> {
    const ROW: DialectRow = DialectRow {
        settings: || match MILL {
            false => NcSettings::two_axes(Dialect::LatheA),
            true => NcSettings { diameter: false, axes: PerAxis([true; 3]), ..NcSettings::two_axes(Dialect::Mill) },
        },
        modal_codes: ModalCodes { distance_is_modal: MILL, ..ModalCodes::SYSTEM_A },
        index: index::index,
        check_unexecuted,
        executes_lone_blocks: true,
        called_program: |_| None,
        call_in_text,
        call_text: |program| Some(format!("M98 P{program}")),
        program_heading: |line| o_number(line).map(|(number, _)| (number, None)),
        new_program_text: |number| format!("O{number:04}\r\n\r\nM30\r\n"),
        call_limit: |callee| match callee {
            Callee::Macro | Callee::CycleWithoutFeed => CallLimit { depth: MACRO_DEPTH, name: "G65/G66" },
            Callee::Sub => CallLimit { depth: SUB_DEPTH, name: "M98" },
        },
        preflight_scope: PreflightScope::Unsupported,
        required_end_code: None,
        refused_words: &[],
        has_labels: false,
        has_macros: true,
    };

    #[inline]
    fn execute(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
        if let Some((code, program)) = calls::code_macro(running) {
            return calls::call_by_code(running, code, program);
        }
        let plan = codes::read_g_codes(running)?;
        codes::extra_work_offset(running, &plan)?;
        if let Some(at) = running.words.address_only
            && !(plan.is_one_shot(27) && running.words.address_only_among(b"XYZ"))
        {
            return missing_number(running, at);
        }
        // Its words are arguments.
        if plan.is_one_shot(65) || plan.modal_call.is_some_and(|call| call.number == 66) {
            return calls::macro_call(running, &plan);
        }
        common::refuse_duplicate_address(running)?;
        if let Some(word) = running.words.take(b'O').filter(|word| !is_program_number(word.value)) {
            return out_of_range(word, format_args!("1–{}", program_number::O_MAX));
        }
        calls::refuse_arguments_of_m98(running)?;
        apply_modes(running, &plan)?;
        running.words.take(b'T');
        if running.second_half {
            return execute_remainder(running, &plan);
        }
        if plan.compensation.is_some_and(|code| code.number == 40) {
            // Before a T of the block.
            running.modals.compensation = None;
        }
        auxiliary::tool_call(running)?;
        if !changes_coordinates(running, &plan) {
            return execute_remainder(running, &plan);
        }
        common::split_block(running, |running| execute_remainder(running, &plan))
    }
}

/// Deepest nesting of M98, and of G65 and G66.
const SUB_DEPTH: usize = 4;
const MACRO_DEPTH: usize = 4;

/// The programs that a line may call.
fn call_in_text(code: &str) -> Vec<u32> {
    let calls = ["M98", "G65", "G66"].iter().any(|word| code.contains(word));
    let calculates = code.contains("G65") && code.contains('H');
    let Some(behind) = code.split('P').nth(1).filter(|_| calls && !calculates) else { return Vec::new() };
    let digits = behind.bytes().take_while(u8::is_ascii_digit).count();
    let Ok(number) = behind[..digits].parse::<u32>() else { return Vec::new() };
    // B3: P may hold a repeat count before the number; how many digits are the number, P418 says.
    let own = (O_DIGITS..=O_MAX_DIGITS).map(|digits| number % (o_limit(digits) + 1));
    let mut found: Vec<u32> = own.filter(|number| *number > 0 && digits <= O_MAX_DIGITS as usize).collect();
    found.dedup();
    found
}

/// The letters X Y Z U V W.
const AXIS_WORDS: u32 = letter_mask(b"XYZUVW");

/// Executes what follows the modes, the work offset and the tool.
fn execute_remainder(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<FlowAction> {
    let offset = plan.compensation.filter(|code| code.number != 40).and_then(|_| running.words.take(b'D'));
    let offset = offset.map(|word| integer(word, 0, running.settings.tool_count)).transpose()?;
    common::set_compensation(running, plan, (offset, running.words.has(b'T')))?;
    if let (Some(active), Some(code)) = (running.modals.compensation, plan.one_shot)
        && active.cutter.radius_mm > 0.0
        && cycles::is_grooving(code.number)
    {
        return fail1(code.at as usize, E::NotInCompensation, format_args!("G{}", active.g()));
    }
    auxiliary::spindle_speed(running, plan)?;
    let flow = auxiliary::before_motion(running)?;
    match plan.one_shot {
        Some(code) if cycles::is_contour_cycle(code.number) => {
            let block_start = running.flow.place;
            *running.pending_cycle =
                cycles::contour_cycle(running, code)?.map(|cycle| PendingCycle { cycle, block_start });
        }
        _ => execute_one_shot_or_move(running, plan)?,
    }
    auxiliary::after_motion(running)?;
    if let Some(unused) = running.words.unused() {
        return unknown_word(running, plan, unused);
    }
    if matches!(flow, FlowAction::Next)
        && let Some(call) = plan.modal_call
        && call.number == 67
    {
        return Ok(FlowAction::SetModalCall(None));
    }
    Ok(flow)
}

/// Checks the codes of a block that is not executed.
fn check_unexecuted(words: &BlockWords, block: &UnexecutedBlock<'_>) -> ReadResult<()> {
    for code in words.g.iter() {
        codes::look_up(*code, block.settings.is_mill())?;
    }
    match words.m.iter().find(|code| !crate::defs::mcode::is_known(code.number)) {
        Some(code) => fail1(code.at as usize, E::UnknownM, format_args!("M{}", code.number)),
        None => Ok(()),
    }
}

/// Sets feed, path mode and work offset.
#[inline]
fn apply_modes(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    // The F of G27 and G78 is not modal.
    if !(plan.is_one_shot(27) || plan.is_one_shot(78)) {
        let mm = if running.modals.inch { MM_PER_INCH } else { 1.0 };
        common::set_feed(running, mm)?;
    }
    plan.push_modes(running);
    Ok(())
}

/// Whether the block changes its work offset or tool offset and also moves.
#[inline]
fn changes_coordinates(running: &BlockContext<'_, '_>, plan: &BlockCodes) -> bool {
    let moves = running.words.has_any(AXIS_WORDS) && !plan.is_one_shot(4);
    moves && !plan.is_one_shot(10) && !plan.is_one_shot(52) && (plan.work_offset || running.words.has(b'T'))
}

fn execute_one_shot_or_move(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    match plan.one_shot {
        // M35 has used the axis words.
        None if running.words.m.iter().any(|code| code.number == 35) => Ok(()),
        None => motion::modal_move(running, plan),
        Some(code) if code.number == 9 => motion::exact_stop_move(running, plan),
        Some(code) => reading_of(code.number).map_or(Ok(()), |read| read(running, code)),
    }
}

/// Reads the words of a one-shot function and pushes its operations.
type OneShot = fn(&mut BlockContext<'_, '_>, Code) -> ReadResult<()>;

/// How a one-shot function is read; each file knows its own. Contour cycles and calls change the flow: not here.
fn reading_of(code: u32) -> Option<OneShot> {
    motion::reading_of(code)
        .or_else(|| grinding::reading_of(code))
        .or_else(|| data_input::reading_of(code))
        .or_else(|| cycles::reading_of(code))
}

/// The unit of lengths without a decimal point, in the programmed unit; `None`: they are millimetres or inches.
/// A least increment is 0.001 mm or 0.0001 inch (FANUC increment system IS-B).
fn least_increment(running: &BlockContext<'_, '_>) -> Option<f64> {
    let least = running.settings.least_increment_mm?;
    Some(if running.modals.inch { least / 10.0 } else { least })
}

/// The length of a word in millimetres; applies inches and least increment.
#[inline]
fn length_mm(running: &BlockContext<'_, '_>, word: Word) -> ReadResult<f64> {
    let mut value = word.value;
    if word.kind == ValueKind::Integer
        && let Some(least) = least_increment(running)
    {
        value *= least;
    }
    if running.modals.inch {
        value *= MM_PER_INCH;
    }
    if value.abs() > MAX_VALUE { out_of_range(word, "±99999.999") } else { Ok(value) }
}

/// The value of a word that must be a whole number in a range.
fn integer(word: Word, low: u32, high: u32) -> ReadResult<u32> {
    common::integer(char::from(word.letter), word, low, high)
}

#[cold]
fn missing_number<T>(running: &BlockContext<'_, '_>, at: u32) -> ReadResult<T> {
    fail1(at as usize, E::MissingNumber, Capitals(common::address_at(running.text, at)))
}

/// Reports an unknown word, or an axis word that the one-shot function does not use.
#[cold]
fn unknown_word<T>(running: &BlockContext<'_, '_>, plan: &BlockCodes, word: Word) -> ReadResult<T> {
    if AXIS_WORDS & letter_mask(&[word.letter]) != 0
        && let Some(once) = plan.one_shot
    {
        return fail1(word.at as usize, E::AxisUnused, once.name('G', 2));
    }
    let has_corners = running.modals.motion == MotionMode::Feed && plan.one_shot.is_none();
    let size = match word.letter {
        // A rotary axis, not an angle or a chamfer.
        b'A' | b'C' if !has_corners || running.settings.is_mill() || word.letter == b'C' && word.value <= 0.0 => {
            return fail1(word.at as usize, E::NoAxis, char::from(word.letter));
        }
        b'B' => return fail1(word.at as usize, E::NoAxis, "B"),
        b'A' | b'C' | b'R' => Some((char::from(word.letter), word.value)),
        // Their sign says where the next line goes: the contour knows it.
        b'I' | b'K' => Some(('C', word.value.abs())),
        _ => None,
    };
    if let Some((letter, size)) = size.filter(|_| has_corners) {
        return fail2(
            word.at as usize,
            E::CommaMissing,
            format_args!("{}{}", char::from(word.letter), word.value),
            format_args!(",{letter}{size}"),
        );
    }
    if let Some(code) =
        running.words.m.first().filter(|_| running.words.g.is_empty() && !is_axis_or_motion(word.letter))
    {
        let text = format_args!("{}{}", char::from(word.letter), word.value);
        return fail2(word.at as usize, E::MCodeWord, code.name('M', 2), text);
    }
    common::unknown_word(running.text, word)
}

/// Letters of moves: the function of group 01 that acts would have them.
const fn is_axis_or_motion(letter: u8) -> bool {
    (AXIS_WORDS | letter_mask(b"IJKRF")) & letter_mask(&[letter]) != 0
}

/// The address letters of an axis: absolute and incremental.
#[inline]
const fn axis_letters(axis: Axis) -> [u8; 2] {
    match axis {
        Axis::X => [b'X', b'U'],
        Axis::Y => [b'Y', b'V'],
        Axis::Z => [b'Z', b'W'],
    }
}

/// Whether an O word can name a program.
fn is_program_number(value: f64) -> bool {
    (1.0..=f64::from(program_number::O_MAX)).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::{cycles, reading_of};
    use crate::defs::gcode::{Availability, G_CODES, GCodeGroup};

    #[test]
    fn b2_every_one_shot_function_of_the_table_has_a_reading() {
        for row in G_CODES.iter().filter(|row| row.group == GCodeGroup::NonModal) {
            let code = u32::from(row.code);
            let read = reading_of(code).is_some() || cycles::is_contour_cycle(code) || [9, 65].contains(&code);
            let exists = [row.lathe, row.mill].contains(&Availability::Yes);
            assert_eq!(read, exists, "G{code:02}");
        }
    }
}
