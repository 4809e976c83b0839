//! One-key retract of the wheel: the key holds the run and executes O9000; pressed again, O9001 brings the wheel back and
//! the run can go on.
//!
//! The held run is put aside meanwhile, with the moves it had read. It goes on only from where it was left: a wheel that
//! O9001 has brought elsewhere would meet the part where nothing was planned.
//! Source: spec K6.4, K2.2.

use std::sync::Arc;

use super::run::{Origin, Run};
use super::{Controller, Event, Phase};
use crate::controller::axes::Owner;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::{Said, Text};
use crate::machine::Answer;
use crate::nc::{Library, Place, Source};
use crate::units::{Axis, PerAxis};

/// The program that withdraws the wheel, and the one that brings it back.
const WITHDRAW: u32 = 9_000;
const BRING_BACK: u32 = 9_001;
/// How near an axis must be to where the run was left, mm of slide travel.
const BACK_MM: f64 = 0.001;

/// P4.4=0.
pub(super) const DISABLED: Text = Text::new("一键回退未启用 (P4.4=0)", "the one-key retract is not enabled (P4.4=0)");

/// Where the retract stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Stage {
    /// The wheel is where the work has it.
    #[default]
    Home,
    /// The key was pressed in a run: as soon as the axes stand, O9000 begins.
    Asked,
    /// O9000 runs; the wheel came from here (machine frame, radius mm).
    Leaving(PerAxis<f64>),
    /// The wheel is withdrawn: it came from here, and O9000 has left it there.
    Away(PerAxis<f64>, PerAxis<f64>),
    /// O9001 runs.
    Coming(PerAxis<f64>),
    /// O9001 has ended elsewhere. The hand must bring the axes there.
    Astray(PerAxis<f64>),
}

/// The retract and the run that waits for it.
#[derive(Default)]
pub(super) struct Retract {
    stage: Stage,
    /// The run that was held, with its place and the tool offset and frame in force.
    waiting: Option<Box<Waiting>>,
}

struct Waiting {
    run: Box<Run>,
    place: Place,
    active: usize,
    tool: u32,
    offset: usize,
}

impl Retract {
    /// The lamp: the wheel is away, or on its way.
    pub(super) fn is_lit(&self) -> bool {
        self.stage != Stage::Home
    }

    /// One of the two programs runs, or is about to.
    pub(super) fn is_working(&self) -> bool {
        matches!(self.stage, Stage::Asked | Stage::Leaving(_) | Stage::Coming(_))
    }

    /// The run that was put aside.
    pub(super) fn waiting_run(&mut self) -> Option<&mut Run> {
        self.waiting.as_mut().map(|waiting| &mut *waiting.run)
    }
}

impl Controller {
    /// The key.
    pub(super) fn press_retract(&mut self) {
        if !self.params.bit(param::WHEEL_RETRACT) {
            return self.refuse(DISABLED);
        }
        match self.retract.stage {
            Stage::Home => {}
            Stage::Asked | Stage::Leaving(_) | Stage::Coming(_) => {
                return self.refuse(Said::new("一键回退正在执行", "the retract is under way"));
            }
            Stage::Away(from, at) => {
                return match self.off(at) {
                    None => self.begin_retract(BRING_BACK, Stage::Coming(from)),
                    Some((axis, off)) => self.refuse(self.moved_away(axis, off)),
                };
            }
            Stage::Astray(from) => return self.refuse(self.astray(from)),
        }
        match self.phase {
            Phase::Running | Phase::Holding => {
                // The run stops in any case; without its program the wheel stays where it is.
                self.retract.stage = Stage::Asked;
                self.hold_run();
            }
            Phase::Idle | Phase::Held | Phase::Stopped => self.withdraw(),
            Phase::Aborting | Phase::Homing(_) => {
                self.refuse(Said::new("轴还在运动，请稍候", "the axes still move"));
            }
        }
    }

    /// The run has come to rest: the wheel is withdrawn if that is why. True: nothing else is to move the axes.
    pub(super) fn withdraw_if_asked(&mut self) -> bool {
        if self.retract.stage != Stage::Asked {
            return false;
        }
        self.retract.stage = Stage::Home;
        self.withdraw();
        true
    }

    fn withdraw(&mut self) {
        let from = self.axes.program_set();
        self.begin_retract(WITHDRAW, Stage::Leaving(from));
    }

    /// Puts the open run aside and starts one of the two programs.
    fn begin_retract(&mut self, number: u32, stage: Stage) {
        if !self.axes.all_homed() {
            return self.refuse(Said::new("先回零，才能一键回退", "home the axes before the retract"));
        }
        if self.programs.find(number).is_none() {
            return self.refuse(Said::new(
                format!("程序目录中没有 O{number:04}，不能一键回退"),
                format!("the programs folder has no O{number:04}: no retract"),
            ));
        }
        let still = self.is_free_for_hand() && (self.axes.owner() == Owner::Path || self.axes.is_at_rest());
        if !still || !self.is_at_rest_by_hand() {
            return self.refuse(Said::new("轴还在运动，请稍候", "the axes still move"));
        }
        if !matches!(self.ask(Request::MoveByHand), Answer::Taken) || !self.part_from_run() {
            return;
        }
        if let Some(run) = self.run.take() {
            let (place, frames) = (self.place, &self.frames);
            let (active, tool, offset) = (frames.active, frames.tool, frames.offset);
            self.retract.waiting = Some(Box::new(Waiting { run, place, active, tool, offset }));
        }
        // Called as a subprogram: M99 ends it, and so does M30 without its effects.
        let source = Arc::new(Source::new(0, "一键回退", format!("M98 P{number}").into_bytes()));
        let modals = self.mdi_modals.take();
        self.open_run(source, Origin::Retract);
        self.mdi_modals = modals;
        self.retract.stage = stage;
    }

    /// One of the two programs is over: the run that waits comes back, held.
    pub(super) fn finish_retract(&mut self) {
        self.close_run();
        let came = match self.retract.stage {
            Stage::Leaving(from) => Stage::Away(from, self.axes.program_set()),
            Stage::Coming(from) if self.off(from).is_none() => Stage::Home,
            Stage::Coming(from) => Stage::Astray(from),
            stage @ (Stage::Home | Stage::Asked | Stage::Away(..) | Stage::Astray(_)) => stage,
        };
        self.retract.stage = came;
        let Some(waiting) = self.retract.waiting.take() else {
            if let Stage::Astray(from) = came {
                self.refuse(self.astray(from));
            }
            return self.happen(Event::Finish);
        };
        let Waiting { mut run, place, active, tool, offset } = *waiting;
        // The planner has finished O9000 and O9001 since; what turned in the pause is remembered from before.
        run.next_tag = run.next_tag.max(self.axes.path.finished_tag().map_or(1, |tag| tag + 1));
        let turned = run.turned;
        self.run = Some(run);
        self.place = place;
        (self.frames.active, self.frames.tool, self.frames.offset) = (active, tool, offset);
        // Held, as the key had left it.
        self.happen(Event::Hold);
        self.happen(Event::AtRest);
        if let Some(run) = &mut self.run {
            run.turned = turned;
        }
        match came {
            Stage::Astray(from) => self.refuse(self.astray(from)),
            Stage::Home | Stage::Asked | Stage::Leaving(_) | Stage::Away(..) | Stage::Coming(_) => {}
        }
    }

    /// Why cycle start must wait for the wheel, if it must.
    pub(super) fn retract_forbids_start(&mut self) -> Option<Said> {
        match self.retract.stage {
            Stage::Home | Stage::Leaving(_) | Stage::Coming(_) => None,
            Stage::Asked => Some(Said::new("一键回退正在执行", "the retract is under way")),
            Stage::Away(..) => Some(Said::new(
                "砂轮已回退，再按一键回退使其返回",
                "the wheel is withdrawn: press 一键回退 again to bring it back",
            )),
            Stage::Astray(from) if self.off(from).is_some() => Some(self.astray(from)),
            Stage::Astray(_) => {
                self.retract.stage = Stage::Home;
                None
            }
        }
    }

    /// The first axis that is not where the run was left, and how far, radius mm.
    fn off(&self, from: PerAxis<f64>) -> Option<(Axis, f64)> {
        let now = self.axes.program_set();
        Axis::ALL.into_iter().map(|axis| (axis, now[axis] - from[axis])).find(|(_, off)| off.abs() > BACK_MM)
    }

    /// RESET, or an alarm that ends the run.
    pub(super) fn drop_retract(&mut self) {
        if self.retract.waiting.is_some() {
            self.forget_place();
        }
        self.retract = Retract::default();
    }

    /// Nothing that the hand or a hold has begun is under way.
    fn is_at_rest_by_hand(&self) -> bool {
        self.axes.owner() == Owner::Path || !self.hand.is_leading()
    }

    fn moved_away(&self, axis: Axis, off: f64) -> Said {
        let off = off * self.displayed_per_mm(axis);
        Said::new(
            format!("{axis} 离开了 O9000 退到的位置 {off:+.3}：先移回，再按一键回退；或复位"),
            format!(
                "{axis} is {off:+.3} off the place that O9000 left it at: bring it back there first, or press RESET"
            ),
        )
    }

    fn astray(&self, from: PerAxis<f64>) -> Said {
        let (axis, off) = self.off(from).unwrap_or((self.row.slow_axis, 0.0));
        let off = off * self.displayed_per_mm(axis);
        Said::new(
            format!("O9001 没有回到原位：{axis} 差 {off:+.3}，用手轮移回后循环启动，或复位"),
            format!("O9001 ended elsewhere: {axis} is {off:+.3} off. Bring it back by handwheel, or press RESET"),
        )
    }
}
