//! The alarms as the network knows them: conditions of MTConnect, each with its level.
//! Source: ANSI/MTC1.4 (MTConnect 2.2), part 3.

use super::data_item::Component;
use super::snapshot::{AlarmView, Snapshot};
use crate::defs::alarm::{self, Reaction};
use crate::defs::text::Text;

/// A group of alarms that the network knows as one condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The control and its data, and the emergency stop.
    System,
    /// The field bus, stations, serial line.
    Communications,
    /// Interlocks.
    Logic,
    /// Programs.
    Motion,
    /// The drives of the axes.
    Drives,
    /// The wheel, or the main spindle.
    Spindle,
    /// Hydraulics.
    Hydraulic,
    /// Coolant.
    Coolant,
    /// Lubrication.
    Lubrication,
}

impl Condition {
    /// All conditions.
    pub const ALL: [Self; 9] = [
        Self::System,
        Self::Communications,
        Self::Logic,
        Self::Motion,
        Self::Drives,
        Self::Spindle,
        Self::Hydraulic,
        Self::Coolant,
        Self::Lubrication,
    ];

    /// Those of a machine.
    pub fn of_machine(snapshot: &Snapshot) -> impl Iterator<Item = Self> + use<'_> {
        Self::ALL.into_iter().filter(|condition| condition.row().1.is_fitted(snapshot))
    }

    /// Id, component and type in the standard.
    #[must_use]
    pub const fn row(self) -> (&'static str, Component, &'static str) {
        match self {
            Self::System => ("c_system", Component::Controller, "SYSTEM"),
            Self::Communications => ("c_communications", Component::Controller, "COMMUNICATIONS"),
            Self::Logic => ("c_logic", Component::Controller, "LOGIC_PROGRAM"),
            Self::Motion => ("c_motion", Component::Path, "MOTION_PROGRAM"),
            Self::Drives => ("c_drives", Component::Axes, "ACTUATOR"),
            Self::Spindle => ("c_spindle", Component::Spindle, "ACTUATOR"),
            Self::Hydraulic => ("c_hydraulic", Component::Hydraulic, "ACTUATOR"),
            Self::Coolant => ("c_coolant", Component::Coolant, "ACTUATOR"),
            Self::Lubrication => ("c_lubrication", Component::Lubrication, "ACTUATOR"),
        }
    }

    /// What it is, for people.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::System => Text::new("报警：系统", "alarms: system"),
            Self::Communications => Text::new("报警：通讯", "alarms: communications"),
            Self::Logic => Text::new("报警：联锁", "alarms: interlocks"),
            Self::Motion => Text::new("报警：程序", "alarms: program"),
            Self::Drives => Text::new("报警：驱动", "alarms: drives"),
            Self::Spindle => Text::new("报警：主轴", "alarms: spindle"),
            Self::Hydraulic => Text::new("报警：液压", "alarms: hydraulics"),
            Self::Coolant => Text::new("报警：冷却", "alarms: coolant"),
            Self::Lubrication => Text::new("报警：润滑", "alarms: lubrication"),
        }
    }

    /// Its worst alarm: a fault stands before a warning.
    #[must_use]
    pub fn worst(self, snapshot: &Snapshot) -> Option<&AlarmView> {
        let raised = snapshot.alarms.iter().filter(move |alarm| Self::of_alarm(alarm.number) == self);
        raised.min_by_key(|alarm| level(alarm.number) != FAULT)
    }

    /// The condition of an alarm.
    #[must_use]
    pub const fn of_alarm(number: u16) -> Self {
        match number {
            alarm::HYDRAULIC_PRESSURE => Self::Hydraulic,
            alarm::COOLANT_FLOW => Self::Coolant,
            alarm::LUBRICATION_LEVEL => Self::Lubrication,
            alarm::WHEEL_OVERSPEED | alarm::WHEEL_DIAMETER_REFUSED | alarm::INVERTER_FAULT => Self::Spindle,
            alarm::PROGRAM_MISSING | alarm::SOFT_LIMIT => Self::Motion,
            alarm::BUS_LOST | alarm::STATION_SILENT => Self::Communications,
            alarm::EMERGENCY_STOP | alarm::PAGE_FILES_INVALID | alarm::POWER_FAIL => Self::System,
            _ => Self::of_range(number),
        }
    }

    /// The condition of an alarm by the range of its number.
    const fn of_range(number: u16) -> Self {
        match number {
            100..=179 => Self::Drives,
            180..=299 => Self::Logic,
            310..=319 => Self::Communications,
            300..=309 | 320..=499 => Self::System,
            // Those of programs.
            0..=99 | 500.. => Self::Motion,
        }
    }
}

/// Level of an alarm that stops or blocks something.
pub const FAULT: &str = "FAULT";

/// The level of an alarm: `FAULT` if something is stopped or blocked until somebody acts, otherwise `WARNING`.
#[must_use]
pub fn level(number: u16) -> &'static str {
    if alarm::reaction(number) == Reaction::Show { "WARNING" } else { FAULT }
}
