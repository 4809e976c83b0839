//! Checks a whole program without a machine: all mistakes, path length, time and extents. Source: spec B1, T4.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use super::fault::{Fault, Place, Wrong};
use super::interpreter::{Block, Interpreter};
use super::memory::Memory;
use super::settings::Settings;
use super::source::{Library, Source};
use super::unread::{self, Unread};
use super::world::{CheckWorld, Come};
use crate::defs::program_error::ProgramError as E;
use crate::units::PerAxis;

/// Most mistakes, and most warnings, that are collected.
pub const FAULT_LIMIT: usize = 1_000;
/// A run that reads this many blocks without reaching a new line of the program is in an endless (waiting) loop.
pub const STANDSTILL_LIMIT: u32 = 1_000_000;
/// How many such loops a check leaves before it stops following the program.
const LEFT_LOOPS: u32 = 4;

/// The result of a check.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// All mistakes in line order; each kind once per line.
    pub faults: Vec<Fault>,
    /// Allowed but rarely intended: null in arithmetic, a block after `;`, a loop that does not end in the check.
    pub warnings: Vec<Fault>,
    /// Path length of all moves, mm. An endless loop counts up to its first repetition.
    pub length_mm: f64,
    /// Time at programmed feeds without acceleration, seconds; endless loops as in `length_mm`.
    pub seconds: f64,
    /// Least and greatest work coordinates of all moves, radius mm; none without a move.
    pub extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
    /// Lines of the text.
    pub lines: usize,
    /// Number of blocks with operations; endless loops as in `length_mm`.
    pub blocks: u64,
    /// The blocks passed to `sink` (counted from 0) that are repetitions of an endless loop.
    pub repeated: Vec<Range<u64>>,
    /// The run reached its end (or its M99) without leaving an endless loop.
    pub finished: bool,
}

/// Checks a program from a cold start.
#[must_use]
pub fn check(source: &Arc<Source>, library: &Arc<dyn Library + Send + Sync>, settings: &Settings) -> Checked {
    check_with(source, library, settings, Memory::default(), &mut CheckWorld::new(settings), &mut |_| {})
}

/// Checks a program with the given variables and world; passes every block to `sink`.
pub fn check_with(
    source: &Arc<Source>,
    library: &Arc<dyn Library + Send + Sync>,
    settings: &Settings,
    memory: Memory,
    world: &mut CheckWorld,
    sink: &mut dyn FnMut(&Block),
) -> Checked {
    check_until(source, library, settings, memory, world, &mut |block| {
        sink(block);
        true
    })
}

/// As [`check_with`], until `sink` returns false; the check is then not finished.
pub fn check_until(
    source: &Arc<Source>,
    library: &Arc<dyn Library + Send + Sync>,
    settings: &Settings,
    memory: Memory,
    world: &mut CheckWorld,
    sink: &mut dyn FnMut(&Block) -> bool,
) -> Checked {
    let mut checking = Checking::new(source, library, settings, memory);
    while checking.advance(world, sink, u32::MAX) {}
    checking.found(world)
}

/// Checks only the syntax of some lines, without the rest of the program: jump targets are not checked.
#[must_use]
pub fn look(source: &Arc<Source>, settings: &Settings) -> Vec<Fault> {
    const ELSEWHERE: [E; 6] =
        [E::MissingTarget, E::SeveralTargets, E::MissingLabel, E::SeveralLabels, E::LabelElsewhere, E::LoopUnpaired];
    let (mut unread, mut faults) = (Unread::new(source.line_count()), Vec::new());
    while unread.advance((source, settings), None, u32::MAX, &mut |fault| faults.push(fault)) {}
    faults.retain(|fault: &Fault| !ELSEWHERE.contains(&fault.error));
    faults
}

/// The state of a run when it began to repeat lines; restored if the repetition turns out to be endless.
#[derive(Clone, Debug)]
struct Progress {
    /// No new line was reached since.
    over: bool,
    come: Come,
    memory: Memory,
    /// Blocks passed to `sink`, and mistakes found, up to there.
    shown: u64,
    faults: usize,
    /// The current line of the main program, from 0.
    line: u32,
    /// The line (from 0) of the last backward jump since.
    back: Option<u32>,
}

/// A check in progress: follows the program without a machine, then reads the lines that were not executed.
pub struct Checking {
    source: Arc<Source>,
    settings: Settings,
    interpreter: Interpreter,
    block: Block,
    found: Checked,
    /// The lines that were not executed; read when the run is over.
    unread: Unread,
    over: bool,
    told: HashSet<(u32, u32, E)>,
    progress: Progress,
    /// Blocks since the last new line, and how many of them make a loop endless.
    standstill: u32,
    limit: u32,
    /// Endless loops left so far.
    left: u32,
    /// How many endless loops may be left.
    leaves: u32,
    /// A null word was skipped somewhere: the modal state may differ from that in the real run.
    left_out: bool,
    /// Number of blocks passed to `sink`.
    shown: u64,
}

impl Checking {
    /// Starts at the head of a program.
    #[must_use]
    pub fn new(
        source: &Arc<Source>,
        library: &Arc<dyn Library + Send + Sync>,
        settings: &Settings,
        memory: Memory,
    ) -> Self {
        let mut interpreter =
            Interpreter::new(Arc::clone(source), Arc::clone(library), settings.clone(), memory.clone());
        interpreter.nulls = Some(Vec::new());
        interpreter.notes = Some(Vec::new());
        let come = Come::default();
        Self {
            source: Arc::clone(source),
            settings: settings.clone(),
            interpreter,
            block: Block::new(settings),
            found: Checked::default(),
            unread: Unread::new(source.line_count()),
            over: false,
            told: HashSet::new(),
            progress: Progress { over: false, come, memory, shown: 0, faults: 0, line: 0, back: None },
            standstill: 0,
            limit: STANDSTILL_LIMIT,
            left: 0,
            leaves: LEFT_LOOPS,
            left_out: false,
            shown: 0,
        }
    }

    /// Sets how many blocks without a new line make a loop endless; the check stops at the first such loop.
    #[must_use]
    pub const fn with_limit(mut self, blocks: u32) -> Self {
        (self.limit, self.leaves) = (blocks, 0);
        self
    }

    /// The mistakes so far, in the order found.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.found.faults
    }

    /// The result; valid when the check is over.
    #[must_use]
    pub fn found(self, world: &CheckWorld) -> Checked {
        let number = self.source.number();
        let mut found = self.found;
        found.faults.sort_by_key(|fault| (fault.place.program != number, fault.place.program, fault.place.line));
        (found.length_mm, found.seconds, found.extents) = (world.length_mm(), world.seconds(), world.extents());
        found.blocks = self.shown - found.repeated.iter().map(|range| range.end - range.start).sum::<u64>();
        found.lines = self.source.line_count();
        found
    }

    /// Continues for at most `most` blocks or lines; `false` when the check is over or `sink` returned false.
    pub fn advance(&mut self, world: &mut CheckWorld, sink: &mut dyn FnMut(&Block) -> bool, most: u32) -> bool {
        if self.over {
            let mut faults = Vec::new();
            let library = Arc::clone(&self.interpreter.library);
            let text = (&*self.source, &self.settings);
            let more = self.unread.advance(text, Some(&*library), most, &mut |fault| faults.push(fault));
            faults.into_iter().for_each(|fault| self.fault(fault));
            return more;
        }
        for _ in 0..most {
            if self.interpreter.has_ended() {
                return self.end(true);
            }
            let main = self.look_at_line(world);
            if self.standstill > self.limit {
                self.give_up(world);
                if self.left > self.leaves || !self.interpreter.leave_loop() {
                    return self.end(false);
                }
                self.standstill = 0;
                continue;
            }
            match self.interpreter.single(world, &mut self.block) {
                Ok(more) => {
                    self.left_out = self.left_out || self.interpreter.has_met_null();
                    if !self.block.ops.is_empty() {
                        self.shown += 1;
                        self.block.ops.iter().for_each(|op| world.apply(op));
                        if !sink(&self.block) {
                            return false;
                        }
                    }
                    if let (false, Some(line)) = (more, main) {
                        self.unread.text_end = Some(line);
                    }
                    if !more || self.interpreter.has_restarted() {
                        return self.end(true);
                    }
                }
                Err(fault) => {
                    self.left_out = self.left_out || self.interpreter.has_met_null();
                    let error = fault.error;
                    self.judge(fault);
                    self.interpreter.skip(error);
                }
            }
            if self.interpreter.has_remarks() {
                self.interpreter.remarks().into_iter().for_each(|fault| self.warn(fault));
            }
        }
        true
    }

    /// Marks the line that is read next; returns its number (from 0) if it belongs to the main program.
    #[inline]
    fn look_at_line(&mut self, world: &CheckWorld) -> Option<u32> {
        let (source, line) = self.interpreter.at_line();
        let main = Arc::ptr_eq(source, &self.source);
        let new = main && self.unread.visited.mark(line);
        self.standstill = if new { 0 } else { self.standstill + 1 };
        let progress = &mut self.progress;
        if new {
            progress.over = false;
        } else if !progress.over {
            progress.come = world.come();
            progress.memory.clone_from(self.interpreter.memory());
            (progress.over, progress.back) = (true, None);
            (progress.shown, progress.faults) = (self.shown, self.found.faults.len());
        }
        if main {
            if !new && line < progress.line {
                progress.back = Some(progress.line);
            }
            progress.line = line;
        }
        main.then_some(line)
    }

    /// Reports an endless loop at the line that jumps back. Its repetitions do not count: path length, variables and
    /// position are restored to the start of the repetition.
    fn give_up(&mut self, world: &mut CheckWorld) {
        let (place, title) = match self.progress.back {
            Some(line) => (Place { program: self.source.number(), line: line + 1, n: None }, self.source.title()),
            None => (self.interpreter.place(), self.interpreter.at_line().0.title()),
        };
        self.warn(Fault::new(title, place, 1, Wrong { at: 0, error: E::Endless, details: Default::default() }));
        let Progress { come, memory, shown, faults, .. } = &self.progress;
        world.go_back(*come);
        self.interpreter.put_memory(memory.clone());
        if *shown < self.shown {
            self.found.repeated.push(*shown..self.shown);
        }
        // A value that grows with every repetition is not a mistake of the text.
        let (kept, mut index) = (*faults, 0);
        self.found.faults.retain(|fault| {
            index += 1;
            index <= kept || !matches!(fault.error, E::OutOfRange | E::Overflow)
        });
        (self.progress.shown, self.progress.faults) = (self.shown, self.found.faults.len());
        self.left += 1;
    }

    /// Ends the run; the lines that were not executed are read next.
    fn end(&mut self, finished: bool) -> bool {
        self.found.finished = finished && self.left == 0;
        self.over = true;
        let source = Arc::clone(&self.source);
        unread::whole(&source, &self.settings).for_each(|fault| self.fault(fault));
        true
    }

    /// A consequence of null variables is only a warning: the operator sets them before the real run.
    fn judge(&mut self, fault: Fault) {
        let (null_here, left_out) = (self.interpreter.has_met_null(), self.left_out);
        let by_null = match fault.error {
            E::MissingWord | E::ArcWithoutCentre => null_here,
            E::ArcEndOff | E::ArcRadius => null_here || self.left > 0,
            E::DivisionByZero => null_here && fault.detail().is_empty(),
            E::Domain | E::OutOfRange | E::BadVariable | E::SwitchVariable => null_here,
            E::FeedMissing => left_out,
            // The position after a loop that was left is unknown.
            E::ArcTooSmall | E::FullCircleByRadius | E::RectangleSide => self.left > 0,
            _ => false,
        };
        if by_null { self.warn(fault) } else { self.fault(fault) }
    }

    fn is_new(&mut self, place: Place, error: E) -> bool {
        self.told.insert((place.program, place.line, error))
    }

    fn fault(&mut self, fault: Fault) {
        if self.found.faults.len() < FAULT_LIMIT && self.is_new(fault.place, fault.error) {
            self.found.faults.push(fault);
        }
    }

    fn warn(&mut self, fault: Fault) {
        if self.found.warnings.len() < FAULT_LIMIT && self.is_new(fault.place, fault.error) {
            self.found.warnings.push(fault);
        }
    }
}
