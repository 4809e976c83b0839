//! One-key retract of the wheel: the key holds the run and executes O9000. Pressed again, it executes O9001, which
//! returns the wheel, and the run can continue.
//!
//! Meanwhile the held run is suspended with the moves it has read. It continues only from the position where it was
//! left: from elsewhere the wheel could touch the part outside the planned path.
//! Source: spec K6.4, K2.2.

use std::sync::Arc;

use super::Program;
use super::activity::Activity;
use super::run::{Origin, ProgramRun};
use crate::controller::axes::AxisOwner;
use crate::controller::plant::{ControlEvent, ControlPhase, Plant, STILL_MOVING};
use crate::defs::kind::Dialect;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::machine::RequestResult;
use crate::nc::{self, BlockLocation, Library, Source};
use crate::units::{Axis, MachinePos, Micros, PerAxis};

/// The programs that retract and return the wheel.
const RETRACT_PROGRAM: u32 = 9_000;
const RETURN_PROGRAM: u32 = 9_001;
/// Position tolerance for continuing the run, mm of slide travel.
const RETURN_TOLERANCE_MM: f64 = 0.001;

/// P4.4=0.
pub const DISABLED: Text = Text::new("一键回退未启用 (P4.4=0)", "the one-key retract is not enabled (P4.4=0)");

/// State of the retract.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RetractStage {
    /// Not retracted.
    #[default]
    AtWork,
    /// The key was pressed in a run: O9000 starts as soon as the axes are at rest.
    Requested,
    /// O9000 runs. Start position (machine, radius mm).
    Retracting(MachinePos),
    /// The wheel is retracted. Start position, and end position of O9000 (machine, radius mm).
    Retracted(MachinePos, MachinePos),
    /// O9001 runs. Target: the start position.
    Returning(MachinePos),
    /// O9001 ended elsewhere. The axes must be jogged to this position.
    OffPosition(MachinePos),
}

/// The retract and the suspended run.
#[derive(Default)]
pub struct Retract {
    stage: RetractStage,
    /// The held run with its block position and its active tool offset and work offset.
    suspended: Option<SuspendedRun>,
}

struct SuspendedRun {
    run: Box<ProgramRun>,
    place: BlockLocation,
    active_offset: usize,
    tool: u32,
    offset: usize,
    /// The local zero (G52): the retract has none.
    local: PerAxis<f64>,
    spindles_before_pause: [bool; 2],
}

/// The texts that call O9000 and O9001; none in a dialect whose blocks cannot call a program by its number.
pub fn retract_calls(dialect: Dialect) -> [Option<Arc<Source>>; 2] {
    [RETRACT_PROGRAM, RETURN_PROGRAM].map(|number| {
        let call = nc::call_text(dialect, number)?;
        Some(Arc::new(Source::new(0, "一键回退", call, dialect)))
    })
}

impl Retract {
    /// Whether the lamp is lit: the wheel is retracted or moving.
    pub fn lamp_on(&self) -> bool {
        self.stage != RetractStage::AtWork
    }

    /// Whether O9000 or O9001 runs or is about to start.
    pub fn is_moving(&self) -> bool {
        matches!(self.stage, RetractStage::Requested | RetractStage::Retracting(_) | RetractStage::Returning(_))
    }

    /// Extends a dwell of the suspended run by a tick.
    pub fn extend_dwell(&mut self, tick: Micros) {
        if let Some(Activity::Dwell { until }) = self.suspended_run().map(|run| &mut run.activity) {
            *until = *until + tick;
        }
    }

    /// The suspended run.
    pub fn suspended_run(&mut self) -> Option<&mut ProgramRun> {
        self.suspended.as_mut().map(|waiting| &mut *waiting.run)
    }
}

impl Program {
    /// Press of the key 一键回退.
    pub fn press_retract(&mut self, plant: &mut Plant) {
        if !plant.params.bit(param::WHEEL_RETRACT) {
            return plant.refuse(DISABLED);
        }
        match self.retract.stage {
            RetractStage::AtWork => {}
            RetractStage::Requested | RetractStage::Retracting(_) | RetractStage::Returning(_) => {
                return plant.refuse(phrase!("一键回退正在执行", "the retract is in progress"));
            }
            RetractStage::Retracted(from, at) => {
                return match position_deviation(plant, at) {
                    None => self.begin_retract(plant, RETURN_PROGRAM, RetractStage::Returning(from)),
                    Some((axis, off)) => plant.refuse(moved_away_text(plant, axis, off)),
                };
            }
            RetractStage::OffPosition(from) => return plant.refuse(off_position_text(plant, from)),
        }
        match plant.execution.phase {
            ControlPhase::Running | ControlPhase::Holding => {
                // The run is held in any case; if O9000 is missing, the wheel stays where it is.
                self.retract.stage = RetractStage::Requested;
                plant.hold_run();
            }
            ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped => self.start_retract(plant),
            ControlPhase::Aborting | ControlPhase::Homing(_) => plant.refuse(STILL_MOVING),
        }
    }

    /// The run has come to rest: starts the retract if it was requested. True: no other motion may start.
    pub fn retract_if_requested(&mut self, plant: &mut Plant) -> bool {
        if self.retract.stage != RetractStage::Requested {
            return false;
        }
        self.retract.stage = RetractStage::AtWork;
        self.start_retract(plant);
        true
    }

    fn start_retract(&mut self, plant: &mut Plant) {
        let from = plant.axes.program_set_point();
        self.begin_retract(plant, RETRACT_PROGRAM, RetractStage::Retracting(from));
    }

    /// Suspends the open run and starts O9000 or O9001.
    fn begin_retract(&mut self, plant: &mut Plant, number: u32, stage: RetractStage) {
        if !plant.axes.all_homed() {
            return plant.refuse(phrase!("先回零，才能一键回退", "home the axes before the retract"));
        }
        if plant.work.programs.find(number).is_none() {
            return plant.refuse(phrase!(
                "程序目录中没有 O{number:04}，不能一键回退",
                "O{number:04} is not in the programs folder: no retract",
                number
            ));
        }
        let Some(source) = self.retract_calls[usize::from(number == RETURN_PROGRAM)].clone() else {
            return plant.refuse(phrase!(
                "该机型的程序不能调用 O{number:04}，不能一键回退",
                "programs on this kind of machine cannot call O{number:04}: no retract",
                number
            ));
        };
        let still =
            plant.allows_manual_motion() && (plant.axes.owner() == AxisOwner::Program || plant.axes.is_at_rest());
        let by_hand = plant.axes.owner() != AxisOwner::Program && plant.jog.is_active();
        if !still || by_hand {
            return plant.refuse(STILL_MOVING);
        }
        if !matches!(plant.request(Request::Jog), RequestResult::Accepted) || !self.detach_from_run(plant) {
            return;
        }
        if let Some(run) = self.run.take() {
            let (place, offsets) = (plant.execution.current_block, &plant.work.offsets);
            let (active, tool, offset, local) = (offsets.active, offsets.tool, offsets.tool_offset, offsets.local);
            let spindles_before_pause = plant.execution.spindles_before_pause;
            let suspended =
                SuspendedRun { run, place, active_offset: active, tool, offset, local, spindles_before_pause };
            self.retract.suspended = Some(suspended);
        }
        // Called as a subprogram: M99 ends it; M30 ends it too, without its machine actions.
        let modals = self.mdi_modals.take();
        self.open_run(plant, source, Origin::Retract);
        self.mdi_modals = modals;
        self.retract.stage = stage;
    }

    /// O9000 or O9001 is over: restores the suspended run in the held state.
    pub fn finish_retract(&mut self, plant: &mut Plant) {
        self.close_run(plant);
        let came = match self.retract.stage {
            RetractStage::Retracting(from) => RetractStage::Retracted(from, plant.axes.program_set_point()),
            RetractStage::Returning(from) if position_deviation(plant, from).is_none() => RetractStage::AtWork,
            RetractStage::Returning(from) => RetractStage::OffPosition(from),
            stage @ (RetractStage::AtWork
            | RetractStage::Requested
            | RetractStage::Retracted(..)
            | RetractStage::OffPosition(_)) => stage,
        };
        self.retract.stage = came;
        let Some(waiting) = self.retract.suspended.take() else {
            if let RetractStage::OffPosition(from) = came {
                plant.refuse(off_position_text(plant, from));
            }
            return plant.transition(ControlEvent::Finish);
        };
        let SuspendedRun { mut run, place, active_offset: active, tool, offset, local, spindles_before_pause } =
            waiting;
        // O9000 and O9001 have used tags since. The spindles recorded before the retract remain valid.
        run.next_tag = run.next_tag.max(plant.axes.planner.finished_tag().map_or(1, |tag| tag + 1));
        // Origins that the retract has set count for the rest of the run.
        let offsets = &plant.work.offsets;
        (run.lookahead.work_offsets.work, run.lookahead.work_offsets.external) = (offsets.work, offsets.external);
        self.run = Some(run);
        plant.work.offsets.local = local;
        plant.execution.current_block = place;
        (plant.work.offsets.active, plant.work.offsets.tool, plant.work.offsets.tool_offset) = (active, tool, offset);
        // Back to the held state.
        plant.transition(ControlEvent::Hold);
        plant.transition(ControlEvent::AtRest);
        plant.execution.spindles_before_pause = spindles_before_pause;
        match came {
            RetractStage::OffPosition(from) => plant.refuse(off_position_text(plant, from)),
            RetractStage::AtWork
            | RetractStage::Requested
            | RetractStage::Retracting(_)
            | RetractStage::Retracted(..)
            | RetractStage::Returning(_) => {}
        }
    }

    /// Why the retract forbids cycle start, if it does.
    #[must_use]
    pub fn retract_start_block(&self, plant: &Plant) -> Option<LocalizedText> {
        match self.retract.stage {
            RetractStage::AtWork | RetractStage::Retracting(_) | RetractStage::Returning(_) => None,
            RetractStage::Requested => Some(phrase!("一键回退正在执行", "the retract is in progress")),
            RetractStage::Retracted(..) => Some(phrase!(
                "砂轮已回退，再按一键回退使其返回",
                "the wheel is retracted: press RETRACT again to bring it back"
            )),
            RetractStage::OffPosition(from) => {
                position_deviation(plant, from).is_some().then(|| off_position_text(plant, from))
            }
        }
    }

    /// The same at a start; a wheel that is back at its place is no longer off it.
    pub fn retract_blocks_start(&mut self, plant: &Plant) -> Option<LocalizedText> {
        let block = self.retract_start_block(plant);
        if block.is_none() && matches!(self.retract.stage, RetractStage::OffPosition(_)) {
            self.retract.stage = RetractStage::AtWork;
        }
        block
    }

    /// RESET or an alarm that ends the run: drops the suspended run.
    pub fn abandon_retract(&mut self, plant: &mut Plant) {
        if let Some(waiting) = self.retract.suspended.take() {
            plant.note_end_of(&waiting.run.interpreter);
            self.clear_run_position(plant);
            self.pool.close(waiting.run);
        }
        self.retract = Retract::default();
    }
}

/// The first axis that is off a position, and by how much, radius mm.
fn position_deviation(plant: &Plant, from: MachinePos) -> Option<(Axis, f64)> {
    let now = plant.axes.program_set_point();
    Axis::ALL.into_iter().map(|axis| (axis, now[axis] - from[axis])).find(|(_, off)| off.abs() > RETURN_TOLERANCE_MM)
}

fn moved_away_text(plant: &Plant, axis: Axis, off: f64) -> LocalizedText {
    let off = off * plant.displayed_per_mm(axis);
    phrase!(
        "{axis} 离开了 O9000 退到的位置 {off:+.3}：先移回，再按一键回退；或复位",
        "{axis} is {off:+.3} off the position where O9000 left it: move it back first, or press RESET",
        axis,
        off
    )
}

fn off_position_text(plant: &Plant, from: MachinePos) -> LocalizedText {
    let (axis, off) = position_deviation(plant, from).unwrap_or((plant.kind.row().wheel_axis, 0.0));
    let off = off * plant.displayed_per_mm(axis);
    phrase!(
        "O9001 没有回到原位：{axis} 差 {off:+.3}，用手轮移回后循环启动，或复位",
        "O9001 did not return to the start: {axis} is {off:+.3} off. Move it back by handwheel, or press RESET",
        axis,
        off
    )
}
