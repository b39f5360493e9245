//! Standard errors of the numbers of a fit.
//!
//! The noise contributes the largest of three variances: C = H⁻¹·max(1, misfit²) with H = JᵀWJ; the
//! sandwich H⁻¹MH⁻¹ with Newey and West's M, which counts what neighbours repeat; and what noise with
//! the spectrum of the residuals makes of each number (`coloured`). Three contributions are added. One is
//! half of the bias that the errors of speed and acceleration give the number (see `attenuation`; their
//! variance is known to a factor of about two). One comes from the positions at rest: while the
//! probe holds still the encoder's error is one number, and no hold averages it (0.3 µm at 10⁴ N/m are 3
//! mN, against 0.2 mN of white noise after 2 s). And one is what the sensors are good for at best (`sensor`).

use std::ops::Range;

use estimator_core::physics::effect::{ChainStage, Repeats};
use rayon::prelude::*;

use crate::gap::model::{
    attenuation::bias, fit::Fit, fit::RIDGE, problem::Linearization, problem::Problem,
    sensor::errors_n, shape::Owner, simulate::forces, simulate::forces_of_changed,
};
use crate::gap::noise::coloured::ResidualSpectrum;
use crate::lsq::basis::{add_column, dot};
use crate::lsq::covariance::{inverse, long_run_variance};
use crate::stats::correlation;

/// Fewest lags of the sandwich: within a window of `kinematics` the errors of speed and acceleration are the
/// same ones. It has 31 samples at 1 kHz; 20 s at 5 kHz are fitted at every fourth sample, of which it has 38.
const FEWEST_LAGS: usize = 40;
/// Most lags of the sandwich.
const MOST_LAGS: usize = 100;
/// The share of the bias that is not known.
const UNKNOWN_BIAS: f64 = 0.5;

/// Standard errors of the free numbers of a fit, in the units of the parameters; `None` at a bound.
pub(crate) fn std_errors(problem: &Problem<'_>, fit: &Fit) -> Vec<Option<f64>> {
    std_errors_holding(problem, fit, &fit.at_bound())
}

/// The same where only some numbers are held: how well a size is known that is 0, since it may not be less.
pub(crate) fn std_errors_holding(
    problem: &Problem<'_>,
    fit: &Fit,
    held: &[bool],
) -> Vec<Option<f64>> {
    let n = fit.numbers.len();
    let linear = problem.linearize(&fit.shape, &fit.numbers);
    let normal = problem.normal_equations(&linear);
    let Some(inverse) = inverse(&normal.curvature, held, RIDGE) else {
        return vec![None; n];
    };
    let residuals = ResidualStatistics::new(problem, fit, &linear, held);
    let bias = bias(problem, fit);
    (0..n)
        .into_par_iter()
        .map(|at| {
            if held[at] {
                return None;
            }
            let row = &inverse[at * n..(at + 1) * n];
            // What a newton at every sample does to this number alone: one series, not n² of them.
            let influence = residuals.influence(problem, &linear, row);
            let noise = residuals.noise_variance(problem, &linear, &influence, row[at]);
            let variance = noise
                + residuals.rest_variance(&influence)
                + residuals.sensor_variance(&influence)
                + (UNKNOWN_BIAS * bias[at]).powi(2);
            let scale = match fit.shape.free[at].logarithmic {
                true => fit.shape.natural(at, fit.numbers[at]),
                false => 1.0,
            };
            let error = (variance.sqrt() * scale).hypot(smoothing_error(problem, fit, at));
            // One that is as large as all that the number may be says that the log does not determine it: a neck that no
            // sample sees had ± 7·10¹⁵³ m.
            Some(error).filter(|error| error.is_finite() && *error < fit.shape.room(at))
        })
        .collect()
}

/// The standard error that smoothing the positions gives the amplitude of an encoder's ripple; 0 for
/// another number. Windows that stay within a count of 1 µm (0.29 µm, one standard deviation) took 0.15
/// to 0.4 µm off it.
fn smoothing_error(problem: &Problem<'_>, fit: &Fit, at: usize) -> f64 {
    let is_ripple = |number: usize| {
        let facts = fit.shape.terms[number].id.info();
        facts.stage == ChainStage::PositionReading && facts.repeats == Repeats::AlongTheWay
    };
    match fit.shape.free[at].owner {
        Owner::Effect(number, 0) if is_ripple(number) => {
            let each = problem.logs.iter().map(|log| log.position_noise_m);
            each.fold(0.0, f64::max)
        }
        _ => 0.0,
    }
}

/// The residuals of a fit, and what they say of the noise.
struct ResidualStatistics {
    /// The samples with a weight.
    used: Vec<usize>,
    /// Σ w r² for each degree of freedom.
    misfit: f64,
    /// Lags of the sandwich.
    lags: usize,
    spectrum: ResidualSpectrum,
    /// The rests, as places in `used`, and the force (N) that an error of the position makes there.
    rests: Vec<(Range<usize>, Vec<f64>)>,
    /// The forces (N) that the sensors are off by at each of `used`, by one standard deviation.
    sensors: [Vec<f64>; 2],
}

impl ResidualStatistics {
    fn new(
        problem: &Problem<'_>,
        fit: &Fit,
        linear: &Linearization,
        held: &[bool],
    ) -> ResidualStatistics {
        let used = problem.used();
        let weighted = |channel: &[f64]| -> Vec<f64> {
            let each = used.iter();
            each.map(|at| problem.weights[*at].sqrt() * channel[*at])
                .collect()
        };
        let white = weighted(&linear.residuals);
        let mut fitted = Vec::new();
        for (column, _) in linear.columns.iter().zip(held).filter(|(_, held)| !**held) {
            add_column(&mut fitted, weighted(column), &[]);
        }
        let here = forces(&fit.shape, &fit.numbers, problem.logs);
        let sensors = errors_n(problem.logs, &here);
        let freedom = white.len().saturating_sub(fit.numbers.len()).max(1) as f64;
        ResidualStatistics {
            misfit: white.iter().map(|r| r * r).sum::<f64>() / freedom,
            lags: ((3.0 * correlation(&white)).ceil() as usize)
                .clamp(FEWEST_LAGS, MOST_LAGS)
                .min(used.len() / 8),
            spectrum: ResidualSpectrum::of(&white, &fitted),
            rests: rests(problem, fit, &used),
            sensors: sensors.map(|error| used.iter().map(|at| error[*at]).collect()),
            used,
        }
    }

    /// What a newton at each used sample does to a number whose row of the inverse curvature is given.
    fn influence(&self, problem: &Problem<'_>, linear: &Linearization, row: &[f64]) -> Vec<f64> {
        let of_sample = |at: &usize| {
            let columns = row.iter().zip(&linear.columns);
            let slope: f64 = columns.map(|(inverse, column)| inverse * column[*at]).sum();
            slope * problem.weights[*at]
        };
        self.used.iter().map(of_sample).collect()
    }

    /// The variance that the noise gives a number: the largest of white noise with the misfit, of what
    /// neighbours repeat, and of noise with the spectrum of the residuals.
    fn noise_variance(
        &self,
        problem: &Problem<'_>,
        linear: &Linearization,
        influence: &[f64],
        inverse: f64,
    ) -> f64 {
        let each = || influence.iter().zip(&self.used);
        let terms: Vec<f64> = each()
            .map(|(influence, at)| influence * linear.residuals[*at])
            .collect();
        let white_influence = each().map(|(influence, at)| influence / problem.weights[*at].sqrt());
        let coloured = self
            .spectrum
            .variance(&white_influence.collect::<Vec<f64>>());
        let plain = inverse * self.misfit.max(1.0);
        let repeated = long_run_variance(&terms, self.lags);
        plain.max(repeated).max(coloured)
    }

    /// The variance that the errors of the positions at rest give a number.
    fn rest_variance(&self, influence: &[f64]) -> f64 {
        let each = self.rests.iter();
        each.map(|(samples, error_n)| dot(&influence[samples.clone()], error_n).powi(2))
            .sum()
    }

    /// The variance that errors of the sensors give a number, which are the same in every sample.
    fn sensor_variance(&self, influence: &[f64]) -> f64 {
        let each = self.sensors.iter();
        each.map(|error_n| dot(influence, error_n).powi(2)).sum()
    }
}

/// The rests, as places in `used`, and the force (N) that one standard deviation of the position makes
/// there.
pub(crate) fn rests(
    problem: &Problem<'_>,
    fit: &Fit,
    used: &[usize],
) -> Vec<(Range<usize>, Vec<f64>)> {
    let here = forces(&fit.shape, &fit.numbers, problem.logs);
    let there = forces_of_changed(&fit.shape, &fit.numbers, problem.logs, |log| {
        let error_m = log.position_noise_m;
        log.position_m.iter_mut().for_each(|x| *x += error_m);
    });
    let position: Vec<f64> = problem
        .logs
        .iter()
        .flat_map(|log| log.position_m.iter().copied())
        .collect();
    let mut from = 0;
    // Samples that are missing do not end a rest: four parts of one hold have no four errors.
    let stays: Vec<usize> = used
        .chunk_by(|a, b| position[*a] == position[*b])
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
