//! What is wrong with a configuration, said so that it can be put right.

use core::fmt;

/// A field of [`crate::Config`] that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigError {
    /// The field, as a path from `Config`: `forgetting.alpha_1`.
    pub field: &'static str,
    /// The value that it has.
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
/// Ok if `good`, else the error that names the field; NaN is never good.
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
