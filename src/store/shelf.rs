//! The programs of a folder whatever they are called: `O1001.NC` by number, `VGRIND.MPF` and `L10.SPF` by name, and
//! `SHAFT.NC` where the kind calls its programs so. What goes over a stick or a line is named this way.
//! Source: spec B1, L1, S1, K7.8.

use std::path::Path;

use super::fault::IoFault;
use super::file_class::PROGRAM;
use super::folder::{Folder, FolderError, Read};
use super::listing::LISTING_LIMIT;
use super::named::stem_of;
use super::stick::StickFile;

/// The longest name of a program without its extension, in characters.
pub const STEM_LIMIT: usize = 32;

/// A folder of programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shelf {
    folder: Folder,
    /// `NAME.NC` counts, and `O1001.NC` is a name like any other.
    named: bool,
}

impl Shelf {
    /// The programs of a folder; `named` where the kind calls them by name.
    #[must_use]
    pub fn new(folder: &Path, named: bool) -> Self {
        Self { folder: Folder::new(folder), named }
    }

    /// Whether a file name is that of a program here. It holds no separator, begins with no point and is not too long.
    #[must_use]
    pub fn knows(&self, name: &str) -> bool {
        if !self.named {
            return PROGRAM.parse(name).is_some() || stem_of(name).is_some();
        }
        let Some((stem, extension)) = name.rsplit_once('.') else { return false };
        let good = |sign: char| sign.is_alphanumeric() || matches!(sign, '_' | '-');
        extension.eq_ignore_ascii_case("NC")
            && (1..=STEM_LIMIT).contains(&stem.chars().count())
            && stem.chars().all(good)
    }

    /// The plain files that are programs, by name; links, folders and devices are passed over.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn list(&self) -> Result<Vec<StickFile>, FolderError> {
        let mut found = Vec::new();
        if !self.named {
            // Of two files with one number one counts.
            let listing = self.folder.list(&PROGRAM)?;
            found.extend(listing.entries.into_iter().map(|entry| StickFile { name: entry.name, size: entry.size }));
        }
        let path = self.folder.path();
        for entry in std::fs::read_dir(path).map_err(IoFault::at(path, "list"))?.take(LISTING_LIMIT) {
            let entry = entry.map_err(IoFault::at(path, "list"))?;
            let (Ok(name), Ok(told)) = (entry.file_name().into_string(), entry.metadata()) else { continue };
            let numbered = !self.named && PROGRAM.parse(&name).is_some();
            if told.is_file() && !numbered && self.knows(&name) {
                found.push(StickFile { name, size: told.len() });
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(found)
    }

    /// The name that a program has here, whatever the case of its letters; the name itself if it is not here.
    fn own_name(&self, name: &str) -> Result<String, FolderError> {
        let listed = self.list()?;
        let same = listed.iter().find(|file| file.name == name);
        let same = same.or_else(|| listed.iter().find(|file| file.name.eq_ignore_ascii_case(name)));
        Ok(same.map_or_else(|| name.to_owned(), |file| file.name.clone()))
    }

    /// The content of a program by its file name, without regard to case.
    ///
    /// # Errors
    /// It is no program's name, or the file is missing, no plain file, too large or unreadable.
    pub fn read(&self, name: &str) -> Result<Read, FolderError> {
        self.check(name)?;
        self.folder.read_named(&PROGRAM, &self.own_name(name)?)
    }

    /// Writes a program, in place of the one of that name: after a power cut it is the old or the new. Gives its name.
    ///
    /// # Errors
    /// It is no program's name, too large, a link or folder has it, or the disk refuses.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<String, FolderError> {
        self.check(name)?;
        match PROGRAM.parse(name).filter(|_| !self.named) {
            Some((number, _)) => self.folder.write(&PROGRAM, number, bytes),
            None => self.folder.write_named(&PROGRAM, &self.own_name(name)?, bytes),
        }
    }

    fn check(&self, name: &str) -> Result<(), FolderError> {
        if self.knows(name) {
            return Ok(());
        }
        let like = if self.named { "SHAFT.NC".to_owned() } else { PROGRAM.name(1001) };
        Err(FolderError::BadName { name: name.to_owned(), like })
    }
}
