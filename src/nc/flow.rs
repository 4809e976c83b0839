//! The position in the program: jumps, loops, calls and returns. Source: spec B3.

use std::sync::Arc;

use super::expression::{Locals, Value};
use super::fault::{CallChain, E, ReadResult, fail1, fail2};
use super::lexer::Cursor;
use super::modal_calls::{ModalCalls, ModalMark};
use super::source::Source;
use super::source_index::{LOOP_DEPTH, LoopEnd};
use super::statement::line_continues;

/// Deepest nesting of counted loops (G22) and of subprograms in the same text.
pub(crate) const COUNTED_DEPTH: usize = 255;

/// Nesting for which memory is reserved.
const USUAL_DEPTH: usize = 16;

static NO_LOCALS: Locals = [None; 33];

/// The kind of a call: a subprogram shares its caller's local variables, a macro has its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Callee {
    Sub,
    Macro,
    /// A grinding cycle while no F was in force: its own feeds end with it.
    CycleWithoutFeed,
}

impl Callee {
    const fn is_macro(self) -> bool {
        matches!(self, Self::Macro | Self::CycleWithoutFeed)
    }
}

/// How many calls of each kind are open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CallDepth {
    subs: usize,
    macros: usize,
}

impl CallDepth {
    const fn of(self, callee: Callee) -> usize {
        match callee {
            Callee::Sub => self.subs,
            Callee::Macro | Callee::CycleWithoutFeed => self.macros,
        }
    }

    /// Inside one more call.
    pub const fn within(self, callee: Callee) -> Self {
        match callee {
            Callee::Sub => Self { subs: self.subs + 1, ..self },
            Callee::Macro | Callee::CycleWithoutFeed => Self { macros: self.macros + 1, ..self },
        }
    }
}

/// Deepest nesting of a kind of call, and its name.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CallLimit {
    pub depth: usize,
    pub name: &'static str,
}

/// A call as programmed. The arguments of a macro stand beside it, so that it is cheap to pass on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Call {
    pub program: u32,
    pub times: u32,
    pub callee: Callee,
    pub at: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct OpenLoop {
    number: u8,
    while_at: usize,
    end: LoopEnd,
}

/// An open counted loop, lines from 0.
#[derive(Clone, Copy, Debug)]
struct OpenCountedLoop {
    line: u32,
    end_line: u32,
    repeats_left: u32,
}

/// A place in a text.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    /// The next byte to read.
    pub at: usize,
    /// Its line, from 0.
    pub line: u32,
    /// A block of this line was already read.
    pub mid_line: bool,
}

impl Place {
    /// The place behind a block that the cursor has read; `line` is the line of the block.
    #[inline]
    pub fn behind(mut cursor: Cursor<'_>, line: u32) -> Self {
        if line_continues(&cursor) {
            return Self { at: cursor.at, line, mid_line: true };
        }
        cursor.skip_line_end();
        Self { at: cursor.at, line: line + 1, mid_line: false }
    }
}

/// A call frame: the position to return to, and the state of the caller.
#[derive(Clone, Debug)]
struct CallFrame {
    source: Arc<Source>,
    place: Place,
    loops: [OpenLoop; LOOP_DEPTH],
    depth: usize,
    /// The byte of the call.
    call_at: usize,
    repeats_left: u32,
    callee: Callee,
    /// The arguments of a macro, for its repetitions.
    arguments: Locals,
    /// The G66 calls of the caller, in the call of their macro.
    modal_mark: Option<ModalMark>,
    /// How many G66 calls there were before a macro was called.
    modal_count: usize,
    /// Number of counted loops that belong to the caller's callers.
    counted_base: usize,
    /// The first block number of a subprogram in the same text.
    local_entry: Option<u32>,
}

/// The local variables of a started program, all null, in the memory of other ones.
fn first_level(mut levels: Vec<Locals>) -> Vec<Locals> {
    levels.clear();
    levels.push(NO_LOCALS);
    levels
}

/// The position in the running program, and the call stack.
#[derive(Clone, Debug)]
pub(crate) struct Flow {
    pub source: Arc<Source>,
    pub place: Place,
    /// M99 restarted the main program.
    pub restarted: bool,
    pub modal_calls: ModalCalls,
    loops: [OpenLoop; LOOP_DEPTH],
    depth: usize,
    call_stack: Vec<CallFrame>,
    /// The calls around a text that was begun by itself.
    calls_around: CallDepth,
    locals: Vec<Locals>,
    counted_loops: Vec<OpenCountedLoop>,
    /// How many of `counted` belong to callers.
    counted_base: usize,
}

impl Flow {
    pub fn new(source: Arc<Source>) -> Self {
        Self {
            place: Place { at: source.line_start(0), ..Place::default() },
            source,
            restarted: false,
            modal_calls: ModalCalls::with_capacity(USUAL_DEPTH),
            loops: [OpenLoop::default(); LOOP_DEPTH],
            depth: 0,
            call_stack: Vec::with_capacity(USUAL_DEPTH),
            calls_around: CallDepth::default(),
            locals: first_level(Vec::with_capacity(USUAL_DEPTH)),
            counted_loops: Vec::with_capacity(USUAL_DEPTH),
            counted_base: 0,
        }
    }

    /// Starts at the head of another text. The memory of the stacks is kept.
    pub fn begin(&mut self, source: Arc<Source>) {
        self.source = source;
        self.go_to_line(0);
        self.modal_calls.clear();
        self.call_stack.clear();
        self.locals = first_level(std::mem::take(&mut self.locals));
        self.counted_loops.clear();
        (self.restarted, self.depth, self.counted_base) = (false, 0, 0);
        self.calls_around = CallDepth::default();
    }

    /// Goes to the block at a byte of a text without its caller, within the WHILE loops around it and as deep in calls as
    /// it would be.
    pub fn begin_at(&mut self, source: Arc<Source>, at: usize, locals: &Locals, calls_around: CallDepth) {
        self.begin(source);
        self.calls_around = calls_around;
        self.locals.iter_mut().for_each(|level| *level = *locals);
        self.go_to(at);
        let around = self.source.while_loops_around(at);
        let opened = around.filter_map(|found| {
            Some(OpenLoop { number: found.number, while_at: found.while_at as usize, end: found.end? })
        });
        for (place, open) in self.loops.iter_mut().zip(opened) {
            *place = open;
            self.depth += 1;
        }
        self.loops[..self.depth].reverse();
    }

    /// #1–#33 of the started program.
    pub fn first_locals(&self) -> &Locals {
        self.locals.first().unwrap_or(&NO_LOCALS)
    }

    /// Takes over the position and the stacks of another flow, in the memory of this one.
    pub fn copy_from(&mut self, other: &Self) {
        let Self { source, place, restarted, modal_calls, loops, depth, .. } = other;
        let Self { call_stack, calls_around, locals, counted_loops, counted_base, .. } = other;
        self.calls_around = *calls_around;
        self.source.clone_from(source);
        self.call_stack.clone_from(call_stack);
        self.locals.clone_from(locals);
        self.counted_loops.clone_from(counted_loops);
        self.modal_calls.copy_from(modal_calls);
        (self.place, self.restarted) = (*place, *restarted);
        (self.loops, self.depth, self.counted_base) = (*loops, *depth, *counted_base);
    }

    /// #1–#33 of the current call level.
    #[inline]
    pub fn locals(&self) -> &Locals {
        self.locals.last().unwrap_or(&NO_LOCALS)
    }

    /// Takes over #1–#33 of the current call level from a flow that is as deep in calls.
    pub fn take_locals(&mut self, other: &Self) {
        if let Some(locals) = self.locals.last_mut() {
            *locals = *other.locals();
        }
    }

    /// Sets one of #1–#33; returns whether its value has changed.
    pub fn set_local(&mut self, number: u32, value: Value) -> bool {
        let place = self.locals.last_mut().and_then(|locals| locals.get_mut((number as usize).wrapping_sub(1)));
        place.is_some_and(|place| std::mem::replace(place, value).map(f64::to_bits) != value.map(f64::to_bits))
    }

    /// Whether the started program runs, not a subprogram.
    #[inline]
    pub fn is_main(&self) -> bool {
        self.call_stack.is_empty()
    }

    /// Whether a program was called and has not returned.
    pub fn is_within(&self, program: u32) -> bool {
        // The first frame is that of the started program.
        let callers = self.call_stack.iter().skip(1).map(|frame| &frame.source);
        !self.is_main() && callers.chain([&self.source]).any(|source| source.number() == program)
    }

    /// Whether the present program is a cycle that leaves no F in force.
    pub fn ends_without_feed(&self) -> bool {
        self.call_stack.last().is_some_and(|level| level.callee == Callee::CycleWithoutFeed)
    }

    /// How deep in calls the present program is.
    pub fn call_depth(&self) -> CallDepth {
        self.call_stack.iter().fold(self.calls_around, |depth, frame| depth.within(frame.callee))
    }

    /// The calls that led to the present program, the last one first.
    pub fn calls(&self) -> CallChain {
        let line = |level: &CallFrame| level.source.line_of(level.call_at) + 1;
        self.call_stack.iter().rev().map(|level| (level.source.number(), line(level))).collect()
    }

    /// The block number of the running subprogram, if it is in the same text.
    pub fn local_sub(&self) -> Option<u32> {
        self.call_stack.last().and_then(|level| level.local_entry)
    }

    /// Enters the counted loop of a faulty G22 for one pass, so that a check can read on.
    pub fn enter_faulty_loop(&mut self) {
        if let Some(found) = self.source.counted_loop_at(self.place.line)
            && let Some(end_line) = found.end_line
        {
            self.counted_loops.push(OpenCountedLoop { line: found.line, end_line, repeats_left: 0 });
        }
    }

    /// Goes to a line (from 0).
    pub fn go_to_line(&mut self, line: u32) {
        self.place = Place { at: self.source.line_start(line), line, mid_line: false };
    }

    /// Goes to the block that begins at a byte.
    pub fn go_to(&mut self, at: usize) {
        let line = self.source.line_of(at);
        self.place = Place { at, line, mid_line: at != self.source.line_start(line) };
    }

    /// Goes to a place of this text. Leaves loops that do not contain it.
    pub fn go_behind(&mut self, place: Place) {
        self.place = place;
        let stays = |open: &OpenLoop| open.while_at < place.at && place.at <= open.end.at as usize;
        self.depth = self.loops[..self.depth].iter().take_while(|open| stays(open)).count();
    }

    /// GOTO: goes to the next block with the number, else to the first. Leaves loops that do not contain it.
    pub fn go_to_block(&mut self, n: u32, at: usize) -> ReadResult<()> {
        let Some(target) = self.source.find_block(n, self.place.at) else {
            return fail1(at, E::MissingTarget, format!("N{n}"));
        };
        self.go_to(target);
        self.go_behind(self.place);
        Ok(())
    }

    /// WHILE in the current block: enters the loop, or goes past its END.
    pub fn begin_loop(&mut self, holds: bool, number: u8, at: usize) -> ReadResult<()> {
        let found = self.source.while_loop_at(self.place.at).filter(|found| found.number == number);
        let Some((while_at, end)) = found.and_then(|found| Some((found.while_at as usize, found.end?))) else {
            return fail1(at, E::LoopMismatch, format_args!("WHILE … DO{number}"));
        };
        let top = self.depth.checked_sub(1).map(|top| self.loops[top]);
        let again = top.is_some_and(|top| top.while_at == while_at);
        if !again {
            if self.loops[..self.depth].iter().any(|open| open.number == number) || self.depth == LOOP_DEPTH {
                return fail1(at, E::DoNumber, format_args!("{number}"));
            }
            self.loops[self.depth] = OpenLoop { number, while_at, end };
            self.depth += 1;
        }
        if !holds {
            self.depth -= 1;
            self.go_to(end.after as usize);
        }
        Ok(())
    }

    /// END: goes back to its WHILE.
    pub fn end_loop(&mut self, number: u8, at: usize) -> ReadResult<()> {
        match self.depth.checked_sub(1).map(|top| self.loops[top]) {
            Some(top) if top.number == number && top.end.at as usize == self.place.at => {
                self.go_to(top.while_at);
                Ok(())
            }
            // A jump went into the loop, past its WHILE.
            Some(_) | None => match self.source.while_loop_of_end(self.place.at) {
                Some(found) => fail2(
                    at,
                    E::JumpIntoWhile,
                    format_args!("END{number}"),
                    format_args!("{}", self.source.line_of(found.while_at as usize) + 1),
                ),
                None => fail1(at, E::LoopMismatch, format_args!("END{number}")),
            },
        }
    }

    /// Goes to the line (from 0) behind another one. Leaves loops that do not contain it.
    pub fn go_behind_line(&mut self, line: u32) {
        self.go_to_line(line + 1);
        self.go_behind(self.place);
    }

    /// Returns to the started program, however many repetitions of its calls are left.
    pub fn return_to_main(&mut self) {
        while let Some(level) = self.call_stack.last_mut() {
            level.repeats_left = 0;
            let _ = self.return_to(None, 0); // without a target it always succeeds
        }
    }

    /// Goes past the end of the outermost open loop; `false` if no loop is open.
    pub fn leave_loops(&mut self) -> bool {
        // A subprogram of the same text first returns to the loop that calls it.
        while self.counted_loops.len() == self.counted_base && !self.counted_loops.is_empty() {
            if self.return_to(None, 0).is_err() {
                return false;
            }
        }
        if let Some(outermost) = self.counted_loops.get(self.counted_base).copied() {
            self.counted_loops.truncate(self.counted_base);
            self.go_to_line(outermost.end_line + 1);
            return true;
        }
        if self.depth == 0 {
            return false;
        }
        self.depth = 0;
        self.go_to(self.loops[0].end.after as usize);
        true
    }

    /// Calls a program, as deep as the limit. `arguments` are those of a macro. The flow is already past the calling
    /// block.
    pub fn call(&mut self, source: Arc<Source>, call: Call, arguments: &Locals, limit: CallLimit) -> ReadResult<()> {
        if self.call_depth().of(call.callee) >= limit.depth {
            return fail2(call.at, E::TooDeep, limit.name, format_args!("{}", limit.depth));
        }
        if call.callee.is_macro() {
            self.locals.push(*arguments);
        }
        let (repeats_left, arguments) = (call.times - 1, *arguments);
        let frame = CallFrame { repeats_left, arguments, ..self.frame(call.callee, call.at) };
        self.enter(source, frame, 0);
        Ok(())
    }

    /// Calls the macro of the active G66. Moves of the macro call that of the G66 before it.
    pub fn call_modal(&mut self, source: Arc<Source>, call: Call, limit: CallLimit) -> ReadResult<()> {
        let Some((_, arguments)) = self.modal_calls.active() else { return Ok(()) };
        let arguments = *arguments;
        self.call(source, call, &arguments, limit)?;
        let mark = self.modal_calls.enter();
        self.call_stack.last_mut().into_iter().for_each(|frame| frame.modal_mark = Some(mark));
        Ok(())
    }

    /// A frame that returns to the present place.
    fn frame(&self, callee: Callee, call_at: usize) -> CallFrame {
        CallFrame {
            source: Arc::clone(&self.source),
            place: self.place,
            loops: self.loops,
            depth: self.depth,
            call_at,
            repeats_left: 0,
            callee,
            arguments: [None; 33],
            modal_mark: None,
            modal_count: self.modal_calls.count(),
            counted_base: self.counted_base,
            local_entry: None,
        }
    }

    /// Enters a call at a line of its text.
    fn enter(&mut self, source: Arc<Source>, frame: CallFrame, line: u32) {
        self.call_stack.push(frame);
        self.source = source;
        self.depth = 0;
        self.counted_base = self.counted_loops.len();
        self.go_to_line(line);
    }

    /// Goes to the only block with a number. Leaves counted loops that do not contain it.
    pub fn go_to_unique_block(&mut self, n: u32, at: usize) -> ReadResult<()> {
        let line = self.find_unique_block(n, at)?;
        if line == self.place.line {
            return fail1(at, E::JumpToItself, format!("N{n:04}"));
        }
        let stays = |open: &OpenCountedLoop| open.line < line && line <= open.end_line;
        let kept = self.counted_loops[self.counted_base..].iter().take_while(|open| stays(open)).count();
        self.counted_loops.truncate(self.counted_base + kept);
        self.go_to_line(line);
        Ok(())
    }

    fn find_unique_block(&self, n: u32, at: usize) -> ReadResult<u32> {
        match self.source.find_unique_block(n) {
            Ok(Some(line)) => Ok(line),
            Ok(None) => fail1(at, E::MissingTarget, format_args!("N{n:04}")),
            Err(()) => fail1(at, E::SeveralTargets, format_args!("N{n:04}")),
        }
    }

    /// Calls a subprogram in the same text. The flow is already past the calling block.
    pub fn call_local(&mut self, n: u32, at: usize) -> ReadResult<()> {
        let line = self.find_unique_block(n, at)?;
        // L7: subprograms follow the main program, which M02 ends.
        let within = self.source.main_end_line().is_some_and(|end| line < end);
        if within || self.is_main() && line <= self.place.line.saturating_sub(1) {
            return fail1(at, E::SubBeforeMain, format!("N{n:04}"));
        }
        if self.call_stack.len() >= COUNTED_DEPTH {
            return fail2(at, E::TooDeep, "M98", format_args!("{COUNTED_DEPTH}"));
        }
        let frame = CallFrame { local_entry: Some(n), ..self.frame(Callee::Sub, at) };
        self.enter(Arc::clone(&self.source), frame, line);
        Ok(())
    }

    /// G22 in the current line: enters the loop, or goes past its G80. True: the loop was entered.
    pub fn begin_counted_loop(&mut self, times: u32, at: usize) -> ReadResult<bool> {
        let found = self.source.counted_loop_at(self.place.line);
        let Some((line, end_line)) = found.and_then(|found| Some((found.line, found.end_line?))) else {
            return fail2(at, E::LoopUnpaired, "G22", "G80");
        };
        if times == 0 {
            self.go_to_line(end_line + 1);
            return Ok(false);
        }
        if self.counted_loops.len() - self.counted_base >= COUNTED_DEPTH {
            return fail2(at, E::TooDeep, "G22", format_args!("{COUNTED_DEPTH}"));
        }
        self.counted_loops.push(OpenCountedLoop { line, end_line, repeats_left: times - 1 });
        Ok(true)
    }

    /// G80 in the current line: goes back to the line after its G22, or leaves the loop. True: the loop is over.
    pub fn end_counted_loop(&mut self, at: usize) -> ReadResult<bool> {
        let line = self.place.line;
        let open = &mut self.counted_loops[self.counted_base..];
        match open.last_mut() {
            Some(top) if top.end_line == line && top.repeats_left > 0 => {
                top.repeats_left -= 1;
                let first = top.line + 1;
                self.go_to_line(first);
                Ok(false)
            }
            Some(top) if top.end_line == line => {
                self.counted_loops.pop();
                Ok(true)
            }
            Some(_) | None => match self.source.counted_loop_start(line) {
                Some(begun) => fail1(at, E::JumpIntoLoop, begun + 1),
                None => fail2(at, E::LoopUnpaired, "G80", "G22"),
            },
        }
    }

    /// The text of the line that is read.
    pub fn line_text(&self) -> &[u8] {
        self.source.line_bytes(self.place.line)
    }

    /// M99: starts the next repetition, returns to the caller (to block `target`, if given) or restarts the program.
    pub fn return_to(&mut self, target: Option<u32>, at: usize) -> ReadResult<()> {
        let Some(level) = self.call_stack.last_mut() else {
            self.depth = 0;
            return match target {
                Some(n) => self.go_to_block(n, at),
                None => {
                    self.restarted = true;
                    self.go_to_line(0);
                    Ok(())
                }
            };
        };
        if let Some(n) = target
            && level.source.find_block(n, level.place.at).is_none()
        {
            return fail1(at, E::MissingTarget, format_args!("{} N{n}", level.source.title()));
        }
        if level.repeats_left > 0 && target.is_none() {
            level.repeats_left -= 1;
            if level.callee.is_macro()
                && let Some(locals) = self.locals.last_mut()
            {
                *locals = level.arguments;
                self.modal_calls.end_since(level.modal_count);
            }
            self.depth = 0;
            self.go_to_line(0);
            return Ok(());
        }
        let Some(level) = self.call_stack.pop() else { return Ok(()) };
        if level.callee.is_macro() {
            self.locals.pop();
            self.modal_calls.end_since(level.modal_count);
        }
        self.counted_loops.truncate(self.counted_base);
        self.counted_base = level.counted_base;
        self.source = level.source;
        self.place = level.place;
        (self.loops, self.depth) = (level.loops, level.depth);
        if let Some(mark) = level.modal_mark {
            self.modal_calls.leave(mark);
        }
        target.map_or(Ok(()), |n| self.go_to_block(n, at))
    }
}
