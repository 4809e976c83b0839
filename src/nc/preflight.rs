//! Preflight check before program start, one piece per tick: a program with a mistake anywhere does not start.
//!
//! A dialect without variables (超人) is followed to its end, as in a check. In a dialect with R parameters only the
//! syntax is checked, with all called programs: values are known only in the run. Macro programs are not checked.
//! Source: spec L1, L2, L5, L7, S1.

use std::collections::HashSet;
use std::sync::Arc;

use super::check::ProgramCheck;
use super::common_variables::CommonVariables;
use super::dialect::{self, PreflightScope};
use super::external_state::OfflineMachine;
use super::fault::ProgramFault;
use super::settings::{Dialect, NcSettings};
use super::source::{SharedLibrary, Source};
use super::unexecuted_lines::{self, UnexecutedLines};
use crate::units::WorkBudget;

/// Blocks without a new line after which a loop counts as endless; they take 0.3 s.
const STANDSTILL_BLOCKS: u32 = 100_000;
/// Most texts that are read for one program.
const MAX_TEXTS: usize = 100;

/// Lines of a program for which memory is taken at power-on: a byte each, which the system maps when it is used.
const USUAL_LINES: usize = 1 << 20;

/// The preflight of one program after another, in the same memory.
pub struct ProgramPreflight {
    /// Memory of both methods; the dialect of the program chooses one.
    check: ProgramCheck,
    world: OfflineMachine,
    texts: TextPreflight,
    scope: PreflightScope,
    no_variables: CommonVariables,
}

/// Syntax check of a program's text and the texts that it calls.
struct TextPreflight {
    settings: NcSettings,
    library: SharedLibrary,
    source: Arc<Source>,
    unread: UnexecutedLines,
    pending_programs: Vec<u32>,
    visited_programs: HashSet<u32>,
    /// The check of the text as a whole is done.
    text_checked: bool,
}

/// The result of one piece.
#[derive(Clone, Debug)]
pub enum PreflightStatus {
    /// Call again.
    Busy,
    /// No mistake was found.
    Passed,
    /// The program must not start.
    Failed(ProgramFault),
}

impl ProgramPreflight {
    /// Takes the memory. The program stands in until the first one begins.
    #[must_use]
    pub fn new(program: &(Arc<Source>, SharedLibrary), settings: &NcSettings) -> Self {
        let (source, library) = program;
        let no_variables = CommonVariables::default();
        let mut check =
            ProgramCheck::new(source, library, settings, no_variables.clone()).with_standstill_limit(STANDSTILL_BLOCKS);
        check.reserve(USUAL_LINES);
        let texts = TextPreflight {
            settings: settings.clone(),
            library: Arc::clone(library),
            source: Arc::clone(source),
            unread: UnexecutedLines::with_capacity(USUAL_LINES),
            pending_programs: Vec::with_capacity(MAX_TEXTS),
            visited_programs: HashSet::with_capacity(MAX_TEXTS),
            text_checked: false,
        };
        let world = OfflineMachine::new(settings);
        Self { check, world, texts, scope: PreflightScope::Unsupported, no_variables }
    }

    /// Whether programs of a dialect have a preflight.
    #[must_use]
    pub fn is_supported(dialect: Dialect) -> bool {
        dialect::rules(dialect).preflight_scope != PreflightScope::Unsupported
    }

    /// Begins with a program. `world` is the state at its start.
    pub fn begin(&mut self, program: (Arc<Source>, SharedLibrary), settings: &NcSettings, world: OfflineMachine) {
        self.scope = dialect::rules(settings.dialect).preflight_scope;
        self.world = world;
        match self.scope {
            PreflightScope::FullRun => self.check.begin(program, settings, &self.no_variables),
            PreflightScope::TextOnly => self.texts.begin(program, settings),
            PreflightScope::Unsupported => {}
        }
    }

    /// Lets go of the program; another takes its place.
    pub fn leave(&mut self, program: (Arc<Source>, SharedLibrary)) {
        (self.texts.source, self.texts.library) = program.clone();
        self.check.leave(program);
    }

    /// Checks on until the budget is spent.
    pub fn advance(&mut self, budget: &mut WorkBudget) -> PreflightStatus {
        match self.scope {
            PreflightScope::FullRun => {
                let more = self.check.advance(&mut self.world, &mut |_| true, budget);
                match self.check.faults().first() {
                    Some(fault) => PreflightStatus::Failed(fault.clone()),
                    None if more => PreflightStatus::Busy,
                    None => PreflightStatus::Passed,
                }
            }
            PreflightScope::TextOnly => self.texts.advance(budget),
            PreflightScope::Unsupported => PreflightStatus::Passed,
        }
    }
}

impl TextPreflight {
    fn begin(&mut self, (source, library): (Arc<Source>, SharedLibrary), settings: &NcSettings) {
        self.unread.begin(source.line_count());
        self.pending_programs.clear();
        self.visited_programs.clear();
        self.visited_programs.insert(source.number());
        (self.source, self.library, self.text_checked) = (source, library, false);
        self.settings = settings.clone();
    }

    fn advance(&mut self, budget: &mut WorkBudget) -> PreflightStatus {
        let mut first = None;
        if !std::mem::replace(&mut self.text_checked, true) {
            first = unexecuted_lines::check_whole_text(&self.source, &self.settings).next();
        }
        let (source, settings) = (&*self.source, &self.settings);
        let more = self.unread.advance(source, settings, Some(&*self.library), budget, &mut |fault| {
            first.get_or_insert(fault);
        });
        if let Some(fault) = first {
            return PreflightStatus::Failed(fault);
        }
        if more {
            return PreflightStatus::Busy;
        }
        for (number, _) in self.unread.calls.drain(..) {
            if self.visited_programs.len() < MAX_TEXTS && self.visited_programs.insert(number) {
                self.pending_programs.push(number);
            }
        }
        while let Some(number) = self.pending_programs.pop() {
            if let Some(source) = self.library.find(number) {
                self.unread.begin(source.line_count());
                (self.source, self.text_checked) = (source, false);
                return PreflightStatus::Busy;
            }
        }
        PreflightStatus::Passed
    }
}
