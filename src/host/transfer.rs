//! Transfers programs, page files, values and a backup of everything between control and USB drive; saves screenshots.
//! Every file is written atomically and read back. Existing files are overwritten only after confirmation.
//! Source: spec K7.8, H8.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::folders::Folders;
use super::job_runner::{folder_refusal, refusal_of};
use super::value_set;
use crate::controller::files::TransferValues;
use crate::defs::date::DateTime;
use crate::defs::text::{LocalizedText, Text};
use crate::link::files::{FileAnswer, Refusal, RestoredValues};
use crate::link::media::{Direction, MediaFile, MediaView, Screenshot, TransferRequest, TransferSet};
use crate::store::{
    CommentSource, FileClass, FileContent, Folder, FolderError, IoFault, PAGE_TEXT, PICTURE, PROGRAM, ProgramFolder,
    UsbDrive, Values, read_file, stamp, write_atomic,
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
const ARCHIVE_LIMIT: u64 = 2 * 1024 * 1024 * 1024;
/// Maximum size of a value file, bytes.
const VALUES_LIMIT: u64 = 4 * 1024 * 1024;
/// Maximum size of a screenshot, bytes of RGB data.
const PRINT_LIMIT: usize = 64 * 1024 * 1024;

/// Pictures on a USB drive; other formats than BMP can be converted (K5.12).
pub(super) const FOREIGN_PICTURE: FileClass = FileClass {
    letter: 'B',
    extensions: &["BMP", "PNG", "JPG", "JPEG"],
    limit: 32 * 1024 * 1024,
    comment_source: CommentSource::None,
};
/// Maximum side, pixels, and memory, bytes, of a picture to convert.
const PICTURE_SIDE_LIMIT: u32 = 10_000;
const PICTURE_MEMORY_LIMIT: u64 = 256 * 1024 * 1024;

/// The class and number of a page file.
fn parse_page_file(name: &str) -> Option<(&'static FileClass, u16)> {
    static CLASSES: [FileClass; 2] = [PAGE_TEXT, PICTURE];
    CLASSES.iter().find_map(|class| class.parse(name).map(|(number, _)| (class, number)))
}

/// The set that a file on a USB drive belongs to; `None` for other files.
fn set_of(name: &str, programs: &ProgramFolder) -> Option<TransferSet> {
    match name {
        PARAM_FILE => Some(TransferSet::Params),
        VARIABLE_FILE => Some(TransferSet::Variables),
        name if is_archive(name) => Some(TransferSet::Backup),
        name if parse_page_file(name).is_some() || FOREIGN_PICTURE.parse(name).is_some() => Some(TransferSet::Screens),
        name => programs.is_program_name(name).then_some(TransferSet::Programs),
    }
}

/// The files on the control and on the USB drive.
#[must_use]
pub fn media_view(folders: &Folders, stick: Option<&UsbDrive>) -> MediaView {
    let shelf = folders.program_folder();
    let present = stick.filter(|stick| stick.is_present());
    let there = present.and_then(|stick| stick.files().ok()).unwrap_or_default().into_iter();
    let there =
        there.filter_map(|file| Some(MediaFile { set: set_of(&file.name, &shelf)?, name: file.name, size: file.size }));
    let programs = shelf.list().unwrap_or_default().into_iter();
    let mut here: Vec<MediaFile> =
        programs.map(|file| MediaFile { name: file.name, size: file.size, set: TransferSet::Programs }).collect();
    for class in [PAGE_TEXT, PICTURE] {
        let entries = Folder::new(&folders.screens).list(&class).map(|listing| listing.entries).unwrap_or_default();
        here.extend(entries.into_iter().map(|entry| MediaFile {
            name: entry.name,
            size: entry.size,
            set: TransferSet::Screens,
        }));
    }
    MediaView {
        medium_folder: present.map(|stick| stick.root().display().to_string()),
        free_bytes: present.and_then(UsbDrive::free_bytes),
        medium_files: there.collect(),
        control_files: here,
        ..MediaView::default()
    }
}

fn is_archive(name: &str) -> bool {
    name.starts_with(ARCHIVE_NAME.0) && name.ends_with(ARCHIVE_NAME.1)
}

pub(super) fn no_usb_drive() -> Refusal {
    Refusal::Other(LocalizedText::new("没有 U 盘或已拔出", "no USB medium, or it was pulled out"))
}

/// The refusal for a disk error, in both languages.
fn io_refusal(fault: &IoFault) -> Refusal {
    Refusal::Other(LocalizedText::new(fault.zh(), fault.to_string()))
}

fn refusal(zh: impl Into<String>, en: impl Into<String>) -> Refusal {
    Refusal::Other(LocalizedText::new(zh, en))
}

/// One transfer.
pub struct UsbTransfer<'a> {
    /// The control's folders.
    pub folders: &'a Folders,
    /// The USB drive.
    pub usb_drive: &'a UsbDrive,
    /// The values of the core.
    pub holdings: Option<&'a TransferValues>,
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
    pub fn run(&self, ask: &TransferRequest, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        if !self.usb_drive.is_present() {
            return Err(no_usb_drive());
        }
        let done = match (ask.set, ask.direction) {
            (TransferSet::Programs | TransferSet::Screens, _) => self.copy_files(ask, tell),
            (TransferSet::Params | TransferSet::Variables, Direction::Export) => self.write_values(ask),
            (TransferSet::Params | TransferSet::Variables, Direction::Import) => self.read_values(ask.set),
            (TransferSet::Backup, Direction::Export) => self.backup(tell),
            (TransferSet::Backup, Direction::Import) => self.restore(ask, tell),
            // Serial transfers do not use a USB drive.
            (TransferSet::Serial, _) => Err(no_usb_drive()),
        };
        // If the USB drive was removed, that is the cause, whatever the system reports.
        done.map_err(|refusal| if self.usb_drive.is_present() { refusal } else { no_usb_drive() })
    }

    /// The files to copy, sorted by name.
    fn pending_files(&self, ask: &TransferRequest) -> Result<Vec<PendingFile>, Refusal> {
        let wanted = |name: &str| ask.names.is_empty() || ask.names.iter().any(|wanted| wanted == name);
        let mut waiting = Vec::new();
        if ask.set == TransferSet::Programs {
            let (here, there) =
                (self.folders.program_folder(), ProgramFolder::new(self.usb_drive.root(), self.folders.by_name));
            let (from, to) = if ask.direction == Direction::Export { (here, there) } else { (there, here) };
            for file in
                from.list().map_err(|error| folder_refusal(&error))?.into_iter().filter(|file| wanted(&file.name))
            {
                waiting.push(PendingFile {
                    route: FileRoute::Program(from.clone(), to.clone()),
                    name: file.name,
                    size: file.size,
                });
            }
            return Ok(waiting);
        }
        let (own, stick) = (Folder::new(&self.folders.screens), Folder::new(self.usb_drive.root()));
        for class in [PAGE_TEXT, PICTURE] {
            let (from, to) = match ask.direction {
                Direction::Export => (own.clone(), stick.clone()),
                Direction::Import => (stick.clone(), own.clone()),
            };
            // Incoming pictures can have other formats.
            let foreign = ask.direction == Direction::Import && class.letter == PICTURE.letter;
            let read_as = if foreign { FOREIGN_PICTURE } else { class };
            let entries = from.list(&read_as).map_err(|error| folder_refusal(&error))?.entries;
            for entry in entries.into_iter().filter(|entry| wanted(&entry.name)) {
                let way = FileRoute::Page {
                    class,
                    read_as,
                    number: entry.number,
                    from: from.clone(),
                    to: to.clone(),
                    foreign,
                };
                waiting.push(PendingFile { route: way, name: entry.name, size: entry.size });
            }
        }
        Ok(waiting)
    }

    /// Copies programs or page files one by one.
    fn copy_files(&self, ask: &TransferRequest, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let waiting = self.pending_files(ask)?;
        if waiting.is_empty() {
            return Err(refusal("没有可复制的文件", "there is nothing to copy"));
        }
        let (mut clashing, mut foreign) = (Vec::new(), Vec::new());
        for file in &waiting {
            let (new, fault) = file.read_source()?;
            foreign.extend(fault);
            if let Ok(old) = file.read_target()
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
        let (mut done, mut copied, mut skipped) = (0, 0, 0);
        for file in &waiting {
            if self.cancelled.load(Ordering::Acquire) {
                return Err(refusal(
                    format!("已取消，已复制 {copied} 个文件"),
                    format!("cancelled after {copied} files"),
                ));
            }
            tell(FileAnswer::Progress(COPYING, (done * 1_000 / all) as u16));
            done += file.size;
            if ask.overwrite == Some(false) && clashing.contains(&file.name) {
                skipped += 1;
                continue;
            }
            file.copy()?;
            copied += 1;
        }
        Ok(FileAnswer::Done(LocalizedText::new(
            format!(
                "已复制 {copied} 个文件{}",
                if skipped > 0 { format!("，跳过 {skipped} 个") } else { String::new() }
            ),
            format!(
                "{copied} files copied{}",
                if skipped > 0 { format!(", {skipped} skipped") } else { String::new() }
            ),
        )))
    }

    fn write_values(&self, ask: &TransferRequest) -> Result<FileAnswer, Refusal> {
        let holdings = self.holdings.ok_or_else(no_usb_drive)?;
        let all = value_set::from_holdings(holdings);
        let (name, part) = if ask.set == TransferSet::Params {
            (PARAM_FILE, Values { kind: all.kind, params: all.params, ..Values::default() })
        } else {
            (VARIABLE_FILE, Values { variables: all.variables, ..Values::default() })
        };
        let path = self.usb_drive.root().join(name);
        if ask.overwrite.is_none() && path.exists() && Values::read(&path).ok().as_ref() != Some(&part) {
            return Err(Refusal::Overwrite(vec![name.to_owned()]));
        }
        if ask.overwrite == Some(false) && path.exists() {
            return Ok(FileAnswer::Done(LocalizedText::new("未改动", "nothing was changed")));
        }
        part.write(&path).map_err(|error| refusal_of(&error))?;
        let back = Values::read(&path).map_err(|error| refusal_of(&error))?;
        if back != part {
            return Err(refusal(
                format!("{name} 校验不符，请换 U 盘"),
                format!("{name} does not read back: take another medium"),
            ));
        }
        Ok(FileAnswer::Done(LocalizedText::new(format!("已写出 {name}"), format!("{name} written"))))
    }

    fn read_values(&self, set: TransferSet) -> Result<FileAnswer, Refusal> {
        let name = if set == TransferSet::Params { PARAM_FILE } else { VARIABLE_FILE };
        let path = self.usb_drive.root().join(name);
        if std::fs::symlink_metadata(&path).is_ok_and(|told| told.len() > VALUES_LIMIT) {
            return Err(refusal(format!("{name} 太大"), format!("{name} is too large")));
        }
        let found = Values::read(&path).map_err(|error| refusal_of(&error))?;
        let part = match set {
            TransferSet::Params => Values { kind: found.kind, params: found.params, ..Values::default() },
            _ => Values { variables: found.variables, ..Values::default() },
        };
        let restored = self.check_values(&part)?;
        Ok(FileAnswer::Restored(Box::new(restored)))
    }

    fn check_values(&self, part: &Values) -> Result<RestoredValues, Refusal> {
        let holdings = self.holdings.ok_or_else(no_usb_drive)?;
        value_set::check_values(part, holdings.kind)
    }

    /// Writes everything into one archive, followed by a list of checksums.
    fn backup(&self, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let holdings = self.holdings.ok_or_else(no_usb_drive)?;
        let name = format!("{}{}{}", ARCHIVE_NAME.0, self.date.compact(), ARCHIVE_NAME.1);
        let mut archive = tar::Builder::new(Vec::new());
        let mut sums = String::new();
        let text = value_set::from_holdings(holdings).to_text().map_err(|error| refusal_of(&error))?;
        append_file((&mut archive, &mut sums), "values.ron", text.as_bytes())?;
        let view = media_view(self.folders, None);
        let all = view.control_files.iter().map(|file| file.size).sum::<u64>().max(1);
        let mut done = 0;
        for file in &view.control_files {
            if self.cancelled.load(Ordering::Acquire) {
                return Err(refusal("已取消", "cancelled"));
            }
            tell(FileAnswer::Progress(COPYING, (done * 900 / all) as u16));
            let (place, read) = match parse_page_file(&file.name).filter(|_| file.set == TransferSet::Screens) {
                Some((class, number)) => (SCREEN_PREFIX, Folder::new(&self.folders.screens).read(class, number)),
                None => (PROGRAM_PREFIX, self.folders.program_folder().read(&file.name)),
            };
            let read = read.map_err(|error| folder_refusal(&error))?;
            append_file((&mut archive, &mut sums), &format!("{place}{}", read.name), &read.bytes)?;
            done += file.size;
        }
        let list = sums.clone();
        append_file((&mut archive, &mut sums), "checksums.txt", list.as_bytes())?;
        let bytes = archive.into_inner().map_err(|error| refusal_of(&error))?;
        let path = self.usb_drive.root().join(&name);
        write_atomic(&path, &bytes).map_err(|fault| io_refusal(&fault))?;
        let back = read_file(&path, ARCHIVE_LIMIT).map_err(|error| folder_refusal(&error))?;
        if stamp(&back) != stamp(&bytes) {
            return Err(refusal(
                format!("{name} 校验不符，请换 U 盘"),
                format!("{name} does not read back: take another medium"),
            ));
        }
        Ok(FileAnswer::Done(LocalizedText::new(format!("已备份到 {name}"), format!("backup written: {name}"))))
    }

    /// Restores everything from an archive. The whole archive is checked before the first file is written.
    fn restore(&self, ask: &TransferRequest, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let files = self.usb_drive.files().map_err(|fault| folder_refusal(&fault.into()))?;
        let chosen = files
            .iter()
            .rev()
            .map(|file| &file.name)
            .find(|name| is_archive(name) && (ask.names.is_empty() || ask.names.contains(name)));
        let name = chosen.ok_or_else(|| refusal("U 盘上没有备份文件", "there is no backup on the medium"))?;
        if ask.overwrite.is_none() {
            return Err(Refusal::Overwrite(vec![name.clone()]));
        }
        let bytes =
            read_file(&self.usb_drive.root().join(name), ARCHIVE_LIMIT).map_err(|error| folder_refusal(&error))?;
        let shelf = self.folders.program_folder();
        let (values, contents) = unpack_archive(name, &bytes, &shelf)?;
        let restored = self.check_values(&values)?;
        let all = contents.len().max(1);
        for (index, (set, name, bytes)) in contents.iter().enumerate() {
            tell(FileAnswer::Progress(COPYING, (index * 1_000 / all) as u16));
            let written = match parse_page_file(name).filter(|_| *set == TransferSet::Screens) {
                Some((class, number)) => Folder::new(&self.folders.screens).write(class, number, bytes),
                None => shelf.write(name, bytes),
            };
            written.map_err(|error| folder_refusal(&error))?;
        }
        Ok(FileAnswer::Restored(Box::new(restored)))
    }
}

/// A file to copy.
struct PendingFile {
    name: String,
    size: u64,
    route: FileRoute,
}

/// Source and target of a file.
enum FileRoute {
    /// A program by name.
    Program(ProgramFolder, ProgramFolder),
    /// A page file by number.
    Page {
        class: FileClass,
        read_as: FileClass,
        number: u16,
        from: Folder,
        to: Folder,
        /// Incoming: a file with another format than a page picture is converted.
        foreign: bool,
    },
}

impl PendingFile {
    /// The bytes to write. For a converted picture also the reason for the conversion.
    fn read_source(&self) -> Result<(Vec<u8>, Option<LocalizedText>), Refusal> {
        let (read, foreign) = match &self.route {
            FileRoute::Program(from, _) => (from.read(&self.name), false),
            FileRoute::Page { read_as, number, from, foreign, .. } => (from.read(read_as, *number), *foreign),
        };
        let read = read.map_err(|error| folder_refusal(&error))?;
        if !foreign {
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

    /// The file to be overwritten.
    fn read_target(&self) -> Result<FileContent, FolderError> {
        match &self.route {
            FileRoute::Program(_, to) => to.read(&self.name),
            FileRoute::Page { class, number, to, .. } => to.read(class, *number),
        }
    }

    /// Writes the file, reads it back and compares.
    fn copy(&self) -> Result<(), Refusal> {
        let (bytes, _) = self.read_source()?;
        let name = match &self.route {
            FileRoute::Program(_, to) => to.write(&self.name, &bytes),
            FileRoute::Page { class, number, to, .. } => to.write(class, *number, &bytes),
        };
        let name = name.map_err(|error| folder_refusal(&error))?;
        if stamp(&self.read_target().map_err(|error| folder_refusal(&error))?.bytes) == stamp(&bytes) {
            return Ok(());
        }
        Err(refusal(format!("{name} 校验不符，请换 U 盘"), format!("{name} does not read back: take another medium")))
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
    let (width, height) = super::folders::PICTURE_SIZE;
    let fitted = reader.decode()?.resize(width, height, image::imageops::FilterType::Triangle).to_rgba8();
    let mut page = image::RgbaImage::from_pixel(width, height, image::Rgba([255; 4]));
    let corner = (i64::from(width - fitted.width()) / 2, i64::from(height - fitted.height()) / 2);
    image::imageops::overlay(&mut page, &fitted, corner.0, corner.1);
    let mut bmp = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageRgba8(page).to_rgb8().write_to(&mut bmp, image::ImageFormat::Bmp)?;
    Ok(bmp.into_inner())
}

/// Adds a file to an archive and to its list of checksums.
fn append_file(into: (&mut tar::Builder<Vec<u8>>, &mut String), name: &str, bytes: &[u8]) -> Result<(), Refusal> {
    let (archive, sums) = into;
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o644);
    header.set_cksum();
    sums.push_str(&format!("{:016x} {name}\n", stamp(bytes)));
    archive.append_data(&mut header, name, bytes).map_err(|error| refusal_of(&error))
}

type ArchiveContents = Vec<(TransferSet, String, Vec<u8>)>;

/// Unpacks an archive. One invalid name, file type or checksum refuses the whole archive.
fn unpack_archive(name: &str, bytes: &[u8], shelf: &ProgramFolder) -> Result<(Values, ArchiveContents), Refusal> {
    use std::io::Read as _;
    let damaged = |what: &str| {
        refusal(
            format!("备份 {name} 已损坏或不是本系统的文件：{what}"),
            format!("{name} is damaged or no backup of this control: {what}"),
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

/// Saves a screenshot on the USB drive, or in the screenshot folder if there is no drive; returns its path.
///
/// # Errors
/// The picture has no valid size, or a disk error.
pub fn save_screenshot(
    picture: &Screenshot,
    date: DateTime,
    folder: Option<&Path>,
    stick: Option<&UsbDrive>,
) -> Result<LocalizedText, Refusal> {
    let wanted = picture.width as usize * picture.height as usize * 3;
    if wanted == 0 || wanted != picture.rgb.len() || wanted > PRINT_LIMIT {
        return Err(refusal("没有图像", "there is no picture"));
    }
    let mut bytes = Vec::new();
    let (width, height, colour) = (picture.width, picture.height, image::ExtendedColorType::Rgb8);
    let done = if picture.as_bmp {
        image::codecs::bmp::BmpEncoder::new(&mut bytes).encode(&picture.rgb, width, height, colour)
    } else {
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, &picture.rgb, width, height, colour)
    };
    done.map_err(|error| refusal_of(&error))?;
    save_file(&bytes, (date, if picture.as_bmp { "BMP" } else { "PNG" }), folder, stick)
}

/// Saves a file on the USB drive, or in the folder if there is no drive; returns its path.
///
/// # Errors
/// No target folder, or a disk error.
pub fn save_file(
    bytes: &[u8],
    (date, extension): (DateTime, &str),
    folder: Option<&Path>,
    stick: Option<&UsbDrive>,
) -> Result<LocalizedText, Refusal> {
    save_file_as(bytes, (&format!("KT830-{}", date.compact()), extension), folder, stick)
}

/// The same with a given name; if it exists, a counter from 1 to 100 is appended.
///
/// # Errors
/// No target folder, or a disk error.
pub(super) fn save_file_as(
    bytes: &[u8],
    (stem, extension): (&str, &str),
    folder: Option<&Path>,
    stick: Option<&UsbDrive>,
) -> Result<LocalizedText, Refusal> {
    let present = stick.filter(|stick| stick.is_present()).map(UsbDrive::root);
    let Some(folder) = present.or(folder) else {
        return Err(refusal("没有保存位置：请插入 U 盘", "nowhere to keep it: plug a USB medium in"));
    };
    let free =
        |count: u32| if count == 0 { format!("{stem}.{extension}") } else { format!("{stem}-{count}.{extension}") };
    let name = (0..100).map(free).find(|name| !folder.join(name).exists()).unwrap_or_else(|| free(100));
    std::fs::create_dir_all(folder).map_err(|error| refusal_of(&error))?;
    write_atomic(&folder.join(&name), bytes).map_err(|fault| io_refusal(&fault))?;
    let place = folder.join(&name);
    Ok(LocalizedText::new(format!("已保存：{}", place.display()), format!("saved: {}", place.display())))
}
