//! Incoming program files of other controls: files with several programs, and files whose name is no program name.
//! Source: spec B1, K7.8.

use super::job_answer::refusal;
use crate::defs::kind::Dialect;
use crate::link::files::Refusal;
use crate::nc::program_parts;
use crate::store::ProgramFolder;

/// Extensions under which other controls and computers write programs.
const FOREIGN_EXTENSIONS: [&str; 7] = ["NC", "TXT", "CNC", "TAP", "PRG", "DNC", "PIM"];

/// Whether a file of another control may hold programs: `ALL-PROG.TXT`.
pub(super) fn is_foreign_program_file(name: &str) -> bool {
    let extension = name.rsplit_once('.').map(|(_, extension)| extension);
    extension.is_some_and(|written| FOREIGN_EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(written)))
}

/// The programs of a file, each with the name of the file that it gets; nothing if the file is one program with a
/// name that the control can use.
///
/// # Errors
/// A program has no number, or two have the same.
pub(super) fn split(
    name: &str,
    bytes: &[u8],
    shelf: &ProgramFolder,
    dialect: Dialect,
) -> Result<Vec<(String, Vec<u8>)>, Refusal> {
    let parts = program_parts(bytes, dialect);
    let has_own_name = shelf.is_program_name(name);
    if has_own_name && parts.len() == 1 {
        return Ok(Vec::new());
    }
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    let mut lines: Vec<u32> = Vec::new();
    for (index, part) in parts.into_iter().enumerate() {
        let own = (index == 0 && has_own_name).then(|| name.to_owned());
        let numbered = || part.number.map(|number| format!("O{number:04}.NC"));
        let Some(target) = own.or_else(|| part.name.clone()).or_else(numbered) else {
            let zh = format!("{name} 开头没有程序号：请在第一行写 O1234 这样的程序号");
            return Err(refusal(
                zh,
                format!("{name} begins without a program number: write one like O1234 in its first line"),
            ));
        };
        let line = part.lines_before + 1;
        if let Some(before) = files.iter().position(|(other, _)| other.eq_ignore_ascii_case(&target)) {
            let (first, en) =
                (lines[before], format!("{name}: {target} begins in line {} and again in line {line}", lines[before]));
            return Err(refusal(format!("{name}：{target} 在第 {first} 行和第 {line} 行各有一个"), en));
        }
        files.push((target, bytes.get(part.bytes).unwrap_or_default().to_vec()));
        lines.push(line);
    }
    Ok(files)
}
