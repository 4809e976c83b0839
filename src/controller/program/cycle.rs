//! Cycle start and feed hold: they start and hold a run.
//! Source: spec B5, K2.2, "what stops what".

use std::sync::Arc;

use super::Program;
use super::activity::Handover;
use super::run::Origin;
use crate::controller::plant::{ControlPhase, Plant, STILL_MOVING};
use crate::defs::key::Mode;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::text::{Text, phrase};
use crate::nc::Library as _;

/// A start in the tick of a reset.
pub const START_VOID: Text =
    Text::new("同时按了复位或急停，启动无效", "RESET or emergency stop was pressed with the start: no start");

impl Program {
    /// 单段: switched on in a move, the axes stop and the moves are handed over block by block.
    pub fn toggle_single_block(&mut self, plant: &mut Plant) {
        plant.operator.switches.single_block = !plant.operator.switches.single_block;
        if plant.operator.switches.single_block
            && matches!(plant.execution.phase, ControlPhase::Running | ControlPhase::Holding | ControlPhase::Held)
            && let Some(run) = &mut self.run
            && run.handed_over > 0
            && run.handover == Handover::Feeding
        {
            plant.axes.planner.hold();
            run.handover = Handover::TakingBack;
        }
    }

    /// 循环启动: starts a program or a prepared MDI line, or continues a held run.
    pub fn cycle_start(&mut self, plant: &mut Plant) {
        if plant.execution.starts_void {
            return plant.refuse(START_VOID);
        }
        match plant.execution.phase {
            ControlPhase::Running => return plant.refuse(phrase!("程序已在运行", "the program is running")),
            ControlPhase::Holding | ControlPhase::Aborting | ControlPhase::Homing(_) => {
                return plant.refuse(STILL_MOVING);
            }
            ControlPhase::Idle if plant.operator.mode == Mode::Mdi => return self.start_mdi(plant),
            ControlPhase::Idle if plant.operator.mode != Mode::Auto => {
                return plant.refuse(phrase!("自动方式下才能循环启动", "cycle start works in mode AUTO"));
            }
            ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped => {}
        }
        if let Some(why) = self.retract_blocks_start(plant) {
            return plant.refuse(why);
        }
        if !plant.is_granted(Request::CycleStart) {
            return;
        }
        if matches!(plant.execution.phase, ControlPhase::Idle) {
            let number = plant.execution.current_program;
            if let Some(places) = plant.work.programs.places_of_duplicate(number) {
                let (title, places) = (plant.program_title(number), places.to_owned());
                return plant.refuse(phrase!(
                    "程序 {title} 有两个：{places}。改掉其中一个的程序号，或删除一个",
                    "program {title} exists twice: {places}. Change the number of one of them, or delete one",
                    title,
                    places
                ));
            }
            if self.start_restart(plant) {
                return;
            }
            let repeats = plant.params.get(param::PROGRAM_REPEATS) as u32 - 1;
            plant.execution.repeats_left = if plant.execution.runs_once { 0 } else { repeats };
            return self.start_program(plant);
        }
        if let Some(why) = self.spindle_stopped_in_pause(plant) {
            return plant.refuse(why);
        }
        self.resume_run(plant);
    }

    /// L9: a finished program starts again until it has run P390 times.
    pub fn repeat_program(&mut self, plant: &mut Plant) {
        if plant.execution.repeats_left > 0 && matches!(plant.execution.phase, ControlPhase::Idle) {
            plant.execution.repeats_left -= 1;
            if plant.is_granted(Request::CycleStart) {
                // The part of the pass before stays in sight until the next one is finished.
                let finished = plant.execution.finished_cycle;
                self.start_program(plant);
                plant.execution.finished_cycle = finished;
            }
        }
    }

    fn start_program(&mut self, plant: &mut Plant) {
        let number = plant.execution.current_program;
        let Some(program) = plant.work.programs.get(number) else {
            let title = plant.program_title(number);
            return plant.refuse(phrase!(
                "没有程序 {title}：先在目录中选择程序",
                "there is no program {title}: choose one in the directory",
                title
            ));
        };
        let source = Arc::clone(&program.source);
        self.open_run(plant, source, Origin::Program);
    }

    /// 进给保持.
    pub fn feed_hold(&mut self, plant: &mut Plant) {
        match plant.execution.phase {
            ControlPhase::Running => plant.hold_run(),
            ControlPhase::Homing(_) => plant.abort_run(),
            ControlPhase::Idle => {
                plant.refuse(phrase!("没有程序在运行，无可暂停", "no program runs: there is nothing to hold"))
            }
            ControlPhase::Holding | ControlPhase::Aborting => {
                plant.show_note(phrase!("轴正在停止", "the axes are stopping"))
            }
            ControlPhase::Held | ControlPhase::Stopped => {
                plant.show_note(phrase!("已在暂停，按循环启动继续", "already held: press cycle start to continue"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k2_2_cycle_start_and_feed_hold_say_why_nothing_happens() {
        let mut plant = Plant::factory();
        let mut program = Program::new(plant.kind, None);
        let mut why = |plant: &mut Plant, act: fn(&mut Program, &mut Plant)| {
            act(&mut program, plant);
            assert!(matches!(plant.execution.phase, ControlPhase::Idle) && !program.is_open());
            plant.outbox.refusal.take().map(|why| why.en().into_owned()).unwrap_or_default()
        };
        assert!(why(&mut plant, Program::feed_hold).contains("nothing to hold"));
        assert!(why(&mut plant, Program::cycle_start).contains("mode AUTO"));
        plant.operator.mode = Mode::Mdi;
        assert!(why(&mut plant, Program::cycle_start).contains("type a line"));
        plant.execution.starts_void = true;
        assert!(why(&mut plant, Program::cycle_start).contains("no start"));
    }
}
