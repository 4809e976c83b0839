//! Arithmetic of expressions: equality, whole numbers, and the functions. Angles are in degrees; `None`: the argument is
//! outside the domain. Two numbers are equal within 1e-9 of the larger. Source: spec B3.

/// Largest whole number of the bit functions: 2^53.
const MAX_WHOLE_NUMBER: f64 = 9_007_199_254_740_992.0;

/// A function with one argument.
pub(crate) type Function = fn(f64) -> Option<f64>;

/// The functions by name. A name that begins with another name comes before it.
pub(crate) const FUNCTIONS: [(&str, Function); 17] = [
    ("SIN", |a| Some(sin_degrees(a))),
    ("COS", |a| Some(sin_degrees(a + 90.0))),
    ("TAN", |a| {
        let cosine = sin_degrees(a + 90.0);
        (cosine.abs() > 1e-12).then(|| sin_degrees(a) / cosine)
    }),
    ("ASIN", |a| clamp_to_unit(a).map(|a| a.asin().to_degrees())),
    ("ACOS", |a| clamp_to_unit(a).map(|a| a.acos().to_degrees())),
    ("ATAN", |a| Some(a.atan().to_degrees())),
    ("SQRT", square_root),
    ("SQR", square_root),
    ("ABS", |a| Some(a.abs())),
    // A value has its decimal point already.
    ("ADP", Some),
    ("ROUND", |a| Some(a.round())),
    ("FIX", |a| Some(a.trunc())),
    ("FUP", |a| Some(if a < 0.0 { a.floor() } else { a.ceil() })),
    ("LN", |a| (a > 0.0).then(|| a.ln())),
    ("EXP", |a| Some(a.exp())),
    ("BIN", from_bcd),
    ("BCD", to_bcd),
];

/// A function of two arguments, `NAME[a,b]`.
pub(crate) fn of_two(name: &str, a: f64, b: f64) -> Option<f64> {
    let value = if name == "ATAN" { a.atan2(b).to_degrees() } else { a.powf(b) };
    Some(value).filter(|value| !value.is_nan())
}

/// EQ as specified: within 1e-9 of the larger. DECISION: 1e-12 always counts as equal, so that 0.1+0.2-0.3 EQ 0.
#[must_use]
pub(crate) fn equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= (1e-9 * a.abs().max(b.abs())).max(1e-12)
}

/// The whole number that the value equals within 1e-9 (relative, absolute below 1), if any.
#[must_use]
#[inline]
pub(crate) fn whole_number(value: f64) -> Option<i64> {
    // A cast truncates towards zero and saturates. NaN fails the comparison.
    let near = (value + 0.5_f64.copysign(value)) as i64;
    let limit = MAX_WHOLE_NUMBER as i64;
    let off = (value - near as f64).abs();
    (off <= 1e-9 * value.abs().max(1.0) && (-limit..=limit).contains(&near)).then_some(near)
}

/// The same for whole numbers from 0 to `u32::MAX`.
#[must_use]
#[inline]
pub(crate) fn whole_u32(value: f64) -> Option<u32> {
    whole_number(value).and_then(|value| u32::try_from(value).ok())
}

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    Eq,
    Ne,
    Gt,
    Lt,
    Ge,
    Le,
}

impl Comparison {
    /// Whether it is true of two numbers; they are equal as in [`equal`].
    pub fn holds(self, a: f64, b: f64) -> bool {
        let equals = equal(a, b);
        match self {
            Self::Eq => equals,
            Self::Ne => !equals,
            Self::Gt => a > b && !equals,
            Self::Lt => a < b && !equals,
            Self::Ge => a > b || equals,
            Self::Le => a < b || equals,
        }
    }
}

pub(crate) fn square_root(value: f64) -> Option<f64> {
    (value >= 0.0).then(|| value.sqrt())
}

/// Sine of an angle in degrees, exact at multiples of 90°.
pub(crate) fn sin_degrees(degrees: f64) -> f64 {
    let turned = degrees % 360.0;
    match whole_number(turned).filter(|whole| whole % 90 == 0).map(|whole| whole.rem_euclid(360)) {
        Some(90) => 1.0,
        Some(270) => -1.0,
        Some(_) => 0.0,
        None => turned.to_radians().sin(),
    }
}

fn clamp_to_unit(value: f64) -> Option<f64> {
    // Rounding may make a quotient of equal lengths slightly greater than 1.
    (value.abs() <= 1.0 + 1e-9).then(|| value.clamp(-1.0, 1.0))
}

/// Converts BCD (four bits per decimal digit) to a number.
pub(crate) fn from_bcd(value: f64) -> Option<f64> {
    let value = whole_number(value).filter(|value| *value >= 0)?;
    let mut result = 0;
    for place in (0..13).rev() {
        let digit = (value >> (4 * place)) & 15;
        if digit > 9 {
            return None;
        }
        result = result * 10 + digit;
    }
    Some(result as f64)
}

/// Converts a number to BCD (four bits per decimal digit).
pub(crate) fn to_bcd(value: f64) -> Option<f64> {
    let mut value = whole_number(value).filter(|value| (0..10_000_000_000_000).contains(value))?;
    let mut result = 0;
    for place in 0..13 {
        result |= (value % 10) << (4 * place);
        value /= 10;
    }
    Some(result as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b3_eq_is_within_a_billionth_of_the_larger() {
        assert!(equal(0.1 + 0.2, 0.3) && equal(0.1 + 0.2 - 0.3, 0.0) && equal(1e6, 1e6 + 5e-4));
        assert!(!equal(1e6, 1e6 + 5e-3) && !equal(0.001, 0.001_000_01) && !equal(0.0, 1e-9));
    }

    #[test]
    fn b3_whole_numbers_are_recognised_through_rounding() {
        for (value, found) in [(2.0, Some(2)), (-2.0, Some(-2)), (2.0 - 1e-12, Some(2)), (-0.0, Some(0)), (2.5, None)] {
            assert_eq!(whole_number(value), found, "{value}");
        }
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 0.5, -0.5, 1e-3] {
            assert_eq!(whole_number(value), None, "{value}");
        }
    }
}
