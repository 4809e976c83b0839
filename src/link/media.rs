//! What the transfer page asks and sees: a medium that is plugged in, files both ways, values, an archive of everything.
//! Source: spec K7.8, H8.

use crate::defs::text::Text;

/// What is carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Set {
    /// Programs, `O1001.NC`.
    #[default]
    Programs,
    /// Page texts and pictures, `C0001.TXT`, `B0001.BMP`.
    Screens,
    /// Parameters.
    Params,
    /// Macro variables.
    Variables,
    /// Everything in one archive.
    Backup,
    /// Programs over RS232 (L9).
    Serial,
}

impl Set {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Programs, Self::Screens, Self::Params, Self::Variables, Self::Backup, Self::Serial];

    /// The name shown.
    #[must_use]
    pub const fn name(self) -> Text {
        match self {
            Self::Programs => Text::new("程序", "programs"),
            Self::Screens => Text::new("页面文件", "page files"),
            Self::Params => Text::new("参数", "parameters"),
            Self::Variables => Text::new("宏变量", "macro values"),
            Self::Backup => Text::new("全部备份", "full backup"),
            Self::Serial => Text::new("RS232", "RS232"),
        }
    }

    /// The word of its key.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Programs => "set-programs",
            Self::Screens => "set-screens",
            Self::Params => "set-params",
            Self::Variables => "set-variables",
            Self::Backup => "set-backup",
            Self::Serial => "set-serial",
        }
    }

    /// Whether its files are chosen one by one.
    #[must_use]
    pub const fn has_list(self) -> bool {
        matches!(self, Self::Programs | Self::Screens)
    }

    /// The set that the files of this one belong to: what goes over a line are programs.
    #[must_use]
    pub const fn files(self) -> Self {
        match self {
            Self::Serial => Self::Programs,
            other => other,
        }
    }
}

/// Which way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the control to the medium.
    Out,
    /// From the medium to the control.
    In,
}

/// A file as listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MediaFile {
    /// Its name.
    pub name: String,
    /// Bytes.
    pub size: u64,
    /// What it belongs to.
    pub set: Set,
}

/// The two sides of a transfer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MediaView {
    /// The medium's folder; none is plugged in.
    pub stick: Option<String>,
    /// Bytes free on it.
    pub free: Option<u64>,
    /// Files of the medium that this control knows.
    pub there: Vec<MediaFile>,
    /// Files of the control: programs, page files.
    pub here: Vec<MediaFile>,
    /// The RS232 port that is chosen.
    pub port: Option<String>,
    /// The RS232 ports of this computer.
    pub ports: Vec<String>,
}

/// A transfer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// What.
    pub set: Set,
    /// Which way.
    pub direction: Direction,
    /// The files; none: all of the set. What comes over a line is stored under the first one, if it is one program.
    pub names: Vec<String>,
    /// What is done with files that are there already and differ; not decided yet: it is asked.
    pub overwrite: Option<bool>,
    /// Whether pictures that are not of the form are converted; not decided yet: it is asked.
    pub convert: Option<bool>,
}

/// A picture of the screen.
#[derive(Clone, PartialEq, Eq)]
pub struct Print {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Red, green, blue of each pixel, top row first.
    pub rgb: std::sync::Arc<[u8]>,
    /// To be kept as BMP instead of PNG (P22.1).
    pub bmp: bool,
}

impl std::fmt::Debug for Print {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Print({}×{})", self.width, self.height)
    }
}
