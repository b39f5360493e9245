//! Whether what a fit leaves is slow where it should be white.
//!
//! Residuals can be as large as the noise and none: a material that breaks in small steps, taken for one that yields, left
//! 1.09 times what is allowed. Means over some samples tell: noise makes them small, and what a model lacks stays. There
//! they were 6 times as large (in power) in motion as white noise makes them, and 1.9 times in holds.

use crate::gap::model::{dataset::Dataset, fit::Fit, problem::Problem};
use crate::gap::noise::floor::NoiseFloor;
use crate::stats::highest;

/// Samples of a mean: at 1 kHz a tenth of a stroke.
const MEAN_OF: usize = 32;
/// A sample says something of the noise where that makes this share of what is allowed: errors of the motion are alike over a
/// window, and a servo's corners would be something slow.
const MOSTLY_NOISE: f64 = 0.5;
/// Fewest means to judge by.
const FEWEST: f64 = 8.0;

/// How many times as large (rms) means of the residuals are in motion as noise makes them; `None` where they are as
/// noise is, and where the noise itself is slow or may be.
pub(super) fn slow_remainder(dataset: &Dataset<'_>, all: &Problem<'_>, best: &Fit) -> Option<f64> {
    // Without a rest in free air nobody knows whether the noise is slow; and the errors of a lever's motion, which never
    // rests, are.
    let is_known = |floor: &NoiseFloor| !floor.coloured && floor.rest_n.is_some();
    if !dataset.floors.iter().all(is_known) {
        return None;
    }
    let residuals = all.residuals(&best.shape, &best.numbers);
    let speeds: Vec<f64> = (dataset.logs.iter())
        .flat_map(|log| log.speed_mps.iter().copied())
        .collect();
    let [moving, still] = squared_means(&residuals, all.weights, &speeds);
    let thresholds = &dataset.thresholds.explained;
    // Slow noise that the floor does not know of is there at rest as well.
    let noise = still.unwrap_or(1.0).max(1.0);
    let moving = moving.unwrap_or(1.0);
    let is_slow = moving > thresholds.slow && moving > thresholds.slow_over_rest * noise;
    is_slow.then(|| (moving / noise).sqrt())
}

/// The mean square of means, over that of means of white noise, in motion and at rest; `None` where there are too few.
fn squared_means(residuals: &[f64], weights: &[f64], speeds: &[f64]) -> [Option<f64>; 2] {
    let least = MOSTLY_NOISE * highest(weights.iter().copied());
    let mut sums = [(0.0, 0.0); 2];
    let blocks = (residuals.chunks_exact(MEAN_OF))
        .zip(weights.chunks_exact(MEAN_OF))
        .zip(speeds.chunks_exact(MEAN_OF));
    for ((residuals, weights), speeds) in blocks {
        if weights.iter().any(|weight| *weight <= least) {
            continue;
        }
        let each = residuals.iter().zip(weights).map(|(r, w)| r * w.sqrt());
        let is_still = speeds.iter().all(|speed| *speed == 0.0);
        let (sum, count) = &mut sums[usize::from(is_still)];
        *sum += each.sum::<f64>().powi(2) / MEAN_OF as f64;
        *count += 1.0;
    }
    sums.map(|(sum, count)| (count >= FEWEST).then(|| sum / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    #[test]
    fn a_slow_error_of_half_the_noise_shows_in_means_and_white_noise_does_not() {
        let count = 64 * MEAN_OF;
        let mut rng = Pcg64::seed_from_u64(5);
        let noise: Vec<f64> = (0..count)
            .map(|_| StandardNormal.sample(&mut rng))
            .collect();
        // In the first half the probe moves.
        let speeds: Vec<f64> = (0..count)
            .map(|i| f64::from(u8::from(i < count / 2)))
            .collect();
        let error = |i: usize| 0.5 * (i as f64 / 200.0).sin() * 2.0_f64.sqrt() * speeds[i];
        let slow: Vec<f64> = noise
            .iter()
            .enumerate()
            .map(|(i, n)| n + error(i))
            .collect();
        let weights = vec![1.0; count];
        let [moving, still] = squared_means(&slow, &weights, &speeds).map(Option::unwrap);
        // 1 + 0.25·32 = 9, with 32 means ± 25 %.
        assert!((6.0..12.0).contains(&moving), "{moving}");
        assert!((0.5..1.5).contains(&still), "{still}");
        let [moving, _] = squared_means(&noise, &weights, &speeds).map(Option::unwrap);
        assert!((0.5..1.5).contains(&moving), "{moving}");
        // What has no weight says nothing, and too few means neither.
        let none = vec![0.0; count];
        assert_eq!(squared_means(&slow, &none, &speeds), [None, None]);
    }
}
