//! What the rig sees of the truth: a load cell behind a 12-bit converter and an incremental encoder.

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Codes of the force converter: 12 bits.
pub const FORCE_CODES: f64 = 4096.0;

/// Settings of both sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Standard deviation of the force noise (N).
    pub force_noise_n: f64,
    /// Force per code (N); 0: neither steps nor limits.
    pub force_step_n: f64,
    /// Force at code 0 (N); the range is 4096 steps from there.
    pub force_min_n: f64,
    /// Position per count (m); 0: no steps.
    pub position_step_m: f64,
    /// Samples per second (Hz).
    pub rate_hz: f64,
}

impl Default for Sensors {
    /// A 20 mN cell with 5 mN steps from −5.12 to 15.355 N: 12 bits off centre, because a touch
    /// presses to 14 N and pulls with little. A 1 µm encoder, both at 1 kHz.
    fn default() -> Self {
        Sensors {
            force_noise_n: 0.02,
            force_step_n: 0.005,
            force_min_n: -5.12,
            position_step_m: 1e-6,
            rate_hz: 1000.0,
        }
    }
}

impl Sensors {
    /// Sensors that show the truth.
    pub const PERFECT: Sensors = Sensors {
        force_noise_n: 0.0,
        force_step_n: 0.0,
        force_min_n: 0.0,
        position_step_m: 0.0,
        rate_hz: 1000.0,
    };
}

/// A load cell: Gaussian noise, then a converter with steps and limits.
#[derive(Clone, Debug)]
pub struct LoadCell {
    settings: Sensors,
    noise: Pcg64,
    clipped: usize,
}

impl LoadCell {
    /// A cell whose noise is that of `seed`.
    pub fn new(settings: Sensors, seed: u64) -> LoadCell {
        LoadCell {
            settings,
            noise: Pcg64::seed_from_u64(seed),
            clipped: 0,
        }
    }

    /// What the converter says (N) of a force (N).
    pub fn read_n(&mut self, force_n: f64) -> f64 {
        let noise: f64 = StandardNormal.sample(&mut self.noise);
        let noisy_n = force_n + self.settings.force_noise_n * noise;
        let step_n = self.settings.force_step_n;
        if step_n == 0.0 {
            return noisy_n;
        }
        let code = ((noisy_n - self.settings.force_min_n) / step_n).round();
        let limited = code.clamp(0.0, FORCE_CODES - 1.0);
        self.clipped += usize::from(limited != code);
        self.settings.force_min_n + limited * step_n
    }

    /// Samples so far that stood at an end of the range.
    pub fn clipped(&self) -> usize {
        self.clipped
    }
}

/// An incremental encoder: whole counts, from a random place within a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    step_m: f64,
    phase: f64,
}

impl Encoder {
    /// An encoder of `step_m` (m) a count, whose zero lies where `seed` has it.
    pub fn new(step_m: f64, seed: u64) -> Encoder {
        // Its own stream: other force noise must not move the encoder.
        let mut random = Pcg64::seed_from_u64(seed ^ 0x656e_636f_6465_7200);
        Encoder {
            step_m,
            phase: random.random(),
        }
    }

    /// What the counter says (m) of a position (m): ⌊x/step + phase⌋ counts, right in the mean over
    /// all phases.
    pub fn read_m(&self, position_m: f64) -> f64 {
        if self.step_m == 0.0 {
            return position_m;
        }
        (position_m / self.step_m + self.phase).floor() * self.step_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: u64 = 20_070_101;

    fn mean_and_rms(values: &[f64]) -> (f64, f64) {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        (mean, variance.sqrt())
    }

    #[test]
    fn force_noise_has_the_mean_and_the_strength_that_it_says() {
        let mut cell = LoadCell::new(Sensors::default(), SEED);
        let read: Vec<f64> = (0..100_000).map(|_| cell.read_n(3.0017)).collect();
        let (mean, rms) = mean_and_rms(&read);
        // Noise and a uniform 5 mN step: √(20² + 25/12) = 20.052 mN. Five standard errors of 1e5
        // samples: 0.32 mN of the mean, 0.22 mN of the strength.
        assert!((mean - 3.0017).abs() < 3.2e-4, "{mean}");
        assert!((rms - 0.020_052).abs() < 2.2e-4, "{rms}");
    }

    #[test]
    fn the_converter_steps_and_stops_at_its_ends() {
        let settings = Sensors {
            force_noise_n: 0.0,
            ..Sensors::default()
        };
        let mut cell = LoadCell::new(settings, SEED);
        assert!((cell.read_n(14.0012) - 14.0).abs() < 1e-12);
        assert_eq!(cell.clipped(), 0);
        assert!((cell.read_n(20.0) - 15.355).abs() < 1e-12);
        assert!((cell.read_n(-9.0) + 5.12).abs() < 1e-12);
        assert_eq!(cell.clipped(), 2);
    }

    #[test]
    fn the_encoders_error_is_uniform_over_one_count() {
        let encoder = Encoder::new(1e-6, SEED);
        // 0.6180… of a count per sample visits a count evenly.
        let errors: Vec<f64> = (0..50_000)
            .map(|index| f64::from(index) * 0.618_033_988_749_895e-6)
            .map(|position_m| encoder.read_m(position_m) - position_m)
            .collect();
        let (_, rms) = mean_and_rms(&errors);
        let smallest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = errors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // A count wide, and 1/√12 of a count rms.
        assert!((0.999e-6..=1.0e-6).contains(&(largest - smallest)));
        assert!((rms / 1e-6 - 12f64.sqrt().recip()).abs() < 1e-3, "{rms:e}");
    }

    #[test]
    fn the_encoder_is_right_in_the_mean_over_all_phases() {
        let read = |seed| Encoder::new(1e-6, seed).read_m(12.3e-6);
        let (mean, _) = mean_and_rms(&(0..10_000).map(read).collect::<Vec<_>>());
        // Five standard errors of a two-valued variable of 1 µm: 0.46 µm · 5/100.
        assert!((mean - 12.3e-6).abs() < 2.3e-8, "{mean:e}");
    }

    #[test]
    fn one_seed_is_one_recording() {
        let read = |seed| LoadCell::new(Sensors::default(), seed).read_n(1.0);
        assert_eq!(read(SEED), read(SEED));
        let differing = (0..50).filter(|seed| read(*seed) != read(SEED)).count();
        assert!(differing > 30);
    }

    #[test]
    fn perfect_sensors_show_the_truth() {
        assert_eq!(
            LoadCell::new(Sensors::PERFECT, SEED).read_n(1.234_567),
            1.234_567
        );
        assert_eq!(Encoder::new(0.0, SEED).read_m(1.234_567), 1.234_567);
    }
}
