//! Panel keys: what a press does, or why it has no effect.
//! Source: spec K2, K2.2, K2.4.

use super::{ControlPhase, Controller, retract};
use crate::defs::alarm;
use crate::defs::key::{Key, KeyGroup, Mode};
use crate::defs::mcode::Request;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::{LocalizedText, Text};
use crate::machine::{RequestResult, panel_key};
use crate::units::Axis;

/// Override limits and step, percent.
const FEED_OVERRIDE_MAX: u16 = 150;
const SPINDLE_OVERRIDE: std::ops::RangeInclusive<u16> = 50..=120;
const OVERRIDE_STEP: u16 = 10;

impl Controller {
    /// Why a key would have no effect now, if so.
    pub(super) fn key_blocked(&self, key: Key) -> Option<Text> {
        if let Some(reason) =
            panel_key::inactive_reason(key, self.kind, self.axes.fitted(), self.phase.without_homing())
        {
            return Some(reason);
        }
        if key == Key::WheelRetract && !self.params.bit(param::WHEEL_RETRACT) {
            return Some(retract::DISABLED);
        }
        let request = panel_key::machine_request(key, self.mode, self.output_set)?;
        self.machine.blocking_rule(request, self.now, self.inputs, &self.params).map(|rule| rule.reason)
    }

    /// K2.4: executes a key press, or shows why it has no effect.
    pub(super) fn press_key(&mut self, key: Key) {
        if let Some(reason) =
            panel_key::inactive_reason(key, self.kind, self.axes.fitted(), self.phase.without_homing())
        {
            return self.refuse(reason);
        }
        let already = selects_state(key) && self.key_view(key).lamp;
        self.handle_key(key);
        if already && self.message.since != self.now {
            let name = key.label_on(self.kind);
            self.show_note(LocalizedText::new(
                format!("{}：已是此状态", name.zh),
                format!("{}: it is so already", name.en),
            ));
        }
    }

    fn handle_key(&mut self, key: Key) {
        match key {
            Key::ModeEdit => self.select_mode(Mode::Edit),
            Key::ModeAuto => self.select_mode(Mode::Auto),
            Key::ModeMdi => self.select_mode(Mode::Mdi),
            Key::ModeHome => self.select_mode(Mode::Home),
            Key::ModeHandwheel => self.select_mode(Mode::Handwheel),
            Key::ModeStep => self.select_mode(Mode::Step),
            Key::ModeManual => self.select_mode(Mode::Manual),
            Key::SingleBlock => self.toggle_single_block(),
            Key::BlockSkip => self.switches.block_skip = !self.switches.block_skip,
            Key::OptionalStop => self.switches.optional_stop = !self.switches.optional_stop,
            Key::MachineLock => self.toggle_machine_lock(),
            Key::AuxFunctionLock => self.toggle_aux_function_lock(),
            Key::DryRun => self.toggle_dry_run(),
            Key::CycleStart => self.cycle_start(),
            Key::FeedHold => self.feed_hold(),
            Key::Reset => {
                self.reset();
                self.show_note(LocalizedText::new("已复位", "reset"));
            }
            Key::EmergencyStop => {
                self.soft_e_stop = !self.soft_e_stop;
                if self.soft_e_stop {
                    self.inputs.set(Input::EmergencyStop, true); // in this very tick
                }
            }
            Key::Rapid => self.jog.rapid = !self.jog.rapid,
            Key::HandwheelX => self.jog.axis = Axis::X,
            Key::HandwheelY => self.jog.axis = Axis::Y,
            Key::HandwheelZ => self.jog.axis = Axis::Z,
            Key::Step0001 => self.jog.step_mm = 0.001,
            Key::Step001 => self.jog.step_mm = 0.01,
            Key::Step01 => self.jog.step_mm = 0.1,
            Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => self.axis_key(key),
            Key::Oscillation => self.toggle_oscillation(),
            Key::DressReturn => self.toggle_dress_return(),
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
            Key::NextRow => self.show_soft_row(self.pages.soft_row + 1),
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
        self.show_note(LocalizedText::new(
            format!("倍率已到 {at} %"),
            format!("the override stands at its end, {at} %"),
        ));
    }

    fn set_override(&mut self, key: Key) {
        let overrides = &mut self.overrides;
        match key {
            Key::FeedOverrideUp => overrides.feed = (overrides.feed + OVERRIDE_STEP).min(FEED_OVERRIDE_MAX),
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
                if let Some(request) = panel_key::machine_request(key, self.mode, self.output_set) {
                    self.request(request);
                }
            }
        }
    }

    /// Sends a request to the machine logic and shows a refusal.
    pub(super) fn request(&mut self, request: Request) -> RequestResult {
        self.machine.set_control_state(self.control_state());
        let answer = self.machine.request(request, self.now, self.inputs, &self.params);
        match answer {
            RequestResult::Accepted
                if matches!(request, Request::WorkDriveHigh | Request::WorkDriveLow | Request::WorkDriveStop) =>
            {
                self.analog_2_rpm = 0.0;
            }
            RequestResult::Accepted => {}
            RequestResult::NoEffect(reason) | RequestResult::Denied(reason) => self.refuse(reason),
            RequestResult::Alarm(number, reason) => {
                let reason = self.machine.reason_text(reason, request, &self.params);
                self.refuse(reason.clone());
                // Alarm 180 is raised by the supervision, which also clears it (K3.7).
                if number != alarm::HYDRAULIC_PRESSURE {
                    self.raise(number, Some(reason));
                }
            }
        }
        answer
    }

    fn select_mode(&mut self, mode: Mode) {
        // K2.2, K6.3: a held run survives a mode change; cycle start resumes it from any mode.
        if !matches!(self.phase, ControlPhase::Idle | ControlPhase::Held | ControlPhase::Stopped) && mode != self.mode {
            return self.refuse(LocalizedText::new("轴还在运动，不能换方式", "the axes still move: no change of mode"));
        }
        self.jog.stop_all();
        self.discard_mdi();
        if mode != self.mode {
            self.restart = None;
            self.dressing.cancel();
        }
        self.mode = mode;
    }
}

/// Keys that select a state, in contrast to toggle keys: pressed again they change nothing.
const fn selects_state(key: Key) -> bool {
    match key.row().group {
        KeyGroup::Mode | KeyGroup::Handwheel | KeyGroup::Override => true,
        KeyGroup::Wheel | KeyGroup::Workpiece | KeyGroup::Clamping => matches!(
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
        KeyGroup::Switch
        | KeyGroup::Run
        | KeyGroup::Jog
        | KeyGroup::Fluids
        | KeyGroup::Gauges
        | KeyGroup::Dressing
        | KeyGroup::Screen => false,
    }
}
