//! Lathe functions of a program: threads, homing to a switch, the tool post.
//! Source: spec L5, L6, L8.

use super::activity::{ActionStatus, Activity};
use super::run::ProgramRun;
use crate::controller::axes::homing::HomingProgress;
use crate::controller::plant::{ControlEvent, Plant};
use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::arg::Arg;
use crate::defs::text::phrase;
use crate::motion::{ThreadMover, ThreadPass};
use crate::nc::ThreadMove;
use crate::units::Axis;

impl ProgramRun {
    /// One tick of a thread.
    pub fn step_thread(&mut self, plant: &mut Plant, thread: &ThreadPass) -> ActionStatus {
        if self.activity == Activity::Thread {
            return ActionStatus::done_if(plant.axes.thread().is_none());
        }
        if !self.is_settled(plant) {
            return ActionStatus::Wait;
        }
        let rpm = plant.spindles.encoder.rpm.abs();
        if plant.machine.spindle_direction().is_none() || rpm < 1.0 {
            let [title, place] = thread_location(plant);
            plant.raise(alarm::SPINDLE_NOT_TURNING, Some(phrase!("{title} {place}", "{title} {place}", title, place)));
            return ActionStatus::Wait;
        }
        let limit = ThreadMove::max_spindle_rpm(thread.lead_mm);
        // The speed is measured: one or two rpm above the limit are no program fault.
        if rpm > limit * 1.01 + 1.0 {
            let [title, place] = thread_location(plant);
            let message = phrase!(
                "{title} {place}：主轴 {rpm:.0} r/min，导程 {lead_mm:.3} mm 最高 {limit:.0} r/min",
                "{title} {place}: {rpm:.0} rpm, lead {lead_mm:.3} mm allows at most {limit:.0} rpm",
                title,
                place,
                rpm,
                lead_mm = thread.lead_mm,
                limit
            );
            plant.raise(alarm::THREAD_SPEED, Some(message));
            return ActionStatus::Wait;
        }
        let from = plant.axes.set_point();
        let (turns, lag_s) = (plant.spindles.encoder.turns, plant.params.get(param::SERVO_LAG) / 1_000.0);
        let limits = plant.axes.path_limits(&plant.params);
        plant.axes.begin_thread(ThreadMover::new(*thread, from, limits, turns, lag_s));
        plant.spindles.threads.begin(plant.execution.current_block.line, thread.lead_mm, from[Axis::Z]);
        self.activity = Activity::Thread;
        ActionStatus::Wait
    }

    /// One tick of homing by a program.
    pub fn step_program_homing(&mut self, plant: &mut Plant, axis: Axis) -> ActionStatus {
        if self.activity != Activity::Homing {
            if !self.is_settled(plant) {
                return ActionStatus::Wait;
            }
            plant.axes.switch_to_manual();
            plant.axes.lift_soft_limits(axis);
            plant.axes.homing = Some(plant.plan_homing(axis));
            self.activity = Activity::Homing;
            return ActionStatus::Wait;
        }
        let Some(mut homing) = plant.axes.homing.take() else {
            plant.axes.switch_to_program();
            return ActionStatus::Done;
        };
        let progress = plant.tick_homing(&mut homing);
        match progress {
            HomingProgress::Running => plant.axes.homing = Some(homing),
            HomingProgress::SetZero { edge } => {
                plant.apply_zero(axis, edge);
                plant.axes.homing = Some(homing);
            }
            HomingProgress::Done => plant.axes.finish_homing(axis, &plant.params),
            HomingProgress::Failed(why) => plant.raise_homing_failed(axis, why),
        }
        ActionStatus::Wait
    }

    /// One tick of the tool post.
    pub fn step_turret(&mut self, plant: &mut Plant, station: u8) -> ActionStatus {
        let request = Request::ToolTurret(station);
        if self.activity == Activity::AwaitUnit {
            return ActionStatus::done_if(plant.machine.is_settled(request));
        }
        if plant.operator.switches.aux_function_lock {
            return ActionStatus::Done;
        }
        if !self.is_settled(plant) {
            return ActionStatus::Wait;
        }
        if plant.is_granted(request) {
            self.activity = Activity::AwaitUnit;
        } else {
            plant.transition(ControlEvent::Hold);
        }
        ActionStatus::Wait
    }
}

/// Program, line and column of the thread code, or of its block if the code is modal from an earlier block.
fn thread_location(plant: &Plant) -> [Arg; 2] {
    let (program, line) = (plant.execution.current_block.program, plant.execution.current_block.line);
    let text = plant.work.programs.get(program).and_then(|program| program.source.line(line)).unwrap_or_default();
    let found = ["G33", "G32"].into_iter().find_map(|code| text.to_ascii_uppercase().find(code)).unwrap_or(0);
    let column = text[..found].chars().count() as u32 + 1;
    [plant.program_title(program), Arg::Place(line, column)]
}
