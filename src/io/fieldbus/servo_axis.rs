//! A servo axis on a field bus: counts to millimetres, the way of its drive to operation enabled, its brake.
//! Source: CiA 402-2, cyclic synchronous position mode.

use super::cia402::{self, CYCLIC_SYNCHRONOUS_POSITION, PowerState};
use super::description::{
    ACTUAL_POSITION, ACTUAL_TORQUE, BrakeDescription, CONTROLWORD, DeviceDescription, ERROR_CODE, MODE, STATUSWORD,
    ServoAxisDescription, TARGET_POSITION, field_of,
};
use super::process_image::{BitField, DeviceImage};
use super::touch_probe::TouchProbe;
use crate::io::ProbeLatch;
use crate::io::drive::{DriveFault, DriveState};
use crate::units::Micros;

/// Counts in a tick that are standstill.
const STANDSTILL_COUNTS: i64 = 1;

/// Where the objects of the drive are in its process data.
#[derive(Clone, Copy, Debug)]
struct DriveFields {
    controlword: BitField,
    target_position: BitField,
    mode: Option<BitField>,
    statusword: BitField,
    actual_position: BitField,
    error_code: Option<BitField>,
    torque: Option<BitField>,
}

/// What is wanted of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Demand {
    /// No torque since then.
    Off(Micros),
    /// It is to follow its set-points.
    On,
    /// It has left operation while it was to be on. It stays off until it is no longer asked for: otherwise it would come
    /// back in the middle of the braking of the other axes, and jump.
    Dropped,
}

/// An axis with its drive.
#[derive(Clone, Debug)]
pub struct ServoAxis {
    /// Index of the drive in the process image.
    pub device: usize,
    fields: DriveFields,
    /// Counts for 1 mm in the plus direction; negative if they fall.
    counts_per_mm: f64,
    brake: Option<BrakeDescription>,
    probe: Option<TouchProbe>,
    /// Where the probe has latched, counts without wrap.
    latched_count: Option<i64>,
    /// Actual position in counts, without the wrap of its field; `None` before the first exchange.
    count: Option<i64>,
    /// Count that is 0 mm of the encoder's frame: where the axis was switched on, or the machine zero of an absolute
    /// encoder.
    zero_count: i64,
    is_absolute: bool,
    power: PowerState,
    /// The error code, once it is read by mailbox.
    fault: DriveFault,
    demand: Demand,
    /// Since when the drive has had torque and was to have it: the time of the brake counts from here.
    enabled_since: Option<Micros>,
    /// RESET is leading the drive out of its fault.
    resetting: bool,
    /// Counts of the last tick.
    velocity_counts: i64,
    /// Torque of the drive, 0.1 % of the rated one.
    torque: i32,
}

/// What the control asks of the axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisSetPoint {
    /// Set-point in the encoder's frame, mm.
    pub position_mm: f64,
    /// The drive is to be on.
    pub on: bool,
}

impl ServoAxis {
    /// An axis whose drive has not been read yet; `None` if the drive lacks an object, which the check excludes.
    #[must_use]
    pub fn new(description: &ServoAxisDescription, drive: &DeviceDescription) -> Option<Self> {
        let fields = DriveFields {
            controlword: field_of(&drive.outputs, CONTROLWORD)?,
            target_position: field_of(&drive.outputs, TARGET_POSITION)?,
            mode: field_of(&drive.outputs, MODE),
            statusword: field_of(&drive.inputs, STATUSWORD)?,
            actual_position: field_of(&drive.inputs, ACTUAL_POSITION)?,
            error_code: field_of(&drive.inputs, ERROR_CODE),
            torque: field_of(&drive.inputs, ACTUAL_TORQUE).filter(|field| field.bits == 16),
        };
        let sign = if description.reversed { -1.0 } else { 1.0 };
        Some(Self {
            device: usize::from(description.device).saturating_sub(1),
            fields,
            counts_per_mm: sign * description.counts_per_mm,
            brake: description.brake.clone(),
            probe: description.touch_probe.and_then(|described| drive.touch_probe(described)),
            latched_count: None,
            count: None,
            zero_count: description.absolute.map_or(0, |encoder| i64::from(encoder.zero_counts)),
            is_absolute: description.absolute.is_some(),
            power: PowerState::default(),
            fault: DriveFault::UNKNOWN,
            demand: Demand::Off(Micros::ZERO),
            enabled_since: None,
            resetting: false,
            velocity_counts: 0,
            torque: 0,
        })
    }

    /// Takes what the drive has sent.
    pub fn read(&mut self, now: Micros, image: &DeviceImage) {
        let raw = self.fields.actual_position.read_signed(&image.inputs);
        let count = match self.count {
            // The difference of the fields is right across their wrap.
            Some(before) => before + i64::from(raw.wrapping_sub(before as i32)),
            // The zero of an absolute encoder may lie beyond the wrap.
            None if self.is_absolute => self.zero_count + i64::from(raw.wrapping_sub(self.zero_count as i32)),
            None => {
                self.zero_count = i64::from(raw);
                self.zero_count
            }
        };
        self.velocity_counts = self.count.map_or(0, |before| count - before);
        self.count = Some(count);
        let latched = self.probe.as_mut().and_then(|probe| probe.read(image));
        self.latched_count = latched.map(|raw| count + i64::from(raw.wrapping_sub(count as i32)));
        self.torque = self.fields.torque.map_or(0, |field| field.read_signed(&image.inputs));
        self.power = PowerState::from_statusword(self.fields.statusword.read(&image.inputs) as u16);
        if !self.power.is_fault() {
            (self.fault, self.resetting) = (DriveFault::UNKNOWN, false);
        } else if let Some(field) = self.fields.error_code {
            self.fault = DriveFault(field.read(&image.inputs) as u16);
        }
        if self.power == PowerState::OperationEnabled {
            self.enabled_since.get_or_insert(now);
        } else {
            self.leave_operation();
        }
    }

    fn leave_operation(&mut self) {
        if self.enabled_since.take().is_some() && self.demand == Demand::On {
            self.demand = Demand::Dropped;
        }
    }

    /// The drive does not answer any more: it is taken to be without torque, and its brake is to hold.
    pub fn lose(&mut self) {
        self.power = PowerState::NotReadyToSwitchOn;
        self.leave_operation();
    }

    /// A frame is missing: the axis is taken to go on at its last speed.
    pub fn extrapolate(&mut self) {
        self.count = self.count.map(|count| count + self.velocity_counts);
    }

    /// Position in the encoder's frame, mm.
    #[must_use]
    pub fn encoder_mm(&self) -> f64 {
        self.count.map_or(0.0, |count| self.mm_of(count))
    }

    fn mm_of(&self, count: i64) -> f64 {
        // Added to 0, a reversed axis has no negative zero.
        0.0 + (count - self.zero_count) as f64 / self.counts_per_mm
    }

    /// What its touch probe has latched.
    #[must_use]
    pub fn latch(&self) -> Option<ProbeLatch> {
        let (probe, count) = self.probe.as_ref().zip(self.latched_count)?;
        Some(ProbeLatch { signal: probe.signal(), encoder_mm: self.mm_of(count) })
    }

    /// Arms its touch probe while the signal that is wired to it is awaited.
    pub fn arm_probe(&mut self, awaited_signal: u8, image: &mut DeviceImage) {
        if let Some(probe) = &mut self.probe {
            probe.write(awaited_signal == probe.signal(), image);
        }
    }

    /// Whether its position is that of an absolute encoder.
    #[must_use]
    pub const fn is_absolute(&self) -> bool {
        self.is_absolute && self.count.is_some()
    }

    /// What its encoder counts (object 6064h), once it has been read.
    #[must_use]
    pub fn raw_count(&self) -> Option<i32> {
        self.count.map(|count| count as i32)
    }

    /// Torque in percent of the rated one, where the drive sends it; positive in the plus direction of the axis.
    #[must_use]
    pub fn torque_percent(&self) -> Option<f64> {
        // Added to 0, a reversed axis has no negative zero.
        self.fields.torque.map(|_| 0.0 + self.counts_per_mm.signum() * f64::from(self.torque) / 10.0)
    }

    /// State of the drive at `now`, with its brake.
    #[must_use]
    pub fn state(&self, now: Micros) -> DriveState {
        if self.power.is_fault() {
            return DriveState::Fault(self.fault);
        }
        let released = self.enabled_since.is_some_and(|since| now.since(since) >= self.release_time());
        match self.demand {
            Demand::Off(_) | Demand::Dropped => DriveState::Off,
            Demand::On if self.power == PowerState::OperationEnabled && released => DriveState::Enabled,
            Demand::On => DriveState::SwitchingOn,
        }
    }

    /// Whether the drive has torque, or brakes by itself.
    const fn has_torque(&self) -> bool {
        matches!(
            self.power,
            PowerState::OperationEnabled | PowerState::QuickStopActive | PowerState::FaultReactionActive
        )
    }

    /// Whether the drive is in a fault whose code is to be read by mailbox.
    #[must_use]
    pub fn is_code_missing(&self) -> bool {
        self.power == PowerState::Fault && self.fault == DriveFault::UNKNOWN && self.fields.error_code.is_none()
    }

    /// The error code that was read by mailbox.
    pub const fn set_fault(&mut self, fault: DriveFault) {
        self.fault = fault;
    }

    /// RESET: a drive in a fault is to leave it, also one that reports it only after the bus is back.
    pub const fn reset_fault(&mut self) {
        self.resetting = true;
    }

    /// RESET is over: a fault that is still there stays until the next one.
    pub const fn end_reset(&mut self) {
        self.resetting = false;
    }

    fn release_time(&self) -> Micros {
        self.brake.as_ref().map_or(Micros::ZERO, |brake| Micros::from_millis_f64(1_000.0 * brake.release_s))
    }

    /// Time from the end of the release until the brake holds.
    #[must_use]
    pub fn engage_time(&self) -> Micros {
        self.brake.as_ref().map_or(Micros::ZERO, |brake| Micros::from_millis_f64(1_000.0 * brake.engage_s))
    }

    /// Port of the brake, and whether it is to be released: while the axis is to follow, and while the drive stops it.
    #[must_use]
    pub fn brake_release(&self) -> Option<(u8, bool)> {
        let brake = self.brake.as_ref()?;
        let stops = matches!(self.power, PowerState::QuickStopActive | PowerState::FaultReactionActive);
        Some((brake.port, stops || self.power == PowerState::OperationEnabled && self.demand == Demand::On))
    }

    /// Writes what the drive gets in the next exchange. A drive without torque gets its actual position, so that nothing
    /// jumps when it is enabled.
    pub fn write(&mut self, now: Micros, asked: AxisSetPoint, image: &mut DeviceImage) {
        self.demand = match (self.demand, asked.on) {
            (Demand::Off(since), false) => Demand::Off(since),
            (Demand::On | Demand::Dropped, false) => Demand::Off(now),
            (Demand::Off(_), true) => {
                // The brake has begun to engage: it is released anew.
                self.enabled_since = self.enabled_since.map(|_| now);
                Demand::On
            }
            (demand @ (Demand::On | Demand::Dropped), true) => demand,
        };
        let controlword = self.controlword(now, self.fields.controlword.read(&image.outputs) as u16);
        self.fields.controlword.write(&mut image.outputs, u32::from(controlword));
        if let Some(mode) = self.fields.mode {
            mode.write(&mut image.outputs, u32::from(CYCLIC_SYNCHRONOUS_POSITION));
        }
        let target = match self.state(now) {
            DriveState::Enabled => {
                self.zero_count.wrapping_add((asked.position_mm * self.counts_per_mm).round() as i64)
            }
            // With torque, and the brake on its way: the axis is held where it is, by its last target.
            DriveState::Off | DriveState::SwitchingOn | DriveState::Fault(_) if self.has_torque() => return,
            DriveState::Off | DriveState::SwitchingOn | DriveState::Fault(_) => self.count.unwrap_or_default(),
        };
        self.fields.target_position.write(&mut image.outputs, target as u32);
    }

    /// The next step of the power state machine. The brake holds before the torque goes, and a drive that stops by itself
    /// is left alone until it stands.
    fn controlword(&self, now: Micros, last: u16) -> u16 {
        if self.resetting && self.power.is_fault() {
            return PowerState::controlword_reset(last);
        }
        match self.demand {
            _ if self.power == PowerState::QuickStopActive && self.velocity_counts.abs() > STANDSTILL_COUNTS => {
                cia402::QUICK_STOP
            }
            Demand::Off(since)
                if self.power == PowerState::OperationEnabled && now.since(since) < self.engage_time() =>
            {
                self.power.controlword_on()
            }
            Demand::Off(_) | Demand::Dropped => self.power.controlword_off(),
            Demand::On => self.power.controlword_on(),
        }
    }
}
