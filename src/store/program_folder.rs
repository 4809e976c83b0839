//! The programs of a folder by file name: numbered `O1001.NC`, named `VGRIND.MPF` and `L10.SPF`, and `SHAFT.NC` on
//! kinds with named programs. Transfers by USB drive and RS232 use these names.
//! Source: spec B1, L1, S1, K7.8.

use std::path::Path;

use super::file_class::PROGRAM;
use super::folder::{FileContent, Folder, FolderError};
use super::io_fault::IoFault;
use super::listing::LISTING_LIMIT;
use super::named_program::program_stem;
use super::usb_drive::ListedFile;

/// Maximum length of a program name without its extension, characters.
pub const STEM_LIMIT: usize = 32;

/// A folder of programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramFolder {
    folder: Folder,
    /// `NAME.NC` is a program, and `O1001.NC` has no special meaning.
    by_name: bool,
}

impl ProgramFolder {
    /// The programs of a folder; `named` on kinds with named programs.
    #[must_use]
    pub fn new(folder: &Path, named: bool) -> Self {
        Self { folder: Folder::new(folder), by_name: named }
    }

    /// Whether the programs have names instead of numbers.
    #[must_use]
    pub const fn is_by_name(&self) -> bool {
        self.by_name
    }

    /// Whether a file name is a valid program name: no separator, no leading dot, not too long.
    #[must_use]
    pub fn is_program_name(&self, name: &str) -> bool {
        if !self.by_name {
            return PROGRAM.parse(name).is_some() || program_stem(name).is_some();
        }
        let Some((stem, extension)) = name.rsplit_once('.') else { return false };
        let good = |sign: char| sign.is_alphanumeric() || matches!(sign, '_' | '-');
        extension.eq_ignore_ascii_case("NC")
            && (1..=STEM_LIMIT).contains(&stem.chars().count())
            && stem.chars().all(good)
    }

    /// Lists the programs by name; links, folders and devices are skipped.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn list(&self) -> Result<Vec<ListedFile>, FolderError> {
        let mut found = Vec::new();
        if !self.by_name {
            // Of two files with the same number only one is used.
            let listing = self.folder.list(&PROGRAM)?;
            found.extend(listing.entries.into_iter().map(|entry| ListedFile { name: entry.name, size: entry.size }));
        }
        let path = self.folder.path();
        for entry in std::fs::read_dir(path).map_err(IoFault::at(path, "list"))?.take(LISTING_LIMIT) {
            let entry = entry.map_err(IoFault::at(path, "list"))?;
            let (Ok(name), Ok(told)) = (entry.file_name().into_string(), entry.metadata()) else { continue };
            let numbered = !self.by_name && PROGRAM.parse(&name).is_some();
            if told.is_file() && !numbered && self.is_program_name(&name) {
                found.push(ListedFile { name, size: told.len() });
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(found)
    }

    /// The name of an existing program, compared case-insensitively; the given name if there is none.
    fn stored_name(&self, name: &str) -> Result<String, FolderError> {
        let listed = self.list()?;
        let same = listed.iter().find(|file| file.name == name);
        let same = same.or_else(|| listed.iter().find(|file| file.name.eq_ignore_ascii_case(name)));
        Ok(same.map_or_else(|| name.to_owned(), |file| file.name.clone()))
    }

    /// Reads a program by its file name, case-insensitively.
    ///
    /// # Errors
    /// Not a program name, or the file is missing, not a regular file, too large or unreadable.
    pub fn read(&self, name: &str) -> Result<FileContent, FolderError> {
        self.check_name(name)?;
        self.folder.read_named(&PROGRAM, &self.stored_name(name)?)
    }

    /// Reads a program by the name that [`Self::list`] has given.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_listed(&self, name: &str) -> Result<FileContent, FolderError> {
        self.folder.read_named(&PROGRAM, name)
    }

    /// Writes or replaces a program. After a power cut it is the old or the new file. Returns its name.
    ///
    /// # Errors
    /// Not a program name, too large, a link or folder has that name, or a disk error.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<String, FolderError> {
        self.check_name(name)?;
        match PROGRAM.parse(name).filter(|_| !self.by_name) {
            Some((number, _)) => self.folder.write(&PROGRAM, number, bytes),
            None => self.folder.write_named(&PROGRAM, &self.stored_name(name)?, bytes),
        }
    }

    fn check_name(&self, name: &str) -> Result<(), FolderError> {
        if self.is_program_name(name) {
            return Ok(());
        }
        let like = if self.by_name { "SHAFT.NC".to_owned() } else { PROGRAM.file_name(1001) };
        Err(FolderError::BadName { name: name.to_owned(), like })
    }
}
