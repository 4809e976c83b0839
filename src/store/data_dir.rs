//! The data directory: the platform's default, or the one given at start.

use std::path::{Path, PathBuf};

use directories::ProjectDirs;

use super::disk;
use super::io_fault::IoFault;
use super::retained::has_traces;
use crate::defs::text::LocalizedText;

/// Why there is no usable data directory.
#[derive(Debug, thiserror::Error)]
pub enum DataDirError {
    /// The platform has no default: no home directory.
    #[error("data directory: the system gives no place for data (no home directory); start with --data FOLDER")]
    NoPlace,
    /// The directory cannot be created or written.
    #[error("data directory: {0}, or start with another --data FOLDER")]
    Unusable(#[from] IoFault),
}

/// The data directory and the folders in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataDir {
    root: PathBuf,
    /// It had data before this start.
    has_data: bool,
    /// It has data, and a folder is missing or cannot be written: which, and why.
    fault: Option<LocalizedText>,
}

impl DataDir {
    /// The given directory, or the platform's for "kt830"; created with its folders if it is missing. A directory with
    /// data that cannot be written is no error: a control starts with its data and says that it stores nothing.
    ///
    /// # Errors
    /// The platform has no default, or the new directory cannot be created or written.
    pub fn resolve(given: Option<&Path>) -> Result<Self, DataDirError> {
        let root = match given {
            Some(path) => path.to_path_buf(),
            None => ProjectDirs::from("", "", "kt830").ok_or(DataDirError::NoPlace)?.data_dir().to_path_buf(),
        };
        let has_data = has_traces(&root);
        let mut found = Self { root, has_data, fault: None };
        for folder in [found.root.clone(), found.programs(), found.screens(), found.backups(), found.screenshots()] {
            match Self::make_writable(&folder) {
                Err(fault) if has_data => found.fault = Some(fault.message()),
                made => made?,
            }
        }
        Ok(found)
    }

    fn make_writable(folder: &Path) -> Result<(), IoFault> {
        disk::create_folders(folder).map_err(IoFault::at(folder, "create"))?;
        // Fail now rather than while a part is being ground.
        tempfile::tempfile_in(folder).map_err(IoFault::at(folder, "write in"))?;
        Ok(())
    }

    /// The directory had data before this start.
    #[must_use]
    pub const fn has_data(&self) -> bool {
        self.has_data
    }

    /// A folder cannot be written, although the directory has data: an alarm.
    #[must_use]
    pub fn fault(&self) -> Option<&LocalizedText> {
        self.fault.as_ref()
    }

    /// The directory itself; it contains `retained.redb` and the settings.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Part programs, `O1001.NC` (B1).
    #[must_use]
    pub fn programs(&self) -> PathBuf {
        self.root.join("programs")
    }

    /// Page texts and pictures, `C0001.TXT` and `B0001.BMP` (K7.3).
    #[must_use]
    pub fn screens(&self) -> PathBuf {
        self.root.join("screens")
    }

    /// Language files, `de.ron` (H9). It is there only if somebody has put one into it.
    #[must_use]
    pub fn languages(&self) -> PathBuf {
        self.root.join("languages")
    }

    /// Backups of parameters and variables (K7.8).
    #[must_use]
    pub fn backups(&self) -> PathBuf {
        self.root.join("backups")
    }

    /// Screenshots (K7.8).
    #[must_use]
    pub fn screenshots(&self) -> PathBuf {
        self.root.join("prints")
    }
}
