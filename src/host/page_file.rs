//! Files of a grinding page for the page designer: its text, the variables its program uses, and its picture. A picture
//! comes from a USB drive or the folder and is converted if it has another format.
//! Source: spec K5.12, K7.3, K7.4.

use std::collections::BTreeMap;

use ropey::Rope;

use super::folders::{parse_picture, picture_labels};
use super::job_answer::{JobResult, done, error_refusal, no_usb_drive, refusal, saved};
use super::picture_labels::picture_labels_text;
use super::transfer::{FOREIGN_PICTURE, convert_picture};
use crate::controller::files::BackgroundJob;
use crate::defs::kind::Dialect;
use crate::defs::page_text::{COLUMN_ROWS, VariableUse};
use crate::defs::text::{Lang, phrase};
use crate::link::files::{FileAnswer, Refusal};
use crate::link::page_file::{PageFile, PageTextId, PictureFile, PictureLocation};
use crate::link::screens::PictureLabel;
use crate::nc::program_uses::find_uses;
use crate::store::{
    Encoding, FileClass, Folder, FolderError, PAGE_TEXT, PAGE_TEXT_EN, PAGE_TEXT_LIMIT, PICTURE, PICTURE_LABELS,
    UsbDrive, decode, encode, stamp,
};

/// Page number minus file number.
const PAGE_NUMBER_OFFSET: u32 = 1_000;
/// Maximum number of programs searched for one page.
const MAX_PROGRAMS: usize = 40;

/// Reads and writes page files.
pub struct PageFileFolder {
    /// The folder of page files.
    pub screens: Folder,
    /// The USB drive, if present.
    pub usb_drive: Option<UsbDrive>,
}

fn file_number(page: u32) -> Result<u32, Refusal> {
    let number = page.checked_sub(PAGE_NUMBER_OFFSET);
    let missing = || refusal(format!("{page} 没有页面"), format!("{page} has no page"));
    number.filter(|number| (1..=9_999).contains(number)).ok_or_else(missing)
}

/// The class of a page text.
const fn class(id: PageTextId) -> &'static FileClass {
    match id.lang {
        Lang::Zh => &PAGE_TEXT,
        Lang::En | Lang::Added(_) => &PAGE_TEXT_EN,
    }
}

/// An empty page text: a title and ten empty entries for each column.
fn empty_page_text() -> Rope {
    let mut text = String::from("标题;\r\n\r\n");
    for _ in 0..2 {
        text.push_str(&";\r\n".repeat(COLUMN_ROWS));
        text.push_str("\r\n");
    }
    text.push_str("%\r\n");
    text.into()
}

impl PageFileFolder {
    /// Reads the page text, the variables that a program uses, and the list of available pictures.
    pub fn read(&self, id: PageTextId, program: u32, job: &BackgroundJob) -> Result<PageFile, Refusal> {
        let file = file_number(id.page)?;
        let mut read = PageFile { id, uses: variables_used(program, job), ..PageFile::default() };
        match self.screens.read(class(id), file) {
            Ok(found) => {
                (read.name, read.stamp) = (found.name, stamp(&found.bytes));
                match decode(&found.bytes) {
                    Ok(decoded) => read.text = decoded.text.into(),
                    Err(_) => {
                        (read.text, read.has_invalid_bytes) = (String::from_utf8_lossy(&found.bytes).into(), true)
                    }
                }
            }
            Err(FolderError::Missing { name, .. }) => (read.name, read.text) = (name, self.template(id, file)),
            Err(error) => return Err(error.into()),
        }
        read.pictures = self.pictures();
        Ok(read)
    }

    /// The text of a file that does not exist yet. The English text begins as the page text, to be translated.
    fn template(&self, id: PageTextId, file: u32) -> Rope {
        let own = Some(PAGE_TEXT).filter(|_| id.lang == Lang::En).and_then(|own| self.screens.read(&own, file).ok());
        own.and_then(|own| Some(decode(&own.bytes).ok()?.text.into())).unwrap_or_else(empty_page_text)
    }

    fn pictures(&self) -> Vec<PictureFile> {
        let of = |from: PictureLocation, folder: &UsbDrive| {
            let files = folder.files().unwrap_or_default().into_iter();
            let is_picture = |name: &str| {
                let kind = name.rsplit_once('.').map_or("", |(_, kind)| kind);
                FOREIGN_PICTURE.extensions.iter().any(|known| known.eq_ignore_ascii_case(kind))
            };
            let pictures = files.filter(move |file| is_picture(&file.name));
            pictures.map(move |file| PictureFile { location: from, name: file.name, size: file.size })
        };
        let screens = UsbDrive::at(self.screens.path().to_path_buf());
        let mut found: Vec<_> = self.usb_drive.iter().flat_map(|drive| of(PictureLocation::Medium, drive)).collect();
        found.extend(of(PictureLocation::Screens, &screens));
        found
    }

    /// Replaces the text unless the file was changed since it was read. Keeps the encoding; a new file is GBK (K7.4).
    pub fn save(&self, id: PageTextId, text: &Rope, base: u64, force: bool) -> JobResult {
        let file = file_number(id.page)?;
        let encoding = match self.screens.read(class(id), file) {
            Ok(read) if !force && stamp(&read.bytes) != base => return Err(Refusal::Conflict),
            Ok(read) => decode(&read.bytes).map_or(Encoding::Gbk, |decoded| decoded.encoding),
            Err(FolderError::Missing { .. }) => Encoding::Gbk,
            Err(error) => return Err(error.into()),
        };
        let (bytes, kept) = encode(text, encoding);
        if bytes.len() as u64 > PAGE_TEXT_LIMIT {
            return Err(refusal("文件太大", "the text is too long"));
        }
        let name = self.screens.write(class(id), file, &bytes)?;
        Ok(saved(&name, id.page, &bytes, kept))
    }

    /// Replaces the places of the variables in the picture, unless the file has others than those that were changed.
    pub fn save_labels(
        &self,
        page: u32,
        labels: &[PictureLabel],
        base: &[PictureLabel],
        dialect: Dialect,
    ) -> JobResult {
        let file = file_number(page)?;
        let found = picture_labels(&self.screens, file).map_err(|fault| Refusal::Other(fault.full_message()))?;
        if found != base {
            return Err(Refusal::Conflict);
        }
        let name = self.screens.write(&PICTURE_LABELS, file, picture_labels_text(labels, dialect).as_bytes())?;
        Ok(FileAnswer::Done(phrase!("{name} 已保存", "{name} saved", name)))
    }

    /// Copies a file to the picture of a page; converts it if necessary.
    pub fn take_picture(&self, page: u32, from: PictureLocation, name: &str) -> JobResult {
        let file = file_number(page)?;
        let folder = match (from, &self.usb_drive) {
            (PictureLocation::Screens, _) => self.screens.clone(),
            (PictureLocation::Medium, Some(drive)) => Folder::new(drive.root()),
            (PictureLocation::Medium, None) => return Err(no_usb_drive()),
        };
        let read = folder.read_named(&FOREIGN_PICTURE, name)?;
        let (bytes, fault) = match parse_picture(&read.name, &read.bytes) {
            Ok(_) => (read.bytes, None),
            Err(fault) => (convert_picture(&read.bytes).map_err(error_refusal)?, Some(fault.full_message())),
        };
        let to = self.screens.write(&PICTURE, file, &bytes)?;
        Ok(match fault {
            None => done(format!("{to} 已换成 {name}"), format!("{to} replaced by {name}")),
            Some(fault) => done(
                format!("{to} 已换成 {name}，已转换（{}）", fault.zh()),
                format!("{to} replaced by {name}, converted ({})", fault.en()),
            ),
        })
    }
}

/// The variables that a program and its subprograms use; `None` when the program does not exist.
fn variables_used(program: u32, job: &BackgroundJob) -> Option<Vec<VariableUse>> {
    job.programs.get(program)?;
    let (mut all, mut next, mut at) = (BTreeMap::<u16, VariableUse>::new(), vec![program], 0);
    while let Some(number) = next.get(at).copied().filter(|_| at < MAX_PROGRAMS) {
        at += 1;
        let Some(program) = job.programs.get(number) else { continue };
        let found = find_uses(&program.source, job.settings.dialect);
        for (variable, used) in found.variables {
            let known = all.entry(variable).or_insert_with(|| used.clone());
            (known.reads, known.writes) = (known.reads || used.reads, known.writes || used.writes);
        }
        for called in found.calls {
            if !next.contains(&called) {
                next.push(called);
            }
        }
    }
    Some(all.into_values().collect())
}
