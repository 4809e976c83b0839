//! One-key retract of the wheel: the key holds the run and executes O9000. Pressed again, it executes O9001, which
//! returns the wheel, and the run can continue.
//!
//! Meanwhile the held run is suspended with the moves it has read. It continues only from the position where it was
//! left: from elsewhere the wheel could touch the part outside the planned path.
//! Source: spec K6.4, K2.2.

use std::sync::Arc;

use super::run::{Origin, ProgramRun};
use super::{ControlEvent, ControlPhase, Controller};
use crate::controller::axes::AxisOwner;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::{LocalizedText, Text};
use crate::machine::RequestResult;
use crate::nc::{self, BlockLocation, Library, Source};
use crate::units::{Axis, PerAxis};

/// The programs that retract and return the wheel.
const RETRACT_PROGRAM: u32 = 9_000;
const RETURN_PROGRAM: u32 = 9_001;
/// Position tolerance for continuing the run, mm of slide travel.
const RETURN_TOLERANCE_MM: f64 = 0.001;

/// P4.4=0.
pub(super) const DISABLED: Text = Text::new("一键回退未启用 (P4.4=0)", "the one-key retract is not enabled (P4.4=0)");

/// State of the retract.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum RetractStage {
    /// Not retracted.
    #[default]
    AtWork,
    /// The key was pressed in a run: O9000 starts as soon as the axes are at rest.
    Requested,
    /// O9000 runs. Start position (machine, radius mm).
    Retracting(PerAxis<f64>),
    /// The wheel is retracted. Start position, and end position of O9000 (machine, radius mm).
    Retracted(PerAxis<f64>, PerAxis<f64>),
    /// O9001 runs. Target: the start position.
    Returning(PerAxis<f64>),
    /// O9001 ended elsewhere. The axes must be jogged to this position.
    OffPosition(PerAxis<f64>),
}

/// The retract and the suspended run.
#[derive(Default)]
pub(super) struct Retract {
    stage: RetractStage,
    /// The held run with its block position and its active tool offset and work offset.
    suspended: Option<Box<SuspendedRun>>,
}

struct SuspendedRun {
    run: Box<ProgramRun>,
    place: BlockLocation,
    active_offset: usize,
    tool: u32,
    offset: usize,
}

impl Retract {
    /// Whether the lamp is lit: the wheel is retracted or moving.
    pub(super) fn lamp_on(&self) -> bool {
        self.stage != RetractStage::AtWork
    }

    /// Whether O9000 or O9001 runs or is about to start.
    pub(super) fn is_moving(&self) -> bool {
        matches!(self.stage, RetractStage::Requested | RetractStage::Retracting(_) | RetractStage::Returning(_))
    }

    /// The suspended run.
    pub(super) fn suspended_run(&mut self) -> Option<&mut ProgramRun> {
        self.suspended.as_mut().map(|waiting| &mut *waiting.run)
    }
}

impl Controller {
    /// Press of the key 一键回退.
    pub(super) fn press_retract(&mut self) {
        if !self.params.bit(param::WHEEL_RETRACT) {
            return self.refuse(DISABLED);
        }
        match self.retract.stage {
            RetractStage::AtWork => {}
            RetractStage::Requested | RetractStage::Retracting(_) | RetractStage::Returning(_) => {
                return self.refuse(LocalizedText::new("一键回退正在执行", "the retract is under way"));
            }
            RetractStage::Retracted(from, at) => {
                return match self.position_deviation(at) {
                    None => self.begin_retract(RETURN_PROGRAM, RetractStage::Returning(from)),
                    Some((axis, off)) => self.refuse(self.moved_away_text(axis, off)),
                };
            }
            RetractStage::OffPosition(from) => return self.refuse(self.off_position_text(from)),
        }
        match self.phase {
            ControlPhase::Running | ControlPhase::Holding => {
                // The run is held in any case; if O9000 is missing, the wheel stays where it is.
                self.retract.stage = RetractStage::Requested;
                self.hold_run();
            }
            ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped => self.start_retract(),
            ControlPhase::Aborting | ControlPhase::Homing(_) => {
                self.refuse(LocalizedText::new("轴还在运动，请稍候", "the axes still move"));
            }
        }
    }

    /// The run has come to rest: starts the retract if it was requested. True: no other motion may start.
    pub(super) fn retract_if_requested(&mut self) -> bool {
        if self.retract.stage != RetractStage::Requested {
            return false;
        }
        self.retract.stage = RetractStage::AtWork;
        self.start_retract();
        true
    }

    fn start_retract(&mut self) {
        let from = self.axes.program_set_point();
        self.begin_retract(RETRACT_PROGRAM, RetractStage::Retracting(from));
    }

    /// Suspends the open run and starts O9000 or O9001.
    fn begin_retract(&mut self, number: u32, stage: RetractStage) {
        if !self.axes.all_homed() {
            return self.refuse(LocalizedText::new("先回零，才能一键回退", "home the axes before the retract"));
        }
        if self.programs.find(number).is_none() {
            return self.refuse(LocalizedText::new(
                format!("程序目录中没有 O{number:04}，不能一键回退"),
                format!("the programs folder has no O{number:04}: no retract"),
            ));
        }
        let dialect = self.kind_row.dialect;
        let Some(call) = nc::call_text(dialect, number) else {
            return self.refuse(LocalizedText::new(
                format!("该机型的程序不能调用 O{number:04}，不能一键回退"),
                format!("the programs of this kind cannot call O{number:04}: no retract"),
            ));
        };
        let still = self.allows_manual_motion() && (self.axes.owner() == AxisOwner::Program || self.axes.is_at_rest());
        if !still || !self.no_manual_motion() {
            return self.refuse(LocalizedText::new("轴还在运动，请稍候", "the axes still move"));
        }
        if !matches!(self.request(Request::Jog), RequestResult::Accepted) || !self.detach_from_run() {
            return;
        }
        if let Some(run) = self.run.take() {
            let (place, frames) = (self.current_block, &self.work_offsets);
            let (active, tool, offset) = (frames.active, frames.tool, frames.tool_offset);
            self.retract.suspended = Some(Box::new(SuspendedRun { run, place, active_offset: active, tool, offset }));
        }
        // Called as a subprogram: M99 ends it; M30 ends it too, without its machine actions.
        let source = Arc::new(Source::new(0, "一键回退", call.into_bytes(), dialect));
        let modals = self.mdi_modals.take();
        self.open_run(source, Origin::Retract);
        self.mdi_modals = modals;
        self.retract.stage = stage;
    }

    /// O9000 or O9001 is over: restores the suspended run in the held state.
    pub(super) fn finish_retract(&mut self) {
        self.close_run();
        let came = match self.retract.stage {
            RetractStage::Retracting(from) => RetractStage::Retracted(from, self.axes.program_set_point()),
            RetractStage::Returning(from) if self.position_deviation(from).is_none() => RetractStage::AtWork,
            RetractStage::Returning(from) => RetractStage::OffPosition(from),
            stage @ (RetractStage::AtWork
            | RetractStage::Requested
            | RetractStage::Retracted(..)
            | RetractStage::OffPosition(_)) => stage,
        };
        self.retract.stage = came;
        let Some(waiting) = self.retract.suspended.take() else {
            if let RetractStage::OffPosition(from) = came {
                self.refuse(self.off_position_text(from));
            }
            return self.transition(ControlEvent::Finish);
        };
        let SuspendedRun { mut run, place, active_offset: active, tool, offset } = *waiting;
        // O9000 and O9001 have used tags since. The spindles recorded before the retract remain valid.
        run.next_tag = run.next_tag.max(self.axes.planner.finished_tag().map_or(1, |tag| tag + 1));
        let turned = run.spindles_before_pause;
        self.run = Some(run);
        self.current_block = place;
        (self.work_offsets.active, self.work_offsets.tool, self.work_offsets.tool_offset) = (active, tool, offset);
        // Back to the held state.
        self.transition(ControlEvent::Hold);
        self.transition(ControlEvent::AtRest);
        if let Some(run) = &mut self.run {
            run.spindles_before_pause = turned;
        }
        match came {
            RetractStage::OffPosition(from) => self.refuse(self.off_position_text(from)),
            RetractStage::AtWork
            | RetractStage::Requested
            | RetractStage::Retracting(_)
            | RetractStage::Retracted(..)
            | RetractStage::Returning(_) => {}
        }
    }

    /// Why the retract forbids cycle start, if it does.
    pub(super) fn retract_blocks_start(&mut self) -> Option<LocalizedText> {
        match self.retract.stage {
            RetractStage::AtWork | RetractStage::Retracting(_) | RetractStage::Returning(_) => None,
            RetractStage::Requested => Some(LocalizedText::new("一键回退正在执行", "the retract is under way")),
            RetractStage::Retracted(..) => Some(LocalizedText::new(
                "砂轮已回退，再按一键回退使其返回",
                "the wheel is withdrawn: press 一键回退 again to bring it back",
            )),
            RetractStage::OffPosition(from) if self.position_deviation(from).is_some() => {
                Some(self.off_position_text(from))
            }
            RetractStage::OffPosition(_) => {
                self.retract.stage = RetractStage::AtWork;
                None
            }
        }
    }

    /// The first axis that is off a position, and by how much, radius mm.
    fn position_deviation(&self, from: PerAxis<f64>) -> Option<(Axis, f64)> {
        let now = self.axes.program_set_point();
        Axis::ALL
            .into_iter()
            .map(|axis| (axis, now[axis] - from[axis]))
            .find(|(_, off)| off.abs() > RETURN_TOLERANCE_MM)
    }

    /// RESET or an alarm that ends the run: drops the suspended run.
    pub(super) fn abandon_retract(&mut self) {
        if self.retract.suspended.is_some() {
            self.clear_run_position();
        }
        self.retract = Retract::default();
    }

    /// Whether no manual motion or withdrawal is in progress.
    fn no_manual_motion(&self) -> bool {
        self.axes.owner() == AxisOwner::Program || !self.jog.is_active()
    }

    fn moved_away_text(&self, axis: Axis, off: f64) -> LocalizedText {
        let off = off * self.displayed_per_mm(axis);
        LocalizedText::new(
            format!("{axis} 离开了 O9000 退到的位置 {off:+.3}：先移回，再按一键回退；或复位"),
            format!(
                "{axis} is {off:+.3} off the place that O9000 left it at: bring it back there first, or press RESET"
            ),
        )
    }

    fn off_position_text(&self, from: PerAxis<f64>) -> LocalizedText {
        let (axis, off) = self.position_deviation(from).unwrap_or((self.kind_row.wheel_axis, 0.0));
        let off = off * self.displayed_per_mm(axis);
        LocalizedText::new(
            format!("O9001 没有回到原位：{axis} 差 {off:+.3}，用手轮移回后循环启动，或复位"),
            format!("O9001 ended elsewhere: {axis} is {off:+.3} off. Bring it back by handwheel, or press RESET"),
        )
    }
}
