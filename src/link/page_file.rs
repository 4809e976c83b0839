//! What the page designer asks and sees: a page text with what its program uses, and pictures that can be taken.
//! Source: spec K5.12, K7.3, K7.4.

use ropey::Rope;

use crate::defs::screen::VariableUse;

/// Where a picture lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureFrom {
    /// On the medium.
    Medium,
    /// In the folder of page files.
    Screens,
}

/// A picture that can be taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// Where.
    pub from: PictureFrom,
    /// Its name there.
    pub name: String,
    /// Bytes.
    pub size: u64,
}

/// A page text as it was read for editing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PageFile {
    /// 1000 and the number of the files: 1001 is C0001.TXT.
    pub number: u32,
    /// The file, or the name it will have.
    pub name: String,
    /// The text; a form to fill in where there is no file yet.
    pub text: Rope,
    /// Stamp of the file; 0: there is none.
    pub stamp: u64,
    /// Bytes that are neither GBK nor UTF-8: shown, not edited.
    pub mistaken: bool,
    /// What its program and the programs called by it use, by number; none: the program is not there.
    pub uses: Option<Vec<VariableUse>>,
    /// Pictures that can be taken.
    pub pictures: Vec<PictureFile>,
}
