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
use crate::defs::mcode::Request;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::link::edit::ModalView;
use crate::machine::RequestResult;
use crate::machine::panel_key::NOT_IN_RUN;
use crate::nc::{ModalState, NcSettings, NextStatus, SharedLibrary, Source};

/// Maximum characters of an MDI line.
const MAX_MDI_CHARS: usize = 500;

const NOT_MDI: Text = Text::new("录入方式下才能执行：先按 录入 键", "MDI lines work in mode MDI: press that key first");
const OPEN_RUN: Text = Text::new("程序未结束，先等待或复位", "a program is open: wait, or press RESET");
const TOO_LONG: Text = Text::new("录入行太长", "the MDI line is too long");
const NO_LINE: Text = Text::new("先输入一行，再按循环启动", "type a line and press 输入 before cycle start");

impl Program {
    /// Prepares a line after checking its first block; an empty line discards the prepared one.
    pub fn prepare_mdi(&mut self, plant: &mut Plant, line: &str) -> Result<LocalizedText, LocalizedText> {
        let line = line.trim();
        if line.is_empty() {
            self.discard_mdi();
            return Ok(phrase!("录入行已取消", "the MDI line is taken back"));
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
        self.check_mdi(plant, line)?;
        self.mdi_ready = Arc::from(line);
        Ok(phrase!("按循环启动执行", "press cycle start to execute it"))
    }

    /// Mode change or RESET: a line prepared earlier must not start.
    pub fn discard_mdi(&mut self) {
        if !self.mdi_ready.is_empty() {
            self.mdi_ready = Arc::from("");
        }
    }

    /// Cycle start in mode MDI.
    pub fn start_mdi(&mut self, plant: &mut Plant) {
        let line = Arc::clone(&self.mdi_ready);
        if line.is_empty() {
            return plant.refuse(NO_LINE);
        }
        self.run_mdi(plant, &line);
        if self.run.is_some() {
            self.discard_mdi();
        }
    }

    /// Executes a line of MDI text.
    pub fn run_mdi(&mut self, plant: &mut Plant, line: &str) {
        if plant.execution.starts_void {
            return plant.refuse(START_VOID);
        }
        if plant.operator.mode != Mode::Mdi {
            return plant.refuse(phrase!("录入方式下才能执行", "MDI lines work in mode MDI"));
        }
        if !matches!(plant.execution.phase, ControlPhase::Idle) {
            return plant.refuse(NOT_IN_RUN);
        }
        if line.chars().count() > MAX_MDI_CHARS {
            return plant.refuse(phrase!("录入行太长", "the MDI line is too long"));
        }
        if let Some(why) = self.retract_blocks_start(plant) {
            return plant.refuse(why);
        }
        if matches!(plant.request(Request::MdiStart), RequestResult::Accepted) {
            let source = Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec(), plant.kind.row().dialect));
            self.open_run(plant, source, Origin::Mdi);
        }
    }

    /// Checks the first block of the line from the present machine position.
    fn check_mdi(&mut self, plant: &Plant, line: &str) -> Result<(), LocalizedText> {
        let source = Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec(), plant.kind.row().dialect));
        let settings = NcSettings { needs_block_numbers: false, ..nc_settings(plant.kind, &plant.params) };
        let modals = self.mdi_modals.unwrap_or_else(|| ModalState::new(&settings));
        let mut frames = plant.work.offsets.clone();
        frames.activate(modals.work_offset);
        let mut planned =
            LookaheadState::new(frames, plant.axes.set_point(), plant.work.dress_points, modals.path_mode);
        planned.oscillating = plant.oscillating_axis();
        planned.dialect = plant.kind.row().dialect;
        let program: (_, SharedLibrary) = (source, Arc::clone(&plant.work.programs) as _);
        let start = RunStart { program, settings, modals, memory: &plant.work.variables, lookahead: planned };
        let mut run = self.pool.open(start, plant.now);
        let mut world = RunWorld::new(plant, &run.lookahead, true);
        let checked = match run.interpreter.next(&mut world, &mut run.block) {
            Ok(NextStatus::Block) => run.queue_block(&plant.params).map_err(|forbidden| forbidden.text(&plant.params)),
            Ok(NextStatus::Drain | NextStatus::Busy | NextStatus::End) => Ok(()),
            Err(fault) => Err(fault.cause_phrase()),
        };
        self.pool.close(run);
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
        modal_view_of(plant, &modals)
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
