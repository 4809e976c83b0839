//! A run: the program being read ahead, and the queue of items read but not yet executed.
//!
//! Read-ahead converts operations to items in machine coordinates. The executor hands moves to the planner and executes
//! everything else when all motion before it is finished. So variables, work offsets and block numbers change when the
//! machine reaches them, not when they are read.
//! Source: spec B3 (shown as executed), B5, K6.3.

use std::collections::VecDeque;
use std::sync::Arc;

use super::activity::{Activity, Handover};
use super::lookahead_state::LookaheadState;
use super::move_refusal::MoveRefusal;
use super::queue::{QueueItem, QueuedAction};
use crate::controller::plant::system_variables::nc_settings;
use crate::defs::kind::Kind;
use crate::defs::param::Params;
use crate::motion::MAX_QUEUED_MOVES;
use crate::nc::{self, Block, CommonVariables, Interpreter, Source, WorkOffsets};
use crate::units::{MachinePos, Micros, PerAxis};

/// Items read ahead in any case.
const MIN_ITEMS: usize = 512;
/// Beyond [`MIN_ITEMS`], items are read only to have this many that the planner does not have: more than it takes in a
/// tick. How far ahead it plans, it decides itself.
const WAITING_ITEMS: usize = 128;
/// Maximum items read ahead: every move that the planner holds as a block of its own, and what waits.
const MAX_ITEMS: usize = 3 * MAX_QUEUED_MOVES + MIN_ITEMS;

/// System variables for which a search for a start block has memory; more take more.
const SYSTEM_VARIABLES: usize = 512;

/// State of read-ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadAheadStatus {
    /// Blocks are being read.
    Open,
    /// The queue must be executed before the next block is read.
    Barrier,
    /// End of the program text, or a fault.
    Finished,
}

/// Origin of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The current program: has a preflight, obeys single block, repeats by P390.
    Program,
    /// An MDI line.
    Mdi,
    /// O9000 or O9001 of the one-key retract.
    Retract,
}

/// The preflight of a run.
pub struct RunPreflight {
    /// The preflight.
    pub preflight: nc::ProgramPreflight,
    /// The operator has been informed.
    pub announced: bool,
    /// It is over.
    pub done: bool,
    /// The state before the start: a refused program changes nothing.
    pub before: StateBeforeStart,
}

/// Work offsets and tool-change point before a start.
pub type StateBeforeStart = (WorkOffsets, Option<MachinePos>);

/// What a preflight begins with: the state that it follows the program from, and the one to go back to.
pub struct PreflightStart {
    /// The machine at program start.
    pub world: nc::OfflineMachine,
    /// The state before the start.
    pub before: StateBeforeStart,
}

/// One run of a program or an MDI line.
pub struct ProgramRun {
    /// The interpreter of the program text.
    pub interpreter: Interpreter,
    /// Scratch for the block being read.
    pub block: Block,
    /// The queue: items read but not yet executed, in order.
    pub queue: VecDeque<QueueItem>,
    /// Number of items at the front of the queue that were handed over.
    pub handed_over: usize,
    /// The next planner tag.
    pub next_tag: u32,
    /// Machine state at the end of all items read.
    pub lookahead: LookaheadState,
    /// State of read-ahead.
    pub read_ahead: ReadAheadStatus,
    /// The mistake that has ended read-ahead; its alarm is at the end of the queue.
    pub fault: Option<nc::ProgramFault>,
    /// The idle pass of a loop in which it asked the machine last.
    pub asked_at_pass: u32,
    /// What the executor is in the middle of.
    pub activity: Activity,
    /// Origin of the run.
    pub origin: Origin,
    /// Start time.
    pub started_at: Micros,
    /// Whether the moves are handed to the planner.
    pub handover: Handover,
    /// Preflight of the program before anything is executed.
    pub preflight: Option<Box<RunPreflight>>,
}

/// What a run begins with.
pub struct RunStart<'a> {
    /// The text and the programs that it may call.
    pub program: (Arc<Source>, nc::SharedLibrary),
    /// Settings of the interpreter.
    pub settings: nc::NcSettings,
    /// The modal state.
    pub modals: nc::ModalState,
    /// The common variables.
    pub memory: &'a CommonVariables,
    /// Work offsets and position.
    pub lookahead: LookaheadState,
    /// A preflight comes first.
    pub preflight: Option<PreflightStart>,
}

/// Runs that are not open. A start takes one and an end gives it back, so that neither allocates nor frees.
pub struct RunPool {
    #[allow(clippy::vec_box, reason = "a run changes its owner without being moved or allocated")]
    free: Vec<Box<ProgramRun>>,
    preflight: Option<Box<RunPreflight>>,
    /// Memory of the search for a start block.
    pub search_memory: nc::SystemVariables,
    no_program: (Arc<Source>, nc::SharedLibrary),
    settings: nc::NcSettings,
}

impl RunPool {
    /// Runs for a program, for the retract that suspends it, and for an MDI line that is checked.
    const RUNS: usize = 3;

    /// The runs of a control at power-on.
    #[must_use]
    pub fn new() -> Self {
        let kind = Kind::default();
        let source = Arc::new(Source::new(0, "", Vec::new(), kind.dialect()));
        let settings = nc_settings(kind, &Params::factory(kind));
        let no_program: (_, nc::SharedLibrary) = (source, Arc::new(nc::EmptyLibrary));
        let mut pool = Self {
            free: Vec::with_capacity(Self::RUNS),
            preflight: None,
            search_memory: Vec::with_capacity(SYSTEM_VARIABLES),
            no_program,
            settings,
        };
        pool.preflight = Some(pool.new_preflight());
        for _ in 0..Self::RUNS {
            let run = Box::new(pool.new_run());
            pool.free.push(run);
        }
        pool
    }

    fn new_preflight(&self) -> Box<RunPreflight> {
        let preflight = nc::ProgramPreflight::new(&self.no_program, &self.settings);
        let before = (WorkOffsets::default(), None);
        Box::new(RunPreflight { preflight, announced: false, done: false, before })
    }

    fn new_run(&self) -> ProgramRun {
        let (source, library) = self.no_program.clone();
        let block = Block::new(&self.settings);
        let path = block.modals.path_mode;
        ProgramRun {
            interpreter: Interpreter::new(source, library, self.settings.clone(), CommonVariables::default()),
            block,
            queue: VecDeque::with_capacity(MAX_ITEMS + nc::USUAL_OPS + 64),
            handed_over: 0,
            next_tag: 1,
            lookahead: LookaheadState::new(WorkOffsets::default(), MachinePos::default(), PerAxis::default(), path),
            read_ahead: ReadAheadStatus::Finished,
            fault: None,
            asked_at_pass: 0,
            activity: Activity::Idle,
            origin: Origin::Program,
            started_at: Micros::ZERO,
            handover: Handover::Feeding,
            preflight: None,
        }
    }

    /// A run from the machine's present state.
    #[must_use]
    pub fn open(&mut self, start: RunStart<'_>, now: Micros) -> Box<ProgramRun> {
        let mut run = self.free.pop().unwrap_or_else(|| Box::new(self.new_run()));
        let RunStart { program, settings, modals, memory, lookahead, preflight } = start;
        run.preflight = preflight.map(|PreflightStart { world, before }| {
            let mut pending = self.preflight.take().unwrap_or_else(|| self.new_preflight());
            pending.preflight.begin(program.clone(), &settings, world);
            (pending.announced, pending.done, pending.before) = (false, false, before);
            pending
        });
        run.block.restart(modals);
        run.interpreter.begin(program, settings, memory);
        run.interpreter.set_modals(modals);
        run.lookahead = lookahead;
        (run.handed_over, run.next_tag, run.started_at) = (0, 1, now);
        run.fault = None;
        (run.read_ahead, run.activity) = (ReadAheadStatus::Open, Activity::Idle);
        (run.origin, run.handover) = (Origin::Program, Handover::Feeding);
        run
    }

    /// Takes a run back and lets go of its program.
    pub fn close(&mut self, mut run: Box<ProgramRun>) {
        run.queue.clear();
        if let Some(mut pending) = run.preflight.take() {
            pending.preflight.leave(self.no_program.clone());
            self.preflight = Some(pending);
        }
        run.block.restart(run.block.modals);
        run.interpreter.leave(self.no_program.clone());
        if self.free.len() < Self::RUNS {
            self.free.push(run);
        }
    }
}

impl ProgramRun {
    /// Whether enough is read ahead.
    pub fn is_full(&self) -> bool {
        let waiting = self.queue.len() - self.handed_over;
        self.queue.len() >= MIN_ITEMS && (waiting >= WAITING_ITEMS || self.queue.len() >= MAX_ITEMS)
    }

    /// Ends read-ahead with a program fault; its alarm is raised when everything before it is executed.
    pub fn end_with_fault(&mut self, fault: &nc::ProgramFault) {
        self.read_ahead = ReadAheadStatus::Finished;
        let alarm = QueuedAction::Alarm(fault.alarm(), fault.place_and_cause(), fault.location);
        self.queue.push_back(QueueItem::Action(alarm));
        self.fault = Some(fault.clone());
    }

    /// Converts the block just read to queue items.
    ///
    /// # Errors
    /// The first refused operation. Nothing of the block is queued then.
    pub fn queue_block(&mut self, params: &Params) -> Result<(), MoveRefusal> {
        let kept = self.queue.len();
        let before = self.lookahead.clone();
        self.queue.push_back(QueueItem::BlockStart(self.block.location));
        let ops = std::mem::take(&mut self.block.ops);
        let mut result = Ok(());
        for op in &ops {
            result = self.lookahead.queue_op(op, self.block.location, &mut self.queue, params);
            if result.is_err() {
                break;
            }
            if op.stops_look_ahead() {
                self.read_ahead = ReadAheadStatus::Barrier;
            }
        }
        self.block.ops = ops;
        match result {
            Ok(()) if self.block.complete => self.queue.push_back(QueueItem::BlockEnd),
            Ok(()) => {}
            Err(_) => {
                self.queue.truncate(kept);
                self.lookahead = before;
            }
        }
        result
    }
}
