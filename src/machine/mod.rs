//! The machine's units – wheel, workpiece drive, tailstock, hydraulics, fluids – and the rules between them.
//!
//! Owns what is switched on and what is under way; knows neither program nor axes. Whoever wants a change asks
//! ([`Machine::ask`]); the interlock table answers.
//! Source: spec K3, K5.

mod hydraulic;
pub mod interlock;
pub mod kind;
mod tailstock;

use crate::defs::alarm;
use crate::defs::mcode::Request;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::defs::text::Text;
use crate::units::Micros;
use hydraulic::Hydraulic;
use interlock::{Facts, Outcome};
use kind::KindRow;
use tailstock::Tailstock;

/// What came of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Done, or under way: [`Machine::is_settled`] tells when it is finished.
    Taken,
    /// A message, nothing else; the program goes on.
    NoEffect(Text),
    /// A message; nothing changed; a program waits before the block.
    Denied(Text),
    /// An alarm; nothing changed.
    Refused(u16, Text),
}

/// The wheel contactor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wheel {
    Off,
    RunUp { since: Micros },
    Running,
}

/// Headstock, dresser roll or table, whichever the kind has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drive {
    Off,
    RunUp { fast: bool, since: Micros },
    Running { fast: bool },
}

impl Drive {
    const fn speed(self) -> Option<bool> {
        match self {
            Self::Off => None,
            Self::RunUp { fast, .. } | Self::Running { fast } => Some(fast),
        }
    }
}

/// What the controller tells the machine logic about itself each tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Around {
    /// A program or an MDI line is under way, held ones included.
    pub run_open: bool,
    /// Every axis that the kind has is homed.
    pub homed: bool,
    /// An alarm that blocks cycle start is present.
    pub alarm_blocks: bool,
    /// The drives are off after an alarm that stopped everything.
    pub drives_off: bool,
    /// An axis oscillates that the run did not start.
    pub oscillating: bool,
}

/// Something that the machine logic found by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// An alarm's condition came.
    Alarm {
        /// Its number.
        number: u16,
        /// Whether it ends the run and stops the wheel.
        stopped: bool,
    },
    /// A self-clearing alarm's condition is gone.
    Gone(u16),
}

/// All units of one machine.
#[derive(Clone, Debug)]
pub struct Machine {
    row: &'static KindRow,
    wheel: Wheel,
    drive: Drive,
    tailstock: Tailstock,
    hydraulic: Hydraulic,
    /// Outputs without a sequence of their own: fluids, gauges, user outputs.
    plain: OutputSet,
    e_stop: bool,
    around: Around,
}

/// Outputs that an emergency stop, a panic, a lost screen or a lost bus leave as they are: a part must not fly while the
/// wheel coasts (table after K3).
pub const KEPT_WHEN_SAFE: &[Output] =
    &[Output::Hydraulic, Output::Magnetise, Output::Tailstock, Output::Lubrication, Output::TowerRed];

/// Findings of one tick: at most the e-stop, the hydraulics and the tailstock.
pub type Findings = [Option<Finding>; 3];

impl Machine {
    /// A machine at power-on: everything off.
    #[must_use]
    pub fn new(row: &'static KindRow, now: Micros) -> Self {
        Self {
            row,
            wheel: Wheel::Off,
            drive: Drive::Off,
            tailstock: Tailstock::Resting,
            hydraulic: Hydraulic::new(now),
            plain: OutputSet::NONE,
            e_stop: false,
            around: Around::default(),
        }
    }

    /// Puts the machine where a headless run begins (tools.md T3): hydraulics on long enough, tailstock advanced.
    pub fn make_ready(&mut self, params: &Params) {
        self.hydraulic.make_ready();
        if params.bit(param::TAILSTOCK_ENABLED) {
            self.tailstock = Tailstock::Holding;
        }
    }

    /// The facts that the interlock rules read.
    #[must_use]
    pub fn facts(&self, now: Micros, inputs: InputSet, params: &Params) -> Facts {
        let supervised = !params.bit(param::NO_HYDRAULIC_CHECK);
        Facts {
            e_stop: self.e_stop,
            wheel_on: self.wheel != Wheel::Off,
            drive_on: self.drive != Drive::Off,
            tailstock_enabled: params.bit(param::TAILSTOCK_ENABLED) && self.row.tailstock,
            tailstock_moving: self.tailstock.is_moving(),
            tailstock_needed: params.bit(param::TAILSTOCK_BEFORE_HEADSTOCK),
            tailstock_advanced: self.tailstock.is_advanced(),
            hydraulic_needed: supervised,
            hydraulic_checked: supervised && params.get(param::HYDRAULIC_DELAY) > 0.0,
            hydraulic_on: self.hydraulic.is_on(),
            hydraulic_latched: self.hydraulic.is_latched(),
            hydraulic_settled: self.hydraulic.is_settled(now, params),
            pressure: inputs.has(Input::HydraulicPressure),
            magnet_needed: params.bit(param::WHEEL_NEEDS_MAGNET),
            magnetised: self.plain.has(Output::Magnetise),
            around: self.around,
        }
    }

    /// Asks for a change. The interlock table decides; a refused request changes nothing.
    pub fn ask(&mut self, request: Request, now: Micros, inputs: InputSet, params: &Params) -> Answer {
        let facts = self.facts(now, inputs, params);
        if let Some(rule) = interlock::forbidding(request, &facts) {
            return match rule.outcome {
                Outcome::NoEffect => Answer::NoEffect(rule.reason),
                Outcome::Deny => Answer::Denied(rule.reason),
                Outcome::Alarm(number) => {
                    if number == alarm::HYDRAULIC {
                        self.hydraulic.note_refused_start();
                    }
                    Answer::Refused(number, rule.reason)
                }
            };
        }
        self.carry_out(request, now);
        Answer::Taken
    }

    fn carry_out(&mut self, request: Request, now: Micros) {
        match request {
            Request::WheelStart if self.wheel == Wheel::Off => self.wheel = Wheel::RunUp { since: now },
            Request::WheelStart | Request::CycleStart | Request::HomeAxes | Request::MoveByHand => {}
            Request::WheelStop => self.wheel = Wheel::Off,
            Request::DriveHigh | Request::DriveLow => {
                let fast = request == Request::DriveHigh;
                if self.drive.speed() != Some(fast) {
                    self.drive = Drive::RunUp { fast, since: now };
                }
            }
            Request::DriveStop => self.drive = Drive::Off,
            Request::TailstockAdvance => self.tailstock.advance(now),
            Request::TailstockRetract => self.tailstock.retract(now),
            Request::HydraulicOn => self.hydraulic.switch_on(now),
            Request::HydraulicOff => self.hydraulic.switch_off(),
            Request::Magnetise => self.plain.set(Output::Magnetise, true),
            Request::Demagnetise => self.plain.set(Output::Magnetise, false),
            Request::Switch(output, on) => self.plain.set(output, on),
        }
    }

    /// Whether the unit of a request has finished what it was asked.
    #[must_use]
    pub fn is_settled(&self, request: Request) -> bool {
        match request {
            Request::WheelStart => self.wheel == Wheel::Running,
            Request::DriveHigh | Request::DriveLow => matches!(self.drive, Drive::Running { .. }),
            Request::TailstockAdvance | Request::TailstockRetract => !self.tailstock.is_moving(),
            Request::WheelStop
            | Request::DriveStop
            | Request::HydraulicOn
            | Request::HydraulicOff
            | Request::Magnetise
            | Request::Demagnetise
            | Request::Switch(..)
            | Request::CycleStart
            | Request::HomeAxes
            | Request::MoveByHand => true,
        }
    }

    /// One tick: delays run, feedback arrives, supervision looks.
    pub fn tick(&mut self, now: Micros, inputs: InputSet, params: &Params, around: Around) -> Findings {
        self.around = around;
        let e_stop = inputs.has(Input::EmergencyStop);
        let pressed = e_stop && !self.e_stop;
        self.e_stop = e_stop;
        if e_stop {
            self.safe_stop();
        }
        self.run_up(now, params);
        let hydraulic = self.hydraulic.supervise(now, inputs, params, self.wheel != Wheel::Off, around.run_open);
        if let Some(Finding::Alarm { stopped: true, .. }) = hydraulic {
            self.wheel = Wheel::Off; // K3.7: in the tick of the filtered edge
        }
        let tailstock =
            self.tailstock.watch(now, inputs, params).map(|number| Finding::Alarm { number, stopped: true });
        let pressed = pressed.then_some(Finding::Alarm { number: alarm::EMERGENCY_STOP, stopped: true });
        [pressed, hydraulic, tailstock]
    }

    fn run_up(&mut self, now: Micros, params: &Params) {
        if let Wheel::RunUp { since } = self.wheel
            && now.since(since) >= Micros::from_millis_f64(params.get(param::WHEEL_RUN_UP))
        {
            self.wheel = Wheel::Running;
        }
        if let Drive::RunUp { fast, since } = self.drive
            && now.since(since) >= Micros::from_millis_f64(params.get(param::HEADSTOCK_RUN_UP))
        {
            self.drive = Drive::Running { fast };
        }
    }

    /// E-stop, panic, lost HMI or bus: what turns or flows is switched off, what clamps stays (table after K3).
    pub fn safe_stop(&mut self) {
        self.wheel = Wheel::Off;
        self.drive = Drive::Off;
        for output in [
            Output::Coolant,
            Output::SecondSpindle,
            Output::SecondSpindleCcw,
            Output::OscillationForward,
            Output::OscillationBackward,
        ] {
            self.plain.set(output, false);
        }
    }

    /// Reset: the workpiece drive stops; wheel, fluids, hydraulics and clamping stay (table after K3).
    pub fn reset(&mut self) {
        self.drive = Drive::Off;
        self.hydraulic.acknowledge();
    }

    /// An alarm that stops the wheel as well.
    pub fn stop_wheel_and_drive(&mut self) {
        self.wheel = Wheel::Off;
        self.drive = Drive::Off;
    }

    /// M30 (K3.14): coolant and workpiece drive off, the wheel too unless P17.2 keeps it.
    pub fn program_end(&mut self, params: &Params) {
        self.plain.set(Output::Coolant, false);
        self.drive = Drive::Off;
        if !params.bit(param::WHEEL_RUNS_AFTER_M30) {
            self.wheel = Wheel::Off;
        }
    }

    /// The outputs by function.
    #[must_use]
    pub fn outputs(&self) -> OutputSet {
        let mut on = self.plain;
        on.set(Output::Wheel, self.wheel != Wheel::Off);
        on.set(Output::Tailstock, self.tailstock.output());
        on.set(Output::Hydraulic, self.hydraulic.is_on());
        if let Some(fast) = self.drive.speed() {
            on.set(self.row.drive_output(fast), true);
        }
        on
    }

    /// Whether headstock, roll or table is switched on.
    #[must_use]
    pub fn drive_is_on(&self) -> bool {
        self.drive != Drive::Off
    }

    /// Whether the emergency stop is pressed.
    #[must_use]
    pub const fn is_e_stopped(&self) -> bool {
        self.e_stop
    }

    /// Whether the feedback of a switched-on output is still awaited; its lamp blinks.
    #[must_use]
    pub fn is_working(&self, output: Output) -> bool {
        match output {
            Output::Wheel => matches!(self.wheel, Wheel::RunUp { .. }),
            Output::Tailstock => self.tailstock.is_moving(),
            Output::HeadstockHigh | Output::HeadstockLow | Output::DresserRoll | Output::TableRotation => {
                matches!(self.drive, Drive::RunUp { fast, .. } if self.row.drive_output(fast) == output)
            }
            _ => false,
        }
    }
}
