//! How well a fit's numbers are known.
//!
//! The noise gives the largest variance of three: C = H⁻¹·max(1, misfit²), H = JᵀWJ; the sandwich
//! H⁻¹MH⁻¹ with Newey & West's M, which counts what neighbours repeat; and what noise of the residuals'
//! spectrum makes of each number (`coloured`). To that come half of what the errors of speed and acceleration have
//! done to the number (see `attenuation`: their variance is known to a factor of about two), and the positions
//! at rest: while the probe holds still the encoder's error is one number, and no hold averages it (0.3 µm at
//! 10⁴ N/m are 3 mN, against 0.2 mN of white noise after 2 s).

use std::ops::Range;

use estimator_core::physics::effect::EffectId;

use crate::gap::model::attenuation::bias;
use crate::gap::model::basis::extend;
use crate::gap::model::covariance::{inverse, stuck};
use crate::gap::model::fit::{Fit, Linear, Problem, forces, forces_moved};
use crate::gap::model::shape::Owner;
use crate::gap::noise::coloured::Coloured;
use crate::stats::correlation;

/// Fewest and most lags of the sandwich. Within a window of `kinematics`, 31 samples at most, the errors of
/// speed and acceleration are the same ones.
const FEWEST_LAGS: usize = 31;
const MOST_LAGS: usize = 100;
/// Share of the motion's errors' effect that is not known.
const UNKNOWN: f64 = 0.5;

/// Standard errors of a fit's free numbers, in the parameters' own units; `None` at a bound.
pub(in crate::gap) fn std_errors(problem: &Problem<'_>, fit: &Fit) -> Vec<Option<f64>> {
    let n = fit.numbers.len();
    let linear = problem.linear(&fit.shape, &fit.numbers);
    let (curvature, _) = problem.normal(&linear);
    let stuck = stuck(fit);
    let Some(inverse) = inverse(&curvature, &stuck, n) else {
        return vec![None; n];
    };
    let left = Left::new(problem, fit, &linear, &stuck);
    let bias = bias(problem, fit);
    (0..n)
        .map(|own| {
            if stuck[own] {
                return None;
            }
            // What a newton at every sample does to this number alone: one series, not n² of them.
            let per_n: Vec<f64> = left
                .used
                .iter()
                .map(|at| {
                    let slope: f64 = (0..n)
                        .map(|k| inverse[own * n + k] * linear.columns[k][*at])
                        .sum();
                    slope * problem.weights[*at]
                })
                .collect();
            let noise = left.noise(problem, &linear, &per_n, inverse[own * n + own]);
            let variance = noise + left.at_rest(&per_n) + (UNKNOWN * bias[own]).powi(2);
            let natural = fit.shape.natural(own, fit.numbers[own]);
            let scale = if fit.shape.free[own].logarithmic {
                natural
            } else {
                1.0
            };
            let error = (variance.sqrt() * scale).hypot(smoothed(problem, fit, own));
            Some(error).filter(|error| error.is_finite())
        })
        .collect()
}

/// What smoothing the positions costs a number of theirs: a ripple of the encoder lost 0.15 to 0.4 µm of its
/// amplitude to windows that stay within a count of 1 µm (0.29 µm, one standard deviation).
fn smoothed(problem: &Problem<'_>, fit: &Fit, own: usize) -> f64 {
    let is_ripple = |number: usize| fit.shape.terms[number].id == EffectId::EncoderPeriodicError;
    match fit.shape.free[own].owner {
        Owner::Effect(number, 0) if is_ripple(number) => {
            let each = problem.courses.iter().map(|own| own.position_noise_m);
            each.fold(0.0, f64::max)
        }
        _ => 0.0,
    }
}

/// What a fit left, and what is to be known of it.
struct Left {
    /// The samples that count.
    used: Vec<usize>,
    misfit: f64,
    lags: usize,
    coloured: Coloured,
    rests: Vec<(Range<usize>, Vec<f64>)>,
}

impl Left {
    fn new(problem: &Problem<'_>, fit: &Fit, linear: &Linear, stuck: &[bool]) -> Left {
        let n = fit.numbers.len();
        let used: Vec<usize> = (0..problem.weights.len())
            .filter(|at| problem.weights[*at] > 0.0)
            .collect();
        let weighted = |channel: &[f64]| -> Vec<f64> {
            let each = used.iter();
            each.map(|at| problem.weights[*at].sqrt() * channel[*at])
                .collect()
        };
        let white = weighted(&linear.residuals);
        let mut taken = Vec::new();
        for (column, _) in linear.columns.iter().zip(stuck).filter(|own| !own.1) {
            extend(&mut taken, weighted(column), &[]);
        }
        let freedom = white.len().saturating_sub(n).max(1) as f64;
        Left {
            misfit: white.iter().map(|r| r * r).sum::<f64>() / freedom,
            lags: ((3.0 * correlation(&white)).ceil() as usize)
                .clamp(FEWEST_LAGS, MOST_LAGS)
                .min(used.len() / 8),
            coloured: Coloured::of(&white, &taken),
            rests: rests(problem, fit, &used),
            used,
        }
    }

    /// Variance that the residuals give a number: white, as neighbours repeat, as the spectrum says.
    fn noise(&self, problem: &Problem<'_>, linear: &Linear, per_n: &[f64], own: f64) -> f64 {
        let each = || per_n.iter().zip(&self.used);
        let influence: Vec<f64> = each()
            .map(|(own, at)| own * linear.residuals[*at])
            .collect();
        let per_one = each().map(|(own, at)| own / problem.weights[*at].sqrt());
        let coloured = self.coloured.variance(&per_one.collect::<Vec<f64>>());
        let plain = own * self.misfit.max(1.0);
        let repeated = long_run(&influence, self.lags);
        plain.max(repeated).max(coloured)
    }

    /// And the one that the positions at rest give it.
    fn at_rest(&self, per_n: &[f64]) -> f64 {
        let each = self.rests.iter().map(|(samples, error_n)| {
            let own = per_n[samples.clone()].iter().zip(error_n);
            own.map(|(own, error)| own * error).sum::<f64>().powi(2)
        });
        each.sum()
    }
}

/// The rests, as places among the `used` samples, and the force (N) that one standard deviation of the
/// position makes there.
pub(in crate::gap) fn rests(
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
