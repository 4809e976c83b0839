//! MDI: the page prepares a line and cycle start executes it, so that no page starts a motion.
//! Source: spec B5, B6.

use std::sync::Arc;

use super::commands::MDI_MOST;
use super::planned::Planned;
use super::run::Run;
use super::system::{RunWorld, nc_settings};
use super::{Controller, Phase};
use crate::defs::key::Mode;
use crate::defs::text::{Lang, Said, Text};
use crate::link::edit::ModalView;
use crate::nc::{Modals, Next, Settings, Source};

const NOT_MDI: Text = Text::new("录入方式下才能执行：先按 录入 键", "MDI lines work in mode MDI: press that key first");
const OPEN_RUN: Text = Text::new("程序未结束，先等待或复位", "a program is open: wait, or press RESET");
const TOO_LONG: Text = Text::new("录入行太长", "the MDI line is too long");
const NO_LINE: Text = Text::new("先输入一行，再按循环启动", "type a line and press 输入 before cycle start");

impl Controller {
    /// Prepares a line after checking its first block; an empty line discards the prepared one.
    pub(super) fn ready_mdi(&mut self, line: &str) -> Result<Said, Said> {
        let line = line.trim();
        if line.is_empty() {
            self.drop_mdi();
            return Ok(Said::new("录入行已取消", "the MDI line is taken back"));
        }
        if self.mode != Mode::Mdi {
            return Err(NOT_MDI.into());
        }
        if !matches!(self.phase, Phase::Idle) {
            return Err(OPEN_RUN.into());
        }
        if line.chars().count() > MDI_MOST {
            return Err(TOO_LONG.into());
        }
        self.check_mdi(line)?;
        self.edits.mdi_ready = Arc::from(line);
        Ok(Said::new("按循环启动执行", "press cycle start to execute it"))
    }

    /// Mode change or RESET: a line prepared earlier must not start.
    pub(super) fn drop_mdi(&mut self) {
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
        self.mdi(&line);
        if self.run.is_some() {
            self.drop_mdi();
        }
    }

    /// Checks the first block of the line from the present machine position.
    fn check_mdi(&self, line: &str) -> Result<(), Said> {
        let source = Arc::new(Source::new(0, "MDI", line.as_bytes().to_vec()));
        let settings = Settings { numbered: false, ..nc_settings(self.kind, &self.params) };
        let modals = self.mdi_modals.unwrap_or_else(|| Modals::new(&settings));
        let mut frames = self.frames.clone();
        frames.activate(modals.frame);
        let mut planned = Planned::new(frames, self.axes.set(), self.dress.points, modals.path);
        planned.oscillating = self.oscillating_axis();
        planned.system = self.row.system;
        let start = (self.memory.clone(), planned);
        let library = Arc::clone(&self.programs);
        let mut run = Run::new(source, library, (settings, modals), start, self.now);
        let mut world = RunWorld::new(self, &run.planned, true);
        match run.interpreter.next(&mut world, &mut run.block) {
            Ok(Next::Block) => run.take_block(&self.params).map_err(|forbidden| self.forbidden(&forbidden)),
            Ok(Next::Drain | Next::Busy | Next::End) => Ok(()),
            Err(fault) => Err(Said::new(fault.cause(Lang::Zh), fault.cause(Lang::En))),
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
            (None, None) => Modals::new(&settings),
        };
        self.view_of(&modals)
    }

    /// Modal codes as the pages show them.
    pub(super) fn view_of(&self, modals: &Modals) -> ModalView {
        ModalView {
            g: modals.g_codes(self.kind.system()),
            feed: modals.feed,
            speed: modals.speed,
            tool: (modals.tool, modals.offset),
            m: modals.m,
        }
    }
}
