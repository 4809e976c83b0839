//! Main spindle and tool post of a lathe.
//!
//! The spindle is started and stopped by pulses of P386 (0.4 s) on separate outputs, for self-holding contactors.
//! The tool post turns forward until the switch of the wanted station is on, then in reverse for P389, which
//! clamps it. Source: spec L7, L8.

use crate::defs::alarm;
use crate::defs::param::{self, Params};
use crate::defs::signal::{Input, InputSet, Output, OutputSet};
use crate::units::Micros;

/// The main spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MainSpindle {
    /// Off.
    #[default]
    Off,
    /// The stop pulse is on.
    Stopping { since: Micros },
    /// The start pulse is on, or the spindle runs up.
    Starting { ccw: bool, since: Micros },
    /// Turning.
    Turning { ccw: bool },
}

impl MainSpindle {
    pub fn start(&mut self, ccw: bool, now: Micros) {
        if self.direction() != Some(ccw) {
            *self = Self::Starting { ccw, since: now };
        }
    }

    /// Every stop request gives a pulse, so that a spindle started elsewhere stops too.
    pub const fn stop(&mut self, now: Micros) {
        *self = Self::Stopping { since: now };
    }

    /// Direction, true counter-clockwise; `None` while it is off.
    pub const fn direction(self) -> Option<bool> {
        match self {
            Self::Off | Self::Stopping { .. } => None,
            Self::Starting { ccw, .. } | Self::Turning { ccw } => Some(ccw),
        }
    }

    /// No start or stop is in progress.
    pub const fn is_settled(self) -> bool {
        matches!(self, Self::Off | Self::Turning { .. })
    }

    pub fn tick(&mut self, now: Micros, params: &Params) {
        let pulse = params.millis(param::SPINDLE_PULSE_TIME);
        *self = match *self {
            Self::Stopping { since } if now.since(since) >= pulse => Self::Off,
            Self::Starting { ccw, since } if now.since(since) >= params.millis(param::SPINDLE_RUN_UP).max(pulse) => {
                Self::Turning { ccw }
            }
            state => state,
        };
    }

    pub fn write_outputs(self, now: Micros, params: &Params, on: &mut OutputSet) {
        let pulses = |since: Micros| now.since(since) < params.millis(param::SPINDLE_PULSE_TIME);
        match self {
            Self::Stopping { since } => on.set(Output::SpindleStop, pulses(since)),
            Self::Starting { ccw, since } => {
                let output = if ccw { Output::SpindleReverse } else { Output::SpindleForward };
                on.set(output, pulses(since));
            }
            Self::Off | Self::Turning { .. } => {}
        }
    }

    pub fn discrete(self, age: impl Fn(Micros) -> u8) -> u8 {
        match self {
            Self::Off => 0,
            Self::Turning { ccw } => 1 + u8::from(ccw),
            Self::Stopping { since } => 4 + age(since),
            Self::Starting { ccw, since } => 8 + 4 * u8::from(ccw) + age(since),
        }
    }
}

/// The tool post; stations count from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToolTurret {
    /// At rest, clamped.
    #[default]
    Clamped,
    /// Turning forward towards a station.
    Seeking { station: u8, since: Micros },
    /// Turning in reverse, which clamps it.
    Clamping { since: Micros },
}

impl ToolTurret {
    pub fn index_to(&mut self, station: u8, inputs: InputSet, now: Micros) {
        let there = station_in_position(inputs);
        let station = if station == 0 { there.map_or(1, |there| there % 4 + 1) } else { station };
        *self = if there == Some(station) { Self::Clamped } else { Self::Seeking { station, since: now } };
    }

    pub const fn is_moving(self) -> bool {
        !matches!(self, Self::Clamped)
    }

    /// One tick; returns the time-out alarm.
    pub fn supervise(&mut self, now: Micros, inputs: InputSet, params: &Params) -> Option<u16> {
        match *self {
            Self::Clamped => {}
            Self::Seeking { station, .. } if station_in_position(inputs) == Some(station) => {
                *self = Self::Clamping { since: now }
            }
            Self::Seeking { since, .. } if now.since(since) >= params.millis(param::TOOL_TURRET_TIMEOUT) => {
                *self = Self::Clamped;
                return Some(alarm::TOOL_TURRET_TIMEOUT);
            }
            Self::Clamping { since } if now.since(since) >= params.millis(param::TOOL_TURRET_CLAMP_TIME) => {
                *self = Self::Clamped;
            }
            Self::Seeking { .. } | Self::Clamping { .. } => {}
        }
        None
    }

    pub const fn write_outputs(self, on: &mut OutputSet) {
        on.set(Output::TurretForward, matches!(self, Self::Seeking { .. }));
        on.set(Output::TurretReverse, matches!(self, Self::Clamping { .. }));
    }

    pub fn discrete(self, age: impl Fn(Micros) -> u8) -> u8 {
        match self {
            Self::Clamped => 0,
            Self::Clamping { since } => 4 + age(since),
            Self::Seeking { station, since } => 8 + 4 * station + age(since),
        }
    }
}

/// The station whose switch alone is on.
pub fn station_in_position(inputs: InputSet) -> Option<u8> {
    let mut on = (1..=4).zip(Input::STATIONS).filter(|(_, input)| inputs.has(*input));
    let (station, _) = on.next()?;
    on.next().is_none().then_some(station)
}
