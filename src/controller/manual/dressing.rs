//! The dressing point: setting it, and returning to it manually. G27 returns to it in a program.
//!
//! The lamp of 回修整点 shows the state. Lit: an axis key moves its axis to the point. Dark: the key jogs.
//! Source: spec K4.2.

use super::Manual;
use crate::controller::plant::{MM_S_PER_MM_MIN, Plant, STILL_MOVING};
use crate::controller::program::Program;
use crate::controller::program::move_refusal::MoveRefusal;
use crate::controller::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::mcode::Request;
use crate::defs::page::Page;
use crate::defs::param;
use crate::defs::soft_key::CoordinateView;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::units::Axis;

/// The state of operator input about the dressing points.
#[derive(Clone, Debug, Default)]
pub struct DressingInput {
    /// 回修整点 is lit.
    pub return_active: bool,
    /// The question “是否设置…修整点” is open for this axis.
    awaiting_answer: Option<Axis>,
}

impl DressingInput {
    /// Mode change or reset: the lamp goes dark and an open question is withdrawn.
    pub const fn cancel(&mut self) {
        self.return_active = false;
        self.awaiting_answer = None;
    }

    /// The operator left the view of the question: the question is withdrawn.
    pub const fn withdraw_question(&mut self) {
        self.awaiting_answer = None;
    }
}

/// A coordinate as displayed that differs by less is the same: half an increment, mm.
const SAME_PLACE: f64 = 0.000_5;

/// Why an axis without a place has no dressing point.
fn not_homed(plant: &Plant, axis: Axis) -> Option<LocalizedText> {
    (!plant.axes.is_homed(axis)).then(|| {
        phrase!("{axis} 轴未回零，不能设置修整点", "{axis} is not homed: the dressing point cannot be set", axis)
    })
}

impl Manual {
    /// Key X, Y or Z in JOG mode, view 相对 of the position page: asks whether to set the dressing point here.
    pub fn ask_dress_point(&mut self, plant: &mut Plant, coordinates: CoordinateView, axis: Axis) {
        let elsewhere = if plant.operator.mode != Mode::Manual {
            Some(const { &Text::new("不是手动方式", "the mode is not JOG") })
        } else if plant.operator.page != Page::Position {
            Some(const { &Text::new("不在位置页面", "this is not the position page") })
        } else {
            (coordinates != CoordinateView::Relative)
                .then_some(const { &Text::new("不是相对坐标", "the relative coordinates are not shown") })
        };
        let refusal = if let Some(why) = elsewhere {
            Some(phrase!(
                "{why}：修整点在手动方式、位置页面“相对”（第 1 行 F1）下设置",
                "{why}: dressing points are set in JOG, position page RELATIVE (row 1 F1)",
                why
            ))
        } else {
            not_homed(plant, axis)
        };
        self.dressing.awaiting_answer = refusal.is_none().then_some(axis);
        match refusal {
            Some(message) => plant.refuse(message),
            None => plant.show_note(phrase!(
                "是否设置 {axis} 轴修整点？按输入设置，取消放弃",
                "set the dressing point of {axis} here? INPUT: yes, CANCEL: no",
                axis
            )),
        }
    }

    /// 输入 confirms the question: the present machine coordinate is stored.
    pub fn set_dress_point(&mut self, plant: &mut Plant) {
        let Some(axis) = self.dressing.awaiting_answer else {
            return plant.refuse(phrase!("没有要输入的内容", "there is nothing to enter"));
        };
        if !plant.axes.is_at_rest() {
            return plant.refuse(STILL_MOVING); // the question stays
        }
        self.store_dress_point(plant, axis);
    }

    /// The key of the dressing page, which has asked with the coordinate `shown`: the same in JOG, without the position page.
    pub fn take_dress_point(&mut self, plant: &mut Plant, axis: Axis, shown: f64) {
        let moved = plant.axes.actual()[axis] * plant.displayed_per_mm(axis) - shown;
        if plant.operator.mode != Mode::Manual {
            plant.refuse(phrase!("修整点在手动方式下设置", "dressing points are set in JOG"));
        } else if let Some(message) = not_homed(plant, axis) {
            plant.refuse(message);
        } else if !plant.axes.is_at_rest() {
            plant.refuse(STILL_MOVING);
        } else if moved.abs() > SAME_PLACE {
            plant.refuse(phrase!(
                "{axis} 轴已移动：再按一次取此处",
                "{axis} has moved since: take the point again",
                axis
            ));
        } else {
            self.store_dress_point(plant, axis);
        }
    }

    fn store_dress_point(&mut self, plant: &mut Plant, axis: Axis) {
        self.dressing.awaiting_answer = None;
        let at = plant.axes.actual()[axis];
        plant.work.dress_points[axis] = Some(at);
        plant.store(StorageRequest::DressPoint(axis, Some(at)));
        let shown = at * plant.displayed_per_mm(axis);
        plant.show_note(phrase!(
            "{axis} 轴修整点设置成功：机床坐标 {shown:.3}",
            "dressing point of {axis} set: machine {shown:.3}",
            axis,
            shown
        ));
    }

    /// Removes all dressing points: the dressing programs use the values of their pages again.
    pub fn clear_dress_points(&mut self, plant: &mut Plant) {
        self.dressing.cancel();
        for axis in Axis::ALL {
            plant.remove_dress_point(axis);
        }
        plant.show_note(phrase!(
            "修整点已清除，修整程序用页面数值",
            "dressing points cleared: the values of the pages count"
        ));
    }

    /// 取消 withdraws the question.
    pub fn cancel_dress_point(&mut self, plant: &mut Plant) {
        if self.dressing.awaiting_answer.take().is_some() {
            plant.show_note(phrase!("修整点没有改变", "the dressing point is unchanged"));
        } else {
            plant.refuse(phrase!("没有要取消的内容", "there is nothing to cancel"));
        }
    }

    /// 回修整点 switches its lamp on or off.
    pub fn toggle_dress_return(&mut self, plant: &mut Plant) {
        if plant.operator.mode != Mode::Manual {
            return plant.refuse(phrase!("手动方式下才能回修整点", "the return to the dressing point works in JOG"));
        }
        self.dressing.return_active = !self.dressing.return_active;
        if !self.dressing.return_active {
            plant.jog.stop_all();
        }
    }

    fn refuse_dress_return(&mut self, plant: &mut Plant, number: u16, why: LocalizedText) {
        plant.refuse(why.clone());
        if !plant.execution.phase.is_run_open() {
            plant.raise(number, Some(why));
        }
    }

    /// Axis key with the lamp lit: one press of either sign moves the axis to its point at P243 (mm/min). Without a
    /// point, or if not homed, nothing moves and the alarm of G27 is raised; in a held run only a message is shown
    /// and the run survives (K6.3).
    pub fn return_to_dress_point(&mut self, plant: &mut Plant, program: &mut Program, axis: Axis) {
        let Some(point) = plant.work.dress_points[axis] else {
            let why = MoveRefusal::NoDressPoint(axis).text(&plant.params);
            return self.refuse_dress_return(plant, alarm::NO_DRESSING_POINT, why);
        };
        if !plant.axes.is_homed(axis) {
            let why =
                phrase!("{axis} 轴未回零，不能回修整点", "{axis} is not homed: no return to the dressing point", axis);
            return self.refuse_dress_return(plant, alarm::NOT_HOMED, why);
        }
        if !plant.allows_manual_motion() || !plant.is_granted(Request::Jog) || !program.detach_from_run(plant) {
            return;
        }
        let speed = plant.params.get(param::DRESS_RETURN_SPEED) * MM_S_PER_MM_MIN;
        plant.jog.move_to(axis, point, speed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k4_2_a_dressing_point_is_asked_for_before_it_is_set() {
        let mut plant = Plant::factory();
        let mut manual = Manual::default();
        manual.ask_dress_point(&mut plant, CoordinateView::Relative, Axis::X);
        assert!(plant.outbox.refusal.take().is_some_and(|why| why.en().contains("not homed")));
        manual.set_dress_point(&mut plant);
        assert!(plant.outbox.refusal.take().is_some(), "no question is open");
        let params = plant.params.clone();
        plant.axes.finish_homing(Axis::X, &params);
        manual.ask_dress_point(&mut plant, CoordinateView::All, Axis::X);
        assert!(plant.outbox.refusal.take().is_some(), "another view");
        manual.ask_dress_point(&mut plant, CoordinateView::Relative, Axis::X);
        manual.dressing.withdraw_question();
        manual.cancel_dress_point(&mut plant);
        assert!(plant.outbox.refusal.take().is_some(), "the operator left the view");
        manual.ask_dress_point(&mut plant, CoordinateView::Relative, Axis::X);
        manual.set_dress_point(&mut plant);
        assert_eq!(plant.outbox.refusal, None);
        assert_eq!(plant.outbox.requests, [StorageRequest::DressPoint(Axis::X, Some(0.0))]);
        assert!(plant.work.dress_points[Axis::X].is_some());
    }
}
