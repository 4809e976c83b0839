//! Checks the description of a machine against the parameters of the control.
//! Source: spec P1, K3 (ports); docs/manual, chapter "first start on a machine".

use super::description::{ClockDescription, DescriptionError, DigitalChannels, MachineDescription, require, wrong};
use super::station_description::FIRST_STATION;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, Output};
use crate::units::Axis;

/// Inputs that must act in the cycle.
const IN_THE_CYCLE: [Input; 11] = [
    Input::EmergencyStop,
    Input::GuardClosed,
    Input::DriveX,
    Input::DriveY,
    Input::DriveZ,
    Input::LimitXPlus,
    Input::LimitXMinus,
    Input::LimitYPlus,
    Input::LimitYMinus,
    Input::LimitZPlus,
    Input::LimitZMinus,
];

/// Seconds of a minute.
const MINUTE_S: f64 = 60.0;

impl MachineDescription {
    /// Checks what depends on the parameters of the control: the cycle, the fitted axes, the ports of functions.
    ///
    /// # Errors
    /// The first value that does not go with them.
    pub fn check_against(&self, params: &Params) -> Result<(), DescriptionError> {
        let in_time = (self.ethercat.reply_time_us as f64) < params.get(param::TICK_TIME);
        require(in_time, "ethercat.reply_time_us", "must be less than the cycle of the control (P58)")?;
        let in_step = |clocks: ClockDescription| clocks.cycle_us == params.get(param::TICK_TIME) as u32;
        let place = "ethercat.distributed_clocks";
        let rule = "cycle_us must be the cycle of the control (P58)";
        require(self.ethercat.distributed_clocks.is_none_or(in_step), place, rule)?;
        let (fitted, described) = (params.fitted().axes(), self.axes());
        for axis in Axis::ALL {
            let place = axis.letter().to_ascii_lowercase().to_string();
            let (fitted, described) = (fitted[axis], described[axis].is_some());
            require(described || !fitted, &place, "the control has this axis, the description has no drive for it")?;
            require(fitted || !described, &place, "has a drive, and the control does not have this axis (P6.6)")?;
        }
        for (axis, highest) in described.iter().filter_map(|(axis, servo)| Some((axis, servo.as_ref()?.highest_mm_s?)))
        {
            let rapid = params.get_axis(param::RAPID_X, axis) / MINUTE_S;
            let place = format!("{}.highest_mm_s", axis.letter().to_ascii_lowercase());
            require(rapid <= highest, &place, "the rapid traverse of the control (P30–P32) is faster")?;
        }
        for (axis, servo) in described.iter() {
            let Some(brake) = servo.and_then(|servo| servo.brake.as_ref()) else { continue };
            let mut functions = Output::ALL.iter().filter(|output| output.exists_on(params.fitted()));
            if let Some(output) = functions.find(|output| params.output_port(**output) == brake.port) {
                let place = format!("{}.brake", axis.letter().to_ascii_lowercase());
                let taken = format!("{place}: port {} and {} (P{})", brake.port, output.id(), output.port_param());
                return Err(wrong(taken, "an output port has one writer"));
            }
        }
        self.check_touch_probes(params)?;
        self.check_safety_inputs(params)
    }

    /// The signal of a touch probe is seen in the cycle, too: that of a station comes too late for its latch.
    fn check_touch_probes(&self, params: &Params) -> Result<(), DescriptionError> {
        for (axis, servo) in self.axes().iter() {
            let Some(probe) = servo.and_then(|servo| servo.touch_probe) else { continue };
            let input = Input::GAUGES.get(usize::from(probe.signal) - 1).copied().unwrap_or(Input::WheelContact);
            let is_its = |block: &&DigitalChannels| block.channels().any(|(_, port)| port == params.input_port(input));
            if self.inputs.iter().find(is_its).is_some_and(|block| block.device >= FIRST_STATION) {
                let place = format!("{}.touch_probe: {}", axis.letter().to_ascii_lowercase(), input.id());
                return Err(wrong(place, "must act in the cycle, so it is on the bus and not at a station"));
            }
        }
        Ok(())
    }

    /// Signals that must act in the cycle are on the bus: a station is read beside it, and may be silent.
    fn check_safety_inputs(&self, params: &Params) -> Result<(), DescriptionError> {
        for (at, block) in self.inputs.iter().enumerate().filter(|(_, block)| block.device >= FIRST_STATION) {
            let of_station = |input: &&Input| block.channels().any(|(_, port)| port == params.input_port(**input));
            if let Some(input) = IN_THE_CYCLE.iter().find(of_station) {
                let place = format!("inputs[{at}]: {} (P{})", input.id(), input.port_param());
                return Err(wrong(place, "must act in the cycle, so it is on the bus and not at a station"));
            }
        }
        Ok(())
    }
}
