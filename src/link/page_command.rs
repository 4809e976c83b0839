//! Requests of the parameter and settings pages to the core, and the answers of the disk thread.
//! A password goes through the core to the disk thread and never comes back; the core learns only whether it matches.
//! Source: spec B6 (passwords, stored hashed), K6.1, K6.2.

use std::fmt;

use super::files::{FileAnswer, FileRequest, Ticket};
use super::scope::ScopeCommand;
use crate::defs::date::DateTime;
use crate::defs::downtime_reason::DowntimeReason;
use crate::defs::favourite::Favourite;
use crate::defs::kind::Kind;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::param::{AccessLevel, ParamAddress};
use crate::defs::text::{Lang, LocalizedText, Text};
use crate::units::Axis;

/// What a password unlocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PasswordScope {
    /// Editing programs (K6.2).
    Program,
    /// User parameters.
    User,
    /// The machine builder's parameters and the kind of machine.
    Builder,
}

impl PasswordScope {
    /// All scopes.
    pub const ALL: [Self; 3] = [Self::Program, Self::User, Self::Builder];

    /// The scope of a word in a story.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "program" => Some(Self::Program),
            "user" => Some(Self::User),
            "builder" => Some(Self::Builder),
            _ => None,
        }
    }

    /// The name shown.
    #[must_use]
    pub const fn name(self) -> &'static Text {
        match self {
            Self::Program => const { &Text::new("程序编辑", "program edit") },
            Self::User => const { &Text::new("用户参数", "user parameters") },
            Self::Builder => const { &Text::new("机床厂参数", "machine builder") },
        }
    }

    /// The password that a level requires.
    #[must_use]
    pub const fn for_level(level: AccessLevel) -> Option<Self> {
        match level {
            AccessLevel::Operator => None,
            AccessLevel::User => Some(Self::User),
            AccessLevel::Builder => Some(Self::Builder),
        }
    }

    /// The level that the password unlocks.
    #[must_use]
    pub const fn level(self) -> AccessLevel {
        match self {
            Self::Program => AccessLevel::Operator,
            Self::User => AccessLevel::User,
            Self::Builder => AccessLevel::Builder,
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

/// Sizes of the screen, percent; at more than the first the display shows a part of it.
pub const ZOOMS: [u16; 3] = [100, 150, 200];
/// Range of the picture brightness, percent; the darkest picture is still readable.
pub const BRIGHTNESS: std::ops::RangeInclusive<u8> = 70..=100;
/// Step of the brightness, percent.
pub const BRIGHTNESS_STEP: u8 = 10;

/// An earlier state of the retained data that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptState {
    /// The number of its commit.
    pub number: u64,
    /// When it was kept, as the pages show a time.
    pub time: String,
}

/// Which values take the place of lost data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DataChoice {
    /// Those that are in force, at once.
    Present,
    /// An earlier state, from the next start on.
    Kept(KeptState),
    /// Factory values, from the next start on.
    Factory,
}

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum PageCommand {
    /// Changes a parameter from the parameter page; requires the level of the parameter.
    EditParam(ParamAddress, f64),
    /// Changes the leadscrew table of an axis (B7); requires the machine builder's level.
    EditLeadscrew(Axis, LeadscrewCompensation),
    /// Unlocks a level until power-off.
    Unlock(PasswordScope, Secret),
    /// Locks all levels.
    Lock,
    /// Replaces a password; requires the old one.
    ChangePassword {
        /// The password to replace.
        scope: PasswordScope,
        /// The old password.
        old: Secret,
        /// The new password.
        new: Secret,
    },
    /// Decides what takes the place of data that were damaged or lost (alarm 300).
    AcceptData(DataChoice),
    /// Selects the kind of machine from the next start on.
    SetNextKind(Kind),
    /// Sets the language of the screen, now and at the next start.
    SetLang(Lang),
    /// Selects the light theme (true) or the dark theme, now and at the next start.
    SetLightTheme(bool),
    /// Sets the picture brightness, percent, now and at the next start.
    SetBrightness(u8),
    /// Sets the size of the screen, percent, one of [`ZOOMS`], now and at the next start.
    SetZoom(u16),
    /// Selects the RS232 port, from now on.
    SetSerialPort(String),
    /// Sets what the home page keeps, now and at the next start.
    SetFavourites(Vec<Favourite>),
    /// The present machine coordinate of an axis is its dressing point (K4.2). The page has asked, with this coordinate as
    /// displayed; an axis that has moved since is refused.
    TakeDressPoint(Axis, f64),
    /// Removes the dressing points (K4.2).
    ClearDressPoints,
    /// Says why the machine stands; none takes the reason back from now on.
    SetDowntimeReason(Option<DowntimeReason>),
    /// Starts or ends a recording of the scope.
    Scope(ScopeCommand),
    /// Sets date and time of day.
    SetDate(DateTime),
    /// A request about programs or folders, or for a long calculation.
    File(Ticket, FileRequest),
    /// The disk thread's answer to a request.
    StorageAnswered(StorageAnswer),
}

/// A request to the disk thread.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingsRequest {
    /// Checks a password.
    CheckPassword(PasswordScope, Secret),
    /// Replaces a password if the old one matches.
    ChangePassword {
        /// The password to replace.
        scope: PasswordScope,
        /// The old password.
        old: Secret,
        /// The new password.
        new: Secret,
    },
    /// What takes the place of data that were damaged or lost.
    AcceptData(DataChoice),
    /// Saves the kind for the next start.
    SaveKind(Kind),
    /// Saves the language for the next start.
    SaveLang(Lang),
    /// Saves the theme for the next start.
    SaveLightTheme(bool),
    /// Saves the brightness for the next start.
    SaveBrightness(u8),
    /// Saves the size of the screen for the next start.
    SaveZoom(u16),
    /// Saves the RS232 port.
    SaveSerialPort(String),
    /// Saves what the home page keeps.
    SaveFavourites(Vec<Favourite>),
}

/// What a typed password is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PasswordCheck {
    /// Not the password.
    Wrong,
    /// The password that holds.
    Right,
    /// The password that holds, and the one as delivered, which the manual prints.
    Initial,
}

/// An answer of the disk thread.
#[derive(Clone, Debug, PartialEq)]
pub enum StorageAnswer {
    /// Whether a password matches.
    PasswordChecked(PasswordScope, PasswordCheck),
    /// Whether a password was replaced; false if the old one did not match.
    PasswordChanged(PasswordScope, bool),
    /// The choice is stored.
    DataAccepted(DataChoice),
    /// The kind for the next start is saved.
    KindSaved(Kind),
    /// The language is saved.
    LangSaved,
    /// An answer of the work outside the tick.
    File(Ticket, FileAnswer),
    /// The disk thread failed; why.
    Failed(LocalizedText),
}
