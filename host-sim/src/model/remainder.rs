//! What a model left of the log that it was identified on.

use crate::diagnostic::Diagnostic;
use crate::phase::PHASES;
use crate::toml_reader::{Bounds, Table};

/// What no effect of the catalogue explained when a model was identified, a process of its own, and the noise beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// Root mean square (N); 0 where the log was explained to its noise.
    pub rms_n: f64,
    /// The same in each phase of the contact that the log had: a bond that breaks leaves more than a hold.
    pub by_phase_n: [Option<f64>; PHASES.len()],
    /// Standard deviation (N) of the noise then, where the file says it.
    pub noise_n: Option<f64>,
    /// How long (s) it stays what it is: the time of one independent value.
    pub correlation_s: f64,
    /// The corner (Hz) of the low-pass that forces went through; `None` without one.
    pub bandwidth_hz: Option<f64>,
}

impl Remainder {
    /// The `[remainder]` of a model file.
    pub(super) fn from_table(table: &Table<'_>) -> Result<Remainder, Diagnostic> {
        table.understand(&["rms", "by_phase", "noise", "correlation_time", "bandwidth"]);
        let mut by_phase_n = [None; PHASES.len()];
        if let Some(own) = table.table("by_phase")? {
            for (name, rms_n) in PHASES.iter().zip(&mut by_phase_n) {
                *rms_n = own.number(name, Bounds::NotNegative)?;
            }
            own.finish()?;
        }
        let remainder = Remainder {
            rms_n: table.required_number("rms", Bounds::NotNegative)?,
            by_phase_n,
            noise_n: table.number("noise", Bounds::NotNegative)?,
            correlation_s: table.required_number("correlation_time", Bounds::Positive)?,
            bandwidth_hz: table.number("bandwidth", Bounds::Positive)?,
        };
        table.finish()?;
        Ok(remainder)
    }

    /// Root mean square (N) in a phase, by its place in [`PHASES`].
    pub(crate) fn rms_in_n(&self, phase: usize) -> f64 {
        self.by_phase_n[phase].unwrap_or(self.rms_n)
    }
}
