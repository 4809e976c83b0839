//! Checks a page text against the English text beside it.
//! Source: spec H9.

use std::path::Path;

use crate::defs::page_text::{self, PageTextFault};
use crate::host::folders::parse_page_text;
use crate::link::screens::FileFault;
use crate::store::{FileClass, FileContent, Folder, PAGE_TEXT, PAGE_TEXT_EN, decode, folder_of};

/// Where a page text and the English text beside it do not fit (H9); either of them may be the checked file. A page
/// text without an English one has no warnings.
pub fn english_warnings(path: &Path, name: &str, bytes: &[u8]) -> Vec<FileFault> {
    let folder = Folder::new(folder_of(path));
    let other = |class: &FileClass, number| folder.read(class, number).ok();
    let own = FileContent { name: name.to_owned(), bytes: bytes.to_vec() };
    let pair = match (PAGE_TEXT.parse(name), PAGE_TEXT_EN.parse(name)) {
        (Some((number, _)), _) => other(&PAGE_TEXT_EN, number).map(|english| (own, english)),
        (None, Some((number, _))) => other(&PAGE_TEXT, number).map(|page| (page, own)),
        (None, None) => None,
    };
    let Some((page, english)) = pair else { return Vec::new() };
    let Ok(page) = parse_page_text(&page.name, &page.bytes) else { return Vec::new() };
    match parse_page_text(&english.name, &english.bytes) {
        // The faults of the checked file itself are errors.
        Err(fault) => Some(fault).filter(|_| english.name != name).into_iter().collect(),
        Ok(_) => {
            let text = decode(&english.bytes).map(|decoded| decoded.text).unwrap_or_default();
            let faults = page_text::english_faults(&page, &page_text::parse_all(&text)).into_iter();
            let file = english.name;
            let fault = |fault: PageTextFault| FileFault {
                file: file.clone(),
                position: Some((fault.line, fault.column)),
                message: fault.message,
            };
            faults.map(fault).collect()
        }
    }
}
