//! Why a machine or part file is refused.

/// Why a machine or part file is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimFileError {
    /// Syntax error; RON gives line and column.
    #[error("{0}")]
    Syntax(#[from] ron::error::SpannedError),
    /// A value is invalid.
    #[error("{field} is {value}: {rule}")]
    Value {
        /// Field, with the number of the surface if there are several.
        field: String,
        /// The invalid value.
        value: f64,
        /// The rule that is violated.
        rule: &'static str,
    },
    /// Two settings contradict each other.
    #[error("{what}: {rule}")]
    Incompatible {
        /// The setting at fault.
        what: String,
        /// The rule that is violated.
        rule: &'static str,
    },
}

/// Refuses a value of a field.
pub(super) fn refuse_value(field: impl Into<String>, value: f64, rule: &'static str) -> Result<(), SimFileError> {
    Err(SimFileError::Value { field: field.into(), value, rule })
}

/// Refuses a value that is not positive and finite.
pub(super) fn require_positive(field: &str, value: f64) -> Result<(), SimFileError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    refuse_value(field, value, "must be above zero")
}

/// Refuses a value that is negative or not finite.
pub(super) fn require_not_negative(field: &str, value: f64) -> Result<(), SimFileError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    refuse_value(field, value, "must not be below zero")
}

/// Refuses the first of some fields of a section that is not positive and finite.
macro_rules! require_positive_fields {
    ($name:expr, $section:expr; $($field:ident)+) => {
        [$((stringify!($field), $section.$field)),+].into_iter().try_for_each(|(field, value)| {
            $crate::io::sim::file_error::require_positive(&format!("{}.{field}", $name), value)
        })
    };
}
pub(super) use require_positive_fields;
