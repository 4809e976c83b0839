//! The check of a whole program: every mistake, path length, time and extents, without a machine. Source: spec B1, T4.

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

/// After this many mistakes, or warnings, no more are collected.
pub const FAULT_LIMIT: usize = 1_000;
/// A run that reads this many blocks without coming to a new line of the program is in a loop that waits for something.
pub const STANDSTILL_LIMIT: u32 = 1_000_000;
/// How many such loops a check leaves before it gives up following the program.
const LEFT_LOOPS: u32 = 4;

/// What a check found.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// Every mistake, in the order of lines, each line once.
    pub faults: Vec<Fault>,
    /// What is allowed and seldom meant: null in arithmetic, a block after `;`, a loop that does not end here.
    pub warnings: Vec<Fault>,
    /// The way of all moves, mm; of a loop that does not end here, up to where it began to repeat.
    pub length_mm: f64,
    /// The time at programmed feeds, acceleration left out, seconds; counted as the way.
    pub seconds: f64,
    /// Least and greatest coordinates of all moves, work frame, radius mm; none without a move.
    pub extents: Option<(PerAxis<f64>, PerAxis<f64>)>,
    /// Lines of the text.
    pub lines: usize,
    /// Blocks that had operations; of a loop that does not end here, up to where it began to repeat.
    pub blocks: u64,
    /// Of all blocks that `sink` has seen, from 0: those of a loop that does not end here, from where it began to repeat.
    pub repeated: Vec<Range<u64>>,
    /// The run came to its end (or to its M99), and no loop was left on the way.
    pub finished: bool,
}

/// Checks a program from a cold start.
#[must_use]
pub fn check(source: &Arc<Source>, library: &Arc<dyn Library + Send + Sync>, settings: &Settings) -> Checked {
    check_with(source, library, settings, Memory::default(), &mut CheckWorld::new(settings), &mut |_| {})
}

/// Checks a program with given variables and world, and shows every block to `sink`.
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

/// As [`check_with`], until `sink` says false: then the check is not finished.
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

/// Reads the lines of a text for their writing alone, as far as that can be judged without the rest of the program:
/// where a jump leads is not looked at.
#[must_use]
pub fn look(source: &Arc<Source>, settings: &Settings) -> Vec<Fault> {
    const ELSEWHERE: [E; 6] =
        [E::MissingTarget, E::SeveralTargets, E::MissingLabel, E::SeveralLabels, E::LabelElsewhere, E::LoopUnpaired];
    let (mut unread, mut faults) = (Unread::new(source.line_count()), Vec::new());
    while unread.advance((source, settings), None, u32::MAX, &mut |fault| faults.push(fault)) {}
    faults.retain(|fault: &Fault| !ELSEWHERE.contains(&fault.error));
    faults
}

/// How far a run has come: to where it first went over lines that were not new any more.
#[derive(Clone, Debug)]
struct Progress {
    /// No new line since.
    over: bool,
    come: Come,
    memory: Memory,
    /// Blocks that were shown, and mistakes that were found.
    shown: u64,
    faults: usize,
    /// The main program's line, from 0, at present.
    line: u32,
    /// Where it went back since, last.
    back: Option<u32>,
}

/// A check under way: a program followed without a machine, then the lines that the run did not come to.
pub struct Checking {
    source: Arc<Source>,
    settings: Settings,
    interpreter: Interpreter,
    block: Block,
    found: Checked,
    /// The lines that the run has not come to, once it is over.
    unread: Unread,
    over: bool,
    told: HashSet<(u32, u32, E)>,
    progress: Progress,
    /// Blocks without a new line, and how many make a loop that does not end here.
    standstill: u32,
    limit: u32,
    /// Loops that were left.
    left: u32,
    /// How many may be.
    leaves: u32,
    /// A word was left out somewhere: what is in force may differ from what it will be in the run.
    left_out: bool,
    /// Blocks that `sink` has seen.
    shown: u64,
}

impl Checking {
    /// Stands at the head of a program.
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

    /// With so many blocks without a new line as the sign of a loop that does not end here; nothing behind it is run.
    #[must_use]
    pub const fn with_limit(mut self, blocks: u32) -> Self {
        (self.limit, self.leaves) = (blocks, 0);
        self
    }

    /// The mistakes found so far, as they were met.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        &self.found.faults
    }

    /// What was found, when it is over.
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

    /// Goes on for at most so many blocks, or lines that the run has not come to; `false` when it is over, or when
    /// `sink` had enough.
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

    /// Marks the line that is read next; its number, from 0, if it is one of the main program.
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

    /// Tells of a loop that does not end here, at the line that leads back into it. Its repetitions do not count: way,
    /// values and place are as when it began to repeat.
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
        // A value that has grown with every repetition is no mistake of the text.
        let (kept, mut index) = (*faults, 0);
        self.found.faults.retain(|fault| {
            index += 1;
            index <= kept || !matches!(fault.error, E::OutOfRange | E::Overflow)
        });
        (self.progress.shown, self.progress.faults) = (self.shown, self.found.faults.len());
        self.left += 1;
    }

    /// The run is over: lines that it did not come to are still to be read.
    fn end(&mut self, finished: bool) -> bool {
        self.found.finished = finished && self.left == 0;
        self.over = true;
        let source = Arc::clone(&self.source);
        unread::whole(&source, &self.settings).for_each(|fault| self.fault(fault));
        true
    }

    /// What variables without a value cause is no mistake of the text: the operator will have given them.
    fn judge(&mut self, fault: Fault) {
        let (null_here, left_out) = (self.interpreter.has_met_null(), self.left_out);
        let by_null = match fault.error {
            E::MissingWord | E::ArcWithoutCentre => null_here,
            E::ArcEndOff | E::ArcRadius => null_here || self.left > 0,
            E::DivisionByZero => null_here && fault.detail().is_empty(),
            E::Domain | E::OutOfRange | E::BadVariable | E::SwitchVariable => null_here,
            E::FeedMissing => left_out,
            // Where the run would stand behind a loop that was left is not known.
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
