//! The dressing point: setting it, and returning to it manually. G27 returns to it in a program.
//!
//! The lamp of 回修整点 shows the state. Lit: an axis key moves its axis to the point. Dark: the key jogs.
//! Source: spec K4.2.

use super::planned::Forbidden;
use super::{Controller, Effect, MINUTE_HZ, Phase};
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::mcode::Request;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::soft_key::Coordinates;
use crate::defs::text::{Said, Text};
use crate::machine::Answer;
use crate::units::{Axis, PerAxis};

/// The dressing points and the state of operator input.
#[derive(Clone, Debug)]
pub struct Dress {
    /// Machine coordinates, radius mm; `None` where not set.
    pub points: PerAxis<Option<f64>>,
    /// 回修整点 is lit.
    pub returning: bool,
    /// The question “是否设置…修整点” is open for this axis.
    asked: Option<Axis>,
}

impl Dress {
    /// Starts from the retained points.
    pub const fn new(points: PerAxis<Option<f64>>) -> Self {
        Self { points, returning: false, asked: None }
    }

    /// Mode change or reset: the lamp goes dark and an open question is withdrawn.
    pub const fn let_go(&mut self) {
        self.returning = false;
        self.asked = None;
    }

    /// The operator left the view of the question: the question is withdrawn.
    pub const fn withdraw(&mut self) {
        self.asked = None;
    }
}

impl Controller {
    /// Key X, Y or Z in JOG mode, view 相对 of the position page: asks whether to set the dressing point here.
    pub(super) fn ask_dress_point(&mut self, axis: Axis) {
        let elsewhere = if self.mode != Mode::Manual {
            Some(Text::new("不是手动方式", "the mode is not JOG"))
        } else if self.page != Page::Position {
            Some(Text::new("不在位置页面", "this is not the position page"))
        } else {
            (self.pages.coordinates != Coordinates::Relative)
                .then_some(Text::new("不是相对坐标", "these are not the relative coordinates"))
        };
        let refusal = if let Some(why) = elsewhere {
            Some(Said::new(
                format!("{}：修整点在手动方式、位置页面 F1“相对”下设置", why.zh),
                format!("{}: dressing points are set in JOG, position page, F1 RELATIVE", why.en),
            ))
        } else if !self.axes.is_homed(axis) {
            Some(Said::new(
                format!("{axis} 轴未回零，不能设置修整点"),
                format!("{axis} is not homed: no dressing point"),
            ))
        } else {
            None
        };
        self.dress.asked = refusal.is_none().then_some(axis);
        match refusal {
            Some(said) => self.refuse(said),
            None => self.say(Said::new(
                format!("是否设置 {axis} 轴修整点？按输入设置，取消放弃"),
                format!("set the dressing point of {axis} here? INPUT sets it, CANCEL leaves it"),
            )),
        }
    }

    /// 输入 confirms the question: the present machine coordinate is stored.
    pub(super) fn set_dress_point(&mut self) {
        let Some(axis) = self.dress.asked else {
            return self.refuse(Said::new("没有要输入的内容", "there is nothing to enter"));
        };
        if !self.axes.is_at_rest() {
            return self.refuse(Said::new("轴还在运动，请稍候", "the axes still move")); // the question stays
        }
        self.dress.asked = None;
        let at = self.axes.actual()[axis];
        self.dress.points[axis] = Some(at);
        self.effects.push(Effect::DressPoint(axis, at));
        let shown = at * self.displayed_per_mm(axis);
        self.say(Said::new(
            format!("{axis} 轴修整点设置成功：机床坐标 {shown:.3}"),
            format!("dressing point of {axis} set: machine {shown:.3}"),
        ));
    }

    /// 取消 withdraws the question.
    pub(super) fn cancel_dress_point(&mut self) {
        if self.dress.asked.take().is_some() {
            self.say(Said::new("修整点没有改变", "the dressing point is as it was"));
        } else {
            self.refuse(Said::new("没有要取消的内容", "there is nothing to cancel"));
        }
    }

    /// 回修整点 switches its lamp on or off.
    pub(super) fn switch_dress_return(&mut self) {
        if self.mode != Mode::Manual {
            return self.refuse(Said::new("手动方式下才能回修整点", "the return works in JOG"));
        }
        self.dress.returning = !self.dress.returning;
        if !self.dress.returning {
            self.hand.let_go();
        }
    }

    /// Axis key with the lamp lit: one press of either sign moves the axis to its point at P243 (mm/min). Without a
    /// point, or if not homed, nothing moves and the alarm of G27 is raised; in a held run only a message is shown
    /// and the run survives (K6.3).
    pub(super) fn return_to_dress_point(&mut self, axis: Axis) {
        let Some(point) = self.dress.points[axis] else {
            let why = self.forbidden(&Forbidden::NoDressPoint(axis));
            return self.no_return(alarm::NO_DRESS_POINT, why);
        };
        if !self.axes.is_homed(axis) {
            let why = Said::new(format!("{axis} 轴未回零，不能回修整点"), format!("{axis} is not homed: no return"));
            return self.no_return(alarm::NOT_HOMED, why);
        }
        let still = matches!(self.phase, Phase::Idle) || self.is_free_for_hand();
        if !still || !matches!(self.ask(Request::MoveByHand), Answer::Taken) || !self.part_from_run() {
            return;
        }
        let speed = self.params.get(param::DRESS_RETURN_SPEED) * MINUTE_HZ;
        self.hand.lead(axis, point, speed);
    }

    fn no_return(&mut self, number: u16, why: Said) {
        self.refuse(why.clone());
        if !self.phase.is_run_open() {
            self.raise(number, Some(why));
        }
    }
}
