//! Syntax colours of a program line: codes stand out; comments and block numbers are quiet.
//! Source: spec B6, H4.

use egui::Color32;
use egui::text::{LayoutJob, TextFormat};

use crate::hmi::theme::{self, Theme};

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TokenKind {
    /// Block number, comment, `%`.
    Quiet,
    /// G and M words.
    Code,
    /// Variables, brackets, WHILE and similar words.
    Macro,
    /// Coordinates and all other words.
    Plain,
}

/// Layout of a line, token by token.
pub fn layout_line(text: &str, size: f32, theme: &Theme) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut rest = text;
    while !rest.is_empty() {
        let (piece, length) = first_token(rest, job.text.trim_start().is_empty());
        let (head, tail) = rest.split_at(length);
        job.append(head, 0.0, TextFormat::simple(theme::font(size), colour(piece, theme)));
        rest = tail;
    }
    job.wrap.max_rows = 1;
    job
}

const fn colour(piece: TokenKind, theme: &Theme) -> Color32 {
    match piece {
        TokenKind::Quiet => theme.muted,
        TokenKind::Code => theme.info,
        TokenKind::Macro => theme.macros,
        TokenKind::Plain => theme.text,
    }
}

/// Operators that a number may follow without a space.
const OPERATORS: [&str; 10] = ["EQ", "NE", "GT", "GE", "LT", "LE", "AND", "OR", "XOR", "MOD"];

/// Kind of the first token of a text, and its length in bytes.
fn first_token(text: &str, first: bool) -> (TokenKind, usize) {
    let Some(sign) = text.chars().next() else { return (TokenKind::Plain, 0) };
    if text.starts_with("//") || matches!(sign, ';' | '%') {
        return (TokenKind::Quiet, text.len());
    }
    if sign == '(' {
        return (TokenKind::Quiet, text.find(')').map_or(text.len(), |close| close + 1));
    }
    if matches!(sign, '#' | '[' | ']' | '=' | '+' | '*') {
        let digits = text[1..].bytes().take_while(|byte| sign == '#' && byte.is_ascii_digit()).count();
        return (TokenKind::Macro, 1 + digits);
    }
    if !sign.is_ascii_alphabetic() && sign != '_' {
        let letter = |sign: char| sign.is_ascii_alphabetic() || ";%(#[]=+*_".contains(sign);
        let length = text.char_indices().skip(1).find(|(_, sign)| letter(*sign)).map_or(text.len(), |(at, _)| at);
        // A `//` that starts a comment ends the token, too.
        let comment = text[sign.len_utf8()..].find("//").map_or(text.len(), |at| at + sign.len_utf8());
        return (TokenKind::Plain, length.min(comment));
    }
    let word = text.bytes().take_while(|byte| byte.is_ascii_alphanumeric() || *byte == b'_').count();
    if text[word..].starts_with(':') {
        return (TokenKind::Macro, word + 1);
    }
    let letters = text.bytes().take_while(u8::is_ascii_alphabetic).count();
    if letters > 1 {
        // A label is a word with its digits; an operator ends before its number.
        let operator = OPERATORS.iter().any(|known| known.eq_ignore_ascii_case(&text[..letters]));
        return (TokenKind::Macro, if operator { letters } else { word });
    }
    let number = text[1..].bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
    let kind = match sign.to_ascii_uppercase() {
        'G' | 'M' => TokenKind::Code,
        'N' | 'O' if first => TokenKind::Quiet,
        _ => TokenKind::Plain,
    };
    (kind, 1 + number)
}
