//! The functions of expressions. Angles are in degrees. `None`: the argument is outside the domain. Source: spec B3.

use super::expression::whole_number;

/// A function with one argument.
pub(crate) type Function = fn(f64) -> Option<f64>;

/// The functions by name. A name that begins with another name comes before it.
pub(crate) const FUNCTIONS: [(&str, Function); 16] = [
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
    ("ROUND", |a| Some(a.round())),
    ("FIX", |a| Some(a.trunc())),
    ("FUP", |a| Some(if a < 0.0 { a.floor() } else { a.ceil() })),
    ("LN", |a| (a > 0.0).then(|| a.ln())),
    ("EXP", |a| Some(a.exp())),
    ("BIN", from_bcd),
    ("BCD", to_bcd),
];

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
