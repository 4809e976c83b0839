//! SINUMERIK expressions, evaluated while they are read: `+ − * / DIV MOD`, round brackets, functions, R parameters
//! and positions. An R parameter that was never set is 0. Source: spec S1.

use std::ops::Range;

use crate::defs::variable_name;
use crate::nc::expression::{CoordinateFrame, Scope, enter, finite, function_value, signs};
use crate::nc::fault::{Capitals, E, ReadResult, fail, fail1, fail2};
use crate::nc::functions::{FUNCTIONS, whole_u32};
use crate::nc::lexer::Cursor;
use crate::nc::words::Assignment;
use crate::units::Axis;

/// SINUMERIK function names, and the same functions in `FUNCTIONS`.
const FUNCTION_NAMES: [(&str, &str); 11] = [
    ("SIN", "SIN"),
    ("COS", "COS"),
    ("TAN", "TAN"),
    ("ASIN", "ASIN"),
    ("ACOS", "ACOS"),
    ("SQRT", "SQRT"),
    ("ABS", "ABS"),
    ("TRUNC", "FIX"),
    ("ROUND", "ROUND"),
    ("LN", "LN"),
    ("EXP", "EXP"),
];

/// Functions that are not in `FUNCTIONS`: the square, and ATAN2 with two arguments.
const EXTRA_FUNCTIONS: [&str; 2] = ["POT", "ATAN2"];

/// The names of all functions.
pub(in crate::nc::dialect) fn function_names() -> impl Iterator<Item = &'static str> {
    FUNCTION_NAMES.into_iter().map(|(name, _)| name).chain(EXTRA_FUNCTIONS)
}

/// Skips spaces. Brackets are not comments here.
pub(super) fn skip_blanks(cursor: &mut Cursor<'_>) {
    while matches!(cursor.peek(), b' ' | b'\t') && !cursor.is_at_end() {
        cursor.at += 1;
    }
}

/// Skips a keyword if it is next and no further letter or digit follows; returns whether it was.
pub(super) fn accept_keyword(cursor: &mut Cursor<'_>, word: &str) -> bool {
    let found = identifier(&cursor.text[cursor.at.min(cursor.text.len())..]);
    let found = found.is_some_and(|name| name.eq_ignore_ascii_case(word.as_bytes()));
    cursor.at += if found { word.len() } else { 0 };
    found
}

/// The error for an unexpected byte. Round brackets are not comments here.
#[cold]
pub(super) fn unexpected<T>(cursor: &Cursor<'_>) -> ReadResult<T> {
    match cursor.peek() {
        b'(' | b')' => fail(cursor.at, E::UnbalancedRound),
        _ => cursor.unexpected(),
    }
}

/// Evaluates the expression at the cursor.
pub(super) fn evaluate<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<f64> {
    evaluate_with(cursor, scope, &[])
}

/// Evaluates the expression at the cursor; `sets` are earlier assignments in the same block.
pub(super) fn evaluate_with<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, sets: &[Assignment]) -> ReadResult<f64> {
    SinumerikExpressionParser { cursor, scope, assignments: sets, depth: 0 }.sum()
}

/// Evaluates the expression in round brackets at the cursor.
pub(super) fn bracketed<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, sets: &[Assignment]) -> ReadResult<f64> {
    SinumerikExpressionParser { cursor, scope, assignments: sets, depth: 0 }.bracket()
}

/// The variable number of the R parameter at the cursor: `R18` or `R[…]`.
pub(super) fn parameter_number<S: Scope>(
    cursor: &mut Cursor<'_>,
    scope: &mut S,
    sets: &[Assignment],
) -> ReadResult<u32> {
    SinumerikExpressionParser { cursor, scope, assignments: sets, depth: 0 }.parameter_number()
}

struct SinumerikExpressionParser<'r, 'a, S> {
    cursor: &'r mut Cursor<'a>,
    scope: &'r mut S,
    assignments: &'r [Assignment],
    depth: usize,
}

impl<S: Scope> SinumerikExpressionParser<'_, '_, S> {
    fn sum(&mut self) -> ReadResult<f64> {
        self.chain::<false>()
    }

    /// Operators of one precedence, from the left: `TIGHT` are `* / DIV MOD`, the others `+ −`.
    fn chain<const TIGHT: bool>(&mut self) -> ReadResult<f64> {
        let mut left = self.operand::<TIGHT>()?;
        loop {
            skip_blanks(self.cursor);
            let at = self.cursor.at;
            let act: fn(f64, f64) -> f64 = match (TIGHT, self.cursor.peek()) {
                (false, b'+') => |a, b| a + b,
                (false, b'-') => |a, b| a - b,
                (true, b'*') => |a, b| a * b,
                (true, b'/') => |a, b| a / b,
                (true, _) if accept_keyword(self.cursor, "DIV") => |a, b| (a / b).trunc(),
                (true, _) if accept_keyword(self.cursor, "MOD") => |a, b| a % b,
                _ => return Ok(left),
            };
            let divides = TIGHT && self.cursor.text.get(at) != Some(&b'*');
            self.cursor.at += usize::from(self.cursor.at == at);
            let right = self.operand::<TIGHT>()?;
            left = match (divides && right.abs() <= 0.0, S::HAS_VALUES) {
                (true, true) => return fail(at, E::DivisionByZero),
                (true, false) => 0.0,
                (false, _) => finite::<S>(act(left, right), at)?,
            };
        }
    }

    fn operand<const TIGHT: bool>(&mut self) -> ReadResult<f64> {
        if !TIGHT {
            return self.chain::<true>();
        }
        let negative = signs(self.cursor, |cursor| {
            skip_blanks(cursor);
            Ok(())
        })?;
        let value = self.factor()?;
        Ok(if negative { -value } else { value })
    }

    fn factor(&mut self) -> ReadResult<f64> {
        match self.cursor.peek() {
            b'0'..=b'9' | b'.' => self.number(),
            b'(' => self.bracket(),
            b'$' => self.position_variable(),
            b'R' | b'r' if matches!(self.cursor.peek_at(1), b'0'..=b'9' | b'[' | b'-') => {
                let at = self.cursor.at;
                let variable = self.parameter_number()?;
                match self.assignments.iter().rev().find(|set| set.variable == variable) {
                    Some(set) => Ok(set.value),
                    None => Ok(self.scope.read(variable, at)?.unwrap_or(0.0)),
                }
            }
            b'R' | b'r' if self.cursor.peek_at(1) >= 0x80 => {
                self.cursor.at += 1;
                unexpected(self.cursor)
            }
            b'A'..=b'Z' | b'a'..=b'z' | b'_' => self.function(),
            b'\r' | b'\n' | b';' => fail1(self.cursor.at, E::MissingNumber, "="),
            _ => unexpected(self.cursor),
        }
    }

    fn bracket(&mut self) -> ReadResult<f64> {
        let open = self.cursor.at;
        skip_blanks(self.cursor);
        if !self.cursor.accept(b'(') {
            return fail(open, E::UnbalancedRound);
        }
        enter(&mut self.depth, open)?;
        let value = self.sum()?;
        self.depth -= 1;
        self.close(open)?;
        Ok(value)
    }

    /// The argument of a function, in round brackets.
    fn argument(&mut self, function: &str, at: usize) -> ReadResult<f64> {
        skip_blanks(self.cursor);
        match self.cursor.peek() {
            b'(' => self.bracket(),
            _ => fail2(at, E::MissingWord, function, "( )"),
        }
    }

    fn close(&mut self, open: usize) -> ReadResult<()> {
        skip_blanks(self.cursor);
        match self.cursor.peek() {
            b')' => {
                self.cursor.at += 1;
                Ok(())
            }
            b'\r' | b'\n' | b';' => fail(open, E::UnbalancedRound),
            _ => unexpected(self.cursor),
        }
    }

    /// A number, also with an exponent: `1.5EX3`.
    fn number(&mut self) -> ReadResult<f64> {
        let start = self.cursor.at;
        let number = self.cursor.read_number()?;
        let mantissa = start..self.cursor.at;
        let mut ahead = *self.cursor;
        if !ahead.accept_keyword("EX") {
            return Ok(number.value);
        }
        let exponent = ahead.at;
        ahead.at += usize::from(matches!(ahead.peek(), b'+' | b'-'));
        let digits = ahead.at;
        while ahead.peek().is_ascii_digit() {
            ahead.at += 1;
        }
        let written = |range: Range<usize>| String::from_utf8_lossy(&self.cursor.text[range]);
        if digits == ahead.at {
            return fail1(exponent, E::MissingNumber, "EX");
        }
        let value = format!("{}e{}", written(mantissa), written(exponent..ahead.at)).parse();
        let value = value.ok().filter(|value: &f64| value.is_finite());
        self.cursor.at = ahead.at;
        value.map_or_else(|| fail(start, E::Overflow), Ok)
    }

    fn parameter_number(&mut self) -> ReadResult<u32> {
        let at = self.cursor.at;
        self.cursor.at += 1;
        let index = match self.cursor.peek() {
            b'0'..=b'9' => {
                let number = self.cursor.read_number()?;
                if number.has_point {
                    return fail1(at, E::NotWhole, "R");
                }
                number.value
            }
            b'[' => {
                self.cursor.at += 1;
                let from = self.cursor.at;
                enter(&mut self.depth, at)?;
                let value = self.sum()?;
                self.depth -= 1;
                skip_blanks(self.cursor);
                let is_computed = self.cursor.text[from..self.cursor.at].iter().any(|sign| b"Rr$".contains(sign));
                if !self.cursor.accept(b']') {
                    return fail(at + 1, E::UnbalancedBracket);
                }
                // Without values every R is 0: which parameter it is, is known in the run.
                if is_computed && !S::HAS_VALUES { 0.0 } else { value }
            }
            b'-' if self.cursor.peek_at(1).is_ascii_digit() => {
                self.cursor.at += 1;
                -self.cursor.read_number()?.value
            }
            _ => return fail1(at, E::MissingNumber, "R"),
        };
        let number = whole_u32(index).and_then(variable_name::variable_of_r);
        number.map_or_else(|| fail1(at, E::BadRParameter, format_args!("R{index}")), Ok)
    }

    /// `$AA_IW[X]`, `$AA_IM[X]`.
    fn position_variable(&mut self) -> ReadResult<f64> {
        let at = self.cursor.at;
        self.cursor.at += 1;
        let word = identifier(&self.cursor.text[self.cursor.at..]).unwrap_or_default();
        let frame = if word.eq_ignore_ascii_case(b"AA_IW") {
            CoordinateFrame::Work
        } else if word.eq_ignore_ascii_case(b"AA_IM") {
            CoordinateFrame::Machine
        } else {
            return fail1(at, E::UnknownSystemVariable, format_args!("${}", Capitals(word)));
        };
        self.cursor.at += word.len();
        skip_blanks(self.cursor);
        let open = self.cursor.at;
        if !self.cursor.accept(b'[') {
            return fail1(open, E::MissingNumber, format_args!("${}", Capitals(word)));
        }
        skip_blanks(self.cursor);
        let letter = self.cursor.peek().to_ascii_uppercase();
        let Some(axis) = Axis::ALL.into_iter().find(|axis| axis.letter() == char::from(letter)) else {
            return fail1(self.cursor.at, E::NoAxis, char::from(letter));
        };
        let place = self.cursor.at;
        self.cursor.at += 1;
        skip_blanks(self.cursor);
        if !self.cursor.accept(b']') {
            return fail(open, E::UnbalancedBracket);
        }
        Ok(self.scope.axis_position(axis, frame, place)?.unwrap_or(0.0))
    }

    fn function(&mut self) -> ReadResult<f64> {
        let at = self.cursor.at;
        if accept_keyword(self.cursor, "POT") {
            let value = self.argument("POT", at)?;
            return finite::<S>(value * value, at);
        }
        if accept_keyword(self.cursor, "ATAN2") {
            return self.arc_tangent(at);
        }
        let found = FUNCTION_NAMES.into_iter().find(|(name, _)| accept_keyword(self.cursor, name));
        let act = found.and_then(|(_, name)| FUNCTIONS.into_iter().find(|(other, _)| *other == name));
        let (Some((shown, _)), Some((_, act))) = (found, act) else {
            let word = identifier(&self.cursor.text[at..]).unwrap_or(&self.cursor.text[at..=at]);
            // `X= F100`: the next word begins where a value is expected.
            if word.len() == 1 && matches!(self.cursor.peek_at(1), b'0'..=b'9' | b'.' | b'+' | b'-' | b'=') {
                return fail1(at, E::MissingNumber, "=");
            }
            let shown = Capitals(word);
            self.cursor.at += word.len();
            skip_blanks(self.cursor);
            return match self.cursor.peek() {
                b'(' => fail2(at, E::UnknownFunction, shown, function_names().collect::<Vec<_>>().join(" ")),
                _ if word.len() > 1 => fail1(at, E::NoUserVariable, shown),
                _ => fail1(at, E::UnknownWord, shown),
            };
        };
        let argument = self.argument(shown, at)?;
        function_value::<S>(act(argument), shown, argument, at)
    }

    /// `ATAN2(y, x)`, degrees from the first axis.
    fn arc_tangent(&mut self, at: usize) -> ReadResult<f64> {
        skip_blanks(self.cursor);
        let open = self.cursor.at;
        if !self.cursor.accept(b'(') {
            return fail2(at, E::MissingWord, "ATAN2", "(y, x)");
        }
        enter(&mut self.depth, open)?;
        let y = self.sum()?;
        skip_blanks(self.cursor);
        if !self.cursor.accept(b',') {
            return match self.cursor.peek() {
                b')' => fail2(at, E::MissingWord, "ATAN2", "(y, x)"),
                b'\r' | b'\n' | b';' => fail(open, E::UnbalancedRound),
                _ => unexpected(self.cursor),
            };
        }
        let x = self.sum()?;
        self.depth -= 1;
        self.close(open)?;
        Ok(y.atan2(x).to_degrees())
    }
}

/// The identifier at the start of a text: two letters or `_`, then letters, digits and `_`.
pub(super) fn identifier(text: &[u8]) -> Option<&[u8]> {
    let letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'_';
    if !text.get(..2)?.iter().all(letter) {
        return None;
    }
    let length = text.iter().take_while(|byte| letter(byte) || byte.is_ascii_digit()).count();
    text.get(..length)
}
