//! Decodes and encodes text files: UTF-8, or GBK as written by the customers' computers (B1, K7.4).
//!
//! Full-width `；＃％（）：` are ordinary characters here; the parser decides where they are allowed.

use std::borrow::Cow;

use encoding_rs::{DecoderResult, GBK};
use ropey::Rope;

/// The encoding of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without a byte order mark; includes ASCII.
    Utf8,
    /// GBK, and its superset GB18030.
    Gbk,
}

/// A file's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded<'b> {
    /// The text without a byte order mark, line ends as in the file.
    pub text: Cow<'b, str>,
    /// The encoding of the file.
    pub encoding: Encoding,
}

/// Bytes that are invalid in UTF-8 and in GBK.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, byte {column}: 0x{byte:02X} is not a character of UTF-8 or GBK; {}", remedy(*.utf16))]
pub struct DecodeError {
    /// Line, from 1.
    pub line: usize,
    /// Byte position in the line, from 1.
    pub column: usize,
    /// The first invalid byte.
    pub byte: u8,
    /// Whether the file starts like UTF-16, which some editors call "Unicode".
    pub utf16: bool,
}

fn remedy(utf16: bool) -> &'static str {
    if utf16 { "it was saved as UTF-16 (\"Unicode\"): save it as UTF-8" } else { "save the file again as UTF-8 or GBK" }
}

/// Decodes a file: as UTF-8 if all bytes are valid, otherwise as GBK.
///
/// DECISION: without a byte order mark, UTF-8 with letters that no workshop uses counts as GBK (`is_unlikely_utf8`).
///
/// # Errors
/// The first bytes that are invalid in both. A file with a UTF-8 byte order mark must be UTF-8.
pub fn decode(bytes: &[u8]) -> Result<Decoded<'_>, DecodeError> {
    const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";
    let marked = bytes.strip_prefix(UTF8_MARK);
    let body = marked.unwrap_or(bytes);
    let utf8_end = match std::str::from_utf8(body) {
        Ok(text) => {
            if marked.is_none()
                && !text.is_ascii()
                && is_unlikely_utf8(text)
                && let Ok(text) = decode_gbk(body)
            {
                return Ok(Decoded { text: text.into(), encoding: Encoding::Gbk });
            }
            return Ok(Decoded { text: text.into(), encoding: Encoding::Utf8 });
        }
        Err(wrong) => wrong.valid_up_to(),
    };
    if marked.is_some() {
        return Err(error_at(body, utf8_end));
    }
    // Up to the later of the two positions one of the encodings was valid.
    decode_gbk(body)
        .map(|text| Decoded { text: text.into(), encoding: Encoding::Gbk })
        .map_err(|gbk_end| error_at(body, gbk_end.max(utf8_end)))
}

/// Encodes a text. Returns false when UTF-8 replaced GBK because of a character that GBK lacks.
#[must_use]
pub fn encode(text: &Rope, encoding: Encoding) -> (Vec<u8>, bool) {
    if encoding == Encoding::Gbk {
        let whole = String::from(text);
        let (bytes, _, lacking) = GBK.encode(&whole);
        if !lacking {
            return (bytes.into_owned(), true);
        }
    }
    (text.bytes().collect(), encoding == Encoding::Utf8)
}

/// Whether valid UTF-8 is a coincidence: the GBK bytes of 砂 are also ɰ in UTF-8. Chinese characters (three bytes in
/// UTF-8) prove UTF-8; so does a text with Latin, Greek and Cyrillic letters only, including `±` and `µ`.
fn is_unlikely_utf8(text: &str) -> bool {
    let odd = |c: char| matches!(c, '\u{180}'..='\u{36F}' | '\u{480}'..='\u{7FF}');
    text.contains(odd) && text.chars().all(|c| c < '\u{800}')
}

/// Decodes GBK; the error is the position of the first invalid byte.
fn decode_gbk(bytes: &[u8]) -> Result<String, usize> {
    let mut decoder = GBK.new_decoder_without_bom_handling();
    let mut text = String::with_capacity(decoder.max_utf8_buffer_length(bytes.len()).unwrap_or(bytes.len() * 3));
    let (result, read) = decoder.decode_to_string_without_replacement(bytes, &mut text, true);
    match result {
        DecoderResult::InputEmpty => Ok(text),
        // Cannot happen, because the buffer is large enough.
        DecoderResult::OutputFull => Err(read),
        DecoderResult::Malformed(length, after) => Err(read.saturating_sub(usize::from(length) + usize::from(after))),
    }
}

/// The error at an offset, with line and byte column. LF, CRLF and CR alone end a line (B1).
fn error_at(bytes: &[u8], offset: usize) -> DecodeError {
    let offset = offset.min(bytes.len().saturating_sub(1));
    let (mut line, mut start) = (1, 0);
    for (at, byte) in bytes[..offset].iter().enumerate() {
        let ends = *byte == b'\n' || (*byte == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        if ends {
            line += 1;
            start = at + 1;
        }
    }
    let utf16 = bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF");
    DecodeError { line, column: offset - start + 1, byte: bytes.get(offset).copied().unwrap_or(0), utf16 }
}
