//! MDI: the page prepares a line and cycle start executes it, so that no page starts a motion.
//! Source: spec B5, B6.

use std::sync::Arc;

use super::Program;
use super::cycle::START_VOID;
use super::lookahead_state::LookaheadState;
use super::run::{Origin, RunStart};
use super::run_world::RunWorld;
use crate::controller::plant::system_variables::nc_settings;
use crate::controller::plant::{ControlPhase, Plant};
use crate::defs::key::Mode;
use crate::defs::kind::Dialect;
use crate::defs::mcode::Request;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::edit::ModalView;
use crate::machine::RequestResult;
use crate::machine::panel_key::NOT_IN_RUN;
use crate::nc::{ModalState, NcSettings, NextStatus, SharedLibrary, Source};

/// Maximum characters of an MDI line.
const MAX_MDI_CHARS: usize = 500;

const NOT_MDI: Text =
    Text::new("录入方式下才能执行：先按 录入 键", "MDI lines run in mode MDI only: press the MDI key first");
const OPEN_RUN: Text = Text::new("程序未结束，先等待或复位", "a program is active: wait, or press RESET");
const TOO_LONG: Text = Text::new("录入行太长", "the MDI line is too long");
const NO_LINE: Text = Text::new("先输入一行，再按循环启动", "type a line and press INPUT before cycle start");

/// The MDI line. Its text is indexed in memory that is taken at power-on.
pub struct MdiLine {
    source: Arc<Source>,
    /// It waits for cycle start.
    ready: bool,
}

impl MdiLine {
    /// No line, for programs of a dialect.
    pub fn new(dialect: Dialect) -> Self {
        Self { source: Arc::new(Self::empty(dialect)), ready: false }
    }

    fn empty(dialect: Dialect) -> Source {
        Source::with_capacity("MDI", MAX_MDI_CHARS * char::MAX_LEN_UTF8, dialect)
    }

    /// Indexes a line; it does not wait for cycle start yet.
    fn set(&mut self, line: &str) {
        self.ready = false;
        if Arc::get_mut(&mut self.source).is_none() {
            // Cannot happen: the run that holds the line is over when the next one is typed.
            self.source = Arc::new(Self::empty(self.source.dialect()));
        }
        if let Some(source) = Arc::get_mut(&mut self.source) {
            source.set_text(line.as_bytes());
        }
    }

    /// The text that waits for cycle start; empty if none.
    pub fn waiting_text(&self) -> &str {
        let text = if self.ready { self.source.bytes() } else { &[] };
        str::from_utf8(text).unwrap_or_default()
    }
}

impl Program {
    /// Prepares a line after checking its first block. The line prepared before is discarded, also by an empty line or
    /// one that is refused.
    pub fn prepare_mdi(&mut self, plant: &mut Plant, line: &str) -> Result<LocalizedText, LocalizedText> {
        let line = line.trim();
        self.discard_mdi();
        if line.is_empty() {
            return Ok(phrase!("录入行已取消", "the MDI line is cancelled"));
        }
        if plant.operator.mode != Mode::Mdi {
            return Err(NOT_MDI.into());
        }
        if !matches!(plant.execution.phase, ControlPhase::Idle) {
            return Err(OPEN_RUN.into());
        }
        if line.chars().count() > MAX_MDI_CHARS {
            return Err(TOO_LONG.into());
        }
        self.mdi.set(line);
        self.check_mdi(plant)?;
        self.mdi.ready = true;
        Ok(phrase!("按循环启动执行", "press cycle start to execute it"))
    }

    /// Mode change or RESET: a line prepared earlier must not start.
    pub const fn discard_mdi(&mut self) {
        self.mdi.ready = false;
    }

    /// Cycle start in mode MDI.
    pub fn start_mdi(&mut self, plant: &mut Plant) {
        if !self.mdi.ready {
            return plant.refuse(NO_LINE);
        }
        self.open_mdi(plant);
        if self.run.is_some() {
            self.discard_mdi();
        }
    }

    /// Executes a line of MDI text.
    pub fn run_mdi(&mut self, plant: &mut Plant, line: &str) {
        if line.chars().count() > MAX_MDI_CHARS {
            return plant.refuse(TOO_LONG);
        }
        if matches!(plant.execution.phase, ControlPhase::Idle) {
            self.mdi.set(line);
        }
        self.open_mdi(plant);
    }

    /// Executes the line, if the machine may start it.
    fn open_mdi(&mut self, plant: &mut Plant) {
        if plant.execution.starts_void {
            return plant.refuse(START_VOID);
        }
        if plant.operator.mode != Mode::Mdi {
            return plant.refuse(phrase!("录入方式下才能执行", "MDI lines run in mode MDI only"));
        }
        if !matches!(plant.execution.phase, ControlPhase::Idle) {
            return plant.refuse(NOT_IN_RUN);
        }
        if let Some(why) = self.retract_blocks_start(plant) {
            return plant.refuse(why);
        }
        if matches!(plant.request(Request::MdiStart), RequestResult::Accepted) {
            self.open_run(plant, Arc::clone(&self.mdi.source), Origin::Mdi);
        }
    }

    /// Checks the first block of the line from the present machine position.
    fn check_mdi(&mut self, plant: &mut Plant) -> Result<(), LocalizedText> {
        let source = Arc::clone(&self.mdi.source);
        let settings = NcSettings { needs_block_numbers: false, ..nc_settings(plant.kind, &plant.params) };
        let modals = self.mdi_modals.unwrap_or_else(|| ModalState::new(&settings));
        let mut offsets = plant.work.offsets.clone();
        offsets.activate(modals.work_offset);
        let mut lookahead =
            LookaheadState::new(offsets, plant.axes.set_point(), plant.work.dress_points, modals.path_mode);
        lookahead.oscillating = plant.oscillating_axis();
        lookahead.dialect = plant.kind.row().dialect;
        let program: (_, SharedLibrary) = (source, Arc::clone(&plant.work.programs) as _);
        let memory = &plant.work.variables;
        let start = RunStart { program, settings, modals, memory, lookahead, preflight: None };
        let mut run = self.pool.open(start, plant.now);
        let mut world = RunWorld::new(plant, &run.lookahead, true);
        let mut budget = plant.reading_budget();
        let checked = match run.interpreter.next_within(&mut world, &mut run.block, &mut budget) {
            Ok(NextStatus::Block) => run.queue_block(&plant.params).map_err(|forbidden| forbidden.text(&plant.params)),
            Ok(NextStatus::Drain | NextStatus::Busy | NextStatus::Waiting | NextStatus::End) => Ok(()),
            Err(fault) => Err(fault.cause_phrase()),
        };
        self.pool.close(run);
        plant.charge_reading(budget);
        checked
    }

    /// The active modal codes: of the run as read, of the last MDI line, or the power-on state.
    pub fn modal_view(&self, plant: &Plant) -> ModalView {
        let settings = nc_settings(plant.kind, &plant.params);
        if let Some(chosen) = self.restart_modals(plant) {
            return chosen;
        }
        let modals = match (&self.run, &self.mdi_modals) {
            (Some(run), _) => run.block.modals,
            (None, Some(kept)) => *kept,
            (None, None) => ModalState::new(&settings),
        };
        let mut view = modal_view_of(plant, &modals);
        // Without a T word the offset of the last program acts on (K4.1).
        let offsets = &plant.work.offsets;
        if view.tool == (0, 0) && offsets.tool_offset != 0 {
            view.tool = (offsets.tool as u16, offsets.tool_offset as u16);
        }
        view
    }
}

/// Modal codes as the pages show them.
pub fn modal_view_of(plant: &Plant, modals: &ModalState) -> ModalView {
    ModalView {
        g: modals.g_codes(plant.kind.dialect()),
        feed: modals.feed,
        speed: modals.speed,
        tool: (modals.tool, modals.offset),
        m: modals.m_code,
    }
}
