//! The check of a whole program: every mistake, path length, time and extents, without a machine. Source: spec B1, T4.

use std::collections::HashSet;
use std::sync::Arc;

use super::dialect;
use super::fault::{Fault, Place, Stop, Wrong, fault_in};
use super::interpreter::{Block, Interpreter};
use super::lexer::Cursor;
use super::memory::Memory;
use super::settings::Settings;
use super::source::{Library, Source, at_head};
use super::statement::{self, Blank, Content, Head};
use super::words::Words;
use super::world::CheckWorld;
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
    /// Blocks that had operations.
    pub blocks: u64,
    /// The run came to its end (or to its M99) and was not given up.
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
    let mut interpreter = Interpreter::new(Arc::clone(source), Arc::clone(library), settings.clone(), memory);
    interpreter.nulls = Some(Vec::new());
    interpreter.notes = Some(Vec::new());
    let mut run = Run {
        source,
        settings,
        found: Checked::default(),
        visited: Visited::new(source.line_count()),
        told: HashSet::new(),
        text_end: None,
        repeated: Way::default(),
    };
    if run.follow(&mut interpreter, world, sink) {
        run.read_the_rest();
    }
    let repeated = run.repeated;
    let mut found = run.found;
    found.faults.sort_by_key(|fault| (fault.place.program != source.number(), fault.place.program, fault.place.line));
    found.length_mm = world.length_mm() - repeated.length_mm;
    found.seconds = world.seconds() - repeated.seconds;
    found.extents = world.extents();
    found.lines = source.line_count();
    found
}

/// Reads the lines of a text for their writing alone, as far as that can be judged without the rest of the program:
/// where a jump leads is not looked at.
#[must_use]
pub fn look(source: &Arc<Source>, settings: &Settings) -> Vec<Fault> {
    let visited = Visited::new(source.line_count());
    let found = Checked::default();
    let repeated = Way::default();
    let mut run = Run { source, settings, found, visited, told: HashSet::new(), text_end: None, repeated };
    run.read_the_rest();
    run.found.faults.retain(|fault| !matches!(fault.error, E::MissingTarget | E::MissingLabel | E::LabelElsewhere));
    run.found.faults
}

/// One bit a line.
struct Visited(Vec<u64>);

impl Visited {
    fn new(lines: usize) -> Self {
        Self(vec![0; lines / 64 + 1])
    }

    /// Marks a line; whether it is new.
    #[inline]
    fn mark(&mut self, line: u32) -> bool {
        let Some(word) = self.0.get_mut(line as usize / 64) else { return false };
        let bit = 1 << (line % 64);
        let new = *word & bit == 0;
        *word |= bit;
        new
    }
}

struct Run<'r> {
    source: &'r Arc<Source>,
    settings: &'r Settings,
    found: Checked,
    visited: Visited,
    told: HashSet<(u32, u32, E)>,
    /// The line (from 0) behind which nothing counts: its `%` ended the run.
    text_end: Option<u32>,
    /// What loops that do not end here have come to.
    repeated: Way,
}

/// Way and time of a world.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    length_mm: f64,
    seconds: f64,
}

impl Way {
    fn of(world: &CheckWorld) -> Self {
        Self { length_mm: world.length_mm(), seconds: world.seconds() }
    }
}

/// How far a run has come: to its last line that was new.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    way: Way,
    /// The main program's line, from 0, at present.
    line: u32,
    /// Where it went back since, last.
    back: Option<u32>,
}

impl Progress {
    /// A line of the main program; `new` if the run has not been there.
    #[inline]
    fn see(&mut self, line: u32, new: bool, world: &CheckWorld) {
        if new {
            (self.way, self.back) = (Way::of(world), None);
        } else if line < self.line {
            self.back = Some(self.line);
        }
        self.line = line;
    }
}

impl Run<'_> {
    /// Runs the program; false when the sink had enough.
    fn follow(
        &mut self,
        interpreter: &mut Interpreter,
        world: &mut CheckWorld,
        sink: &mut dyn FnMut(&Block) -> bool,
    ) -> bool {
        let mut block = Block::new(self.settings);
        let (mut standstill, mut left, mut progress) = (0, 0, Progress::default());
        // A word was left out somewhere: what is in force may differ from what it will be in the run.
        let mut left_out = false;
        while !interpreter.has_ended() {
            let (source, line) = interpreter.at_line();
            let main = Arc::ptr_eq(source, self.source);
            let new = main && self.visited.mark(line);
            if main {
                progress.see(line, new, world);
            }
            standstill = if new { 0 } else { standstill + 1 };
            if standstill > STANDSTILL_LIMIT {
                self.give_up(interpreter, progress, world);
                progress.way = Way::of(world);
                left += 1;
                if left > LEFT_LOOPS || !interpreter.leave_loop() {
                    return true;
                }
                standstill = 0;
            }
            match interpreter.single(world, &mut block) {
                Ok(more) => {
                    left_out = left_out || interpreter.has_met_null();
                    if !block.ops.is_empty() {
                        self.found.blocks += 1;
                        block.ops.iter().for_each(|op| world.apply(op));
                        if !sink(&block) {
                            return false;
                        }
                    }
                    if !more && main {
                        self.text_end = Some(line);
                    }
                    if !more || interpreter.has_restarted() {
                        break;
                    }
                }
                Err(fault) => {
                    left_out = left_out || interpreter.has_met_null();
                    let error = fault.error;
                    self.judge(fault, interpreter.has_met_null(), left_out);
                    interpreter.skip(error);
                }
            }
            if interpreter.has_remarks() {
                interpreter.remarks().into_iter().for_each(|fault| self.warn(fault));
            }
        }
        self.found.finished = true;
        true
    }

    /// Tells of a loop that does not end here, at the line that leads back into it; its repetitions do not count.
    fn give_up(&mut self, interpreter: &Interpreter, progress: Progress, world: &CheckWorld) {
        let (place, title) = match progress.back {
            Some(line) => (Place { program: self.source.number(), line: line + 1, n: None }, self.source.title()),
            None => (interpreter.place(), interpreter.at_line().0.title()),
        };
        self.warn(Fault::new(title, place, 1, Wrong { at: 0, error: E::Endless, details: Default::default() }));
        let now = Way::of(world);
        self.repeated.length_mm += now.length_mm - progress.way.length_mm;
        self.repeated.seconds += now.seconds - progress.way.seconds;
    }

    /// Lines that the run did not come to are read for their writing.
    fn read_the_rest(&mut self) {
        let source = Arc::clone(self.source);
        let text = source.bytes();
        let mut words = Words::default();
        for line in 0..source.line_count() as u32 {
            if self.text_end.is_some_and(|end| line > end) {
                return;
            }
            if !self.visited.mark(line) {
                continue;
            }
            let mut cursor = Cursor::window(text, source.start(line));
            let mut head = Head { mid_line: false, block_skip: false };
            loop {
                let at = cursor.at;
                let read = dialect::read(self.settings.system, &mut cursor, &mut Blank, &mut words, head);
                let cut = cursor.is_cut(text);
                let read = read.and_then(|content| match content {
                    _ if cut => super::fault::wrong(at, E::BlockTooLong),
                    Content::Words => dialect::look(&words, self.settings, (text, at)),
                    Content::TextEnd { at } if !at_head(text, at) => {
                        self.text_end = Some(line);
                        Ok(())
                    }
                    Content::Goto { n, at } if n > 0 && source.find_block(n, at).is_none() => {
                        super::fault::wrong1(at, E::MissingTarget, format!("N{n}"))
                    }
                    Content::Jump { label, forward, .. } => source.find_label(label, line, forward).map(drop),
                    _ => Ok(()),
                });
                if let Err(stop) = read {
                    if let Stop::Wrong(wrong) = *stop {
                        self.fault(fault_in(&source, words.n, wrong));
                    }
                    break;
                }
                if !statement::goes_on(&cursor) || cursor.at <= at {
                    break;
                }
                head.mid_line = true;
            }
        }
    }

    /// What variables without a value cause is no mistake of the text: the operator will have given them.
    fn judge(&mut self, fault: Fault, null_here: bool, left_out: bool) {
        let by_null = match fault.error {
            E::MissingWord | E::ArcWithoutCentre | E::ArcEndOff | E::ArcRadius => null_here,
            E::DivisionByZero => null_here && fault.detail().is_empty(),
            E::Domain | E::OutOfRange | E::BadVariable | E::SwitchVariable => null_here,
            E::FeedMissing => left_out,
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
