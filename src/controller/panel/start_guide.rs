//! What is still missing for the next cycle start: the rules of the interlock table that forbid it, the program and its
//! values, the mode. Read-only.
//! Source: spec K2.2, K3, K5.13, K5.17, B5, H7.

use super::PartsView;
use crate::controller::plant::{ControlPhase, Plant};
use crate::controller::program::start_check::StartVerdict;
use crate::defs::equipment::Equipment;
use crate::defs::key::{Key, Mode};
use crate::defs::mcode::Request;
use crate::defs::page::Page;
use crate::defs::signal::{Input, Output};
use crate::defs::start_step::StartStep;
use crate::defs::text::{LocalizedText, phrase};
use crate::link::start_guide::{StartGuide, StepAction, StepState, StepView};
use crate::machine::interlock::InterlockInputs;
use crate::units::Axis;

const COUNT: usize = StartStep::ALL.len();

/// Fills the guide; all conditions are absent while a run is open, and while a start from a block is prepared, which
/// has conditions of its own.
pub fn fill(parts: PartsView<'_>, guide: &mut StartGuide) {
    let open = parts.program.is_open() || parts.plant.execution.phase.is_run_open() || parts.program.restart.is_some();
    let conditions = (!open).then(|| Conditions::new(parts));
    for (step, place) in StartStep::ALL.into_iter().zip(&mut guide.steps) {
        let view = conditions.as_ref().map(|conditions| conditions.view(step)).unwrap_or_default();
        if *place != view {
            *place = view;
        }
    }
}

/// The conditions as the machine and the program have them now.
struct Conditions<'a> {
    parts: PartsView<'a>,
    inputs: InterlockInputs,
    /// The first rule of each condition that forbids the start, or what the program starts.
    refused: [Option<LocalizedText>; COUNT],
}

impl<'a> Conditions<'a> {
    fn new(parts: PartsView<'a>) -> Self {
        let plant = parts.plant;
        let (machine, now, inputs, params) = (&plant.machine, plant.now, plant.inputs.filtered, &plant.params);
        let starts = plant.work.programs.started_units(plant.execution.current_program);
        let switches = &plant.operator.switches;
        // With M, S and T locked a program starts nothing, in a dry run not the wheel.
        let (wheel, drive) = (starts.wheel && !switches.dry_run, starts.work_drive);
        let requests = [
            Some(Request::CycleStart),
            Some(Request::WheelStart).filter(|_| wheel && !switches.aux_function_lock),
            Some(Request::WorkDriveHigh).filter(|_| drive && !switches.aux_function_lock),
        ];
        let mut refused = [const { None }; COUNT];
        for request in requests.into_iter().flatten() {
            for rule in machine.unmet_start_rules(request, now, inputs, params) {
                if let Some(step) = rule.step {
                    refused[step as usize].get_or_insert_with(|| rule.reason.into());
                }
            }
        }
        Self { parts, inputs: machine.interlock_inputs(now, inputs, params), refused }
    }

    fn view(&self, step: StartStep) -> StepView {
        let Some(met) = self.is_met(step) else { return StepView::default() };
        let reason = self.refused[step as usize].clone().or_else(|| self.own_reason(step));
        let Some(reason) = reason else {
            let state = if met { StepState::Met } else { StepState::NotNeeded };
            return StepView { state, ..StepView::default() };
        };
        let state = if self.is_pending(step) { StepState::Pending } else { StepState::Missing };
        StepView { state, reason, action: self.action(step) }
    }

    /// Whether a condition is met by itself, whatever the program needs; none: the machine does not have it.
    fn is_met(&self, step: StartStep) -> Option<bool> {
        let (plant, inputs) = (self.parts.plant, &self.inputs);
        match step {
            StartStep::Machine | StartStep::Program | StartStep::Mode => Some(true),
            StartStep::Guard => (plant.params.input_port(Input::GuardClosed) != 0).then_some(!inputs.guard_open),
            StartStep::Hydraulics => {
                let pressure = inputs.pressure || !inputs.hydraulic_checked;
                inputs.hydraulic_needed.then_some(inputs.hydraulic_on && inputs.hydraulic_settled && pressure)
            }
            StartStep::Homing => (!plant.kind.row().may_start_unhomed()).then(|| plant.axes.all_homed()),
            StartStep::Tailstock => inputs.tailstock_enabled.then_some(inputs.tailstock_advanced),
            StartStep::Magnet => (inputs.magnet_on_kind && inputs.magnet_enabled).then_some(inputs.magnetised),
            StartStep::Wheel => plant.kind.row().has(Equipment::Wheel).then_some(true),
            StartStep::Values => (!plant.kind.is_lathe()).then_some(true),
        }
    }

    /// What no rule of the interlock table says.
    fn own_reason(&self, step: StartStep) -> Option<LocalizedText> {
        let plant = self.parts.plant;
        let number = plant.execution.current_program;
        match step {
            StartStep::Machine => None,
            StartStep::Program if plant.work.programs.get(number).is_none() => {
                Some(phrase!("先在目录中选择程序", "choose a program in the directory"))
            }
            StartStep::Program => match self.parts.program.start_verdict(plant) {
                StartVerdict::Faulty(text) => Some(text.clone()),
                StartVerdict::Unknown | StartVerdict::Accepted | StartVerdict::RefusesValue(..) => None,
            },
            StartStep::Values => match self.parts.program.start_verdict(plant) {
                StartVerdict::RefusesValue(text, _) => Some(text.clone()),
                StartVerdict::Unknown if plant.work.programs.get(number).is_some() => {
                    Some(phrase!("正在读程序开头", "the head of the program is being read"))
                }
                StartVerdict::Unknown | StartVerdict::Accepted | StartVerdict::Faulty(_) => None,
            },
            StartStep::Mode if plant.operator.mode != Mode::Auto => {
                Some(phrase!("按 自动 键：循环启动在自动方式下", "press AUTO: cycle start works in mode AUTO"))
            }
            StartStep::Mode => self.parts.program.retract_start_block(plant),
            StartStep::Guard | StartStep::Hydraulics | StartStep::Homing => None,
            StartStep::Tailstock | StartStep::Magnet | StartStep::Wheel => None,
        }
    }

    fn is_pending(&self, step: StartStep) -> bool {
        let plant = self.parts.plant;
        match step {
            StartStep::Machine => self.inputs.control_state.drives_switching,
            StartStep::Hydraulics => self.inputs.hydraulic_on && !self.inputs.hydraulic_settled,
            StartStep::Homing => matches!(plant.execution.phase, ControlPhase::Homing(_)),
            StartStep::Tailstock => self.inputs.tailstock_moving,
            StartStep::Magnet => plant.machine.awaits_feedback(Output::Magnetise),
            StartStep::Values => *self.parts.program.start_verdict(plant) == StartVerdict::Unknown,
            StartStep::Guard | StartStep::Wheel | StartStep::Program | StartStep::Mode => false,
        }
    }

    /// What the operator does for a condition that is not met.
    fn action(&self, step: StartStep) -> Option<StepAction> {
        let (plant, inputs) = (self.parts.plant, &self.inputs);
        let verdict = self.parts.program.start_verdict(plant);
        match step {
            StartStep::Machine if plant.inputs.screen_e_stop() => Some(StepAction::PressOnPanel(Key::EmergencyStop)),
            StartStep::Machine if inputs.e_stop || inputs.external_hold => None,
            StartStep::Machine => Some(StepAction::Press(Key::Reset)),
            StartStep::Guard => None,
            StartStep::Hydraulics if inputs.hydraulic_latched => Some(StepAction::Press(Key::Reset)),
            StartStep::Hydraulics if inputs.hydraulic_on => Some(StepAction::Open(Page::Alarm, None)),
            StartStep::Hydraulics => Some(StepAction::Press(Key::Hydraulic)),
            StartStep::Homing if plant.operator.mode != Mode::Home => Some(StepAction::Press(Key::ModeHome)),
            StartStep::Homing => next_homing_key(plant).map(StepAction::PressOnPanel),
            StartStep::Tailstock => Some(StepAction::PressOnPanel(Key::TailstockAdvance)),
            StartStep::Magnet => Some(StepAction::Press(Key::Magnetise)),
            StartStep::Wheel => Some(StepAction::Open(Page::Dressing, None)),
            StartStep::Program if matches!(verdict, StartVerdict::Faulty(_)) => {
                Some(StepAction::Open(Page::Program, None))
            }
            StartStep::Program => Some(StepAction::Open(Page::Directory, None)),
            StartStep::Values => match *verdict {
                StartVerdict::RefusesValue(_, variable) => Some(StepAction::Open(Page::Grinding, variable)),
                StartVerdict::Unknown | StartVerdict::Accepted | StartVerdict::Faulty(_) => None,
            },
            StartStep::Mode if plant.operator.mode != Mode::Auto => Some(StepAction::Press(Key::ModeAuto)),
            StartStep::Mode if self.parts.program.retract_start_block(plant).is_some() => {
                Some(StepAction::PressOnPanel(Key::WheelRetract))
            }
            StartStep::Mode if inputs.control_state.oscillating => Some(StepAction::PressOnPanel(Key::Oscillation)),
            StartStep::Mode if inputs.control_state.dry_run => Some(StepAction::Press(Key::WheelStop)),
            StartStep::Mode => None,
        }
    }
}

/// The key that homes the next axis.
fn next_homing_key(plant: &Plant) -> Option<Key> {
    let axis = plant
        .kind
        .row()
        .home_order
        .iter()
        .copied()
        .find(|axis| plant.axes.is_present(*axis) && !plant.axes.is_homed(*axis))?;
    let plus = plant.home_direction(axis) > 0.0;
    Some(match axis {
        Axis::X if plus => Key::XPlus,
        Axis::X => Key::XMinus,
        Axis::Y if plus => Key::YPlus,
        Axis::Y => Key::YMinus,
        Axis::Z if plus => Key::ZPlus,
        Axis::Z => Key::ZMinus,
    })
}
