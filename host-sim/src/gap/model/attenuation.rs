//! The bias that the errors of speed and acceleration give the numbers, and the numbers without it.
//!
//! Errors in the variables bias least squares: a mass reads too small by σ_a²/⟨a²⟩, a friction turns
//! round over too wide a range of speeds. The bias grows with the variance, so that one more dose of the
//! error shows what the first has done: the first step of Cook and Stefanski's simulation–extrapolation
//! (JASA 89, 1994), with two points instead of random numbers. The gradient JᵀWr, averaged over the
//! motion moved by +σ and by −σ, is no longer zero, and the inverse curvature turns it into the bias.

use crate::gap::model::fit::{Fit, RIDGE};
use crate::gap::model::problem::Problem;
use crate::gap::model::weights::{with_acceleration_error, with_speed_error};
use crate::lsq::covariance::inverse;

/// How much too large the errors of the motion make the free numbers of a fit.
pub(crate) fn bias(problem: &Problem<'_>, fit: &Fit) -> Vec<f64> {
    let n = fit.numbers.len();
    let here = problem.normal_equations(&problem.linearize(&fit.shape, &fit.numbers));
    let at_bound = fit.at_bound();
    let Some(inverse) = inverse(&here.curvature, &at_bound, RIDGE) else {
        return vec![0.0; n];
    };
    let mut pull = vec![0.0; n];
    // Of the acceleration's error only the white part counts: what a window rounds off follows the
    // acceleration and attenuates nothing.
    for change in [with_speed_error, with_acceleration_error] {
        for sign in [1.0, -1.0] {
            let mut logs = problem.logs.to_vec();
            logs.iter_mut().for_each(|log| change(log, sign));
            let moved = Problem {
                logs: &logs,
                ..*problem
            };
            let there = moved.normal_equations(&moved.linearize(&fit.shape, &fit.numbers));
            let each = pull.iter_mut().zip(&there.downhill).zip(&here.downhill);
            each.for_each(|((pull, there), here)| *pull += 0.5 * (there - here));
        }
    }
    let row = |at: usize| (0..n).map(|k| inverse[at * n + k] * pull[k]).sum();
    (0..n)
        .map(|at| if at_bound[at] { 0.0 } else { row(at) })
        .collect()
}

/// The fit with its bias taken off, or the fit itself where that would cost more than this share of Σ w r².
pub(crate) fn corrected(problem: &Problem<'_>, fit: &Fit, largest_cost: f64) -> Fit {
    let mut corrected = fit.clone();
    let free = fit.shape.free.iter().zip(bias(problem, fit));
    for (number, (free, bias)) in corrected.numbers.iter_mut().zip(free) {
        *number = (*number - bias).clamp(free.lowest, free.highest);
    }
    corrected.cost = problem.cost(&corrected.shape, &corrected.numbers);
    let most = problem.cost(&fit.shape, &fit.numbers) * (1.0 + largest_cost);
    if corrected.cost <= most {
        corrected
    } else {
        fit.clone()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use estimator_core::physics::effect::{EffectId, MOST_PARAMETERS};

    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::gap::data::scales::Scales;
    use crate::gap::model::shape::Shape;
    use crate::gap::model::start::whole;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;

    /// A mass of 0.5 kg on 4 s at 1 kHz of 3 m/s² at 2 Hz that is known to σ (m/s²).
    fn mass(error_mps2: f64, seed: u64) -> (FitData, Scales) {
        let angle = |t: f64| 12.566 * t;
        let time: Vec<f64> = (0..4000).map(|at| f64::from(at) * 1e-3).collect();
        let position = time.iter().map(|t| -0.019 * angle(*t).sin()).collect();
        let force = time.iter().map(|t| 0.5 * 3.0 * angle(*t).sin()).collect();
        let log = Log::from_channels(time, position, force);
        let mut data = FitData::of(&log.uniform().unwrap());
        let mut state = seed;
        for (at, a) in data.acceleration_mps2.iter_mut().enumerate() {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            // Uniform of variance 1.
            let error = ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt();
            *a = 3.0 * angle(at as f64 * 1e-3).sin() + error_mps2 * error;
        }
        data.acceleration_noise_mps2.fill(error_mps2);
        let scales = Scales::of(std::slice::from_ref(&data));
        (data, scales)
    }

    /// The mass (kg) as it is fitted, and corrected.
    fn found(error_mps2: f64, seed: u64) -> (f64, f64) {
        let path = Path::new("model.toml");
        let file = TomlFile::parse("[environment]\nlaw = \"free\"\n".into(), path).unwrap();
        let model = Model::from_toml(&file, path).unwrap();
        let (data, scales) = mass(error_mps2, seed);
        let mut row = [0.0; MOST_PARAMETERS];
        row[0] = 0.3;
        let term = whole(EffectId::ToolInertia, row, 1);
        let shape = Shape::new(&model.environment, vec![term], &scales);
        let weights = vec![1.0; data.len()];
        let problem = Problem {
            logs: std::slice::from_ref(&data),
            weights: &weights,
            low_pass: None,
        };
        let fit = problem.fit(&shape, shape.start());
        let of = |fit: &Fit| fit.shape.terms_at(&fit.numbers)[0].row[0];
        (of(&fit), of(&corrected(&problem, &fit, 0.02)))
    }

    #[test]
    fn a_mass_on_a_noisy_acceleration_is_not_found_too_small() {
        // GIVEN an error of 0.3 m/s² on 2.1 m/s² rms: 2 % of its square
        let each: Vec<(f64, f64)> = (1..=10).map(|seed| found(0.3, 7919 * seed)).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / 10.0;
        let (fitted, corrected) = (mean(|masses| masses.0), mean(|masses| masses.1));
        // THEN the fit is 2 % too small, and the correction leaves a tenth of that: 0.07 % is the scatter
        // of the mean of ten.
        assert!((fitted / 0.49 - 1.0).abs() < 2.5e-3, "{fitted}");
        assert!((corrected / 0.5 - 1.0).abs() < 2.5e-3, "{corrected}");
    }

    #[test]
    fn what_would_cost_much_is_no_small_correction() {
        // GIVEN an error as large as the acceleration itself
        let (fitted, corrected) = found(2.0, 7);
        // THEN the first step of an extrapolation is not taken.
        assert!(fitted < 0.3 && corrected == fitted, "{fitted} {corrected}");
    }
}
