//! Residuals of a fit on a column that is no parameter of it, after everything that the parameters can do is taken off.

use super::fit::{Problem, of_size};
use crate::lsq::{covariance::inverse, covariance::long_run_variance};
use crate::stats::correlation;

/// Lags of the variance of a sum, in correlation times.
const LAGS: f64 = 3.0;
/// Fewest block means to tell a lateness from.
const FEWEST_NODES: usize = 40;

/// A regression of the residuals on a column.
pub(super) struct Regression {
    pub(super) slope: f64,
    pub(super) std_error: f64,
}

impl Problem<'_> {
    /// The residuals on a column (a value per node that counts), after what the parameters can do; `alike` is what of
    /// them (N) may be alike in every touch.
    pub(super) fn regression(
        &self,
        free: &[f64],
        column: &[f64],
        alike: &[f64],
    ) -> Option<Regression> {
        of_size!(self, regression_of(free, column, alike))
    }

    fn regression_of<const N: usize>(
        &self,
        free: &[f64],
        column: &[f64],
        alike: &[f64],
    ) -> Option<Regression> {
        let mut rows: Vec<(f64, f64, [f64; N])> = Vec::with_capacity(column.len());
        self.gradients::<N>(free, |_, weight, residual, gradient| {
            rows.push((weight.sqrt(), residual, *gradient));
        });
        if rows.len() < FEWEST_NODES {
            return None;
        }
        let fixed: [bool; N] = std::array::from_fn(|i| self.fixed.contains(&i));
        let inverse = inverse(&self.normal(free).curvature, &fixed, 1e-13)?;
        let mut both = [0.0; N];
        for ((root, _, gradient), value) in rows.iter().zip(column) {
            for (sum, slope) in both.iter_mut().zip(gradient) {
                *sum += root * root * slope * value;
            }
        }
        let carried: [f64; N] =
            std::array::from_fn(|i| (0..N).map(|j| inverse[i * N + j] * both[j]).sum());
        let left = rows.iter().zip(column).map(|((root, _, gradient), value)| {
            let by_parameters: f64 = gradient.iter().zip(&carried).map(|(a, b)| a * b).sum();
            root * (value - by_parameters)
        });
        let left: Vec<f64> = left.collect();
        let square: f64 = left.iter().map(|own| own * own).sum();
        let residuals: Vec<f64> = rows
            .iter()
            .map(|(root, residual, _)| root * residual)
            .collect();
        let terms: Vec<f64> = left.iter().zip(&residuals).map(|(a, b)| a * b).collect();
        let slope = terms.iter().sum::<f64>() / square;
        let lags = ((LAGS * correlation(&residuals)) as usize).clamp(4, terms.len() / 4);
        let chi_2: f64 = residuals.iter().map(|own| own * own).sum();
        let white = (chi_2 / rows.len().saturating_sub(N + 1).max(1) as f64).max(1.0) * square;
        let variance = long_run_variance(&terms, lags).max(white);
        let each = rows.iter().zip(&left).zip(alike);
        let alike: f64 = each
            .map(|(((root, ..), left), force_n)| (root * left * force_n).abs())
            .sum();
        let found = Regression {
            slope,
            std_error: variance.sqrt().hypot(alike) / square,
        };
        (found.slope.is_finite() && found.std_error.is_finite()).then_some(found)
    }
}
