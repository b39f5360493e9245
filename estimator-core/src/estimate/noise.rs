//! How noisy the force is, and what it reads when nothing is touched: measured, not configured.

use crate::maths::scalar::Real;

/// Noise and resting force of the load cell, from the first stretch in free air.
///
/// The standard deviation comes from second differences, F(h) − 2F(h−1) + F(h−2), whose variance is
/// 6σ² for white noise: a slope or a slow drift does not count as noise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise<T> {
    previous: [T; 2],
    seen: u32,
    mean_n: T,
    spread_n2: T,
    curvature_n2: T,
}

impl<T: Real> Noise<T> {
    /// Takes one raw force (N).
    pub fn update(&mut self, force_n: T) {
        self.seen = self.seen.saturating_add(1);
        let count = T::from_f64(f64::from(self.seen));
        let before = force_n - self.mean_n;
        self.mean_n += before / count;
        self.spread_n2 += (before * (force_n - self.mean_n) - self.spread_n2) / count;
        if self.seen > 2 {
            let [last, before] = self.previous;
            let curvature = (force_n - last) - (last - before);
            let terms = T::from_f64(f64::from(self.seen - 2));
            self.curvature_n2 += (curvature * curvature - self.curvature_n2) / terms;
        }
        self.previous = [force_n, self.previous[0]];
    }

    /// Number of samples taken.
    pub fn seen(&self) -> u32 {
        self.seen
    }

    /// Mean force (N).
    pub fn mean_n(&self) -> T {
        self.mean_n
    }

    /// Standard deviation about the mean (N): noise and everything slower, hum, drag and drift
    /// included.
    pub fn spread_n(&self) -> T {
        self.spread_n2.sqrt()
    }

    /// Standard deviation of the noise of the raw force (N).
    pub fn sigma_n(&self) -> T {
        (self.curvature_n2 / T::from_f64(6.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_not_noise() {
        let mut noise = Noise::<f64>::default();
        (0..200).for_each(|i| noise.update(0.5 + 0.01 * f64::from(i)));
        assert!(noise.sigma_n() < 1e-12);
        assert!((noise.mean_n() - (0.5 + 0.01 * 99.5)).abs() < 1e-12);
    }

    #[test]
    fn the_spread_of_a_known_sequence_is_found() {
        // ±a alternating: second differences are ±4a, so σ reads 4a/√6: the measure is for white
        // noise and says so by its factor.
        let mut noise = Noise::<f64>::default();
        (0..1000).for_each(|i| noise.update(if i % 2 == 0 { 0.02 } else { -0.02 }));
        assert!((noise.sigma_n() - 0.08 / libm::sqrt(6.0)).abs() < 1e-12);
        assert!((noise.spread_n() - 0.02).abs() < 1e-12);
    }
}
