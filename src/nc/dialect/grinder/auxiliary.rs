//! S, T and M. Source: spec B2, B4, K3.4, K3.14, K3.15, K5.11.

use super::{MAX_VALUE, integer};
use crate::defs::mcode;
use crate::defs::text::arg::Arg;
use crate::nc::dialect::codes::{self, BlockCodes};
use crate::nc::dialect::common::{in_range, missing_word, out_of_range, set_speed};
use crate::nc::dialect::rules::{BlockContext, FlowAction};
use crate::nc::expression::Scope;
use crate::nc::fault::{E, ReadResult, fail, fail1, fail2};
use crate::nc::flow::{Call, Callee};
use crate::nc::op::Op;
use crate::nc::words::Code;

/// Highest block number and packed P of M98.
const MAX_BLOCK_NUMBER: u32 = 99_999_999;
/// Most repetitions of a subprogram.
pub(super) const MAX_REPEATS: u32 = 9_999;
/// Number of input and output ports.
const PORT_COUNT: u32 = 64;

/// T: tool and offset.
pub(super) fn tool_call(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let Some(word) = running.words.take(b'T') else { return Ok(()) };
    let count = running.settings.tool_count;
    let value = integer(word, 0, 9_999)?;
    let (tool, offset) = (value / 100, value % 100);
    if tool == 0 && (1..=count).contains(&offset) {
        return fail2(
            word.at as usize,
            E::ToolWithoutOffset,
            format_args!("{}", word.value),
            format_args!("{offset:02}"),
        );
    }
    if tool > count || offset > count || (tool == 0 && offset != 0) {
        let expected = format_args!("Txxyy xx 1–{count} yy 0–{count}");
        let name: Arg = match tool {
            0 => format_args!("T{}", word.value).into(),
            _ => format_args!("T{value:04}").into(),
        };
        return fail2(word.at as usize, E::OutOfRange, name, expected);
    }
    let modals = &mut *running.modals;
    let tool = tool as u16;
    if tool != 0 && modals.tool != 0 && tool != modals.tool {
        modals.several_tools = true;
        if modals.g50_used {
            return fail(word.at as usize, E::G50WithTools);
        }
    }
    if tool != 0 {
        modals.tool = tool;
    }
    modals.offset = offset as u16;
    running.ops.push(Op::T { tool, offset: offset as u16 });
    Ok(())
}

/// S, unless an M code uses it.
pub(super) fn spindle_speed(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<()> {
    // K3.4: M63 S drives the second analog output; G50 S is a limit.
    if plan.is_one_shot(50) || plan.is_one_shot(92) || running.words.m.iter().any(|code| takes_s(code.number)) {
        return Ok(());
    }
    set_speed(running)
}

const fn takes_s(code: u32) -> bool {
    matches!(code, 63 | 64)
}

/// Codes that must be the only M code of a block: they use P and L, or end the program, or jump.
const fn stands_alone(code: u32) -> bool {
    matches!(code, 0 | 1 | 2 | 20..=22 | 30 | 91 | 92 | 98 | 99)
}

/// Checks the M codes, adds those that act before the motion, and returns how the program continues.
pub(super) fn before_motion(running: &mut BlockContext<'_, '_>) -> ReadResult<FlowAction> {
    let words = running.words;
    let mut flow = FlowAction::Next;
    for code in words.m.iter() {
        if !mcode::is_known(code.number) {
            return fail1(code.at as usize, E::UnknownM, format_args!("M{}", code.number));
        }
        if stands_alone(code.number) {
            codes::check_stands_alone(words, *code, 2)?;
        }
        running.modals.m_code = Some(code.number as u8);
        match code.number {
            // `M01 L n` continues at block n.
            1 => {
                if let Some(word) = words.take(b'L') {
                    flow = FlowAction::Goto { n: integer(word, 0, MAX_BLOCK_NUMBER)?, at: word.at as usize };
                }
            }
            2 | 30 => flow = FlowAction::End,
            91 | 92 => flow = input_jump(running, *code)?,
            98 => flow = subprogram(running, *code)?,
            99 => flow = return_from_subprogram(running, *code)?,
            35 => super::grinding::oscillation_by_m_code(running, *code)?,
            36 => running.ops.push(Op::OscillationOff),
            number if !codes::acts_after_motion(number) => push_m_code(running, *code)?,
            _ => {}
        }
    }
    Ok(flow)
}

/// Adds the M codes that act after the motion.
pub(super) fn after_motion(running: &mut BlockContext<'_, '_>) -> ReadResult<()> {
    let words = running.words;
    for code in words.m.iter() {
        let jumps = code.number == 1 && words.has(b'L');
        if codes::acts_after_motion(code.number) && !jumps {
            push_m_code(running, *code)?;
        }
    }
    Ok(())
}

fn push_m_code(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<()> {
    let words = running.words;
    let number = code.number;
    let s = if takes_s(number) {
        words.take(b'S').map(|word| in_range(word, (0.0, MAX_VALUE), "")).transpose()?
    } else {
        None
    };
    let (mut p, mut l) = (None, None);
    if (20..=22).contains(&number) {
        let name = || Arg::from(format_args!("M{number}"));
        let Some(port) = words.take(b'P') else { return fail2(code.at as usize, E::PortWordMissing, name(), "P") };
        p = Some(f64::from(integer(port, 1, PORT_COUNT)?));
        if number == 20 {
            // B4: a pulse of L milliseconds.
            let Some(millis) = words.take(b'L') else {
                return fail2(code.at as usize, E::MissingWord, name(), "L");
            };
            l = Some(in_range(millis, (0.0, MAX_VALUE), "")?);
        }
    }
    running.ops.push(Op::M { code: number as u8, s, p, l });
    Ok(())
}

/// `M91 P<in> L<block>` jumps if the input is active (low), `M92` if not; without L: P is the block.
fn input_jump(running: &mut BlockContext<'_, '_>, code: Code) -> ReadResult<FlowAction> {
    let name = || Arg::from(format_args!("M{}", code.number));
    let words = running.words;
    let Some(p) = words.take(b'P') else { return fail2(code.at as usize, E::PortWordMissing, name(), "P") };
    let (port, target) = match words.take(b'L') {
        Some(block) => (integer(p, 1, PORT_COUNT)?, block),
        None if running.settings.jump_input == 0 => return fail1(code.at as usize, E::InputNotAssigned, name()),
        None => (running.settings.jump_input, p),
    };
    let n = integer(target, 0, MAX_BLOCK_NUMBER)?;
    let value = running.scope.read(999 + port, code.at as usize)?;
    let active = value.is_some_and(|value| value.abs() > 0.5);
    let at = target.at as usize;
    Ok(if active == (code.number == 91) { FlowAction::Goto { n, at } } else { FlowAction::GotoNotTaken { n, at } })
}

/// `M98 P○○○○ L□□□□`, or both in P: `P×××○○○○`; the number has the digits of P418.
fn subprogram(running: &BlockContext<'_, '_>, code: Code) -> ReadResult<FlowAction> {
    let words = running.words;
    let Some(p) = words.take(b'P') else { return missing_word(words, code.at, "M98", b'P') };
    let packed = integer(p, 1, MAX_BLOCK_NUMBER)?;
    let limit = running.settings.program_limit;
    let (program, times) = match words.take(b'L') {
        Some(times) => (integer(p, 1, limit)?, integer(times, 1, MAX_REPEATS)?),
        None if packed > limit && packed % (limit + 1) == 0 => return out_of_range(p, "×××○○○○"),
        None if packed > limit => (packed % (limit + 1), packed / (limit + 1)),
        None => (packed, 1),
    };
    Ok(FlowAction::Call(Call { program, times, callee: Callee::Sub, at: p.at as usize }))
}

fn return_from_subprogram(running: &BlockContext<'_, '_>, code: Code) -> ReadResult<FlowAction> {
    let target = running.words.take(b'P').map(|word| integer(word, 0, MAX_BLOCK_NUMBER)).transpose()?;
    Ok(FlowAction::Return { target, at: code.at as usize })
}
