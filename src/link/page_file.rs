//! Data of the page designer: a page text with the variables its program uses, and the pictures available.
//! Source: spec K5.12, K7.3, K7.4.

use ropey::Rope;

use crate::defs::page_text::VariableUse;
use crate::defs::text::Lang;

/// Where a picture is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureLocation {
    /// On the medium.
    Medium,
    /// In the folder of page files.
    Screens,
}

/// A picture that can be used for a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// Where it is stored.
    pub location: PictureLocation,
    /// Its file name.
    pub name: String,
    /// Bytes.
    pub size: u64,
}

/// A page text: its page, and whether it is the customer's own text (C0001.TXT) or the English one (C0001.EN.TXT).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PageTextId {
    /// 1000 plus the file number: 1001 is C0001.TXT.
    pub page: u32,
    /// English: the English text; Chinese: the customer's own text.
    pub lang: Lang,
}

/// A page text as read for editing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PageFile {
    /// Which text it is.
    pub id: PageTextId,
    /// The file name, also of a file that does not exist yet.
    pub name: String,
    /// The text; a template where there is no file yet.
    pub text: Rope,
    /// Checksum of the file; 0 if there is none.
    pub stamp: u64,
    /// The file has bytes that are neither GBK nor UTF-8: it is shown but not edited.
    pub has_invalid_bytes: bool,
    /// Variables used by its program and the programs called by it, by number; none if the program does not exist.
    pub uses: Option<Vec<VariableUse>>,
    /// The pictures available.
    pub pictures: Vec<PictureFile>,
}
