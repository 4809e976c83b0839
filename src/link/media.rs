//! Requests and data of the transfer page: a plugged-in medium, files both ways, values, a full backup.
//! Source: spec K7.8, H8.

use crate::defs::text::Text;

/// What is transferred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TransferSet {
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

impl TransferSet {
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

    /// The id of its key.
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

    /// Whether its files are selected one by one.
    #[must_use]
    pub const fn has_file_list(self) -> bool {
        matches!(self, Self::Programs | Self::Screens)
    }

    /// The set that the listed files belong to: RS232 transfers programs.
    #[must_use]
    pub const fn file_set(self) -> Self {
        match self {
            Self::Serial => Self::Programs,
            other => other,
        }
    }
}

/// Direction of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the control to the medium.
    Export,
    /// From the medium to the control.
    Import,
}

/// A file as listed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MediaFile {
    /// Its name.
    pub name: String,
    /// Bytes.
    pub size: u64,
    /// The set it belongs to.
    pub set: TransferSet,
}

/// The two sides of a transfer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MediaView {
    /// Folder of the medium; `None` if none is plugged in.
    pub medium_folder: Option<String>,
    /// Free bytes on it.
    pub free_bytes: Option<u64>,
    /// Files on the medium of known types.
    pub medium_files: Vec<MediaFile>,
    /// Files on the control: programs, page files.
    pub control_files: Vec<MediaFile>,
    /// The selected RS232 port.
    pub port: Option<String>,
    /// The RS232 ports of this computer.
    pub ports: Vec<String>,
}

/// A transfer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TransferRequest {
    /// The set.
    pub set: TransferSet,
    /// Direction of a transfer.
    pub direction: Direction,
    /// The files; empty: all of the set. A single program received by RS232 is stored under the first name.
    pub names: Vec<String>,
    /// Whether existing files that differ are overwritten; `None`: the operator is asked.
    pub overwrite: Option<bool>,
    /// Whether pictures of another format are converted; `None`: the operator is asked.
    pub convert: Option<bool>,
    /// Whether files with several programs are divided into one file each; `None`: the operator is asked.
    pub split: Option<bool>,
}

/// A screenshot.
#[derive(Clone, PartialEq, Eq)]
pub struct Screenshot {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Red, green, blue of each pixel, top row first.
    pub rgb: std::sync::Arc<[u8]>,
    /// Saved as BMP instead of PNG (P22.1).
    pub as_bmp: bool,
}

impl std::fmt::Debug for Screenshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Print({}×{})", self.width, self.height)
    }
}
