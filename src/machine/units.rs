//! Executes granted requests; reports outputs, pending feedback (blinking lamps) and whether units have settled.
//! Source: spec K3.

use super::cylinder::Cylinder;
use super::fluids::Lubrication;
use super::magnet::Magnet;
use super::ports::{Owner, owner};
use super::wheel::{Drive, SecondSpindle, Wheel};
use super::{Answer, Machine};
use crate::defs::mcode::{Gauge, Request};
use crate::defs::param::Params;
use crate::defs::signal::{InputSet, Output, OutputSet};
use crate::defs::text::Text;
use crate::units::Micros;

const TOO_MANY_PULSES: Text = Text::new("同时输出的脉冲太多", "too many pulses at once");

impl Machine {
    /// Executes a request that the interlock table has granted.
    pub(super) fn carry_out(&mut self, request: Request, now: Micros, inputs: InputSet, params: &Params) -> Answer {
        match request {
            Request::WheelStart => self.wheel.start(now),
            Request::CycleStart | Request::MdiStart | Request::HomeAxes | Request::MoveByHand => {}
            Request::CylinderOn => self.cylinder.start(now),
            Request::CylinderOff => self.cylinder = Cylinder::Off,
            Request::WheelStop => self.wheel = Wheel::Off,
            // One speed only where both codes use the same output.
            Request::DriveHigh | Request::DriveLow => {
                let fast = request == Request::DriveHigh || self.row.drive_low == self.row.drive_high;
                self.drive.start(fast, now);
            }
            Request::DriveStop => self.drive = Drive::Off,
            Request::SecondSpindleStart(ccw) => self.second_spindle.start(ccw, now),
            Request::SecondSpindleStop => self.second_spindle = SecondSpindle::Off,
            Request::SpindleStart(ccw) => self.spindle.start(ccw, now),
            Request::SpindleStop => self.spindle.stop(now),
            Request::Post(station) => self.post.send(station, inputs, now),
            Request::TailstockAdvance => self.tailstock.advance(now),
            Request::TailstockRetract => self.tailstock.retract(now),
            Request::HydraulicOn => self.hydraulic.switch_on(now),
            Request::HydraulicOff => self.hydraulic.switch_off(),
            Request::Magnetise => self.magnet.magnetise(now),
            Request::Demagnetise => self.magnet.demagnetise(now),
            Request::MagnetOff => self.magnet = Magnet::Off,
            Request::Gauge(gauge, out) => self.arms.send(gauge, out, now),
            Request::Gear(gear) => self.gears.change(gear, now),
            Request::Switch(output, on) => self.switch(output, on),
            Request::Port(port, on) => match owner(port, params, self.row.kind) {
                Owner::Plain(output) => self.switch(output, on),
                Owner::Nobody | Owner::Interlocked(_) => self.ports.switch(port, on),
            },
            Request::Pulse(port, millis) => {
                if !self.ports.pulse(port, now + Micros::from_millis(u64::from(millis))) {
                    return Answer::Denied(TOO_MANY_PULSES);
                }
            }
        }
        Answer::Taken
    }

    /// The output that a request switches on.
    pub(super) fn output_of(&self, request: Request) -> Option<Output> {
        Some(match request {
            Request::WheelStart => Output::Wheel,
            Request::DriveHigh => self.row.drive_high,
            Request::DriveLow => self.row.drive_low,
            Request::SecondSpindleStart(false) => Output::SecondSpindle,
            Request::SecondSpindleStart(true) => Output::SecondSpindleCcw,
            Request::SpindleStart(false) => Output::SpindleForward,
            Request::SpindleStart(true) => Output::SpindleReverse,
            Request::SpindleStop => Output::SpindleStop,
            Request::Post(_) => Output::PostForward,
            Request::TailstockAdvance => Output::Tailstock,
            Request::HydraulicOn => Output::Hydraulic,
            Request::CylinderOn => Output::OscillationForward,
            Request::Magnetise => Output::Magnetise,
            Request::Demagnetise => Output::Demagnetise,
            Request::Gauge(Gauge::Radial, true) => Output::RadialGauge,
            Request::Gauge(Gauge::Axial, true) => Output::AxialGauge,
            Request::Gear(gear) => Output::GEARS[usize::from(gear) % Output::GEARS.len()],
            Request::Switch(output, true) => output,
            Request::WheelStop
            | Request::DriveStop
            | Request::SecondSpindleStop
            | Request::TailstockRetract
            | Request::HydraulicOff
            | Request::MagnetOff
            | Request::Gauge(_, false)
            | Request::Switch(_, false)
            | Request::Port(..)
            | Request::Pulse(..)
            | Request::CylinderOff
            | Request::CycleStart
            | Request::MdiStart
            | Request::HomeAxes
            | Request::MoveByHand => return None,
        })
    }

    fn switch(&mut self, output: Output, on: bool) {
        match output {
            Output::Coolant => self.fluids.coolant = on,
            Output::Lubrication => self.fluids.lubrication = if on { Lubrication::On } else { Lubrication::Off },
            output => {
                debug_assert!(Output::USER.contains(&output), "{output:?} has a request of its own");
                self.user.set(output, on);
            }
        }
    }

    /// Whether the unit of a request has settled.
    #[must_use]
    pub fn is_settled(&self, request: Request) -> bool {
        match request {
            Request::WheelStart => self.wheel == Wheel::Running,
            Request::DriveHigh | Request::DriveLow => matches!(self.drive, Drive::Running { .. }),
            Request::SecondSpindleStart(_) => !self.second_spindle.is_reversing(),
            Request::SpindleStart(_) | Request::SpindleStop => self.spindle.is_settled(),
            Request::Post(_) => !self.post.is_moving(),
            Request::TailstockAdvance | Request::TailstockRetract => !self.tailstock.is_moving(),
            Request::Magnetise | Request::Demagnetise => !self.magnet.is_busy(),
            Request::Gauge(gauge, _) => !self.arms.is_going(gauge),
            Request::Gear(_) => !self.gears.is_going(),
            Request::Pulse(port, _) => !self.ports.is_pulsing(port),
            Request::WheelStop
            | Request::DriveStop
            | Request::SecondSpindleStop
            | Request::HydraulicOn
            | Request::HydraulicOff
            | Request::MagnetOff
            | Request::Switch(..)
            | Request::Port(..)
            | Request::CylinderOn
            | Request::CylinderOff
            | Request::CycleStart
            | Request::MdiStart
            | Request::HomeAxes
            | Request::MoveByHand => true,
        }
    }

    /// The outputs by function.
    #[must_use]
    pub fn outputs(&self, params: &Params) -> OutputSet {
        let mut on = self.user;
        on.set(Output::Wheel, self.wheel.is_on());
        on.set(Output::Coolant, self.fluids.coolant);
        on.set(Output::Lubrication, self.fluids.lubrication.is_on());
        on.set(Output::Tailstock, self.tailstock.output());
        on.set(Output::Hydraulic, self.hydraulic.is_on());
        on.set(Output::Magnetise, self.magnet.is_on());
        on.set(Output::Demagnetise, self.magnet.is_demagnetising());
        on.set(Output::SecondSpindle, self.second_spindle.direction() == Some(false));
        on.set(Output::SecondSpindleCcw, self.second_spindle.direction() == Some(true));
        self.cylinder.show(&mut on);
        self.arms.show(&mut on);
        self.gears.show(&mut on);
        self.spindle.show(self.now, params, &mut on);
        self.post.show(&mut on);
        if let Some(fast) = self.drive.speed() {
            on.set(self.row.drive_output(fast), true);
        }
        let ports = self.ports.terminals();
        for output in Output::ALL.iter().filter(|output| ports.0 != 0 && output.is_plain()) {
            if ports.level(params.output_port(*output)) {
                on.set(*output, true); // a pulse on the port of a plain function is that function
            }
        }
        on
    }

    /// Whether the feedback of a switched-on output is still pending: its lamp blinks.
    #[must_use]
    pub fn is_working(&self, output: Output) -> bool {
        match output {
            Output::Wheel => matches!(self.wheel, Wheel::RunUp { .. }),
            Output::Tailstock => self.tailstock.is_moving(),
            Output::Magnetise => matches!(self.magnet, Magnet::Magnetising { .. }),
            Output::Demagnetise => matches!(self.magnet, Magnet::Demagnetising { .. }),
            Output::RadialGauge => self.arms.is_going(Gauge::Radial),
            Output::AxialGauge => self.arms.is_going(Gauge::Axial),
            Output::SecondSpindle | Output::SecondSpindleCcw => self.second_spindle.is_reversing(),
            Output::HeadstockHigh | Output::HeadstockLow | Output::DresserRoll | Output::TableRotation => {
                matches!(self.drive, Drive::RunUp { fast, .. } if self.row.drive_output(fast) == output)
            }
            Output::Gear1 | Output::Gear2 | Output::Gear3 | Output::Gear4 => self.gears.is_going_to(output),
            Output::Coolant
            | Output::Lubrication
            | Output::Hydraulic
            | Output::OscillationForward
            | Output::OscillationBackward
            | Output::User1
            | Output::User2
            | Output::User3
            | Output::User4
            | Output::User5
            | Output::TowerRed
            | Output::TowerYellow
            | Output::TowerGreen
            | Output::SpindleForward
            | Output::SpindleReverse
            | Output::SpindleStop
            | Output::PostForward
            | Output::PostReverse => false,
        }
    }
}
