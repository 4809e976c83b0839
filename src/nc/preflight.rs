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
use super::settings::NcSettings;
use super::source::{SharedLibrary, Source};
use super::unexecuted_lines::{self, UnexecutedLines};

/// Blocks or lines per call.
const BLOCKS_PER_CALL: u32 = 500;
/// Blocks without a new line after which a loop counts as endless; they take 0.2 s.
const STANDSTILL_BLOCKS: u32 = 100_000;
/// Most texts that are read for one program.
const MAX_TEXTS: usize = 100;

/// A preflight check in progress.
pub struct ProgramPreflight(PreflightMethod);

enum PreflightMethod {
    FullRun(Box<ProgramCheck>, Box<OfflineMachine>),
    TextOnly(Box<TextPreflight>),
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
    /// Starts a preflight; none for a dialect that has none. `world` is the state at program start.
    #[must_use]
    pub fn new(
        source: &Arc<Source>,
        library: &SharedLibrary,
        settings: &NcSettings,
        world: OfflineMachine,
    ) -> Option<Self> {
        Some(Self(match dialect::rules(settings.dialect).preflight_scope {
            PreflightScope::FullRun => {
                let checking = ProgramCheck::new(source, library, settings, CommonVariables::default())
                    .with_standstill_limit(STANDSTILL_BLOCKS);
                PreflightMethod::FullRun(Box::new(checking), Box::new(world))
            }
            PreflightScope::TextOnly => PreflightMethod::TextOnly(Box::new(TextPreflight {
                settings: settings.clone(),
                library: Arc::clone(library),
                source: Arc::clone(source),
                unread: UnexecutedLines::new(source.line_count()),
                pending_programs: Vec::new(),
                visited_programs: HashSet::from([source.number()]),
                text_checked: false,
            })),
            PreflightScope::Unsupported => return None,
        }))
    }

    /// Checks the next piece.
    pub fn advance(&mut self) -> PreflightStatus {
        match &mut self.0 {
            PreflightMethod::FullRun(checking, world) => {
                let more = checking.advance(world, &mut |_| true, BLOCKS_PER_CALL);
                match checking.faults().first() {
                    Some(fault) => PreflightStatus::Failed(fault.clone()),
                    None if more => PreflightStatus::Busy,
                    None => PreflightStatus::Passed,
                }
            }
            PreflightMethod::TextOnly(texts) => texts.advance(),
        }
    }
}

impl TextPreflight {
    fn advance(&mut self) -> PreflightStatus {
        let mut first = None;
        if !std::mem::replace(&mut self.text_checked, true) {
            first = unexecuted_lines::check_whole_text(&self.source, &self.settings).next();
        }
        let text = (&*self.source, &self.settings);
        let more = self.unread.advance(text, Some(&*self.library), BLOCKS_PER_CALL, &mut |fault| {
            first.get_or_insert(fault);
        });
        if let Some(fault) = first {
            return PreflightStatus::Failed(fault);
        }
        if more {
            return PreflightStatus::Busy;
        }
        self.pending_programs.extend(self.unread.calls.drain(..).map(|(number, _)| number));
        while let Some(number) = self.pending_programs.pop() {
            if self.visited_programs.len() < MAX_TEXTS
                && self.visited_programs.insert(number)
                && let Some(source) = self.library.find(number)
            {
                (self.unread, self.source, self.text_checked) =
                    (UnexecutedLines::new(source.line_count()), source, false);
                return PreflightStatus::Busy;
            }
        }
        PreflightStatus::Passed
    }
}
