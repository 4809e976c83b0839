//! Reads the chosen program up to its first action while nothing runs, again and again: does it accept its values?
//!
//! A program checks its values at its head and refuses wrong ones by `#3000`. The check finds that before cycle start.
//! It executes nothing; the first block that would act ends it.
//! Source: spec B3, B8, K7.4.

use std::sync::Arc;

use super::lookahead_state::LookaheadState;
use super::run::{ProgramRun, RunPool, RunStart};
use super::run_world::RunWorld;
use crate::controller::plant::Plant;
use crate::controller::plant::system_variables::nc_settings;
use crate::defs::text::LocalizedText;
use crate::nc::interpreter::BLOCK_WORK;
use crate::nc::{self, ModalState, NextStatus, Op, OpEffect, ProgramMessage};
use crate::units::{Micros, PerAxis};

/// Time between two checks: a value that is typed is checked before the operator looks up.
const INTERVAL: Micros = Micros::from_millis(200);
/// Work of a tick, and of a whole check: so many blocks. More is not a check of values.
const WORK_PER_TICK: usize = 10 * BLOCK_WORK;
const MAX_WORK: usize = 2_000 * BLOCK_WORK;

/// What the program says of its values.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum StartVerdict {
    /// It has not been read yet.
    #[default]
    Unknown,
    /// It comes to its first action.
    Accepted,
    /// It refuses a value: text, and the variable that is wrong.
    RefusesValue(LocalizedText, Option<u16>),
    /// It has a mistake.
    Faulty(LocalizedText),
}

/// The check in progress and its last result.
#[derive(Default)]
pub struct StartCheck {
    run: Option<Box<ProgramRun>>,
    /// Work of the check in progress.
    spent: usize,
    next_at: Micros,
    /// The program that the verdict is about.
    program: u32,
    verdict: StartVerdict,
}

impl StartCheck {
    /// What a program says of its values.
    #[must_use]
    pub fn verdict_of(&self, program: u32) -> &StartVerdict {
        if self.program == program { &self.verdict } else { &StartVerdict::Unknown }
    }

    /// The programs are replaced: the verdict on the old text is void.
    pub fn forget(&mut self, pool: &mut RunPool) {
        self.abandon(pool);
        (self.verdict, self.next_at) = (StartVerdict::Unknown, Micros::ZERO);
    }

    /// Ends the check in progress: a run begins.
    pub fn abandon(&mut self, pool: &mut RunPool) {
        if let Some(run) = self.run.take() {
            pool.close(run);
        }
    }

    /// One tick while nothing runs.
    pub fn step(&mut self, pool: &mut RunPool, plant: &mut Plant) {
        let number = plant.execution.current_program;
        if self.program != number {
            self.abandon(pool);
            (self.program, self.verdict, self.next_at) = (number, StartVerdict::Unknown, plant.now);
        }
        if self.run.is_none() && (plant.now < self.next_at || !self.begin(pool, plant)) {
            return;
        }
        let Some(run) = &mut self.run else { return };
        let mut budget = plant.reading_budget().share(WORK_PER_TICK);
        let mut found = None;
        while found.is_none() && !budget.is_spent() {
            let mut world = RunWorld::new(plant, &run.lookahead, true);
            found = match run.interpreter.next_within(&mut world, &mut run.block, &mut budget) {
                Ok(NextStatus::Block) => verdict_of_block(run, plant),
                Ok(NextStatus::Busy) => None,
                Ok(NextStatus::Drain | NextStatus::Waiting | NextStatus::End) => Some(StartVerdict::Accepted),
                Err(fault) => Some(StartVerdict::Faulty(fault.phrase())),
            };
        }
        plant.charge_reading(budget);
        self.spent += budget.spent();
        if self.spent > MAX_WORK {
            found = found.or(Some(StartVerdict::Accepted));
        }
        if let Some(verdict) = found {
            self.verdict = verdict;
            self.next_at = plant.now + INTERVAL;
            self.abandon(pool);
        }
    }

    /// Begins at the head of the current program; false if there is none to read.
    fn begin(&mut self, pool: &mut RunPool, plant: &Plant) -> bool {
        let settings = nc_settings(plant.kind, &plant.params);
        let Some(program) = plant.work.programs.get(self.program) else { return false };
        // A program that begins where the machine stands, without variables, has no values to check.
        if settings.start_is_work_zero {
            self.verdict = StartVerdict::Accepted;
            return false;
        }
        let settings = nc::NcSettings { axes: plant.axes.fitted(), ..settings };
        let modals = ModalState::new(&settings);
        let mut offsets = plant.work.offsets.clone();
        offsets.activate(modals.work_offset);
        // As at a start: without a local zero (G52).
        offsets.local = PerAxis::default();
        let mut lookahead =
            LookaheadState::new(offsets, plant.axes.set_point(), plant.work.dress_points, modals.path_mode);
        lookahead.soft_limits_active = plant.axes.all_homed();
        // Homing is a condition of its own.
        lookahead.homed = true;
        lookahead.dialect = plant.kind.row().dialect;
        let program: (_, nc::SharedLibrary) = (Arc::clone(&program.source), Arc::clone(&plant.work.programs) as _);
        let memory = &plant.work.variables;
        let start = RunStart { program, settings, modals, memory, lookahead, preflight: None };
        (self.run, self.spent) = (Some(pool.open(start, plant.now)), 0);
        true
    }
}

/// What the block just read says; none: read on.
fn verdict_of_block(run: &mut ProgramRun, plant: &Plant) -> Option<StartVerdict> {
    let refused = run.block.ops.iter().find_map(|op| match op.effect() {
        OpEffect::Message(ProgramMessage::Alarm(number, text)) => {
            Some((number as u16, LocalizedText::of_program(text)))
        }
        _ => None,
    });
    if let Some((number, text)) = refused {
        let (text, variable) = plant.program_alarm_words(number, &text, run.block.location.program);
        return Some(StartVerdict::RefusesValue(text, variable));
    }
    let acts = run.block.ops.iter().any(acts);
    let queued = run.queue_block(&plant.params);
    run.queue.clear();
    match queued {
        Err(forbidden) => Some(StartVerdict::Faulty(forbidden.text(&plant.params))),
        Ok(()) => acts.then_some(StartVerdict::Accepted),
    }
}

/// Whether an operation acts on the machine or asks it, so that what follows depends on it.
fn acts(op: &Op) -> bool {
    match op.effect() {
        OpEffect::Variable(..) | OpEffect::Coordinates(_) | OpEffect::PathMode(_) => false,
        OpEffect::Speed(..) | OpEffect::SpeedLimit(_) | OpEffect::Message(ProgramMessage::Show(_)) => false,
        OpEffect::Motion(_) | OpEffect::MCode(_) | OpEffect::Dwell(_) | OpEffect::Oscillation(_) => true,
        OpEffect::IndexTurret { .. } | OpEffect::SystemVariable(..) | OpEffect::Message(_) => true,
    }
}
