//! The bias that the errors of speed and acceleration give the numbers, and the numbers without it.
//!
//! Errors in the variables bias least squares: a mass reads too small by σ_a²/⟨a²⟩, a friction turns
//! round over too wide a range of speeds. The bias grows with the variance, so that one more dose of the
//! error shows what the first has done: the first step of Cook and Stefanski's simulation–extrapolation
//! (JASA 89, 1994), with two points instead of random numbers. The gradient JᵀWr, averaged over the
//! motion moved by +σ and by −σ, is no longer zero, and the inverse curvature turns it into the bias.
//!
//! What smoothing leaves out of the motion makes a bias as well, with the opposite sign: crests of the speed that are
//! too low make a damper too large. Put back, it shows in the gradient what the fit would have found with it; as a
//! mean over the log, for at one sample it is mostly noise.

use crate::gap::data::fit_data::FitData;
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
    let mut add = |share: f64, change: &dyn Fn(&mut FitData)| {
        let mut logs = problem.logs.to_vec();
        logs.iter_mut().for_each(change);
        let moved = Problem {
            logs: &logs,
            ..*problem
        };
        let there = moved.normal_equations(&moved.linearize(&fit.shape, &fit.numbers));
        let each = pull.iter_mut().zip(&there.downhill).zip(&here.downhill);
        each.for_each(|((pull, there), here)| *pull += share * (there - here));
    };
    for sign in [1.0, -1.0] {
        add(0.5, &|log| with_speed_error(log, sign));
        // Of the acceleration's error only the white part counts: what a window rounds off follows the
        // acceleration and attenuates nothing.
        add(0.5, &|log| with_acceleration_error(log, sign));
    }
    add(-1.0, &with_what_is_left_out);
    let row = |at: usize| (0..n).map(|k| inverse[at * n + k] * pull[k]).sum();
    (0..n)
        .map(|at| if at_bound[at] { 0.0 } else { row(at) })
        .collect()
}

/// Puts back what smoothing has left out of the motion.
fn with_what_is_left_out(log: &mut FitData) {
    let positions = log.position_m.iter_mut().zip(&log.position_left_m);
    positions.for_each(|(position, left)| *position += left);
    let speeds = log.speed_mps.iter_mut().zip(&log.speed_left_mps);
    speeds.for_each(|(speed, left)| *speed += left);
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
    use crate::gap::data::scales::Scales;
    use crate::gap::model::shape::Shape;
    use crate::gap::model::start::whole;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;

    /// A mass of 0.5 kg on 4 s at 1 kHz of 3 m/s² at 2 Hz that is known to σ (m/s²).
    fn mass(error_mps2: f64, seed: u64) -> FitData {
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
        data
    }

    /// The parameter of an effect in free air as it is fitted from `start`, and corrected.
    fn fitted(id: EffectId, start: f64, data: &FitData) -> (f64, f64) {
        let path = Path::new("model.toml");
        let file = TomlFile::parse("[environment]\nlaw = \"free\"\n".into(), path).unwrap();
        let model = Model::from_toml(&file, path).unwrap();
        let mut row = [0.0; MOST_PARAMETERS];
        row[0] = start;
        let scales = Scales::of(std::slice::from_ref(data));
        let shape = Shape::new(&model.environment, vec![whole(id, row, 1)], &scales);
        let problem = Problem {
            logs: std::slice::from_ref(data),
            weights: &vec![1.0; data.len()],
            low_pass: None,
            known: None,
        };
        let fit = problem.fit(&shape, shape.start());
        let of = |fit: &Fit| fit.shape.terms_at(&fit.numbers)[0].row[0];
        (of(&fit), of(&corrected(&problem, &fit, 0.02)))
    }

    /// The mass (kg) as it is fitted, and corrected.
    fn found(error_mps2: f64, seed: u64) -> (f64, f64) {
        fitted(EffectId::ToolInertia, 0.3, &mass(error_mps2, seed))
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
    fn a_damper_on_smoothed_speeds_is_not_found_too_large() {
        // GIVEN 5 N s/m on strokes of 1.2 mm at 5.5 Hz, read in counts of 1 µm at 100 Hz: three samples are an
        // eighth of a turn, and their parabolas are off by more than the noise
        let turn = |t: f64| 34.56 * t;
        let time: Vec<f64> = (0..2000).map(|at| f64::from(at) * 1e-2).collect();
        let read = |t: &f64| (1.2e3 * turn(*t).sin()).round() * 1e-6;
        let position = time.iter().map(read).collect();
        // and 20 mN of noise that says nothing of a slow speed
        let noise = [0.02, -0.02].into_iter().cycle();
        let each = time.iter().zip(noise);
        let force = each.map(|(t, noise)| 5.0 * 1.2e-3 * 34.56 * turn(*t).cos() + noise);
        let log = Log::from_channels(time.clone(), position, force.collect());
        let data = FitData::of(&log.uniform().unwrap());
        let (fitted, corrected) = fitted(EffectId::ViscousDrag, 3.0, &data);
        // THEN it is 1.3 % too large as it is fitted, and a twentieth of that once it is corrected.
        assert!((1e-2..2e-2).contains(&(fitted / 5.0 - 1.0)), "{fitted}");
        assert!((corrected / 5.0 - 1.0).abs() < 7e-4, "{corrected}");
    }

    #[test]
    fn what_would_cost_much_is_no_small_correction() {
        // GIVEN an error as large as the acceleration itself
        let (fitted, corrected) = found(2.0, 7);
        // THEN the first step of an extrapolation is not taken.
        assert!(fitted < 0.3 && corrected == fitted, "{fitted} {corrected}");
    }
}
