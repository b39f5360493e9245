//! The logs of one rig at one resolution, with all that is known of them without a model.

use crate::gap::data::{fit_data::FitData, low_pass::LowPass, scales::Scales};
use crate::gap::model::{
    fit::Fit, known::Known, problem::Problem, weights::variances, weights::weights,
};
use crate::gap::noise::floor::NoiseFloor;
use crate::gap::thresholds::Thresholds;

/// The logs that search, decision and experiments share.
#[derive(Clone, Copy)]
pub(crate) struct Dataset<'a> {
    pub(crate) logs: &'a [FitData],
    /// The noise floor of each log.
    pub(crate) floors: &'a [NoiseFloor],
    /// The low-pass that the forces of the logs have been through, and that predictions go through.
    pub(crate) low_pass: Option<LowPass>,
    pub(crate) scales: &'a Scales,
    /// What is known of the base's numbers beside the logs.
    pub(crate) known: Option<&'a Known>,
    /// What decides.
    pub(crate) thresholds: &'a Thresholds,
}

impl<'a> Dataset<'a> {
    /// The least-squares problem with these weights.
    pub(crate) fn problem(&self, weights: &'a [f64]) -> Problem<'a> {
        Problem {
            logs: self.logs,
            weights,
            low_pass: self.low_pass,
            known: self.known,
        }
    }

    /// The variances (N²) that the residuals of a fit should have.
    pub(crate) fn variances(&self, fit: &Fit) -> Vec<f64> {
        variances(fit, self.logs, self.floors, self.low_pass)
    }

    /// The weights (1/N²) of the residuals of a fit.
    pub(crate) fn weights(&self, fit: &Fit) -> Vec<f64> {
        weights(&self.variances(fit))
    }
}
