//! Where the data lies: the platform's place for it, or the one given at start.

use std::fs;
use std::path::{Path, PathBuf};

use directories::ProjectDirs;

use super::fault::IoFault;

/// Why there is no data directory to work in.
#[derive(Debug, thiserror::Error)]
pub enum DataDirError {
    /// The platform names no place: no home directory.
    #[error("data directory: the system names no place for data (no home directory); start with --data FOLDER")]
    NoPlace,
    /// The place cannot be made or written.
    #[error("data directory: {0}, or start with another --data FOLDER")]
    Unusable(#[from] IoFault),
}

/// The data directory and the folders in it, all existing and writable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DataDir {
    root: PathBuf,
}

impl DataDir {
    /// The given directory, or else the platform's for "kt830"; created with its folders when absent.
    ///
    /// # Errors
    /// When the platform names no place, or the directory cannot be created or written.
    pub fn resolve(given: Option<&Path>) -> Result<Self, DataDirError> {
        let root = match given {
            Some(path) => path.to_path_buf(),
            None => ProjectDirs::from("", "", "kt830").ok_or(DataDirError::NoPlace)?.data_dir().to_path_buf(),
        };
        let found = Self { root };
        for folder in [found.root(), &found.programs(), &found.screens(), &found.backups(), &found.prints()] {
            fs::create_dir_all(folder).map_err(IoFault::at(folder, "create"))?;
            // Better refused now than at the first part.
            tempfile::tempfile_in(folder).map_err(IoFault::at(folder, "write in"))?;
        }
        Ok(found)
    }

    /// The directory itself; `retained.redb` and the settings lie here.
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

    /// Backups of parameters and variables (K7.8).
    #[must_use]
    pub fn backups(&self) -> PathBuf {
        self.root.join("backups")
    }

    /// Screen prints (K7.8).
    #[must_use]
    pub fn prints(&self) -> PathBuf {
        self.root.join("prints")
    }
}
