//! Panel keys: what a press does, or why it has no effect.
//! Source: spec K2, K2.2, K2.4.

use super::{Controller, Phase, retract};
use crate::defs::alarm;
use crate::defs::key::{Group, Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::{Said, Text};
use crate::machine::{Answer, press};
use crate::units::Axis;

/// Override limits and step, percent.
const FEED_OVERRIDE_MOST: u16 = 150;
const SPINDLE_OVERRIDE: std::ops::RangeInclusive<u16> = 50..=120;
const OVERRIDE_STEP: u16 = 10;

impl Controller {
    /// Why a key would have no effect now, if so.
    pub(super) fn blocked(&self, key: Key) -> Option<Text> {
        if let Some(reason) = press::dead(key, self.kind, self.axes.fitted(), self.phase.bare()) {
            return Some(reason);
        }
        if key == Key::WheelRetract && !self.params.bit(param::WHEEL_RETRACT) {
            return Some(retract::DISABLED);
        }
        let request = press::request(key, self.mode, self.output_set)?;
        self.machine.forbidding(request, self.now, self.inputs, &self.params).map(|rule| rule.reason)
    }

    /// K2.4: executes a key press, or shows why it has no effect.
    pub(super) fn press(&mut self, key: Key) {
        if let Some(reason) = press::dead(key, self.kind, self.axes.fitted(), self.phase.bare()) {
            return self.refuse(reason);
        }
        let already = chooses(key) && self.key_view(key).lamp;
        self.act_on(key);
        if already && self.message.since != self.now {
            let name = key.name_on(self.kind);
            self.say(Said::new(format!("{}：已是此状态", name.zh), format!("{}: it is so already", name.en)));
        }
    }

    fn act_on(&mut self, key: Key) {
        match key {
            Key::ModeEdit => self.choose(Mode::Edit),
            Key::ModeAuto => self.choose(Mode::Auto),
            Key::ModeMdi => self.choose(Mode::Mdi),
            Key::ModeHome => self.choose(Mode::Home),
            Key::ModeHandwheel => self.choose(Mode::Handwheel),
            Key::ModeStep => self.choose(Mode::Step),
            Key::ModeManual => self.choose(Mode::Manual),
            Key::SingleBlock => self.switch_single_block(),
            Key::BlockSkip => self.switches.block_skip = !self.switches.block_skip,
            Key::OptionalStop => self.switches.optional_stop = !self.switches.optional_stop,
            Key::MachineLock => self.switch_machine_lock(),
            Key::MstLock => self.switch_mst_lock(),
            Key::DryRun => self.switch_dry_run(),
            Key::CycleStart => self.cycle_start(),
            Key::FeedHold => self.feed_hold(),
            Key::Reset => {
                self.reset();
                self.say(Said::new("已复位", "reset"));
            }
            Key::EmergencyStop => {
                self.soft_e_stop = !self.soft_e_stop;
                if self.soft_e_stop {
                    self.inputs.set(Input::EmergencyStop, true); // in this very tick
                }
            }
            Key::Rapid => self.hand.rapid = !self.hand.rapid,
            Key::HandwheelX => self.hand.axis = Axis::X,
            Key::HandwheelY => self.hand.axis = Axis::Y,
            Key::HandwheelZ => self.hand.axis = Axis::Z,
            Key::Step0001 => self.hand.step_mm = 0.001,
            Key::Step001 => self.hand.step_mm = 0.01,
            Key::Step01 => self.hand.step_mm = 0.1,
            Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => self.axis_key(key),
            Key::Oscillation => self.switch_oscillation(),
            Key::DressReturn => self.switch_dress_return(),
            Key::WheelRetract => self.press_retract(),
            Key::AddressX => self.ask_dress_point(Axis::X),
            Key::AddressY => self.ask_dress_point(Axis::Y),
            Key::AddressZ => self.ask_dress_point(Axis::Z),
            Key::Input => self.set_dress_point(),
            Key::Cancel => self.cancel_dress_point(),
            Key::F1 => self.press_soft_key(0),
            Key::F2 => self.press_soft_key(1),
            Key::F3 => self.press_soft_key(2),
            Key::F4 => self.press_soft_key(3),
            Key::F5 => self.press_soft_key(4),
            Key::NextRow => self.turn_soft_row(self.pages.soft_row + 1),
            _ => self.press_override(key),
        }
    }

    fn press_override(&mut self, key: Key) {
        let before = (self.overrides.feed, self.overrides.spindle);
        self.set_override(key);
        let now = (self.overrides.feed, self.overrides.spindle);
        let at = match key {
            Key::FeedOverrideUp | Key::FeedOverrideDown if before == now => now.0,
            Key::SpindleOverrideUp | Key::SpindleOverrideDown if before == now => now.1,
            _ => return,
        };
        self.say(Said::new(format!("倍率已到 {at} %"), format!("the override stands at its end, {at} %")));
    }

    fn set_override(&mut self, key: Key) {
        let overrides = &mut self.overrides;
        match key {
            Key::FeedOverrideUp => overrides.feed = (overrides.feed + OVERRIDE_STEP).min(FEED_OVERRIDE_MOST),
            Key::FeedOverrideDown => overrides.feed = overrides.feed.saturating_sub(OVERRIDE_STEP),
            Key::RapidF0 => overrides.rapid = 0,
            Key::Rapid25 => overrides.rapid = 25,
            Key::Rapid50 => overrides.rapid = 50,
            Key::Rapid100 => overrides.rapid = 100,
            Key::SpindleOverrideUp => {
                overrides.spindle = (overrides.spindle + OVERRIDE_STEP).min(*SPINDLE_OVERRIDE.end());
            }
            Key::SpindleOverrideDown => {
                overrides.spindle = (overrides.spindle - OVERRIDE_STEP).max(*SPINDLE_OVERRIDE.start());
            }
            key => {
                if let Some(request) = press::request(key, self.mode, self.output_set) {
                    self.ask(request);
                }
            }
        }
    }

    /// Sends a request to the machine logic and shows a refusal.
    pub(super) fn ask(&mut self, request: Request) -> Answer {
        self.machine.inform(self.around());
        let answer = self.machine.ask(request, self.now, self.inputs, &self.params);
        match answer {
            Answer::Taken if matches!(request, Request::DriveHigh | Request::DriveLow | Request::DriveStop) => {
                self.analog_2_rpm = 0.0;
            }
            Answer::Taken => {}
            Answer::NoEffect(reason) | Answer::Denied(reason) => self.refuse(reason),
            Answer::Refused(number, reason) => {
                let reason = self.machine.reason(reason, request, &self.params);
                self.refuse(reason.clone());
                // Alarm 180 is raised by the supervision, which also clears it (K3.7).
                if number != alarm::HYDRAULIC {
                    self.raise(number, Some(reason));
                }
            }
        }
        answer
    }

    fn choose(&mut self, mode: Mode) {
        // K2.2, K6.3: a held run survives a mode change; cycle start resumes it from any mode.
        if !matches!(self.phase, Phase::Idle | Phase::Held | Phase::Stopped) && mode != self.mode {
            return self.refuse(Said::new("轴还在运动，不能换方式", "the axes still move: no change of mode"));
        }
        self.hand.let_go();
        self.drop_mdi();
        if mode != self.mode {
            self.restart = None;
            self.dress.let_go();
        }
        self.mode = mode;
    }
}

/// Keys that select a state, in contrast to toggle keys: pressed again they change nothing.
const fn chooses(key: Key) -> bool {
    match key.row().group {
        Group::Mode | Group::Handwheel | Group::Override => true,
        Group::Wheel | Group::Workpiece | Group::Clamping => matches!(
            key,
            Key::WheelStart
                | Key::WheelStop
                | Key::HeadstockHigh
                | Key::HeadstockLow
                | Key::HeadstockStop
                | Key::SpindleForward
                | Key::SpindleReverse
                | Key::SpindleStop
                | Key::TailstockAdvance
                | Key::TailstockRetract
        ),
        Group::Switch | Group::Run | Group::Jog | Group::Fluids | Group::Gauges | Group::Dressing | Group::Screen => {
            false
        }
    }
}
