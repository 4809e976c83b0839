//! A USB drive: its mount point, its free space, the regular files in its top folder.
//! Source: spec K7.8, H8 (no U盘).

use std::fs;
use std::path::{Path, PathBuf};

use super::io_fault::IoFault;

/// Folders below which operating systems mount drives, one or two levels down.
const MOUNT_ROOTS: [&str; 4] = ["/media", "/run/media", "/mnt", "/Volumes"];
/// Maximum number of names read in a folder.
const MAX_ENTRIES: usize = 4_096;

/// A USB drive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsbDrive {
    root: PathBuf,
}

/// A file with its size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedFile {
    /// Its name.
    pub name: String,
    /// Its size, bytes.
    pub size: u64,
}

impl UsbDrive {
    /// The drive mounted at a folder.
    #[must_use]
    pub const fn at(root: PathBuf) -> Self {
        Self { root }
    }

    /// The first drive that is plugged in.
    #[must_use]
    pub fn find() -> Option<Self> {
        let below = |folder: &Path| -> Vec<PathBuf> {
            let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(MAX_ENTRIES);
            let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
            folders.map(|entry| entry.path()).collect()
        };
        let first = MOUNT_ROOTS.iter().flat_map(|root| below(Path::new(root)));
        let all = first.flat_map(|folder| {
            let deeper = below(&folder);
            std::iter::once(folder).chain(deeper)
        });
        all.into_iter().find(|folder| is_mount_point(folder)).map(Self::at)
    }

    /// Its top folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether it is still plugged in.
    #[must_use]
    pub fn is_present(&self) -> bool {
        self.root.is_dir()
    }

    /// Free bytes; `None` if the system does not report them.
    #[must_use]
    pub fn free_bytes(&self) -> Option<u64> {
        #[cfg(unix)]
        {
            let told = rustix::fs::statvfs(&self.root).ok()?;
            Some(told.f_bavail.saturating_mul(told.f_frsize))
        }
        #[cfg(not(unix))]
        None
    }

    /// The regular files in its top folder, sorted by name.
    ///
    /// # Errors
    /// It cannot be listed: removed or defective.
    pub fn files(&self) -> Result<Vec<ListedFile>, IoFault> {
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.root).map_err(IoFault::at(&self.root, "list"))?.take(MAX_ENTRIES) {
            let entry = entry.map_err(IoFault::at(&self.root, "list"))?;
            let (Ok(name), Ok(metadata)) = (entry.file_name().into_string(), entry.metadata()) else { continue };
            if metadata.is_file() && !name.starts_with('.') {
                found.push(ListedFile { name, size: metadata.len() });
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(found)
    }
}

/// Whether a folder is on another device than its parent.
#[cfg(unix)]
fn is_mount_point(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| fs::metadata(path).map(|told| told.dev()).ok();
    folder.parent().is_some_and(|above| device(folder).is_some() && device(folder) != device(above))
}

#[cfg(not(unix))]
fn is_mount_point(_folder: &Path) -> bool {
    false
}
