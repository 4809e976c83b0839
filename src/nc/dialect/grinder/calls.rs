//! G65 and G66 with their arguments. Source: spec B3.

use super::auxiliary::MAX_REPEATS;
use super::{integer, least_increment, macro_a};
use crate::nc::dialect::codes::BlockCodes;
use crate::nc::dialect::common::missing_word;
use crate::nc::dialect::rules::{BlockContext, FlowAction};
use crate::nc::expression::Locals;
use crate::nc::fault::{E, ReadResult, fail1, fail2};
use crate::nc::flow::{Call, Callee};
use crate::nc::modal_calls::ModalCall;
use crate::nc::settings::CodeMacros;
use crate::nc::words::{Code, ValueKind, Word};

/// Most sets of I, J, K in argument system II.
const MAX_IJK_SETS: usize = 10;

/// G65 and G66 calls, and G65 with H (calculation).
pub(super) fn macro_call(running: &mut BlockContext<'_, '_>, plan: &BlockCodes) -> ReadResult<FlowAction> {
    let words = running.words;
    let (code, name) = match (plan.one_shot, plan.modal_call) {
        (Some(once), Some(call)) => {
            return fail2(call.at as usize, E::NotTogether, once.name('G', 2), call.name('G', 2));
        }
        (Some(once), None) => (once, "G65"),
        (None, Some(call)) => (call, "G66"),
        (None, None) => return Ok(FlowAction::Next),
    };
    if let Some(m) = words.m.get(1) {
        return fail1(m.at as usize, E::DoubleWord, "M");
    }
    if let Some(other) = words.g.iter().find(|other| other.at != code.at) {
        return fail2(other.at as usize, E::NotTogether, name, other.name('G', 2));
    }
    if name == "G65" && is_macro_a_call(running) {
        words.mark_all_used();
        return macro_a::execute(running);
    }
    let Some(p) = words.take(b'P') else { return missing_word(words, code.at, name, b'P') };
    let program = integer(p, 1, running.settings.program_limit)?;
    let times = words.take(b'L').map_or(Ok(1), |word| integer(word, 1, MAX_REPEATS))?;
    *running.arguments = arguments(&words.list, |word| argument_value(running, program, word))?;
    if let Some(m) = words.m.first() {
        running.arguments[12] = Some(f64::from(m.number));
    }
    words.mark_all_used();
    Ok(if name == "G65" {
        FlowAction::Call(Call { program, times, callee: callee_of(running, program), at: p.at as usize })
    } else {
        FlowAction::SetModalCall(Some(ModalCall { program, times }))
    })
}

/// Refuses `M98 P1000 A5`: the words beside P and L belong to no code of the block, and would reach no variable.
pub(super) fn refuse_arguments_of_m98(running: &BlockContext<'_, '_>) -> ReadResult<()> {
    let words = running.words;
    if !(words.g.is_empty() && words.m.iter().any(|code| code.number == 98)) {
        return Ok(());
    }
    match words.list.iter().find(|word| matches!(word.letter, b'A'..=b'E' | b'H'..=b'K' | b'Q')) {
        Some(word) => {
            fail1(word.at as usize, E::ArgumentsByG65, format_args!("{}{}", char::from(word.letter), word.value))
        }
        None => Ok(()),
    }
}

/// The code of the block that calls a macro by its table (P420 …, P440 …), and the program.
///
/// As on FANUC, no code calls a macro within a program that a code has called: there it is the control's own. G65, G66, and
/// the M codes that change the flow of the program, call none.
#[inline]
pub(super) fn code_macro(running: &BlockContext<'_, '_>) -> Option<(Code, u32)> {
    let find = |codes: &[Code], macros: &CodeMacros, own: &[u32]| {
        let row = |code: &Code| macros.iter().find(|(number, _)| *number != 0 && u32::from(*number) == code.number);
        let called = codes.iter().find_map(|code| Some((*code, u32::from(row(code)?.1))));
        called.filter(|(code, _)| !own.contains(&code.number))
    };
    let settings = running.settings;
    let called = find(&running.words.g, &settings.g_macros, &[65, 66, 67])
        .or_else(|| find(&running.words.m, &settings.m_macros, &[2, 30, 91, 92, 98, 99]))?;
    let programs = settings.g_macros.iter().chain(&settings.m_macros).filter(|(code, _)| *code != 0);
    let is_within = programs.map(|(_, program)| u32::from(*program)).any(|program| running.flow.is_within(program));
    (!is_within).then_some(called)
}

/// The argument of P in a call by a code.
const P_ARGUMENT: usize = 16;

/// Calls the macro of a code; the other words of the block are its arguments.
pub(super) fn call_by_code(running: &mut BlockContext<'_, '_>, code: Code, program: u32) -> ReadResult<FlowAction> {
    let words = running.words;
    let name = |code: Code| code.name(if words.g.iter().any(|g| g.at == code.at) { 'G' } else { 'M' }, 2);
    if let Some(other) = words.g.iter().chain(words.m.iter()).find(|other| other.at != code.at) {
        return fail2(other.at as usize, E::NotTogether, name(code), name(*other));
    }
    let repeats = words.take(b'L');
    if let Some(word) = repeats.filter(|_| is_grinding_cycle(program)) {
        // FANUC names a wheel-wear compensation by it; a repetition would grind the same stock again.
        return fail2(word.at as usize, E::CycleRepeated, name(code), "L");
    }
    let times = repeats.map_or(Ok(1), |word| integer(word, 1, MAX_REPEATS))?;
    *running.arguments = arguments(&words.list, |word| argument_value(running, program, word))?;
    // Here P names no program: the gauge signal of a grinding cycle, a dwell.
    running.arguments[P_ARGUMENT - 1] = words.take(b'P').map(|word| word.value);
    words.mark_all_used();
    let callee = callee_of(running, program);
    Ok(FlowAction::Call(Call { program, times, callee, at: code.at as usize }))
}

/// Whether `G65 Hm` calculates. DECISION: it does if it has only P, Q and R. H is the argument #11 if P precedes it
/// and is a plain number, and H is no jump or alarm, which use a plain number.
fn is_macro_a_call(running: &BlockContext<'_, '_>) -> bool {
    let words = running.words;
    let find = |letter| words.list.iter().find(|word| word.letter == letter);
    let Some(h) = find(b'H') else { return false };
    let own = |word: &Word| matches!(word.letter, b'H' | b'P' | b'Q' | b'R' | b'O');
    if !(words.m.is_empty() && words.list.iter().all(own)) {
        return false;
    }
    let takes_number = (80.0..=86.0).contains(&h.value) || (99.0..100.0).contains(&h.value);
    find(b'P').is_none_or(|p| {
        let behind = running.text.get(p.at as usize + 1..).unwrap_or_default();
        let plain = behind.iter().find(|byte| **byte != b' ').is_some_and(u8::is_ascii_digit);
        takes_number || h.at < p.at || !plain
    })
}

/// System I: each letter has its own variable. System II: if I, J or K occurs twice, up to ten sets of them; a letter
/// out of order (I after K) begins the next set. If both systems set a variable, the later word counts.
fn arguments(words: &[Word], value_of: impl Fn(&Word) -> f64) -> ReadResult<Locals> {
    let mut locals: Locals = [None; 33];
    let mut seen = 0_u32;
    let given = || {
        words.iter().filter(|word| !matches!(word.letter, b'P' | b'L' | b'O') && word.kind != ValueKind::AddressOnly)
    };
    let mut count = [0; 3];
    for word in given() {
        if let Some(place) = (b'I'..=b'K').position(|letter| letter == word.letter) {
            count[place] += 1;
        }
    }
    let second = count.iter().any(|count| *count > 1);
    let (mut set, mut last) = (0, None);
    for word in given() {
        let at = word.at as usize;
        let index = match word.letter {
            letter @ b'I'..=b'K' if second => {
                let place = usize::from(letter - b'I');
                if last.is_some_and(|last| place <= last) {
                    set += 1;
                }
                last = Some(place);
                if set >= MAX_IJK_SETS {
                    return fail1(at, E::DoubleWord, char::from(letter));
                }
                4 + 3 * set + place
            }
            letter => {
                let bit = 1 << (letter - b'A');
                if seen & bit != 0 {
                    return fail1(at, E::DoubleWord, word.name());
                }
                seen |= bit;
                match argument_variable(letter) {
                    Some(index) => index,
                    None => return fail1(at, E::UnknownWord, word.name()),
                }
            }
        };
        locals[index - 1] = (word.kind != ValueKind::Null).then(|| value_of(word));
    }
    Ok(locals)
}

/// Arguments that are lengths: without a decimal point they are in least increments, where P6.1 asks for it (FANUC).
const LENGTH_ARGUMENTS: &[u8] = b"ABCIJKQRUVWXYZ";
/// The same for the shipped grinding cycles, and their times in seconds; their other arguments are feeds and numbers.
const CYCLE_ARGUMENTS: [(u32, &[u8], &[u8]); 7] = [
    (9071, b"ABW", b"U"),
    (9073, b"ABW", b"U"),
    (9075, b"IJKXZ", b""),
    (9076, b"AX", b"U"),
    (9077, b"IJKXZ", b"U"),
    (9078, b"IJKX", b""),
    (9079, b"IJKX", b""),
];
/// The other shipped programs: the shipped programs call them, with numbers as they are.
const SHIPPED_PROGRAMS: [u32; 12] = [9000, 9001, 9010, 9011, 9012, 9013, 9014, 9015, 9016, 9017, 9018, 9020];

/// Whether a program is a shipped grinding cycle.
fn is_grinding_cycle(program: u32) -> bool {
    CYCLE_ARGUMENTS.iter().any(|(number, ..)| *number == program)
}

/// How a macro is called. The feeds of a grinding cycle end with it where no F is in force.
fn callee_of(running: &BlockContext<'_, '_>, program: u32) -> Callee {
    match running.modals.feed.is_none() && is_grinding_cycle(program) {
        true => Callee::CycleWithoutFeed,
        false => Callee::Macro,
    }
}

/// The value that an argument of a macro passes on.
fn argument_value(running: &BlockContext<'_, '_>, program: u32, word: &Word) -> f64 {
    let Some(thousandth) = running.settings.least_increment_mm.filter(|_| word.kind == ValueKind::Integer) else {
        return word.value;
    };
    let cycle = CYCLE_ARGUMENTS.iter().find(|(number, ..)| *number == program);
    let (lengths, times) = match cycle {
        Some((_, lengths, times)) => (*lengths, *times),
        None if SHIPPED_PROGRAMS.contains(&program) => (&b""[..], &b""[..]),
        None => (LENGTH_ARGUMENTS, &b""[..]),
    };
    if times.contains(&word.letter) {
        return word.value * thousandth;
    }
    let least = least_increment(running).filter(|_| lengths.contains(&word.letter));
    word.value * least.unwrap_or(1.0)
}

/// The letters of the arguments #1 to #26; a point where there is none.
const ARGUMENT_LETTERS: &[u8; 26] = b"ABCIJKDEF.H.M...QRSTUVWXYZ";

fn argument_variable(letter: u8) -> Option<usize> {
    ARGUMENT_LETTERS.iter().position(|argument| *argument == letter).map(|index| index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(letter: u8, value: f64) -> Word {
        Word { value, at: 0, letter, kind: ValueKind::Integer }
    }

    fn passed(words: &[Word]) -> ReadResult<Locals> {
        arguments(words, |word| word.value)
    }

    #[test]
    fn b3_argument_system_1_gives_each_letter_its_variable() {
        let locals = passed(&[word(b'A', 1.0), word(b'X', 24.0), word(b'Z', 26.0), word(b'D', 7.0)]).unwrap();
        assert_eq!(
            (locals[0], locals[23], locals[25], locals[6], locals[3]),
            (Some(1.0), Some(24.0), Some(26.0), Some(7.0), None)
        );
        assert!(passed(&[word(b'X', 1.0), word(b'X', 2.0)]).is_err());
    }

    #[test]
    fn b3_argument_system_2_counts_sets_of_i_j_k() {
        let list = [(b'A', 1.0), (b'I', 4.0), (b'J', 5.0), (b'K', 6.0), (b'I', 7.0), (b'K', 9.0), (b'J', 11.0)];
        let locals = passed(&list.map(|(letter, value)| word(letter, value))).unwrap();
        for (index, value) in [(1, 1.0), (4, 4.0), (5, 5.0), (6, 6.0), (7, 7.0), (9, 9.0), (11, 11.0)] {
            assert_eq!(locals[index - 1], Some(value), "#{index}");
        }
        assert_eq!(locals[7], None);
    }

    #[test]
    fn b3_of_both_argument_systems_the_later_word_counts() {
        let list = [(b'A', 1.0), (b'B', 2.0), (b'I', -3.0), (b'I', 4.0), (b'D', 5.0)];
        let locals = passed(&list.map(|(letter, value)| word(letter, value))).unwrap();
        // The second I is #7, which D then overwrites.
        assert_eq!((locals[0], locals[1], locals[3], locals[6]), (Some(1.0), Some(2.0), Some(-3.0), Some(5.0)));
    }
}
