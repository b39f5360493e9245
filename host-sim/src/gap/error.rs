//! How well a fit's numbers are known.
//!
//! C = H⁻¹·max(1, misfit²)·τ, H = JᵀWJ, τ the blocks per independent residual; and the sandwich
//! H⁻¹MH⁻¹ with Newey & West's M, which counts what neighbours repeat. The larger variance of both,
//! and that of the positions at rest: while the probe holds still the encoder's error is one number,
//! and no hold averages it (0.3 µm at 10⁴ N/m are 3 mN, against 0.2 mN of white noise after 2 s).

use std::ops::Range;

use super::fit::{Fit, Problem, forces, forces_moved};
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
    let rests = rests(problem, fit, &used);
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
            // What a newton at every sample does to this number alone: one series, not n² of them.
            let per_n: Vec<f64> = used
                .iter()
                .map(|at| {
                    let slope: f64 = (0..n)
                        .map(|k| inverse[own * n + k] * linear.columns[k][*at])
                        .sum();
                    slope * problem.weights[*at]
                })
                .collect();
            let each = per_n.iter().zip(&used);
            let influence: Vec<f64> = each.map(|(own, at)| own * linear.residuals[*at]).collect();
            let sandwich = long_run(&influence, lags);
            let plain = inverse[own * n + own] * misfit.max(1.0);
            let at_rest: f64 = rests
                .iter()
                .map(|(samples, error_n)| {
                    let sum: f64 = samples
                        .clone()
                        .map(|at| per_n[at] * error_n[at - samples.start])
                        .sum();
                    sum * sum
                })
                .sum();
            let size = (plain.max(sandwich).max(0.0) + at_rest).sqrt();
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

/// The rests, as places among the `used` samples, and the force (N) that one standard deviation of the
/// position makes there.
pub(super) fn rests(
    problem: &Problem<'_>,
    fit: &Fit,
    used: &[usize],
) -> Vec<(Range<usize>, Vec<f64>)> {
    let here = forces(&fit.shape, &fit.numbers, problem.courses);
    let there = forces_moved(&fit.shape, &fit.numbers, problem.courses, |course| {
        let error_m = course.position_noise_m;
        course.position_m.iter_mut().for_each(|x| *x += error_m);
    });
    let position: Vec<f64> = problem
        .courses
        .iter()
        .flat_map(|course| course.position_m.iter().copied())
        .collect();
    let mut from = 0;
    let stays: Vec<usize> = used
        .chunk_by(|a, b| b - a == 1 && position[*a] == position[*b])
        .map(<[usize]>::len)
        .collect();
    stays
        .into_iter()
        .map(|count| {
            from += count;
            from - count..from
        })
        .filter(|samples| samples.len() > 2)
        .map(|samples| {
            let error = |at: usize| there[used[at]] - here[used[at]];
            (samples.clone(), samples.map(error).collect())
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
