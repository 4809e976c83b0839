//! Text files of either encoding: UTF-8, or GBK as the customers' computers write it (B1, K7.4).
//!
//! Full-width `；＃％（）：` are characters like others here; whether they may stand there is the parser's business.

use encoding_rs::{DecoderResult, GBK};

/// How a file was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// UTF-8, with or without a byte order mark; plain ASCII counts as this.
    Utf8,
    /// GBK, and GB18030 which contains it.
    Gbk,
}

/// A file's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    /// The text without a byte order mark, line ends as in the file.
    pub text: String,
    /// How it was written.
    pub encoding: Encoding,
}

/// Bytes that are no character in UTF-8, nor in GBK.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, byte {column}: 0x{byte:02X} is no character in UTF-8 nor in GBK; {}", remedy(*.utf16))]
pub struct DecodeError {
    /// Line, from 1.
    pub line: usize,
    /// Place in the line in bytes, from 1.
    pub column: usize,
    /// The first offending byte.
    pub byte: u8,
    /// Whether the file begins like UTF-16, which some editors call "Unicode".
    pub utf16: bool,
}

fn remedy(utf16: bool) -> &'static str {
    if utf16 { "it was saved as UTF-16 (\"Unicode\"): save it as UTF-8" } else { "save the file again as UTF-8 or GBK" }
}

/// The text of a file: UTF-8 if it is that throughout, else GBK.
///
/// DECISION: without a byte order mark, text that would be UTF-8 only with letters no shop uses is GBK (`hardly_utf8`).
///
/// # Errors
/// Names the first bytes that are valid in neither. With a UTF-8 byte order mark the file is held to be UTF-8.
pub fn decode(bytes: &[u8]) -> Result<Decoded, DecodeError> {
    const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";
    let marked = bytes.strip_prefix(UTF8_MARK);
    let body = marked.unwrap_or(bytes);
    let utf8_end = match std::str::from_utf8(body) {
        Ok(text) => {
            if marked.is_none()
                && hardly_utf8(text)
                && let Ok(text) = gbk(body)
            {
                return Ok(Decoded { text, encoding: Encoding::Gbk });
            }
            return Ok(Decoded { text: text.to_owned(), encoding: Encoding::Utf8 });
        }
        Err(wrong) => wrong.valid_up_to(),
    };
    if marked.is_some() {
        return Err(place(body, utf8_end));
    }
    // Before the further of the two ends, one of the encodings was valid.
    gbk(body)
        .map(|text| Decoded { text, encoding: Encoding::Gbk })
        .map_err(|gbk_end| place(body, gbk_end.max(utf8_end)))
}

/// Whether UTF-8 is a chance: the GBK bytes of 砂 are those of ɰ. Chinese in UTF-8 takes three bytes a character, so
/// its presence settles it; so do only letters of Latin, Greek and Cyrillic, `±` and `µ` among them.
fn hardly_utf8(text: &str) -> bool {
    let odd = |c: char| matches!(c, '\u{180}'..='\u{36F}' | '\u{480}'..='\u{7FF}');
    text.contains(odd) && text.chars().all(|c| c < '\u{800}')
}

/// The text of bytes in GBK, or where it stops being that.
fn gbk(bytes: &[u8]) -> Result<String, usize> {
    let mut decoder = GBK.new_decoder_without_bom_handling();
    let mut text = String::with_capacity(decoder.max_utf8_buffer_length(bytes.len()).unwrap_or(bytes.len() * 3));
    let (result, read) = decoder.decode_to_string_without_replacement(bytes, &mut text, true);
    match result {
        DecoderResult::InputEmpty => Ok(text),
        // Cannot be for the room reserved above; then the place is where it stopped.
        DecoderResult::OutputFull => Err(read),
        DecoderResult::Malformed(length, after) => Err(read.saturating_sub(usize::from(length) + usize::from(after))),
    }
}

/// Line and byte column of an offset. LF, CRLF and CR alone end a line (B1).
fn place(bytes: &[u8], offset: usize) -> DecodeError {
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
