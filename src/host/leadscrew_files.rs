//! Leadscrew compensation tables on a USB drive: `KT830-SCREW-X.CSV` from the measuring device's computer, or a file
//! that this control wrote with date and time in its name.
//! Source: spec B7.

use super::job_answer::{JobResult, no_usb_drive, refusal};
use super::transfer::SaveTarget;
use crate::defs::date::DateTime;
use crate::defs::leadscrew::LeadscrewCompensation;
use crate::defs::text::LocalizedText;
use crate::link::files::{FileAnswer, Refusal};
use crate::store::{UsbDrive, decode, read_regular_file};
use crate::units::Axis;

/// Maximum file size, bytes: a hundred lines and comments.
const FILE_LIMIT: u64 = 256 * 1024;
/// The header line.
const HEADER: &str = "位置 mm,反向间隙 mm,螺距误差 mm\r\n";

fn file_stem(axis: Axis) -> String {
    format!("KT830-SCREW-{}", axis.letter())
}

/// Reads the table of an axis: `KT830-SCREW-X.CSV` if it exists, otherwise the newest that this control wrote.
///
/// # Errors
/// No USB drive, no such file, not a text, or an invalid line, which is named.
pub fn read(axis: Axis, drive: Option<&UsbDrive>) -> JobResult {
    let drive = drive.ok_or_else(no_usb_drive)?;
    let stem = file_stem(axis);
    let ours = |name: &str| {
        let upper = name.to_ascii_uppercase();
        let rest = upper.strip_prefix(&stem).and_then(|rest| rest.strip_suffix(".CSV"));
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    };
    // The name without a date sorts after those with a date.
    let file =
        drive.files()?.into_iter().filter(|file| ours(&file.name)).max_by_key(|file| file.name.to_ascii_uppercase());
    let missing = || refusal(format!("U 盘上没有 {stem}.CSV"), format!("there is no {stem}.CSV on the USB stick"));
    let name = file.map(|file| file.name).ok_or_else(missing)?;
    let wrong = |zh: String, en: String| refusal(format!("{name} {zh}"), format!("{name} {en}"));
    let bytes = read_regular_file(&drive.root().join(&name), FILE_LIMIT)?;
    let text = decode(&bytes)
        .map_err(|error| wrong(format!("第 {} 行不是 GBK 或 UTF-8 文字", error.line), error.to_string()))?;
    let table = LeadscrewCompensation::parse(&text.text).map_err(|fault| {
        let (line, cause) = (fault.line, &fault.message);
        wrong(format!("第 {line} 行：{}", cause.zh()), format!("line {line}: {}", cause.en()))
    })?;
    if table.points().is_empty() {
        return Err(wrong("中没有点".into(), "contains no points".into()));
    }
    Ok(FileAnswer::Leadscrew(axis, table, name))
}

/// Writes the table of an axis.
///
/// # Errors
/// No target folder, or a disk error.
pub(super) fn write(
    axis: Axis,
    table: &LeadscrewCompensation,
    date: DateTime,
    target: SaveTarget<'_>,
) -> Result<LocalizedText, Refusal> {
    let text = format!("\u{FEFF}{HEADER}{}", table.to_text().replace('\n', "\r\n"));
    target.save(text.as_bytes(), (&format!("{}-{}", file_stem(axis), date.compact()), "CSV"))
}
