//! Defaults of each dialect: factory settings, and the G codes that display the modal states.

use super::super::settings::{Settings, SpeedUnit, System, Turning};
use crate::units::PerAxis;

/// The G codes of modal states in a dialect.
pub(crate) struct Spelling {
    /// G90 and G91 are modal.
    pub modal_distance: bool,
    /// Feed per minute and per revolution.
    pub per_minute: u8,
    pub per_rev: u8,
    /// Inches and millimetres.
    pub inch: u8,
    pub metric: u8,
    /// Exact stop.
    pub exact: u8,
}

/// The G codes of modal states in a dialect.
#[must_use]
pub(crate) const fn spelling(system: System) -> Spelling {
    let modal_distance = !matches!(system, System::LatheA | System::SuperMan);
    match system {
        System::LatheA | System::Mill | System::SuperMan => {
            Spelling { modal_distance, per_minute: 98, per_rev: 99, inch: 20, metric: 21, exact: 61 }
        }
        System::Sinumerik => Spelling { modal_distance, per_minute: 94, per_rev: 95, inch: 70, metric: 71, exact: 60 },
    }
}

impl Settings {
    /// Factory settings of GC: X (diameter) and Z.
    #[must_use]
    pub fn lathe() -> Self {
        Self {
            system: System::LatheA,
            diameter: true,
            axes: PerAxis([true, false, true]),
            least_increment_mm: None,
            inch: false,
            tolerance_mm: 0.01,
            arc_tolerance_mm: 0.01,
            speed_unit: SpeedUnit::Rpm,
            jump_input: 0,
            tools: 16,
            exact_stop: false,
            zero_at_start: false,
            numbered: false,
            turning: Turning::default(),
            oscillation_by_cylinder: false,
            rapid_mm_min: PerAxis([6_000.0; 3]),
        }
    }

    /// Factory settings of GS and GA: X, Y, Z in radius.
    #[must_use]
    pub fn mill() -> Self {
        Self { system: System::Mill, diameter: false, axes: PerAxis([true; 3]), ..Self::lathe() }
    }

    /// Factory settings of the vertical lathe-grinder: X (diameter) and Z.
    #[must_use]
    pub fn sinumerik() -> Self {
        Self { system: System::Sinumerik, exact_stop: true, ..Self::lathe() }
    }

    /// Factory settings of the 超人 lathe: X (diameter) and Z.
    #[must_use]
    pub fn superman() -> Self {
        let tools = 4;
        Self { system: System::SuperMan, exact_stop: true, zero_at_start: true, numbered: true, tools, ..Self::lathe() }
    }

    /// Factory settings of a machine with programs of this dialect.
    #[must_use]
    pub fn of(system: System) -> Self {
        match system {
            System::LatheA => Self::lathe(),
            System::Mill => Self::mill(),
            System::Sinumerik => Self::sinumerik(),
            System::SuperMan => Self::superman(),
        }
    }
}
