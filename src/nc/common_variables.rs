//! The common variables #100–#433 and #500–#999. Source: spec B3, K7.5.

use crate::defs::variable_name::is_switch;

/// The highest common variable.
const LAST_NUMBER: usize = 999;

/// The reason why a variable cannot be read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VariableError {
    /// No common variable has this number.
    #[error("there is no common variable #{0}")]
    Unknown(u32),
    /// #570–#579 take 0 or 1.
    #[error("variable #{0} must be 0 or 1")]
    Switch(u32),
    /// Infinite or not a number.
    #[error("the value for #{0} is not a number")]
    NotFinite(u32),
}

/// The common variables. A variable without a value is null.
#[derive(Debug)]
pub struct CommonVariables {
    // Null is stored as NaN; `set` refuses NaN as a value.
    values: Box<[f64]>,
}

impl Default for CommonVariables {
    fn default() -> Self {
        Self { values: vec![f64::NAN; LAST_NUMBER + 1].into_boxed_slice() }
    }
}

impl Clone for CommonVariables {
    fn clone(&self) -> Self {
        Self { values: self.values.clone() }
    }

    /// Takes over all values in place.
    fn clone_from(&mut self, other: &Self) {
        self.values.copy_from_slice(&other.values);
    }
}

impl CommonVariables {
    /// Whether a number is a common variable: 100–433 and 500–999.
    #[must_use]
    pub const fn contains(number: u32) -> bool {
        matches!(number, 100..=433 | 500..=999)
    }

    /// Whether a variable is retained over power-off: 200–433 and 500–999.
    #[must_use]
    pub const fn is_retained(number: u32) -> bool {
        matches!(number, 200..=433 | 500..=999)
    }

    /// The value of a variable, `None` for null.
    ///
    /// # Errors
    /// [`VariableError::Unknown`] outside 100–433 and 500–999.
    pub fn get(&self, number: u32) -> Result<Option<f64>, VariableError> {
        if !Self::contains(number) {
            return Err(VariableError::Unknown(number));
        }
        Ok(self.values.get(number as usize).copied().filter(|value| !value.is_nan()))
    }

    /// Sets a variable; `None` is null.
    ///
    /// # Errors
    /// [`VariableError::Unknown`] outside the ranges; [`VariableError::Switch`] for values other than 0 and 1 in
    /// 570–579 (also null); [`VariableError::NotFinite`]. The variable is then unchanged.
    pub fn set(&mut self, number: u32, value: Option<f64>) -> Result<(), VariableError> {
        let place = match self.values.get_mut(number as usize) {
            Some(place) if Self::contains(number) => place,
            _ => return Err(VariableError::Unknown(number)),
        };
        match value {
            Some(value) if !value.is_finite() => return Err(VariableError::NotFinite(number)),
            Some(0.0 | 1.0) => {}
            Some(_) | None if is_switch(number) => return Err(VariableError::Switch(number)),
            Some(_) | None => {}
        }
        *place = value.unwrap_or(f64::NAN);
        Ok(())
    }

    /// All variables with a value, by number.
    pub fn iter(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.values
            .iter()
            .enumerate()
            .filter(|(_, value)| !value.is_nan())
            .map(|(number, value)| (number as u32, *value))
    }
}
