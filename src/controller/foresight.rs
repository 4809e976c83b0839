//! Interlock check before a run: finds the blocks that the machine would refuse. The interlock table is evaluated for a
//! machine whose units respond at once. Also checked: missing ports and moves of an oscillating axis.
//! Source: spec K3 (the checker reads the table), K4.3, B3, B4, T4.

use super::offsets::in_range;
use super::run::MCall;
use super::system::offset_of_variable;
use super::wheel_size::rpm_of;
use crate::defs::alarm;
use crate::defs::kind::Kind;
use crate::defs::mcode::{self, Action, Request};
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output};
use crate::defs::text::Said;
use crate::defs::variable;
use crate::machine::interlock::Outcome;
use crate::machine::kind::{KindRow, find};
use crate::machine::{Around, Machine};
use crate::nc::{AxisSet, Block, Op, Place, SpeedMode};
use crate::units::{Axis, Micros};

/// Longer than the response time of any unit.
const LONG: Micros = Micros::from_millis(600_000);
const TICK: Micros = Micros::from_millis(1);
/// Threshold between off (0) and on (1) when a program writes an output.
const HALF: f64 = 0.5;
/// Maximum number of reported blocks.
const MOST: usize = 20;
/// Feedback inputs of outputs; true: active while the output is on.
const FOLLOW: [(Input, Output, bool); 7] = [
    (Input::HydraulicPressure, Output::Hydraulic, true),
    (Input::TailstockAdvanced, Output::Tailstock, true),
    (Input::TailstockRetracted, Output::Tailstock, false),
    (Input::RadialArmOut, Output::RadialGauge, true),
    (Input::RadialArmIn, Output::RadialGauge, false),
    (Input::AxialArmOut, Output::AxialGauge, true),
    (Input::AxialArmIn, Output::AxialGauge, false),
];
/// Inputs that are active on a machine in order.
const THERE: [Input; 3] = [Input::GuardClosed, Input::CoolantFlow, Input::LubricationLevel];

/// A block that the run would refuse.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreseen {
    /// The block.
    pub at: Place,
    /// Code, reason and alarm.
    pub said: Said,
}

/// Follows the operations of a program check, starting from a ready machine (T3).
pub struct Foresight<'a> {
    row: &'static KindRow,
    params: &'a Params,
    machine: Machine,
    now: Micros,
    wheel_speed: (f64, SpeedMode),
    wheel_rpm_limit: Option<f64>,
    wheel_diameter_mm: f64,
    oscillating: Option<Axis>,
    found: Vec<Foreseen>,
}

impl<'a> Foresight<'a> {
    /// A machine of a kind with these parameters, ready to run.
    #[must_use]
    pub fn new(kind: Kind, params: &'a Params) -> Self {
        let row = find(kind);
        let mut machine = Machine::new(row, Micros::ZERO);
        machine.make_ready(params);
        let mut foresight = Self {
            row,
            params,
            machine,
            now: Micros::ZERO,
            wheel_speed: (params.get(param::WHEEL_RPM), SpeedMode::Rpm),
            wheel_rpm_limit: None,
            wheel_diameter_mm: params.get(param::WHEEL_DIAMETER),
            oscillating: None,
            found: Vec::new(),
        };
        foresight.settle();
        foresight
    }

    /// Checks a block that was read.
    pub fn see(&mut self, block: &Block) {
        for op in &block.ops {
            let Some(said) = self.refusal(op) else { continue };
            let told = self.found.len() >= MOST || self.found.iter().any(|found| found.at == block.at);
            if !told {
                self.found.push(Foreseen { at: block.at, said });
            }
        }
    }

    /// The refusals, in program order.
    #[must_use]
    pub fn found(self) -> Vec<Foreseen> {
        self.found
    }

    fn refusal(&mut self, op: &Op) -> Option<Said> {
        match op {
            Op::M { code, s, p, l } => {
                let row = mcode::find_in(self.row.system, u16::from(*code))?;
                let call = MCall { row, s: *s, p: p.unwrap_or(0.0) as u8, l_ms: l.unwrap_or(0.0) as u32 };
                self.m_code(call)
            }
            Op::SetSystem { number, value } => self.write(*number, value.unwrap_or(0.0)),
            Op::S { value, mode } => {
                self.wheel_speed = (*value, *mode);
                self.inform();
                None
            }
            Op::SpeedLimit { rpm } => {
                self.wheel_rpm_limit = Some(*rpm);
                self.inform();
                None
            }
            Op::OscillationOn { stroke: Some((axis, _)), .. } => {
                let refused = self.oscillates(*axis);
                self.oscillating = Some(*axis);
                refused
            }
            Op::OscillationOn { stroke: None, .. } => self.ask(Request::CylinderOn, "G35"),
            Op::OscillationOff => {
                self.oscillating = None;
                None
            }
            Op::Rapid { words, .. }
            | Op::Feed { words, .. }
            | Op::Arc { words, .. }
            | Op::Skip { words, .. }
            | Op::Reference { words, .. }
            | Op::DressReturn { axes: words, .. } => self.words(*words),
            Op::MachineMove { to, .. } => {
                let mut words = AxisSet::NONE;
                to.iter().filter(|(_, to)| to.is_some()).for_each(|(axis, _)| words.insert(axis));
                self.words(words)
            }
            _ => None,
        }
    }

    fn words(&self, words: AxisSet) -> Option<Said> {
        self.oscillating.filter(|axis| words.contains(*axis)).and_then(|axis| self.oscillates(axis))
    }

    fn oscillates(&self, asked: Axis) -> Option<Said> {
        let axis = self.oscillating?;
        Some(with_alarm(
            alarm::OSCILLATING_AXIS,
            format!("{asked}：{axis} 轴在振荡中，先用 G36 关闭"),
            format!("{asked}: {axis} oscillates, end it with G36 first"),
        ))
    }

    fn m_code(&mut self, call: MCall) -> Option<Said> {
        let name = format!("M{:02}", call.row.code);
        match call.row.action {
            Action::AwaitInput(input) if self.params.input_port(input) == 0 => {
                let said = input.name();
                let (zh, en) = (format!("{name}：{} 没有输入口", said.zh), format!("{name}: {} has no port", said.en));
                Some(with_alarm(alarm::INPUT_MISSING, zh, en))
            }
            Action::End => {
                self.machine.program_end(self.params);
                self.settle();
                None
            }
            _ => call.request().and_then(|request| self.ask(request, &name)),
        }
    }

    /// Requests a change of the machine and lets it settle.
    fn ask(&mut self, request: Request, name: &str) -> Option<Said> {
        let inputs = self.inputs();
        if let Some(rule) = self.machine.forbidding(request, self.now, inputs, self.params) {
            let reason = self.machine.reason(rule.reason, request, self.params);
            let (zh, en) = (format!("{name}：{}", reason.zh), format!("{name}: {}", reason.en));
            return match rule.outcome {
                Outcome::NoEffect => None,
                Outcome::Deny => Some(Said::new(zh, en)),
                Outcome::Alarm(number) => Some(with_alarm(number, zh, en)),
            };
        }
        self.machine.ask(request, self.now, inputs, self.params);
        self.settle();
        None
    }

    /// A program writes a system variable.
    fn write(&mut self, number: u32, value: f64) -> Option<Said> {
        if let Some(index) = variable::OUTPUTS.index(number) {
            return self.ask(Request::Port(index as u8 + 1, value.abs() >= HALF), &format!("#{number}"));
        }
        if let Some(part) = offset_of_variable(number).filter(|part| !in_range(*part, value)) {
            let most = part.most();
            let range = format!("#{number} = {value} (±{most})");
            return Some(with_alarm(alarm::OFFSET_RANGE, range.clone(), range));
        }
        if number == variable::WHEEL_DIAMETER.first {
            if value > self.wheel_diameter_mm || value < param::WHEEL_DIAMETER.min {
                let before = self.wheel_diameter_mm;
                let zh = format!("#{number} = {value:.4}，现直径 {before:.4}");
                return Some(with_alarm(
                    alarm::WHEEL_SIZE,
                    zh,
                    format!("#{number} = {value:.4}, the wheel has {before:.4}"),
                ));
            }
            self.wheel_diameter_mm = value;
            self.inform();
        }
        None
    }

    /// Advances the time until every request is finished.
    fn settle(&mut self) {
        for wait in [TICK, LONG, TICK] {
            self.now = self.now + wait;
            let (inputs, around) = (self.inputs(), self.around());
            self.machine.tick(self.now, inputs, self.params, around);
        }
    }

    fn inform(&mut self) {
        let around = self.around();
        self.machine.inform(around);
    }

    fn around(&self) -> Around {
        let wheel_rpm = rpm_of(self.wheel_speed, self.wheel_rpm_limit, self.wheel_diameter_mm)
            .min(self.params.get(param::WHEEL_RPM_MAX));
        Around { homed: true, run_open: true, wheel_rpm, ..Around::default() }
    }

    fn inputs(&self) -> InputSet {
        let on = self.machine.outputs(self.params);
        let mut inputs = InputSet::NONE;
        FOLLOW.iter().for_each(|(input, output, with)| inputs.set(*input, on.has(*output) == *with));
        THERE.iter().for_each(|input| inputs.set(*input, true));
        for (input, output) in Input::GEARS.into_iter().zip(Output::GEARS) {
            inputs.set(input, on.has(output));
        }
        inputs
    }
}

fn with_alarm(number: u16, zh: String, en: String) -> Said {
    Said::new(format!("{zh} (报警 {number})"), format!("{en} (alarm {number})"))
}
