//! Requests of the parameter and settings pages to the core, and the answers of the disk thread.
//! A password goes through the core to the disk thread and never comes back; the core learns only whether it matches.
//! Source: spec B6 (passwords, stored hashed), K6.1, K6.2.

use std::fmt;

use super::files::{FileAnswer, FileRequest, Ticket};
use crate::defs::date::Date;
use crate::defs::kind::Kind;
use crate::defs::param::{Level, ParamAddress};
use crate::defs::screw::ScrewTable;
use crate::defs::text::{Lang, Said, Text};
use crate::units::Axis;

/// What a password unlocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Guard {
    /// Editing programs (K6.2).
    Program,
    /// User parameters.
    User,
    /// The machine builder's parameters and the kind of machine.
    Builder,
}

impl Guard {
    /// All scopes.
    pub const ALL: [Self; 3] = [Self::Program, Self::User, Self::Builder];

    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Program => Text::new("程序编辑", "program edit"),
            Self::User => Text::new("用户参数", "user parameters"),
            Self::Builder => Text::new("机床厂参数", "machine builder"),
        }
    }

    /// The password that a level requires.
    #[must_use]
    pub const fn of(level: Level) -> Option<Self> {
        match level {
            Level::Operator => None,
            Level::User => Some(Self::User),
            Level::Builder => Some(Self::Builder),
        }
    }

    /// The level that the password unlocks.
    #[must_use]
    pub const fn level(self) -> Level {
        match self {
            Self::Program => Level::Operator,
            Self::User => Level::User,
            Self::Builder => Level::Builder,
        }
    }
}

/// A password in transit. It never appears in a message or a trace.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// A password as typed.
    #[must_use]
    pub const fn new(text: String) -> Self {
        Self(text)
    }

    /// The text; only for hashing.
    #[must_use]
    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(…)")
    }
}

/// Number of digits of a new password; digits only, because the numeric pad must be able to enter it.
pub const PASSWORD_LENGTH: std::ops::RangeInclusive<usize> = 4..=16;

/// Range of the picture brightness, percent; the darkest picture is still readable.
pub const BRIGHTNESS: std::ops::RangeInclusive<u8> = 70..=100;
/// Step of the brightness, percent.
pub const BRIGHTNESS_STEP: u8 = 10;

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum PageCommand {
    /// Changes a parameter from the parameter page; requires the level of the parameter.
    EditParam(ParamAddress, f64),
    /// Changes the leadscrew table of an axis (B7); requires the machine builder's level.
    EditScrew(Axis, ScrewTable),
    /// Unlocks a level until power-off.
    Unlock(Guard, Secret),
    /// Locks all levels.
    Lock,
    /// Replaces a password; requires the old one.
    ChangePassword {
        /// The password to replace.
        of: Guard,
        /// The old password.
        old: Secret,
        /// The new password.
        new: Secret,
    },
    /// Selects the kind of machine from the next start on.
    KeepKind(Kind),
    /// Sets the language of the screen, now and at the next start.
    KeepLang(Lang),
    /// Selects the light theme (true) or the dark theme, now and at the next start.
    KeepLight(bool),
    /// Sets the picture brightness, percent, now and at the next start.
    KeepBrightness(u8),
    /// Selects the RS232 port, from now on.
    KeepPort(String),
    /// Sets date and time of day.
    SetDate(Date),
    /// A request about programs or folders, or for a long calculation.
    File(Ticket, FileRequest),
    /// The disk thread's answer to a request.
    Answered(PageAnswer),
}

/// A request to the disk thread.
#[derive(Clone, Debug, PartialEq)]
pub enum PageWish {
    /// Checks a password.
    Check(Guard, Secret),
    /// Replaces a password if the old one matches.
    Change {
        /// The password to replace.
        of: Guard,
        /// The old password.
        old: Secret,
        /// The new password.
        new: Secret,
    },
    /// Saves the kind for the next start.
    KeepKind(Kind),
    /// Saves the language for the next start.
    KeepLang(Lang),
    /// Saves the theme for the next start.
    KeepLight(bool),
    /// Saves the brightness for the next start.
    KeepBrightness(u8),
    /// Saves the RS232 port.
    KeepPort(String),
}

/// An answer of the disk thread.
#[derive(Clone, Debug, PartialEq)]
pub enum PageAnswer {
    /// Whether a password matches.
    Checked(Guard, bool),
    /// Whether a password was replaced; false if the old one did not match.
    Changed(Guard, bool),
    /// The kind for the next start is saved.
    KindKept(Kind),
    /// The language is saved.
    LangKept,
    /// An answer of the work outside the tick.
    File(Ticket, FileAnswer),
    /// The disk thread failed; why.
    Failed(Said),
}
