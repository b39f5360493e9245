//! What the errors of a fit's numbers make of its predictions.
//!
//! A fit to two thirds of a log has numbers that are off by their standard errors, and the last third shows it.
//! With ten numbers, five holds deep enough to tell and an encoder's error of 6 mN in each, the held-out holds were off
//! by 12 mN though every effect was right.

use crate::gap::model::{
    error::rests, fit::Fit, fit::RIDGE, problem::Linearization, problem::Problem,
};
use crate::lsq::covariance::inverse;

/// Σ w Var(predicted force) over held-out samples, of a fit to the others. `correlation` is the number of samples for
/// each independent residual.
pub(super) fn prediction_variance(
    training: &Problem<'_>,
    all: &Problem<'_>,
    fit: &Fit,
    held_out: &[bool],
    correlation: f64,
) -> f64 {
    let linear = training.linearize(&fit.shape, &fit.numbers);
    let curvature = training.normal_equations(&linear).curvature;
    let Some(inverse) = inverse(&curvature, &fit.at_bound(), RIDGE) else {
        return 0.0;
    };
    let weights: Vec<f64> = all
        .weights
        .iter()
        .zip(held_out)
        .map(|(w, out)| if *out { *w } else { 0.0 })
        .collect();
    let predicted = Problem {
        weights: &weights,
        ..*all
    };
    let predicted = predicted.normal_equations(&linear).curvature;
    let n = fit.numbers.len();
    let of_noise: f64 = inverse.iter().zip(&predicted).map(|(a, b)| a * b).sum();
    let product = |matrix: &[f64], vector: &[f64]| -> Vec<f64> {
        let rows = matrix.chunks(n.max(1));
        let dot = |row: &[f64]| row.iter().zip(vector).map(|(a, b)| a * b).sum();
        rows.map(dot).collect()
    };
    let of_rest = |pull: Vec<f64>| -> f64 {
        let moved = product(&inverse, &pull);
        let seen = product(&predicted, &moved);
        moved.iter().zip(&seen).map(|(a, b)| a * b).sum()
    };
    let of_rests: f64 = pulls(training, fit, &linear).map(of_rest).sum();
    correlation * of_noise + of_rests
}

/// Jᵀ W e of each rest, where e is the force that one standard deviation of its position makes.
fn pulls(
    problem: &Problem<'_>,
    fit: &Fit,
    linear: &Linearization,
) -> impl Iterator<Item = Vec<f64>> {
    let weights = problem.weights;
    let used: Vec<usize> = (0..weights.len()).filter(|at| weights[*at] > 0.0).collect();
    let rests = rests(problem, fit, &used).into_iter();
    rests.map(move |(samples, error_n)| {
        let pull = |column: &Vec<f64>| {
            let each = used[samples.clone()].iter().zip(&error_n);
            each.map(|(at, error)| weights[*at] * column[*at] * error)
                .sum()
        };
        linear.columns.iter().map(pull).collect()
    })
}
