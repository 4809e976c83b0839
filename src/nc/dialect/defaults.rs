//! Defaults of each dialect: factory settings, and the G codes that display the modal states.

use super::super::settings::{Dialect, NcSettings, SpeedUnit, SuperManSettings};
use crate::units::PerAxis;

/// The G codes of modal states in a dialect.
pub(crate) struct ModalCodes {
    /// G90 and G91 are modal.
    pub distance_is_modal: bool,
    /// Feed per minute and per revolution.
    pub per_minute: u8,
    pub per_rev: u8,
    /// Inches and millimetres.
    pub inch: u8,
    pub metric: u8,
    /// Exact stop.
    pub exact_stop: u8,
}

/// The G codes of modal states in a dialect.
#[must_use]
pub(crate) const fn modal_codes(system: Dialect) -> ModalCodes {
    let modal_distance = !matches!(system, Dialect::LatheA | Dialect::SuperMan);
    match system {
        Dialect::LatheA | Dialect::Mill | Dialect::SuperMan => ModalCodes {
            distance_is_modal: modal_distance,
            per_minute: 98,
            per_rev: 99,
            inch: 20,
            metric: 21,
            exact_stop: 61,
        },
        Dialect::Sinumerik => ModalCodes {
            distance_is_modal: modal_distance,
            per_minute: 94,
            per_rev: 95,
            inch: 70,
            metric: 71,
            exact_stop: 60,
        },
    }
}

impl NcSettings {
    /// Factory settings of GC: X (diameter) and Z.
    #[must_use]
    pub fn lathe_a() -> Self {
        Self {
            dialect: Dialect::LatheA,
            diameter: true,
            axes: PerAxis([true, false, true]),
            least_increment_mm: None,
            inch: false,
            tolerance_mm: 0.01,
            arc_tolerance_mm: 0.01,
            speed_unit: SpeedUnit::Rpm,
            jump_input: 0,
            tool_count: 16,
            exact_stop: false,
            start_is_work_zero: false,
            needs_block_numbers: false,
            superman: SuperManSettings::default(),
            oscillation_by_cylinder: false,
            rapid_mm_min: PerAxis([6_000.0; 3]),
        }
    }

    /// Factory settings of GS and GA: X, Y, Z in radius.
    #[must_use]
    pub fn mill() -> Self {
        Self { dialect: Dialect::Mill, diameter: false, axes: PerAxis([true; 3]), ..Self::lathe_a() }
    }

    /// Factory settings of the vertical lathe-grinder: X (diameter) and Z.
    #[must_use]
    pub fn sinumerik() -> Self {
        Self { dialect: Dialect::Sinumerik, exact_stop: true, ..Self::lathe_a() }
    }

    /// Factory settings of the 超人 lathe: X (diameter) and Z.
    #[must_use]
    pub fn superman() -> Self {
        let tools = 4;
        Self {
            dialect: Dialect::SuperMan,
            exact_stop: true,
            start_is_work_zero: true,
            needs_block_numbers: true,
            tool_count: tools,
            ..Self::lathe_a()
        }
    }

    /// Factory settings of a machine with programs of this dialect.
    #[must_use]
    pub fn for_dialect(system: Dialect) -> Self {
        match system {
            Dialect::LatheA => Self::lathe_a(),
            Dialect::Mill => Self::mill(),
            Dialect::Sinumerik => Self::sinumerik(),
            Dialect::SuperMan => Self::superman(),
        }
    }
}
