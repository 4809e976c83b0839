//! Changes of the program folder that the pages request: save, record, create, copy, rename, delete. A file may hold
//! several programs; a change of one leaves the others as they are.
//! Source: spec B1, B6, K6.2, L9.

use std::ops::Range;

use ropey::Rope;

use super::job_answer::{JobResult, done, refusal, saved};
use crate::controller::{FilePart, Programs};
use crate::defs::kind::Dialect;
use crate::defs::program_number;
use crate::link::files::Refusal;
use crate::nc::{self, ProgramPart, program_parts};
use crate::store::{Encoding, FileContent, Folder, FolderError, PROGRAM, decode, encode, stamp};

/// Maximum number of recordings in a folder.
const MAX_RECORDINGS: u32 = 99;
/// Line end between two programs of a file.
const NEW_LINE: &str = "\r\n";

/// The program folder, and the programs as the core knows them.
pub(super) struct ProgramFiles<'a> {
    pub folder: Folder,
    pub programs: &'a Programs,
    pub dialect: Dialect,
    /// The password for O9000 to O9999 was not entered.
    pub subprograms_locked: bool,
}

/// A file, and a program in it.
struct ProgramInFile {
    file: FileContent,
    /// The bytes of the program.
    program: Range<usize>,
    /// The number that the program must keep in its text; none for the first one, which has that of the file.
    own_number: Option<u32>,
    /// The number of the second program, if this is the first of several.
    next_number: Option<u32>,
}

/// Whether a protected subprogram follows the first program of a text.
fn has_subprogram_behind(text: &Rope, dialect: Dialect) -> bool {
    let (bytes, _) = encode(text, Encoding::Utf8);
    let is_protected = |part: &ProgramPart| part.number.is_some_and(program_number::is_protected_subprogram);
    program_parts(&bytes, dialect).iter().skip(1).any(is_protected)
}

impl ProgramInFile {
    fn program(&self) -> &[u8] {
        &self.file.bytes[self.program.clone()]
    }

    /// The file with another text in place of the program, that text, and whether the encoding was kept.
    fn with_text(&self, text: &Rope, dialect: Dialect) -> (Vec<u8>, Vec<u8>, bool) {
        let bytes = &self.file.bytes;
        let encoding = decode(bytes).map_or(Encoding::Utf8, |decoded| decoded.encoding);
        if self.program == (0..bytes.len()) {
            let (program, kept) = encode(text, encoding);
            return (program.clone(), program, kept);
        }
        let mut own = String::from(text);
        let begins = program_parts(own.as_bytes(), dialect).first().and_then(|part| part.number);
        if let Some(number) = self.own_number.filter(|_| begins.is_none()) {
            own.insert_str(0, &format!("{}{NEW_LINE}", program_number::name_of(number)));
        }
        if self.program.end < bytes.len() && !own.ends_with(['\r', '\n']) {
            own.push_str(NEW_LINE);
        }
        let shown = |bytes: &[u8]| decode(bytes).map(|decoded| decoded.text.into_owned());
        let around = (shown(&bytes[..self.program.start]), shown(&bytes[self.program.end..]));
        let program = encode(&Rope::from_str(&own), encoding);
        match around {
            // GBK lacks a character: the whole file becomes UTF-8.
            (Ok(before), Ok(after)) if !program.1 => {
                (format!("{before}{own}{after}").into_bytes(), own.into_bytes(), false)
            }
            _ => (self.with_bytes(&program.0), program.0, program.1),
        }
    }

    /// Whether a new file still begins this program where it was and ends it where the new text ends: no other program
    /// becomes a part of it, and it does not divide or join others.
    fn stays_apart(&self, file: &[u8], program: &[u8], dialect: Dialect) -> bool {
        let (before, after) = (program_parts(&self.file.bytes, dialect), program_parts(file, dialect));
        let index = before.iter().position(|part| part.bytes == self.program);
        let part = index.and_then(|index| after.get(index));
        before.len() == after.len() && part.is_some_and(|part| file[part.bytes.clone()] == *program)
    }

    /// The file with other bytes in place of the program.
    fn with_bytes(&self, program: &[u8]) -> Vec<u8> {
        let bytes = &self.file.bytes;
        [&bytes[..self.program.start], program, &bytes[self.program.end..]].concat()
    }
}

impl ProgramFiles<'_> {
    /// File name of a named program; `None` for a program with a number.
    fn named_file(&self, number: u32) -> Option<&str> {
        let program = self.programs.get(number).filter(|_| program_number::is_named(number))?;
        Some(program.source.name())
    }

    /// The place of a program that is not the first one of its file.
    fn part(&self, number: u32) -> Option<&FilePart> {
        self.programs.get(number)?.part.as_ref()
    }

    /// Title used in messages.
    fn title(&self, number: u32) -> String {
        let program = self.programs.get(number);
        program.map_or_else(|| program_number::name_of(number), |program| program.source.title())
    }

    fn read_file(&self, number: u32) -> Result<FileContent, FolderError> {
        match self.part(number).map(|part| part.file.as_str()).or_else(|| self.named_file(number)) {
            Some(file) => self.folder.read_named(&PROGRAM, file),
            None => self.folder.read(&PROGRAM, file_number(number).unwrap_or_default()),
        }
    }

    /// The program in a file that was just read. Another computer may have changed the file: then it is a conflict.
    fn find_in(&self, number: u32, file: FileContent) -> Result<ProgramInFile, Refusal> {
        let own_number = self.part(number).map(|_| number);
        let parts = program_parts(&file.bytes, self.dialect);
        // The first program of a file with a number has that of the file.
        let numbered = self.part(number).is_some_and(|part| PROGRAM.parse(&part.file).is_some());
        let is_wanted = |(index, part): &(usize, &ProgramPart)| match own_number {
            Some(_) => *index >= usize::from(numbered) && part.number == own_number,
            None => *index == 0,
        };
        let (_, part) = parts.iter().enumerate().find(is_wanted).ok_or(Refusal::Conflict)?;
        let next_number = parts.get(1).filter(|_| own_number.is_none()).and_then(|next| next.number);
        Ok(ProgramInFile { program: part.bytes.clone(), own_number, next_number, file })
    }

    fn read(&self, number: u32) -> Result<ProgramInFile, Refusal> {
        self.find_in(number, self.read_file(number)?)
    }

    /// Writes the file of a program.
    fn write_file(&self, number: u32, bytes: &[u8]) -> Result<(), Refusal> {
        match self.part(number).map(|part| part.file.as_str()).or_else(|| self.named_file(number)) {
            Some(file) => self.folder.write_named(&PROGRAM, file, bytes)?,
            None => self.folder.write(&PROGRAM, file_number(number)?, bytes)?,
        };
        Ok(())
    }

    /// Checks that neither a file nor a program in a file has a number.
    fn check_free(&self, number: u32) -> Result<u32, Refusal> {
        let file = file_number(number)?;
        if let Some(part) = self.part(number) {
            let (zh, en) = (format!("O{number:04} 在 {} 中", part.file), format!("O{number:04} is in {}", part.file));
            return Err(refusal(zh, en));
        }
        self.folder.check_free(&PROGRAM, file)?;
        Ok(file)
    }

    /// Replaces a program unless it was changed since it was read. Keeps its encoding, or UTF-8 if GBK lacks a character.
    pub(super) fn save(&self, number: u32, text: &Rope, (base, force): (u64, bool)) -> JobResult {
        if self.subprograms_locked && has_subprogram_behind(text, self.dialect) {
            return Err(Refusal::Password);
        }
        let file = match self.read_file(number) {
            // Deleted meanwhile: writing it again loses nothing.
            Err(FolderError::Missing { .. }) => {
                let (bytes, _) = encode(text, Encoding::Utf8);
                self.write_file(number, &bytes)?;
                return Ok(saved(&self.title(number), number, &bytes, true));
            }
            read => read?,
        };
        let placed = self.find_in(number, file)?;
        if !force && stamp(placed.program()) != base {
            return Err(Refusal::Conflict);
        }
        let (file, program, kept) = placed.with_text(text, self.dialect);
        let is_alone = placed.program == (0..placed.file.bytes.len());
        if !is_alone && !placed.stays_apart(&file, &program, self.dialect) {
            return Err(refusal(
                "此文件有几个程序：程序号必须写在该程序最前面，且只能有一个",
                "this file holds several programs: its number must come first in the program, and only one",
            ));
        }
        self.write_file(number, &file)?;
        Ok(saved(&self.title(number), number, &program, kept))
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

    pub(super) fn create(&self, number: u32) -> JobResult {
        let file = self.check_free(number)?;
        self.folder.write(&PROGRAM, file, nc::new_program_text(self.dialect, number).as_bytes())?;
        Ok(done(format!("O{number:04} 已新建"), format!("O{number:04} created")))
    }

    pub(super) fn copy(&self, from: u32, to: u32) -> JobResult {
        let file = self.check_free(to)?;
        self.folder.write(&PROGRAM, file, self.read(from)?.program())?;
        let title = self.title(from);
        Ok(done(format!("{title} 已复制为 O{to:04}"), format!("{title} copied to O{to:04}")))
    }

    pub(super) fn rename(&self, from: u32, to: u32) -> JobResult {
        let file = self.check_free(to)?;
        if self.part(from).is_none() {
            self.folder.rename(&PROGRAM, file_number(from)?, file)?;
        } else {
            let placed = self.read(from)?;
            let text = placed.program();
            let Some((_, rest)) = nc::o_number(text) else {
                return Err(refusal(
                    "有名称的程序在归档文件中，不能改名",
                    "a program with a name in an archive file cannot be renamed",
                ));
            };
            let renamed = [format!("O{to:04}").as_bytes(), rest].concat();
            self.write_file(from, &placed.with_bytes(&renamed))?;
        }
        Ok(done(format!("O{from:04} 已改为 O{to:04}"), format!("O{from:04} renamed to O{to:04}")))
    }

    pub(super) fn delete(&self, number: u32) -> JobResult {
        let placed = self.read(number)?;
        match (self.named_file(number), placed.next_number) {
            (_, None) if placed.own_number.is_some() => self.write_file(number, &placed.with_bytes(b""))?,
            (Some(file), None) => self.folder.delete_named(&PROGRAM, file)?,
            (None, None) => self.folder.delete(&PROGRAM, file_number(number)?)?,
            // The file gets the number of the next program in it.
            (None, Some(next)) => {
                let file = file_number(next)?;
                self.folder.check_free(&PROGRAM, file)?;
                self.folder.write(&PROGRAM, file, &placed.with_bytes(b""))?;
                self.folder.delete(&PROGRAM, file_number(number)?)?;
            }
            (Some(file), Some(_)) => {
                let zh = format!("{file} 里还有其它程序，请先删除它们");
                return Err(refusal(zh, format!("{file} holds other programs: delete those first")));
            }
        }
        let title = self.title(number);
        Ok(done(format!("{title} 已删除"), format!("{title} deleted")))
    }
}

fn file_number(number: u32) -> Result<u32, Refusal> {
    program_number::is_o_number(number).then_some(number).ok_or_else(|| {
        let most = program_number::O_MAX;
        refusal(format!("程序号应为 1-{most}"), format!("program numbers are 1 to {most}"))
    })
}
