//! The interpreter: one block at a time, from text to operations. Source: spec B1, B3.

use std::sync::Arc;

use super::block::Block;
use super::common_variables::{CommonVariables, VariableError};
use super::compensation::BlockCompensation;
use super::contour::{ContourMemory, PendingCycle};
use super::corner::{CornerStage, CornerWords};
use super::dialect::{self, BlockContext, FlowAction};
use super::expression::{Locals, Value};
use super::external_state::ExternalState;
use super::fault::{BlockLocation, E, ErrorAt, ProgramFault, ReadResult, StepStop, fail, fail1, fail2};
use super::flow::{Call, Callee, Flow, Place};
use super::idle_passes::IdlePasses;
use super::lexer::Cursor;
use super::modal::ModalState;
use super::modal_calls::ModalCall;
use super::op::Op;
use super::scope::{LiveScope, NullUse};
use super::settings::NcSettings;
use super::source::{SharedLibrary, Source};
use super::statement::{BlockContent, BlockReader};
use super::words::BlockWords;
use crate::defs::program_number;
use crate::units::WorkBudget;

/// Most blocks that one call of `next` reads.
pub const MAX_BLOCKS_PER_CALL: usize = 1_000;
/// Work units of reading a block, by trial (`cargo bench --bench nc`).
pub const BLOCK_WORK: usize = 500;

/// The result of reading the next block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextStatus {
    /// The block is filled.
    Block,
    /// A live value is needed: call again when all motion is done. Nothing was changed.
    Drain,
    /// Many blocks had no operation: call again in the next tick.
    Busy,
    /// A loop has repeated without any change: only the machine or the operator can end it. Call again in the next tick.
    Waiting,
    /// M30, M02, `%` or the end of the text.
    End,
}

/// Reads a program ahead of its execution.
pub struct Interpreter {
    pub(super) flow: Flow,
    pub(super) library: SharedLibrary,
    pub(super) settings: NcSettings,
    pub(super) common_variables: CommonVariables,
    pub(super) modals: ModalState,
    pub(super) block_words: BlockWords,
    pub(super) ended: bool,
    pub(super) second_half: bool,
    /// Blocks of a contour that the last step has read besides its own.
    pub(super) contour_blocks: usize,
    /// The last step was a cycle, which has read a contour.
    pub(super) contour_was_read: bool,
    /// The arguments of the macro call that the present block makes.
    call_arguments: Locals,
    /// The block number read last (#4114).
    pub(super) last_block_number: Option<u32>,
    /// The jumps back since the last change.
    pub(super) passes: IdlePasses,
    /// The cycle of the block just read; its contour is not read yet.
    pub(super) pending_cycle: Option<PendingCycle>,
    /// Memory for the contour of a cycle; taken while one is read.
    pub(super) contour_memory: Option<Box<ContourMemory>>,
    /// What the block just read asks of the end of its move.
    pub(super) corner_words: Option<CornerWords>,
    /// The blocks that wait for the move behind their corner.
    pub(super) corners: CornerStage,
    /// The blocks between G41 and G40.
    pub(super) compensation: BlockCompensation,
    /// Places where null was used as 0; collected by a check only.
    pub(crate) null_uses: Option<Vec<NullUse>>,
    /// Warnings; collected by a check only.
    pub(crate) warnings: Option<Vec<ErrorAt>>,
    /// Every IF is read as if its condition held: for a check of blocks that were not executed.
    pub(super) conditions_hold: bool,
}

/// A program number stands at the head of its program only.
#[inline]
fn refuse_misplaced_o(words: &BlockWords, source: &Source, at: usize) -> ReadResult<()> {
    match words.peek(b'O').filter(|_| !source.is_at_head(at)) {
        Some(word) => fail(word.at as usize, E::MisplacedO),
        None => Ok(()),
    }
}

/// The result of reading one block.
pub(super) enum StepStatus {
    Empty,
    Block,
    End,
}

impl Interpreter {
    /// Starts at the head of a program, with its own copy of the common variables.
    #[must_use]
    pub fn new(source: Arc<Source>, library: SharedLibrary, settings: NcSettings, memory: CommonVariables) -> Self {
        let modals = ModalState::new(&settings);
        let contour_memory = ContourMemory::new(Flow::new(Arc::clone(&source)), Block::new(&settings));
        Self {
            flow: Flow::new(source),
            library,
            settings,
            common_variables: memory,
            modals,
            block_words: BlockWords::default(),
            ended: false,
            second_half: false,
            contour_blocks: 0,
            contour_was_read: false,
            call_arguments: [None; 33],
            last_block_number: None,
            passes: IdlePasses::default(),
            pending_cycle: None,
            contour_memory: Some(Box::new(contour_memory)),
            corner_words: None,
            corners: CornerStage::new(&modals),
            compensation: BlockCompensation::new(&modals),
            null_uses: None,
            warnings: None,
            conditions_hold: false,
        }
    }

    /// Whether M99 has led back to the head of the started program.
    #[must_use]
    pub const fn has_begun_anew(&self) -> bool {
        self.flow.restarted
    }

    /// Starts at the head of another program, in the memory of this interpreter.
    pub fn begin(&mut self, program: (Arc<Source>, SharedLibrary), settings: NcSettings, memory: &CommonVariables) {
        self.contour_memory.iter_mut().for_each(|memory| memory.begin(Arc::clone(&program.0)));
        self.flow.begin(program.0);
        self.library = program.1;
        self.common_variables.clone_from(memory);
        self.modals = ModalState::new(&settings);
        self.settings = settings;
        (self.ended, self.second_half, self.passes) = (false, false, IdlePasses::default());
        self.last_block_number = None;
        self.forget_blocks();
        self.conditions_hold = false;
        self.null_uses.iter_mut().for_each(Vec::clear);
        self.warnings.iter_mut().for_each(Vec::clear);
    }

    /// Lets go of the program and its library; others take their place.
    pub fn leave(&mut self, (source, library): (Arc<Source>, SharedLibrary)) {
        self.contour_memory.iter_mut().for_each(|memory| memory.begin(Arc::clone(&source)));
        self.flow.begin(source);
        self.library = library;
        self.forget_blocks();
        self.null_uses.iter_mut().for_each(Vec::clear);
    }

    /// Forgets what was read and waits.
    fn forget_blocks(&mut self) {
        (self.pending_cycle, self.corner_words, self.contour_was_read) = (None, None, false);
        self.corners.reset();
        self.compensation.reset();
    }

    /// Continues with an earlier modal state: MDI blocks, a restart from a chosen block.
    pub const fn set_modals(&mut self, modals: ModalState) {
        self.modals =
            ModalState { g50_used: false, several_tools: false, modal_call: false, compensation: None, ..modals };
    }

    /// The modal state after the last block returned.
    #[must_use]
    pub const fn modals(&self) -> &ModalState {
        &self.modals
    }

    /// The common variables as of the last block read (look-ahead copy).
    #[must_use]
    pub const fn common_variables(&self) -> &CommonVariables {
        &self.common_variables
    }

    /// #1–#33 of the current call level; index 0 is #1.
    #[must_use]
    pub fn locals(&self) -> &[Option<f64>; 33] {
        self.flow.locals()
    }

    /// Takes over a common variable that the operator changed while the program runs.
    ///
    /// # Errors
    /// As [`CommonVariables::set`].
    pub fn update_variable(&mut self, number: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.change_common(number, value)
    }

    /// Sets a common variable and notes whether its value has changed.
    pub(super) fn change_common(&mut self, number: u32, value: Value) -> Result<(), VariableError> {
        let before = self.common_variables.get(number)?;
        self.passes.changed |= before.map(f64::to_bits) != value.map(f64::to_bits);
        self.common_variables.set(number, value)
    }

    /// The jumps back to the same block since a value, a mode or the machine was changed by a block.
    #[must_use]
    pub const fn idle_passes(&self) -> u32 {
        self.passes.count
    }

    /// Fills `block` with the next block that has operations.
    ///
    /// # Errors
    /// The program's mistake. Nothing of the block was done; another call returns the same fault.
    pub fn next(&mut self, world: &mut dyn ExternalState, block: &mut Block) -> Result<NextStatus, ProgramFault> {
        self.next_within(world, block, &mut WorkBudget::new(MAX_BLOCKS_PER_CALL * BLOCK_WORK))
    }

    /// As [`Self::next`]; every block read is charged to the budget. `NextStatus::Busy` when it is spent.
    ///
    /// # Errors
    /// As [`Self::next`].
    pub fn next_within(
        &mut self,
        world: &mut dyn ExternalState,
        block: &mut Block,
        budget: &mut WorkBudget,
    ) -> Result<NextStatus, ProgramFault> {
        block.clear();
        if self.is_over() {
            return Ok(NextStatus::End);
        }
        while !budget.is_spent() {
            let from = self.flow.place.at;
            let stepped = self.step_compensated(world, block);
            self.charge_blocks(budget);
            match stepped {
                // A waiting loop (`N10 IF[#438 EQ 0]GOTO 10`): reading it again in this tick gives the same result.
                Ok(StepStatus::Empty) if self.flow.place.at <= from && self.passes.count > 0 => {
                    return Ok(NextStatus::Waiting);
                }
                Ok(StepStatus::Empty) => {}
                Ok(StepStatus::Block) => return Ok(NextStatus::Block),
                Ok(StepStatus::End) => {
                    self.ended = true;
                    return Ok(NextStatus::End);
                }
                Err(StepStop::Drain) => {
                    block.clear();
                    return Ok(NextStatus::Drain);
                }
                Err(StepStop::Fault(fault)) => {
                    block.clear();
                    return Err(fault);
                }
            }
        }
        Ok(NextStatus::Busy)
    }

    /// Charges the last step: its block, and its contour if it is a cycle.
    pub(super) fn charge_blocks(&mut self, budget: &mut WorkBudget) {
        budget.spend((1 + std::mem::take(&mut self.contour_blocks)) * BLOCK_WORK);
    }

    pub(super) fn locate(&self, wrong: ErrorAt) -> ProgramFault {
        self.flow.source.fault(self.block_words.block_number, wrong).with_calls(self.flow.calls())
    }

    /// Reads one block, with the contour if it is a cycle.
    pub(super) fn step(&mut self, world: &mut dyn ExternalState, block: &mut Block) -> ReadResult<StepStatus> {
        let from = self.flow.place.at;
        let stepped = self.read_block(world, block)?;
        if self.flow.place.at <= from {
            self.passes.note_jump_back(self.flow.place.at, &self.modals);
        }
        if self.pending_cycle.is_none() {
            return Ok(stepped);
        }
        self.pending_cycle.take().map_or(Ok(stepped), |pending| self.expand_contour(&pending, world, block))
    }

    /// Reads one block without a cycle's contour.
    pub(super) fn read_block(&mut self, world: &mut dyn ExternalState, block: &mut Block) -> ReadResult<StepStatus> {
        if self.ended {
            return Ok(StepStatus::End);
        }
        let source = &self.flow.source;
        let (text, program, at, line) = (source.bytes(), source.number(), self.flow.place.at, self.flow.place.line + 1);
        let mut cursor = Cursor::window(text, at);
        if cursor.is_at_end() {
            return self.end_of_text(at);
        }
        let (words, mid_line, block_skip) = (&mut self.block_words, self.flow.place.mid_line, world.block_skip());
        // A refused block must not change the modal state.
        let before = self.modals;
        let mut scope = LiveScope {
            locals: self.flow.locals(),
            common_variables: &self.common_variables,
            modals: &before,
            settings: &self.settings,
            block_number: self.last_block_number,
            used_variables: self.null_uses.is_some().then_some(&mut block.used_variables),
            null_uses: &mut self.null_uses,
            last_null: 0,
            warnings: &mut self.warnings,
            source,
            conditions_hold: self.conditions_hold,
            world,
        };
        let reader = BlockReader { cursor: &mut cursor, scope: &mut scope, words, mid_line, block_skip };
        let read = dialect::read_block(self.settings.dialect, reader);
        let content = if cursor.is_truncated(text) { return fail(at, E::BlockTooLong) } else { read? };
        let next = Place::behind(cursor, self.flow.place.line);
        let step = if matches!(content, BlockContent::Words) {
            refuse_misplaced_o(&self.block_words, source, at)?;
            let mut running = BlockContext {
                words: &self.block_words,
                modals: &mut self.modals,
                settings: &self.settings,
                ops: &mut block.ops,
                scope: &mut scope,
                text,
                at,
                flow: &self.flow,
                arguments: &mut self.call_arguments,
                pending_cycle: &mut self.pending_cycle,
                corner: &mut self.corner_words,
                second_half: self.second_half,
            };
            let done = dialect::execute(&mut running).and_then(|step| self.apply_flow_action(step, next, block));
            match &done {
                Ok(_) => self.modals.modal_call = self.flow.modal_calls.is_active(),
                Err(_) => (self.modals, self.pending_cycle, self.corner_words) = (before, None, None),
            }
            done?
        } else {
            self.run_statement(content, next, block)?
        };
        self.finish_block(program, line, block);
        Ok(step)
    }

    /// Adds location and modal state to the block just read.
    #[inline]
    fn finish_block(&mut self, program: u32, line: u32, block: &mut Block) {
        let n = self.block_words.block_number;
        self.last_block_number = n.or(self.last_block_number);
        block.location = BlockLocation { program, line, n };
        if !block.ops.is_empty() {
            block.modals = self.modals;
            self.passes.changed |= block.ops.iter().any(|op| !matches!(op, Op::SetVariable { .. }));
        }
    }

    /// Moves the flow past the block just read.
    #[inline]
    fn advance_past_block(&mut self, next: Place) {
        self.second_half = false;
        self.flow.place = next;
    }

    fn end_of_text(&mut self, at: usize) -> ReadResult<StepStatus> {
        // DECISION: a subprogram without M99 returns to the caller at the end of its text.
        if self.flow.is_main() {
            return Ok(StepStatus::End);
        }
        if let Some(n) = self.flow.local_sub() {
            return fail1(self.flow.source.last_line_start(), E::SubWithoutReturn, format_args!("N{n:04}"));
        }
        self.passes.changed = true;
        self.return_from_call(None, at)?;
        Ok(StepStatus::Empty)
    }

    /// Returns to the caller. A cycle that was called without an F leaves none in force.
    fn return_from_call(&mut self, target: Option<u32>, at: usize) -> ReadResult<()> {
        let ends_without_feed = self.flow.ends_without_feed();
        self.flow.return_to(target, at)?;
        if ends_without_feed {
            self.modals.feed = None;
        }
        Ok(())
    }

    fn run_statement(&mut self, content: BlockContent, next: Place, block: &mut Block) -> ReadResult<StepStatus> {
        match content {
            BlockContent::Assign { at, .. }
            | BlockContent::Goto { at, .. }
            | BlockContent::While { at, .. }
            | BlockContent::EndLoop { at, .. }
            | BlockContent::Print { at, .. }
                if !dialect::rules(self.settings.dialect).has_macros =>
            {
                return fail(at, E::NoMacros);
            }
            BlockContent::Empty | BlockContent::Words => {
                self.advance_past_block(next);
            }
            BlockContent::Assign { variable, value, at, text: comment } => {
                self.assign(variable, value, at, comment, block)?;
                self.advance_past_block(next);
            }
            BlockContent::Goto { n, at } => self.flow.go_to_block(n, at)?,
            BlockContent::Jump { label, forward, holds } => {
                let line = self.flow.source.find_label(label, self.flow.place.line, forward)?;
                if holds { self.flow.go_to_line(line) } else { self.advance_past_block(next) }
            }
            BlockContent::DisplayMessage { text } => {
                block.ops.push(Op::DisplayMessage { text: self.flow.source.message_text(text) });
                self.advance_past_block(next);
            }
            BlockContent::Print { text, .. } => {
                block.ops.push(Op::Print { text });
                self.advance_past_block(next);
            }
            BlockContent::While { holds, number, at } => {
                self.flow.begin_loop(holds, number, at)?;
                if holds {
                    self.advance_past_block(next);
                }
            }
            BlockContent::EndLoop { number, at } => self.flow.end_loop(number, at)?,
            // A `%` at the head of a text does not end it.
            BlockContent::TextEnd { at }
                if self.flow.source.is_at_head(at) && !self.flow.source.bytes()[..at].contains(&b'%') =>
            {
                self.advance_past_block(next);
            }
            BlockContent::TextEnd { at } => return self.end_of_text(at),
        }
        Ok(if block.ops.is_empty() { StepStatus::Empty } else { StepStatus::Block })
    }

    /// Executes the flow action of a block: jump, call, loop, assignment or end.
    #[inline]
    fn apply_flow_action(&mut self, act: FlowAction, next: Place, block: &mut Block) -> ReadResult<StepStatus> {
        if !matches!(act, FlowAction::SecondHalf) {
            self.set_variables(block)?;
        }
        let act = match act {
            FlowAction::Return { target: None, .. } if self.settings.runs_once && self.flow.is_main() => {
                FlowAction::End
            }
            act => act,
        };
        let moves = self.flow.modal_calls.is_active() && block.ops.iter().any(|op| op.effect().is_motion());
        match act {
            FlowAction::Goto { at, .. } | FlowAction::Call(Call { at, .. }) | FlowAction::Return { at, .. }
                if moves =>
            {
                // The G66 macro would have to run between the move and the jump.
                return fail2(at, E::NotTogether, "G66", "M");
            }
            FlowAction::GotoNotTaken { n, at } if self.flow.source.find_block(n, at).is_none() => {
                return fail1(at, E::MissingTarget, format_args!("N{n}"));
            }
            FlowAction::Next | FlowAction::GotoNotTaken { .. } => self.call_modal_macro(moves, next)?,
            FlowAction::SecondHalf => {
                self.second_half = true;
                block.complete = false;
            }
            FlowAction::SetModalCall(modal) => {
                self.set_modal_call(modal)?;
                self.advance_past_block(next);
            }
            FlowAction::Assign { variable, value, at } => {
                self.assign(variable, value, at, None, block)?;
                self.advance_past_block(next);
            }
            FlowAction::End => {
                self.advance_past_block(next);
                self.ended = true;
            }
            elsewhere => self.change_flow(elsewhere, next)?,
        }
        Ok(match (block.ops.is_empty(), self.ended) {
            (false, _) => StepStatus::Block,
            (true, true) => StepStatus::End,
            (true, false) => StepStatus::Empty,
        })
    }

    /// G66 with the arguments of the block, or G67. DECISION: G66 nests as deep as macros call each other (FANUC).
    fn set_modal_call(&mut self, modal: Option<ModalCall>) -> ReadResult<()> {
        let at = self.flow.place.at;
        let Some(modal) = modal else {
            self.flow.modal_calls.pop();
            return Ok(());
        };
        self.find_program(modal.program, at)?;
        let limit = (dialect::rules(self.settings.dialect).call_limit)(Callee::Macro);
        if self.flow.modal_calls.depth() >= limit.depth {
            return fail2(at, E::TooDeep, limit.name, format_args!("{}", limit.depth));
        }
        self.flow.modal_calls.push(modal, &self.call_arguments);
        Ok(())
    }

    /// Goes to the next block. After a block with motion, calls the macro of G66 first.
    #[inline]
    fn call_modal_macro(&mut self, moves: bool, next: Place) -> ReadResult<()> {
        let modal = self.flow.modal_calls.active().map(|(modal, _)| modal).filter(|_| moves);
        let at = self.flow.place.at;
        let source = modal.as_ref().map(|modal| self.find_program(modal.program, at)).transpose()?;
        self.advance_past_block(next);
        if let (Some(modal), Some(source)) = (modal, source) {
            let call = Call { program: modal.program, times: modal.times, callee: Callee::Macro, at };
            self.flow.call_modal(source, call, (dialect::rules(self.settings.dialect).call_limit)(call.callee))?;
        }
        Ok(())
    }

    /// Executes jumps, loops, calls and returns.
    fn change_flow(&mut self, step: FlowAction, next: Place) -> ReadResult<()> {
        // M99 of the main program is a jump to its start.
        let restarts = matches!(step, FlowAction::Return { .. }) && self.flow.is_main();
        let jumps = restarts || matches!(step, FlowAction::Goto { .. } | FlowAction::GotoUnique { .. });
        self.passes.changed |= !jumps;
        match step {
            FlowAction::Goto { n, at } => {
                self.flow.go_to_block(n, at)?;
                self.second_half = false;
            }
            FlowAction::GotoUnique { n, at } => {
                self.flow.go_to_unique_block(n, at)?;
                self.second_half = false;
            }
            FlowAction::CallLocal { n, at } => {
                let stood = self.flow.place;
                self.advance_past_block(next);
                if let Err(stop) = self.flow.call_local(n, at) {
                    self.flow.place = stood;
                    return Err(stop);
                }
            }
            FlowAction::BeginCountedLoop { times, at } => {
                if self.flow.begin_counted_loop(times, at)? {
                    self.advance_past_block(next);
                }
            }
            FlowAction::EndCountedLoop { at } => {
                if self.flow.end_counted_loop(at)? {
                    self.advance_past_block(next);
                }
            }
            FlowAction::Call(call) => {
                let source = self.find_program(call.program, call.at)?;
                self.advance_past_block(next);
                let limit = (dialect::rules(self.settings.dialect).call_limit)(call.callee);
                self.flow.call(source, call, &self.call_arguments, limit)?;
            }
            FlowAction::Return { target, at } => {
                self.second_half = false;
                if self.flow.is_main() && !dialect::rules(self.settings.dialect).has_macros {
                    return fail(at, E::ReturnWithoutCall);
                }
                self.return_from_call(target, at)?;
            }
            FlowAction::Next
            | FlowAction::GotoNotTaken { .. }
            | FlowAction::SecondHalf
            | FlowAction::SetModalCall(_) => {}
            FlowAction::Assign { .. } | FlowAction::End => {}
        }
        Ok(())
    }

    /// Sets the variables that the block assigns, before its other operations.
    #[inline]
    fn set_variables(&mut self, block: &mut Block) -> ReadResult<()> {
        for index in 0..self.block_words.assignments.len() {
            let Some(set) = self.block_words.assignments.get(index).copied() else { break };
            self.assign(set.variable, Some(set.value), set.at as usize, None, block)?;
            // `assign` appends the operation; it belongs before the others.
            block.ops[index..].rotate_right(1);
        }
        Ok(())
    }

    fn find_program(&self, program: u32, at: usize) -> ReadResult<Arc<Source>> {
        let name = || program_number::name_of(program);
        if let Some(places) = self.library.places_of_duplicate(program) {
            return fail2(at, E::DuplicateProgram, name(), places);
        }
        self.library.find(program).map_or_else(|| fail1(at, E::MissingProgram, name()), Ok)
    }
}
