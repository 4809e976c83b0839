//! Panel keys: what a press does, or why it has no effect.
//! Source: spec K2, K2.2, K2.4.

use super::switches::{toggle_aux_function_lock, toggle_dry_run, toggle_machine_lock};
use super::{Panel, Parts};
use crate::controller::manual::toggle_oscillation;
use crate::controller::plant::Plant;
use crate::defs::key::{Key, KeyGroup, Mode};
use crate::defs::soft_key;
use crate::defs::text::arg::Arg;
use crate::defs::text::phrase;
use crate::link::snapshot::Message;
use crate::machine::panel_key;
use crate::units::Axis;

/// Override limits and step, percent.
const FEED_OVERRIDE_MAX: u16 = 150;
const SPINDLE_OVERRIDE_MIN: u16 = 50;
const SPINDLE_OVERRIDE_MAX: u16 = 120;
const OVERRIDE_STEP: u16 = 10;

impl Panel {
    /// K2.4: executes a key press, or shows why it has no effect.
    pub fn press_key(&mut self, parts: &mut Parts<'_>, key: Key) {
        if let Some(reason) = parts.plant.inactive_reason(key) {
            return parts.plant.refuse(reason);
        }
        let already = selects_state(key) && self.key_view(parts.view(), key).lamp;
        self.handle_key(parts, key);
        if already && parts.plant.outbox.message.since != parts.plant.now {
            let name = Arg::Key(key, parts.plant.kind);
            parts.plant.show_note(phrase!("{name}：已是此状态", "{name}: already in this state", name));
        }
    }

    fn handle_key(&mut self, parts: &mut Parts<'_>, key: Key) {
        match key {
            Key::ModeEdit => self.select_mode(parts, Mode::Edit),
            Key::ModeAuto => self.select_mode(parts, Mode::Auto),
            Key::ModeMdi => self.select_mode(parts, Mode::Mdi),
            Key::ModeHome => self.select_mode(parts, Mode::Home),
            Key::ModeHandwheel => self.select_mode(parts, Mode::Handwheel),
            Key::ModeStep => self.select_mode(parts, Mode::Step),
            Key::ModeManual => self.select_mode(parts, Mode::Manual),
            Key::SingleBlock => parts.program.toggle_single_block(parts.plant),
            Key::BlockSkip => parts.plant.operator.switches.block_skip ^= true,
            Key::OptionalStop => parts.plant.operator.switches.optional_stop ^= true,
            Key::MachineLock => toggle_machine_lock(parts),
            Key::AuxFunctionLock => toggle_aux_function_lock(parts.plant),
            Key::DryRun => toggle_dry_run(parts),
            Key::CycleStart => parts.program.cycle_start(parts.plant),
            Key::FeedHold => parts.program.feed_hold(parts.plant),
            Key::Reset => {
                self.reset(parts);
                parts.plant.show_note(phrase!("已复位", "reset"));
            }
            Key::EmergencyStop if parts.plant.inputs.screen_e_stop() => {
                parts.plant.show_note(phrase!("急停已按下", "the emergency stop is already pressed"));
            }
            Key::EmergencyStop => parts.plant.inputs.set_screen_e_stop(true),
            Key::Rapid => parts.plant.operator.rapid_jog = !parts.plant.operator.rapid_jog,
            Key::HandwheelX => parts.plant.operator.handwheel_axis = Axis::X,
            Key::HandwheelY => parts.plant.operator.handwheel_axis = Axis::Y,
            Key::HandwheelZ => parts.plant.operator.handwheel_axis = Axis::Z,
            Key::Step0001 => parts.plant.operator.step_mm = 0.001,
            Key::Step001 => parts.plant.operator.step_mm = 0.01,
            Key::Step01 => parts.plant.operator.step_mm = 0.1,
            Key::XPlus | Key::XMinus | Key::YPlus | Key::YMinus | Key::ZPlus | Key::ZMinus => {
                parts.manual.axis_key(parts.plant, parts.program, key)
            }
            Key::Oscillation => toggle_oscillation(parts.plant),
            Key::DressReturn => parts.manual.toggle_dress_return(parts.plant),
            Key::WheelRetract => parts.program.press_retract(parts.plant),
            Key::AddressX => parts.manual.ask_dress_point(parts.plant, self.pages.coordinates, Axis::X),
            Key::AddressY => parts.manual.ask_dress_point(parts.plant, self.pages.coordinates, Axis::Y),
            Key::AddressZ => parts.manual.ask_dress_point(parts.plant, self.pages.coordinates, Axis::Z),
            Key::Input => parts.manual.set_dress_point(parts.plant),
            Key::Cancel => parts.manual.cancel_dress_point(parts.plant),
            Key::F1 => self.press_soft_key(parts, 0),
            Key::F2 => self.press_soft_key(parts, 1),
            Key::F3 => self.press_soft_key(parts, 2),
            Key::F4 => self.press_soft_key(parts, 3),
            Key::F5 => self.press_soft_key(parts, 4),
            Key::NextRow => self.show_soft_row(self.pages.soft_row + 1),
            Key::PreviousRow => self.show_soft_row(self.pages.soft_row + soft_key::ROWS - 1),
            _ => press_override(parts.plant, key),
        }
    }

    fn select_mode(&mut self, parts: &mut Parts<'_>, mode: Mode) {
        // K2.2, K6.3: a held run survives a mode change; cycle start resumes it from any mode.
        if !parts.plant.allows_manual_motion() && mode != parts.plant.operator.mode {
            return parts
                .plant
                .refuse(phrase!("轴还在运动，不能换方式", "the axes are still moving: the mode cannot be changed"));
        }
        parts.plant.jog.stop_all();
        parts.program.discard_mdi();
        if mode != parts.plant.operator.mode {
            parts.program.abandon_restart();
            parts.manual.dressing.cancel();
        }
        parts.plant.operator.mode = mode;
    }

    /// 复位: ends the run and the oscillation, clears alarms, drops what was prepared.
    fn reset(&mut self, parts: &mut Parts<'_>) {
        parts.program.discard_mdi();
        parts.plant.abort_run();
        parts.plant.machine.reset();
        parts.manual.dressing.cancel();
        parts.program.abandon_retract(parts.plant);
        parts.program.abandon_restart();
        parts.plant.stop_oscillation();
        parts.plant.reset();
        parts.plant.outbox.message = Message::default();
    }
}

fn press_override(plant: &mut Plant, key: Key) {
    let before = plant.operator.overrides;
    set_override(plant, key);
    let now = plant.operator.overrides;
    let at = match key {
        Key::FeedOverrideUp | Key::FeedOverrideDown if before.feed == now.feed => now.feed,
        Key::SpindleOverrideUp | Key::SpindleOverrideDown if before.spindle == now.spindle => now.spindle,
        _ => return,
    };
    plant.show_note(phrase!("倍率已到 {at} %", "the override is at its limit, {at} %", at));
}

fn set_override(plant: &mut Plant, key: Key) {
    let overrides = &mut plant.operator.overrides;
    match key {
        Key::FeedOverrideUp => overrides.feed = (overrides.feed + OVERRIDE_STEP).min(FEED_OVERRIDE_MAX),
        Key::FeedOverrideDown => overrides.feed = overrides.feed.saturating_sub(OVERRIDE_STEP),
        Key::RapidF0 => overrides.rapid = 0,
        Key::Rapid25 => overrides.rapid = 25,
        Key::Rapid50 => overrides.rapid = 50,
        Key::Rapid100 => overrides.rapid = 100,
        Key::SpindleOverrideUp => overrides.spindle = (overrides.spindle + OVERRIDE_STEP).min(SPINDLE_OVERRIDE_MAX),
        Key::SpindleOverrideDown => overrides.spindle = (overrides.spindle - OVERRIDE_STEP).max(SPINDLE_OVERRIDE_MIN),
        key => {
            if let Some(request) = panel_key::machine_request(key, plant.operator.mode, plant.outputs.on) {
                plant.request(request);
            }
        }
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
        KeyGroup::Switch | KeyGroup::Run | KeyGroup::Jog | KeyGroup::Fluids => false,
        KeyGroup::Gauges | KeyGroup::Dressing | KeyGroup::Screen => false,
    }
}
