//! Errors of a configuration, which say what would be right.

use core::fmt;

/// The error that a field of [`crate::Config`] cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConfigError {
    /// Path of the field from `Config`, such as `forgetting.alpha_1`.
    pub field: &'static str,
    /// Value of the field.
    pub value: f32,
    /// What would be right.
    pub expected: &'static str,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}: {}", self.field, self.value, self.expected)
    }
}

impl core::error::Error for ConfigError {}

/// Gives the error that names the field unless `good`, which must be false for NaN.
pub(crate) fn require(
    good: bool,
    field: &'static str,
    value: f32,
    expected: &'static str,
) -> Result<(), ConfigError> {
    if good {
        Ok(())
    } else {
        Err(ConfigError {
            field,
            value,
            expected,
        })
    }
}

/// Returns the error of the first row whose condition is false: condition, field, value, what would be right.
macro_rules! require_each {
    ($($good:expr, $field:expr, $value:expr, $expected:expr;)+) => {
        $(crate::estimate::error::require($good, $field, $value, $expected)?;)+
    };
}
pub(crate) use require_each;
