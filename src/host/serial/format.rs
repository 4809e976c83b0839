//! The transmission format: a leader of NUL, `%`, programs with their O number, `<NAME>` or `%_N_NAME_MPF`, lines that
//! end in CR LF, `%`, a trailer of NUL.
//! DECISION: a `%` inside a line refuses the program: reading it as the end would truncate the program.
//! Source: spec L9, B1, S1 (`.MPF`, `.SPF`).

use encoding_rs::GBK;

use super::SerialError;
use crate::defs::text::LocalizedText;
use crate::nc;
use crate::store::{Encoding, ProgramFolder, decode};

/// Starts and ends a transmission.
const PERCENT: u8 = b'%';
/// Starts the header of a SINUMERIK program, after the `%`.
const SINUMERIK: &str = "_N_";
/// DC1, XON: continue sending.
pub const XON: u8 = 0x11;
/// DC3, XOFF: stop sending.
pub const XOFF: u8 = 0x13;
/// Tape punch control codes (DC2, DC4) and rub-out (DEL); they are skipped.
const TAPE_CONTROL: [u8; 3] = [0x12, 0x14, 0x7F];
/// End-of-file character of old systems.
const SUBSTITUTE: u8 = 0x1A;
/// Maximum number of non-leader bytes before the first `%`.
const PREAMBLE_LIMIT: usize = 256;
/// Maximum length of a program header, bytes.
const HEAD_LIMIT: usize = 80;
const NEW_LINE: &[u8] = b"\r\n";

/// A program: its file name and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialProgram {
    /// `O1001.NC`, `SHAFT.NC`, `VGRIND.MPF`.
    pub name: String,
    /// Its bytes in GBK or UTF-8.
    pub text: Vec<u8>,
}

/// Encodes programs for a transmission, with `leader` NUL bytes before and after.
///
/// # Errors
/// A program contains `%` or a control character, or is not text.
pub fn encode_transmission(sheets: &[SerialProgram], leader: usize, named: bool) -> Result<Vec<u8>, SerialError> {
    let mut out = vec![0; leader];
    // Headers with their own % go last: everything after one belongs to it.
    let (own, plain): (Vec<&SerialProgram>, Vec<&SerialProgram>) =
        sheets.iter().partition(|sheet| matches!(header_of(&sheet.name, named), ProgramHeader::Sinumerik(_)));
    if !plain.is_empty() {
        out.push(PERCENT);
        out.extend_from_slice(NEW_LINE);
    }
    for sheet in plain.into_iter().chain(own) {
        write_program(&mut out, sheet, named)?;
    }
    out.push(PERCENT);
    out.extend_from_slice(NEW_LINE);
    out.resize(out.len() + leader, 0);
    Ok(out)
}

/// The header of a program.
enum ProgramHeader {
    Number(u32),
    Name(String),
    Sinumerik(String),
}

fn header_of(name: &str, named: bool) -> ProgramHeader {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, "SPF"));
    let (upper, extension) = (stem.to_ascii_uppercase(), extension.to_ascii_uppercase());
    let number = upper.strip_prefix('O').and_then(|digits| digits.parse().ok()).filter(|_| stem.len() == 5 && !named);
    match (number, extension.as_str()) {
        (Some(number), "NC") => ProgramHeader::Number(number),
        (_, "MPF" | "SPF") => ProgramHeader::Sinumerik(format!("{PERCENT_SIGN}{SINUMERIK}{upper}_{extension}")),
        _ => ProgramHeader::Name(stem.to_owned()),
    }
}

const PERCENT_SIGN: char = PERCENT as char;

fn write_program(out: &mut Vec<u8>, sheet: &SerialProgram, named: bool) -> Result<(), SerialError> {
    let decoded = decode(&sheet.text).map_err(|error| {
        let (name, line) = (&sheet.name, error.line);
        let zh = format!("{name} 第{line}行：不是 GBK 或 UTF-8 文字");
        SerialError::NotSendable(LocalizedText::new(zh, format!("{name} {error}")))
    })?;
    let mut lines: Vec<(usize, &str)> = decoded.text.split(line_end(&decoded.text)).map(trim_end).enumerate().collect();
    let empty = |line: &&(usize, &str)| matches!(line.1.trim(), "" | "%");
    let front = lines.iter().take_while(empty).count();
    lines.drain(..front);
    while lines.last().as_ref().is_some_and(empty) {
        lines.pop();
    }
    let mut put = |text: &str| {
        match decoded.encoding {
            Encoding::Utf8 => out.extend_from_slice(text.as_bytes()),
            Encoding::Gbk => out.extend_from_slice(&GBK.encode(text).0),
        }
        out.extend_from_slice(NEW_LINE);
    };
    match header_of(&sheet.name, named) {
        // The number in the file name overrides the number in the first line.
        ProgramHeader::Number(number) => match lines.first().and_then(|(_, line)| o_number(line)) {
            Some((_, rest)) => {
                put(&format!("O{number:04}{rest}"));
                lines.remove(0);
            }
            None => put(&format!("O{number:04}")),
        },
        ProgramHeader::Name(stem) => put(&format!("<{stem}>")),
        ProgramHeader::Sinumerik(head) => put(&head),
    }
    for (index, line) in lines {
        let wrong = line.chars().position(|sign| sign == PERCENT_SIGN || (sign.is_control() && sign != '\t'));
        if let Some(column) = wrong {
            let (name, line, column) = (&sheet.name, index + 1, column + 1);
            let en = format!("{name} line {line}, column {column}: a % or a control character");
            let message = LocalizedText::new(format!("{name} 第{line}行 第{column}列：% 或控制字符"), en);
            return Err(SerialError::NotSendable(message));
        }
        put(line);
    }
    Ok(())
}

fn bad_format(zh: impl Into<String>, en: impl Into<String>) -> SerialError {
    SerialError::BadFormat(LocalizedText::new(zh, en))
}

/// The line end: LF, or CR if there is no LF.
fn line_end(text: &str) -> char {
    if text.contains('\n') { '\n' } else { '\r' }
}

fn trim_end(line: &str) -> &str {
    line.trim_matches('\r')
}

/// The number of a line that starts with `O1001` or `:1001`, and the rest of the line.
fn o_number(line: &str) -> Option<(u32, &str)> {
    let (number, rest) = nc::o_number(line.as_bytes())?;
    Some((number, &line[line.len() - rest.len()..]))
}

/// Whether the transmission continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadProgress {
    /// More bytes are expected.
    More,
    /// The closing `%` was received.
    Done,
}

/// The state of the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ReaderState {
    Before,
    Header,
    Text,
    /// After a `%` at the start of a line: the end, or the header of another program.
    Closing,
}

/// A program as received.
#[derive(Clone, Debug, Default)]
struct RawProgram {
    header: Vec<u8>,
    text: Vec<u8>,
}

/// Reads a transmission byte by byte.
#[derive(Clone, Debug)]
pub struct SerialReader {
    limit: usize,
    state: ReaderState,
    /// Bytes received before the first `%`.
    preamble: Vec<u8>,
    programs: Vec<RawProgram>,
    /// Number of CR and LF since the last header; LF ends a line, or CR if there is no LF.
    line_ends: [u32; 2],
    /// Only blanks so far in this line.
    at_line_start: bool,
    size: usize,
}

impl SerialReader {
    /// A reader for at most `limit` bytes of programs.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        let (state, preamble, programs) = (ReaderState::Before, Vec::new(), Vec::new());
        Self { limit, state, preamble, programs, line_ends: [0; 2], at_line_start: true, size: 0 }
    }

    /// Reads one byte.
    ///
    /// # Errors
    /// Noise, too many bytes, or a `%` inside a line.
    pub fn push(&mut self, byte: u8) -> Result<ReadProgress, SerialError> {
        match self.state {
            ReaderState::Before => self.read_preamble(byte)?,
            ReaderState::Header if matches!(byte, b'\r' | b'\n') => {
                self.state = ReaderState::Text;
                return self.read_text(byte);
            }
            ReaderState::Header => {
                let raw = self.programs.last_mut().filter(|raw| raw.header.len() < HEAD_LIMIT);
                raw.ok_or(SerialError::Noise(1))?.header.push(byte);
            }
            ReaderState::Text => return self.read_text(byte),
            ReaderState::Closing if byte == SINUMERIK.as_bytes()[0] => {
                self.begin_program();
                self.programs.iter_mut().last().into_iter().for_each(|raw| raw.header.push(byte));
            }
            ReaderState::Closing => return Ok(ReadProgress::Done),
        }
        Ok(ReadProgress::More)
    }

    fn begin_program(&mut self) {
        self.programs.push(RawProgram::default());
        (self.state, self.line_ends, self.at_line_start) = (ReaderState::Header, [0; 2], true);
    }

    fn read_preamble(&mut self, byte: u8) -> Result<(), SerialError> {
        match byte {
            PERCENT => self.begin_program(),
            0 | b'\r' | b'\n' | b' ' | XON | XOFF => {}
            byte if TAPE_CONTROL.contains(&byte) => {}
            byte => {
                self.preamble.push(byte);
                if self.preamble.len() >= PREAMBLE_LIMIT {
                    return Err(self.preamble_error().unwrap_or(SerialError::Noise(0)));
                }
            }
        }
        Ok(())
    }

    fn read_text(&mut self, byte: u8) -> Result<ReadProgress, SerialError> {
        match byte {
            PERCENT if self.at_line_start => {
                self.state = ReaderState::Closing;
                return Ok(ReadProgress::More);
            }
            PERCENT => {
                let line = self.line();
                return Err(bad_format(format!("第 {line} 行中间有 %"), format!("line {line} contains a %")));
            }
            SUBSTITUTE if self.at_line_start => return Ok(ReadProgress::Done),
            XON | XOFF => return Ok(ReadProgress::More),
            byte if TAPE_CONTROL.contains(&byte) => return Ok(ReadProgress::More),
            b'\r' => (self.line_ends[0], self.at_line_start) = (self.line_ends[0] + 1, true),
            b'\n' => (self.line_ends[1], self.at_line_start) = (self.line_ends[1] + 1, true),
            b'\t' | b' ' => {}
            // A framing error is read as NUL; other control characters do not occur in programs.
            0..b' ' => return Err(SerialError::Noise(self.line())),
            _ => self.at_line_start = false,
        }
        self.size += 1;
        if self.size > self.limit {
            return Err(SerialError::TooLong(self.limit));
        }
        self.programs.iter_mut().last().into_iter().for_each(|raw| raw.text.push(byte));
        Ok(ReadProgress::More)
    }

    /// The line being read; the line of the opening % is line 1.
    #[must_use]
    pub fn line(&self) -> u32 {
        1 + if self.line_ends[1] > 0 { self.line_ends[1] } else { self.line_ends[0] }
    }

    /// Bytes of programs so far.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Whether the first `%` was received.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.state != ReaderState::Before
    }

    /// Whether a `%` was received that is the last one if nothing follows.
    #[must_use]
    pub fn is_closing(&self) -> bool {
        self.state == ReaderState::Closing
    }

    /// The error when the transmission stops here.
    #[must_use]
    pub fn timeout_error(&self) -> SerialError {
        match self.state {
            ReaderState::Before => self.preamble_error().unwrap_or(SerialError::NoData(None)),
            ReaderState::Header | ReaderState::Text | ReaderState::Closing => SerialError::NoData(Some(self.line())),
        }
    }

    /// The cause, concluded from the bytes received without a `%`.
    fn preamble_error(&self) -> Option<SerialError> {
        if self.preamble.is_empty() {
            return None;
        }
        let high = self.preamble.iter().any(|byte| *byte >= 0x80);
        let odd = self.preamble.iter().filter(|byte| byte.count_ones() % 2 == 1).count();
        // A few bytes can have equal parity by chance.
        if high && self.preamble.len() >= 8 && (odd == 0 || odd == self.preamble.len()) {
            return Some(SerialError::Parity);
        }
        let readable = |byte: &u8| matches!(byte, b' '..=b'~' | b'\t');
        Some(match self.preamble.iter().all(readable) {
            true => bad_format("开头没有 %", "there is no % at the beginning"),
            false => SerialError::Noise(0),
        })
    }

    /// The programs with their file names. A single program gets the name `asked`, if one is given.
    ///
    /// # Errors
    /// A program is not text, empty or without a name, or two have the same name.
    pub fn into_programs(
        self,
        asked: Option<&str>,
        shelf: &ProgramFolder,
        named: bool,
    ) -> Result<Vec<SerialProgram>, SerialError> {
        let mut found: Vec<(Option<String>, Vec<u8>)> = Vec::new();
        for raw in &self.programs {
            split_programs(raw, named, &mut found)?;
        }
        let alone = found.len() == 1;
        let mut sheets: Vec<SerialProgram> = Vec::new();
        for (own, text) in found {
            let name = asked.filter(|_| alone).map(str::to_owned).or(own);
            let name = name.filter(|name| shelf.is_program_name(name)).ok_or_else(|| {
                let en = "it has no usable number or name: fill in STORE AS";
                bad_format("程序没有可用的号或名称，请填写 存为", en)
            })?;
            if sheets.iter().any(|sheet| sheet.name.eq_ignore_ascii_case(&name)) {
                return Err(bad_format(format!("{name} 出现两次"), format!("{name} occurs twice")));
            }
            sheets.push(SerialProgram { name, text });
        }
        if sheets.is_empty() {
            return Err(bad_format("两个 % 之间没有程序", "there is no program between the two %"));
        }
        Ok(sheets)
    }
}

/// Splits the text between two `%` into programs, each with its own name if it has one.
fn split_programs(raw: &RawProgram, named: bool, out: &mut Vec<(Option<String>, Vec<u8>)>) -> Result<(), SerialError> {
    let decoded = decode(&raw.text).map_err(|error| SerialError::Noise(error.line as u32))?;
    let head = decode(&raw.header).map_err(|_| SerialError::Noise(1))?.text.trim().to_ascii_uppercase();
    let own = head.strip_prefix(SINUMERIK).and_then(|rest| {
        let (stem, extension) = rest.rsplit_once('_')?;
        Some(if named { format!("{stem}.NC") } else { format!("{stem}.{extension}") })
    });
    let whole = own.is_some();
    let (mut name, mut lines): (Option<String>, Vec<&str>) = (own, Vec::new());
    let mut close = |name: Option<String>, lines: &mut Vec<&str>| {
        while lines.last().is_some_and(|line| line.trim().is_empty()) {
            lines.pop();
        }
        if !lines.is_empty() {
            lines.push("");
            let text = lines.join("\r\n");
            let text = match decoded.encoding {
                Encoding::Utf8 => text.into_bytes(),
                Encoding::Gbk => GBK.encode(&text).0.into_owned(),
            };
            out.push((name, text));
        }
        lines.clear();
    };
    // `%O1001` and `%1001` name the program as a line does.
    let announced =
        (!whole && !head.is_empty()).then(|| o_number(&head).map_or_else(|| format!("O{head}"), |_| head.clone()));
    let announced = announced.filter(|line| o_number(line).is_some());
    let text = decoded.text.split(line_end(&decoded.text)).map(trim_end);
    for line in announced.as_deref().into_iter().chain(text) {
        if lines.is_empty() && line.trim().is_empty() {
            continue;
        }
        let bracket = line.trim().strip_prefix('<').and_then(|rest| rest.split_once('>')).map(|(name, _)| name);
        let number = o_number(line).map(|(number, _)| format!("O{number:04}.NC"));
        if let Some(next) = number.or_else(|| bracket.map(|name| format!("{name}.NC"))).filter(|_| !whole) {
            // A title before the first number belongs to that program.
            if name.is_some() || !lines.iter().all(|line| line.trim_start().starts_with(['(', ';', '/'])) {
                close(name.take(), &mut lines);
            }
            name = Some(next);
        }
        if bracket.is_none() || whole {
            lines.push(line);
        }
    }
    close(name, &mut lines);
    Ok(())
}
