//! What the errors of a fit's numbers make of its predictions.
//!
//! A fit to two thirds of a log has numbers that are off by their standard errors, and the last third shows it.
//! With ten numbers, five holds deep enough to tell and an encoder's error of 6 mN in each, the held-out holds were off
//! by 12 mN though every effect was right.

use crate::gap::model::{
    error::rests, fit::Fit, fit::RIDGE, problem::Linearization, problem::Problem,
};
use crate::lsq::basis::dot;
use crate::lsq::covariance::inverse;
use crate::lsq::dense::{product, quadratic};

/// Σ w Var(predicted force) over the samples that are predicted, of a fit to others. `correlation` is the number of
/// samples for each independent residual.
pub(super) fn prediction_variance(
    training: &Problem<'_>,
    predicted: &Problem<'_>,
    fit: &Fit,
    correlation: f64,
) -> f64 {
    let mut linear = training.linearize(&fit.shape, &fit.numbers);
    let curvature = training.normal_equations(&linear).curvature;
    // What is known of the numbers is nothing that is predicted.
    linear.readings.clear();
    let Some(inverse) = inverse(&curvature, &fit.at_bound(), RIDGE) else {
        return 0.0;
    };
    let n = fit.numbers.len();
    let predicted = predicted.normal_equations(&linear).curvature;
    // H⁻¹ H' H⁻¹: what a pull on the numbers does to the predictions, squared.
    let seen = product(&product(&inverse, &predicted, n), &inverse, n);
    let of_rests = pulls(training, fit, &linear).map(|pull| quadratic(&seen, &pull));
    correlation * dot(&inverse, &predicted) + of_rests.sum::<f64>()
}

/// Jᵀ W e of each rest, where e is the force that one standard deviation of its position makes.
fn pulls(
    problem: &Problem<'_>,
    fit: &Fit,
    linear: &Linearization,
) -> impl Iterator<Item = Vec<f64>> {
    let (weights, used) = (problem.weights, problem.used());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::{fit_data::FitData, scales::Scales};
    use crate::gap::model::shape::Shape;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// Σ w Var of the predictions of every third of six presses with holds, of a stiffness and a surface
    /// that are fitted to the others, with an error of the position (m).
    fn variance(position_noise_m: f64, correlation: f64) -> f64 {
        let path = Path::new("model.toml");
        let text = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\n";
        let model = Model::from_toml(&TomlFile::parse(text.into(), path).unwrap(), path).unwrap();
        let time_s: Vec<f64> = (0..6000).map(|at| f64::from(at) * 1e-3).collect();
        let place = |t: &f64| 2e-3 * (3.0 * (std::f64::consts::TAU * t).sin()).clamp(-1.0, 1.0);
        let positions: Vec<f64> = time_s.iter().map(place).collect();
        let forces = positions.iter().map(|x| 1e3 * x.max(0.0)).collect();
        let log = Log::from_channels(time_s, positions, forces)
            .uniform()
            .unwrap();
        let mut logs = [FitData::of(&log)];
        logs[0].position_noise_m = position_noise_m;
        let shape = Shape::new(&model.environment, Vec::new(), &Scales::of(&logs));
        let weights = |is_out: bool| -> Vec<f64> {
            let each = (0..6000).map(|at| at / 1000 % 3 == 1);
            each.map(|out| if out == is_out { 1e4 } else { 0.0 })
                .collect()
        };
        let (training, predicted) = (weights(false), weights(true));
        let problem = |weights| Problem {
            logs: &logs,
            weights,
            low_pass: None,
            known: None,
        };
        let numbers = shape.start();
        let fit = problem(&training).fit(&shape, numbers);
        let (training, predicted) = (problem(&training), problem(&predicted));
        prediction_variance(&training, &predicted, &fit, correlation)
    }

    #[test]
    fn two_numbers_from_two_thirds_of_a_log_cost_the_last_one_half_of_two() {
        // H⁻¹ of two thirds times H of one third is half of the identity. The damping is 0, at its bound, and costs nothing.
        let alone = variance(0.0, 1.0);
        assert!((alone - 1.0).abs() < 0.01, "{alone}");
        // Noise of which every fourth sample is independent costs four times as much.
        assert!((variance(0.0, 4.0) / alone - 4.0).abs() < 1e-9);
    }

    #[test]
    fn one_error_of_position_in_each_hold_costs_more_than_noise_does() {
        // GIVEN 10 mN of noise and 5 µm of error at 1 N/mm, 5 mN in each of four holds of 400 samples THEN the mean of
        // their errors is 2.5 mN, as 1600 samples of 0.25 mN of noise have it, in two holds of 400.
        let more = variance(5e-6, 1.0) - variance(0.0, 1.0);
        assert!((25.0..80.0).contains(&more), "{more}");
    }
}
