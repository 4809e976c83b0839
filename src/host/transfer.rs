//! Transfers programs, page files, values and a backup of everything between control and USB drive; saves screenshots.
//! Every file is written atomically and read back. Existing files are overwritten only after confirmation.
//! Source: spec K7.8, H8.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::folders::Folders;
use super::job_answer::{JobResult, Tell, cancelled, check_read_back, done, error_refusal, no_usb_drive, refusal};
use super::program_split;
use super::value_set;
use crate::controller::files::TransferValues;
use crate::defs::date::DateTime;
use crate::defs::program_number;
use crate::defs::text::{LocalizedText, Text};
use crate::link::files::{FileAnswer, Refusal, RestoredValues};
use crate::link::media::{Direction, MediaFile, MediaView, Screenshot, TransferRequest, TransferSet};
use crate::store::{
    CommentSource, FileClass, FileContent, Folder, FolderEntry, FolderError, ListedFile, PAGE_FILES, PICTURE, PROGRAM,
    ProgramFolder, UsbDrive, Values, read_regular_file, stamp, write_atomic,
};

/// Names of the value files on a USB drive.
const PARAM_FILE: &str = "KT830-PARAM.RON";
const VARIABLE_FILE: &str = "KT830-MACRO.RON";
/// Prefix and suffix of archive names.
pub const ARCHIVE_NAME: (&str, &str) = ("KT830-", ".TAR");
/// Folders in an archive.
const PROGRAM_PREFIX: &str = "programs/";
const SCREEN_PREFIX: &str = "screens/";
/// Text shown with the progress.
const COPYING: Text = Text::new("正在复制", "copying");
/// Maximum size of an archive, bytes.
const ARCHIVE_LIMIT: u64 = 512 * 1024 * 1024;
/// Maximum size of a value file, bytes.
const VALUES_LIMIT: u64 = 4 * 1024 * 1024;
/// Maximum size of a screenshot, bytes of RGB data.
const PRINT_LIMIT: usize = 64 * 1024 * 1024;

/// Pictures on a USB drive; other formats than BMP can be converted (K5.12).
pub(super) const FOREIGN_PICTURE: FileClass = FileClass {
    letter: 'B',
    max_digits: PICTURE.max_digits,
    extensions: &["BMP", "PNG", "JPG", "JPEG"],
    limit: 32 * 1024 * 1024,
    comment_source: CommentSource::None,
};
/// Maximum side, pixels, and memory, bytes, of a picture to convert.
const PICTURE_SIDE_LIMIT: u32 = 10_000;
const PICTURE_MEMORY_LIMIT: u64 = 256 * 1024 * 1024;

/// The class and number of a page file.
fn parse_page_file(name: &str) -> Option<(&'static FileClass, u32)> {
    static CLASSES: [FileClass; 4] = PAGE_FILES;
    CLASSES.iter().find_map(|class| class.parse(name).map(|(number, _)| (class, number)))
}

/// The set that a file on a USB drive belongs to; `None` for other files.
fn set_of(name: &str, programs: &ProgramFolder) -> Option<TransferSet> {
    match name {
        PARAM_FILE => Some(TransferSet::Params),
        VARIABLE_FILE => Some(TransferSet::Variables),
        name if is_archive(name) => Some(TransferSet::Backup),
        name if parse_page_file(name).is_some() || FOREIGN_PICTURE.parse(name).is_some() => Some(TransferSet::Screens),
        name => {
            let foreign = !programs.is_by_name() && program_split::is_foreign_program_file(name);
            (programs.is_program_name(name) || foreign).then_some(TransferSet::Programs)
        }
    }
}

/// The files on the control and on the USB drive.
#[must_use]
pub fn media_view(folders: &Folders, drive: Option<&UsbDrive>) -> MediaView {
    let shelf = folders.program_folder();
    let present = drive.filter(|drive| drive.is_present());
    let file = |name, size, set| MediaFile { name, size, set };
    let there = present.and_then(|drive| drive.files().ok()).unwrap_or_default().into_iter();
    let there = there.filter_map(|found| set_of(&found.name, &shelf).map(|set| file(found.name, found.size, set)));
    let programs = shelf.list().unwrap_or_default().into_iter();
    let mut here: Vec<_> = programs.map(|found| file(found.name, found.size, TransferSet::Programs)).collect();
    for class in PAGE_FILES {
        let entries = Folder::new(&folders.screens).list(&class).map(|listing| listing.entries).unwrap_or_default();
        here.extend(entries.into_iter().map(|found| file(found.name, found.size, TransferSet::Screens)));
    }
    MediaView {
        medium_folder: present.map(|drive| drive.root().display().to_string()),
        free_bytes: present.and_then(UsbDrive::free_bytes),
        medium_files: there.collect(),
        control_files: here,
        ..MediaView::default()
    }
}

fn is_archive(name: &str) -> bool {
    name.starts_with(ARCHIVE_NAME.0) && name.ends_with(ARCHIVE_NAME.1)
}

/// One transfer.
pub struct UsbTransfer<'a> {
    /// The control's folders.
    pub folders: &'a Folders,
    /// The USB drive.
    pub usb_drive: &'a UsbDrive,
    /// The values of the core.
    pub holdings: Option<&'a TransferValues>,
    /// The password for O9000 to O9999 was not entered.
    pub subprograms_locked: bool,
    /// Cancels the transfer between two files.
    pub cancelled: &'a AtomicBool,
    /// Date and time for file names.
    pub date: DateTime,
}

impl UsbTransfer<'_> {
    /// Executes a transfer and returns the result.
    ///
    /// # Errors
    /// Why it failed or was not completed.
    pub fn run(&self, ask: &TransferRequest, tell: &mut dyn FnMut(FileAnswer)) -> JobResult {
        if !self.usb_drive.is_present() {
            return Err(no_usb_drive());
        }
        let result = match (ask.set, ask.direction) {
            (TransferSet::Programs | TransferSet::Screens, _) => self.copy_files(ask, tell),
            (TransferSet::Params | TransferSet::Variables, Direction::Export) => self.write_values(ask),
            (TransferSet::Params | TransferSet::Variables, Direction::Import) => self.read_values(ask.set),
            (TransferSet::Backup, Direction::Export) => self.backup(tell),
            (TransferSet::Backup, Direction::Import) => self.restore(ask, tell),
            // Serial transfers do not use a USB drive.
            (TransferSet::Serial, _) => Err(no_usb_drive()),
        };
        // If the USB drive was removed, that is the cause, whatever the system reports.
        result.map_err(|refusal| if self.usb_drive.is_present() { refusal } else { no_usb_drive() })
    }

    /// The files to copy, sorted by name.
    fn pending_files(&self, ask: &TransferRequest) -> Result<Vec<PendingFile>, Refusal> {
        let wanted = |name: &str| ask.names.is_empty() || ask.names.iter().any(|wanted| wanted == name);
        let import = ask.direction == Direction::Import;
        let mut waiting = Vec::new();
        if ask.set == TransferSet::Programs {
            let drive = ProgramFolder::new(self.usb_drive.root(), self.folders.by_name);
            if import && !self.folders.by_name {
                return self.incoming_programs(ask);
            }
            let (from, to) = in_direction(import, self.folders.program_folder(), drive);
            for ListedFile { name, size } in from.list()?.into_iter().filter(|file| wanted(&file.name)) {
                let place = |folder: &ProgramFolder| FilePlace::Program(folder.clone(), name.clone());
                let from = Incoming::File(place(&from));
                waiting.push(PendingFile { from, to: place(&to), foreign: false, size, name });
            }
            return Ok(waiting);
        }
        let (from, to) = in_direction(import, Folder::new(&self.folders.screens), Folder::new(self.usb_drive.root()));
        for class in PAGE_FILES {
            // Incoming pictures can have other formats.
            let foreign = import && class.letter == PICTURE.letter;
            let read_as = if foreign { FOREIGN_PICTURE } else { class };
            for FolderEntry { name, size, number, .. } in from.list(&read_as)?.entries {
                if wanted(&name) {
                    let from = Incoming::File(FilePlace::Page(from.clone(), read_as, number));
                    let to = FilePlace::Page(to.clone(), class, number);
                    waiting.push(PendingFile { from, to, foreign, size, name });
                }
            }
        }
        Ok(waiting)
    }

    /// The programs of the drive. Files with several programs are divided if the operator wants it.
    fn incoming_programs(&self, ask: &TransferRequest) -> Result<Vec<PendingFile>, Refusal> {
        let drive = ProgramFolder::new(self.usb_drive.root(), self.folders.by_name);
        let (shelf, mut waiting, mut several) = (self.folders.program_folder(), Vec::new(), Vec::new());
        // The files that the programs come from.
        let mut sources = Vec::new();
        let wanted = |name: &str| ask.names.is_empty() || ask.names.iter().any(|wanted| wanted == name);
        let files = self.usb_drive.files().map_err(FolderError::from)?.into_iter();
        for ListedFile { name, size } in files.filter(|file| wanted(&file.name)) {
            if set_of(&name, &shelf) != Some(TransferSet::Programs) {
                continue;
            }
            let read = read_regular_file(&self.usb_drive.root().join(&name), PROGRAM.limit).map_err(Refusal::from);
            let split = read.and_then(|bytes| program_split::split(&name, &bytes, &shelf, self.folders.dialect));
            let parts = match split {
                // Not chosen by name: any text of the drive.
                Err(_) if ask.names.is_empty() && !shelf.is_program_name(&name) => continue,
                parts => parts?,
            };
            let is_protected = |name: &str| {
                program_number::is_protected_subprogram(program_number::from_name(program_number::stem(name)))
            };
            if self.subprograms_locked && parts.iter().any(|(name, _)| is_protected(name)) {
                return Err(Refusal::Password);
            }
            let together = ask.split == Some(false) && shelf.is_program_name(&name);
            if parts.is_empty() || together {
                let to = FilePlace::Program(shelf.clone(), name.clone());
                let from = Incoming::File(FilePlace::Program(drive.clone(), name.clone()));
                sources.push(name.clone());
                waiting.push(PendingFile { from, to, foreign: false, size, name });
                continue;
            }
            let names: Vec<_> = parts.iter().map(|(name, _)| name.as_str()).collect();
            several.push(format!("{name}: {}", names.join("  ")));
            sources.extend(parts.iter().map(|_| name.clone()));
            for (name, bytes) in parts {
                let to = FilePlace::Program(shelf.clone(), name.clone());
                let size = bytes.len() as u64;
                waiting.push(PendingFile { from: Incoming::Text(bytes), to, foreign: false, size, name });
            }
        }
        if ask.split.is_none() && !several.is_empty() {
            return Err(Refusal::Split(several));
        }
        let targets: Vec<_> = waiting.iter().map(|file| &file.name).collect();
        let twice = targets.iter().enumerate().find_map(|(at, name)| {
            let first = targets[..at].iter().position(|other| other == name)?;
            Some((*name, &sources[first], &sources[at]))
        });
        if let Some((name, first, second)) = twice {
            return Err(refusal(
                format!("{first} 和 {second} 里都有 {name}，没有复制：请只选一个文件"),
                format!("{name} is in {first} and in {second}; nothing was copied: choose one of the files"),
            ));
        }
        Ok(waiting)
    }

    /// A file of the control by its name.
    fn own_file(&self, set: TransferSet, name: &str) -> FilePlace {
        match parse_page_file(name).filter(|_| set == TransferSet::Screens) {
            Some((class, number)) => FilePlace::Page(Folder::new(&self.folders.screens), *class, number),
            None => FilePlace::Program(self.folders.program_folder(), name.to_owned()),
        }
    }

    /// Copies programs or page files one by one.
    fn copy_files(&self, ask: &TransferRequest, tell: Tell<'_>) -> JobResult {
        let waiting = self.pending_files(ask)?;
        if waiting.is_empty() {
            return Err(refusal("没有可复制的文件", "there is nothing to copy"));
        }
        let (mut clashing, mut foreign) = (Vec::new(), Vec::new());
        for file in &waiting {
            let (new, fault) = file.read_source()?;
            foreign.extend(fault);
            if let Ok(old) = file.to.read()
                && stamp(&old.bytes) != stamp(&new)
            {
                clashing.push(file.name.clone());
            }
        }
        if ask.convert != Some(true) && !foreign.is_empty() {
            return Err(Refusal::Convert(foreign));
        }
        if ask.overwrite.is_none() && !clashing.is_empty() {
            return Err(Refusal::Overwrite(clashing));
        }
        let all: u64 = waiting.iter().map(|file| file.size).sum::<u64>().max(1);
        let (mut copied_bytes, mut copied, mut skipped) = (0, 0, 0);
        for file in &waiting {
            if self.cancelled.load(Ordering::Acquire) {
                let zh = format!("已取消，已复制 {copied} 个文件");
                return Err(refusal(zh, format!("cancelled after {copied} files")));
            }
            tell(FileAnswer::Progress(COPYING, (copied_bytes * 1_000 / all) as u16));
            copied_bytes += file.size;
            if ask.overwrite == Some(false) && clashing.contains(&file.name) {
                skipped += 1;
                continue;
            }
            file.copy()?;
            copied += 1;
        }
        let (skipped_zh, skipped_en) = match skipped {
            0 => Default::default(),
            _ => (format!("，跳过 {skipped} 个"), format!(", {skipped} skipped")),
        };
        Ok(done(format!("已复制 {copied} 个文件{skipped_zh}"), format!("{copied} files copied{skipped_en}")))
    }

    fn write_values(&self, ask: &TransferRequest) -> JobResult {
        let holdings = self.holdings.ok_or_else(no_usb_drive)?;
        let all = value_set::from_holdings(holdings);
        let (name, part) = part_of(all, ask.set);
        let path = self.usb_drive.root().join(name);
        if ask.overwrite.is_none() && path.exists() && Values::read(&path).ok().as_ref() != Some(&part) {
            return Err(Refusal::Overwrite(vec![name.to_owned()]));
        }
        if ask.overwrite == Some(false) && path.exists() {
            return Ok(done("未改动", "nothing was changed"));
        }
        part.write(&path).map_err(error_refusal)?;
        check_read_back(name, Values::read(&path).map_err(error_refusal)? == part)?;
        Ok(done(format!("已写出 {name}"), format!("{name} written")))
    }

    fn read_values(&self, set: TransferSet) -> JobResult {
        let (name, _) = part_of(Values::default(), set);
        let path = self.usb_drive.root().join(name);
        if std::fs::symlink_metadata(&path).is_ok_and(|told| told.len() > VALUES_LIMIT) {
            return Err(refusal(format!("{name} 太大"), format!("{name} is too large")));
        }
        let all = Values::read(&path).map_err(error_refusal)?;
        if let Some((zh, en)) = value_set::foreign_section(&all, set) {
            return Err(refusal(
                format!("{name} 里还有{zh}，不从该文件读入；请删去该部分，或用备份恢复"),
                format!("{name} also has {en}, which are not read from it: delete that part, or restore a backup"),
            ));
        }
        let (_, part) = part_of(all, set);
        Ok(FileAnswer::Restored(Box::new(self.check_values(&part)?)))
    }

    fn check_values(&self, part: &Values) -> Result<RestoredValues, Refusal> {
        value_set::check_values(part, self.holdings.ok_or_else(no_usb_drive)?.kind)
    }

    /// Writes everything into one archive, followed by a list of checksums.
    fn backup(&self, tell: Tell<'_>) -> JobResult {
        let holdings = self.holdings.ok_or_else(no_usb_drive)?;
        let name = format!("{}{}{}", ARCHIVE_NAME.0, self.date.compact(), ARCHIVE_NAME.1);
        let mut archive = tar::Builder::new(Vec::new());
        let mut sums = String::new();
        let text = value_set::from_holdings(holdings).to_text().map_err(error_refusal)?;
        append_file((&mut archive, &mut sums), "values.ron", text.as_bytes())?;
        let view = media_view(self.folders, None);
        let all = view.control_files.iter().map(|file| file.size).sum::<u64>().max(1);
        let mut copied = 0;
        for file in &view.control_files {
            if self.cancelled.load(Ordering::Acquire) {
                return Err(cancelled());
            }
            tell(FileAnswer::Progress(COPYING, (copied * 900 / all) as u16));
            let prefix = if file.set == TransferSet::Screens { SCREEN_PREFIX } else { PROGRAM_PREFIX };
            let read = self.own_file(file.set, &file.name).read()?;
            append_file((&mut archive, &mut sums), &format!("{prefix}{}", read.name), &read.bytes)?;
            copied += file.size;
        }
        let list = sums.clone();
        append_file((&mut archive, &mut sums), "checksums.txt", list.as_bytes())?;
        let bytes = archive.into_inner().map_err(error_refusal)?;
        let path = self.usb_drive.root().join(&name);
        write_atomic(&path, &bytes)?;
        let back = read_regular_file(&path, ARCHIVE_LIMIT)?;
        check_read_back(&name, stamp(&back) == stamp(&bytes))?;
        Ok(done(format!("已备份到 {name}"), format!("backup written: {name}")))
    }

    /// Restores everything from an archive. The whole archive is checked before the first file is written.
    fn restore(&self, ask: &TransferRequest, tell: Tell<'_>) -> JobResult {
        let files = self.usb_drive.files().map_err(FolderError::from)?;
        let fits = |name: &&String| is_archive(name) && (ask.names.is_empty() || ask.names.contains(name));
        let chosen = files.iter().rev().map(|file| &file.name).find(fits);
        let name = chosen.ok_or_else(|| refusal("U 盘上没有备份文件", "there is no backup on the USB stick"))?;
        if ask.overwrite.is_none() {
            return Err(Refusal::Overwrite(vec![name.clone()]));
        }
        let bytes = read_regular_file(&self.usb_drive.root().join(name), ARCHIVE_LIMIT)?;
        let shelf = self.folders.program_folder();
        let (values, contents) = read_archive(name, &bytes, &shelf)?;
        let restored = self.check_values(&values)?;
        let all = contents.len().max(1);
        for (index, (set, name, bytes)) in contents.iter().enumerate() {
            tell(FileAnswer::Progress(COPYING, (index * 1_000 / all) as u16));
            self.own_file(*set, name).write(bytes)?;
        }
        Ok(FileAnswer::Restored(Box::new(restored)))
    }
}

/// Source and target of a transfer.
fn in_direction<T>(import: bool, own: T, drive: T) -> (T, T) {
    if import { (drive, own) } else { (own, drive) }
}

/// A file on the control or on the USB drive.
enum FilePlace {
    /// A program by name.
    Program(ProgramFolder, String),
    /// A page file by number.
    Page(Folder, FileClass, u32),
}

impl FilePlace {
    fn read(&self) -> Result<FileContent, FolderError> {
        match self {
            Self::Program(folder, name) => folder.read(name),
            Self::Page(folder, class, number) => folder.read(class, *number),
        }
    }

    fn write(&self, bytes: &[u8]) -> Result<String, FolderError> {
        match self {
            Self::Program(folder, name) => folder.write(name, bytes),
            Self::Page(folder, class, number) => folder.write(class, *number, bytes),
        }
    }
}

/// What is copied.
enum Incoming {
    File(FilePlace),
    Text(Vec<u8>),
}

/// A file to copy.
struct PendingFile {
    name: String,
    size: u64,
    from: Incoming,
    to: FilePlace,
    /// Incoming: a file with another format than a page picture is converted.
    foreign: bool,
}

impl PendingFile {
    /// The bytes to write. For a converted picture also the reason for the conversion.
    fn read_source(&self) -> Result<(Vec<u8>, Option<LocalizedText>), Refusal> {
        let read = match &self.from {
            Incoming::File(file) => file.read()?,
            Incoming::Text(bytes) => return Ok((bytes.clone(), None)),
        };
        if !self.foreign {
            return Ok((read.bytes, None));
        }
        match super::folders::parse_picture(&read.name, &read.bytes) {
            Ok(_) => Ok((read.bytes, None)),
            Err(fault) => match convert_picture(&read.bytes) {
                Ok(bytes) => Ok((bytes, Some(fault.full_message()))),
                Err(_) => Err(Refusal::Other(fault.full_message())),
            },
        }
    }

    /// Writes the file, reads it back and compares.
    fn copy(&self) -> Result<(), Refusal> {
        let (bytes, _) = self.read_source()?;
        let name = self.to.write(&bytes)?;
        check_read_back(&name, stamp(&self.to.read()?.bytes) == stamp(&bytes))
    }
}

/// Converts a PNG, JPEG or BMP to a page picture: scaled to fit 200 × 400 pixels, white background, 24 bit (K5.12).
///
/// # Errors
/// It is not such a picture, or it is too large.
pub fn convert_picture(bytes: &[u8]) -> Result<Vec<u8>, image::ImageError> {
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format()?;
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(PICTURE_SIDE_LIMIT), Some(PICTURE_SIDE_LIMIT));
    limits.max_alloc = Some(PICTURE_MEMORY_LIMIT);
    reader.limits(limits);
    let (width, height) = super::picture_labels::PICTURE_SIZE;
    let fitted = reader.decode()?.resize(width, height, image::imageops::FilterType::Triangle).to_rgba8();
    let mut page = image::RgbaImage::from_pixel(width, height, image::Rgba([255; 4]));
    let corner = (i64::from(width - fitted.width()) / 2, i64::from(height - fitted.height()) / 2);
    image::imageops::overlay(&mut page, &fitted, corner.0, corner.1);
    let mut bmp = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageRgba8(page).to_rgb8().write_to(&mut bmp, image::ImageFormat::Bmp)?;
    Ok(bmp.into_inner())
}

/// The values of a value file, and its name.
fn part_of(all: Values, set: TransferSet) -> (&'static str, Values) {
    match set {
        TransferSet::Params => (PARAM_FILE, Values { kind: all.kind, params: all.params, ..Values::default() }),
        _ => (VARIABLE_FILE, Values { variables: all.variables, ..Values::default() }),
    }
}

/// Adds a file to an archive and to its list of checksums.
fn append_file(into: (&mut tar::Builder<Vec<u8>>, &mut String), name: &str, bytes: &[u8]) -> Result<(), Refusal> {
    let (archive, sums) = into;
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o644);
    header.set_cksum();
    sums.push_str(&format!("{:016x} {name}\n", stamp(bytes)));
    archive.append_data(&mut header, name, bytes).map_err(error_refusal)
}

/// The files of an archive: set, name within its folder, bytes.
pub type ArchiveContents = Vec<(TransferSet, String, Vec<u8>)>;

/// Reads an archive in memory.
///
/// # Errors
/// One invalid name, file type or checksum refuses the whole archive.
pub fn read_archive(name: &str, bytes: &[u8], shelf: &ProgramFolder) -> Result<(Values, ArchiveContents), Refusal> {
    use std::io::Read as _;
    let damaged = |what: &str| {
        refusal(
            format!("备份 {name} 已损坏或不是本系统的文件：{what}"),
            format!("{name} is damaged or not a backup of this control: {what}"),
        )
    };
    let (mut values, mut contents, mut sums, mut listed) = (None, Vec::new(), Vec::new(), None);
    let mut archive = tar::Archive::new(bytes);
    for entry in archive.entries().map_err(|error| damaged(&error.to_string()))? {
        let mut entry = entry.map_err(|error| damaged(&error.to_string()))?;
        let path = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        if !entry.header().entry_type().is_file() || entry.size() > PROGRAM.limit {
            return Err(damaged(&path));
        }
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(|error| damaged(&error.to_string()))?;
        let sum = format!("{:016x} {path}", stamp(&bytes));
        match path.as_str() {
            "checksums.txt" => {
                listed = Some(String::from_utf8_lossy(&bytes).into_owned());
                continue;
            }
            "values.ron" => {
                let text = String::from_utf8_lossy(&bytes);
                values = Some(Values::from_text(&text).map_err(|error| damaged(&error.to_string()))?);
            }
            other => {
                let program = other.strip_prefix(PROGRAM_PREFIX).filter(|name| shelf.is_program_name(name));
                let page = other
                    .strip_prefix(SCREEN_PREFIX)
                    .and_then(|name| parse_page_file(name).map(|(class, _)| (name, class)));
                let (set, file, limit) = match (program, page) {
                    (Some(name), _) => (TransferSet::Programs, name, PROGRAM.limit),
                    (None, Some((name, class))) => (TransferSet::Screens, name, class.limit),
                    (None, None) => return Err(damaged(other)),
                };
                if bytes.len() as u64 > limit {
                    return Err(damaged(other));
                }
                contents.push((set, file.to_owned(), bytes));
            }
        }
        sums.push(sum);
    }
    let listed = listed.ok_or_else(|| damaged("checksums.txt"))?;
    if listed.lines().ne(sums.iter().map(String::as_str)) {
        return Err(damaged("checksums.txt"));
    }
    Ok((values.ok_or_else(|| damaged("values.ron"))?, contents))
}

/// Where a file of this control goes: the USB drive, or the folder of screenshots if there is no drive.
#[derive(Clone, Copy)]
pub(super) struct SaveTarget<'a> {
    pub folder: Option<&'a Path>,
    pub usb_drive: Option<&'a UsbDrive>,
}

impl SaveTarget<'_> {
    /// Saves a screenshot; returns its path.
    pub(super) fn save_screenshot(self, picture: &Screenshot, date: DateTime) -> Result<LocalizedText, Refusal> {
        let wanted = picture.width as usize * picture.height as usize * 3;
        if wanted == 0 || wanted != picture.rgb.len() || wanted > PRINT_LIMIT {
            return Err(refusal("没有图像", "there is no picture"));
        }
        let mut bytes = Vec::new();
        let (width, height, colour) = (picture.width, picture.height, image::ExtendedColorType::Rgb8);
        let encoded = if picture.as_bmp {
            image::codecs::bmp::BmpEncoder::new(&mut bytes).encode(&picture.rgb, width, height, colour)
        } else {
            let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
            image::ImageEncoder::write_image(encoder, &picture.rgb, width, height, colour)
        };
        encoded.map_err(error_refusal)?;
        self.save_dated(&bytes, date, if picture.as_bmp { "BMP" } else { "PNG" })
    }

    /// Saves a file with date and time in its name; returns its path.
    pub(super) fn save_dated(self, bytes: &[u8], date: DateTime, kind: &str) -> Result<LocalizedText, Refusal> {
        self.save(bytes, (&format!("KT830-{}", date.compact()), kind))
    }

    /// Saves a file with a given name; if it exists, a counter from 1 to 100 is appended. Returns its path.
    pub(super) fn save(self, bytes: &[u8], (stem, extension): (&str, &str)) -> Result<LocalizedText, Refusal> {
        let present = self.usb_drive.filter(|drive| drive.is_present()).map(UsbDrive::root);
        let Some(folder) = present.or(self.folder) else {
            return Err(refusal("没有保存位置：请插入 U 盘", "no place to save it: plug in a USB stick"));
        };
        let free =
            |count: u32| if count == 0 { format!("{stem}.{extension}") } else { format!("{stem}-{count}.{extension}") };
        let name = (0..100).map(free).find(|name| !folder.join(name).exists()).unwrap_or_else(|| free(100));
        std::fs::create_dir_all(folder).map_err(error_refusal)?;
        let place = folder.join(&name);
        write_atomic(&place, bytes)?;
        Ok(LocalizedText::new(format!("已保存：{}", place.display()), format!("saved: {}", place.display())))
    }
}
