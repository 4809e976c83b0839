//! Checks a whole program without a machine: all mistakes, path length, time and extents. Source: spec B1, T4.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use super::block::Block;
use super::called_texts::{CalledTexts, TextLine};
use super::common_variables::CommonVariables;
use super::dialect;
use super::external_state::{OfflineMachine, RunTotals};
use super::fault::{BlockLocation, CallChain, E, ErrorAt, ProgramFault};
use super::flow::CallDepth;
use super::idle_passes::IdlePasses;
use super::interpreter::{BLOCK_WORK, Interpreter};
use super::lost_state::LostState;
use super::op::Op;
use super::settings::NcSettings;
use super::source::{SharedLibrary, Source};
use super::unexecuted_blocks::{Certainty, LoneBlocks};
use super::unexecuted_lines::{self, UnexecutedLines};
use crate::defs::program_number;
use crate::defs::text::arg::Arg;
use crate::units::{WorkBudget, WorkPos};

/// Most mistakes, and most warnings, that are collected.
pub const MAX_FAULTS: usize = 1_000;
/// A run that reads this many blocks without reaching a new line of the program is in an endless (waiting) loop.
pub const STANDSTILL_LIMIT: u32 = 1_000_000;
/// Mistakes, and warnings, for which a preflight takes memory at power-on.
const USUAL_FINDINGS: usize = 64;
/// How many such loops a check leaves before it stops following the program.
const MAX_LEFT_LOOPS: u32 = 8;
/// Passes in which nothing changes after which a loop waits for what a check does not have. An input that toggles with
/// every reading changes in fewer.
const MAX_IDLE_PASSES: u32 = 4;

/// The result of a check.
#[derive(Clone, Debug, Default)]
pub struct CheckReport {
    /// All mistakes in line order; each kind once per line.
    pub faults: Vec<ProgramFault>,
    /// Allowed but rarely intended: null in arithmetic, a block after `;`, a loop that is not followed to its end.
    pub warnings: Vec<ProgramFault>,
    /// Path length of all moves, mm. An endless loop counts up to its first repetition.
    pub length_mm: f64,
    /// Time at programmed feeds without acceleration, seconds; endless loops as in `length_mm`.
    pub seconds: f64,
    /// Least and greatest work coordinates of all moves, radius mm; none without a move.
    pub extents: Option<(WorkPos, WorkPos)>,
    /// Lines of the text.
    pub lines: usize,
    /// Number of blocks with operations; endless loops as in `length_mm`.
    pub blocks: u64,
    /// The blocks passed to `sink` (counted from 0) that are repetitions of an endless loop.
    pub repeated_blocks: Vec<Range<u64>>,
    /// The run reached its end (or its M99) without leaving an endless loop.
    pub finished: bool,
    /// It did, by an M99 that begins the main program anew.
    pub begins_anew: bool,
    /// The programs that it calls, in the order of the first calls.
    pub called: Vec<u32>,
}

impl CheckReport {
    /// Empties the report and keeps its memory.
    fn clear(&mut self) {
        let Self { mut faults, mut warnings, mut repeated_blocks, .. } = std::mem::take(self);
        faults.clear();
        warnings.clear();
        repeated_blocks.clear();
        *self = Self { faults, warnings, repeated_blocks, ..Self::default() };
    }
}

/// Checks a program from a cold start.
#[must_use]
pub fn check(source: &Arc<Source>, library: &SharedLibrary, settings: &NcSettings) -> CheckReport {
    let mut world = OfflineMachine::new(settings);
    ProgramCheck::new(source, library, settings, CommonVariables::default()).run(&mut world, &mut |_| {})
}

/// The state of a run when it began to repeat lines; restored if the repetition turns out to be endless.
#[derive(Clone, Debug, Default)]
struct LoopCheckpoint {
    /// No new line was reached since.
    repeating: bool,
    totals: RunTotals,
    variables: CommonVariables,
    /// Blocks passed to `sink`, and mistakes found, up to there.
    shown_blocks: u64,
    faults: usize,
    /// The current line of the main program, from 0.
    line: u32,
    /// The line (from 0) of the last backward jump since.
    jump_back_line: Option<u32>,
}

impl LoopCheckpoint {
    /// At the head of a program, in the same memory. The variables count from the first repetition on.
    fn clear(&mut self) {
        let Self { repeating, totals, variables: _, shown_blocks, faults, line, jump_back_line } = self;
        (*repeating, *totals, *jump_back_line) = (false, RunTotals::default(), None);
        (*shown_blocks, *faults, *line) = (0, 0, 0);
    }
}

/// A check in progress: follows the program without a machine, then reads the lines that were not executed.
pub struct ProgramCheck {
    source: Arc<Source>,
    settings: NcSettings,
    interpreter: Interpreter,
    block: Block,
    report: CheckReport,
    /// The lines that were not executed; read when the run is over.
    unread: UnexecutedLines,
    /// The programs that it calls, in the order of the first calls.
    called: CalledTexts,
    /// The line that the run has reached, later that whose blocks are executed by themselves.
    place: TextLine,
    run_over: bool,
    /// What executes blocks by themselves.
    lone: Option<LoneBlocks>,
    reported: HashSet<(u32, u32, E)>,
    checkpoint: LoopCheckpoint,
    /// Blocks since the last new line, and how many of them make a loop endless.
    standstill: u32,
    standstill_limit: u32,
    /// Endless loops left so far, and how many may be left.
    left_loops: u32,
    max_left_loops: u32,
    /// A loop was left before its end.
    incomplete: bool,
    /// A null word was skipped somewhere: the modal state may differ from that in the real run.
    word_left_out: bool,
    lost: LostState,
    /// A common variable without a value was read: the operator, or a program before, sets it.
    reads_unset: bool,
    /// The program has raised an alarm, which ends a run: the values behind it are those that it refuses.
    alarm_passed: bool,
    /// Number of blocks passed to `sink`.
    shown_blocks: u64,
}

impl ProgramCheck {
    /// Starts at the head of a program.
    #[must_use]
    pub fn new(source: &Arc<Source>, library: &SharedLibrary, settings: &NcSettings, memory: CommonVariables) -> Self {
        let mut interpreter =
            Interpreter::new(Arc::clone(source), Arc::clone(library), settings.clone(), memory.clone());
        interpreter.null_uses = Some(Vec::new());
        interpreter.warnings = Some(Vec::new());
        Self {
            source: Arc::clone(source),
            settings: settings.clone(),
            interpreter,
            block: Block::new(settings),
            report: CheckReport::default(),
            unread: UnexecutedLines::new(source.line_count()),
            called: CalledTexts::default(),
            place: TextLine::default(),
            run_over: false,
            lone: None,
            reported: HashSet::new(),
            checkpoint: LoopCheckpoint { variables: memory, ..LoopCheckpoint::default() },
            standstill: 0,
            standstill_limit: STANDSTILL_LIMIT,
            left_loops: 0,
            max_left_loops: MAX_LEFT_LOOPS,
            incomplete: false,
            word_left_out: false,
            lost: LostState::default(),
            reads_unset: false,
            alarm_passed: false,
            shown_blocks: 0,
        }
    }

    /// Starts at the head of another program, in the memory of this check.
    pub fn begin(&mut self, program: (Arc<Source>, SharedLibrary), settings: &NcSettings, memory: &CommonVariables) {
        self.unread.begin(program.0.line_count());
        self.source = Arc::clone(&program.0);
        self.interpreter.begin(program, settings.clone(), memory);
        self.settings = settings.clone();
        self.block.restart(*self.interpreter.modals());
        self.report.clear();
        self.reported.clear();
        self.checkpoint.clear();
        self.called.clear();
        (self.place, self.lone) = (TextLine::default(), None);
        (self.run_over, self.word_left_out, self.reads_unset, self.incomplete) = (false, false, false, false);
        (self.standstill, self.left_loops, self.shown_blocks) = (0, 0, 0);
        (self.alarm_passed, self.lost) = (false, LostState::default());
    }

    /// Takes memory for a program of this many lines, and for some findings.
    pub(crate) fn reserve(&mut self, lines: usize) {
        self.unread = UnexecutedLines::with_capacity(lines);
        self.report.faults.reserve(USUAL_FINDINGS);
        self.report.warnings.reserve(USUAL_FINDINGS);
        self.reported.reserve(2 * USUAL_FINDINGS);
        self.interpreter.warnings.iter_mut().for_each(|warnings| warnings.reserve(USUAL_FINDINGS));
    }

    /// Lets go of the program; another takes its place.
    pub fn leave(&mut self, program: (Arc<Source>, SharedLibrary)) {
        self.source = Arc::clone(&program.0);
        self.interpreter.leave(program);
        self.block.restart(*self.interpreter.modals());
    }

    /// Sets how many blocks without a new line make a loop endless; the check stops at the first such loop.
    #[must_use]
    pub const fn with_standstill_limit(mut self, blocks: u32) -> Self {
        (self.standstill_limit, self.max_left_loops) = (blocks, 0);
        self
    }

    /// Runs to the end; passes every block to `sink`.
    pub fn run(self, world: &mut OfflineMachine, sink: &mut dyn FnMut(&Block)) -> CheckReport {
        self.run_until(world, &mut |block| {
            sink(block);
            true
        })
    }

    /// As [`Self::run`], until `sink` returns false; the check is then not finished.
    pub fn run_until(mut self, world: &mut OfflineMachine, sink: &mut dyn FnMut(&Block) -> bool) -> CheckReport {
        while self.advance(world, sink, &mut WorkBudget::unlimited()) {}
        self.into_report(world)
    }

    /// The mistakes so far, in the order found.
    #[must_use]
    pub fn faults(&self) -> &[ProgramFault] {
        &self.report.faults
    }

    /// The result; valid when the check is over.
    #[must_use]
    pub fn into_report(self, world: &OfflineMachine) -> CheckReport {
        let number = self.source.number();
        let mut found = self.report;
        found
            .faults
            .sort_by_key(|fault| (fault.location.program != number, fault.location.program, fault.location.line));
        (found.length_mm, found.seconds, found.extents) = (world.length_mm(), world.seconds(), world.extents());
        found.blocks =
            self.shown_blocks - found.repeated_blocks.iter().map(|range| range.end - range.start).sum::<u64>();
        found.lines = self.source.line_count();
        found.called = self.called.numbers().collect();
        found
    }

    /// Continues until the budget is spent on blocks and lines; `false` when the check is over or `sink` returned false.
    pub fn advance(
        &mut self,
        world: &mut OfflineMachine,
        sink: &mut dyn FnMut(&Block) -> bool,
        budget: &mut WorkBudget,
    ) -> bool {
        if self.run_over {
            return self.check_unexecuted(world, budget);
        }
        while !budget.is_spent() {
            if self.interpreter.is_over() {
                return self.finish_run(true);
            }
            let main = self.mark_line(world);
            if self.standstill > self.standstill_limit {
                self.report_endless_loop(world);
                if self.left_loops > self.max_left_loops || !self.leave_loops() {
                    return self.finish_run(false);
                }
                self.standstill = 0;
                continue;
            }
            let read = self.interpreter.read_one(world, &mut self.block);
            self.interpreter.charge_blocks(budget);
            self.note_values();
            match read {
                Ok(more) => {
                    if !self.block.ops.is_empty() {
                        self.shown_blocks += 1;
                        self.block.ops.iter().for_each(|op| world.apply(op));
                        self.note_alarm(world);
                        if !sink(&self.block) {
                            return false;
                        }
                    }
                    if let (false, Some(line)) = (more, main) {
                        self.unread.text_end = Some(line);
                    }
                    if !more || self.interpreter.has_restarted() {
                        return self.finish_run(true);
                    }
                }
                Err(fault) => {
                    let error = fault.error;
                    self.classify(fault);
                    self.lost.note(self.interpreter.flow.line_text());
                    self.interpreter.skip_faulty_block(error);
                }
            }
            if self.interpreter.idle_passes() >= MAX_IDLE_PASSES && !self.leave_wait() {
                return self.finish_run(false);
            }
            if self.interpreter.has_warnings() {
                let Self { interpreter, report, reported, .. } = self;
                interpreter.take_warnings(&mut |fault| add_once(&mut report.warnings, reported, fault));
            }
        }
        true
    }

    /// Marks the line that is read next; returns its number (from 0) if it belongs to the main program.
    #[inline]
    fn mark_line(&mut self, world: &OfflineMachine) -> Option<u32> {
        let line = self.interpreter.flow.place.line;
        let main = Arc::ptr_eq(&self.interpreter.flow.source, &self.source);
        let new = main && self.unread.marks.mark(line);
        let (place, new) = if main { (TextLine { text: 0, line }, new) } else { self.mark_called(line) };
        self.place = place;
        self.standstill = if new { 0 } else { self.standstill + 1 };
        let progress = &mut self.checkpoint;
        if new {
            progress.repeating = false;
        } else if !progress.repeating {
            progress.totals = world.totals();
            progress.variables.clone_from(self.interpreter.common_variables());
            (progress.repeating, progress.jump_back_line) = (true, None);
            (progress.shown_blocks, progress.faults) = (self.shown_blocks, self.report.faults.len());
        }
        if main {
            if !new && line < progress.line {
                progress.jump_back_line = Some(progress.line);
            }
            progress.line = line;
        }
        main.then_some(line)
    }

    /// Marks a line of a called program; true if it is new.
    fn mark_called(&mut self, line: u32) -> (TextLine, bool) {
        let (flow, likely) = (&self.interpreter.flow, self.place.text);
        let text = self.called.find(&flow.source, likely).unwrap_or_else(|| {
            self.called.add((Arc::clone(&flow.source), *flow.locals(), flow.call_depth()), flow.calls());
            self.called.find(&flow.source, likely).unwrap_or(usize::MAX)
        });
        let new = self.called.get_mut(text).is_some_and(|text| text.marks.mark(line));
        (TextLine { text, line }, new)
    }

    /// Marks the lines that a cycle has read for its contour.
    #[cold]
    fn mark_contour(&mut self) {
        let marks = match self.place.text {
            0 => Some(&mut self.unread.marks),
            text => self.called.get_mut(text).map(|text| &mut text.marks),
        };
        let lines = self.interpreter.contour_memory.iter().flat_map(|memory| memory.ops.iter().map(|(_, line)| *line));
        if let Some(marks) = marks {
            lines.for_each(|line| {
                marks.mark(line - 1);
            });
        }
    }

    /// Notes the result of the IF in the line that was read last.
    fn mark_condition(&mut self, holds: bool) {
        let TextLine { text, line } = self.place;
        let marks = match text {
            0 => Some(&mut self.unread.marks),
            _ => self.called.get_mut(text).map(|text| &mut text.marks),
        };
        marks.into_iter().for_each(|marks| marks.mark_condition(line, holds));
    }

    /// Checks what the run did not reach until the budget is spent; `false` when all is checked.
    fn check_unexecuted(&mut self, world: &OfflineMachine, budget: &mut WorkBudget) -> bool {
        if dialect::rules(self.settings.dialect).executes_lone_blocks {
            return self.execute_lone_blocks(world, budget);
        }
        let Self { source, settings, interpreter, unread, called, place, report, reported, .. } = self;
        let mut found = |fault| add_once(&mut report.faults, reported, fault);
        let text = called.get(place.text).map_or(&*source, |text| &text.source);
        if unread.advance(text, settings, Some(&*interpreter.library), budget, &mut found) {
            return true;
        }
        // The programs that the run has called, and those that the lines call which it did not reach.
        for number in unread.calls.drain(..).map(|(number, _)| number) {
            if let Some(found) = interpreter.library.find(number).filter(|found| !Arc::ptr_eq(found, source)) {
                called.add((found, [None; 33], CallDepth::default()), CallChain::default());
            }
        }
        let Some(next) = called.get_mut(place.text + 1) else { return false };
        unread.continue_with(std::mem::take(&mut next.marks));
        place.text += 1;
        let text = Arc::clone(&next.source);
        unexecuted_lines::check_whole_text(&text, settings)
            .for_each(|fault| add_once(&mut report.faults, reported, fault));
        true
    }

    /// Executes the blocks that the run did not reach, of the program and of all that it calls.
    fn execute_lone_blocks(&mut self, world: &OfflineMachine, budget: &mut WorkBudget) -> bool {
        let Self { source, unread, interpreter, called, place, lone, report, reported, .. } = self;
        let blocks = lone.get_or_insert_with(|| {
            *place = TextLine::default();
            interpreter.conditions_hold = true;
            let locals = *interpreter.flow.first_locals();
            LoneBlocks::new((Arc::clone(source), locals), world.clone(), Block::new(&interpreter.settings))
        });
        while !budget.is_spent() {
            budget.spend(BLOCK_WORK);
            let line = place.line;
            if line as usize >= blocks.source.line_count() || blocks.source.ends_in_line(line) {
                let Some(next) = called.get(place.text + 1) else { return false };
                blocks.begin((Arc::clone(&next.source), next.locals, next.depth));
                unexecuted_lines::check_whole_text(&next.source, &interpreter.settings)
                    .for_each(|fault| add_once(&mut report.faults, reported, fault.with_calls(next.calls)));
                *place = TextLine { text: place.text + 1, line: 0 };
                continue;
            }
            place.line += 1;
            let text = called.get(place.text);
            let lines = text.map_or(&unread.marks, |text| &text.marks);
            if lines.is_executed(line) {
                continue;
            }
            blocks.execute(line, interpreter);
            interpreter.charge_blocks(budget);
            let calls = text.map_or_else(CallChain::default, |text| text.calls);
            let here = calls.within((blocks.source.number(), line + 1));
            blocks.calls.drain(..).for_each(|call| called.add(call, here));
            for (fault, certainty) in blocks.found.drain(..) {
                let fault = fault.with_calls(calls);
                match certainty {
                    Certainty::Sure => add_once(&mut report.faults, reported, fault),
                    Certainty::Possible => add_once(&mut report.warnings, reported, fault),
                    Certainty::NoPosition if !std::mem::replace(&mut blocks.position_missed, true) => {
                        add_once(&mut report.warnings, reported, fault.into_unchecked(E::PositionUnknown));
                    }
                    Certainty::NoPosition | Certainty::Unknown => {}
                }
            }
        }
        true
    }

    /// Leaves a loop that waits, behind the line that jumps back; `false` if the check may not leave a loop.
    fn leave_wait(&mut self) -> bool {
        self.interpreter.passes = IdlePasses::default();
        let TextLine { text, line } = self.place;
        let source = Arc::clone(self.called.get(text).map_or(&self.source, |text| &text.source));
        self.warn_of_loop(&source, line);
        self.incomplete = true;
        if self.max_left_loops > 0 {
            self.interpreter.flow.go_behind_line(line);
        }
        self.max_left_loops > 0
    }

    /// Leaves the endless loop; `false` if the place behind it is not known.
    fn leave_loops(&mut self) -> bool {
        let flow = &mut self.interpreter.flow;
        if flow.leave_loops() {
            return true;
        }
        flow.return_to_main();
        self.checkpoint.jump_back_line.map(|line| flow.go_behind_line(line)).is_some()
    }

    fn warn_of_loop(&mut self, source: &Source, line: u32) {
        let place = BlockLocation { program: source.number(), line: line + 1, n: None };
        let wrong = ErrorAt { at: 0, error: E::EndlessLoop, details: Default::default() };
        self.add_warning(ProgramFault::new(source.title_arg(), place, 1, wrong));
    }

    /// Reports an endless loop at the line that jumps back. Its repetitions do not count: path length, variables and
    /// position are restored to the start of the repetition.
    fn report_endless_loop(&mut self, world: &mut OfflineMachine) {
        let flow = &self.interpreter.flow;
        let (source, line) =
            self.checkpoint.jump_back_line.map_or_else(|| (&flow.source, flow.place.line), |line| (&self.source, line));
        let source = Arc::clone(source);
        self.warn_of_loop(&source, line);
        let LoopCheckpoint { totals: come, variables: memory, shown_blocks: shown, faults, .. } = &self.checkpoint;
        world.restore_totals(*come);
        self.interpreter.common_variables.clone_from(memory);
        if *shown < self.shown_blocks {
            self.report.repeated_blocks.push(*shown..self.shown_blocks);
        }
        // A value that grows with every repetition is not a mistake of the text.
        let (kept, mut index) = (*faults, 0);
        self.report.faults.retain(|fault| {
            index += 1;
            index <= kept || !matches!(fault.error, E::OutOfRange | E::Overflow)
        });
        (self.checkpoint.shown_blocks, self.checkpoint.faults) = (self.shown_blocks, self.report.faults.len());
        self.left_loops += 1;
        self.incomplete = true;
    }

    /// Ends the run; the lines that were not executed are read next.
    fn finish_run(&mut self, finished: bool) -> bool {
        self.report.finished = finished && !self.incomplete;
        self.report.begins_anew = self.interpreter.has_restarted();
        (self.run_over, self.place) = (true, TextLine::default());
        let source = Arc::clone(&self.source);
        unexecuted_lines::check_whole_text(&source, &self.settings).for_each(|fault| self.add_fault(fault));
        true
    }

    /// Notes the result of an IF, what the block has read without a value, and the contour that it has read.
    #[inline]
    fn note_values(&mut self) {
        if std::mem::take(&mut self.interpreter.contour_was_read) {
            self.mark_contour();
        }
        if let Some(holds) = self.interpreter.block_words.condition {
            self.mark_condition(holds);
        }
        self.word_left_out = self.word_left_out || self.interpreter.may_have_left_out_feed();
        let memory = self.interpreter.common_variables();
        let is_unset = |number: &u32| matches!(memory.get(*number), Ok(None));
        let reads_unset = self.block.used_variables.iter().any(is_unset);
        self.word_left_out |= reads_unset && self.interpreter.block_words.condition.is_some();
        self.reads_unset |= reads_unset;
        if self.interpreter.flow.modal_calls.is_active() {
            self.note_modal_macro();
        }
    }

    /// Adds the macro of the G66 that acts: no move may call it.
    fn note_modal_macro(&mut self) {
        let (flow, TextLine { text, line }) = (&self.interpreter.flow, self.place);
        let number = self.called.get(text).map_or_else(|| self.source.number(), |text| text.source.number());
        if let Some(call) = self.interpreter.modal_macro() {
            self.called.add(call, flow.calls().within((number, line + 1)));
        }
    }

    /// Warns of an alarm that the program raises, if neither a value of a machine nor one that is not set yet has decided
    /// about it.
    #[inline]
    fn note_alarm(&mut self, world: &OfflineMachine) {
        let Some(Op::Alarm { number, text }) = self.block.ops.last() else { return };
        self.alarm_passed = true;
        if world.guesses() || self.reads_unset || self.left_loops > 0 || self.incomplete {
            return;
        }
        let flow = &self.interpreter.flow;
        let wrong = ErrorAt { at: 0, error: E::AlarmReached, details: [Arg::from(*number), text.clone()] };
        let fault = ProgramFault::new(flow.source.title_arg(), self.block.location, 1, wrong).with_calls(flow.calls());
        self.add_warning(fault);
    }

    /// A consequence of null variables is only a warning: the operator sets them before the real run. So is one of values
    /// that an alarm of the program has refused, and of those that the caller of a subprogram sets (R parameters).
    fn classify(&mut self, fault: ProgramFault) {
        let (null_here, left_out) = (self.interpreter.has_null_use(), self.word_left_out);
        let called = program_number::is_l_number(self.source.number());
        let unsure = null_here || self.alarm_passed || called;
        let is_literal = self.interpreter.flow.source.is_literal_at(&fault);
        let by_null = match fault.error {
            E::MissingWord | E::TurningCycleWord | E::EmptyWord | E::ArcWithoutCentre => null_here,
            E::ArcEndOffCircle | E::ArcRadius => null_here || self.left_loops > 0,
            E::DivisionByZero => (null_here || called) && !fault.has_detail(),
            E::OutOfRange => unsure && !is_literal,
            E::BadVariable => null_here || unsure && !is_literal,
            E::FunctionDomain => null_here || called && !is_literal,
            E::SwitchVariable => null_here,
            // The number is computed from a value that only a run has.
            E::MissingTarget | E::ReadOnly => null_here,
            E::FeedMissing => left_out,
            // The position after a loop that was left is unknown.
            E::ArcTooSmall | E::FullCircleByRadius | E::RectangleSide => self.left_loops > 0,
            _ => false,
        };
        if by_null || self.lost.explains(fault.error) { self.add_warning(fault) } else { self.add_fault(fault) }
    }

    fn add_fault(&mut self, fault: ProgramFault) {
        add_once(&mut self.report.faults, &mut self.reported, fault);
    }

    fn add_warning(&mut self, fault: ProgramFault) {
        add_once(&mut self.report.warnings, &mut self.reported, fault);
    }
}

/// Adds a finding unless its line has one of the same kind.
fn add_once(list: &mut Vec<ProgramFault>, reported: &mut HashSet<(u32, u32, E)>, fault: ProgramFault) {
    let BlockLocation { program, line, .. } = fault.location;
    if list.len() < MAX_FAULTS && reported.insert((program, line, fault.error)) {
        list.push(fault);
    }
}
