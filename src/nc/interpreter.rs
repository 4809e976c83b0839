//! The interpreter: one block at a time, from text to operations. Source: spec B1, B3.

use std::sync::Arc;

use super::contour::ContourCycle;
use super::dialect::{self, Running, Step};
use super::expression::Value;
use super::fault::{Fault, Outcome, Place, Stop, Wrong, fault_in, wrong, wrong1, wrong2};
use super::flow::{Call, Callee, Flow};
use super::lexer::Cursor;
use super::memory::{Memory, VariableError};
use super::modal::Modals;
use super::op::Op;
use super::scope::{LiveScope, NullUse};
use super::settings::Settings;
use super::source::{Library, Source, at_head};
use super::statement::{self, Content, Head};
use super::words::Words;
use super::world::World;
use crate::defs::program;
use crate::defs::program_error::ProgramError as E;
use crate::defs::variable::{self as system_variable, Access};

/// Most blocks that one call of `next` reads.
pub const STATEMENTS_PER_CALL: usize = 1_000;

/// The operations of one block.
#[derive(Clone, Debug)]
pub struct Block {
    /// Where the block is in the program.
    pub at: Place,
    /// Its operations, in order.
    pub ops: Vec<Op>,
    /// The modal state after the block.
    pub modals: Modals,
    /// Whether this ends the block: single block stops here. A block that changes the work offset or tool and also
    /// moves is returned in two parts.
    pub complete: bool,
    /// The variables that its words were calculated from; only a check fills it.
    pub used: Vec<u32>,
}

impl Block {
    /// An empty block. `Interpreter::next` fills it again for every block.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self {
            at: Place::default(),
            ops: Vec::with_capacity(8),
            modals: Modals::new(settings),
            complete: true,
            used: Vec::new(),
        }
    }

    pub(super) fn clear(&mut self) {
        self.ops.clear();
        self.used.clear();
        self.complete = true;
    }
}

/// The result of reading the next block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// The block is filled.
    Block,
    /// A live value is needed: call again when all motion is done. Nothing was changed.
    Drain,
    /// Many blocks had no operation, or a loop waits for a condition: call again in the next tick.
    Busy,
    /// M30, M02, `%` or the end of the text.
    End,
}

/// Reads a program ahead of its execution.
pub struct Interpreter {
    pub(super) flow: Flow,
    pub(super) library: Arc<dyn Library + Send + Sync>,
    pub(super) settings: Settings,
    pub(super) memory: Memory,
    pub(super) modals: Modals,
    pub(super) words: Words,
    pub(super) ended: bool,
    pub(super) second_half: bool,
    /// The block number read last (#4114).
    pub(super) last_n: Option<u32>,
    /// A value that a condition may depend on has changed since the last query.
    changed: bool,
    /// The cycle of the block just read; its contour is not read yet.
    pub(super) pending: Option<Pending>,
    /// Places where null was used as 0; collected by a check only.
    pub(crate) nulls: Option<Vec<NullUse>>,
    /// Warnings; collected by a check only.
    pub(crate) notes: Option<Vec<Wrong>>,
}

/// A cycle whose contour is not read yet, and the start of its own block.
pub(super) struct Pending {
    pub cycle: Box<ContourCycle>,
    pub begin: (usize, u32, bool),
}

/// The result of reading one block.
pub(super) enum Stepped {
    Nothing,
    Block,
    End,
}

impl Interpreter {
    /// Starts at the head of a program, with its own copy of the common variables.
    #[must_use]
    pub fn new(
        source: Arc<Source>,
        library: Arc<dyn Library + Send + Sync>,
        settings: Settings,
        memory: Memory,
    ) -> Self {
        let modals = Modals::new(&settings);
        Self {
            flow: Flow::new(source),
            library,
            settings,
            memory,
            modals,
            words: Words::default(),
            ended: false,
            second_half: false,
            last_n: None,
            changed: false,
            pending: None,
            nulls: None,
            notes: None,
        }
    }

    /// Continues with an earlier modal state: MDI blocks, a restart from a chosen block.
    #[must_use]
    pub fn with_modals(mut self, modals: Modals) -> Self {
        self.modals = Modals { preset: false, several_tools: false, modal_call: false, ..modals };
        self
    }

    /// The modal state after the last block returned.
    #[must_use]
    pub const fn modals(&self) -> &Modals {
        &self.modals
    }

    /// The common variables as of the last block read (look-ahead copy).
    #[must_use]
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// #1–#33 of the current call level; index 0 is #1.
    #[must_use]
    pub fn locals(&self) -> &[Option<f64>; 33] {
        self.flow.locals()
    }

    /// The location of the line that is read next.
    #[must_use]
    pub fn place(&self) -> Place {
        Place { program: self.flow.source.number(), line: self.flow.line + 1, n: None }
    }

    /// Takes over a common variable that the operator changed while the program runs.
    ///
    /// # Errors
    /// As [`Memory::set`].
    pub fn variable_edited(&mut self, number: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.memory.set(number, value)
    }

    /// Fills `block` with the next block that has operations.
    ///
    /// # Errors
    /// The program's mistake. Nothing of the block was done; another call returns the same fault.
    pub fn next(&mut self, world: &mut dyn World, block: &mut Block) -> Result<Next, Fault> {
        block.clear();
        if self.ended {
            return Ok(Next::End);
        }
        // A waiting loop (`N10 IF[#438 EQ 0]GOTO 10`): reading it twice within a tick gives the same result.
        let mut idle = false;
        for _ in 0..STATEMENTS_PER_CALL {
            let from = self.flow.at;
            match self.step(world, block) {
                Ok(Stepped::Nothing) => {
                    idle &= !std::mem::take(&mut self.changed);
                    if self.flow.at <= from {
                        if idle {
                            return Ok(Next::Busy);
                        }
                        idle = true;
                    }
                }
                Ok(Stepped::Block) => return Ok(Next::Block),
                Ok(Stepped::End) => {
                    self.ended = true;
                    return Ok(Next::End);
                }
                Err(stop) => {
                    block.clear();
                    return match *stop {
                        Stop::Drain => Ok(Next::Drain),
                        Stop::Wrong(wrong) => Err(self.fault(wrong)),
                    };
                }
            }
        }
        Ok(Next::Busy)
    }

    pub(super) fn fault(&self, wrong: Wrong) -> Fault {
        fault_in(&self.flow.source, self.words.n, wrong)
    }

    /// Reads one block, with the contour if it is a cycle.
    pub(super) fn step(&mut self, world: &mut dyn World, block: &mut Block) -> Outcome<Stepped> {
        let stepped = self.read_block(world, block)?;
        match self.pending.take() {
            Some(pending) => self.contour(&pending, world, block),
            None => Ok(stepped),
        }
    }

    /// Reads one block without a cycle's contour.
    pub(super) fn read_block(&mut self, world: &mut dyn World, block: &mut Block) -> Outcome<Stepped> {
        if self.ended {
            return Ok(Stepped::End);
        }
        let source = Arc::clone(&self.flow.source);
        let (text, at, line) = (source.bytes(), self.flow.at, self.flow.line + 1);
        let mut cursor = Cursor::window(text, at);
        if cursor.is_over() {
            return self.text_over(at);
        }
        // A refused block must not change the modal state.
        let (before, head) = (self.modals, Head { mid_line: self.flow.mid_line, block_skip: world.block_skip() });
        let mut scope = LiveScope {
            locals: self.flow.locals(),
            memory: &self.memory,
            modals: &before,
            settings: &self.settings,
            program: source.number(),
            n: self.last_n,
            used: self.nulls.is_some().then_some(&mut block.used),
            nulls: &mut self.nulls,
            last_null: 0,
            notes: &mut self.notes,
            source: &source,
            world,
        };
        let read = dialect::read(self.settings.system, &mut cursor, &mut scope, &mut self.words, head);
        if cursor.is_cut(text) {
            return wrong(at, E::BlockTooLong);
        }
        let step = match read? {
            Content::Words => {
                let mut running = Running {
                    words: &self.words,
                    modals: &mut self.modals,
                    settings: &self.settings,
                    ops: &mut block.ops,
                    scope: &mut scope,
                    text,
                    at,
                    flow: &self.flow,
                    second_half: self.second_half,
                };
                if self.words.has(b'O') && !at_head(text, at) {
                    return wrong(self.words.look(b'O').map_or(at, |word| word.at as usize), E::MisplacedO);
                }
                let done = dialect::run(&mut running).and_then(|step| self.prepare(step, &cursor, block));
                match &done {
                    Ok(_) => self.modals.modal_call = self.flow.modal.is_some(),
                    Err(_) => self.modals = before,
                }
                done?
            }
            Content::Assign { at, .. }
            | Content::Goto { at, .. }
            | Content::While { at, .. }
            | Content::EndLoop { at, .. }
                if !dialect::has_macros(&self.settings) =>
            {
                return wrong(at, E::NoMacros);
            }
            content => self.statement(content, &cursor, block, text)?,
        };
        self.last_n = self.words.n.or(self.last_n);
        block.at = Place { program: source.number(), line, n: self.words.n };
        if !block.ops.is_empty() {
            block.modals = self.modals;
        }
        Ok(step)
    }

    /// Moves the flow past the block just read.
    #[inline]
    fn pass(&mut self, cursor: &Cursor<'_>) {
        self.second_half = false;
        if statement::goes_on(cursor) {
            self.flow.at = cursor.at;
            self.flow.mid_line = true;
            return;
        }
        let mut cursor = *cursor;
        cursor.line_end();
        self.flow.at = cursor.at;
        self.flow.line += 1;
        self.flow.mid_line = false;
    }

    fn text_over(&mut self, at: usize) -> Outcome<Stepped> {
        // DECISION: a subprogram without M99 returns to the caller at the end of its text.
        if self.flow.is_main() {
            return Ok(Stepped::End);
        }
        if let Some(n) = self.flow.local_sub() {
            return wrong1(self.flow.source.last_line_start(), E::SubWithoutReturn, format!("N{n:04}"));
        }
        self.changed = true;
        self.flow.return_to(None, at)?;
        Ok(Stepped::Nothing)
    }

    fn statement(&mut self, content: Content, cursor: &Cursor<'_>, block: &mut Block, text: &[u8]) -> Outcome<Stepped> {
        match content {
            Content::Nothing | Content::Words => {
                self.pass(cursor);
            }
            Content::Assign { variable, value, at, text: comment } => {
                self.assign(variable, value, at, comment.and_then(|range| text.get(range)), block)?;
                self.pass(cursor);
            }
            Content::Goto { n, at } => self.flow.go_to_block(n, at)?,
            Content::Jump { label, forward, holds } => {
                let line = self.flow.label_line(label, forward)?;
                if holds { self.flow.go_to_line(line) } else { self.pass(cursor) }
            }
            Content::Note { text: said } => {
                let text = self.flow.source.decode(text.get(said).unwrap_or_default()).into_boxed_str();
                block.ops.push(Op::Note { text });
                self.pass(cursor);
            }
            Content::While { holds, number, at } => {
                self.flow.begin_loop(holds, number, at)?;
                if holds {
                    self.pass(cursor);
                }
            }
            Content::EndLoop { number, at } => self.flow.end_loop(number, at)?,
            // A `%` at the head of a text does not end it.
            Content::TextEnd { at } if at_head(text, at) && !text[..at].contains(&b'%') => self.pass(cursor),
            Content::TextEnd { at } => return self.text_over(at),
        }
        Ok(if block.ops.is_empty() { Stepped::Nothing } else { Stepped::Block })
    }

    /// Executes the flow action of a block: jump, call, loop, assignment or end.
    #[inline]
    fn prepare(&mut self, step: Step, cursor: &Cursor<'_>, block: &mut Block) -> Outcome<Stepped> {
        if !matches!(step, Step::Again) {
            self.set_variables(block)?;
        }
        let moves = self.flow.modal.is_some() && block.ops.iter().any(Op::is_motion);
        match step {
            Step::Goto { at, .. } | Step::Call(Call { at, .. }) | Step::Return { at, .. } if moves => {
                // The G66 macro would have to run between the move and the jump.
                return wrong2(at, E::NotTogether, "G66", "M");
            }
            Step::Next => {
                let modal = self.flow.modal.clone().filter(|_| moves);
                let at = self.flow.at;
                let source = modal.as_ref().map(|modal| self.find(modal.program, at)).transpose()?;
                self.pass(cursor);
                if let (Some(modal), Some(source)) = (modal, source) {
                    let callee = Callee::Macro(modal.arguments.clone());
                    self.flow.call(source, Call { program: modal.program, times: modal.times, callee, at }, true)?;
                }
            }
            Step::Again => {
                self.second_half = true;
                block.complete = false;
            }
            Step::Modal(modal) => {
                if let Some(modal) = &modal {
                    self.find(modal.program, self.flow.at)?;
                }
                self.flow.modal = modal.map(Arc::from);
                self.pass(cursor);
            }
            Step::Contour(cycle) => {
                let begin = (self.flow.at, self.flow.line, self.flow.mid_line);
                self.pass(cursor);
                self.pending = Some(Pending { cycle, begin });
            }
            Step::Assign { variable, value, at } => {
                self.assign(variable, value, at, None, block)?;
                self.pass(cursor);
            }
            Step::End => {
                self.pass(cursor);
                self.ended = true;
            }
            elsewhere => self.lead(elsewhere, cursor)?,
        }
        let over = self.ended && block.ops.is_empty();
        Ok(if over {
            Stepped::End
        } else if block.ops.is_empty() {
            Stepped::Nothing
        } else {
            Stepped::Block
        })
    }

    /// Executes jumps, loops, calls and returns.
    fn lead(&mut self, step: Step, cursor: &Cursor<'_>) -> Outcome<()> {
        match step {
            Step::Goto { n, at } => {
                self.flow.go_to_block(n, at)?;
                self.second_half = false;
            }
            Step::Jump { n, at } => {
                self.flow.jump(n, at)?;
                self.second_half = false;
            }
            Step::Local { n, at } => {
                self.changed = true;
                let stood = self.flow.clone_place();
                self.pass(cursor);
                if let Err(stop) = self.flow.call_local(n, at) {
                    self.flow.put_place(stood);
                    return Err(stop);
                }
            }
            Step::Loop { times, at } => {
                self.changed = true;
                if self.flow.begin_counted(times, at)? {
                    self.pass(cursor);
                }
            }
            Step::EndLoop { at } => {
                self.changed = true;
                if self.flow.end_counted(at)? {
                    self.pass(cursor);
                }
            }
            Step::Call(call) => {
                let source = self.find(call.program, call.at)?;
                self.changed = true;
                self.pass(cursor);
                self.flow.call(source, call, false)?;
            }
            Step::Return { target, at } => {
                self.second_half = false;
                self.changed = true;
                if self.flow.is_main() && !dialect::has_macros(&self.settings) {
                    return wrong(at, E::ReturnWithoutCall);
                }
                self.flow.return_to(target, at)?;
            }
            Step::Next | Step::Again | Step::Modal(_) | Step::Contour(_) | Step::Assign { .. } | Step::End => {}
        }
        Ok(())
    }

    /// Sets the variables that the block assigns, before its other operations.
    #[inline]
    fn set_variables(&mut self, block: &mut Block) -> Outcome<()> {
        for index in 0..self.words.sets().len() {
            let Some(set) = self.words.sets().get(index).copied() else { break };
            self.assign(set.variable, Some(set.value), set.at as usize, None, block)?;
            // `assign` appends the operation; it belongs before the others.
            block.ops[index..].rotate_right(1);
        }
        Ok(())
    }

    fn find(&self, program: u32, at: usize) -> Outcome<Arc<Source>> {
        match self.library.find(program) {
            Some(source) => Ok(source),
            None => wrong1(at, E::MissingProgram, program::title(program)),
        }
    }

    fn assign(
        &mut self,
        variable: u32,
        value: Value,
        at: usize,
        comment: Option<&[u8]>,
        block: &mut Block,
    ) -> Outcome<()> {
        let name = || format!("#{variable}");
        match variable {
            1..=33 => {
                self.flow.set_local(variable, value);
                self.changed = true;
            }
            3000 | 3006 => {
                let text = comment.map(|text| self.flow.source.decode(text)).unwrap_or_default().into_boxed_str();
                let value = value.unwrap_or(0.0);
                let Some(number) = super::expression::whole(value).filter(|number| (0..=999).contains(number)) else {
                    return wrong2(at, E::OutOfRange, format!("#{variable}={value}"), "0–999");
                };
                let number = number as u32;
                block.ops.push(if variable == 3000 {
                    Op::Alarm { number: 3000 + number, text }
                } else {
                    Op::Message { number, text }
                });
            }
            _ if Memory::has(variable) => match self.memory.set(variable, value) {
                Ok(()) => block.ops.push(Op::Set { variable, value }),
                Err(VariableError::Switch(_)) => return wrong1(at, E::SwitchVariable, name()),
                Err(VariableError::Unknown(_)) => return wrong1(at, E::BadVariable, name()),
                Err(VariableError::NotFinite(_)) => return wrong(at, E::Overflow),
            },
            0 => return wrong1(at, E::ReadOnly, name()),
            _ => match system_variable::find(variable).map(|range| range.access) {
                Some(Access::Read) => return wrong1(at, E::ReadOnly, name()),
                Some(Access::ReadWrite | Access::Write) => {
                    block.ops.push(Op::SetSystem { number: variable, value });
                }
                None => return wrong1(at, E::BadVariable, name()),
            },
        }
        Ok(())
    }
}
