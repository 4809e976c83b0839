//! The type of a file under check, by its name and its first line.
//! Source: spec K7.3, tools.md T4.

/// The type of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckedFileKind {
    Program,
    PageText,
    Picture,
    PictureLabels,
}

/// `C0001.TXT`, `C0001.NC` are page texts, `.BMP` pictures, `.RON` their variables, everything else programs. Another
/// `.TXT` is a page text if its first line is a row of one: exports of other controls are called `.TXT`, too.
pub fn file_kind(name: &str, bytes: &[u8]) -> CheckedFileKind {
    let upper = name.to_ascii_uppercase();
    let page = upper
        .strip_prefix('C')
        .is_some_and(|rest| rest.len() > 4 && rest.as_bytes()[..4].iter().all(u8::is_ascii_digit));
    match upper.rsplit_once('.').map(|(_, extension)| extension) {
        Some("BMP") => CheckedFileKind::Picture,
        Some("RON") => CheckedFileKind::PictureLabels,
        _ if page => CheckedFileKind::PageText,
        Some("TXT") if begins_as_page_text(bytes) => CheckedFileKind::PageText,
        _ => CheckedFileKind::Program,
    }
}

/// Whether a text begins with a row of a page, which ends with `;` (K7.4), and not with a block that does: `O0031;`. An
/// empty text is a page text without rows.
fn begins_as_page_text(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut lines = text.split(|byte| matches!(byte, b'\r' | b'\n')).map(<[u8]>::trim_ascii);
    let Some(first) = lines.find(|line| !line.is_empty()) else { return true };
    let is_block = match *first {
        [b'%' | b'(' | b'/' | b'[' | b'#' | b':', ..] => true,
        [letter, next, ..] => {
            letter.is_ascii_alphabetic() && (next.is_ascii_digit() || matches!(next, b'-' | b'.' | b'#' | b'['))
        }
        _ => false,
    };
    !is_block && (first.ends_with(b";") || first.ends_with("；".as_bytes()) || first.ends_with(b"\xA3\xBB"))
}
