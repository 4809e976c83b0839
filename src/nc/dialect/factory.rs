//! What differs from language to language before the first block: settings as a machine leaves the factory, and the
//! numbers under which the same states are told.

use super::super::settings::{Settings, SpeedUnit, System, Turning};
use crate::units::PerAxis;

/// The G codes that tell the same state in every language.
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

/// The G codes of a language.
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
    /// GC as it leaves the factory: X (diameter) and Z.
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

    /// GS and GA as they leave the factory: X, Y, Z in radius.
    #[must_use]
    pub fn mill() -> Self {
        Self { system: System::Mill, diameter: false, axes: PerAxis([true; 3]), ..Self::lathe() }
    }

    /// The vertical lathe-grinder as it leaves the factory: X (diameter) and Z.
    #[must_use]
    pub fn sinumerik() -> Self {
        Self { system: System::Sinumerik, exact_stop: true, ..Self::lathe() }
    }

    /// The 超人 lathe as it leaves the factory: X (diameter) and Z.
    #[must_use]
    pub fn superman() -> Self {
        let tools = 4;
        Self { system: System::SuperMan, exact_stop: true, zero_at_start: true, numbered: true, tools, ..Self::lathe() }
    }

    /// As a machine with programs of this language leaves the factory.
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
