//! Lamps of the keys, and why a key would have no effect.
//! Source: spec K2.4.

use super::{Panel, PartsView};
use crate::controller::plant::ControlPhase;
use crate::controller::program::retract;
use crate::defs::key::{Key, Lamp, Mode};
use crate::defs::param;
use crate::defs::signal::Output;
use crate::defs::text::Text;
use crate::link::snapshot::KeyView;
use crate::machine::panel_key;
use crate::units::Axis;

impl Panel {
    pub fn key_view(&self, parts: PartsView<'_>, key: Key) -> KeyView {
        let (on, machine) = (parts.plant.outputs.on, &parts.plant.machine);
        let (lamp, working) = match key.row().lamp {
            Lamp::None => (false, false),
            Lamp::Output(output) => {
                let reverse = output == Output::SecondSpindle && on.has(Output::SecondSpindleCcw);
                (on.has(output) || reverse, machine.awaits_feedback(output))
            }
            Lamp::OutputOff(output) => (!on.has(output), false),
            Lamp::Control => {
                (self.control_lamp(parts, key), key == Key::WheelRetract && parts.program.retract.is_moving())
            }
        };
        KeyView { lamp, pending: working, blocked: self.key_blocked(parts, key) }
    }

    fn control_lamp(&self, parts: PartsView<'_>, key: Key) -> bool {
        let step = |mm: f64| parts.plant.operator.step_mm.total_cmp(&mm).is_eq();
        match key {
            Key::SingleBlock => parts.plant.operator.switches.single_block,
            Key::BlockSkip => parts.plant.operator.switches.block_skip,
            Key::OptionalStop => parts.plant.operator.switches.optional_stop,
            Key::MachineLock => parts.plant.axes.is_locked(),
            Key::AuxFunctionLock => parts.plant.operator.switches.aux_function_lock,
            Key::DryRun => parts.plant.operator.switches.dry_run,
            Key::Oscillation => parts.plant.oscillation_lamp(),
            Key::DressReturn => parts.manual.dressing.return_active,
            Key::WheelRetract => parts.program.retract.lamp_on(),
            Key::CycleStart => matches!(parts.plant.execution.phase, ControlPhase::Running),
            Key::FeedHold => matches!(parts.plant.execution.phase, ControlPhase::Holding | ControlPhase::Held),
            Key::EmergencyStop => parts.plant.machine.is_e_stopped(),
            Key::Rapid => parts.plant.operator.rapid_jog,
            Key::RapidF0 => parts.plant.operator.overrides.rapid == 0,
            Key::Rapid25 => parts.plant.operator.overrides.rapid == 25,
            Key::Rapid50 => parts.plant.operator.overrides.rapid == 50,
            Key::Rapid100 => parts.plant.operator.overrides.rapid == 100,
            Key::HandwheelX => parts.plant.operator.handwheel_axis == Axis::X,
            Key::HandwheelY => parts.plant.operator.handwheel_axis == Axis::Y,
            Key::HandwheelZ => parts.plant.operator.handwheel_axis == Axis::Z,
            Key::Step0001 => step(0.001),
            Key::Step001 => step(0.01),
            Key::Step01 => step(0.1),
            Key::HeadstockStop => !parts.plant.machine.drive_is_on(),
            Key::SpindleForward => parts.plant.machine.spindle_direction() == Some(false),
            Key::SpindleReverse => parts.plant.machine.spindle_direction() == Some(true),
            Key::SpindleStop => parts.plant.machine.spindle_direction().is_none(),
            Key::ToolTurret => parts.plant.machine.turret_is_moving(),
            _ => Mode::ALL.into_iter().any(|mode| mode.key() == key && mode == parts.plant.operator.mode),
        }
    }

    /// Why a key would have no effect now, if so.
    pub fn key_blocked(&self, parts: PartsView<'_>, key: Key) -> Option<Text> {
        let plant = parts.plant;
        if let Some(reason) = plant.inactive_reason(key) {
            return Some(reason);
        }
        if key == Key::WheelRetract && !plant.params.bit(param::WHEEL_RETRACT) {
            return Some(retract::DISABLED);
        }
        let request = panel_key::machine_request(key, plant.operator.mode, plant.outputs.on)?;
        let rule = plant.machine.blocking_rule(request, plant.now, plant.inputs.filtered, &plant.params);
        rule.map(|rule| rule.reason)
    }
}
