//! What coloured noise makes of an estimate, from the spectrum of the residuals.
//!
//! An estimate moves by Σ g(h)·r(h), and noise with the spectrum S gives it the variance Σ|G(f)|²S(f). A sum
//! over lags, as Newey and West's, cannot tell: 1/f noise remembers for seconds, and that many lags of a log
//! of fifteen seconds are noise themselves. In bands as wide as a third of their frequency S is known well.

use crate::spectral;

/// Fewest bins of a band: their mean scatters by 35 % of the power, 18 % of a standard error. With ten bins
/// the lowest band of noise that remembers for 50 of 4000 samples was a sixth too low.
const FEWEST_BINS: usize = 8;
/// Width of a band over its lowest frequency.
const RELATIVE_WIDTH: f64 = 1.0 / 3.0;
/// The least share of a band that a fit may leave for the band to say anything about the noise.
const LEAST_REMAINDER: f64 = 0.2;

/// Power of stationary noise, bin by bin. White noise of unit variance has 1 in each bin.
pub(crate) struct ResidualSpectrum {
    power: Vec<f64>,
}

impl ResidualSpectrum {
    /// Estimates the spectrum from the residuals of a fit. `fitted` are the orthonormal columns that the fit
    /// could use: they have taken their share of every bin.
    pub(crate) fn of(residuals: &[f64], fitted: &[Vec<f64>]) -> ResidualSpectrum {
        let mut power = bins(residuals);
        let mut remainder = vec![1.0; power.len()];
        for column in fitted {
            let taken = bins(column);
            remainder
                .iter_mut()
                .zip(taken)
                .for_each(|(remainder, taken)| *remainder -= taken);
        }
        let mut from = 0;
        while from < power.len() {
            let width = FEWEST_BINS.max((RELATIVE_WIDTH * from as f64) as usize);
            let mut to = (from + width).min(power.len());
            if power.len() - to < FEWEST_BINS {
                to = power.len();
            }
            let left: f64 = remainder[from..to].iter().sum();
            let level = power[from..to].iter().sum::<f64>()
                / left.max(LEAST_REMAINDER * (to - from) as f64);
            power[from..to].fill(level);
            from = to;
        }
        ResidualSpectrum { power }
    }

    /// The variance of a weighted sum of the noise.
    pub(crate) fn variance(&self, weights: &[f64]) -> f64 {
        let last = weights.len() / 2;
        let each = bins(weights).into_iter().zip(&self.power).enumerate();
        each.map(|(at, (weight, power))| {
            // A bin stands for that of the negative frequency as well, unless it is its own.
            let once = at == 0 || (at == last && weights.len().is_multiple_of(2));
            if once {
                weight * power
            } else {
                2.0 * weight * power
            }
        })
        .sum()
    }
}

/// |Fourier transform|²/n from frequency 0 to the highest.
fn bins(series: &[f64]) -> Vec<f64> {
    let scale = 1.0 / series.len().max(1) as f64;
    let power = spectral::power(series.iter().copied(), series.len());
    power.into_iter().map(|power| scale * power).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lsq::basis::add_column;

    /// First-order noise of unit variance.
    fn coloured(keep: f64, seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut normal = || {
            // Twelve uniforms of a linear congruence: good enough for sums.
            (0..12)
                .map(|_| {
                    state = state
                        .wrapping_mul(6364136223846793005)
                        .wrapping_add(1442695040888963407);
                    (state >> 11) as f64 / (1u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        };
        let mut value = normal();
        (0..count)
            .map(|_| {
                value = keep * value + (1.0 - keep * keep).sqrt() * normal();
                value
            })
            .collect()
    }

    #[test]
    fn the_mean_of_slow_noise_is_as_uncertain_as_it_is() {
        // GIVEN noise that remembers for 50 samples, and lines fitted to 200 logs of 4000
        let (count, keep) = (4000, 0.98);
        let mut columns = Vec::new();
        add_column(&mut columns, vec![1.0; count], &[]);
        add_column(&mut columns, (0..count).map(|at| at as f64).collect(), &[]);
        let (mut true_square, mut found) = (0.0, 0.0);
        for seed in 1..=200 {
            let mut noise = coloured(keep, seed * 7919, count);
            let mean: f64 = noise.iter().zip(&columns[0]).map(|(a, b)| a * b).sum();
            true_square += mean * mean / 200.0;
            crate::lsq::basis::project_out(&mut noise, &columns);
            found += ResidualSpectrum::of(&noise, &columns).variance(&columns[0]) / 200.0;
        }
        // THEN the variance found for the mean is the true one, 99 times that of white noise.
        let theory = (1.0 + keep) / (1.0 - keep);
        assert!((true_square / theory - 1.0).abs() < 0.25, "{true_square}");
        assert!((found / theory - 1.0).abs() < 0.15, "{found} of {theory}");
    }

    #[test]
    fn white_noise_has_the_same_power_everywhere() {
        // GIVEN 50 logs of white noise, THEN its sum and what alternates have its variance: each is the mean
        // of eight bins or more, 35 %, the mean of 50 is known to 5 %.
        let count = 1001;
        let alternating: Vec<f64> = (0..count).map(|at| f64::from(1 - 2 * (at % 2))).collect();
        for weights in [alternating, vec![1.0; 1001]] {
            let variance = |seed: u64| {
                let noise = coloured(0.0, 104_729 * seed, 1001);
                ResidualSpectrum::of(&noise, &[]).variance(&weights) / 1001.0
            };
            let mean = (1..=50).map(variance).sum::<f64>() / 50.0;
            assert!((mean - 1.0).abs() < 0.15, "{mean}");
        }
    }
}
