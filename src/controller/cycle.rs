//! Cycle start, feed hold and reset: they start, hold and end a run.
//! Source: spec B5, K2.2, "what stops what".

use std::sync::Arc;

use super::run::Origin;
use super::{ControlPhase, Controller};
use crate::defs::alarm;
use crate::defs::key::Mode;
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;
use crate::machine::RequestResult;

impl Controller {
    pub(super) fn toggle_single_block(&mut self) {
        self.switches.single_block = !self.switches.single_block;
        if self.switches.single_block
            && matches!(self.phase, ControlPhase::Running)
            && let Some(run) = &mut self.run
            && run.handed_over > 0
        {
            self.axes.planner.hold();
            run.splitting = true;
        }
    }

    pub(super) fn cycle_start(&mut self) {
        match self.phase {
            ControlPhase::Running => return self.refuse(LocalizedText::new("程序已在运行", "the program is running")),
            ControlPhase::Holding | ControlPhase::Aborting | ControlPhase::Homing(_) => {
                return self.refuse(LocalizedText::new("轴还在运动，请稍候", "the axes still move"));
            }
            ControlPhase::Idle if self.mode == Mode::Mdi => return self.start_mdi(),
            ControlPhase::Idle if self.mode != Mode::Auto => {
                return self.refuse(LocalizedText::new("自动方式下才能循环启动", "cycle start works in mode AUTO"));
            }
            ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped => {}
        }
        if let Some(why) = self.retract_blocks_start() {
            return self.refuse(why);
        }
        if !matches!(self.request(Request::CycleStart), RequestResult::Accepted) {
            return;
        }
        if matches!(self.phase, ControlPhase::Idle) && self.start_restart() {
            return;
        }
        if matches!(self.phase, ControlPhase::Idle) {
            self.repeats_left = self.params.get(param::PROGRAM_REPEATS) as u32 - 1;
            return self.start_program();
        }
        if let Some(why) = self.spindle_stopped_in_pause() {
            return self.refuse(why);
        }
        if self.oscillates_by_key() {
            return self.refuse(LocalizedText::new(
                "暂停中用按键启动的振荡未关闭，先关闭再循环启动",
                "the key has begun an oscillation in the pause: end it before cycle start",
            ));
        }
        self.resume_run();
    }

    /// L9: a finished program starts again until it has run P390 times.
    pub(super) fn repeat_program(&mut self) {
        if self.repeats_left > 0 && matches!(self.phase, ControlPhase::Idle) {
            self.repeats_left -= 1;
            if matches!(self.request(Request::CycleStart), RequestResult::Accepted) {
                self.start_program();
            }
        }
    }

    fn start_program(&mut self) {
        let number = self.current_program;
        match self.programs.get(number) {
            Some(program) => {
                let source = Arc::clone(&program.source);
                self.open_run(source, Origin::Program);
            }
            None => {
                let title = self.program_title(number);
                self.refuse(LocalizedText::new(
                    format!("没有程序 {title}：先在目录中选择程序"),
                    format!("there is no program {title}: choose one in the directory"),
                ));
            }
        }
    }

    pub(super) fn feed_hold(&mut self) {
        match self.phase {
            ControlPhase::Running => self.hold_run(),
            ControlPhase::Homing(_) => self.abort_run(),
            ControlPhase::Idle => {
                self.refuse(LocalizedText::new("没有程序在运行，无可暂停", "no program runs: there is nothing to hold"))
            }
            ControlPhase::Holding | ControlPhase::Aborting => {
                self.show_note(LocalizedText::new("轴正在停止", "the axes are stopping"))
            }
            ControlPhase::Held | ControlPhase::Stopped => {
                self.show_note(LocalizedText::new("已在暂停，按循环启动继续", "held already: cycle start goes on"));
            }
        }
    }

    pub(super) fn reset(&mut self) {
        self.discard_mdi();
        self.abort_run();
        self.machine.reset();
        self.dressing.cancel();
        self.abandon_retract();
        self.restart = None;
        self.stop_oscillation();
        let e_stop = self.machine.is_e_stopped();
        let bus = self.image.bus_alive;
        let (inputs, limits) = (self.inputs, self.limit_switches);
        let drives = [Input::DriveX, Input::DriveY, Input::DriveZ].into_iter().any(|input| inputs.has(input));
        self.alarms.reset(|number| match number {
            alarm::EMERGENCY_STOP => e_stop,
            alarm::BUS_LOST => !bus,
            alarm::DRIVE_FAULT => drives,
            alarm::HARD_LIMIT => limits != 0,
            _ => false,
        });
        self.drives_on = !e_stop && bus && !drives;
        self.message = Default::default();
    }
}
