//! The bounds that a program names for the values of its page, in the rows of its alarms: `(#3000=4 #511 GE 0 #511 LE 1000 …)`.
//! They are told before the start; the program itself decides, for some hold only with other values.
//! Source: spec K7.4, B8, H6.

use super::text::{Lang, Text};

/// Greatest magnitude of a value that is typed for a variable.
pub const TYPED_VALUE_LIMIT: f64 = 99_999.999;

/// Which side of a value is bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundSide {
    /// It must not be below.
    Least,
    /// It must not be above.
    Most,
}

/// What a value is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoundLimit {
    /// A number.
    Number(f64),
    /// The value of another variable; an empty one counts as 0.
    Variable(u16),
}

/// One bound of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueBound {
    /// The variable.
    pub variable: u16,
    /// Side.
    pub side: BoundSide,
    /// The limit itself is not allowed.
    pub is_strict: bool,
    /// Limit.
    pub limit: BoundLimit,
}

/// The range of a variable: each end with whether the end itself is excluded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ValueRange {
    /// Lower end.
    pub least: Option<(f64, bool)>,
    /// Upper end.
    pub most: Option<(f64, bool)>,
}

impl ValueRange {
    /// The narrowest range by all bounds of a variable, with the values as they are now.
    #[must_use]
    pub fn of(variable: u16, bounds: &[ValueBound], value_of: impl Fn(u16) -> Option<f64>) -> Self {
        let mut range = Self::default();
        for bound in bounds.iter().filter(|bound| bound.variable == variable) {
            let limit = match bound.limit {
                BoundLimit::Number(number) => number,
                BoundLimit::Variable(other) => value_of(other).unwrap_or(0.0),
            };
            let (end, sign) = match bound.side {
                BoundSide::Least => (&mut range.least, 1.0),
                BoundSide::Most => (&mut range.most, -1.0),
            };
            let is_narrower = end.is_none_or(|(known, strict)| {
                let by = (limit - known) * sign;
                by > 0.0 || by.abs() <= 0.0 && bound.is_strict && !strict
            });
            if is_narrower {
                *end = Some((limit, bound.is_strict));
            }
        }
        range
    }

    /// Whether nothing is bounded.
    #[must_use]
    pub const fn is_free(&self) -> bool {
        self.least.is_none() && self.most.is_none()
    }

    /// Whether a value is within the range.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        let above = |(least, strict): (f64, bool)| if strict { value > least } else { value >= least };
        let below = |(most, strict): (f64, bool)| if strict { value < most } else { value <= most };
        self.least.is_none_or(above) && self.most.is_none_or(below)
    }

    /// `0 … 1000`, `> 0`, `> 0, ≤ 0.05`; empty if nothing is bounded.
    #[must_use]
    pub fn words(&self, lang: Lang) -> String {
        let end =
            |strict: bool, signs: [&str; 2], limit: f64| format!("{} {}", signs[usize::from(strict)], short(limit));
        let comma = Text::new("，", ", ").get(lang);
        match (self.least, self.most) {
            (Some((least, false)), Some((most, false))) => format!("{} … {}", short(least), short(most)),
            (least, most) => {
                let least = least.map(|(limit, strict)| end(strict, ["≥", ">"], limit));
                let most = most.map(|(limit, strict)| end(strict, ["≤", "<"], limit));
                least.into_iter().chain(most).collect::<Vec<_>>().join(comma)
            }
        }
    }
}

/// A limit with at most four decimals, without zeros behind them.
fn short(limit: f64) -> String {
    let text = format!("{limit:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
