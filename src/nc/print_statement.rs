//! `DPRNT[…]`: a line of text with values for the printer. `*` is a blank; `#i[ab]` is a variable with `a` places before
//! and `b` places behind the point. Source: spec B3; FANUC custom macro B, external output commands.

use std::fmt::Write;

use super::expression::{Scope, primary};
use super::fault::{E, ReadResult, fail, fail1, fail2};
use super::lexer::Cursor;
use crate::defs::text::arg::Arg;

/// Most characters of a line, as the printers of such controls take them.
const MAX_LINE: usize = 80;
/// Most places before and behind the point together.
const MAX_PLACES: usize = 9;
/// How the value of a variable is written.
const FORMAT_SYNTAX: &str = "#i[ab]";

/// Reads what follows `DPRNT`, up to its closing bracket.
///
/// # Errors
/// A missing bracket or format, a character that is not ASCII, a line that is too long.
pub(super) fn read_line<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<Arg> {
    cursor.skip_blanks()?;
    let open = cursor.at;
    if !cursor.accept(b'[') {
        return fail1(open, E::BadStatement, "DPRNT[…]");
    }
    let mut line = String::with_capacity(MAX_LINE);
    loop {
        match cursor.peek() {
            b']' => {
                cursor.at += 1;
                break;
            }
            b'\r' | b'\n' => return fail(open, E::UnbalancedBracket),
            b'#' => read_value(cursor, scope, &mut line)?,
            byte if byte.is_ascii_graphic() || byte == b' ' => {
                line.push(if byte == b'*' { ' ' } else { char::from(byte) });
                cursor.at += 1;
            }
            _ => return cursor.unexpected(),
        }
        if line.len() > MAX_LINE {
            return fail1(open, E::PrintTooLong, format_args!("{MAX_LINE}"));
        }
    }
    Ok(Arg::from(format_args!("{line}")))
}

/// A variable and its format. A value with more places before the point than its format is written whole; null is 0.
fn read_value<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, line: &mut String) -> ReadResult<()> {
    let value = primary(cursor, scope)?.unwrap_or(0.0);
    let at = cursor.at;
    let digit =
        |ahead: usize| cursor.peek_at(ahead).is_ascii_digit().then(|| usize::from(cursor.peek_at(ahead) - b'0'));
    let (Some(before), Some(behind), b'[', b']') = (digit(1), digit(2), cursor.peek(), cursor.peek_at(3)) else {
        return fail1(at, E::PrintFormat, FORMAT_SYNTAX);
    };
    if before + behind > MAX_PLACES || before + behind == 0 {
        return fail2(at, E::OutOfRange, FORMAT_SYNTAX, format_args!("1–{MAX_PLACES}"));
    }
    cursor.at += 4;
    // Half away from zero, as the control displays it.
    let scale = 10_f64.powi(behind as i32);
    let rounded = (value.abs() * scale).round() / scale;
    let sign = if value < 0.0 && rounded > 0.0 { '-' } else { ' ' };
    let width = before + usize::from(behind > 0) + behind;
    // Writing to a `String` does not fail.
    let _ = write!(line, "{sign}{rounded:width$.behind$}");
    Ok(())
}
