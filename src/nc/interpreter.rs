//! The interpreter: one block at a time, from text to operations. Source: spec B1, B3.

use std::sync::Arc;

use super::dialect::{self, Running, Step};
use super::expression::{Scope, Value};
use super::fault::{Fault, Outcome, Place, Stop, Wrong, wrong, wrong1};
use super::flow::{Call, Callee, Flow, Locals};
use super::lexer::Cursor;
use super::memory::{Memory, VariableError};
use super::modal::Modals;
use super::op::Op;
use super::settings::Settings;
use super::source::{Library, Source};
use super::statement::{self, Content, Head};
use super::words::Words;
use super::world::{Live, World};
use crate::defs::program_error::ProgramError as E;
use crate::units::PerAxis;

/// How many blocks without an operation one call of `next` may read.
pub const STATEMENTS_PER_CALL: usize = 1_000;

/// The operations of one block.
#[derive(Clone, Debug)]
pub struct Block {
    /// Where it stands.
    pub at: Place,
    /// What it does, in order.
    pub ops: Vec<Op>,
    /// What is in force after it.
    pub modals: Modals,
    /// Whether the block is done with this: single block stops here. A block that both changes the frame or tool and
    /// moves comes in two parts.
    pub complete: bool,
}

impl Block {
    /// An empty block, to be filled again and again.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self { at: Place::default(), ops: Vec::with_capacity(8), modals: Modals::new(settings), complete: true }
    }

    fn clear(&mut self) {
        self.ops.clear();
        self.complete = true;
    }
}

/// What came of asking for the next block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// The block is filled.
    Block,
    /// A live value is wanted: ask again when motion has drained. Nothing was changed.
    Drain,
    /// Many blocks were read and none had an operation: ask again in the next tick.
    Busy,
    /// M30, M02, `%` or the end of the text.
    End,
}

/// Reads a program, ahead of its execution.
pub struct Interpreter {
    flow: Flow,
    library: Arc<dyn Library + Send + Sync>,
    settings: Settings,
    memory: Memory,
    modals: Modals,
    words: Words,
    ended: bool,
    /// Something other than `%` and comments was read in the main program.
    begun: bool,
    second_half: bool,
    /// Where null was taken as 0, if somebody wants to know.
    pub(crate) nulls: Option<Vec<NullUse>>,
}

/// Variables as the text being read sees them.
pub(crate) struct LiveScope<'w> {
    locals: &'w Locals,
    memory: &'w Memory,
    modals: &'w Modals,
    mill: bool,
    program: u32,
    n: Option<u32>,
    nulls: &'w mut Option<Vec<NullUse>>,
    last_null: u32,
    source: &'w Arc<Source>,
    pub world: &'w mut dyn World,
}

/// Where null was taken as 0, and the variable that was null.
type NullUse = (Arc<Source>, usize, u32);

/// What one statement came to.
enum Stepped {
    Nothing,
    Block,
    End,
}

impl Interpreter {
    /// Stands at the head of a program, with its own copy of the common variables.
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
            begun: false,
            second_half: false,
            nulls: None,
        }
    }

    /// Goes on with what was in force before: MDI blocks, a run from a chosen block.
    #[must_use]
    pub fn with_modals(mut self, modals: Modals) -> Self {
        self.modals = Modals { preset: false, several_tools: false, modal_call: false, ..modals };
        self
    }

    /// What is in force after the last block handed out.
    #[must_use]
    pub const fn modals(&self) -> &Modals {
        &self.modals
    }

    /// The look-ahead copy of the common variables.
    #[must_use]
    pub const fn memory(&self) -> &Memory {
        &self.memory
    }

    /// #1–#33 of the running level, index 0 is #1.
    #[must_use]
    pub fn locals(&self) -> &[Option<f64>; 33] {
        self.flow.locals()
    }

    /// The line that is read next.
    #[must_use]
    pub fn place(&self) -> Place {
        Place { program: self.flow.source.number(), line: self.flow.line + 1, n: None }
    }

    /// The operator changed a common variable while the program runs.
    ///
    /// # Errors
    /// As [`Memory::set`].
    pub fn variable_edited(&mut self, number: u32, value: Option<f64>) -> Result<(), VariableError> {
        self.memory.set(number, value)
    }

    /// Fills `block` with the next block that has operations.
    ///
    /// # Errors
    /// The program's mistake; nothing of the block was done, and asking again gives the same fault.
    pub fn next(&mut self, world: &mut dyn World, block: &mut Block) -> Result<Next, Fault> {
        block.clear();
        if self.ended {
            return Ok(Next::End);
        }
        for _ in 0..STATEMENTS_PER_CALL {
            match self.step(world, block) {
                Ok(Stepped::Nothing) => {}
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

    /// Goes past the line of a fault; for a check that wants to see the rest.
    pub(crate) fn skip_line(&mut self) {
        self.second_half = false;
        self.begun = true;
        self.flow.go_to_line(self.flow.line + 1);
    }

    /// Leaves the outermost loop that is open; for a check that sees no end of it.
    pub(crate) fn leave_loop(&mut self) -> bool {
        self.flow.leave_loops()
    }

    /// Whether M99 has begun the main program again.
    pub(crate) const fn has_restarted(&self) -> bool {
        self.flow.restarted
    }

    /// Whether there is anything to remark on the last block.
    pub(crate) fn has_remarks(&self) -> bool {
        self.flow.mid_line || self.nulls.as_ref().is_some_and(|nulls| !nulls.is_empty())
    }

    /// What is allowed and seldom meant in the last block.
    pub(crate) fn remarks(&mut self) -> Vec<Fault> {
        let source = Arc::clone(&self.flow.source);
        let mut remarks = Vec::new();
        for (source, at, variable) in self.nulls.iter_mut().flat_map(|nulls| nulls.drain(..)) {
            let details = [format!("#{variable}"), String::new()];
            remarks.push(fault_in(&source, None, Wrong { at, error: E::NullUsed, details }));
        }
        if self.flow.mid_line {
            let wrong = Wrong { at: self.flow.at, error: E::BlockAfterSemicolon, details: Default::default() };
            remarks.push(fault_in(&source, None, wrong));
        }
        remarks
    }

    /// The running program and the line (from 0) that is read next.
    pub(crate) fn at_line(&self) -> (&Arc<Source>, u32) {
        (&self.flow.source, self.flow.line)
    }

    /// Reads one block whatever it is; `true` while there is more.
    pub(crate) fn single(&mut self, world: &mut dyn World, block: &mut Block) -> Result<Option<bool>, Fault> {
        block.clear();
        match self.step(world, block) {
            Ok(Stepped::Nothing) => Ok(Some(false)),
            Ok(Stepped::Block) => Ok(Some(!self.ended)),
            Ok(Stepped::End) => Ok(None),
            Err(stop) => match *stop {
                Stop::Drain => Ok(Some(false)),
                Stop::Wrong(wrong) => Err(self.fault(wrong)),
            },
        }
    }

    fn fault(&self, wrong: Wrong) -> Fault {
        fault_in(&self.flow.source, self.words.n, wrong)
    }

    fn step(&mut self, world: &mut dyn World, block: &mut Block) -> Outcome<Stepped> {
        if self.ended {
            return Ok(Stepped::End);
        }
        let source = Arc::clone(&self.flow.source);
        let text = source.bytes();
        let (at, line) = (self.flow.at, self.flow.line + 1);
        let mut cursor = Cursor::new(text, at);
        if cursor.is_over() {
            return self.text_over(at);
        }
        let head = Head { mid_line: self.flow.mid_line, block_skip: world.block_skip() };
        let mut scope = LiveScope {
            locals: self.flow.locals(),
            memory: &self.memory,
            modals: &self.modals,
            mill: self.settings.is_mill(),
            program: source.number(),
            n: self.words.n,
            nulls: &mut self.nulls,
            last_null: 0,
            source: &source,
            world,
        };
        let content = statement::read(&mut cursor, &mut scope, &mut self.words, head)?;
        let step = match content {
            Content::Words => {
                let mut modals = self.modals;
                let mut running = Running {
                    words: &self.words,
                    modals: &mut modals,
                    settings: &self.settings,
                    ops: &mut block.ops,
                    scope: &mut scope,
                    text,
                    at,
                    second_half: self.second_half,
                };
                if self.words.look(b'O').is_some() && (self.begun || !self.flow.is_main()) && !at_head(text, at) {
                    return wrong(at, E::MisplacedO);
                }
                let step = dialect::run(&mut running)?;
                let call = self.prepare(step, &cursor, block)?;
                self.modals = modals;
                call
            }
            content => self.statement(content, &cursor, block, text)?,
        };
        block.at = Place { program: source.number(), line, n: self.words.n };
        block.modals = self.modals;
        Ok(step)
    }

    /// Puts the flow behind the block that was read.
    fn pass(&mut self, cursor: &Cursor<'_>) {
        self.begun = true;
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
        // DECISION: the end of a subprogram's text without M99 returns to the caller.
        if self.flow.is_main() {
            return Ok(Stepped::End);
        }
        self.flow.return_to(None, at)?;
        Ok(Stepped::Nothing)
    }

    fn statement(&mut self, content: Content, cursor: &Cursor<'_>, block: &mut Block, text: &[u8]) -> Outcome<Stepped> {
        match content {
            Content::Nothing | Content::Words => {
                let begun = self.begun;
                self.pass(cursor);
                self.begun = begun;
            }
            Content::Assign { variable, value, at, text: comment } => {
                self.assign(variable, value, at, comment.and_then(|range| text.get(range)), block)?;
                self.pass(cursor);
            }
            Content::Goto { n, at } => self.flow.go_to_block(n, at)?,
            Content::While { holds, number, at } => {
                self.flow.begin_loop(holds, number, at)?;
                if holds {
                    self.pass(cursor);
                }
            }
            Content::EndLoop { number, at } => self.flow.end_loop(number, at)?,
            Content::TextEnd { at } if self.begun || !self.flow.is_main() => {
                let first = self.flow.line == 0;
                if !first {
                    return self.text_over(at);
                }
                self.pass(cursor);
            }
            Content::TextEnd { .. } => self.pass(cursor),
        }
        Ok(if block.ops.is_empty() { Stepped::Nothing } else { Stepped::Block })
    }

    /// Acts on what a block of words asked for besides its operations.
    fn prepare(&mut self, step: Step, cursor: &Cursor<'_>, block: &mut Block) -> Outcome<Stepped> {
        match step {
            Step::Next => {
                let moves = self.flow.modal.is_some() && block.ops.iter().any(Op::is_motion);
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
            Step::Goto { n, at } => {
                self.flow.go_to_block(n, at)?;
                self.second_half = false;
            }
            Step::Call(call) => {
                let source = self.find(call.program, call.at)?;
                self.pass(cursor);
                self.flow.call(source, call, false)?;
            }
            Step::Modal(modal) => {
                if let Some(modal) = &modal {
                    self.find(modal.program, self.flow.at)?;
                }
                self.flow.modal = modal.map(Arc::from);
                self.pass(cursor);
            }
            Step::Return { target, at } => {
                self.begun = true;
                self.second_half = false;
                self.flow.return_to(target, at)?;
            }
            Step::Assign { variable, value, at } => {
                self.assign(variable, value, at, None, block)?;
                self.pass(cursor);
            }
            Step::End => {
                self.pass(cursor);
                self.ended = true;
            }
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

    fn find(&self, program: u32, at: usize) -> Outcome<Arc<Source>> {
        match self.library.find(program) {
            Some(source) => Ok(source),
            None => wrong1(at, E::MissingProgram, format!("O{program:04}")),
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
            1..=33 => self.flow.set_local(variable, value),
            3000 | 3006 => {
                let text = comment.map(|text| self.flow.source.decode(text)).unwrap_or_default().into_boxed_str();
                let value = value.unwrap_or(0.0);
                let Some(number) = super::expression::whole(value).filter(|number| (0..=999).contains(number)) else {
                    return super::fault::wrong2(at, E::OutOfRange, format!("#{variable}={value}"), "0–999");
                };
                let number = number as u32;
                block.ops.push(if variable == 3000 {
                    Op::Alarm { number: 3000 + number, text }
                } else {
                    Op::Message { number, text }
                });
            }
            434..=439 | 1100..=1199 | 2000..=2999 | 3001..=3005 | 3901 | 3902 => {
                block.ops.push(Op::SetSystem { number: variable, value });
            }
            0 | 1000..=1099 | 4000..=5999 => return wrong1(at, E::ReadOnly, name()),
            _ => match self.memory.set(variable, value) {
                Ok(()) => block.ops.push(Op::Set { variable, value }),
                Err(VariableError::Switch(_)) => return wrong1(at, E::SwitchVariable, name()),
                Err(VariableError::Unknown(_)) => return wrong1(at, E::BadVariable, name()),
                Err(VariableError::NotFinite(_)) => return wrong(at, E::Overflow),
            },
        }
        Ok(())
    }
}

/// Whether nothing but `%`, blanks and comment lines stands before a byte.
fn at_head(text: &[u8], at: usize) -> bool {
    let mut comment = false;
    text.get(..at).unwrap_or_default().iter().all(|byte| {
        comment = match byte {
            b'\r' | b'\n' => false,
            b';' | b'(' => true,
            _ => comment,
        };
        comment || matches!(byte, b'%' | b' ' | b'\t' | b'\r' | b'\n')
    })
}

/// Gives a mistake its place.
pub(crate) fn fault_in(source: &Source, n: Option<u32>, mut wrong: Wrong) -> Fault {
    if wrong.error == E::ForeignCharacter
        && let Some((character, instead)) = source.foreign(wrong.at)
    {
        wrong.details = [character.to_string(), instead];
    }
    let (place, column) = source.place(wrong.at, n);
    Fault::new(place, column, wrong)
}

impl LiveScope<'_> {
    /// Where the block begins.
    pub fn position(&self) -> PerAxis<f64> {
        self.world.position()
    }
}

impl Scope for LiveScope<'_> {
    const STRICT: bool = true;

    fn read(&mut self, number: u32, at: usize) -> Outcome<Value> {
        let value = self.look_up(number, at)?;
        if value.is_none() {
            self.last_null = number;
        }
        Ok(value)
    }

    fn null_used(&mut self, at: usize) {
        if let Some(nulls) = self.nulls {
            nulls.push((Arc::clone(self.source), at, self.last_null));
        }
    }
}

impl LiveScope<'_> {
    fn look_up(&mut self, number: u32, at: usize) -> Outcome<Value> {
        match number {
            0 => Ok(None),
            1..=33 => Ok(self.locals[number as usize - 1]),
            4114 => Ok(self.n.map(f64::from)),
            4115 => Ok(Some(f64::from(self.program))),
            4000..=4200 => self
                .modals
                .variable(number, self.mill)
                .map_or_else(|| wrong1(at, E::BadVariable, format!("#{number}")), Ok),
            434..=439 | 1000.. => match self.world.system(number) {
                Live::Value(value) => Ok(value),
                Live::Drain => Err(Box::new(Stop::Drain)),
                Live::Unknown => wrong1(at, E::BadVariable, format!("#{number}")),
            },
            _ => self.memory.get(number).or_else(|_| wrong1(at, E::BadVariable, format!("#{number}"))),
        }
    }
}
