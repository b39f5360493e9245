//! A parameter as a fit has it.

/// A parameter with its standard error.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterEstimate {
    /// The key in model files.
    pub name: String,
    /// The value, in the unit of the model file.
    pub value: f64,
    /// Standard error; `None` for a parameter that was fixed, or that is at a bound.
    pub std_error: Option<f64>,
    /// Whether the fit would have gone beyond a bound.
    pub at_bound: bool,
    /// The unit as in reports.
    pub unit: &'static str,
}

impl ParameterEstimate {
    /// What a value means that the log does not show, in words: a rate of relaxation whose error is as large
    /// as itself may as well be 0.
    pub fn remark(&self) -> Option<&'static str> {
        let error = self.std_error?;
        let is_slow = self.unit == "1/s" && error >= self.value.abs();
        is_slow.then_some("slower than this log shows")
    }
}
