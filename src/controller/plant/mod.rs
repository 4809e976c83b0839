//! The plant: the machine as every part of the controller sees it, and the services that touch nothing else.
//!
//! Parts read and change the plant; the plant knows no part. A reaction to an alarm acts on the plant alone: it brakes
//! the axes and changes the phase, and the parts follow the phase.

mod execution;
mod gathered;
mod homing;
mod operator;
mod oscillation;
mod outbox;
mod phase_clock;
mod spindles;
pub mod system_variables;
pub mod wheel_size;
mod work_data;

pub use execution::{ControlEvent, ControlPhase, Execution, FinishedCycle, Homing};
pub use operator::OperatorState;
pub use oscillation::key_stroke;
pub use outbox::Outbox;
pub use spindles::Spindles;
pub use work_data::{ProgramControls, WorkData, offset_in_range};

use super::PowerOnState;
use super::axes::jog_demand::JogDemand;
use super::axes::oscillation::Oscillation;
use super::axes::{Axes, SECONDS_PER_MINUTE};
use super::safety::alarms::AlarmList;
use super::safety::inputs::Inputs;
use super::safety::outputs::Outputs;
use super::storage_request::StorageRequest;
use crate::defs::alarm;
use crate::defs::date::DateTime;
use crate::defs::key::Mode;
use crate::defs::kind::Kind;
use crate::defs::mcode::Request;
use crate::defs::param::{self, ParamAddress, ParamError, Params};
use crate::defs::signal::{Input, Output};
use crate::defs::text::arg::Arg;
use crate::defs::text::{LocalizedText, Text, phrase};
use crate::io::InputImage;
use crate::machine::lathe::station_in_position;
use crate::machine::{ControlState, Machine, RequestResult};
use crate::motion::MAX_TRAJECTORY_WORK;
use crate::units::{Axis, DisplayPos, Micros, PerAxis, WorkBudget, WorkPos};

/// Refusal while set-points move.
pub const STILL_MOVING: Text = Text::new("轴还在运动，请稍候", "the axes are still moving");

/// Factor from mm/min to mm/s.
pub const MM_S_PER_MM_MIN: f64 = 1.0 / SECONDS_PER_MINUTE;

/// Below this speed an axis is shown as standing, mm/s.
const STANDING_MM_S: f64 = 1e-6;

/// Work units of a tick: reading, look-ahead and feed scaling. 0.4 ms on the computer of docs/performance.md.
pub const WORK_PER_TICK: usize = 400_000;

/// The machine and the state that all parts share.
pub struct Plant {
    /// The kind of machine.
    pub kind: Kind,
    /// The parameters in force; shared with the snapshot.
    pub params: Params,
    /// Time of this tick.
    pub now: Micros,
    /// Date and time of day, or the time since power-on while the date is unknown: programs read it, nothing else.
    pub date: DateTime,
    /// The work that is left in this tick.
    pub tick_budget: WorkBudget,
    /// The inputs.
    pub inputs: Inputs,
    /// The machine logic.
    pub machine: Machine,
    /// The axes.
    pub axes: Axes,
    /// What manual motion demands of the movers.
    pub jog: JogDemand,
    /// The axis that oscillates by servo.
    pub oscillation: Option<Oscillation>,
    /// Wheel, workpiece drive and main spindle.
    pub spindles: Spindles,
    /// The outputs and the drives.
    pub outputs: Outputs,
    /// The active alarms and their history.
    pub alarms: AlarmList,
    /// Messages and disk requests.
    pub outbox: Outbox,
    /// Offsets, variables, programs, counts.
    pub work: WorkData,
    /// Phase and place of execution.
    pub execution: Execution,
    /// What the operator has selected on the panel.
    pub operator: OperatorState,
}

impl Plant {
    /// The plant at power-on.
    #[must_use]
    pub fn new(kind: Kind, retained: PowerOnState, image: InputImage, now: Micros) -> Self {
        let params = retained.params;
        let mut plant = Self {
            kind,
            now,
            date: DateTime::default(),
            tick_budget: WorkBudget::new(WORK_PER_TICK),
            inputs: Inputs::new(&params, image),
            machine: Machine::new(kind, now),
            axes: Axes::new(&params, &image, retained.leadscrew_tables),
            jog: JogDemand::default(),
            oscillation: None,
            spindles: Spindles::new(&params),
            outputs: Outputs::default(),
            alarms: AlarmList::new(retained.alarm_history, now),
            outbox: Outbox::new(),
            work: WorkData {
                offsets: retained.work_offsets,
                variables: retained.variables,
                dress_points: retained.dress_points,
                part_count: retained.part_count,
                ..WorkData::default()
            },
            execution: Execution { current_program: retained.current_program, ..Execution::default() },
            operator: OperatorState::default(),
            params,
        };
        plant.update_unusable_outputs();
        plant
    }

    /// Begins a tick: time and inputs.
    pub fn begin_tick(&mut self, now: Micros, timestamp: DateTime, image: &InputImage) {
        (self.now, self.tick_budget) = (now, WorkBudget::new(WORK_PER_TICK));
        self.date = timestamp;
        self.execution.awaited_signal = 0;
        self.alarms.set_time(now, timestamp);
        self.inputs.read(image);
        self.work.contact_seen |= self.inputs.raw.has(Input::WheelContact);
        self.axes.read(image);
        self.spindles.encoder.read(image.spindle_turns, now);
        self.measure_thread();
    }

    /// What reading of blocks may take: all but the share of the planner and of feed scaling.
    pub fn reading_budget(&self) -> WorkBudget {
        WorkBudget::new(self.tick_budget.left().saturating_sub(MAX_TRAJECTORY_WORK))
    }

    /// Charges what was used of [`Self::reading_budget`].
    pub const fn charge_reading(&mut self, used: WorkBudget) {
        self.tick_budget.spend(used.spent());
    }

    /// Moves the axes by one tick.
    pub fn step_axes(&mut self) {
        let rate = self.override_factors();
        // Planner and feed scaling have their share, whatever reading took.
        let mut share = WorkBudget::new(MAX_TRAJECTORY_WORK);
        self.axes.tick(rate, self.spindles.encoder.turns, &mut share);
        self.tick_budget.spend(share.spent());
    }

    /// Changes a parameter, stores it and applies it.
    ///
    /// # Errors
    /// The function is in use, or the value is out of range.
    pub fn change_param(&mut self, at: ParamAddress, value: f64) -> Result<(), LocalizedText> {
        if self.is_in_use(at, value) {
            return Err(phrase!(
                "{at}：该功能正在工作，先关闭再修改",
                "{at}: the function is on; switch it off before changing this",
                at
            ));
        }
        self.params.write(at, value).map_err(ParamError::text)?;
        self.store(StorageRequest::Param(at, value));
        self.inputs.configure(&self.params);
        self.axes.configure(&self.params);
        self.update_unusable_outputs();
        Ok(())
    }

    /// Prepares a headless run (tools.md T3): homed, with the encoder zero at machine coordinates `encoder_zero_mm`,
    /// hydraulics on, part clamped, mode AUTO.
    pub fn make_ready(&mut self, encoder_zero_mm: PerAxis<f64>) {
        for axis in Axis::ALL {
            let at = self.axes.actual()[axis];
            self.axes.set_zero(axis, at, self.inputs.image.encoder_mm[axis] + encoder_zero_mm[axis]);
            self.axes.finish_homing(axis, &self.params);
        }
        self.machine.make_ready(&self.params);
        self.operator.mode = Mode::Auto;
    }

    /// Whether a change would drop an active output, take over an active terminal, change an input while a spindle
    /// turns, or disable a clamp that is in use.
    pub fn is_in_use(&self, at: ParamAddress, value: f64) -> bool {
        let on = |output: Output| self.outputs.on.has(output);
        if at == param::TAILSTOCK_ENABLED.address() {
            return on(Output::Tailstock);
        }
        if at == param::MAGNET_ENABLED.address() {
            // With the magnet, a function at one of its ports would lose it.
            let taken = |output| self.outputs.image.terminals.is_closed(self.params.output_port(output));
            return [Output::Magnetise, Output::Demagnetise].into_iter().any(|output| on(output) || taken(output));
        }
        if at.bit.is_some() {
            return false;
        }
        let turns = on(Output::Wheel) || on(Output::SecondSpindle) || on(Output::SecondSpindleCcw);
        if Input::ALL.iter().any(|input| input.port_param() == at.number) {
            return turns || self.machine.drive_is_on();
        }
        let of = |output: &Output| output.port_param() == at.number && output.exists_on(self.params.fitted());
        let port = value as u8; // truncated: the range is checked when it is written
        Output::ALL.iter().any(|output| of(output) && (on(*output) || self.outputs.image.terminals.is_closed(port)))
    }

    /// X is programmed and shown as a diameter.
    pub fn is_diameter(&self) -> bool {
        !self.params.bit(param::RADIUS_PROGRAMMING)
    }

    /// Displayed millimetres per millimetre of slide travel.
    pub fn displayed_per_mm(&self, axis: Axis) -> f64 {
        displayed_per_mm(&self.params, axis)
    }

    /// The actual work position, radius mm.
    pub fn work_position(&self) -> WorkPos {
        self.work.offsets.work_from_machine(self.axes.actual())
    }

    /// The title of a program.
    pub fn program_title(&self, number: u32) -> Arg {
        self.work.programs.get(number).map_or(Arg::Program(number), |program| program.source.title_arg())
    }

    /// The text of an alarm of `#3000`, and the variable whose value its program calls wrong (B8).
    pub fn program_alarm_words(&self, number: u16, text: &LocalizedText, program: u32) -> (LocalizedText, Option<u16>) {
        let help = self.work.programs.get(program).and_then(|program| program.source.alarm_help(u32::from(number)));
        let own = Some(text).filter(|text| !text.is_blank());
        let value = |variable: u16| self.work.variables.get(u32::from(variable)).ok().flatten();
        let words = own.or(help.map(|help| &help.text)).cloned().unwrap_or_default();
        (words, help.and_then(|help| help.variable(value)))
    }

    /// Sends a request to the machine logic and shows a refusal.
    pub fn request(&mut self, request: Request) -> RequestResult {
        self.machine.set_control_state(self.control_state());
        let answer = self.machine.request(request, self.now, self.inputs.filtered, &self.params);
        match answer {
            RequestResult::Accepted => {
                // In a program the speed of `M63 S` holds until the next M63 or M64, also if a key starts the drive again.
                let in_program = matches!(
                    self.execution.phase,
                    ControlPhase::Running | ControlPhase::Holding | ControlPhase::Held | ControlPhase::Stopped
                );
                if let Request::WorkDriveHigh | Request::WorkDriveLow | Request::WorkDriveStop = request
                    && !in_program
                {
                    self.spindles.analog_2_rpm = 0.0;
                }
            }
            RequestResult::NoEffect(reason) | RequestResult::Denied(reason) => self.refuse(reason),
            RequestResult::Alarm(number, reason) => {
                let reason = self.machine.reason_text(reason, request, &self.params);
                self.refuse(reason.clone());
                // Alarm 180 is raised by the supervision, which also clears it (K3.7).
                if number != alarm::HYDRAULIC_PRESSURE {
                    self.raise(number, Some(reason));
                }
            }
        }
        answer
    }

    /// Sends a request to the machine logic and shows a refusal; true if the request was accepted.
    pub fn is_granted(&mut self, request: Request) -> bool {
        matches!(self.request(request), RequestResult::Accepted)
    }

    /// The state of the control that the machine logic needs.
    pub fn control_state(&self) -> ControlState {
        let dressing = self.params.get(param::DRESSING_PROGRAM_FIRST)..=self.params.get(param::DRESSING_PROGRAM_LAST);
        ControlState {
            run_open: self.execution.phase.is_run_open(),
            homed: self.axes.all_homed() || self.kind.row().may_start_unhomed(),
            alarm_blocks: self.alarms.blocks_start(),
            drives_off: !self.outputs.drives_on,
            drives_switching: self.outputs.drives_on && !self.drives_follow(),
            oscillating: match self.execution.phase.is_run_open() {
                true => self.oscillates_by_key(),
                false => self.oscillation.is_some(),
            },
            dry_run: self.operator.switches.dry_run,
            machine_lock: self.axes.is_locked(),
            dressing_program: dressing.contains(&f64::from(self.execution.current_program)),
            starts_wheel: self.work.programs.started_units(self.execution.current_program).wheel,
            wheel_rpm: self.commanded_wheel_rpm(),
        }
    }

    /// The displayed millimetres of slide travel: X is doubled in diameter mode.
    pub fn displayed(&self, values: PerAxis<f64>) -> DisplayPos {
        DisplayPos::from_fn(|axis| values[axis] * self.displayed_per_mm(axis))
    }

    /// Whether an axis moves.
    pub fn is_moving(&self, axis: Axis) -> bool {
        self.axes.velocity_mm_s()[axis].abs() > STANDING_MM_S
    }

    /// Speed of the path of all axes, mm/s.
    pub fn path_speed_mm_s(&self) -> f64 {
        let velocity = self.axes.velocity_mm_s();
        velocity.iter().map(|(_, v)| v * v).sum::<f64>().sqrt()
    }

    /// Whether the axes stand in position.
    pub fn is_in_position(&self) -> bool {
        self.axes.is_at_rest() && self.axes.is_in_position(&self.params)
    }

    /// The tool post station whose switch alone is on.
    pub fn turret_station(&self) -> Option<u8> {
        station_in_position(self.inputs.filtered)
    }
}

/// Displayed millimetres per millimetre of slide travel: X is programmed and shown as a diameter unless a parameter says radius.
#[must_use]
pub fn displayed_per_mm(params: &Params, axis: Axis) -> f64 {
    if axis == Axis::X && !params.bit(param::RADIUS_PROGRAMMING) { 2.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::drive::DriveState;

    impl Plant {
        /// A cylindrical grinding machine in its factory state.
        pub fn factory() -> Self {
            let drives = PerAxis([DriveState::Enabled; 3]);
            let image = InputImage { drives, bus_alive: true, ..InputImage::default() };
            Self::new(Kind::Gc, PowerOnState::factory(Kind::Gc), image, Micros::ZERO)
        }
    }
}
