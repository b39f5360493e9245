//! Whether what a fit leaves is noise at every scale of time.
//!
//! Normal noise of any colour has typical magnitudes: their median is 0.67 of their root mean square. What comes in
//! bursts has a smaller one, and a sine a larger one. Slow pushes of a hand hide under fast noise, though: differences of
//! means of 4, 8, 16 … samples (Haar's wavelets) show each octave alone, and are hardly correlated where the noise is 1/f.

use crate::gap::thresholds::Thresholds;
use crate::stats::{rms, robust_deviation};

/// Samples of the shortest means: shorter ones are steps of the readings where these are coarse.
const SHORTEST: usize = 4;
/// Fewest differences of an octave to judge by: their median is then known to a fifth.
const FEWEST: usize = 32;

/// Whether residuals are waves, or come in bursts, all together or in an octave.
pub(super) fn are_no_noise(residuals: &[f64], thresholds: &Thresholds) -> bool {
    let decide = &thresholds.explained;
    let all = typical(residuals);
    all < decide.least_typical
        || all > decide.most_typical
        || octaves(residuals).any(|octave| typical(&octave) < decide.least_of_octave)
}

/// How large residuals typically are, as a share of their root mean square; 1 of normal noise.
fn typical(residuals: &[f64]) -> f64 {
    let all = rms(residuals.iter().copied()).max(f64::MIN_POSITIVE);
    robust_deviation(residuals.iter().copied()) / all
}

/// The differences of neighbouring means, from the shortest to the longest of which there are enough.
fn octaves(residuals: &[f64]) -> impl Iterator<Item = Vec<f64>> {
    let shortest = residuals.chunks_exact(SHORTEST);
    let mut means: Vec<f64> = shortest.map(|each| each.iter().sum()).collect();
    std::iter::from_fn(move || {
        let pairs = means.chunks_exact(2);
        let octave: Vec<f64> = pairs.clone().map(|pair| pair[0] - pair[1]).collect();
        means = pairs.map(|pair| pair[0] + pair[1]).collect();
        (octave.len() >= FEWEST).then_some(octave)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    fn are_no_noise(of: impl Fn(usize) -> f64) -> bool {
        let mut rng = Pcg64::seed_from_u64(11);
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let residuals: Vec<f64> = (0..16_000).map(|at| noise() + of(at)).collect();
        super::are_no_noise(&residuals, &Thresholds::default())
    }

    #[test]
    fn pushes_and_a_sine_are_no_noise() {
        assert!(!are_no_noise(|_| 0.0));
        // GIVEN pushes in a tenth of a log, of a tenth of the noise, of 3 times, which only octaves show, and of 12
        let push = |at: usize| f64::from(u8::from(at % 1000 < 100));
        assert!(!are_no_noise(|at| 0.1 * push(at)));
        assert!(are_no_noise(|at| 3.0 * push(at)) && are_no_noise(|at| 12.0 * push(at)));
        // … and a sine as large as the noise, and three times as large
        let sine = |at: usize| 1.4 * (at as f64 / 3.2).sin();
        assert!(!are_no_noise(sine) && are_no_noise(|at| 3.0 * sine(at)));
    }
}
