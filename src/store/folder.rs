//! Numbered files in the folders `programs/` and `screens/` and on a USB drive.
//!
//! The operator may copy files at any time, in upper or lower case, sometimes incompletely. Nothing is cached.
//! Source: spec K7.3, K7.8, B1.

use std::fs;
use std::path::{Path, PathBuf};

use super::atomic_file::{self, ReadError};
use super::disk;
use super::file_class::FileClass;
use super::io_fault::IoFault;
use super::listing::{self, FolderEntry, FolderListing};
use crate::defs::text::{LocalizedText, phrase};

/// Why a file was not read, written, renamed or deleted. Nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// No file with that number.
    #[error("{name} is not in {}; copy it there", .folder.display())]
    Missing {
        /// The name it would have.
        name: String,
        /// The folder.
        folder: PathBuf,
    },
    /// The name is not a plain file name: it holds a separator, `..`, or nothing.
    #[error("\"{name}\" is not a file name; give a name without folders, like {like}")]
    BadName {
        /// The name given.
        name: String,
        /// An example of a valid name.
        like: String,
    },
    /// The number is too large for a file name.
    #[error("{0} is not a file number; use 0 to {1}")]
    BadNumber(u32, u32),
    /// A link, folder or device has that name.
    #[error("{}: a link, folder or device; put the file itself there", .0.display())]
    NotRegular(PathBuf),
    /// Larger than its class allows.
    #[error("{}: {size} bytes, more than the {limit} allowed; split it", .path.display())]
    TooLarge {
        /// The path.
        path: PathBuf,
        /// Its size in bytes.
        size: u64,
        /// The largest size in bytes.
        limit: u64,
    },
    /// With it the files of the folder are together larger than allowed.
    #[error("{}: not read: all files of the folder together are larger than {} MB; delete some", .path.display(), .limit >> 20)]
    FolderTooLarge {
        /// The path of the file.
        path: PathBuf,
        /// The largest size of all files together, bytes.
        limit: u64,
    },
    /// It changed while it was read.
    #[error("{}: still being written; wait until it is copied and try again", .0.display())]
    BeingWritten(PathBuf),
    /// The target exists already.
    #[error("{}: already exists; delete it first or choose another number", .0.display())]
    Exists(PathBuf),
    /// The operating system reported an error.
    #[error(transparent)]
    Io(#[from] IoFault),
}

impl FolderError {
    /// The message for the screen; it names the file without its folder.
    #[must_use]
    pub fn message(&self) -> LocalizedText {
        let name = match self {
            Self::Missing { name, .. } | Self::BadName { name, .. } => name.clone(),
            Self::BadNumber(number, _) => number.to_string(),
            Self::NotRegular(path) | Self::BeingWritten(path) | Self::Exists(path) => file_name(path),
            Self::TooLarge { path, .. } | Self::FolderTooLarge { path, .. } => file_name(path),
            Self::Io(fault) => return fault.message(),
        };
        match self {
            Self::Exists(_) => {
                phrase!("{name} 已存在，请换一个号", "{name} already exists: choose another number", name)
            }
            Self::TooLarge { size, limit, .. } => phrase!(
                "{name} 太大：{size} 字节，最多 {limit}",
                "{name} is too large: {size} bytes, {limit} at most",
                name,
                size = *size as usize,
                limit = *limit as usize
            ),
            Self::FolderTooLarge { limit, .. } => phrase!(
                "{name} 未读入：全部程序超过 {limit} MB，请删除不用的",
                "{name} is not read: all programs together are larger than {limit} MB: delete some",
                name,
                limit = (*limit >> 20) as usize
            ),
            Self::NotRegular(_) => phrase!(
                "{name} 是链接或目录，请换成文件本身",
                "{name} is a link or a folder: put the file itself there",
                name
            ),
            Self::BeingWritten(_) => {
                phrase!("{name} 正在被写入，请稍后再试", "{name} is still being written: wait and try again", name)
            }
            Self::BadName { like, .. } => phrase!(
                "{name} 不是有效的文件名，应像 {like}",
                "{name} is not a file name: use one like {like}",
                name,
                like = like.to_string()
            ),
            Self::BadNumber(_, most) => phrase!(
                "{name} 不是有效的程序号，应为 1-{most}",
                "{name} is not a program number: use 1 to {most}",
                name,
                most = *most
            ),
            Self::Missing { .. } | Self::Io(_) => phrase!("{name} 不存在", "{name} does not exist", name),
        }
    }
}

/// A file's name and content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileContent {
    /// The name on the disk, for messages.
    pub name: String,
    /// The content.
    pub bytes: Vec<u8>,
}

/// A folder of numbered files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// The folder at a path. Whether it exists is checked at each use, because a USB drive can be removed.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Lists the files of a class with size, time and comment line, and the ignored files.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn list(&self, class: &FileClass) -> Result<FolderListing, FolderError> {
        Ok(listing::list(&self.path, class)?)
    }

    /// Finds the file with a number; names are compared case-insensitively.
    ///
    /// # Errors
    /// [`FolderError::Missing`], or the folder cannot be listed.
    pub fn find(&self, class: &FileClass, number: u32) -> Result<FolderEntry, FolderError> {
        let (mut found, _) = listing::scan(&self.path, class)?;
        let found = found.remove(&number).ok_or_else(|| self.missing(class, number))?;
        Ok(listing::folder_entry(&self.path, class, number, found))
    }

    /// Reads the file with a number.
    ///
    /// # Errors
    /// It is missing, not a regular file, larger than its class allows, still being written, or unreadable.
    pub fn read(&self, class: &FileClass, number: u32) -> Result<FileContent, FolderError> {
        let path = self.existing(class, number)?;
        Ok(FileContent { name: file_name(&path), bytes: read_regular_file(&path, class.limit)? })
    }

    /// Reads a file by its exact name, at most `class.limit` bytes.
    ///
    /// # Errors
    /// As [`Folder::read`]; also for a name with a separator or `..`.
    pub fn read_named(&self, class: &FileClass, name: &str) -> Result<FileContent, FolderError> {
        let path = self.path.join(check_plain_name(class, name)?);
        Ok(FileContent { name: name.to_owned(), bytes: read_regular_file(&path, class.limit)? })
    }

    /// Writes or replaces a file by its exact name. After a power cut it is the old or the new file. Returns its name.
    ///
    /// # Errors
    /// As [`Folder::write`]; also for a name with a separator or `..`.
    pub fn write_named(&self, class: &FileClass, name: &str, bytes: &[u8]) -> Result<String, FolderError> {
        let path = self.path.join(check_plain_name(class, name)?);
        if fs::symlink_metadata(&path).is_ok_and(|told| !told.is_file()) {
            return Err(FolderError::NotRegular(path));
        }
        replace(path, class, bytes)
    }

    /// Writes or replaces the file with a number. After a power cut it is the old or the new file. Returns its name.
    ///
    /// # Errors
    /// It is too large, or a link, folder or device has its name, or a disk error.
    pub fn write(&self, class: &FileClass, number: u32, bytes: &[u8]) -> Result<String, FolderError> {
        let path = match self.existing(class, number) {
            Ok(path) => path,
            Err(FolderError::Missing { .. }) => self.new_path(class, number)?,
            Err(other) => return Err(other),
        };
        replace(path, class, bytes)
    }

    /// Deletes a file by its exact name.
    ///
    /// # Errors
    /// It is missing, or a disk error.
    pub fn delete_named(&self, class: &FileClass, name: &str) -> Result<(), FolderError> {
        let path = self.path.join(check_plain_name(class, name)?);
        read_regular_file(&path, class.limit)?;
        self.remove(&path)
    }

    /// Renames a file to a free number and returns the new name.
    ///
    /// # Errors
    /// It is missing, the number is in use, or a disk error.
    pub fn rename(&self, class: &FileClass, from: u32, to: u32) -> Result<String, FolderError> {
        self.check_free(class, to)?;
        let (old, new) = (self.existing(class, from)?, self.new_path(class, to)?);
        disk::rename(&old, &new).map_err(IoFault::at(&old, "rename"))?;
        atomic_file::flush_folder(&self.path)?;
        Ok(file_name(&new))
    }

    /// Deletes the file with a number. A file that it hid (`.NC` behind `.TXT`) becomes valid.
    ///
    /// # Errors
    /// It is missing, or a disk error.
    pub fn delete(&self, class: &FileClass, number: u32) -> Result<(), FolderError> {
        let path = self.existing(class, number)?;
        self.remove(&path)
    }

    /// The path of the file with a number; refuses a link, folder or device with that name.
    fn existing(&self, class: &FileClass, number: u32) -> Result<PathBuf, FolderError> {
        let (mut found, ignored) = listing::scan(&self.path, class)?;
        if let Some(found) = found.remove(&number) {
            return Ok(self.path.join(found.name));
        }
        let same = |name: &str| class.parse(name).is_some_and(|(other, _)| other == number);
        let odd = ignored.into_iter().find(|ignored| same(&ignored.name)).map(|odd| self.path.join(odd.name));
        Err(odd.map_or_else(|| self.missing(class, number), FolderError::NotRegular))
    }

    fn remove(&self, path: &Path) -> Result<(), FolderError> {
        disk::remove(path).map_err(IoFault::at(path, "delete"))?;
        Ok(atomic_file::flush_folder(&self.path)?)
    }

    /// The path of a new file.
    fn new_path(&self, class: &FileClass, number: u32) -> Result<PathBuf, FolderError> {
        if number > class.largest_number() {
            return Err(FolderError::BadNumber(number, class.largest_number()));
        }
        Ok(self.path.join(class.file_name(number)))
    }

    /// Checks that no file has this number.
    ///
    /// # Errors
    /// The number is taken, or the folder cannot be listed.
    pub fn check_free(&self, class: &FileClass, number: u32) -> Result<(), FolderError> {
        match self.existing(class, number) {
            Ok(path) => Err(FolderError::Exists(path)),
            Err(FolderError::Missing { .. }) => Ok(()),
            Err(other) => Err(other),
        }
    }

    fn missing(&self, class: &FileClass, number: u32) -> FolderError {
        FolderError::Missing { name: class.file_name(number), folder: self.path.clone() }
    }
}

/// Writes a file of at most the size of its class; returns its name.
fn replace(path: PathBuf, class: &FileClass, bytes: &[u8]) -> Result<String, FolderError> {
    let (size, limit) = (bytes.len() as u64, class.limit);
    if size > limit {
        return Err(FolderError::TooLarge { path, size, limit });
    }
    atomic_file::replace(&path, bytes)?;
    Ok(file_name(&path))
}

/// Checks that a name cannot lead out of the folder on any operating system.
fn check_plain_name<'a>(class: &FileClass, name: &'a str) -> Result<&'a str, FolderError> {
    let outside = name.is_empty() || name == "." || name == ".." || name.contains(['/', '\\', ':', '\0']);
    if outside { Err(FolderError::BadName { name: name.to_owned(), like: class.file_name(1001) }) } else { Ok(name) }
}

/// Reads a regular file of at most `limit` bytes; links and devices are refused.
///
/// # Errors
/// Why it was not read.
pub fn read_regular_file(path: &Path, limit: u64) -> Result<Vec<u8>, FolderError> {
    let here = || path.to_path_buf();
    atomic_file::read(path, limit).map_err(|refused| match refused {
        ReadError::Io(fault) if fault.is_missing() => {
            FolderError::Missing { name: file_name(path), folder: atomic_file::folder_of(path).to_path_buf() }
        }
        ReadError::Io(fault) => FolderError::Io(fault),
        ReadError::NotRegular => FolderError::NotRegular(here()),
        ReadError::TooLarge { size, limit } => FolderError::TooLarge { path: here(), size, limit },
        ReadError::BeingWritten => FolderError::BeingWritten(here()),
    })
}

/// The file name of a path, for messages.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
