//! A medium that is plugged in: where it is, what is free on it, plain files in its top folder.
//! Source: spec K7.8, H8 (no U盘).

use std::fs;
use std::path::{Path, PathBuf};

use super::fault::IoFault;
use super::folder::{self, FolderError};
use super::whole_file;

/// Where systems put what is plugged in: the folders of media lie one or two levels below.
const ROOTS: [&str; 4] = ["/media", "/run/media", "/mnt", "/Volumes"];
/// Most names looked at in a folder.
const MOST: usize = 4_096;

/// A medium.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stick {
    root: PathBuf,
}

/// A file in the top folder of a medium.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StickFile {
    /// Its name.
    pub name: String,
    /// Bytes.
    pub size: u64,
}

impl Stick {
    /// The medium at a folder.
    #[must_use]
    pub const fn at(root: PathBuf) -> Self {
        Self { root }
    }

    /// The first medium that is plugged in.
    #[must_use]
    pub fn find() -> Option<Self> {
        let below = |folder: &Path| -> Vec<PathBuf> {
            let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(MOST);
            entries
                .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
                .map(|entry| entry.path())
                .collect()
        };
        let first = ROOTS.iter().flat_map(|root| below(Path::new(root)));
        let all = first.flat_map(|folder| {
            let deeper = below(&folder);
            std::iter::once(folder).chain(deeper)
        });
        all.into_iter().find(|folder| is_mount(folder)).map(Self::at)
    }

    /// Its top folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether it is still there.
    #[must_use]
    pub fn is_present(&self) -> bool {
        self.root.is_dir()
    }

    /// Bytes that are free on it, as far as the system tells.
    #[must_use]
    pub fn free(&self) -> Option<u64> {
        #[cfg(unix)]
        {
            let told = rustix::fs::statvfs(&self.root).ok()?;
            Some(told.f_bavail.saturating_mul(told.f_frsize))
        }
        #[cfg(not(unix))]
        None
    }

    /// The plain files in its top folder, by name.
    ///
    /// # Errors
    /// It cannot be listed: it is gone, or broken.
    pub fn files(&self) -> Result<Vec<StickFile>, IoFault> {
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.root).map_err(IoFault::at(&self.root, "list"))?.take(MOST) {
            let entry = entry.map_err(IoFault::at(&self.root, "list"))?;
            let (Ok(name), Ok(metadata)) = (entry.file_name().into_string(), entry.metadata()) else { continue };
            if metadata.is_file() && !name.starts_with('.') {
                found.push(StickFile { name, size: metadata.len() });
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(found)
    }
}

/// Whether a folder lies on another device than the one above it.
#[cfg(unix)]
fn is_mount(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| fs::metadata(path).map(|told| told.dev()).ok();
    folder.parent().is_some_and(|above| device(folder).is_some() && device(folder) != device(above))
}

#[cfg(not(unix))]
fn is_mount(_folder: &Path) -> bool {
    false
}

/// Replaces or creates a file as a whole: after a power cut it is the old one or the new one.
///
/// # Errors
/// The disk refuses; an old file stands.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), IoFault> {
    whole_file::replace(path, bytes)
}

/// Reads a plain file of at most so many bytes; links and devices are refused.
///
/// # Errors
/// Why it was not read.
pub fn read_whole(path: &Path, limit: u64) -> Result<Vec<u8>, FolderError> {
    folder::read_plain(path, limit)
}
