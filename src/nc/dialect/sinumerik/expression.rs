//! SINUMERIK expressions, evaluated while they are read: `+ − * / DIV MOD`, round brackets, functions, R parameters
//! and positions. An R parameter that was never set is 0. Source: spec S1.

use super::read::unexpected;
use crate::defs::program_error::ProgramError as E;
use crate::defs::r_parameter;
use crate::nc::expression::{Frame, Scope, whole};
use crate::nc::fault::{Outcome, wrong, wrong1, wrong2};
use crate::nc::functions::FUNCTIONS;
use crate::nc::lexer::Cursor;
use crate::nc::source::name;
use crate::nc::words::Set;
use crate::units::Axis;

/// Deepest nesting of brackets and signs.
const DEPTH: usize = 32;

/// SINUMERIK function names, and the same functions in `FUNCTIONS`.
const NAMES: [(&str, &str); 11] = [
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
const OTHERS: [&str; 2] = ["POT", "ATAN2"];

/// The names of all functions.
pub(super) fn function_names() -> impl Iterator<Item = &'static str> {
    NAMES.into_iter().map(|(name, _)| name).chain(OTHERS)
}

/// Skips spaces. Brackets are not comments here.
pub(super) fn blanks(cursor: &mut Cursor<'_>) {
    while matches!(cursor.peek(), b' ' | b'\t') && !cursor.is_over() {
        cursor.at += 1;
    }
}

/// Evaluates the expression at the cursor.
pub(super) fn evaluate<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> Outcome<f64> {
    evaluate_after(cursor, scope, &[])
}

/// Evaluates the expression at the cursor; `sets` are earlier assignments in the same block.
pub(super) fn evaluate_after<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, sets: &[Set]) -> Outcome<f64> {
    Reader { cursor, scope, sets, depth: 0 }.sum()
}

/// The variable number of the R parameter at the cursor: `R18` or `R[…]`.
pub(super) fn parameter<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S, sets: &[Set]) -> Outcome<u32> {
    Reader { cursor, scope, sets, depth: 0 }.parameter()
}

struct Reader<'r, 'a, S> {
    cursor: &'r mut Cursor<'a>,
    scope: &'r mut S,
    sets: &'r [Set],
    depth: usize,
}

impl<S: Scope> Reader<'_, '_, S> {
    fn sum(&mut self) -> Outcome<f64> {
        let mut left = self.product()?;
        loop {
            blanks(self.cursor);
            let at = self.cursor.at;
            let minus = match self.cursor.peek() {
                b'+' => false,
                b'-' => true,
                _ => return Ok(left),
            };
            self.cursor.at += 1;
            let right = self.product()?;
            left = self.finite(if minus { left - right } else { left + right }, at)?;
        }
    }

    fn product(&mut self) -> Outcome<f64> {
        let mut left = self.sign()?;
        loop {
            blanks(self.cursor);
            let at = self.cursor.at;
            let act: fn(f64, f64) -> f64 = match self.cursor.peek() {
                b'*' => |a, b| a * b,
                b'/' => |a, b| a / b,
                _ if self.word("DIV") => |a, b| (a / b).trunc(),
                _ if self.word("MOD") => |a, b| a % b,
                _ => return Ok(left),
            };
            let divides = self.cursor.text.get(at) != Some(&b'*');
            self.cursor.at += usize::from(self.cursor.at == at);
            let right = self.sign()?;
            left = match (divides && right.abs() <= 0.0, S::STRICT) {
                (true, true) => return wrong(at, E::DivisionByZero),
                (true, false) => 0.0,
                (false, _) => self.finite(act(left, right), at)?,
            };
        }
    }

    fn sign(&mut self) -> Outcome<f64> {
        blanks(self.cursor);
        let mut negative = false;
        for _ in 0..DEPTH {
            match self.cursor.peek() {
                b'-' => negative = !negative,
                b'+' => {}
                _ => {
                    let value = self.factor()?;
                    return Ok(if negative { -value } else { value });
                }
            }
            self.cursor.at += 1;
            blanks(self.cursor);
        }
        wrong(self.cursor.at, E::TooComplex)
    }

    fn factor(&mut self) -> Outcome<f64> {
        match self.cursor.peek() {
            b'0'..=b'9' | b'.' => Ok(self.cursor.number()?.value),
            b'(' => self.bracket(),
            b'$' => self.system(),
            b'R' | b'r' if matches!(self.cursor.peek_at(1), b'0'..=b'9' | b'[' | b'-') => {
                let at = self.cursor.at;
                let variable = self.parameter()?;
                match self.sets.iter().rev().find(|set| set.variable == variable) {
                    Some(set) => Ok(set.value),
                    None => Ok(self.scope.read(variable, at)?.unwrap_or(0.0)),
                }
            }
            b'R' | b'r' if self.cursor.peek_at(1) >= 0x80 => {
                self.cursor.at += 1;
                unexpected(self.cursor)
            }
            b'A'..=b'Z' | b'a'..=b'z' => self.function(),
            b'\r' | b'\n' | b';' => wrong1(self.cursor.at, E::MissingNumber, "="),
            _ => unexpected(self.cursor),
        }
    }

    fn bracket(&mut self) -> Outcome<f64> {
        let open = self.cursor.at;
        blanks(self.cursor);
        if !self.cursor.take(b'(') {
            return wrong(open, E::UnbalancedRound);
        }
        self.enter(open)?;
        let value = self.sum()?;
        self.depth -= 1;
        self.close(open)?;
        Ok(value)
    }

    /// The argument of a function, in round brackets.
    fn argument(&mut self, function: &str, at: usize) -> Outcome<f64> {
        blanks(self.cursor);
        match self.cursor.peek() {
            b'(' => self.bracket(),
            _ => wrong2(at, E::MissingWord, function, "( )"),
        }
    }

    fn close(&mut self, open: usize) -> Outcome<()> {
        blanks(self.cursor);
        match self.cursor.peek() {
            b')' => {
                self.cursor.at += 1;
                Ok(())
            }
            b'\r' | b'\n' | b';' => wrong(open, E::UnbalancedRound),
            _ => unexpected(self.cursor),
        }
    }

    fn enter(&mut self, at: usize) -> Outcome<()> {
        self.depth += 1;
        if self.depth > DEPTH { wrong(at, E::TooComplex) } else { Ok(()) }
    }

    fn parameter(&mut self) -> Outcome<u32> {
        let at = self.cursor.at;
        self.cursor.at += 1;
        let index = match self.cursor.peek() {
            b'0'..=b'9' => {
                let number = self.cursor.number()?;
                if number.point {
                    return wrong1(at, E::NotWhole, "R");
                }
                number.value
            }
            b'[' => {
                self.cursor.at += 1;
                self.enter(at)?;
                let value = self.sum()?;
                self.depth -= 1;
                blanks(self.cursor);
                if !self.cursor.take(b']') {
                    return wrong(at + 1, E::UnbalancedBracket);
                }
                value
            }
            b'-' if self.cursor.peek_at(1).is_ascii_digit() => {
                self.cursor.at += 1;
                -self.cursor.number()?.value
            }
            _ => return wrong1(at, E::MissingNumber, "R"),
        };
        let number = whole(index).and_then(|index| u32::try_from(index).ok()).and_then(r_parameter::of_r);
        number.map_or_else(|| wrong1(at, E::BadR, format!("R{index}")), Ok)
    }

    /// `$AA_IW[X]`, `$AA_IM[X]`.
    fn system(&mut self) -> Outcome<f64> {
        let at = self.cursor.at;
        self.cursor.at += 1;
        let word = name(&self.cursor.text[self.cursor.at..]).unwrap_or_default();
        let frame = match word.to_ascii_uppercase().as_slice() {
            b"AA_IW" => Frame::Work,
            b"AA_IM" => Frame::Machine,
            word => return wrong1(at, E::UnknownSystemVariable, format!("${}", String::from_utf8_lossy(word))),
        };
        self.cursor.at += word.len();
        blanks(self.cursor);
        let open = self.cursor.at;
        if !self.cursor.take(b'[') {
            return wrong1(open, E::MissingNumber, "$AA_IW");
        }
        blanks(self.cursor);
        let letter = self.cursor.peek().to_ascii_uppercase();
        let Some(axis) = Axis::ALL.into_iter().find(|axis| axis.letter() == char::from(letter)) else {
            return wrong1(self.cursor.at, E::NoAxis, char::from(letter));
        };
        let place = self.cursor.at;
        self.cursor.at += 1;
        blanks(self.cursor);
        if !self.cursor.take(b']') {
            return wrong(open, E::UnbalancedBracket);
        }
        Ok(self.scope.axis_position(axis, frame, place)?.unwrap_or(0.0))
    }

    /// Skips a word if it is next and no further letter or digit follows; returns whether it was.
    fn word(&mut self, word: &str) -> bool {
        let found = name(&self.cursor.text[self.cursor.at.min(self.cursor.text.len())..]);
        let found = found.is_some_and(|name| name.eq_ignore_ascii_case(word.as_bytes()));
        self.cursor.at += if found { word.len() } else { 0 };
        found
    }

    fn function(&mut self) -> Outcome<f64> {
        let at = self.cursor.at;
        if self.word("POT") {
            let value = self.argument("POT", at)?;
            return self.finite(value * value, at);
        }
        if self.word("ATAN2") {
            return self.arc_tangent(at);
        }
        let found = NAMES.into_iter().find(|(name, _)| self.word(name));
        let act = found.and_then(|(_, name)| FUNCTIONS.into_iter().find(|(other, _)| *other == name));
        let (Some((shown, _)), Some((_, act))) = (found, act) else {
            let word = name(&self.cursor.text[at..]).unwrap_or(&self.cursor.text[at..=at]);
            // `X= F100`: the next word begins where a value is expected.
            if word.len() == 1 && matches!(self.cursor.peek_at(1), b'0'..=b'9' | b'.' | b'+' | b'-' | b'=') {
                return wrong1(at, E::MissingNumber, "=");
            }
            let shown = String::from_utf8_lossy(word).to_ascii_uppercase();
            self.cursor.at += word.len();
            blanks(self.cursor);
            return match self.cursor.peek() {
                b'(' => wrong2(at, E::UnknownFunction, shown, function_names().collect::<Vec<_>>().join(" ")),
                _ => wrong1(at, E::UnknownWord, shown),
            };
        };
        let argument = self.argument(shown, at)?;
        match act(argument) {
            Some(value) => self.finite(value, at),
            None if S::STRICT => wrong2(at, E::Domain, shown, argument.to_string()),
            None => Ok(0.0),
        }
    }

    /// `ATAN2(y, x)`, degrees from the first axis.
    fn arc_tangent(&mut self, at: usize) -> Outcome<f64> {
        blanks(self.cursor);
        let open = self.cursor.at;
        if !self.cursor.take(b'(') {
            return wrong2(at, E::MissingWord, "ATAN2", "(y, x)");
        }
        self.enter(open)?;
        let y = self.sum()?;
        blanks(self.cursor);
        if !self.cursor.take(b',') {
            return match self.cursor.peek() {
                b')' => wrong2(at, E::MissingWord, "ATAN2", "(y, x)"),
                b'\r' | b'\n' | b';' => wrong(open, E::UnbalancedRound),
                _ => unexpected(self.cursor),
            };
        }
        let x = self.sum()?;
        self.depth -= 1;
        self.close(open)?;
        Ok(y.atan2(x).to_degrees())
    }

    fn finite(&self, value: f64, at: usize) -> Outcome<f64> {
        if value.is_finite() || !S::STRICT { Ok(value) } else { wrong(at, E::Overflow) }
    }
}
