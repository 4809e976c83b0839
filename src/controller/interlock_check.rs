//! Interlock check before a run: finds the blocks that the machine would refuse. The interlock table is evaluated for a
//! machine whose units respond at once. Also checked: missing ports and moves of an oscillating axis.
//! Source: spec K3 (the checker reads the table), K4.3, B3, B4, T4.

use super::plant::system_variables::offset_part_of_variable;
use super::plant::wheel_size::{rated_wheel_rpm, wheel_rpm_of};
use super::plant::{displayed_per_mm, offset_in_range};
use super::program::move_refusal::MoveRefusal;
use super::program::queue::MCall;
use crate::defs::alarm;
use crate::defs::equipment::Equipment;
use crate::defs::kind::Kind;
use crate::defs::mcode::{MCodeAction, Request};
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output};
use crate::defs::system_variable;
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Template, phrase};
use crate::link::edit::OffsetPart;
use crate::machine::interlock::RuleOutcome;
use crate::machine::{ControlState, Machine};
use crate::nc::{
    AxisSet, Block, BlockLocation, CoordinateChange, CutterRangeError, Feed, Op, OpEffect, OscillationChange,
    SpeedMode, WorkOffsets,
};
use crate::units::{Axis, Micros, PerAxis};

/// Longer than the response time of any unit.
const SETTLE_TIME: Micros = Micros::from_millis(600_000);
const TICK: Micros = Micros::from_millis(1);
/// Threshold between off (0) and on (1) when a program writes an output.
const SWITCH_THRESHOLD: f64 = 0.5;
/// Maximum number of reported blocks, and of warnings.
const MAX_REFUSALS: usize = 20;
/// Feedback inputs of outputs; true: active while the output is on.
const FEEDBACK_INPUTS: [(Input, Output, bool); 7] = [
    (Input::HydraulicPressure, Output::Hydraulic, true),
    (Input::TailstockAdvanced, Output::Tailstock, true),
    (Input::TailstockRetracted, Output::Tailstock, false),
    (Input::RadialArmOut, Output::RadialGauge, true),
    (Input::RadialArmIn, Output::RadialGauge, false),
    (Input::AxialArmOut, Output::AxialGauge, true),
    (Input::AxialArmIn, Output::AxialGauge, false),
];
/// Inputs that are active on a machine in order.
const READY_INPUTS: [Input; 3] = [Input::GuardClosed, Input::CoolantFlow, Input::LubricationLevel];

/// A block that the run would refuse, or carry out otherwise than it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictedRefusal {
    /// The block.
    pub at: BlockLocation,
    /// Code, reason and alarm.
    pub text: LocalizedText,
}

/// Follows the operations of a program check, starting from a ready machine (T3).
pub struct InterlockCheck<'a> {
    kind: Kind,
    params: &'a Params,
    machine: Machine,
    now: Micros,
    wheel_speed: (f64, SpeedMode),
    wheel_rpm_limit: Option<f64>,
    wheel_diameter_mm: f64,
    oscillating: Option<Axis>,
    refusals: Vec<PredictedRefusal>,
    warnings: Vec<PredictedRefusal>,
    told_of_turns: bool,
    /// The last block; none once the program has ended by its code.
    last: Option<BlockLocation>,
}

impl<'a> InterlockCheck<'a> {
    /// A machine of a kind with these parameters, ready to run.
    #[must_use]
    pub fn new(kind: Kind, params: &'a Params) -> Self {
        let mut machine = Machine::new(kind, Micros::ZERO);
        machine.make_ready(params);
        let mut check = Self {
            kind,
            params,
            machine,
            now: Micros::ZERO,
            wheel_speed: (params.get(param::WHEEL_RPM), SpeedMode::Rpm),
            wheel_rpm_limit: None,
            wheel_diameter_mm: params.get(param::WHEEL_DIAMETER),
            oscillating: None,
            refusals: Vec::new(),
            warnings: Vec::new(),
            told_of_turns: false,
            last: None,
        };
        check.settle();
        check
    }

    /// Checks a block that was read.
    pub fn check_block(&mut self, block: &Block) {
        self.last = Some(block.location);
        for op in &block.ops {
            if let Some(text) = self.check_op(op) {
                add(&mut self.refusals, block.location, text);
            }
            let warning = match op.effect() {
                OpEffect::Speed(..) => self.speed_warning(),
                OpEffect::Motion(_) => self.feed_warning(op),
                _ => None,
            };
            if let Some(text) = warning {
                add(&mut self.warnings, block.location, text);
            }
        }
    }

    /// The refusals, and the blocks that are carried out otherwise than written, both in program order. `is_complete`: the
    /// program was followed to the end of its text.
    #[must_use]
    pub fn into_findings(mut self, is_complete: bool) -> [Vec<PredictedRefusal>; 2] {
        if is_complete {
            let warning = self.end_warning();
            self.warnings.extend(warning);
        }
        [self.refusals, self.warnings]
    }

    /// A text that ends without M30 leaves on what M30 switches off.
    fn end_warning(&mut self) -> Option<PredictedRefusal> {
        let at = self.last?;
        let on = self.machine.outputs(self.params);
        self.machine.program_end(self.params);
        self.settle();
        let off = self.machine.outputs(self.params);
        let output = on.iter().find(|output| !off.has(*output))?;
        let text = phrase!(
            "程序没有结束代码 (M30 M02)：{output} 不会关",
            "the program has no end code (M30, M02): {output} stays on",
            output
        );
        Some(PredictedRefusal { at, text })
    }

    /// A feed per revolution counts the turns of the workpiece, which the program has not started: said once. The operator
    /// may have started it by its key.
    fn feed_warning(&mut self, op: &Op) -> Option<LocalizedText> {
        let per_turn = matches!(op, Op::Feed { feed: Feed::PerRev(_), .. } | Op::Arc { feed: Feed::PerRev(_), .. });
        if !per_turn || self.machine.drive_is_on() || std::mem::replace(&mut self.told_of_turns, true) {
            return None;
        }
        let turned_by_head = self.kind.row().has(Equipment::Headstock);
        self.kind.row().has(Equipment::Wheel).then(|| match turned_by_head {
            true => phrase!(
                "每转进给 (G99) 需要工件转动：先用 M63 启动",
                "the feed per revolution (G99) counts turns of the workpiece: start it with M63 before"
            ),
            false => phrase!(
                "每转进给 (G95) 需要 M63 的驱动转动：先启动",
                "the feed per revolution (G95) counts turns of the drive of M63: start it before"
            ),
        })
    }

    /// S above what the wheel can or may turn at. Above its rating the wheel is not started; one that turns is held there.
    fn speed_warning(&self) -> Option<LocalizedText> {
        if !self.kind.row().has(Equipment::Wheel) {
            return None;
        }
        let rpm = wheel_rpm_of(self.wheel_speed, self.wheel_rpm_limit, self.wheel_diameter_mm);
        let most = self.params.get(param::WHEEL_RPM_MAX);
        let rated = rated_wheel_rpm(self.params, self.wheel_diameter_mm);
        let turns = self.machine.outputs(self.params).has(Output::Wheel);
        if turns && rpm.min(most) > rated {
            return Some(phrase!(
                "S 为 {rpm:.0} r/min，超过砂轮额定线速度，按 {rated:.0} r/min 运行 (P77 P79)",
                "S is {rpm:.0} r/min, above the wheel's rating: the wheel runs at {rated:.0} r/min (P77, P79)",
                rpm,
                rated
            ));
        }
        (rpm > most).then(|| {
            phrase!(
                "S 为 {rpm:.0} r/min，超过 P64，按 {most:.0} r/min 运行",
                "S is {rpm:.0} r/min, above P64: the wheel runs at {most:.0} r/min",
                rpm,
                most
            )
        })
    }

    fn check_op(&mut self, op: &Op) -> Option<LocalizedText> {
        let effect = op.effect();
        match effect {
            OpEffect::Motion(_) | OpEffect::IndexTurret { .. } => self.check_axes(effect.named_axes()),
            OpEffect::MCode(words) => MCall::new(self.kind.dialect(), &words).and_then(|call| self.m_code(call)),
            OpEffect::SystemVariable(number, value) => self.check_system_variable(number, value.unwrap_or(0.0)),
            OpEffect::Speed(value, mode) => {
                self.wheel_speed = (value, mode);
                self.update_control_state();
                None
            }
            OpEffect::SpeedLimit(rpm) => {
                self.wheel_rpm_limit = Some(rpm);
                self.update_control_state();
                None
            }
            OpEffect::Oscillation(OscillationChange::Axis { axis, .. }) => {
                let refused = self.oscillating_refusal(axis);
                self.oscillating = Some(axis);
                refused
            }
            OpEffect::Oscillation(OscillationChange::Cylinder { .. }) => {
                self.request(Request::CylinderOn, "G35".into())
            }
            OpEffect::Oscillation(OscillationChange::Off) => {
                self.oscillating = None;
                None
            }
            OpEffect::Coordinates(CoordinateChange::Set(values)) => {
                let set = |axis: &Axis| values[*axis].is_some();
                self.oscillating.filter(set).and_then(|axis| self.oscillating_refusal(axis))
            }
            OpEffect::Coordinates(CoordinateChange::AddWear { by, .. }) => self.check_wear(&by),
            OpEffect::Coordinates(_) | OpEffect::PathMode(_) | OpEffect::Dwell(_) => None,
            OpEffect::Variable(..) | OpEffect::Message(_) => None,
        }
    }

    /// K4.1: one G10 adds no more than an offset may hold; what it holds is known in the run only.
    fn check_wear(&self, by: &PerAxis<f64>) -> Option<LocalizedText> {
        let shown = |axis: Axis| by[axis] * displayed_per_mm(self.params, axis);
        let axis = Axis::ALL.into_iter().find(|axis| !offset_in_range(OffsetPart::Wear, shown(*axis)))?;
        Some(with_alarm(alarm::OFFSET_RANGE, MoveRefusal::WearOutOfRange(axis, by[axis]).text(self.params)))
    }

    fn check_axes(&self, words: AxisSet) -> Option<LocalizedText> {
        self.oscillating.filter(|axis| words.contains(*axis)).and_then(|axis| self.oscillating_refusal(axis))
    }

    fn oscillating_refusal(&self, asked: Axis) -> Option<LocalizedText> {
        let axis = self.oscillating?;
        let text = phrase!(
            "{asked}：{axis} 轴在振荡中，先用 G36 关闭",
            "{asked}: {axis} is oscillating, stop it with G36 first",
            asked,
            axis
        );
        Some(with_alarm(alarm::AXIS_OSCILLATES, text))
    }

    fn m_code(&mut self, call: MCall) -> Option<LocalizedText> {
        let name = Arg::from(format_args!("M{:02}", call.row.code));
        match call.row.action {
            MCodeAction::AwaitInput(input) if self.params.input_port(input) == 0 => {
                let text = phrase!("{name}：{input} 没有输入口", "{name}: {input} has no port", name, input);
                Some(with_alarm(alarm::INPUT_NOT_ASSIGNED, text))
            }
            MCodeAction::ProgramEnd => {
                self.last = None;
                self.machine.program_end(self.params);
                self.settle();
                None
            }
            _ => call.request().and_then(|request| self.request(request, name)),
        }
    }

    /// Requests a change of the machine and lets it settle.
    fn request(&mut self, request: Request, name: Arg) -> Option<LocalizedText> {
        let inputs = self.inputs();
        if let Some(rule) = self.machine.blocking_rule(request, self.now, inputs, self.params) {
            let reason = self.machine.reason_text(&rule.reason, request, self.params);
            let text = LocalizedText::phrase_of(REFUSED, [name], [reason]);
            return match rule.outcome {
                RuleOutcome::NoEffect => None,
                RuleOutcome::Deny => Some(text),
                RuleOutcome::Alarm(number) => Some(with_alarm(number, text)),
            };
        }
        self.machine.request(request, self.now, inputs, self.params);
        self.settle();
        None
    }

    /// A program writes a system variable.
    fn check_system_variable(&mut self, number: u32, value: f64) -> Option<LocalizedText> {
        if let Some(index) = system_variable::OUTPUTS.index(number) {
            let request = Request::Port(index as u8 + 1, value.abs() >= SWITCH_THRESHOLD);
            return self.request(request, format_args!("#{number}").into());
        }
        if let Some(Err(CutterRangeError)) = WorkOffsets::default().set_cutter_variable(number, value) {
            return Some(with_alarm(
                alarm::OFFSET_RANGE,
                phrase!("#{number} = {value}", "#{number} = {value}", number, value),
            ));
        }
        if let Some(part) = offset_part_of_variable(number).filter(|part| !offset_in_range(*part, value)) {
            let most = part.max_abs();
            let text = phrase!("#{number} = {value} (±{most})", "#{number} = {value} (±{most})", number, value, most);
            return Some(with_alarm(alarm::OFFSET_RANGE, text));
        }
        if number == system_variable::WHEEL_DIAMETER.first {
            if value > self.wheel_diameter_mm || value < param::WHEEL_DIAMETER.min {
                let before = self.wheel_diameter_mm;
                let text = phrase!(
                    "#{number} = {value:.4}，现直径 {before:.4}",
                    "#{number} = {value:.4}, current diameter {before:.4}",
                    number,
                    value,
                    before
                );
                return Some(with_alarm(alarm::WHEEL_DIAMETER_REFUSED, text));
            }
            self.wheel_diameter_mm = value;
            self.update_control_state();
        }
        None
    }

    /// Advances the time until every request is finished.
    fn settle(&mut self) {
        for wait in [TICK, SETTLE_TIME, TICK] {
            self.now = self.now + wait;
            let (inputs, state) = (self.inputs(), self.control_state());
            self.machine.tick(self.now, inputs, self.params, state);
        }
    }

    fn update_control_state(&mut self) {
        let state = self.control_state();
        self.machine.set_control_state(state);
    }

    fn control_state(&self) -> ControlState {
        let wheel_rpm = wheel_rpm_of(self.wheel_speed, self.wheel_rpm_limit, self.wheel_diameter_mm)
            .min(self.params.get(param::WHEEL_RPM_MAX));
        ControlState { homed: true, run_open: true, wheel_rpm, ..ControlState::default() }
    }

    fn inputs(&self) -> InputSet {
        let on = self.machine.outputs(self.params);
        let mut inputs = InputSet::NONE;
        FEEDBACK_INPUTS.iter().for_each(|(input, output, with)| inputs.set(*input, on.has(*output) == *with));
        READY_INPUTS.iter().for_each(|input| inputs.set(*input, true));
        for (input, output) in Input::GEARS.into_iter().zip(Output::GEARS) {
            inputs.set(input, on.has(output));
        }
        inputs
    }
}

/// Adds a finding, one for a block.
fn add(found: &mut Vec<PredictedRefusal>, at: BlockLocation, text: LocalizedText) {
    if found.len() < MAX_REFUSALS && !found.iter().any(|other| other.at == at) {
        found.push(PredictedRefusal { at, text });
    }
}

const REFUSED: &Template = &Template::new("{name}：{reason}", "{name}: {reason}", &["name", "reason"]);
const WITH_ALARM: &Template = &Template::new("{text} (报警 {number})", "{text} (alarm {number})", &["number", "text"]);

fn with_alarm(number: u16, text: LocalizedText) -> LocalizedText {
    LocalizedText::phrase_of(WITH_ALARM, [number.into()], [text])
}
