//! Between the control and a medium: programs, page files, values, an archive of everything; pictures of the screen.
//! Every file is written whole and read back; what is there already is overwritten only when that was answered.
//! Source: spec K7.8, H8.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use chrono::Local;

use super::disk::Folders;
use super::office::{because, refused};
use super::values;
use crate::controller::files::Holdings;
use crate::defs::text::{Said, Text};
use crate::link::files::{FileAnswer, Refusal, Restored};
use crate::link::media::{Direction, MediaFile, MediaView, Print, Set, Transfer};
use crate::store::{
    CommentIs, FileClass, Folder, PAGE_TEXT, PICTURE, PROGRAM, Stick, Values, read_whole, stamp, write_whole,
};

/// Names of the files of values on a medium.
const PARAMS: &str = "KT830-PARAM.RON";
const VARIABLES: &str = "KT830-MACRO.RON";
/// How archives begin and end.
pub const ARCHIVE: (&str, &str) = ("KT830-", ".TAR");
/// What is being done.
const COPYING: Text = Text::new("正在复制", "copying");
/// The largest archive.
const ARCHIVE_LIMIT: u64 = 2 * 1024 * 1024 * 1024;
/// The largest file of values.
const VALUES_LIMIT: u64 = 4 * 1024 * 1024;
/// Most pixels of a picture of the screen.
const PRINT_LIMIT: usize = 64 * 1024 * 1024;

/// Pictures on a medium: what is no BMP can be converted (K5.12). Larger than a page picture, but bounded.
const FOREIGN_PICTURE: FileClass = FileClass {
    letter: 'B',
    extensions: &["BMP", "PNG", "JPG", "JPEG"],
    limit: 32 * 1024 * 1024,
    comment: CommentIs::None,
};
/// Largest side of a picture that is converted, and most bytes that it may take in memory.
const PICTURE_SIDE: u32 = 10_000;
const PICTURE_MEMORY: u64 = 256 * 1024 * 1024;

/// The classes of a set.
const fn classes(set: Set) -> &'static [FileClass] {
    match set {
        Set::Programs => &[PROGRAM],
        Set::Screens => &[PAGE_TEXT, PICTURE],
        Set::Params | Set::Variables | Set::Backup => &[],
    }
}

/// The class and number of a name, whatever set it belongs to.
fn classed(name: &str) -> Option<(&'static FileClass, u16)> {
    static CLASSES: [FileClass; 4] = [PROGRAM, PAGE_TEXT, PICTURE, FOREIGN_PICTURE];
    CLASSES.iter().find_map(|class| class.parse(name).map(|(number, _)| (class, number)))
}

/// What stands on both sides.
#[must_use]
pub fn media(folders: &Folders, stick: Option<&Stick>) -> MediaView {
    let known = |name: &str| classed(name).is_some() || [PARAMS, VARIABLES].contains(&name) || is_archive(name);
    let present = stick.filter(|stick| stick.is_present());
    let there = present.and_then(|stick| stick.files().ok()).unwrap_or_default();
    let there = there.into_iter().filter(|file| known(&file.name));
    let there = there.map(|file| MediaFile { name: file.name, size: file.size }).collect();
    let mut here = Vec::new();
    for (folder, set) in [(&folders.programs, Set::Programs), (&folders.screens, Set::Screens)] {
        for class in classes(set) {
            let entries = Folder::new(folder).list(class).map(|listing| listing.entries).unwrap_or_default();
            here.extend(entries.into_iter().map(|entry| MediaFile { name: entry.name, size: entry.size }));
        }
    }
    MediaView {
        stick: present.map(|stick| stick.root().display().to_string()),
        free: present.and_then(Stick::free),
        there,
        here,
    }
}

fn is_archive(name: &str) -> bool {
    name.starts_with(ARCHIVE.0) && name.ends_with(ARCHIVE.1)
}

pub(super) fn no_stick() -> Refusal {
    Refusal::Because(Said::new("没有 U 盘或已拔出", "no USB medium, or it was pulled out"))
}

fn say(zh: impl Into<String>, en: impl Into<String>) -> Refusal {
    Refusal::Because(Said::new(zh, en))
}

/// One transfer under way.
pub struct Carrier<'a> {
    /// The control's folders.
    pub folders: &'a Folders,
    /// The medium.
    pub stick: &'a Stick,
    /// What the core holds.
    pub holdings: Option<&'a Holdings>,
    /// Ends it between two files.
    pub cancelled: &'a AtomicBool,
}

impl Carrier<'_> {
    /// Does a transfer; the answer says what came of it.
    ///
    /// # Errors
    /// Why it was not done, or not to its end.
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
        };
        // Whatever the system said: a medium that is gone is the cause.
        done.map_err(|refusal| if self.stick.is_present() { refusal } else { no_stick() })
    }

    const fn own(&self, class: &FileClass) -> &PathBuf {
        if class.letter == PROGRAM.letter { &self.folders.programs } else { &self.folders.screens }
    }

    /// Programs or page files, one after the other.
    fn files(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let stick = Folder::new(self.stick.root());
        let mut waiting = Vec::new();
        for class in classes(ask.set) {
            let own = Folder::new(self.own(class));
            let (from, to) = match ask.direction {
                Direction::Out => (own, stick.clone()),
                Direction::In => (stick.clone(), own),
            };
            let read_as = self.read_as(class, ask.direction);
            let entries = from.list(read_as).map_err(|error| refused(&error))?.entries;
            let wanted = |name: &String| ask.names.is_empty() || ask.names.contains(name);
            for entry in entries.into_iter().filter(|entry| wanted(&entry.name)) {
                waiting.push((class, from.clone(), to.clone(), entry));
            }
        }
        if waiting.is_empty() {
            return Err(say("没有可复制的文件", "there is nothing to copy"));
        }
        let (mut clashing, mut foreign) = (Vec::new(), Vec::new());
        for (class, from, to, entry) in &waiting {
            let (new, fault) = self.fetch((class, ask.direction), entry.number, from)?;
            foreign.extend(fault);
            if let Ok(old) = to.read(class, entry.number)
                && stamp(&old.bytes) != stamp(&new)
            {
                clashing.push(entry.name.clone());
            }
        }
        if ask.convert != Some(true) && !foreign.is_empty() {
            return Err(Refusal::Convert(foreign));
        }
        if ask.overwrite.is_none() && !clashing.is_empty() {
            return Err(Refusal::Overwrite(clashing));
        }
        let all: u64 = waiting.iter().map(|(.., entry)| entry.size).sum::<u64>().max(1);
        let (mut done, mut copied, mut skipped) = (0, 0, 0);
        for (class, from, to, entry) in &waiting {
            if self.cancelled.load(Ordering::Acquire) {
                return Err(say(format!("已取消，已复制 {copied} 个文件"), format!("cancelled after {copied} files")));
            }
            tell(FileAnswer::Progress(COPYING, (done * 1_000 / all) as u16));
            done += entry.size;
            if ask.overwrite == Some(false) && clashing.contains(&entry.name) {
                skipped += 1;
                continue;
            }
            let (bytes, _) = self.fetch((class, ask.direction), entry.number, from)?;
            copy(class, entry.number, &bytes, to)?;
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

    /// Pictures of other forms count as well when they come in.
    const fn read_as<'c>(&self, class: &'c FileClass, direction: Direction) -> &'c FileClass {
        match direction {
            Direction::In if class.letter == PICTURE.letter => &FOREIGN_PICTURE,
            Direction::In | Direction::Out => class,
        }
    }

    /// The bytes of a file as they are to be written; a picture that was converted comes with what is wrong with it.
    fn fetch(
        &self,
        (class, direction): (&FileClass, Direction),
        number: u16,
        from: &Folder,
    ) -> Result<(Vec<u8>, Option<Said>), Refusal> {
        let read = from.read(self.read_as(class, direction), number).map_err(|error| refused(&error))?;
        if class.letter != PICTURE.letter || direction == Direction::Out {
            return Ok((read.bytes, None));
        }
        // What is taken for a page picture has to be one when it comes in.
        match super::disk::parse_picture(&read.name, &read.bytes) {
            Ok(_) => Ok((read.bytes, None)),
            Err(fault) => match convert(&read.bytes) {
                Ok(bytes) => Ok((bytes, Some(fault.said()))),
                Err(_) => Err(Refusal::Because(fault.said())),
            },
        }
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

    /// Everything in one archive, each file with its checksum in a list at the end.
    fn backup(&self, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let holdings = self.holdings.ok_or_else(no_stick)?;
        let name = format!("{}{}{}", ARCHIVE.0, Local::now().format("%Y%m%d-%H%M%S"), ARCHIVE.1);
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
            let Some((class, number)) = classed(&file.name) else { continue };
            let read = Folder::new(self.own(class)).read(class, number).map_err(|error| refused(&error))?;
            let place = if class.letter == PROGRAM.letter { "programs" } else { "screens" };
            put((&mut archive, &mut sums), &format!("{place}/{}", read.name), &read.bytes)?;
            done += file.size;
        }
        let list = sums.clone();
        put((&mut archive, &mut sums), "checksums.txt", list.as_bytes())?;
        let bytes = archive.into_inner().map_err(|error| because(&error))?;
        let path = self.stick.root().join(&name);
        write_whole(&path, &bytes).map_err(|error| because(&error))?;
        let back = read_whole(&path, ARCHIVE_LIMIT).map_err(|error| because(&error))?;
        if stamp(&back) != stamp(&bytes) {
            return Err(say(
                format!("{name} 校验不符，请换 U 盘"),
                format!("{name} does not read back: take another medium"),
            ));
        }
        Ok(FileAnswer::Done(Said::new(format!("已备份到 {name}"), format!("backup written: {name}"))))
    }

    /// Everything out of an archive: it is examined whole before the first file is touched.
    fn restore(&self, ask: &Transfer, tell: &mut dyn FnMut(FileAnswer)) -> Result<FileAnswer, Refusal> {
        let files = self.stick.files().map_err(|error| because(&error))?;
        let chosen = files
            .iter()
            .rev()
            .map(|file| &file.name)
            .find(|name| is_archive(name) && (ask.names.is_empty() || ask.names.contains(name)));
        let name = chosen.ok_or_else(|| say("U 盘上没有备份文件", "there is no backup on the medium"))?;
        if ask.overwrite.is_none() {
            return Err(Refusal::Overwrite(vec![name.clone()]));
        }
        let bytes = read_whole(&self.stick.root().join(name), ARCHIVE_LIMIT).map_err(|error| because(&error))?;
        let (values, contents) = unpack(name, &bytes)?;
        let restored = self.restored(&values)?;
        let all = contents.len().max(1);
        for (index, (class, number, bytes)) in contents.iter().enumerate() {
            tell(FileAnswer::Progress(COPYING, (index * 1_000 / all) as u16));
            Folder::new(self.own(class)).write(class, *number, bytes).map_err(|error| refused(&error))?;
        }
        Ok(FileAnswer::Restored(Box::new(restored)))
    }
}

/// One file, read back and compared.
fn copy(class: &FileClass, number: u16, bytes: &[u8], to: &Folder) -> Result<(), Refusal> {
    let name = to.write(class, number, bytes).map_err(|error| refused(&error))?;
    let back = to.read(class, number).map_err(|error| refused(&error))?;
    if stamp(&back.bytes) == stamp(bytes) {
        return Ok(());
    }
    Err(say(format!("{name} 校验不符，请换 U 盘"), format!("{name} does not read back: take another medium")))
}

/// Any PNG, JPEG or BMP as a page picture: as large as fits on 200 × 400, on white, 24 bit (K5.12).
///
/// # Errors
/// It is no such picture, or too large.
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

/// One file into an archive, and into its list of checksums.
fn put(into: (&mut tar::Builder<Vec<u8>>, &mut String), name: &str, bytes: &[u8]) -> Result<(), Refusal> {
    let (archive, sums) = into;
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o644);
    header.set_cksum();
    sums.push_str(&format!("{:016x} {name}\n", stamp(bytes)));
    archive.append_data(&mut header, name, bytes).map_err(|error| because(&error))
}

type Contents = Vec<(&'static FileClass, u16, Vec<u8>)>;

/// The files of an archive; a name, a kind or a checksum that is not this control's refuses the whole.
fn unpack(name: &str, bytes: &[u8]) -> Result<(Values, Contents), Refusal> {
    use std::io::Read;
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
                let file = other.strip_prefix("programs/").or_else(|| other.strip_prefix("screens/"));
                let (class, number) = file.and_then(classed).ok_or_else(|| damaged(other))?;
                if bytes.len() as u64 > class.limit {
                    return Err(damaged(other));
                }
                contents.push((class, number, bytes));
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

/// Keeps a picture of the screen in the folder of prints, and on the medium if there is one; gives where it is.
///
/// # Errors
/// The picture is of no size, or the disk refuses.
pub fn print(picture: &Print, folder: Option<&Path>, stick: Option<&Stick>) -> Result<Said, Refusal> {
    let wanted = picture.width as usize * picture.height as usize * 3;
    if wanted == 0 || wanted != picture.rgb.len() || wanted > PRINT_LIMIT {
        return Err(say("没有图像", "there is no picture"));
    }
    let mut bytes = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    let colour = image::ExtendedColorType::Rgb8;
    image::ImageEncoder::write_image(encoder, &picture.rgb, picture.width, picture.height, colour)
        .map_err(|error| because(&error))?;
    keep(&bytes, "PNG", folder, stick)
}

/// Keeps a file that people want to look at, on the medium if there is one; gives where it is.
///
/// # Errors
/// There is no place, or the disk refuses.
pub fn keep(bytes: &[u8], extension: &str, folder: Option<&Path>, stick: Option<&Stick>) -> Result<Said, Refusal> {
    let present = stick.filter(|stick| stick.is_present()).map(Stick::root);
    let Some(folder) = present.or(folder) else {
        return Err(say("没有保存位置：请插入 U 盘", "nowhere to keep it: plug a USB medium in"));
    };
    let stem = Local::now().format("KT830-%Y%m%d-%H%M%S").to_string();
    let free =
        |count: u32| if count == 0 { format!("{stem}.{extension}") } else { format!("{stem}-{count}.{extension}") };
    let name = (0..100).map(free).find(|name| !folder.join(name).exists()).unwrap_or_else(|| free(100));
    std::fs::create_dir_all(folder).map_err(|error| because(&error))?;
    write_whole(&folder.join(&name), bytes).map_err(|error| because(&error))?;
    let place = folder.join(&name);
    Ok(Said::new(format!("已保存：{}", place.display()), format!("saved: {}", place.display())))
}
