//! Faults of the simulated machine by name (P8, tools.md "Faults").

use super::SimulatedMachine;
use crate::defs::signal::{Input, PORTS};
use crate::defs::sim_fault::{FAULTS, FaultArgument};
use crate::units::{Axis, PerAxis};

/// Longest bus fault, ticks.
const BUS_TICKS_LIMIT: u32 = 1_000_000;

/// Why a fault or an input name is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// There is no fault with this name.
    #[error("there is no fault '{0}'; `fault list` shows all of them")]
    Unknown(String),
    /// The argument is not the id of an input, or not a port.
    #[error("'{0}' is not the id of an input")]
    Input(String),
    /// The argument is not a number of ticks in range.
    #[error("'{0}' is not a number of ticks from 1 to {BUS_TICKS_LIMIT}")]
    Ticks(String),
    /// A fault without argument is followed by one.
    #[error("'{0}' has no argument, but '{1}' is given")]
    UnexpectedArgument(&'static str, String),
}

/// A parsed fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SimFault {
    StuckOn(Input),
    StuckOff(Input),
    Bounce(Input),
    PressureLoss,
    Drive(Axis),
    Following(Axis),
    WornScrew(Axis),
    GaugeDead,
    CoolantMissing,
    LubricationMissing,
    BusLate(u32),
    BusSilent(u32),
    SupplyLoss,
}

impl SimFault {
    /// Parses a fault, in upper or lower case. `ticks_optional` allows the number to be omitted, to end a fault.
    pub(super) fn parse(text: &str, ticks_optional: bool) -> Result<Self, FaultError> {
        let lower = text.trim().to_ascii_lowercase();
        let (word, rest) = lower.split_once(char::is_whitespace).map_or((lower.as_str(), ""), |(w, r)| (w, r.trim()));
        let input = || Input::from_id(rest).ok_or_else(|| FaultError::Input(rest.to_owned()));
        let ticks = || match rest.parse::<u32>() {
            Ok(n) if (1..=BUS_TICKS_LIMIT).contains(&n) => Ok(n),
            _ if rest.is_empty() && ticks_optional => Ok(1),
            _ => Err(FaultError::Ticks(rest.to_owned())),
        };
        let row = FAULTS.iter().find(|row| row.name == word).ok_or_else(|| FaultError::Unknown(word.to_owned()))?;
        if row.argument == FaultArgument::None && !rest.is_empty() {
            return Err(FaultError::UnexpectedArgument(row.name, rest.to_owned()));
        }
        Ok(match word {
            "stuck-on" => Self::StuckOn(input()?),
            "stuck-off" => Self::StuckOff(input()?),
            "bounce" => Self::Bounce(input()?),
            "bus-late" => Self::BusLate(ticks()?),
            "bus-silent" => Self::BusSilent(ticks()?),
            "pressure-loss" => Self::PressureLoss,
            "gauge-dead" => Self::GaugeDead,
            "coolant-missing" => Self::CoolantMissing,
            "lubrication-missing" => Self::LubricationMissing,
            "supply-loss" => Self::SupplyLoss,
            "drive-x" => Self::Drive(Axis::X),
            "drive-y" => Self::Drive(Axis::Y),
            "drive-z" => Self::Drive(Axis::Z),
            "following-x" => Self::Following(Axis::X),
            "following-y" => Self::Following(Axis::Y),
            "following-z" => Self::Following(Axis::Z),
            "worn-screw-x" => Self::WornScrew(Axis::X),
            "worn-screw-y" => Self::WornScrew(Axis::Y),
            "worn-screw-z" => Self::WornScrew(Axis::Z),
            _ => return Err(FaultError::Unknown(word.to_owned())),
        })
    }
}

/// The active faults, except those of switches, which the wiring holds.
///
/// DECISION: `bus-late N` – for N ticks the bus answers one tick late: the first has no answer, outputs arrive one tick
/// late; `bus-silent N` – for N ticks there is no answer and outputs do not arrive; drives hold the last set-point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActiveFaults {
    pub pressure_loss: bool,
    pub drive: PerAxis<bool>,
    pub following: PerAxis<bool>,
    pub gauge_dead: bool,
    pub coolant_missing: bool,
    pub lubrication_missing: bool,
    pub supply_loss: bool,
    /// Remaining ticks in which the bus answers one tick late.
    pub late_ticks: u32,
    /// The bus was late in the tick before.
    pub was_late: bool,
    /// Remaining ticks in which the bus is silent.
    pub silent_ticks: u32,
}

impl SimulatedMachine {
    /// Checks the text of a fault, so that a story can be checked before it is played.
    ///
    /// # Errors
    /// The name, its input or its number of ticks is wrong.
    pub fn check_fault(text: &str) -> Result<(), FaultError> {
        SimFault::parse(text, false).map(drop)
    }

    /// As [`Self::check_fault`], for the end of a fault: the number of ticks may be omitted.
    ///
    /// # Errors
    /// The name or its input is wrong.
    pub fn check_ended_fault(text: &str) -> Result<(), FaultError> {
        SimFault::parse(text, true).map(drop)
    }

    /// Injects a fault by name.
    ///
    /// # Errors
    /// The name, its input or its number of ticks is wrong; nothing changes.
    pub fn inject_fault(&mut self, text: &str) -> Result<(), FaultError> {
        self.set_fault(SimFault::parse(text, false)?, true);
        Ok(())
    }

    /// Ends a fault by name; the number of ticks may be omitted.
    ///
    /// # Errors
    /// The name or its input is wrong.
    pub fn clear_fault(&mut self, text: &str) -> Result<(), FaultError> {
        self.set_fault(SimFault::parse(text, true)?, false);
        Ok(())
    }

    /// Forces an input, by id or port, logically on or off regardless of its polarity; `None` ends the forcing.
    ///
    /// # Errors
    /// The text is neither an input id nor a port.
    pub fn force_input(&mut self, name_or_port: &str, on: Option<bool>) -> Result<(), FaultError> {
        let word = name_or_port.trim();
        let port = word.parse().ok().filter(|port| (1..=PORTS).contains(port));
        match (Input::from_id(&word.to_ascii_lowercase()), port) {
            (Some(input), _) => self.wiring.force(input, on),
            (None, Some(port)) => self.wiring.force_port(port, on),
            (None, None) => return Err(FaultError::Input(word.to_owned())),
        }
        Ok(())
    }

    fn set_fault(&mut self, fault: SimFault, present: bool) {
        match fault {
            SimFault::StuckOn(input) => self.wiring.set_stuck(input, present.then_some(true)),
            SimFault::StuckOff(input) => self.wiring.set_stuck(input, present.then_some(false)),
            SimFault::Bounce(input) => self.wiring.set_bouncing(input, present),
            SimFault::PressureLoss => self.active_faults.pressure_loss = present,
            SimFault::Drive(axis) => self.active_faults.drive[axis] = present,
            SimFault::Following(axis) => self.active_faults.following[axis] = present,
            SimFault::WornScrew(axis) => self.axes[axis].iter_mut().for_each(|axis| axis.screw_worn = present),
            SimFault::GaugeDead => self.active_faults.gauge_dead = present,
            SimFault::CoolantMissing => self.active_faults.coolant_missing = present,
            SimFault::LubricationMissing => self.active_faults.lubrication_missing = present,
            SimFault::SupplyLoss => self.active_faults.supply_loss = present,
            SimFault::BusLate(ticks) => self.active_faults.late_ticks = if present { ticks } else { 0 },
            SimFault::BusSilent(ticks) => self.active_faults.silent_ticks = if present { ticks } else { 0 },
        }
    }
}
