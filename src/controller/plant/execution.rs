//! Execution: the phase of the control and the place in the program, with the reactions that stop motion.
//! Source: spec B5, table "what stops what".

use super::Plant;
use super::phase_clock::PhaseClock;
use crate::controller::axes::homing::AxisHoming;
use crate::controller::storage_request::StorageRequest;
use crate::defs::mcode::Request;
use crate::defs::signal::Output;
use crate::defs::text::LocalizedText;
use crate::link::cycle_times::CycleTimes;
use crate::machine::phase;
use crate::nc::BlockLocation;
use crate::units::{Micros, PerAxis};

/// Homing in progress: the present axis and the axes still to home.
#[derive(Clone, Debug)]
pub struct Homing {
    /// The axis that homes now.
    pub current: AxisHoming,
    /// The axes still to home.
    pub queued: PerAxis<bool>,
}

/// The control phase.
pub type ControlPhase = phase::RunPhase<Homing>;
/// An event that may change the phase.
pub type ControlEvent = phase::PhaseEvent<Homing>;

/// A cycle that has finished a part.
#[derive(Clone, Copy, Debug)]
pub struct FinishedCycle {
    /// The part count.
    pub number: u32,
    /// The program.
    pub program: u32,
    /// When it ended.
    pub ended_at: Micros,
    /// How long it and its phases took.
    pub times: CycleTimes,
}

/// What is executed: phase, program, block.
#[derive(Clone, Debug, Default)]
pub struct Execution {
    /// The control phase.
    pub phase: ControlPhase,
    /// Number of the current program; 0 for none.
    pub current_program: u32,
    /// The present block.
    pub current_block: BlockLocation,
    /// Blocks executed since power-on.
    pub block_count: u64,
    /// Remaining automatic repetitions of the program (P390).
    pub repeats_left: u32,
    /// Durations of the last run.
    pub last_times: CycleTimes,
    /// The grinding phase of the open run.
    pub phases: PhaseClock,
    /// A gauge has ended an infeed of the run by its signal.
    pub gauged: bool,
    /// M30 has ended the open program: its part is finished.
    pub part_finished: bool,
    /// The cycle that has finished a part; none from the next cycle start by the operator on.
    pub finished_cycle: Option<FinishedCycle>,
    /// Running when the run was paused: wheel, and workpiece drive (headstock, table, roll) or main spindle.
    pub spindles_before_pause: [bool; 2],
    /// What a stop of the program waits for (M00, M01, #3006); none after a single block.
    pub stop_reason: Option<LocalizedText>,
    /// The program repeats a loop that changes nothing and asks the machine nothing: only the operator can end it.
    pub is_endless: bool,
    /// RESET or emergency stop is among the commands of this tick: nothing starts in it.
    pub starts_void: bool,
}

impl Execution {
    /// A run is over. If M30 has ended a program its part is finished.
    pub fn end_cycle(&mut self, ended_at: Micros, duration: Micros, number: u32) {
        let times = self.phases.times(duration, ended_at);
        self.last_times = times;
        self.phases.restart();
        if std::mem::take(&mut self.part_finished) {
            self.finished_cycle = Some(FinishedCycle { number, program: self.current_program, ended_at, times });
        }
    }
}

impl Plant {
    /// Applies an event to the phase; the phase changes only here (homing updates its own state in place).
    pub fn transition(&mut self, event: ControlEvent) {
        let before = self.execution.phase.is_pause();
        self.execution.phase = std::mem::take(&mut self.execution.phase).after(event);
        if !self.execution.phase.is_pause() {
            self.execution.stop_reason = None;
        }
        if self.execution.phase.is_pause() && !before {
            self.execution.spindles_before_pause = self.running_spindles();
        }
    }

    /// Makes a program the current one, before its first block, and stores its number; 0 for none.
    pub fn set_current_program(&mut self, number: u32) {
        self.execution.current_program = number;
        self.execution.current_block = BlockLocation::default();
        self.store(StorageRequest::CurrentProgram(number));
    }

    /// A run is closed: the screen shows no block of a subprogram or of MDI as the current one.
    pub fn leave_subprogram(&mut self) {
        if self.execution.current_block.program != self.execution.current_program {
            self.execution.current_block = BlockLocation::default();
        }
    }

    /// Brakes all motion; the run ends once the axes are at rest.
    pub fn abort_run(&mut self) {
        self.jog.stop_all();
        self.execution.repeats_left = 0;
        if matches!(self.execution.phase, ControlPhase::Aborting)
            || matches!(self.execution.phase, ControlPhase::Idle) && self.has_braked()
        {
            return;
        }
        self.axes.brake();
        self.transition(ControlEvent::Abort);
    }

    /// Whether jog, handwheel, homing or an oscillation that is not of an open run moves an axis.
    pub fn is_moved_by_hand(&self) -> bool {
        self.jog.is_active() || self.execution.phase.is_homing() || self.oscillates_outside_run()
    }

    fn oscillates_outside_run(&self) -> bool {
        self.is_oscillating() && (self.oscillates_by_key() || !self.execution.phase.is_run_open())
    }

    /// Brakes what moves by hand. An open run stays.
    pub fn stop_manual_motion(&mut self) {
        if self.oscillates_outside_run() {
            self.stop_oscillation();
            if self.machine.cylinder_is_on() {
                self.request(Request::CylinderOff);
            }
        }
        if self.execution.phase.is_run_open() {
            self.jog.stop_all();
        } else {
            self.abort_run();
        }
    }

    /// Feed hold: holds a running program; nothing else is affected.
    pub fn hold_run(&mut self) {
        if self.axes.homing.is_some() {
            return self.abort_run(); // homing cannot be held
        }
        if matches!(self.execution.phase, ControlPhase::Running) {
            self.axes.planner.hold();
            self.transition(ControlEvent::Hold);
        }
    }

    /// Whether a program stops at the end of each block: single block is on and #3003 does not disable it.
    pub const fn stops_after_blocks(&self) -> bool {
        self.operator.switches.single_block && self.work.program_controls.single_block & 1 == 0
    }

    /// Whether manual motion is allowed: nothing runs, or the run is held or stopped.
    pub const fn allows_manual_motion(&self) -> bool {
        matches!(self.execution.phase, ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped)
    }

    /// Whether wheel and workpiece drive or main spindle run.
    pub fn running_spindles(&self) -> [bool; 2] {
        let part = self.machine.drive_is_on() || self.machine.spindle_direction().is_some();
        [self.outputs.on.has(Output::Wheel), part]
    }
}
