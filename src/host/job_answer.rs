//! What the jobs answer with: refusals made from errors, messages, program faults as lines, and the changed folders.
//! Source: spec B6, K6.2, K7.8.

use std::fmt::Display;

use crate::defs::text::{Lang, LocalizedText, phrase};
use crate::link::files::{FileAnswer, Refusal};
use crate::link::line_fault::LineFault;
use crate::nc::ProgramFault;
use crate::store::{FolderError, IoFault, stamp};

/// The result of a job.
pub(super) type JobResult = Result<FileAnswer, Refusal>;

/// Receives the answers of a job; the last one completes it.
pub(super) type Tell<'a> = &'a mut dyn FnMut(FileAnswer);

/// The folders that a job has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangedFolders {
    /// The program folder.
    pub programs: bool,
    /// The folder of page files.
    pub screens: bool,
}

impl From<FolderError> for Refusal {
    fn from(error: FolderError) -> Self {
        Self::Other(error.message())
    }
}

impl From<IoFault> for Refusal {
    fn from(fault: IoFault) -> Self {
        Refusal::Other(fault.message())
    }
}

pub(super) fn refusal(zh: impl Into<String>, en: impl Into<String>) -> Refusal {
    Refusal::Other(LocalizedText::new(zh, en))
}

/// The refusal for an error that has English words only.
pub(super) fn error_refusal(error: impl Display) -> Refusal {
    Refusal::Other(LocalizedText::same(&error))
}

pub(super) fn no_usb_drive() -> Refusal {
    refusal("没有 U 盘或已拔出", "no USB stick, or it was removed")
}

pub(super) fn cancelled() -> Refusal {
    refusal("已取消", "cancelled")
}

/// Compares what was written to a USB drive with what is read back.
pub(super) fn check_read_back(name: &str, same: bool) -> Result<(), Refusal> {
    let differs =
        || refusal(format!("{name} 校验不符，请换 U 盘"), format!("{name} failed verification: use another USB stick"));
    if same { Ok(()) } else { Err(differs()) }
}

/// The answer of a job that is done.
pub(super) fn done(zh: impl Into<String>, en: impl Into<String>) -> FileAnswer {
    FileAnswer::Done(LocalizedText::new(zh, en))
}

/// The answer of a saved text; `kept` is false if it was saved as UTF-8 because GBK lacks a character.
pub(super) fn saved(title: &str, number: u32, bytes: &[u8], kept: bool) -> FileAnswer {
    let message = if kept {
        phrase!("{title} 已保存", "{title} saved", title)
    } else {
        phrase!(
            "{title} 已保存；含 GBK 以外的字，改用 UTF-8 编码",
            "{title} saved as UTF-8: it contains characters that are not in GBK",
            title
        )
    };
    FileAnswer::Saved { message, number, stamp: stamp(bytes) }
}

/// A program fault as the pages show it.
#[must_use]
pub fn line_fault(fault: &ProgramFault) -> LineFault {
    let worded = |lang| format!("{} – {}", fault.cause(lang), fault.remedy(lang));
    let message = LocalizedText::new(worded(Lang::Zh), worded(Lang::En));
    LineFault { line: fault.location.line, column: fault.column, message }
}
