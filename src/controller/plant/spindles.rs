//! The spindles: programmed wheel speed and its limits, workpiece speed, main spindle encoder, threads cut.
//! Source: spec B2 (S, G96), P2, K3.4, L5.

use super::Plant;
use super::wheel_size::{rated_wheel_rpm, wheel_rpm_of};
use crate::controller::axes::spindle_encoder::SpindleEncoder;
use crate::controller::axes::thread_recorder::ThreadRecorder;
use crate::defs::param::{self, Params};
use crate::defs::signal::Output;
use crate::defs::text::phrase;
use crate::nc::SpeedMode;
use crate::units::Axis;

/// Wheel, workpiece drive and main spindle.
#[derive(Clone, Debug)]
pub struct Spindles {
    /// Programmed S, in the unit of its mode.
    pub wheel_speed: (f64, SpeedMode),
    /// G50 S: maximum wheel speed under G96, rpm.
    pub wheel_rpm_limit: Option<f64>,
    /// Speed on the second analog output, rpm; 0 for the two fixed speeds.
    pub analog_2_rpm: f64,
    /// The main spindle encoder.
    pub encoder: SpindleEncoder,
    /// The threads cut since power-on.
    pub threads: ThreadRecorder,
}

impl Spindles {
    /// At power-on the wheel has the speed of its parameter.
    #[must_use]
    pub fn new(params: &Params) -> Self {
        Self {
            wheel_speed: (params.get(param::WHEEL_RPM), SpeedMode::Rpm),
            wheel_rpm_limit: None,
            analog_2_rpm: 0.0,
            encoder: SpindleEncoder::default(),
            threads: ThreadRecorder::default(),
        }
    }
}

impl Plant {
    /// S: wheel speed in rpm, or as surface speed by the wheel diameter P77.
    pub fn set_wheel_speed(&mut self, value: f64, mode: SpeedMode) {
        self.spindles.wheel_speed = (value, mode);
        if self.outputs.on.has(Output::Wheel) && self.output_wheel_rpm() < self.commanded_wheel_rpm() {
            self.refuse(phrase!(
                "S 超过砂轮额定线速度，按额定转速运行 (P77 P79)",
                "S exceeds the wheel rating: the wheel runs at its rated speed (P77, P79)"
            ));
        }
    }

    /// The programmed wheel speed, rpm, with the present diameter.
    pub fn wheel_rpm(&self) -> f64 {
        wheel_rpm_of(self.spindles.wheel_speed, self.spindles.wheel_rpm_limit, self.params.get(param::WHEEL_DIAMETER))
    }

    /// Commanded wheel speed, rpm, limited to 10 V output. Above the wheel's rating the wheel does not start (P2).
    pub fn commanded_wheel_rpm(&self) -> f64 {
        let wanted = self.wheel_rpm() * f64::from(self.operator.overrides.spindle) / 100.0;
        wanted.min(self.params.get(param::WHEEL_RPM_MAX))
    }

    /// Speed on the first analog output, rpm: also limited to the wheel's rating while it runs.
    pub fn output_wheel_rpm(&self) -> f64 {
        self.commanded_wheel_rpm().min(rated_wheel_rpm(&self.params, self.params.get(param::WHEEL_DIAMETER)))
    }

    /// Workpiece speed, rpm; 0 while the drive is off.
    pub fn workpiece_rpm(&self) -> f64 {
        if !self.machine.drive_is_on() {
            0.0
        } else if self.spindles.analog_2_rpm > 0.0 {
            self.spindles.analog_2_rpm
        } else if self.outputs.on.has(self.kind.row().drive_output(true)) {
            self.params.get(param::HEADSTOCK_RPM_HIGH)
        } else {
            self.params.get(param::HEADSTOCK_RPM_LOW)
        }
    }

    /// Measures the thread being cut, from the Z and spindle encoders of the same tick.
    pub fn measure_thread(&mut self) {
        match self.axes.thread() {
            Some(mover) => {
                let nominal = mover.nominal_z_mm(self.spindles.encoder.turns);
                self.spindles.threads.measure(self.axes.actual()[Axis::Z], nominal);
            }
            None => self.spindles.threads.finish(),
        }
    }
}
