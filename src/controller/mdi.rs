//! MDI: the page prepares a line and cycle start executes it, so that no page starts a motion.
//! Source: spec B5, B6.

use std::sync::Arc;

use super::commands::MAX_MDI_CHARS;
use super::lookahead_state::LookaheadState;
use super::run::ProgramRun;
use super::system_variables::{RunWorld, nc_settings};
use super::{ControlPhase, Controller};
use crate::defs::key::Mode;
use crate::defs::text::{Lang, LocalizedText, Text};
use crate::link::edit::ModalView;
use crate::nc::{ModalState, NcSettings, NextStatus, Source};

const NOT_MDI: Text = Text::new("录入方式下才能执行：先按 录入 键", "MDI lines work in mode MDI: press that key first");
const OPEN_RUN: Text = Text::new("程序未结束，先等待或复位", "a program is open: wait, or press RESET");
const TOO_LONG: Text = Text::new("录入行太长", "the MDI line is too long");
const NO_LINE: Text = Text::new("先输入一行，再按循环启动", "type a line and press 输入 before cycle start");

impl Controller {
    /// Prepares a line after checking its first block; an empty line discards the prepared one.
    pub(super) fn prepare_mdi(&mut self, line: &str) -> Result<LocalizedText, LocalizedText> {
        let line = line.trim();
        if line.is_empty() {
            self.discard_mdi();
            return Ok(LocalizedText::new("录入行已取消", "the MDI line is taken back"));
        }
        if self.mode != Mode::Mdi {
            return Err(NOT_MDI.into());
        }
        if !matches!(self.phase, ControlPhase::Idle) {
            return Err(OPEN_RUN.into());
        }
        if line.chars().count() > MAX_MDI_CHARS {
            return Err(TOO_LONG.into());
        }
        self.check_mdi(line)?;
        self.edits.mdi_ready = Arc::from(line);
        Ok(LocalizedText::new("按循环启动执行", "press cycle start to execute it"))
    }

    /// Mode change or RESET: a line prepared earlier must not start.
    pub(super) fn discard_mdi(&mut self) {
        if !self.edits.mdi_ready.is_empty() {
            self.edits.mdi_ready = Arc::from("");
        }
    }

    /// Cycle start in mode MDI.
    pub(super) fn start_mdi(&mut self) {
        let line = Arc::clone(&self.edits.mdi_ready);
        if line.is_empty() {
            return self.refuse(NO_LINE);
        }
        self.run_mdi(&line);
        if self.run.is_some() {
            self.discard_mdi();
        }
    }

    /// Checks the first block of the line from the present machine position.
    fn check_mdi(&self, line: &str) -> Result<(), LocalizedText> {
        let source = Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec(), self.kind_row.dialect));
        let settings = NcSettings { needs_block_numbers: false, ..nc_settings(self.kind, &self.params) };
        let modals = self.mdi_modals.unwrap_or_else(|| ModalState::new(&settings));
        let mut frames = self.work_offsets.clone();
        frames.activate(modals.work_offset);
        let mut planned = LookaheadState::new(frames, self.axes.set_point(), self.dressing.points, modals.path_mode);
        planned.oscillating = self.oscillating_axis();
        planned.dialect = self.kind_row.dialect;
        let start = (self.memory.clone(), planned);
        let library = Arc::clone(&self.programs);
        let mut run = ProgramRun::new(source, library, (settings, modals), start, self.now);
        let mut world = RunWorld::new(self, &run.lookahead, true);
        match run.interpreter.next(&mut world, &mut run.block) {
            Ok(NextStatus::Block) => run.queue_block(&self.params).map_err(|forbidden| self.refusal_text(&forbidden)),
            Ok(NextStatus::Drain | NextStatus::Busy | NextStatus::End) => Ok(()),
            Err(fault) => Err(LocalizedText::new(fault.cause(Lang::Zh), fault.cause(Lang::En))),
        }
    }

    /// The active modal codes: of the run as read, of the last MDI line, or the power-on state.
    pub(super) fn modal_view(&self) -> ModalView {
        let settings = nc_settings(self.kind, &self.params);
        if let Some(chosen) = self.restart_modals() {
            return chosen;
        }
        let modals = match (&self.run, &self.mdi_modals) {
            (Some(run), _) => run.block.modals,
            (None, Some(kept)) => *kept,
            (None, None) => ModalState::new(&settings),
        };
        self.modal_view_of(&modals)
    }

    /// Modal codes as the pages show them.
    pub(super) fn modal_view_of(&self, modals: &ModalState) -> ModalView {
        ModalView {
            g: modals.g_codes(self.kind.dialect()),
            feed: modals.feed,
            speed: modals.speed,
            tool: (modals.tool, modals.offset),
            m: modals.m_code,
        }
    }
}
