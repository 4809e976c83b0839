//! Wheel, workpiece drive and second spindle: contactors with run-up times.
//! Source: spec K3.1, K3.4, K3.14.

use crate::defs::param::{self, Params};
use crate::units::Micros;

/// The wheel contactor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WheelContactor {
    /// Off.
    #[default]
    Off,
    /// On, its run-up time is not over.
    RunUp { since: Micros },
    /// On, at speed.
    Running,
}

impl WheelContactor {
    pub fn is_on(self) -> bool {
        self != Self::Off
    }

    pub fn start(&mut self, now: Micros) {
        if *self == Self::Off {
            *self = Self::RunUp { since: now };
        }
    }

    pub fn tick(&mut self, now: Micros, params: &Params) {
        if let Self::RunUp { since } = *self
            && now.since(since) >= params.millis(param::WHEEL_RUN_UP)
        {
            *self = Self::Running;
        }
    }
}

/// Headstock, dresser roll or table, whichever the kind has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WorkpieceDrive {
    /// Off.
    #[default]
    Off,
    /// On, its run-up time is not over.
    RunUp { fast: bool, since: Micros },
    /// On, at speed.
    Running { fast: bool },
}

impl WorkpieceDrive {
    pub fn is_on(self) -> bool {
        self != Self::Off
    }

    /// True for high speed, false for low; `None` when off.
    pub const fn speed(self) -> Option<bool> {
        match self {
            Self::Off => None,
            Self::RunUp { fast, .. } | Self::Running { fast } => Some(fast),
        }
    }

    pub fn start(&mut self, fast: bool, now: Micros) {
        if self.speed() != Some(fast) {
            *self = Self::RunUp { fast, since: now };
        }
    }

    pub fn tick(&mut self, now: Micros, params: &Params) {
        if let Self::RunUp { fast, since } = *self
            && now.since(since) >= params.millis(param::HEADSTOCK_RUN_UP)
        {
            *self = Self::Running { fast };
        }
    }
}

/// The second spindle: never both directions at once, with a pause (P87) between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SecondSpindleContactor {
    /// Off.
    #[default]
    Off,
    /// On.
    Turning { ccw: bool },
    /// Switched off; the other direction follows after P87.
    Reversing { ccw: bool, since: Micros },
}

impl SecondSpindleContactor {
    pub fn start(&mut self, ccw: bool, now: Micros) {
        *self = match *self {
            Self::Off => Self::Turning { ccw },
            Self::Turning { ccw: other } if other != ccw => Self::Reversing { ccw, since: now },
            Self::Reversing { since, .. } => Self::Reversing { ccw, since },
            turning @ Self::Turning { .. } => turning,
        };
    }

    pub const fn direction(self) -> Option<bool> {
        match self {
            Self::Turning { ccw } => Some(ccw),
            Self::Off | Self::Reversing { .. } => None,
        }
    }

    pub const fn is_reversing(self) -> bool {
        matches!(self, Self::Reversing { .. })
    }

    pub fn tick(&mut self, now: Micros, params: &Params) {
        if let Self::Reversing { ccw, since } = *self
            && now.since(since) >= params.millis(param::SECOND_SPINDLE_PAUSE)
        {
            *self = Self::Turning { ccw };
        }
    }
}
