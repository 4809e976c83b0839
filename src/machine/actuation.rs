//! Executes granted requests; reports outputs, pending feedback (blinking lamps) and whether units have settled.
//! Source: spec K3.

use super::cylinder::Cylinder;
use super::fluids::Lubrication;
use super::magnetic_chuck::MagneticChuck;
use super::ports::{PortOwner, port_owner};
use super::wheel::{SecondSpindleContactor, WheelContactor, WorkpieceDrive};
use super::{Machine, RequestResult};
use crate::defs::mcode::{Gauge, Request};
use crate::defs::param::Params;
use crate::defs::signal::{InputSet, Output, OutputSet};
use crate::defs::text::Text;
use crate::units::Micros;

const TOO_MANY_PULSES: Text = Text::new("同时输出的脉冲太多", "too many output pulses at once");

impl Machine {
    /// Executes a request that the interlock table has granted.
    pub(super) fn execute(&mut self, asked: Request, now: Micros, inputs: InputSet, params: &Params) -> RequestResult {
        match asked {
            Request::WheelStart => self.wheel.start(now),
            Request::CycleStart | Request::MdiStart | Request::HomeAxes | Request::Jog => {}
            Request::CylinderOn => self.cylinder.start(now),
            Request::CylinderOff => self.cylinder = Cylinder::Off,
            Request::WheelStop => self.wheel = WheelContactor::Off,
            // One speed only where both codes use the same output.
            Request::WorkDriveHigh | Request::WorkDriveLow => {
                let row = self.kind.row();
                let fast = asked == Request::WorkDriveHigh || row.drive_output(false) == row.drive_output(true);
                self.workpiece_drive.start(fast, now);
            }
            Request::WorkDriveStop => self.workpiece_drive = WorkpieceDrive::Off,
            Request::SecondSpindleStart(ccw) => self.second_spindle.start(ccw, now),
            Request::SecondSpindleStop => self.second_spindle = SecondSpindleContactor::Off,
            Request::SpindleStart(ccw) => self.main_spindle.start(ccw, now),
            Request::SpindleStop => self.main_spindle.stop(now),
            Request::ToolTurret(station) => self.turret.index_to(station, inputs, now),
            Request::TailstockAdvance => self.tailstock.advance(now),
            Request::TailstockRetract => self.tailstock.retract(now),
            Request::HydraulicOn => self.hydraulic.switch_on(now),
            Request::HydraulicOff => self.hydraulic.switch_off(),
            Request::Magnetise => self.magnet.magnetise(now),
            Request::Demagnetise => self.magnet.demagnetise(now),
            Request::MagnetOff => self.magnet = MagneticChuck::Off,
            Request::Gauge(gauge, out) => self.gauge_arms.move_arm(gauge, out, now),
            Request::Gear(gear) => self.gears.change(gear, now),
            Request::Switch(output, on) => self.switch(output, on),
            Request::Port(port, on) => match port_owner(port, params) {
                PortOwner::Plain(output) => self.switch(output, on),
                PortOwner::Unassigned | PortOwner::Interlocked(_) => self.ports.switch(port, on),
            },
            Request::Pulse(port, millis) => {
                if !self.ports.pulse(port, now + Micros::from_millis(u64::from(millis))) {
                    return RequestResult::Denied(TOO_MANY_PULSES);
                }
            }
        }
        RequestResult::Accepted
    }

    /// The output that a request switches on.
    pub(super) fn output_of(&self, request: Request) -> Option<Output> {
        Some(match request {
            Request::WheelStart => Output::Wheel,
            Request::WorkDriveHigh => self.kind.row().drive_output(true),
            Request::WorkDriveLow => self.kind.row().drive_output(false),
            Request::SecondSpindleStart(false) => Output::SecondSpindle,
            Request::SecondSpindleStart(true) => Output::SecondSpindleCcw,
            Request::SpindleStart(false) => Output::SpindleForward,
            Request::SpindleStart(true) => Output::SpindleReverse,
            Request::SpindleStop => Output::SpindleStop,
            Request::ToolTurret(_) => Output::TurretForward,
            Request::TailstockAdvance => Output::Tailstock,
            Request::HydraulicOn => Output::Hydraulic,
            Request::CylinderOn => Output::OscillationForward,
            Request::Magnetise => Output::Magnetise,
            Request::Demagnetise => Output::Demagnetise,
            Request::Gauge(Gauge::Radial, true) => Output::RadialGauge,
            Request::Gauge(Gauge::Axial, true) => Output::AxialGauge,
            Request::Gear(gear) => Output::GEARS[usize::from(gear) % Output::GEARS.len()],
            Request::Switch(output, true) => output,
            Request::WheelStop | Request::WorkDriveStop | Request::SecondSpindleStop => return None,
            Request::TailstockRetract | Request::HydraulicOff | Request::MagnetOff => return None,
            Request::CylinderOff | Request::Gauge(_, false) | Request::Switch(_, false) => return None,
            Request::Port(..) | Request::Pulse(..) => return None,
            Request::CycleStart | Request::MdiStart | Request::HomeAxes | Request::Jog => return None,
        })
    }

    fn switch(&mut self, output: Output, on: bool) {
        match output {
            Output::Coolant => self.fluids.coolant = on,
            Output::Lubrication => self.fluids.lubrication = if on { Lubrication::On } else { Lubrication::Off },
            output => {
                assert!(Output::USER.contains(&output), "{output:?} has a request of its own");
                self.user_outputs.set(output, on);
            }
        }
    }

    /// Whether the unit of a request has settled.
    #[must_use]
    pub fn is_settled(&self, request: Request) -> bool {
        match request {
            Request::WheelStart => self.wheel == WheelContactor::Running,
            Request::WorkDriveHigh | Request::WorkDriveLow => {
                matches!(self.workpiece_drive, WorkpieceDrive::Running { .. })
            }
            Request::SecondSpindleStart(_) => !self.second_spindle.is_reversing(),
            Request::SpindleStart(_) | Request::SpindleStop => self.main_spindle.is_settled(),
            Request::ToolTurret(_) => !self.turret.is_moving(),
            Request::TailstockAdvance | Request::TailstockRetract => !self.tailstock.is_moving(),
            Request::Magnetise | Request::Demagnetise => !self.magnet.is_busy(),
            Request::Gauge(gauge, _) => !self.gauge_arms.is_moving(gauge),
            Request::Gear(_) => !self.gears.is_changing(),
            Request::Pulse(port, _) => !self.ports.is_pulsing(port),
            Request::WheelStop | Request::WorkDriveStop | Request::SecondSpindleStop | Request::MagnetOff => true,
            Request::HydraulicOn | Request::HydraulicOff | Request::CylinderOn | Request::CylinderOff => true,
            Request::Switch(..) | Request::Port(..) => true,
            Request::CycleStart | Request::MdiStart | Request::HomeAxes | Request::Jog => true,
        }
    }

    /// The outputs by function.
    #[must_use]
    pub fn outputs(&self, params: &Params) -> OutputSet {
        let mut on = self.user_outputs;
        on.set(Output::Wheel, self.wheel.is_on());
        on.set(Output::Coolant, self.fluids.coolant);
        on.set(Output::Lubrication, self.fluids.lubrication.is_on());
        on.set(Output::Tailstock, self.tailstock.output());
        on.set(Output::Hydraulic, self.hydraulic.is_on());
        on.set(Output::Magnetise, self.magnet.is_on());
        on.set(Output::Demagnetise, self.magnet.is_demagnetising());
        on.set(Output::SecondSpindle, self.second_spindle.direction() == Some(false));
        on.set(Output::SecondSpindleCcw, self.second_spindle.direction() == Some(true));
        self.cylinder.write_outputs(&mut on);
        self.gauge_arms.write_outputs(&mut on);
        self.gears.write_outputs(&mut on);
        self.main_spindle.write_outputs(self.now, params, &mut on);
        self.turret.write_outputs(&mut on);
        if let Some(fast) = self.workpiece_drive.speed() {
            on.set(self.kind.row().drive_output(fast), true);
        }
        let ports = self.ports.terminals();
        if ports.0 == 0 {
            return on;
        }
        for output in Output::ALL.iter().filter(|output| output.is_freely_switchable()) {
            if ports.is_closed(params.output_port(*output)) {
                on.set(*output, true); // a pulse on the port of a plain function is that function
            }
        }
        on
    }

    /// Whether the feedback of a switched-on output is still pending: its lamp blinks.
    #[must_use]
    pub fn awaits_feedback(&self, output: Output) -> bool {
        match output {
            Output::Wheel => matches!(self.wheel, WheelContactor::RunUp { .. }),
            Output::Tailstock => self.tailstock.is_moving(),
            Output::Magnetise => matches!(self.magnet, MagneticChuck::Magnetising { .. }),
            Output::Demagnetise => matches!(self.magnet, MagneticChuck::Demagnetising { .. }),
            Output::RadialGauge => self.gauge_arms.is_moving(Gauge::Radial),
            Output::AxialGauge => self.gauge_arms.is_moving(Gauge::Axial),
            Output::SecondSpindle | Output::SecondSpindleCcw => self.second_spindle.is_reversing(),
            Output::HeadstockHigh | Output::HeadstockLow | Output::DresserRoll | Output::TableRotation => {
                matches!(self.workpiece_drive, WorkpieceDrive::RunUp { fast, .. } if self.kind.row().drive_output(fast) == output)
            }
            Output::Gear1 | Output::Gear2 | Output::Gear3 | Output::Gear4 => self.gears.is_changing_to(output),
            Output::Coolant | Output::Lubrication | Output::Hydraulic => false,
            Output::OscillationForward | Output::OscillationBackward => false,
            Output::User1 | Output::User2 | Output::User3 | Output::User4 | Output::User5 => false,
            Output::TowerRed | Output::TowerYellow | Output::TowerGreen => false,
            Output::SpindleForward | Output::SpindleReverse | Output::SpindleStop => false,
            Output::TurretForward | Output::TurretReverse => false,
        }
    }
}
