//! Reads the folders of programs and page files: splits programs into lines, parses page texts, checks pictures.
//! Runs on the disk thread or before a headless run, never in the tick.
//! Source: spec B1, K5.12, K7.3, K7.4.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use chrono::{DateTime, Local};
use image::{ImageFormat, ImageReader};
use ropey::Rope;

use super::picture_labels::{PICTURE_SIZE, parse_picture_labels};
use super::shipped::{SHIPPED, Shipped, shipped_picture};
use crate::controller::{FilePart, Programs, StoredProgram};
use crate::defs::kind::{Dialect, Kind};
use crate::defs::text::LocalizedText;
use crate::defs::{page_text, program_kind, program_number};
use crate::link::screens::{FileFault, Picture, PictureLabel, ScreenFiles, Screens};
use crate::link::snapshot::DirectoryRow;
use crate::nc::program_uses::UnitUse;
use crate::nc::{ProgramPart, Source, program_parts};
use crate::store::{
    DataDir, FileClass, FileContent, Folder, FolderEntry, FolderError, ListedFile, NamedProgram, PAGE_TEXT,
    PAGE_TEXT_EN, PICTURE, PICTURE_LABELS, PROGRAM, PROGRAMS_LIMIT, ProgramFolder, decode, folder_of,
    list_named_programs, program_stem, stamp,
};

/// Page file numbers of the programs with a grinding page: O1001 to O1020 use C0001/B0001 to C0020/B0020.
const PAGE_NUMBERS: std::ops::RangeInclusive<u32> = 1..=20;
/// Page file numbers of the R pages of the vertical grinder (S3).
const R_PAGE_NUMBERS: std::ops::RangeInclusive<u32> = 801..=803;
/// Number of the dressing page's picture, B0100.BMP (K7.6).
const DRESSING_PICTURE: u32 = 100;
/// Lines of a program that are searched for its kinds of machine, and characters of a line.
const HEAD_LINES: usize = 10;
const HEAD_CHARS: usize = 200;
/// Size of a page picture, bytes: 54 of header, 3 per pixel (K5.12).
pub const PICTURE_BYTES: usize = 54 + PIXEL_BYTES;
/// Bytes of its pixels.
const PIXEL_BYTES: usize = 3 * 200 * 400;
/// Where the header says at which byte the pixels begin.
const PIXELS_OFFSET: usize = 10;
/// Offsets of bits per pixel and compression in a BMP header, bytes.
const BITS_OFFSET: usize = 28;
const COMPRESSION_OFFSET: usize = 30;

/// The folders of programs and of page files.
#[derive(Clone, Debug)]
pub struct Folders {
    /// Folder of programs.
    pub programs: PathBuf,
    /// Folder of page texts and pictures.
    pub screens: PathBuf,
    /// Programs have names (`SHAFT.NC`) instead of O numbers (L1).
    pub by_name: bool,
    /// The dialect of the programs.
    pub dialect: Dialect,
}

fn is_same_folder(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

impl Folders {
    /// The given folders; otherwise `./programs` and `./screens`; otherwise those of the data directory. Empty folders
    /// of the data directory get the shipped files. Where there are data, a folder that cannot be filled is no error: the
    /// control starts, and says so when it reads the folder.
    ///
    /// # Errors
    /// The folder or a file in it cannot be created.
    pub fn resolve(
        programs: Option<PathBuf>,
        screens: Option<PathBuf>,
        data: &DataDir,
        kind: Kind,
    ) -> std::io::Result<Self> {
        let choose = |given: Option<PathBuf>, name: &str, own: PathBuf, shipped: &[Shipped]| match given {
            Some(path) => Ok(path),
            // A start within the data directory: its own folder gets the shipped files.
            None if Path::new(name).is_dir() && !is_same_folder(Path::new(name), &own) => Ok(PathBuf::from(name)),
            None => fill(data, shipped, &own).map(|()| own),
        };
        let of_kind = &kind.row().programs;
        let programs = match of_kind.folder {
            "" => choose(programs, "programs", data.programs(), &shipped_in("programs"))?,
            folder => choose(programs, &format!("programs/{folder}"), data.programs().join(folder), of_kind.shipped)?,
        };
        let screens = choose(screens, "screens", data.screens(), &shipped_in("screens"))?;
        Ok(Self { programs, screens, by_name: of_kind.by_name, dialect: kind.dialect() })
    }

    /// The folders of a data directory, as by [`Self::resolve`] without given ones.
    ///
    /// # Errors
    /// The folder or a file in it cannot be created.
    pub fn of_data(data: &DataDir, kind: Kind) -> std::io::Result<Self> {
        let of_kind = &kind.row().programs;
        let programs = data.programs().join(of_kind.folder);
        let numbered = shipped_in("programs");
        fill(data, if of_kind.folder.is_empty() { &numbered } else { of_kind.shipped }, &programs)?;
        fill(data, &shipped_in("screens"), &data.screens())?;
        Ok(Self { programs, screens: data.screens(), by_name: of_kind.by_name, dialect: kind.dialect() })
    }

    /// The program folder, for programs with numbers and with names.
    #[must_use]
    pub fn program_folder(&self) -> ProgramFolder {
        ProgramFolder::new(&self.programs, self.by_name)
    }

    /// Reads every program.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn read_programs(&self) -> Result<(Programs, Vec<DirectoryRow>), FolderError> {
        if self.by_name {
            return self.read_named();
        }
        let folder = Folder::new(&self.programs);
        let (mut rows, mut directory) = (Vec::new(), Vec::new());
        let mut budget = ReadBudget(PROGRAMS_LIMIT);
        let mut add = |read: Result<FileContent, FolderError>, row: DirectoryRow| {
            let programs = read.map(|read| programs_of_folder(row.number, &read.name, read.bytes, self.dialect));
            let programs = match programs {
                Ok(programs) => programs,
                // Deleted since it was listed.
                Err(FolderError::Missing { .. }) => return,
                Err(error) => return directory.push((false, unread_row(row, &error))),
            };
            for program in programs {
                let (english, kinds) = (english_title(&program), program.kinds.clone());
                let own = match &program.part {
                    None => DirectoryRow { english, kinds, ..row.clone() },
                    Some(_) => part_row(&program, &row.modified),
                };
                directory.push((program.part.is_some(), own));
                rows.push(program);
            }
        };
        for FolderEntry { number, name: file, size, modified, comment } in folder.list(&PROGRAM)?.entries {
            let (name, modified) = (program_number::name_of(number), time_text(modified));
            let (english, kinds) = (None, Vec::new());
            let row = DirectoryRow { number, name, size, comment, english, modified, kinds };
            add(budget.read(folder.path(), &row, || folder.read_named(&PROGRAM, &file)), row);
        }
        for NamedProgram { stem, name: file, size, modified, comment } in list_named_programs(&self.programs)? {
            let (number, modified) = (program_number::from_name(&stem), time_text(modified));
            let (english, kinds) = (None, Vec::new());
            let row = DirectoryRow { number, name: stem, size, comment, english, modified, kinds };
            add(budget.read(folder.path(), &row, || folder.read_named(&PROGRAM, &file)), row);
        }
        // The parts of files stand among the numbers; one row for each. Names follow in their order.
        let place = |row: &DirectoryRow| if program_number::is_o_number(row.number) { row.number } else { u32::MAX };
        directory.sort_by_key(|(is_part, row)| (place(row), *is_part));
        let mut directory: Vec<_> = directory.into_iter().map(|(_, row)| row).collect();
        directory.dedup_by_key(|row| row.number);
        let programs = Programs::new(rows);
        for twice in programs.duplicates() {
            for row in directory.iter_mut().filter(|row| row.number == twice.number) {
                row.comment = format!("重号 {}", twice.text);
                row.english = Some(format!("number used twice: {}", twice.text));
            }
        }
        Ok((programs, directory))
    }

    /// Reads programs with names in alphabetical order (L1).
    fn read_named(&self) -> Result<(Programs, Vec<DirectoryRow>), FolderError> {
        let shelf = self.program_folder();
        let (mut rows, mut directory) = (Vec::new(), Vec::new());
        let mut budget = ReadBudget(PROGRAMS_LIMIT);
        for ListedFile { name, size } in shelf.list()? {
            let stem = program_number::stem(&name).to_ascii_uppercase();
            let told = self.programs.join(&name).metadata().ok();
            let modified = time_text(told.and_then(|metadata| metadata.modified().ok()));
            let number = program_number::from_name(&stem);
            let (comment, english, kinds) = (String::new(), None, Vec::new());
            let row = DirectoryRow { number, name: stem, size, comment, english, modified, kinds };
            let FileContent { name, bytes } = match budget.read(&self.programs, &row, || shelf.read_listed(&name)) {
                Ok(read) => read,
                Err(FolderError::Missing { .. }) => continue,
                Err(error) => {
                    directory.push(unread_row(row, &error));
                    continue;
                }
            };
            let size = bytes.len() as u64;
            let program = program_from_bytes(number, &name, bytes, self.dialect);
            let comment = program.source.comment_title().unwrap_or_default();
            let (english, kinds) = (english_title(&program), program.kinds.clone());
            directory.push(DirectoryRow { size, comment, english, kinds, ..row });
            rows.push(program);
        }
        Ok((Programs::new(rows), directory))
    }

    /// Reads every page text and picture.
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn read_screens(&self) -> Result<Screens, FolderError> {
        let folder = Folder::new(&self.screens);
        let listed = |class: &FileClass| -> Result<Vec<u32>, FolderError> {
            Ok(folder.list(class)?.entries.iter().map(|entry| entry.number).collect())
        };
        let (texts, pictures) = (listed(&PAGE_TEXT)?, listed(&PICTURE)?);
        let pages = PAGE_NUMBERS
            .chain(R_PAGE_NUMBERS)
            .filter(|number| texts.contains(number) || pictures.contains(number))
            .map(|number| (1_000 + number, screen_files(&folder, number)))
            .collect();
        let dressing = Some(picture(&folder, DRESSING_PICTURE));
        Ok(Screens { pages, dressing })
    }
}

/// What a program is created for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramUse {
    /// To be shown and edited as well as executed.
    Pages,
    /// To be executed or checked: the text that pages show is left out. It would take the memory of the file once more.
    Execution,
}

/// What may still be read of a folder, bytes.
struct ReadBudget(u64);

impl ReadBudget {
    /// Reads the file of a row, if it fits.
    fn read(
        &mut self,
        folder: &Path,
        row: &DirectoryRow,
        read: impl FnOnce() -> Result<FileContent, FolderError>,
    ) -> Result<FileContent, FolderError> {
        // A file that is too large by itself says so.
        if row.size > self.0 && row.size <= PROGRAM.limit {
            return Err(FolderError::FolderTooLarge { path: folder.join(&row.name), limit: PROGRAMS_LIMIT });
        }
        let found = read()?;
        self.0 = self.0.saturating_sub(found.bytes.len() as u64);
        Ok(found)
    }
}

/// The row of a file that was not read: why. It cannot be loaded.
fn unread_row(row: DirectoryRow, error: &FolderError) -> DirectoryRow {
    let why = error.message();
    DirectoryRow { comment: why.zh().into_owned(), english: Some(why.en().into_owned()), ..row }
}

/// The kinds that a program names in its first lines.
fn kinds_of_program(text: &str) -> Vec<Kind> {
    let lines = text.split(['\r', '\n']).filter(|line| !line.is_empty());
    let head: Vec<String> = lines.take(HEAD_LINES).map(|line| line.chars().take(HEAD_CHARS).collect()).collect();
    program_kind::kinds_of(head.iter().map(String::as_str))
}

/// The row of a program that is not the first one of its file.
fn part_row(program: &StoredProgram, modified: &str) -> DirectoryRow {
    DirectoryRow {
        number: program.number,
        name: program.source.title(),
        size: program.source.bytes().len() as u64,
        comment: program.source.comment_title().unwrap_or_default(),
        english: english_title(program),
        modified: modified.to_owned(),
        kinds: program.kinds.clone(),
    }
}

/// The programs of a file of the folder. The only program of a file with a name has the number that its text gives, as those
/// of an export have.
fn programs_of_folder(number: u32, name: &str, bytes: Vec<u8>, dialect: Dialect) -> Vec<StoredProgram> {
    let own = match program_parts(&bytes, dialect).as_slice() {
        [only] if program_number::is_named(number) => only.number.filter(|own| program_number::is_o_number(*own)),
        _ => None,
    };
    match own {
        Some(own) => {
            let part = Some(FilePart { file: name.to_owned(), lines_before: 0 });
            vec![StoredProgram { part, ..create_program(own, name, bytes, dialect, ProgramUse::Pages) }]
        }
        None => programs_from_file(number, name, bytes, dialect, ProgramUse::Pages),
    }
}

/// Creates the programs of a file, the first one first. It has the number of the file, those behind it have their own. In
/// a file with a name, as other controls write exports, the first one has its own number, too.
#[must_use]
pub fn programs_from_file(
    number: u32,
    name: &str,
    bytes: Vec<u8>,
    dialect: Dialect,
    purpose: ProgramUse,
) -> Vec<StoredProgram> {
    let parts = program_parts(&bytes, dialect);
    if parts.len() == 1 {
        return vec![create_program(number, name, bytes, dialect, purpose)];
    }
    let is_export = program_number::is_named(number) && parts.first().is_some_and(|part| part.number.is_some());
    let mut programs = Vec::with_capacity(parts.len());
    for ProgramPart { number: own, name: own_name, bytes: range, lines_before } in parts {
        let Some(text) = bytes.get(range).map(<[u8]>::to_vec) else { continue };
        if programs.is_empty() && !is_export {
            programs.push(create_program(number, name, text, dialect, purpose));
        } else if let Some(own) = own {
            let part = Some(FilePart { file: name.to_owned(), lines_before });
            let program = create_program(own, own_name.as_deref().unwrap_or(name), text, dialect, purpose);
            programs.push(StoredProgram { part, ..program });
        }
    }
    programs
}

/// Creates a program from the bytes of its file, for pages and execution.
#[must_use]
pub fn program_from_bytes(number: u32, name: &str, bytes: Vec<u8>, dialect: Dialect) -> StoredProgram {
    create_program(number, name, bytes, dialect, ProgramUse::Pages)
}

fn create_program(number: u32, name: &str, bytes: Vec<u8>, dialect: Dialect, purpose: ProgramUse) -> StoredProgram {
    let (decoded, has_invalid_bytes) = match decode(&bytes) {
        Ok(decoded) => (decoded.text, false),
        Err(_) => (String::from_utf8_lossy(&bytes), true),
    };
    let kinds = kinds_of_program(&decoded);
    let text = if purpose == ProgramUse::Pages { Rope::from_str(&decoded) } else { Rope::new() };
    drop(decoded);
    let stamp = stamp(&bytes);
    let source = Arc::new(Source::new(number, name, bytes, dialect));
    let unit_use = UnitUse::of(&source);
    StoredProgram { number, source, text, stamp, unit_use, kinds, has_invalid_bytes, part: None }
}

/// The English title that a program gives (H9).
fn english_title(program: &StoredProgram) -> Option<String> {
    program.source.english_title().map(str::to_owned)
}

/// The other named programs in the folder of a named program. A call such as `L10` is searched there first.
#[must_use]
pub fn named_programs_beside(file: &Path, dialect: Dialect, purpose: ProgramUse) -> Vec<StoredProgram> {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if program_stem(&name).is_none() {
        return Vec::new();
    }
    let folder = Folder::new(folder_of(file));
    let read = |entry: NamedProgram| {
        let read = folder.read_named(&PROGRAM, &entry.name).ok()?;
        Some(create_program(program_number::from_name(&entry.stem), &read.name, read.bytes, dialect, purpose))
    };
    let beside = list_named_programs(folder_of(file)).unwrap_or_default().into_iter();
    beside.filter(|entry| entry.name != name).filter_map(read).collect()
}

/// A time of the computer's clock as the pages show it; empty if unknown.
pub(super) fn time_text(modified: Option<SystemTime>) -> String {
    modified.map(|time| DateTime::<Local>::from(time).format("%Y-%m-%d %H:%M").to_string()).unwrap_or_default()
}

/// The shipped files of a folder.
fn shipped_in(folder: &str) -> Vec<Shipped> {
    let name = |path: &'static str| path.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/'));
    SHIPPED.iter().filter_map(|(path, bytes)| Some((name(path)?, *bytes))).collect()
}

/// Stands in a folder that is being filled: a start that finds it goes on.
const INSTALLING: &str = ".installing";

/// Creates a folder and fills it if it is empty. What a full disk or a power cut has interrupted goes on at the next start;
/// files that are there stay as they are.
fn install_shipped(shipped: &[Shipped], own: &Path) -> std::io::Result<()> {
    let named = |error: std::io::Error| std::io::Error::new(error.kind(), format!("{}: {error}", own.display()));
    std::fs::create_dir_all(own).map_err(named)?;
    // Another process that begins on the same folder waits, and finds it filled. Where folders have no locks, it does not.
    let folder = std::fs::File::open(own);
    let _filling = folder.and_then(|folder| folder.lock().map(|()| folder));
    let marker = own.join(INSTALLING);
    if std::fs::read_dir(own).map_err(named)?.next().is_some() && !marker.exists() {
        return Ok(());
    }
    install_file(&marker, b"")?;
    for (file, bytes) in shipped.iter().filter(|(file, _)| !own.join(file).exists()) {
        install_file(&own.join(file), bytes)?;
    }
    std::fs::remove_file(marker)
}

/// Fills a new folder of a data directory. Where there are data, one that cannot be filled is no error.
fn fill(data: &DataDir, shipped: &[Shipped], own: &Path) -> std::io::Result<()> {
    match install_shipped(shipped, own) {
        Err(error) if !data.has_data() => Err(error),
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Writes a file beside its place and moves it there once it is on the disk: it is there whole, or not at all.
fn install_file(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let part = path.with_added_extension("part");
    let written = std::fs::write(&part, bytes)
        .and_then(|()| std::fs::File::open(&part)?.sync_all())
        .and_then(|()| std::fs::rename(&part, path));
    written.map_err(|error| {
        let text = format!("{}: cannot install: {error}; free disk space, then start again", path.display());
        std::io::Error::new(error.kind(), text)
    })
}

fn file_fault(file: &str, zh: impl Into<String>, en: impl Into<String>) -> FileFault {
    FileFault { file: file.to_owned(), position: None, message: LocalizedText::new(zh, en) }
}

/// Reads a page file; a fault is shown with alarm 66.
fn read_page_file(folder: &Folder, class: &FileClass, number: u32) -> Result<FileContent, FileFault> {
    folder.read(class, number).map_err(|error| match error {
        FolderError::Missing { name, .. } => {
            file_fault(&name, "文件不存在，请拷入 screens 目录", "missing: copy it into the screens folder")
        }
        other => FileFault { file: class.file_name(number), position: None, message: other.message() },
    })
}

/// Page text with its English, and picture. Without a valid English text the page is shown as written (H9).
fn screen_files(folder: &Folder, number: u32) -> ScreenFiles {
    let parsed = |class: &FileClass| -> Result<page_text::PageText, FileFault> {
        let found = read_page_file(folder, class, number)?;
        parse_page_text(&found.name, &found.bytes)
    };
    let (mut text, mut english_fault) = (parsed(&PAGE_TEXT), None);
    if folder.find(&PAGE_TEXT_EN, number).is_ok()
        && let Ok(text) = &mut text
    {
        match parsed(&PAGE_TEXT_EN) {
            Ok(english) => text.add_english(&english),
            Err(fault) => english_fault = Some(fault),
        }
    }
    let (labels, labels_fault) = match picture_labels(folder, number) {
        Ok(labels) => (labels, None),
        Err(fault) => (Vec::new(), Some(fault)),
    };
    let (text, picture) = (text.map(Arc::new), picture(folder, number));
    ScreenFiles { text, english_fault, picture, labels, labels_fault }
}

/// Parses a page text in UTF-8 or GBK.
///
/// # Errors
/// The first position that does not match the format.
pub fn parse_page_text(name: &str, bytes: &[u8]) -> Result<page_text::PageText, FileFault> {
    page_text::parse(&decoded_page_text(name, bytes)?).map_err(|wrong| text_fault(name, wrong))
}

/// Every position of a page text that does not match the format.
#[must_use]
pub fn page_text_faults(name: &str, bytes: &[u8]) -> Vec<FileFault> {
    match decoded_page_text(name, bytes) {
        Ok(text) => page_text::parse_all(&text).faults.into_iter().map(|wrong| text_fault(name, wrong)).collect(),
        Err(fault) => vec![fault],
    }
}

fn text_fault(name: &str, wrong: page_text::PageTextFault) -> FileFault {
    FileFault { file: name.to_owned(), position: Some((wrong.line, wrong.column)), message: wrong.message }
}

fn decoded_page_text(name: &str, bytes: &[u8]) -> Result<String, FileFault> {
    let decoded = decode(bytes).map_err(|error| {
        let en = "neither GBK nor UTF-8: save it again in an editor";
        let message = LocalizedText::new("不是 GBK 或 UTF-8 编码，请用记事本另存", en);
        FileFault { file: name.to_owned(), position: Some((error.line as u32, error.column as u32)), message }
    })?;
    Ok(decoded.text.into_owned())
}

fn picture(folder: &Folder, number: u32) -> Result<Arc<Picture>, FileFault> {
    let found = read_page_file(folder, &PICTURE, number)?;
    parse_picture(&found.name, &found.bytes).map(Arc::new)
}

/// The places of the variables in a picture; none without the file.
///
/// # Errors
/// What is wrong with the file.
pub fn picture_labels(folder: &Folder, number: u32) -> Result<Vec<PictureLabel>, FileFault> {
    if folder.find(&PICTURE_LABELS, number).is_err() {
        return Ok(Vec::new());
    }
    let found = read_page_file(folder, &PICTURE_LABELS, number)?;
    parse_picture_labels(&found.name, &found.bytes)
}

/// Checks a page picture: BMP, 200 × 400 pixels, 24 bit, uncompressed: 240 054 bytes, and padding behind
/// the pixels (K5.12).
///
/// # Errors
/// What is wrong with the picture.
pub fn parse_picture(name: &str, bytes: &[u8]) -> Result<Picture, FileFault> {
    if !bytes.starts_with(b"BM") {
        return Err(file_fault(name, "不是 BMP 文件", "not a BMP file"));
    }
    let number = |at: usize| bytes.get(at..at + 4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let (width, height) = (number(18), number(22).map(|height| (height as i32).unsigned_abs()));
    if (width, height) != (Some(PICTURE_SIZE.0), Some(PICTURE_SIZE.1)) {
        let (width, height) = (width.unwrap_or(0), height.unwrap_or(0));
        let en = format!("the picture is {width}×{height}, it must be 200×400 pixels");
        return Err(file_fault(name, format!("图片是 {width}×{height}，应为 200×400 点"), en));
    }
    let bits = number(BITS_OFFSET).map_or(0, |both| both & 0xFFFF);
    if bits != 24 {
        let en = format!("the picture has {bits} bits per pixel, save it with 24");
        return Err(file_fault(name, format!("图片是 {bits} 位，保存时请选 24 位"), en));
    }
    if number(COMPRESSION_OFFSET) != Some(0) {
        let en = "the picture is compressed, save it uncompressed";
        return Err(file_fault(name, "图片是压缩的，请存为不压缩的 BMP", en));
    }
    // Bytes behind the pixels are padding; PhotoShop writes two and counts them in the size of its header.
    let needed = number(PIXELS_OFFSET).map_or(PICTURE_BYTES, |start| start as usize + PIXEL_BYTES);
    let size = bytes.len();
    if size < needed {
        let en = format!("the file has only {size} bytes of {needed}: the copy is not complete");
        return Err(file_fault(name, format!("文件只有 {size} 字节，应有 {needed} 字节 (234K)：拷贝不完整"), en));
    }
    if let Some(shipped) = shipped_picture(name).filter(|shipped| *shipped == bytes) {
        return Ok(Picture(Cow::Borrowed(shipped)));
    }
    ImageReader::with_format(Cursor::new(bytes), ImageFormat::Bmp)
        .decode()
        .map_err(|error| file_fault(name, format!("图片损坏：{error}"), format!("the picture is damaged: {error}")))?;
    Ok(Picture(Cow::Owned(bytes.to_vec())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, size: u64) -> DirectoryRow {
        DirectoryRow { name: name.to_owned(), size, ..DirectoryRow::default() }
    }

    #[test]
    fn b1_a_program_beyond_the_limit_of_the_folder_is_not_read_and_a_smaller_one_is() {
        let mut budget = ReadBudget(10);
        let mut read = |name: &str, size: u64| {
            let bytes = vec![b' '; size as usize];
            budget.read(Path::new("programs"), &row(name, size), || Ok(FileContent { name: name.to_owned(), bytes }))
        };
        assert!(read("O0001", 6).is_ok());
        let refused = read("O0002", 5).unwrap_err();
        let told = unread_row(row("O0002", 5), &refused);
        assert_eq!(
            told.english.unwrap(),
            "O0002 is not read: all programs together are larger than 256 MB: delete some"
        );
        assert!(read("O0003", 4).is_ok());
        assert!(read("O0004", 1).is_err());
    }
}
