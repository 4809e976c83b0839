//! Transfers programs, page files, values and a backup of everything between control and USB drive; saves screenshots.
//! Every file is written atomically and read back. Existing files are overwritten only after confirmation.
//! Source: spec K7.8, H8.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::disk::Folders;
use super::office::{because, refused};
use super::values;
use crate::controller::files::Holdings;
use crate::defs::date::Date;
use crate::defs::text::{Said, Text};
use crate::link::files::{FileAnswer, Refusal, Restored};
use crate::link::media::{Direction, MediaFile, MediaView, Print, Set, Transfer};
use crate::store::{
    CommentIs, FileClass, Folder, FolderError, IoFault, PAGE_TEXT, PICTURE, PROGRAM, Read, Shelf, Stick, Values,
    read_whole, stamp, write_whole,
};

/// Names of the value files on a USB drive.
const PARAMS: &str = "KT830-PARAM.RON";
const VARIABLES: &str = "KT830-MACRO.RON";
/// Prefix and suffix of archive names.
pub const ARCHIVE: (&str, &str) = ("KT830-", ".TAR");
/// Folders in an archive.
const PROGRAMS: &str = "programs/";
const SCREENS: &str = "screens/";
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
    comment: CommentIs::None,
};
/// Maximum side, pixels, and memory, bytes, of a picture to convert.
const PICTURE_SIDE: u32 = 10_000;
const PICTURE_MEMORY: u64 = 256 * 1024 * 1024;

/// The class and number of a page file.
fn page_file(name: &str) -> Option<(&'static FileClass, u16)> {
    static CLASSES: [FileClass; 2] = [PAGE_TEXT, PICTURE];
    CLASSES.iter().find_map(|class| class.parse(name).map(|(number, _)| (class, number)))
}

/// The set that a file on a USB drive belongs to; `None` for other files.
fn set_of(name: &str, programs: &Shelf) -> Option<Set> {
    match name {
        PARAMS => Some(Set::Params),
        VARIABLES => Some(Set::Variables),
        name if is_archive(name) => Some(Set::Backup),
        name if page_file(name).is_some() || FOREIGN_PICTURE.parse(name).is_some() => Some(Set::Screens),
        name => programs.knows(name).then_some(Set::Programs),
    }
}

/// The files on the control and on the USB drive.
#[must_use]
pub fn media(folders: &Folders, stick: Option<&Stick>) -> MediaView {
    let shelf = folders.shelf();
    let present = stick.filter(|stick| stick.is_present());
    let there = present.and_then(|stick| stick.files().ok()).unwrap_or_default().into_iter();
    let there =
        there.filter_map(|file| Some(MediaFile { set: set_of(&file.name, &shelf)?, name: file.name, size: file.size }));
    let programs = shelf.list().unwrap_or_default().into_iter();
    let mut here: Vec<MediaFile> =
        programs.map(|file| MediaFile { name: file.name, size: file.size, set: Set::Programs }).collect();
    for class in [PAGE_TEXT, PICTURE] {
        let entries = Folder::new(&folders.screens).list(&class).map(|listing| listing.entries).unwrap_or_default();
        here.extend(entries.into_iter().map(|entry| MediaFile {
            name: entry.name,
            size: entry.size,
            set: Set::Screens,
        }));
    }
    MediaView {
        stick: present.map(|stick| stick.root().display().to_string()),
        free: present.and_then(Stick::free),
        there: there.collect(),
        here,
        ..MediaView::default()
    }
}

fn is_archive(name: &str) -> bool {
    name.starts_with(ARCHIVE.0) && name.ends_with(ARCHIVE.1)
}

pub(super) fn no_stick() -> Refusal {
    Refusal::Because(Said::new("没有 U 盘或已拔出", "no USB medium, or it was pulled out"))
}

/// The refusal for a disk error, in both languages.
fn of_disk(fault: &IoFault) -> Refusal {
    Refusal::Because(Said::new(fault.zh(), fault.to_string()))
}

fn say(zh: impl Into<String>, en: impl Into<String>) -> Refusal {
    Refusal::Because(Said::new(zh, en))
}

/// One transfer.
pub struct Carrier<'a> {
    /// The control's folders.
    pub folders: &'a Folders,
    /// The USB drive.
    pub stick: &'a Stick,
    /// The values of the core.
    pub holdings: Option<&'a Holdings>,
    /// Cancels the transfer between two files.
    pub cancelled: &'a AtomicBool,
    /// Date and time for file names.
    pub date: Date,
}

impl Carrier<'_> {
    /// Executes a transfer and returns the result.
    ///
    /// # Errors
    /// Why it failed or was not completed.
    pub fn carry(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        if !self.stick.is_present() {
            return Err(no_stick());
        }
        let done = match (ask.set, ask.direction) {
            (Set::Programs | Set::Screens, _) => self.files(ask, tell),
            (Set::Params | Set::Variables, Direction::Out) => self.values_out(ask),
            (Set::Params | Set::Variables, Direction::In) => self.values_in(ask.set),
            (Set::Backup, Direction::Out) => self.backup(tell),
            (Set::Backup, Direction::In) => self.restore(ask, tell),
            // Serial transfers do not use a USB drive.
            (Set::Serial, _) => Err(no_stick()),
        };
        // If the USB drive was removed, that is the cause, whatever the system reports.
        done.map_err(|refusal| if self.stick.is_present() { refusal } else { no_stick() })
    }

    /// The files to copy, sorted by name.
    fn waiting(&self, ask: &Transfer) -> Result<Vec<Waiting>, Refusal> {
        let wanted = |name: &str| ask.names.is_empty() || ask.names.iter().any(|wanted| wanted == name);
        let mut waiting = Vec::new();
        if ask.set == Set::Programs {
            let (here, there) = (self.folders.shelf(), Shelf::new(self.stick.root(), self.folders.named));
            let (from, to) = if ask.direction == Direction::Out { (here, there) } else { (there, here) };
            for file in from.list().map_err(|error| refused(&error))?.into_iter().filter(|file| wanted(&file.name)) {
                waiting.push(Waiting { way: Way::Program(from.clone(), to.clone()), name: file.name, size: file.size });
            }
            return Ok(waiting);
        }
        let (own, stick) = (Folder::new(&self.folders.screens), Folder::new(self.stick.root()));
        for class in [PAGE_TEXT, PICTURE] {
            let (from, to) = match ask.direction {
                Direction::Out => (own.clone(), stick.clone()),
                Direction::In => (stick.clone(), own.clone()),
            };
            // Incoming pictures can have other formats.
            let foreign = ask.direction == Direction::In && class.letter == PICTURE.letter;
            let read_as = if foreign { FOREIGN_PICTURE } else { class };
            let entries = from.list(&read_as).map_err(|error| refused(&error))?.entries;
            for entry in entries.into_iter().filter(|entry| wanted(&entry.name)) {
                let way =
                    Way::Page { class, read_as, number: entry.number, from: from.clone(), to: to.clone(), foreign };
                waiting.push(Waiting { way, name: entry.name, size: entry.size });
            }
        }
        Ok(waiting)
    }

    /// Copies programs or page files one by one.
    fn files(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let waiting = self.waiting(ask)?;
        if waiting.is_empty() {
            return Err(say("没有可复制的文件", "there is nothing to copy"));
        }
        let (mut clashing, mut foreign) = (Vec::new(), Vec::new());
        for file in &waiting {
            let (new, fault) = file.fetch()?;
            foreign.extend(fault);
            if let Ok(old) = file.old()
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
                return Err(say(format!("已取消，已复制 {copied} 个文件"), format!("cancelled after {copied} files")));
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
        Ok(FileAnswer::Done(Said::new(
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

    fn values_out(&self, ask: &Transfer) -> Result<FileAnswer, Refusal> {
        let holdings = self.holdings.ok_or_else(no_stick)?;
        let all = values::of(holdings);
        let (name, part) = if ask.set == Set::Params {
            (PARAMS, Values { kind: all.kind, params: all.params, ..Values::default() })
        } else {
            (VARIABLES, Values { variables: all.variables, ..Values::default() })
        };
        let path = self.stick.root().join(name);
        if ask.overwrite.is_none() && path.exists() && Values::read(&path).ok().as_ref() != Some(&part) {
            return Err(Refusal::Overwrite(vec![name.to_owned()]));
        }
        if ask.overwrite == Some(false) && path.exists() {
            return Ok(FileAnswer::Done(Said::new("未改动", "nothing was changed")));
        }
        part.write(&path).map_err(|error| because(&error))?;
        let back = Values::read(&path).map_err(|error| because(&error))?;
        if back != part {
            return Err(say(
                format!("{name} 校验不符，请换 U 盘"),
                format!("{name} does not read back: take another medium"),
            ));
        }
        Ok(FileAnswer::Done(Said::new(format!("已写出 {name}"), format!("{name} written"))))
    }

    fn values_in(&self, set: Set) -> Result<FileAnswer, Refusal> {
        let name = if set == Set::Params { PARAMS } else { VARIABLES };
        let path = self.stick.root().join(name);
        if std::fs::symlink_metadata(&path).is_ok_and(|told| told.len() > VALUES_LIMIT) {
            return Err(say(format!("{name} 太大"), format!("{name} is too large")));
        }
        let found = Values::read(&path).map_err(|error| because(&error))?;
        let part = match set {
            Set::Params => Values { kind: found.kind, params: found.params, ..Values::default() },
            _ => Values { variables: found.variables, ..Values::default() },
        };
        let restored = self.restored(&part)?;
        Ok(FileAnswer::Restored(Box::new(restored)))
    }

    fn restored(&self, part: &Values) -> Result<Restored, Refusal> {
        let holdings = self.holdings.ok_or_else(no_stick)?;
        values::check(part, holdings.kind)
    }

    /// Writes everything into one archive, followed by a list of checksums.
    fn backup(&self, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let holdings = self.holdings.ok_or_else(no_stick)?;
        let name = format!("{}{}{}", ARCHIVE.0, self.date.compact(), ARCHIVE.1);
        let mut archive = tar::Builder::new(Vec::new());
        let mut sums = String::new();
        let text = values::of(holdings).to_text().map_err(|error| because(&error))?;
        put((&mut archive, &mut sums), "values.ron", text.as_bytes())?;
        let view = media(self.folders, None);
        let all = view.here.iter().map(|file| file.size).sum::<u64>().max(1);
        let mut done = 0;
        for file in &view.here {
            if self.cancelled.load(Ordering::Acquire) {
                return Err(say("已取消", "cancelled"));
            }
            tell(FileAnswer::Progress(COPYING, (done * 900 / all) as u16));
            let (place, read) = match page_file(&file.name).filter(|_| file.set == Set::Screens) {
                Some((class, number)) => (SCREENS, Folder::new(&self.folders.screens).read(class, number)),
                None => (PROGRAMS, self.folders.shelf().read(&file.name)),
            };
            let read = read.map_err(|error| refused(&error))?;
            put((&mut archive, &mut sums), &format!("{place}{}", read.name), &read.bytes)?;
            done += file.size;
        }
        let list = sums.clone();
        put((&mut archive, &mut sums), "checksums.txt", list.as_bytes())?;
        let bytes = archive.into_inner().map_err(|error| because(&error))?;
        let path = self.stick.root().join(&name);
        write_whole(&path, &bytes).map_err(|fault| of_disk(&fault))?;
        let back = read_whole(&path, ARCHIVE_LIMIT).map_err(|error| refused(&error))?;
        if stamp(&back) != stamp(&bytes) {
            return Err(say(
                format!("{name} 校验不符，请换 U 盘"),
                format!("{name} does not read back: take another medium"),
            ));
        }
        Ok(FileAnswer::Done(Said::new(format!("已备份到 {name}"), format!("backup written: {name}"))))
    }

    /// Restores everything from an archive. The whole archive is checked before the first file is written.
    fn restore(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let files = self.stick.files().map_err(|fault| refused(&fault.into()))?;
        let chosen = files
            .iter()
            .rev()
            .map(|file| &file.name)
            .find(|name| is_archive(name) && (ask.names.is_empty() || ask.names.contains(name)));
        let name = chosen.ok_or_else(|| say("U 盘上没有备份文件", "there is no backup on the medium"))?;
        if ask.overwrite.is_none() {
            return Err(Refusal::Overwrite(vec![name.clone()]));
        }
        let bytes = read_whole(&self.stick.root().join(name), ARCHIVE_LIMIT).map_err(|error| refused(&error))?;
        let shelf = self.folders.shelf();
        let (values, contents) = unpack(name, &bytes, &shelf)?;
        let restored = self.restored(&values)?;
        let all = contents.len().max(1);
        for (index, (set, name, bytes)) in contents.iter().enumerate() {
            tell(FileAnswer::Progress(COPYING, (index * 1_000 / all) as u16));
            let written = match page_file(name).filter(|_| *set == Set::Screens) {
                Some((class, number)) => Folder::new(&self.folders.screens).write(class, number, bytes),
                None => shelf.write(name, bytes),
            };
            written.map_err(|error| refused(&error))?;
        }
        Ok(FileAnswer::Restored(Box::new(restored)))
    }
}

/// A file to copy.
struct Waiting {
    name: String,
    size: u64,
    way: Way,
}

/// Source and target of a file.
enum Way {
    /// A program by name.
    Program(Shelf, Shelf),
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

impl Waiting {
    /// The bytes to write. For a converted picture also the reason for the conversion.
    fn fetch(&self) -> Result<(Vec<u8>, Option<Said>), Refusal> {
        let (read, foreign) = match &self.way {
            Way::Program(from, _) => (from.read(&self.name), false),
            Way::Page { read_as, number, from, foreign, .. } => (from.read(read_as, *number), *foreign),
        };
        let read = read.map_err(|error| refused(&error))?;
        if !foreign {
            return Ok((read.bytes, None));
        }
        match super::disk::parse_picture(&read.name, &read.bytes) {
            Ok(_) => Ok((read.bytes, None)),
            Err(fault) => match convert(&read.bytes) {
                Ok(bytes) => Ok((bytes, Some(fault.said()))),
                Err(_) => Err(Refusal::Because(fault.said())),
            },
        }
    }

    /// The file to be overwritten.
    fn old(&self) -> Result<Read, FolderError> {
        match &self.way {
            Way::Program(_, to) => to.read(&self.name),
            Way::Page { class, number, to, .. } => to.read(class, *number),
        }
    }

    /// Writes the file, reads it back and compares.
    fn copy(&self) -> Result<(), Refusal> {
        let (bytes, _) = self.fetch()?;
        let name = match &self.way {
            Way::Program(_, to) => to.write(&self.name, &bytes),
            Way::Page { class, number, to, .. } => to.write(class, *number, &bytes),
        };
        let name = name.map_err(|error| refused(&error))?;
        if stamp(&self.old().map_err(|error| refused(&error))?.bytes) == stamp(&bytes) {
            return Ok(());
        }
        Err(say(format!("{name} 校验不符，请换 U 盘"), format!("{name} does not read back: take another medium")))
    }
}

/// Converts a PNG, JPEG or BMP to a page picture: scaled to fit 200 × 400 pixels, white background, 24 bit (K5.12).
///
/// # Errors
/// It is not such a picture, or it is too large.
pub fn convert(bytes: &[u8]) -> Result<Vec<u8>, image::ImageError> {
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format()?;
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(PICTURE_SIDE), Some(PICTURE_SIDE));
    limits.max_alloc = Some(PICTURE_MEMORY);
    reader.limits(limits);
    let (width, height) = super::disk::PICTURE_SIZE;
    let fitted = reader.decode()?.resize(width, height, image::imageops::FilterType::Triangle).to_rgba8();
    let mut page = image::RgbaImage::from_pixel(width, height, image::Rgba([255; 4]));
    let corner = (i64::from(width - fitted.width()) / 2, i64::from(height - fitted.height()) / 2);
    image::imageops::overlay(&mut page, &fitted, corner.0, corner.1);
    let mut bmp = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageRgba8(page).to_rgb8().write_to(&mut bmp, image::ImageFormat::Bmp)?;
    Ok(bmp.into_inner())
}

/// Adds a file to an archive and to its list of checksums.
fn put(into: (&mut tar::Builder<Vec<u8>>, &mut String), name: &str, bytes: &[u8]) -> Result<(), Refusal> {
    let (archive, sums) = into;
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o644);
    header.set_cksum();
    sums.push_str(&format!("{:016x} {name}\n", stamp(bytes)));
    archive.append_data(&mut header, name, bytes).map_err(|error| because(&error))
}

type Contents = Vec<(Set, String, Vec<u8>)>;

/// Unpacks an archive. One invalid name, file type or checksum refuses the whole archive.
fn unpack(name: &str, bytes: &[u8], shelf: &Shelf) -> Result<(Values, Contents), Refusal> {
    use std::io::Read as _;
    let damaged = |what: &str| {
        say(
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
                values = Some(Values::of_text(&text).map_err(|error| damaged(&error.to_string()))?);
            }
            other => {
                let program = other.strip_prefix(PROGRAMS).filter(|name| shelf.knows(name));
                let page = other.strip_prefix(SCREENS).and_then(|name| page_file(name).map(|(class, _)| (name, class)));
                let (set, file, limit) = match (program, page) {
                    (Some(name), _) => (Set::Programs, name, PROGRAM.limit),
                    (None, Some((name, class))) => (Set::Screens, name, class.limit),
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
pub fn print(picture: &Print, date: Date, folder: Option<&Path>, stick: Option<&Stick>) -> Result<Said, Refusal> {
    let wanted = picture.width as usize * picture.height as usize * 3;
    if wanted == 0 || wanted != picture.rgb.len() || wanted > PRINT_LIMIT {
        return Err(say("没有图像", "there is no picture"));
    }
    let mut bytes = Vec::new();
    let (width, height, colour) = (picture.width, picture.height, image::ExtendedColorType::Rgb8);
    let done = if picture.bmp {
        image::codecs::bmp::BmpEncoder::new(&mut bytes).encode(&picture.rgb, width, height, colour)
    } else {
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, &picture.rgb, width, height, colour)
    };
    done.map_err(|error| because(&error))?;
    keep(&bytes, (date, if picture.bmp { "BMP" } else { "PNG" }), folder, stick)
}

/// Saves a file on the USB drive, or in the folder if there is no drive; returns its path.
///
/// # Errors
/// No target folder, or a disk error.
pub fn keep(
    bytes: &[u8],
    (date, extension): (Date, &str),
    folder: Option<&Path>,
    stick: Option<&Stick>,
) -> Result<Said, Refusal> {
    keep_as(bytes, (&format!("KT830-{}", date.compact()), extension), folder, stick)
}

/// The same with a given name; if it exists, a counter from 1 to 100 is appended.
///
/// # Errors
/// No target folder, or a disk error.
pub(super) fn keep_as(
    bytes: &[u8],
    (stem, extension): (&str, &str),
    folder: Option<&Path>,
    stick: Option<&Stick>,
) -> Result<Said, Refusal> {
    let present = stick.filter(|stick| stick.is_present()).map(Stick::root);
    let Some(folder) = present.or(folder) else {
        return Err(say("没有保存位置：请插入 U 盘", "nowhere to keep it: plug a USB medium in"));
    };
    let free =
        |count: u32| if count == 0 { format!("{stem}.{extension}") } else { format!("{stem}-{count}.{extension}") };
    let name = (0..100).map(free).find(|name| !folder.join(name).exists()).unwrap_or_else(|| free(100));
    std::fs::create_dir_all(folder).map_err(|error| because(&error))?;
    write_whole(&folder.join(&name), bytes).map_err(|fault| of_disk(&fault))?;
    let place = folder.join(&name);
    Ok(Said::new(format!("已保存：{}", place.display()), format!("saved: {}", place.display())))
}
