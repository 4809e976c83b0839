//! One-key retract of the wheel: the key holds the run and executes O9000. Pressed again, it executes O9001, which
//! returns the wheel, and the run can continue.
//!
//! Meanwhile the held run is suspended with the moves it has read. It continues only from the position where it was
//! left: from elsewhere the wheel could touch the part outside the planned path.
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

/// The programs that retract and return the wheel.
const WITHDRAW: u32 = 9_000;
const BRING_BACK: u32 = 9_001;
/// Position tolerance for continuing the run, mm of slide travel.
const BACK_MM: f64 = 0.001;

/// P4.4=0.
pub(super) const DISABLED: Text = Text::new("一键回退未启用 (P4.4=0)", "the one-key retract is not enabled (P4.4=0)");

/// State of the retract.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Stage {
    /// Not retracted.
    #[default]
    Home,
    /// The key was pressed in a run: O9000 starts as soon as the axes are at rest.
    Asked,
    /// O9000 runs. Start position (machine, radius mm).
    Leaving(PerAxis<f64>),
    /// The wheel is retracted. Start position, and end position of O9000 (machine, radius mm).
    Away(PerAxis<f64>, PerAxis<f64>),
    /// O9001 runs. Target: the start position.
    Coming(PerAxis<f64>),
    /// O9001 ended elsewhere. The axes must be jogged to this position.
    Astray(PerAxis<f64>),
}

/// The retract and the suspended run.
#[derive(Default)]
pub(super) struct Retract {
    stage: Stage,
    /// The held run with its block position and its active tool offset and work offset.
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
    /// Whether the lamp is lit: the wheel is retracted or moving.
    pub(super) fn is_lit(&self) -> bool {
        self.stage != Stage::Home
    }

    /// Whether O9000 or O9001 runs or is about to start.
    pub(super) fn is_working(&self) -> bool {
        matches!(self.stage, Stage::Asked | Stage::Leaving(_) | Stage::Coming(_))
    }

    /// The suspended run.
    pub(super) fn waiting_run(&mut self) -> Option<&mut Run> {
        self.waiting.as_mut().map(|waiting| &mut *waiting.run)
    }
}

impl Controller {
    /// Press of the key 一键回退.
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
                // The run is held in any case; if O9000 is missing, the wheel stays where it is.
                self.retract.stage = Stage::Asked;
                self.hold_run();
            }
            Phase::Idle | Phase::Held | Phase::Stopped => self.withdraw(),
            Phase::Aborting | Phase::Homing(_) => {
                self.refuse(Said::new("轴还在运动，请稍候", "the axes still move"));
            }
        }
    }

    /// The run has come to rest: starts the retract if it was requested. True: no other motion may start.
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

    /// Suspends the open run and starts O9000 or O9001.
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
        // Called as a subprogram: M99 ends it; M30 ends it too, without its machine actions.
        let source = Arc::new(Source::new(0, "一键回退", format!("M98 P{number}").into_bytes()));
        let modals = self.mdi_modals.take();
        self.open_run(source, Origin::Retract);
        self.mdi_modals = modals;
        self.retract.stage = stage;
    }

    /// O9000 or O9001 is over: restores the suspended run in the held state.
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
        // O9000 and O9001 have used tags since. The spindles recorded before the retract remain valid.
        run.next_tag = run.next_tag.max(self.axes.path.finished_tag().map_or(1, |tag| tag + 1));
        let turned = run.turned;
        self.run = Some(run);
        self.place = place;
        (self.frames.active, self.frames.tool, self.frames.offset) = (active, tool, offset);
        // Back to the held state.
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

    /// Why the retract forbids cycle start, if it does.
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

    /// The first axis that is off a position, and by how much, radius mm.
    fn off(&self, from: PerAxis<f64>) -> Option<(Axis, f64)> {
        let now = self.axes.program_set();
        Axis::ALL.into_iter().map(|axis| (axis, now[axis] - from[axis])).find(|(_, off)| off.abs() > BACK_MM)
    }

    /// RESET or an alarm that ends the run: drops the suspended run.
    pub(super) fn drop_retract(&mut self) {
        if self.retract.waiting.is_some() {
            self.forget_place();
        }
        self.retract = Retract::default();
    }

    /// Whether no manual motion or withdrawal is in progress.
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
