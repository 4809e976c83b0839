//! Supervision: findings of the machine logic, and the control's own checks of drives, limits, bus and screen.
//! Source: spec B5, B8, K3.7, table "what stops what".

use super::{ControlEvent, ControlPhase, Controller};
use crate::defs::alarm;
use crate::defs::key::Key;
use crate::defs::param;
use crate::defs::signal::Input;
use crate::defs::text::LocalizedText;
use crate::machine::{Consequence, ControlState, MachineFinding};
use crate::units::{Axis, Micros};

impl Controller {
    /// One tick of the machine logic and of supervision.
    pub(super) fn supervise(&mut self) {
        let around = self.control_state();
        for finding in self.machine.tick(self.now, self.inputs, &self.params, around).into_iter().flatten() {
            match finding {
                MachineFinding::Alarm { number, stopped } => self.raise_with_reaction(number, None, stopped),
                MachineFinding::Cleared(number) => self.alarms.clear(number),
                MachineFinding::Message(why) => self.refuse(why),
            }
        }
        self.handle_external_keys();
        self.supervise_axes();
        self.supervise_screen();
    }

    /// The state of the control that the machine logic needs.
    pub(super) fn control_state(&self) -> ControlState {
        let dressing = self.params.get(param::DRESSING_PROGRAM_FIRST)..=self.params.get(param::DRESSING_PROGRAM_LAST);
        ControlState {
            run_open: self.phase.is_run_open(),
            homed: self.axes.all_homed() || self.kind_row.may_start_unhomed(),
            alarm_blocks: self.alarms.blocks_start(),
            drives_off: !self.drives_on,
            oscillating: self.oscillation.is_some() && !self.phase.is_run_open(),
            dry_run: self.switches.dry_run,
            machine_lock: self.switches.machine_lock,
            dressing_program: dressing.contains(&f64::from(self.current_program)),
            wheel_rpm: self.commanded_wheel_rpm(),
        }
    }

    /// Commanded wheel speed, rpm, limited to 10 V output. Above the wheel's rating the wheel does not start (P2).
    pub(super) fn commanded_wheel_rpm(&self) -> f64 {
        let wanted = self.wheel_rpm() * f64::from(self.overrides.spindle) / 100.0;
        wanted.min(self.params.get(param::WHEEL_RPM_MAX))
    }

    /// Speed on the first analog output, rpm: also limited to the wheel's rating while it runs.
    pub(super) fn output_wheel_rpm(&self) -> f64 {
        let rim_mm_min = self.params.get(param::WHEEL_RATED_SPEED) * 60_000.0;
        let rated = rim_mm_min / (std::f64::consts::PI * self.params.get(param::WHEEL_DIAMETER));
        self.commanded_wheel_rpm().min(rated)
    }

    /// External cycle start and hold act on their rising edge, like the keys (P335, P336).
    fn handle_external_keys(&mut self) {
        let before = std::mem::replace(&mut self.last_inputs, self.inputs);
        for (input, key) in [(Input::ExternalHold, Key::FeedHold), (Input::ExternalStart, Key::CycleStart)] {
            if self.inputs.has(input) && !before.has(input) {
                self.press_key(key);
            }
        }
    }

    fn supervise_axes(&mut self) {
        if !self.image.bus_alive {
            self.raise(alarm::BUS_LOST, None);
        }
        let drives = [Input::DriveX, Input::DriveY, Input::DriveZ];
        let limits = [
            (Input::LimitXPlus, Input::LimitXMinus),
            (Input::LimitYPlus, Input::LimitYMinus),
            (Input::LimitZPlus, Input::LimitZMinus),
        ];
        let faults: Vec<_> = self.axes.present().filter(|axis| self.inputs.has(drives[*axis as usize])).collect();
        if !faults.is_empty() {
            // A crash trips all drives at once: report the moving axes.
            let moving: Vec<_> = faults.iter().filter(|axis| self.is_moving(**axis)).collect();
            let told = if moving.is_empty() { faults.iter().collect() } else { moving };
            let names = told.into_iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
            self.raise(alarm::DRIVE_FAULT, Some(LocalizedText::new(names.clone(), names)));
            self.axes.clear_homed();
        }
        for axis in self.axes.present() {
            let name = || Some(LocalizedText::new(axis.to_string(), axis.to_string()));
            let (plus, minus) = limits[axis as usize];
            for (bit, switch) in [(0, plus), (1, minus)] {
                let mask = 1 << (2 * axis as u8 + bit);
                let pressed = self.inputs.has(switch);
                // Only the edge counts: after RESET the axis must be able to leave the switch.
                if pressed && self.limit_switches & mask == 0 {
                    self.alarms.clear(alarm::HARD_LIMIT);
                    self.raise(alarm::HARD_LIMIT, name());
                    self.axes.clear_homed();
                }
                if pressed { self.limit_switches |= mask } else { self.limit_switches &= !mask }
            }
        }
        if let Some(axis) = self.axes.first_following_error(&self.params)
            && self.drives_on
        {
            self.raise(alarm::FOLLOWING_ERROR, Some(LocalizedText::new(axis.to_string(), axis.to_string())));
            self.axes.clear_homed();
        }
    }

    /// Whether an axis is on the limit switch of this direction.
    pub(super) fn is_on_limit_switch(&self, axis: Axis, direction: f64) -> bool {
        let side = if direction > 0.0 { 0 } else { 1 };
        self.limit_switches >> (2 * axis as u8 + side) & 1 == 1
    }

    fn supervise_screen(&mut self) {
        let silence = Micros::from_millis_f64(self.params.get(param::HMI_KEEP_ALIVE));
        if let Some(heard) = self.screen_alive_at
            && self.now.since(heard) > silence
        {
            self.raise(alarm::HMI_LOST, None);
            self.screen_alive_at = None;
        }
    }

    /// Raises an alarm and executes its reaction.
    pub(super) fn raise(&mut self, number: u16, detail: Option<LocalizedText>) {
        self.raise_with_reaction(number, detail, false);
    }

    fn raise_with_reaction(&mut self, number: u16, detail: Option<LocalizedText>, stopped: bool) {
        if !self.alarms.has(number) {
            let place = self.phase.is_run_open().then_some((self.current_block.program, self.current_block.line));
            self.alarms.raise(number, detail, self.now, place);
            if let Some(alarm) = self.alarms.present().last().filter(|_| self.message.since < self.now) {
                let text = alarm.text.clone();
                self.warn(text);
            }
        } else if !stopped {
            return;
        }
        match Consequence::of(number, stopped) {
            Consequence::Nothing => {}
            Consequence::Hold => self.hold_run(),
            Consequence::Abort => self.abort_run(),
            Consequence::AbortAndStop => {
                self.machine.stop_wheel_and_drive();
                self.abort_run();
            }
            Consequence::AbortAndMakeSafe => {
                self.stop_oscillation();
                self.machine.safe_stop();
                self.abort_run();
                self.drives_on = false;
            }
        }
    }

    /// Feed hold: holds a running program; nothing else is affected.
    pub(super) fn hold_run(&mut self) {
        if self.lathe.homing.is_some() {
            return self.abort_run(); // homing cannot be held
        }
        if matches!(self.phase, ControlPhase::Running) {
            self.axes.planner.hold();
            self.transition(ControlEvent::Hold);
        }
    }
}
