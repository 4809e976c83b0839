//! Names of variables. There is one memory of common variables. SINUMERIK R parameters are its part from #600 on: they
//! are retained, shown and edited like all others. Source: spec B3, S1, S2.

use super::kind::{Dialect, Kind};

/// The common variable of R0.
const R_FIRST: u32 = 600;
/// Number of R parameters.
pub const R_COUNT: u32 = 300;

/// Whether a common variable is a switch: it takes 0 or 1 only (B3).
#[must_use]
pub const fn is_switch(variable: u32) -> bool {
    matches!(variable, 570..=579)
}

/// The common variable of R n; `None` if n is out of range.
#[must_use]
pub const fn variable_of_r(n: u32) -> Option<u32> {
    if n < R_COUNT { Some(R_FIRST + n) } else { None }
}

/// R62: the programs of the vertical grinder store their error number here (seed 002's table); 0 is no error.
const ERROR_FLAG: u32 = 62;

/// The variable in which programs of a kind store their error number; `None` if there is none.
#[must_use]
pub const fn error_variable(kind: Kind) -> Option<u32> {
    if kind.dialect().has_r_parameters() { variable_of_r(ERROR_FLAG) } else { None }
}

/// The name of a variable in a dialect.
#[must_use]
pub fn variable_name(number: u32, dialect: Dialect) -> String {
    let r = number.checked_sub(R_FIRST).filter(|n| *n < R_COUNT && dialect.has_r_parameters());
    r.map_or_else(|| format!("#{number}"), |n| format!("R{n}"))
}

/// The name of a variable on a kind of machine.
#[must_use]
pub fn variable_name_on(number: u32, kind: Kind) -> String {
    variable_name(number, kind.dialect())
}

/// The variable number of a name: `#500`, `R18`.
#[must_use]
pub fn parse(word: &str) -> Option<u16> {
    let digits = |rest: &str| rest.parse::<u16>().ok().filter(|_| rest.bytes().all(|byte| byte.is_ascii_digit()));
    if let Some(rest) = word.strip_prefix('#') {
        return digits(rest);
    }
    let n = word.strip_prefix(['R', 'r']).and_then(digits)?;
    variable_of_r(u32::from(n)).map(|number| number as u16)
}
