//! By how much the residuals exceed the noise, over several strokes.
//!
//! A law that does not hold leaves residuals that are larger than the noise or less white than it. The
//! size alone says too little: 20 mN that stay for 0.1 s move a parameter ten times as far as 20 mN of
//! white noise, and an estimator absorbs most of a misfit, so that little of it is left to be seen. What
//! widens a standard error is the variance of the *mean* of many residuals over what white noise gives
//! it, the batch means of time series (Conway 1963). It is taken at three lengths, since a misfit of one
//! stroke averages out over two.

use crate::maths::scalar::Real;

/// Lengths of the batches (samples).
const LENGTHS: [f64; 3] = [16.0, 64.0, 256.0];
/// Memory (samples): two seconds of contact at 1 kHz, several strokes.
const MEMORY: f64 = 2048.0;
/// Standard deviations of the mean of χ² terms that chance may add.
const CHANCE: f64 = 2.0;
/// Largest squared residual over its variance that enters: one outlier must not fill the memory.
const LARGEST: f64 = 1e4;

/// Means of one length.
#[derive(Clone, Copy, Debug)]
struct Batches<T> {
    sum: T,
    taken: T,
    /// Variance of the mean of a batch over that of white noise.
    ratio: T,
    /// Number of batches that the ratio is a mean of, at most what fits into the memory.
    count: T,
}

/// The misfit of an estimator, updated with every sample that was learned from.
#[derive(Clone, Debug)]
pub struct Misfit<T> {
    batches: [Batches<T>; LENGTHS.len()],
    /// Mean square of the normalized residual, and the number of samples that it is a mean of.
    mean_square: T,
    samples: T,
}

/// By how much residuals exceed the noise.
#[derive(Clone, Copy, Debug)]
pub struct Excess<T> {
    /// Mean square of the normalized residual: about 1 where the noise explains it.
    pub mean_square: T,
    /// Factor by which the standard errors of the parameters are too small, at least 1.
    pub inflation: T,
}

impl<T: Real> Default for Excess<T> {
    fn default() -> Self {
        Excess {
            mean_square: T::one(),
            inflation: T::one(),
        }
    }
}

impl<T: Real> Default for Misfit<T> {
    fn default() -> Self {
        let empty = Batches {
            sum: T::zero(),
            taken: T::zero(),
            ratio: T::one(),
            count: T::zero(),
        };
        Misfit {
            batches: [empty; LENGTHS.len()],
            mean_square: T::one(),
            samples: T::zero(),
        }
    }
}

impl<T: Real> Misfit<T> {
    /// Takes the mean residual of `samples` samples over the standard deviation of the filtered noise;
    /// `noise_gain` is the variance of the filtered over that of the raw force.
    pub fn update(&mut self, normalized: T, samples: T, noise_gain: T) {
        let largest = T::from_f64(LARGEST).sqrt();
        let bounded = normalized.max_of(-largest).min_of(largest);
        self.samples = (self.samples + samples).min_of(T::from_f64(MEMORY));
        self.mean_square += (bounded * bounded - self.mean_square) * samples / self.samples;
        for (batch, length) in self.batches.iter_mut().zip(LENGTHS) {
            batch.sum += bounded * samples;
            batch.taken += samples;
            if batch.taken < T::from_f64(length) {
                continue;
            }
            // White noise of the raw force: the sum of n filtered samples has the variance n·σ².
            let square = batch.sum * batch.sum * noise_gain / batch.taken;
            batch.count = (batch.count + T::one()).min_of(T::from_f64(MEMORY / length));
            batch.ratio += (square - batch.ratio) / batch.count;
            batch.sum = T::zero();
            batch.taken = T::zero();
        }
    }

    /// By how much the residuals exceed the noise.
    pub fn excess(&self) -> Excess<T> {
        Excess {
            mean_square: self.mean_square,
            inflation: self.inflation(),
        }
    }

    fn inflation(&self) -> T {
        let mut square = self.mean_square;
        for batch in &self.batches {
            if batch.count > T::zero() {
                let chance = (T::from_f64(2.0) / batch.count).sqrt();
                square = square.max_of(batch.ratio / (T::one() + T::from_f64(CHANCE) * chance));
            }
        }
        T::one().max_of(square).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise of unit variance through a mean of nine samples, over the standard deviation of that.
    fn filtered(length: usize) -> impl Iterator<Item = f64> {
        let mut state = 88_172_645_463_325_252_u64;
        let mut uniform = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut window = [0.0; 9];
        (0..length).map(move |at| {
            let gauss = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            window[at % 9] = gauss;
            window.iter().sum::<f64>() / 3.0
        })
    }

    #[test]
    fn white_noise_widens_nothing() {
        let mut misfit = Misfit::<f64>::default();
        let mut worst = 1.0_f64;
        for (at, residual) in filtered(20_000).enumerate() {
            misfit.update(residual, 1.0, 1.0 / 9.0);
            if at > 500 {
                worst = worst.max(misfit.inflation());
            }
        }
        // χ² of 8 to 128 batches, less two of its standard deviations.
        assert!(worst < 1.4, "{worst}");
        assert!((misfit.mean_square - 1.0).abs() < 0.3);
    }

    #[test]
    fn a_slow_misfit_as_small_as_the_noise_widens_errors_far_more_than_its_size() {
        let mut misfit = Misfit::<f64>::default();
        for (at, residual) in filtered(4000).enumerate() {
            // As large as the noise of the raw force, three times that of the filtered one.
            misfit.update(
                residual + 3.0 * libm::sin(0.005 * at as f64),
                1.0,
                1.0 / 9.0,
            );
        }
        assert!((2.0..2.8).contains(&misfit.mean_square.sqrt()));
        // √(½·256·0.77): the mean of 256 samples keeps 0.77 of the power of the sine; chance takes its
        // part.
        assert!(
            (7.0..10.0).contains(&misfit.inflation()),
            "{}",
            misfit.inflation()
        );
    }

    #[test]
    fn an_outlier_fills_no_memory() {
        let mut misfit = Misfit::<f64>::default();
        filtered(2000).for_each(|residual| misfit.update(residual, 1.0, 1.0 / 9.0));
        misfit.update(1e9, 1.0, 1.0 / 9.0);
        assert!(misfit.mean_square < 7.0);
    }
}
