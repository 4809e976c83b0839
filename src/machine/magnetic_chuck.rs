//! The magnetic chuck: magnetising holds the part, demagnetising releases it by decaying reversals.
//! Source: spec K3.11, P3. Reset and e-stop leave it as it is: the part must stay clamped while the wheel coasts.

use crate::defs::param::{self, Params};
use crate::units::Micros;

/// State of the chuck.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MagneticChuck {
    /// Both outputs off.
    #[default]
    Off,
    /// Magnetise output on; full force not reached yet.
    Magnetising { since: Micros },
    /// Magnetise output on, the part is held.
    Holding,
    /// Demagnetise output on.
    Demagnetising { since: Micros },
}

impl MagneticChuck {
    pub fn magnetise(&mut self, now: Micros) {
        *self = match *self {
            Self::Off | Self::Demagnetising { .. } => Self::Magnetising { since: now },
            busy @ (Self::Magnetising { .. } | Self::Holding) => busy,
        };
    }

    pub fn demagnetise(&mut self, now: Micros) {
        *self = match *self {
            Self::Off | Self::Magnetising { .. } | Self::Holding => Self::Demagnetising { since: now },
            busy @ Self::Demagnetising { .. } => busy,
        };
    }

    /// The magnetise output.
    pub const fn is_on(self) -> bool {
        matches!(self, Self::Magnetising { .. } | Self::Holding)
    }

    /// The demagnetise output.
    pub const fn is_demagnetising(self) -> bool {
        matches!(self, Self::Demagnetising { .. })
    }

    /// The part is held.
    pub const fn is_holding(self) -> bool {
        matches!(self, Self::Holding)
    }

    /// Magnetising or demagnetising.
    pub const fn is_busy(self) -> bool {
        matches!(self, Self::Magnetising { .. } | Self::Demagnetising { .. })
    }

    pub fn tick(&mut self, now: Micros, params: &Params) {
        let due = |since: Micros, row| now.since(since) >= params.millis(row);
        match *self {
            Self::Magnetising { since } if due(since, param::MAGNETISE_TIME) => *self = Self::Holding,
            Self::Demagnetising { since } if due(since, param::DEMAGNETISE_TIME) => *self = Self::Off,
            Self::Off | Self::Magnetising { .. } | Self::Holding | Self::Demagnetising { .. } => {}
        }
    }
}
