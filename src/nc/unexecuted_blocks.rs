//! Blocks that a run did not execute: executes each by itself, as if it were reached, to find what is wrong with it.
//!
//! Position, modal state and variables there are those of the lines above, not those of a run. A mistake that they
//! could explain is a warning. Where the lines above do not say where the axes are, the warning is that arcs and contours
//! are not checked, once for each program. Source: spec B1, B3, T4.

use std::sync::Arc;

use super::block::Block;
use super::called_texts::FoundCall;
use super::expression::Locals;
use super::external_state::OfflineMachine;
use super::fault::{E, ErrorAt, ProgramFault, ReadStop};
use super::flow::CallDepth;
use super::interpreter::Interpreter;
use super::lexer;
use super::source::Source;
use super::statement;
use super::words::BlockWords;
use crate::defs::gcode::{GCode, GCodeGroup};
use crate::units::Axis;

/// The feed of a called program whose caller is not known, mm/min.
const ASSUMED_FEED: f64 = 100.0;
/// The first characters of the words that moves and cycles of group 01 have.
const MOTION_LETTERS: &[u8] = b"XYZUVWRIJK,";

/// How sure a mistake in a block is that no run has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Certainty {
    /// The text alone is wrong.
    Sure,
    /// Values or modes of a run decide.
    Possible,
    /// Nothing is known that it could be measured by: the lines above do not say where the axes stand.
    NoPosition,
    /// The same of the values of a call, of the feed and the like.
    Unknown,
}

/// Executes the blocks of a text one after the other, each by itself.
#[derive(Debug)]
pub(super) struct LoneBlocks {
    pub source: Arc<Source>,
    /// #1–#33 of the call; null in a program that no block calls.
    locals: Locals,
    /// How deep in calls the text is.
    depth: CallDepth,
    world: OfflineMachine,
    block: Block,
    /// Behind the last line.
    next_line: u32,
    /// The lines above say where the axis stands, in the order X Y Z.
    known: [bool; 3],
    /// The lines above say which function of group 01 acts.
    motion_known: bool,
    /// The byte of the first F of the program that is started, or the end of its text. `None`: a called program, to which
    /// its caller may give one.
    first_feed: Option<usize>,
    /// A block of this text could not be checked without a position.
    pub position_missed: bool,
    /// A compensated contour or a corner of this text was not checked.
    contour_missed: bool,
    /// The programs that the last line calls.
    pub calls: Vec<FoundCall>,
    /// The mistakes of the last line.
    pub found: Vec<(ProgramFault, Certainty)>,
}

impl LoneBlocks {
    /// Begins with a text and #1–#33. The machine and the block are its own.
    pub fn new((source, locals): (Arc<Source>, Locals), world: OfflineMachine, block: Block) -> Self {
        let (known, motion_known, calls, found) = ([false; 3], false, Vec::new(), Vec::new());
        let (next_line, position_missed) = (u32::MAX, false);
        let first_feed = Some(first_feed_word(source.bytes()));
        let depth = CallDepth::default();
        Self {
            source,
            locals,
            depth,
            world,
            block,
            next_line,
            known,
            motion_known,
            first_feed,
            position_missed,
            contour_missed: false,
            calls,
            found,
        }
    }

    /// Begins with another text.
    pub fn begin(&mut self, (source, locals, depth): FoundCall) {
        (self.source, self.locals, self.depth, self.next_line) = (source, locals, depth, u32::MAX);
        (self.position_missed, self.contour_missed, self.first_feed) = (false, false, None);
    }

    /// Executes the blocks of a line (from 0).
    pub fn execute(&mut self, line: u32, interpreter: &mut Interpreter) {
        if line != self.next_line {
            (self.known, self.motion_known) = ([false; 3], false);
        }
        self.next_line = line + 1;
        let (start, end) = (self.source.line_start(line), self.source.line_start(line + 1));
        let (mut next, mut has_assumed_feed) = (Some(start), false);
        while let Some(at) = next {
            interpreter.begin_alone(&self.source, at, (&self.locals, self.depth));
            let stepped = interpreter.step_whole_block(&mut self.world, &mut self.block);
            // The words of the block say where it ends, not where it begins.
            let known_before = self.known;
            self.note_words(interpreter);
            match stepped {
                Ok(_) => {
                    self.note_contour(at, interpreter);
                    interpreter.take_called_programs(&mut self.calls);
                    self.block.ops.iter().for_each(|op| self.world.apply(op));
                    // Behind a jump or an end the lines above say nothing.
                    if interpreter.ended || !(line..=line + 1).contains(&interpreter.flow.place.line) {
                        self.next_line = u32::MAX;
                    }
                }
                Err(ReadStop::Drain) => {}
                // The feed of a caller is not known: what else is wrong with the block is.
                Err(ReadStop::Error(wrong))
                    if wrong.error == E::FeedMissing && self.first_feed.is_none() && !has_assumed_feed =>
                {
                    (interpreter.modals.feed, has_assumed_feed) = (Some(ASSUMED_FEED), true);
                    self.known = known_before;
                    continue;
                }
                Err(ReadStop::Error(wrong)) => {
                    let at = wrong.at;
                    let fault = self.source.fault(interpreter.block_words.block_number, wrong);
                    let certainty = self.certainty(at, &fault, (interpreter, known_before));
                    self.found.push((fault, certainty));
                }
            }
            self.locals = *interpreter.flow.first_locals();
            next = statement::next_block_on_line(&self.source.bytes()[..end], at, at > start);
        }
    }

    /// Notes a block whose path depends on those behind it: the first one of a text is named.
    fn note_contour(&mut self, at: usize, interpreter: &mut Interpreter) {
        let has_corner = interpreter.corner_words.take().is_some();
        if (has_corner || interpreter.modals.compensation.is_some())
            && !std::mem::replace(&mut self.contour_missed, true)
        {
            let wrong = ErrorAt { at, error: E::ContourUnread, details: Default::default() };
            let fault = self.source.fault(interpreter.block_words.block_number, wrong);
            self.found.push((fault, Certainty::Possible));
        }
    }

    /// Notes what the words of a block say of position and function.
    fn note_words(&mut self, interpreter: &Interpreter) {
        let words = &interpreter.block_words;
        // The program may come to a block with a number from elsewhere.
        self.motion_known &= words.block_number.is_none();
        let incremental = interpreter.modals.incremental && interpreter.settings.is_mill();
        for (known, letter) in self.known.iter_mut().zip(*b"XYZ") {
            *known |= words.has(letter) && !incremental;
        }
        self.motion_known |= words.g.iter().any(|code| is_in_group(code.number, GCodeGroup::Motion));
    }

    /// Whether the line of a byte names a local variable without a value.
    fn names_empty_local(&self, at: usize) -> bool {
        let (before, behind) = self.source.bytes().split_at(at);
        let is_end = |byte: &u8| matches!(byte, b'\r' | b'\n');
        let start = before.iter().rposition(is_end).map_or(0, |end| end + 1);
        let end = behind.iter().position(is_end).unwrap_or(behind.len());
        let line = &self.source.bytes()[start..at + end];
        line.split(|byte| *byte == b'#').skip(1).any(|name| {
            let digits = name.iter().take_while(|byte| byte.is_ascii_digit()).count();
            let number: Option<usize> =
                std::str::from_utf8(&name[..digits]).ok().and_then(|digits| digits.parse().ok());
            let local = number.and_then(|number| self.locals.get(number.checked_sub(1)?));
            local.is_some_and(Option::is_none)
        })
    }

    /// How sure a mistake at a byte is; with what was known of the position before the block.
    fn certainty(
        &self,
        at: usize,
        fault: &ProgramFault,
        (interpreter, known_before): (&Interpreter, [bool; 3]),
    ) -> Certainty {
        let (text, words) = (self.source.bytes(), &interpreter.block_words);
        let literal = lexer::is_literal(text, at);
        let without_values = self.block.used_variables.is_empty() && !interpreter.has_null_use();
        let has_group = |group| words.g.iter().any(|code| is_in_group(code.number, group));
        let sure = |holds: bool| if holds { Certainty::Sure } else { Certainty::Possible };
        match fault.error {
            error if depends_on_position(error) => by_position(interpreter, known_before),
            // The word is there; its local variable has a value only in a run.
            E::MissingWord | E::EmptyWord if interpreter.block_words.has_null() && self.names_empty_local(at) => {
                Certainty::Unknown
            }
            // No caller has an F for a program that is started, and no line above has one.
            E::FeedMissing if self.first_feed.is_some_and(|first| at <= first) => Certainty::Possible,
            E::FeedMissing | E::G50WithTools | E::DwellWithoutSpeed => Certainty::Unknown,
            // The calls by which the check came here; a program for several machines asks which one it runs on.
            E::TooDeep | E::NoAxis => Certainty::Possible,
            // The caller has the block.
            E::MissingTarget if words.m.iter().any(|code| code.number == 99) => Certainty::Possible,
            E::OutOfRange
            | E::NotWhole
            | E::MissingProgram
            | E::MissingTarget
            | E::UnknownG
            | E::CycleByTable
            | E::UnknownM
            | E::UnknownH => sure(literal || without_values),
            // Its number is computed from a local variable that has a value only in a run.
            E::BadVariable if !literal && self.names_empty_local(at) => Certainty::Unknown,
            E::BadVariable | E::ReadOnly => sure(literal || without_values),
            E::DivisionByZero if fault.has_detail() => Certainty::Sure,
            E::FunctionDomain if has_literal_argument(text, at) => Certainty::Sure,
            // An IF guards against it.
            E::DivisionByZero | E::FunctionDomain | E::Overflow if words.condition.is_some() => Certainty::Unknown,
            E::DivisionByZero | E::FunctionDomain | E::Overflow | E::SwitchVariable => sure(without_values),
            // G90 or G91 acts that the lines above may not say, unless the block has it.
            E::NotTogether if words.g.iter().any(|code| code.number == 53) => sure(is_written_incremental(words)),
            E::CycleInForce => Certainty::Possible,
            E::AxisOutsidePlane => sure(has_group(GCodeGroup::Plane) || !interpreter.settings.is_mill()),
            // No function of group 01 has the letter.
            E::UnknownWord
                if !text.get(at).is_some_and(|letter| MOTION_LETTERS.contains(&letter.to_ascii_uppercase())) =>
            {
                sure(without_values)
            }
            // The function of group 01 that acts decides about the words.
            error if depends_on_motion(error) => {
                let lacks_word = matches!(fault.error, E::MissingWord | E::EmptyWord);
                let has_own = !words.m.is_empty() || words.g.iter().any(|code| matches!(code.number, 54 | 66));
                let named = has_group(GCodeGroup::Motion) || has_group(GCodeGroup::NonModal) || lacks_word && has_own;
                sure(without_values && (self.motion_known || named))
            }
            _ => Certainty::Sure,
        }
    }
}

/// Whether the block itself asks for increments.
fn is_written_incremental(words: &BlockWords) -> bool {
    words.g.iter().any(|code| code.number == 91)
        || b"XYZ".iter().any(|letter| words.is_incremental(*letter) == Some(true))
}

/// How sure a mistake is that comes from positions.
fn by_position(interpreter: &Interpreter, known: [bool; 3]) -> Certainty {
    let axes = Axis::ALL.into_iter().zip(known);
    match axes.filter(|(axis, _)| interpreter.settings.axes[*axis]).all(|(_, known)| known) {
        true => Certainty::Possible,
        false => Certainty::NoPosition,
    }
}

/// Mistakes that come from positions, and from what other blocks have set.
const fn depends_on_position(error: E) -> bool {
    matches!(
        error,
        E::ArcEndOffCircle
            | E::ArcRadius
            | E::ArcTooSmall
            | E::FullCircleByRadius
            | E::RectangleSide
            | E::ContourStart
            | E::ContourAboveStart
            | E::ContourPocket
            | E::ContourAllowance
            | E::ContourNotMonotone
            | E::ContourEmpty
            | E::ContourStrokes
    )
}

/// Mistakes about which the function of group 01 decides.
const fn depends_on_motion(error: E) -> bool {
    matches!(
        error,
        E::UnknownWord
            | E::CommaMissing
            | E::MissingWord
            | E::TurningCycleWord
            | E::EmptyWord
            | E::AxisUnused
            | E::ArcWithoutCentre
    )
}

/// The byte of the first F with a value in a text, or its end.
fn first_feed_word(text: &[u8]) -> usize {
    let is_feed = |pair: &[u8]| matches!(pair, [b'F' | b'f', b'0'..=b'9' | b'.' | b'#' | b'[' | b' ' | b'=']);
    text.windows(2).position(is_feed).unwrap_or(text.len())
}

/// Whether a G code belongs to a group on any kind of machine.
fn is_in_group(code: u32, group: GCodeGroup) -> bool {
    GCode::find(code).is_some_and(|row| row.group_on(false) == group || row.group_on(true) == group)
}

/// Whether the argument of the function at a byte is a number that is written there.
fn has_literal_argument(text: &[u8], at: usize) -> bool {
    let rest = &text[at.min(text.len())..];
    let argument = rest.split(|byte| *byte == b']').next().unwrap_or_default();
    let name = argument.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    let number = argument[name..].strip_prefix(b"[").unwrap_or_default();
    std::str::from_utf8(number).is_ok_and(|number| number.trim().parse::<f64>().is_ok())
}
