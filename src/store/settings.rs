//! Settings that are needed at start, such as kind and language, in `settings.ron`.
//! The command line overrides them. Source: spec K1 ("chosen at start and kept"), B6 (设置).

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::ron_file::{self, ChecksumPolicy, RonError, RonWarning};
use crate::defs::kind::Kind;
use crate::defs::text::Lang;

/// The file's name.
pub(super) const SETTINGS_FILE: &str = "settings.ron";

/// The settings; the caller provides defaults for `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StoredSettings {
    /// Kind of machine.
    pub kind: Option<Kind>,
    /// Language of the screen.
    pub lang: Option<StoredLang>,
    /// The light theme instead of the dark one.
    pub light: Option<bool>,
    /// Brightness of the screen, percent.
    pub brightness: Option<u8>,
    /// Size of the screen, percent.
    pub zoom: Option<u16>,
    /// The RS232 port: `/dev/ttyS0`, `COM1`.
    pub serial: Option<String>,
    /// What the operator keeps on the home page, each in words.
    pub favourites: Vec<String>,
}

/// A language by its name: the file of an added one may be gone at the next start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoredLang {
    /// 中文
    Zh,
    /// English
    En,
    /// An added one, by its code.
    Added(String),
}

impl StoredLang {
    /// Its code by ISO 639.
    #[must_use]
    pub fn code(&self) -> &str {
        match self {
            Self::Zh => Lang::Zh.code(),
            Self::En => Lang::En.code(),
            Self::Added(code) => code,
        }
    }
}

impl From<Lang> for StoredLang {
    fn from(lang: Lang) -> Self {
        match lang {
            Lang::Zh => Self::Zh,
            Lang::En => Self::En,
            Lang::Added(translation) => Self::Added(translation.code.clone()),
        }
    }
}

impl StoredSettings {
    /// Reads the settings of a data directory; all `None` if there is no file.
    ///
    /// # Errors
    /// The file cannot be read or is invalid; the error names line and column.
    pub fn read(folder: &Path) -> Result<Self, RonError> {
        Self::read_with_warnings(folder).map(|(settings, _)| settings)
    }

    /// As [`Self::read`], with what is wrong with the file that was read.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_with_warnings(folder: &Path) -> Result<(Self, Vec<RonWarning>), RonError> {
        match ron_file::read(&folder.join(SETTINGS_FILE), ChecksumPolicy::Lenient) {
            Ok(found) => Ok((found.value, found.warnings)),
            // A backup that is no more readable than the file is damage, not a first start.
            Err(error @ RonError::Missing(_)) if ron_file::has_backup(&folder.join(SETTINGS_FILE)) => Err(error),
            Err(RonError::Missing(_)) => Ok((Self::default(), Vec::new())),
            Err(error) => Err(error),
        }
    }

    /// Writes the settings; when it returns, they survive a power cut.
    ///
    /// # Errors
    /// A disk error; the old file stays.
    pub fn write(&self, folder: &Path) -> Result<(), RonError> {
        ron_file::write(&folder.join(SETTINGS_FILE), ChecksumPolicy::Lenient, self)
    }
}
