//! Changes of the program folder that the pages request: save, record, create, copy, rename, delete.
//! Source: spec B6, K6.2, L9.

use ropey::Rope;

use super::job_answer::{JobResult, done, refusal, saved};
use crate::controller::Programs;
use crate::defs::kind::Dialect;
use crate::defs::program_number;
use crate::link::files::Refusal;
use crate::nc;
use crate::store::{Encoding, Folder, FolderError, PROGRAM, decode, encode, stamp};

/// Maximum number of recordings in a folder.
const MAX_RECORDINGS: u32 = 99;

/// The program folder, and the programs as the core knows them.
pub(super) struct ProgramFiles<'a> {
    pub folder: Folder,
    pub programs: &'a Programs,
}

impl ProgramFiles<'_> {
    /// File name of a named program; `None` for a program with a number.
    fn named_file(&self, number: u32) -> Option<&str> {
        let program = self.programs.get(number).filter(|_| program_number::is_named(number))?;
        Some(program.source.name())
    }

    /// Title used in messages.
    fn title(&self, number: u32) -> String {
        let program = self.programs.get(number);
        program.map_or_else(|| program_number::name_of(number), |program| program.source.title())
    }

    fn read(&self, number: u32) -> Result<Vec<u8>, FolderError> {
        let read = match self.named_file(number) {
            Some(file) => self.folder.read_named(&PROGRAM, file),
            None => self.folder.read(&PROGRAM, file_number(number).unwrap_or_default()),
        };
        Ok(read?.bytes)
    }

    /// Replaces a program unless it was changed since it was read. Keeps its encoding, or UTF-8 if GBK lacks a character.
    pub(super) fn save(&self, number: u32, text: &Rope, (base, force): (u64, bool)) -> JobResult {
        let encoding = match self.read(number) {
            Ok(bytes) if !force && stamp(&bytes) != base => return Err(Refusal::Conflict),
            Ok(bytes) => decode(&bytes).map_or(Encoding::Utf8, |decoded| decoded.encoding),
            // Deleted meanwhile: writing it again loses nothing.
            Err(FolderError::Missing { .. }) => Encoding::Utf8,
            Err(error) => return Err(error.into()),
        };
        let (bytes, kept) = encode(text, encoding);
        match self.named_file(number) {
            Some(file) => self.folder.write_named(&PROGRAM, file, &bytes)?,
            None => self.folder.write(&PROGRAM, file_number(number)?, &bytes)?,
        };
        Ok(saved(&self.title(number), number, &bytes, kept))
    }

    /// Saves a recorded program under the first free name of `TEACH01` to `TEACH99` (L9).
    pub(super) fn save_recording(&self, text: &str) -> JobResult {
        for number in 1..=MAX_RECORDINGS {
            let stem = format!("TEACH{number:02}");
            let file = format!("{stem}.NC");
            if let Err(FolderError::Missing { .. }) = self.folder.read_named(&PROGRAM, &file) {
                self.folder.write_named(&PROGRAM, &file, text.as_bytes())?;
                return Ok(done(format!("录返程序 {stem} 已保存"), format!("recorded as {stem}")));
            }
        }
        Err(refusal("TEACH01–TEACH99 都已存在，请先删除", "TEACH01 to TEACH99 already exist: delete one"))
    }

    pub(super) fn create(&self, number: u32, dialect: Dialect) -> JobResult {
        let file = file_number(number)?;
        self.folder.check_free(&PROGRAM, file)?;
        self.folder.write(&PROGRAM, file, nc::new_program_text(dialect, number).as_bytes())?;
        Ok(done(format!("O{number:04} 已新建"), format!("O{number:04} created")))
    }

    pub(super) fn copy(&self, from: u32, to: u32) -> JobResult {
        if self.named_file(from).is_none() {
            self.folder.copy(&PROGRAM, file_number(from)?, file_number(to)?)?;
        } else {
            let (bytes, file) = (self.read(from)?, file_number(to)?);
            self.folder.check_free(&PROGRAM, file)?;
            self.folder.write(&PROGRAM, file, &bytes)?;
        }
        let title = self.title(from);
        Ok(done(format!("{title} 已复制为 O{to:04}"), format!("{title} copied to O{to:04}")))
    }

    pub(super) fn rename(&self, from: u32, to: u32) -> JobResult {
        self.folder.rename(&PROGRAM, file_number(from)?, file_number(to)?)?;
        Ok(done(format!("O{from:04} 已改为 O{to:04}"), format!("O{from:04} renamed to O{to:04}")))
    }

    pub(super) fn delete(&self, number: u32) -> JobResult {
        match self.named_file(number) {
            Some(file) => self.folder.delete_named(&PROGRAM, file)?,
            None => self.folder.delete(&PROGRAM, file_number(number)?)?,
        }
        let title = self.title(number);
        Ok(done(format!("{title} 已删除"), format!("{title} deleted")))
    }
}

fn file_number(number: u32) -> Result<u16, Refusal> {
    let file = u16::try_from(number).ok().filter(|number| (1..=9_999).contains(number));
    file.ok_or_else(|| refusal("程序号应为 1-9999", "program numbers are 1 to 9999"))
}
