//! An error of the operating system with path, cause and remedy.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::defs::text::{LocalizedText, Template, Text};

/// A failed operation on a file or folder.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot {action}: {cause}; {}", .path.display(), remedy(.cause.kind()).en)]
pub struct IoFault {
    /// The file or folder.
    pub path: PathBuf,
    /// The operation as a verb: "read", "replace".
    pub action: &'static str,
    /// The error of the operating system.
    #[source]
    pub cause: io::Error,
}

impl IoFault {
    /// For `map_err`: adds path and operation to the error of the operating system.
    pub(super) fn at(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self { path, action, cause }
    }

    fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// The message for the screen, with the file name only; the words of the operating system are not translated.
    #[must_use]
    pub fn message(&self) -> LocalizedText {
        const MESSAGE: &Template =
            &Template::new("{name}：{remedy} ({cause})", "{name}: {remedy} ({cause})", &["name", "cause", "remedy"]);
        let texts = [remedy(self.cause.kind()).into()];
        LocalizedText::phrase_of(MESSAGE, [self.name().into(), self.cause.to_string().into()], texts)
    }

    /// Whether the file or folder does not exist.
    #[must_use]
    pub fn is_missing(&self) -> bool {
        self.cause.kind() == ErrorKind::NotFound
    }
}

/// The remedy for a kind of error.
fn remedy(kind: ErrorKind) -> Text {
    let (zh, en) = match kind {
        ErrorKind::NotFound => ("找不到，请检查 U 盘是否插好", "check the path, and that the stick is plugged in"),
        ErrorKind::PermissionDenied => ("没有权限", "give the user of the control access to it"),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => ("磁盘已满，请清理后再试", "free disk space"),
        ErrorKind::ReadOnlyFilesystem => {
            ("磁盘写保护，请解除或更换", "the disk is write-protected: unlock it, or replace a failing disk")
        }
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            ("同名的文件或目录挡住了，请移开", "move away the file or folder of the same name")
        }
        _ => ("请检查磁盘后再试", "check the disk and try again"),
    };
    Text::new(zh, en)
}
