//! What the pages of parameters and settings ask of the core, and what the disk answers.
//! A password goes through the core to the disk and never comes back; the core learns whether it fitted.
//! Source: spec B6 (passwords, stored hashed), K6.1, K6.2.

use std::fmt;

use super::files::{FileAnswer, FileRequest, Ticket};
use crate::defs::date::Date;
use crate::defs::kind::Kind;
use crate::defs::param::{Level, ParamAddress};
use crate::defs::screw::ScrewTable;
use crate::defs::text::{Lang, Said, Text};
use crate::units::Axis;

/// What a password opens.
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
    /// All of them.
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

    /// The password that a level asks for.
    #[must_use]
    pub const fn of(level: Level) -> Option<Self> {
        match level {
            Level::Operator => None,
            Level::User => Some(Self::User),
            Level::Builder => Some(Self::Builder),
        }
    }

    /// The level that the password opens.
    #[must_use]
    pub const fn level(self) -> Level {
        match self {
            Self::Program => Level::Operator,
            Self::User => Level::User,
            Self::Builder => Level::Builder,
        }
    }
}

/// A password on its way. It is never written into a message or a trace.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// A password as typed.
    #[must_use]
    pub const fn new(text: String) -> Self {
        Self(text)
    }

    /// The text, for the one place that hashes it.
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

/// Least and most digits of a new password: digits only, so that the touch pad can type it.
pub const PASSWORD_LENGTH: std::ops::RangeInclusive<usize> = 4..=16;

/// How far the picture can be dimmed, percent: the darkest can still be read.
pub const BRIGHTNESS: std::ops::RangeInclusive<u8> = 70..=100;
/// A step of it.
pub const BRIGHTNESS_STEP: u8 = 10;

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum PageCommand {
    /// A parameter typed at the parameter page: asks for the level that it needs.
    EditParam(ParamAddress, f64),
    /// Another table for an axis' screw (B7): the machine builder's.
    EditScrew(Axis, ScrewTable),
    /// Opens a level until power-off.
    Unlock(Guard, Secret),
    /// Closes every level.
    Lock,
    /// Replaces a password; the old one is asked for.
    ChangePassword {
        /// Which.
        of: Guard,
        /// As it was.
        old: Secret,
        /// As it is to be.
        new: Secret,
    },
    /// Another kind of machine from the next start on.
    KeepKind(Kind),
    /// The language of the screen, now and at the next start.
    KeepLang(Lang),
    /// The light or the dark theme, now and at the next start.
    KeepLight(bool),
    /// Brightness of the picture in percent, now and at the next start.
    KeepBrightness(u8),
    /// Another RS232 port, from now on.
    KeepPort(String),
    /// Date and time of day, from now on.
    SetDate(Date),
    /// What concerns programs and folders, and the long calculations.
    File(Ticket, FileRequest),
    /// The disk's answer to a wish.
    Answered(PageAnswer),
}

/// What the disk is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum PageWish {
    /// Does the password fit?
    Check(Guard, Secret),
    /// Replace a password if the old one fits.
    Change {
        /// Which.
        of: Guard,
        /// As it was.
        old: Secret,
        /// As it is to be.
        new: Secret,
    },
    /// Keep the kind for the next start.
    KeepKind(Kind),
    /// Keep the language for the next start.
    KeepLang(Lang),
    /// Keep the theme for the next start.
    KeepLight(bool),
    /// Keep the brightness for the next start.
    KeepBrightness(u8),
    /// Keep the RS232 port.
    KeepPort(String),
}

/// What the disk answers.
#[derive(Clone, Debug, PartialEq)]
pub enum PageAnswer {
    /// Whether a password fits.
    Checked(Guard, bool),
    /// Whether a password was replaced: the old one fitted.
    Changed(Guard, bool),
    /// The kind of the next start is kept.
    KindKept(Kind),
    /// The language is kept.
    LangKept,
    /// An answer of the work beside the tick.
    File(Ticket, FileAnswer),
    /// The disk refused.
    Failed(Said),
}
