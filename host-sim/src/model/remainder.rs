//! What a model left of the log that it was identified on.

use crate::diagnostic::Diagnostic;
use crate::toml_reader::{Bounds, Table};

/// What no effect of the catalogue explained when a model was identified: a process of its own, beyond the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// Root mean square (N).
    pub rms_n: f64,
    /// How long (s) it stays what it is: the time of one independent value.
    pub correlation_s: f64,
    /// The corner (Hz) of the low-pass that forces went through; `None` without one.
    pub bandwidth_hz: Option<f64>,
}

impl Remainder {
    /// The `[remainder]` of a model file.
    pub(super) fn from_table(table: &Table<'_>) -> Result<Remainder, Diagnostic> {
        table.understand(&["rms", "correlation_time", "bandwidth"]);
        let remainder = Remainder {
            rms_n: table.required_number("rms", Bounds::Positive)?,
            correlation_s: table.required_number("correlation_time", Bounds::Positive)?,
            bandwidth_hz: table.number("bandwidth", Bounds::Positive)?,
        };
        table.finish()?;
        Ok(remainder)
    }
}
