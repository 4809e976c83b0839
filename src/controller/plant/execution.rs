//! Execution: the phase of the control and the place in the program, with the reactions that stop motion.
//! Source: spec B5, table "what stops what".

use super::Plant;
use super::phase_clock::PhaseClock;
use crate::controller::axes::homing::AxisHoming;
use crate::controller::storage_request::StorageRequest;
use crate::defs::mcode::Request;
use crate::defs::signal::Output;
use crate::defs::text::LocalizedText;
use crate::defs::{alarm, param};
use crate::link::cycle_times::CycleTimes;
use crate::link::part_result::OffsetInForce;
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
    /// A gauge has ended an infeed by its signal.
    pub gauged: bool,
    /// The tool offset that it has worked with; none without or with several.
    pub offset: Option<OffsetInForce>,
    /// Parts that it has counted.
    pub counted: u32,
}

/// The tool offsets that a run has called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CalledOffsets {
    /// None.
    #[default]
    None,
    /// This one, 1 to 16.
    One(usize),
    /// Different ones: nobody knows which one has made the size.
    Several,
}

impl CalledOffsets {
    /// The run calls an offset; 0 cancels the one in force.
    pub fn call(&mut self, number: usize) {
        *self = match *self {
            known if number == 0 => known,
            Self::None => Self::One(number),
            Self::One(known) if known == number => Self::One(known),
            Self::One(_) | Self::Several => Self::Several,
        };
    }
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
    /// Programs run for the time of one pass: neither P390 nor M99 repeats them.
    pub runs_once: bool,
    /// Durations of the last run.
    pub last_times: CycleTimes,
    /// The grinding phase of the open run.
    pub phases: PhaseClock,
    /// A gauge has ended an infeed of the run by its signal.
    pub gauged: bool,
    /// The skip signal that the run awaits in this tick: touch probes wired to it are armed. 0 for none.
    pub awaited_signal: u8,
    /// Ticks since a touch probe has latched without the signal that is awaited.
    pub latch_ticks: u32,
    /// The tool offsets of the run.
    pub called_offsets: CalledOffsets,
    /// M30 has ended the open program: its part is finished.
    pub part_finished: bool,
    /// The last run of a program has come to its end.
    pub is_completed: bool,
    /// The cycle that has finished a part; none from the next cycle start by the operator on.
    pub finished_cycle: Option<FinishedCycle>,
    /// Parts that the open run has counted.
    pub parts_counted: u32,
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
    /// A run begins, with the tool offset that is in force.
    pub fn begin_cycle(&mut self, tool_offset: usize) {
        self.phases.restart();
        (self.gauged, self.parts_counted, self.is_completed) = (false, 0, false);
        self.called_offsets = CalledOffsets::None;
        self.called_offsets.call(tool_offset);
        self.current_block = BlockLocation::default();
    }

    /// Enters a block. One without N belongs to the last one with N in its program.
    pub fn enter_block(&mut self, place: BlockLocation) {
        let inherited = self.current_block.n.filter(|_| self.current_block.program == place.program);
        self.current_block = BlockLocation { n: place.n.or(inherited), ..place };
    }
}

impl Plant {
    /// A run is over. If M30 has ended a program its part is finished.
    pub fn end_cycle(&mut self, duration: Micros) {
        let times = self.execution.phases.times(duration, self.now);
        self.execution.last_times = times;
        self.execution.phases.restart();
        if !std::mem::take(&mut self.execution.part_finished) {
            return;
        }
        let in_force = self.work.offsets.tool_offset;
        let offset = (self.execution.called_offsets == CalledOffsets::One(in_force)).then(|| {
            let axis = self.kind.row().wheel_axis;
            let (displayed_per_mm, work_zero) =
                (self.displayed_per_mm(axis), self.work.offsets.machine_minus_work(axis));
            OffsetInForce { number: in_force, axis, displayed_per_mm, work_zero }
        });
        let (number, program, gauged) = (self.work.part_count, self.execution.current_program, self.execution.gauged);
        let counted = std::mem::take(&mut self.execution.parts_counted);
        self.execution.finished_cycle =
            Some(FinishedCycle { number, program, ended_at: self.now, times, gauged, offset, counted });
    }

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
        (self.execution.current_program, self.execution.is_completed) = (number, false);
        self.execution.current_block = BlockLocation::default();
        self.store(StorageRequest::CurrentProgram(number));
    }

    /// A run is closed: the screen shows no block of a subprogram or of MDI as the current one.
    pub fn leave_subprogram(&mut self) {
        if self.execution.current_block.program != self.execution.current_program {
            self.execution.current_block = BlockLocation::default();
        }
    }

    /// Axes that stand and are not in position: an alarm once that takes too long.
    pub fn await_in_position(&mut self, since: Micros) {
        if self.now.since(since) > self.params.millis(param::IN_POSITION_TIMEOUT) {
            self.raise(alarm::IN_POSITION_TIMEOUT, None);
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
