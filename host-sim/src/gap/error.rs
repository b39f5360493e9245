//! How well a fit's numbers are known.
//!
//! C = H⁻¹·max(1, misfit²)·τ, H = JᵀWJ, τ the blocks per independent residual; and the sandwich
//! H⁻¹MH⁻¹ with Newey & West's M, which counts what neighbours repeat. The larger variance of both
//! is reported.

use super::fit::{Fit, Problem};
use crate::batch::error::correlation;
use crate::dense;

/// Most lags of the sandwich.
const MOST_LAGS: usize = 100;

/// Standard errors of a fit's free numbers, in the parameters' own units; `None` at a bound.
pub(super) fn std_errors(problem: &Problem<'_>, fit: &Fit) -> Vec<Option<f64>> {
    let n = fit.numbers.len();
    let linear = problem.linear(&fit.shape, &fit.numbers);
    let (curvature, _) = problem.normal(&linear);
    let stuck: Vec<bool> = fit
        .shape
        .free
        .iter()
        .zip(&fit.numbers)
        .map(|(free, number)| free.is_at_bound(*number))
        .collect();
    let Some(inverse) = inverse(&curvature, &stuck, n) else {
        return vec![None; n];
    };
    let used: Vec<usize> = (0..problem.weights.len())
        .filter(|at| problem.weights[*at] > 0.0)
        .collect();
    let white: Vec<f64> = used
        .iter()
        .map(|at| problem.weights[*at].sqrt() * linear.residuals[*at])
        .collect();
    let tau = correlation(&white);
    let misfit =
        white.iter().map(|r| r * r).sum::<f64>() / (white.len().saturating_sub(n).max(1)) as f64;
    let lags = ((3.0 * tau).ceil() as usize)
        .clamp(4, MOST_LAGS)
        .min(used.len() / 8);
    (0..n)
        .map(|own| {
            if stuck[own] {
                return None;
            }
            // The influence of every residual on this number alone: one series, not n² of them.
            let influence: Vec<f64> = used
                .iter()
                .zip(&white)
                .map(|(at, r)| {
                    let slope: f64 = (0..n)
                        .map(|k| inverse[own * n + k] * linear.columns[k][*at])
                        .sum();
                    slope * problem.weights[*at].sqrt() * r
                })
                .collect();
            let sandwich = long_run(&influence, lags);
            let plain = inverse[own * n + own] * misfit.max(1.0);
            let size = plain.max(sandwich).max(0.0).sqrt();
            let natural = fit.shape.natural(own, fit.numbers[own]);
            let scale = if fit.shape.free[own].logarithmic {
                natural
            } else {
                1.0
            };
            Some(size * scale).filter(|error| error.is_finite())
        })
        .collect()
}

/// Variance of a sum of correlated terms: Σ κ(l) Σ s(h)s(h−l), κ Bartlett's window.
fn long_run(terms: &[f64], lags: usize) -> f64 {
    (0..=lags)
        .map(|lag| {
            let both: f64 = terms.iter().zip(&terms[lag..]).map(|(a, b)| a * b).sum();
            let window = 1.0 - lag as f64 / (lags + 1) as f64;
            if lag == 0 { both } else { 2.0 * window * both }
        })
        .sum()
}

/// The inverse in units of the columns' sizes, numbers at a bound left out.
fn inverse(curvature: &[f64], stuck: &[bool], n: usize) -> Option<Vec<f64>> {
    let out = |at: usize| stuck[at] || curvature[at * n + at] <= 0.0;
    let size: Vec<f64> = (0..n)
        .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let mut scaled: Vec<f64> = (0..n * n)
        .map(|at| match (at / n, at % n) {
            (row, column) if row == column => 1.0 + 1e-12,
            (row, column) if out(row) || out(column) => 0.0,
            (row, column) => curvature[at] / (size[row] * size[column]),
        })
        .collect();
    let mut ridge = 1e-12;
    let factor = loop {
        match dense::cholesky(&scaled, n) {
            Some(factor) => break factor,
            None if ridge > 1e-3 => return None,
            None => {
                ridge *= 10.0;
                (0..n).for_each(|i| scaled[i * n + i] = 1.0 + ridge);
            }
        }
    };
    let mut inverse = dense::inverse(&factor, n);
    for (at, own) in inverse.iter_mut().enumerate() {
        *own /= size[at / n] * size[at % n];
    }
    Some(inverse)
}
