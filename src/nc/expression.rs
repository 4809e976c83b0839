//! Expressions, evaluated while they are read, without a syntax tree. Null is `None` and counts as 0 in arithmetic.
//! Two numbers are equal within 1e-9 of the larger. Source: spec B3.

use super::fault::{Capitals, E, ReadResult, fail, fail1, fail2};
use super::functions::{self, Comparison, FUNCTIONS, whole_number, whole_u32};
use super::lexer::Cursor;
use crate::units::Axis;

/// Letters of an unknown function that a message shows.
const LONGEST_NAME: usize = 16;
/// Deepest nesting of brackets, signs and indices.
const MAX_DEPTH: usize = 32;

/// A value; `None` is null.
pub(crate) type Value = Option<f64>;

/// #1–#33 of one call level; index 0 is #1.
pub(crate) type Locals = [Value; 33];

/// The coordinate system of an axis position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CoordinateFrame {
    /// Machine coordinates.
    Machine,
    /// Work coordinates.
    Work,
}

/// Looks up variables.
pub(crate) trait Scope {
    /// Whether variables have values; if not, only the syntax is checked.
    const HAS_VALUES: bool;
    /// The value of a variable; `at` is its byte in the text.
    fn read(&mut self, number: u32, at: usize) -> ReadResult<Value>;
    /// The displayed position of an axis, read with the machine at rest.
    fn axis_position(&mut self, axis: Axis, frame: CoordinateFrame, at: usize) -> ReadResult<Value>;
    /// Reports that null was used as 0.
    fn null_used(&mut self, at: usize);
    /// Whether every IF is read as if its condition held.
    fn assumes_conditions(&self) -> bool {
        false
    }
}

/// Evaluates the expression at the cursor, comparisons included.
pub(crate) fn evaluate<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<Value> {
    ExpressionParser { cursor, scope, depth: 0 }.comparison()
}

/// Evaluates `[…]`, a variable or a number, without sign.
pub(crate) fn primary<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<Value> {
    ExpressionParser { cursor, scope, depth: 0 }.factor()
}

/// The number of the variable whose `#` is at the cursor.
pub(crate) fn variable_number<S: Scope>(cursor: &mut Cursor<'_>, scope: &mut S) -> ReadResult<u32> {
    ExpressionParser { cursor, scope, depth: 0 }.variable_number()
}

/// A result that a number can hold.
#[inline]
pub(crate) fn finite<S: Scope>(value: f64, at: usize) -> ReadResult<f64> {
    if value.is_finite() || !S::HAS_VALUES { Ok(value) } else { fail(at, E::Overflow) }
}

/// The result of a function; `None`: the argument is outside its domain.
pub(crate) fn function_value<S: Scope>(value: Option<f64>, name: &str, argument: f64, at: usize) -> ReadResult<f64> {
    match value {
        Some(value) => finite::<S>(value, at),
        None if S::HAS_VALUES => fail2(at, E::FunctionDomain, name, argument),
        None => Ok(0.0),
    }
}

/// Enters a bracket or an index.
pub(crate) fn enter(depth: &mut usize, at: usize) -> ReadResult<()> {
    *depth += 1;
    if *depth > MAX_DEPTH { fail(at, E::TooComplex) } else { Ok(()) }
}

/// Skips signs and blanks; returns whether the signs make a value negative.
#[inline]
pub(crate) fn signs(
    cursor: &mut Cursor<'_>,
    skip_blanks: impl Fn(&mut Cursor<'_>) -> ReadResult<()>,
) -> ReadResult<bool> {
    let mut negative = false;
    for _ in 0..MAX_DEPTH {
        skip_blanks(cursor)?;
        match cursor.peek() {
            b'-' => negative = !negative,
            b'+' => {}
            _ => return Ok(negative),
        }
        cursor.at += 1;
    }
    fail(cursor.at, E::TooComplex)
}

struct ExpressionParser<'r, 'a, S> {
    cursor: &'r mut Cursor<'a>,
    scope: &'r mut S,
    depth: usize,
}

#[derive(Clone, Copy)]
enum Operator {
    Add,
    Subtract,
    Or,
    Xor,
    Multiply,
    Divide,
    Modulo,
    And,
}

impl<S: Scope> ExpressionParser<'_, '_, S> {
    fn comparison(&mut self) -> ReadResult<Value> {
        let left = self.sum()?;
        self.cursor.skip_blanks()?;
        let Some(compare) = self.comparison_sign() else { return Ok(left) };
        let right = self.sum()?;
        self.cursor.skip_blanks()?;
        let at = self.cursor.at;
        if self.comparison_sign().is_some() {
            return fail1(at, E::BadStatement, "a EQ b EQ c");
        }
        Ok(Some(f64::from(u8::from(comparison_holds(compare, left, right)))))
    }

    fn comparison_sign(&mut self) -> Option<Comparison> {
        const WORDS: &[(&str, Comparison)] = &[
            ("EQ", Comparison::Eq),
            ("NE", Comparison::Ne),
            ("GT", Comparison::Gt),
            ("GE", Comparison::Ge),
            ("LT", Comparison::Lt),
            ("LE", Comparison::Le),
            ("==", Comparison::Eq),
            ("!=", Comparison::Ne),
            ("<>", Comparison::Ne),
            (">=", Comparison::Ge),
            ("<=", Comparison::Le),
            (">", Comparison::Gt),
            ("<", Comparison::Lt),
        ];
        if !matches!(self.cursor.peek(), b'A'..=b'Z' | b'a'..=b'z' | b'=' | b'!' | b'<' | b'>') {
            return None;
        }
        WORDS.iter().find(|(word, _)| self.cursor.accept_keyword(word)).map(|(_, compare)| *compare)
    }

    /// Operators of one precedence, from the left: `TIGHT` are `* / MOD AND`, the others `+ − OR XOR`.
    fn chain<const TIGHT: bool>(&mut self) -> ReadResult<Value> {
        let mut left = self.operand_of::<TIGHT>()?;
        loop {
            self.cursor.skip_blanks()?;
            let at = self.cursor.at;
            let operator = match (TIGHT, self.cursor.peek()) {
                (false, b'+') => Operator::Add,
                (false, b'-') => Operator::Subtract,
                (false, b'O' | b'o') if self.cursor.accept_keyword("OR") => Operator::Or,
                (false, b'X' | b'x') if self.cursor.accept_keyword("XOR") => Operator::Xor,
                (true, b'*') => Operator::Multiply,
                (true, b'/') => Operator::Divide,
                (true, b'M' | b'm') if self.cursor.accept_keyword("MOD") => Operator::Modulo,
                (true, b'A' | b'a') if self.cursor.accept_keyword("AND") => Operator::And,
                _ => return Ok(left),
            };
            self.cursor.at += usize::from(self.cursor.at == at);
            let literal = TIGHT && {
                self.cursor.skip_blanks()?;
                self.cursor.at_number()
            };
            let right = self.operand_of::<TIGHT>()?;
            let zero = right.is_some_and(|right| right.abs() <= 0.0);
            if literal && zero && S::HAS_VALUES && matches!(operator, Operator::Divide | Operator::Modulo) {
                // The detail shows the check that no null variable is the cause.
                return fail1(at, E::DivisionByZero, "0");
            }
            left = self.apply(operator, left, right, at)?;
        }
    }

    fn operand_of<const TIGHT: bool>(&mut self) -> ReadResult<Value> {
        if TIGHT { self.sign() } else { self.chain::<true>() }
    }

    fn sum(&mut self) -> ReadResult<Value> {
        self.chain::<false>()
    }

    /// A sign has lower precedence than `**`: `-2**2` is −4.
    fn sign(&mut self) -> ReadResult<Value> {
        // Most operands have neither a sign nor a blank before them.
        if !matches!(self.cursor.peek(), b'-' | b'+' | b' ' | b'\t' | b'(') {
            return self.power();
        }
        let negative = signs(self.cursor, |cursor| cursor.skip_blanks())?;
        let value = self.power()?;
        Ok(if negative { value.map(|value| -value) } else { value })
    }

    fn power(&mut self) -> ReadResult<Value> {
        let mut left = self.factor()?;
        loop {
            self.cursor.skip_blanks()?;
            let at = self.cursor.at;
            if !(self.cursor.peek() == b'*' && self.cursor.peek_at(1) == b'*') {
                return Ok(left);
            }
            self.cursor.at += 2;
            let negative = signs(self.cursor, |cursor| cursor.skip_blanks())?;
            let right = self.factor()?;
            let (base, exponent) = (self.operand(left, at), self.operand(right, at));
            let exponent = if negative { -exponent } else { exponent };
            let power = base.powf(exponent);
            if power.is_nan() && S::HAS_VALUES {
                return fail2(at, E::FunctionDomain, "**", format_args!("{base}, {exponent}"));
            }
            left = Some(finite::<S>(power, at)?);
        }
    }

    fn factor(&mut self) -> ReadResult<Value> {
        match self.cursor.peek() {
            b'0'..=b'9' | b'.' => Ok(Some(self.cursor.read_number()?.value)),
            b'#' => {
                let at = self.cursor.at;
                let number = self.variable_number()?;
                self.scope.read(number, at)
            }
            b'[' => self.bracket(),
            b'A'..=b'Z' | b'a'..=b'z' => self.function(),
            _ => self.cursor.unexpected(),
        }
    }

    fn bracket(&mut self) -> ReadResult<Value> {
        let open = self.cursor.at;
        if !self.cursor.accept(b'[') {
            return self.cursor.unexpected();
        }
        enter(&mut self.depth, open)?;
        let value = self.comparison()?;
        self.depth -= 1;
        self.cursor.skip_blanks()?;
        if self.cursor.accept(b']') {
            return Ok(value);
        }
        if matches!(self.cursor.peek(), b'\r' | b'\n' | b';') {
            return fail(open, E::UnbalancedBracket);
        }
        self.cursor.unexpected()
    }

    fn variable_number(&mut self) -> ReadResult<u32> {
        let at = self.cursor.at;
        self.cursor.at += 1;
        self.cursor.skip_blanks()?;
        let value = match self.cursor.peek() {
            b'0'..=b'9' | b'.' => {
                let number = self.cursor.read_number()?;
                if !number.has_point && number.value < f64::from(u32::MAX) {
                    return Ok(number.value as u32);
                }
                Some(number.value)
            }
            b'[' => self.bracket()?,
            b'#' => {
                enter(&mut self.depth, at)?;
                let inner = self.factor()?;
                self.depth -= 1;
                inner
            }
            b'\r' | b'\n' | b';' => return fail1(at, E::MissingNumber, "#"),
            // A variable with a name, as in LinuxCNC.
            b'<' => return fail1(at, E::BadVariable, "#<…>"),
            _ => return self.cursor.unexpected(),
        };
        if !S::HAS_VALUES && value.is_none() {
            return Ok(0);
        }
        let value = self.operand(value, at);
        whole_u32(value).map_or_else(|| fail1(at, E::BadVariable, format_args!("#{value}")), Ok)
    }

    fn operand(&mut self, value: Value, at: usize) -> f64 {
        value.unwrap_or_else(|| {
            self.scope.null_used(at);
            0.0
        })
    }

    fn apply(&mut self, operator: Operator, left: Value, right: Value, at: usize) -> ReadResult<Value> {
        let (a, b) = (self.operand(left, at), self.operand(right, at));
        let value = match operator {
            Operator::Add => a + b,
            Operator::Subtract => a - b,
            Operator::Multiply => a * b,
            Operator::Divide | Operator::Modulo if b.abs() <= 0.0 => {
                return if S::HAS_VALUES { fail(at, E::DivisionByZero) } else { Ok(Some(0.0)) };
            }
            Operator::Divide => a / b,
            Operator::Modulo => a % b,
            Operator::And => self.bitwise(a, b, at, |a, b| a & b)?,
            Operator::Or => self.bitwise(a, b, at, |a, b| a | b)?,
            Operator::Xor => self.bitwise(a, b, at, |a, b| a ^ b)?,
        };
        finite::<S>(value, at).map(Some)
    }

    fn bitwise(&self, a: f64, b: f64, at: usize, act: fn(i64, i64) -> i64) -> ReadResult<f64> {
        match (whole_number(a), whole_number(b)) {
            (Some(a), Some(b)) => Ok(act(a, b) as f64),
            _ if S::HAS_VALUES => fail2(at, E::FunctionDomain, "AND OR XOR", format_args!("{a}, {b}")),
            _ => Ok(0.0),
        }
    }

    fn function(&mut self) -> ReadResult<Value> {
        let at = self.cursor.at;
        if self.cursor.accept_keyword("POW") {
            return self.function_of_two("POW", at);
        }
        let Some((name, act)) = FUNCTIONS.into_iter().find(|(name, _)| self.cursor.accept_keyword(name)) else {
            return unknown_function(self.cursor);
        };
        if name == "ATAN" && self.has_two_arguments() {
            return self.function_of_two(name, at);
        }
        self.cursor.skip_blanks()?;
        let argument = self.bracket()?;
        let argument = self.operand(argument, at);
        self.cursor.skip_blanks()?;
        let value = if name == "ATAN" && self.cursor.peek() == b'/' && self.bracket_follows() {
            self.cursor.at += 1;
            self.cursor.skip_blanks()?;
            let second = self.bracket()?;
            Some(argument.atan2(self.operand(second, at)).to_degrees())
        } else {
            act(argument)
        };
        function_value::<S>(value, name, argument, at).map(Some)
    }

    /// `[a,b]`.
    fn function_of_two(&mut self, name: &str, at: usize) -> ReadResult<Value> {
        self.cursor.skip_blanks()?;
        let open = self.cursor.at;
        if !self.cursor.accept(b'[') {
            return self.cursor.unexpected();
        }
        enter(&mut self.depth, open)?;
        let mut arguments = [0.0; 2];
        for (argument, end) in arguments.iter_mut().zip(*b",]") {
            let value = self.comparison()?;
            *argument = self.operand(value, at);
            self.cursor.skip_blanks()?;
            if !self.cursor.accept(end) {
                return fail1(self.cursor.at, E::BadStatement, format_args!("{name}[a,b]"));
            }
        }
        self.depth -= 1;
        let [a, b] = arguments;
        function_value::<S>(functions::of_two(name, a, b), name, a, at).map(Some)
    }

    /// Whether a comma divides the bracket that follows.
    fn has_two_arguments(&self) -> bool {
        let (mut ahead, mut depth) = (*self.cursor, 0_u32);
        loop {
            match ahead.peek() {
                b'[' => depth += 1,
                b']' if depth <= 1 => return false,
                b']' => depth -= 1,
                b',' if depth == 1 => return true,
                b'\r' | b'\n' | b';' => return false,
                _ => {}
            }
            ahead.at += 1;
        }
    }

    /// Whether `[` follows the slash, as in `ATAN[a]/[b]`; `ATAN[a]/2` is a division.
    fn bracket_follows(&self) -> bool {
        let mut ahead = *self.cursor;
        ahead.at += 1;
        ahead.skip_blanks().is_ok() && ahead.peek() == b'['
    }
}

fn comparison_holds(compare: Comparison, left: Value, right: Value) -> bool {
    // DECISION: for EQ and NE null equals only null, as in the KT-820 family; in order comparisons it is 0.
    match (left, right, compare) {
        (Some(_), None, Comparison::Eq) | (None, Some(_), Comparison::Eq) => false,
        (Some(_), None, Comparison::Ne) | (None, Some(_), Comparison::Ne) => true,
        _ => compare.holds(left.unwrap_or(0.0), right.unwrap_or(0.0)),
    }
}

/// The error for letters that are no function.
#[cold]
fn unknown_function<T>(cursor: &Cursor<'_>) -> ReadResult<T> {
    let word = &cursor.text[cursor.at..cursor.text.len().min(cursor.at + LONGEST_NAME)];
    let letters = word.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    if letters < 2 {
        return cursor.unexpected();
    }
    let known = FUNCTIONS.map(|(name, _)| name).join(" ");
    fail2(cursor.at, E::UnknownFunction, Capitals(&word[..letters]), format_args!("{known} POW"))
}
