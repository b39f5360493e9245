//! The residuals of one log, with the motion that sorts them.

use crate::gap::data::fit_data::FitData;

/// The residuals of one log with what is needed to sort them.
pub(crate) struct LogResiduals<'a> {
    pub(crate) log: &'a FitData,
    /// Penetration (m).
    pub(crate) depth_m: &'a [f64],
    /// Residuals (N).
    pub(crate) residuals: &'a [f64],
    /// The variances (N²) that the residuals should have; 0 where they say nothing.
    pub(crate) variances: &'a [f64],
}
