//! Measures the noise and the resting force of the load cell in free air.

use crate::maths::scalar::Real;

/// Mean, standard deviation and white noise of the force, over all samples taken so far.
///
/// The white noise comes from second differences, F(h) − 2F(h−1) + F(h−2), whose variance is 6σ² for
/// white noise: a slope or a slow drift does not count as noise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise<T> {
    previous: [T; 2],
    samples: u32,
    mean_n: T,
    variance_n2: T,
    second_difference_n2: T,
}

impl<T: Real> Noise<T> {
    /// Takes one raw force (N).
    pub fn update(&mut self, force_n: T) {
        self.samples = self.samples.saturating_add(1);
        let count = T::from_u32(self.samples);
        let before = force_n - self.mean_n;
        self.mean_n += before / count;
        self.variance_n2 += (before * (force_n - self.mean_n) - self.variance_n2) / count;
        if self.samples > 2 {
            let [last, before] = self.previous;
            let difference = (force_n - last) - (last - before);
            let terms = T::from_u32(self.samples - 2);
            self.second_difference_n2 +=
                (difference * difference - self.second_difference_n2) / terms;
        }
        self.previous = [force_n, self.previous[0]];
    }

    /// Number of samples taken so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean of the force (N).
    pub fn mean_n(&self) -> T {
        self.mean_n
    }

    /// Standard deviation of the force about its mean (N), with noise and everything slower: hum, drag
    /// and drift.
    pub fn std_dev_n(&self) -> T {
        self.variance_n2.sqrt()
    }

    /// Standard deviation of the white noise of the force (N).
    pub fn white_noise_n(&self) -> T {
        (self.second_difference_n2 / T::from_f64(6.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_not_noise() {
        let mut noise = Noise::<f64>::default();
        (0..200).for_each(|i| noise.update(0.5 + 0.01 * f64::from(i)));
        assert!(noise.white_noise_n() < 1e-12);
        assert!((noise.mean_n() - (0.5 + 0.01 * 99.5)).abs() < 1e-12);
    }

    #[test]
    fn the_noise_of_a_known_sequence_is_found() {
        // ±a alternating: second differences are ±4a, so σ reads 4a/√6: the measure is for white
        // noise and says so by its factor.
        let mut noise = Noise::<f64>::default();
        (0..1000).for_each(|i| noise.update(if i % 2 == 0 { 0.02 } else { -0.02 }));
        assert!((noise.white_noise_n() - 0.08 / libm::sqrt(6.0)).abs() < 1e-12);
        assert!((noise.std_dev_n() - 0.02).abs() < 1e-12);
    }
}
