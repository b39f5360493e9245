//! What a model left when it was identified, beside the noise.

use crate::gap::noise::floor::NoiseFloor;
use crate::model::Remainder;
use crate::phase::phases_of;

/// Fewest independent values of what a model left: it follows the motion, and is no noise that might be something else
/// the next time. A servo's remainder remembers for 2 s of 6 s, and against three values a cogging that took 89 % of the
/// squares off was not significant.
const FEWEST_VALUES: f64 = 64.0;

/// The most samples that are taken for one independent value of what a model left.
pub(crate) fn most_correlation(samples: f64) -> f64 {
    (samples / FEWEST_VALUES).max(1.0)
}

impl NoiseFloor {
    /// The floor of a log at a rate (Hz) with a remainder in it.
    pub(crate) fn beside(&self, remainder: &Remainder, rate_hz: f64) -> NoiseFloor {
        let (noise_n2, known_n2) = (self.noise_n().powi(2), remainder.rms_n.powi(2));
        let both_n2 = noise_n2 + known_n2;
        // The variance of a mean adds up.
        let samples = (remainder.correlation_s * rate_hz).max(1.0);
        NoiseFloor {
            used_n: (both_n2 / self.band_share).sqrt(),
            coloured: true,
            correlation: (noise_n2 * self.correlation + known_n2 * samples) / both_n2,
            uncertainty: self.uncertainty * noise_n2 / both_n2,
            left: Some(*remainder),
            ..self.clone()
        }
    }

    /// The variances (N²) of the force in the phases of a log, with what the model left there.
    pub(crate) fn variances(&self, depth_m: &[f64], speed_mps: &[f64]) -> Vec<f64> {
        let all_n2 = self.noise_n().powi(2);
        let Some(left) = self.left else {
            return vec![all_n2; speed_mps.len()];
        };
        let noise_n2 = (all_n2 - left.rms_n.powi(2)).max(0.0);
        let phases = phases_of(depth_m, speed_mps).into_iter();
        phases
            .map(|phase| noise_n2 + left.rms_in_n(phase).powi(2))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::PHASES;

    #[test]
    fn variances_and_those_of_means_add_up() {
        // GIVEN 3 mN of white noise at 1 kHz, and 4 mN that stay what they are for 50 ms
        let white = NoiseFloor::white(3e-3, "");
        let remainder = Remainder {
            rms_n: 4e-3,
            by_phase_n: Default::default(),
            noise_n: None,
            correlation_s: 0.05,
            bandwidth_hz: None,
        };
        let both = white.beside(&remainder, 1e3);
        // THEN they are 5 mN, and every (9 · 1 + 16 · 50) / 25 samples are worth one.
        assert!((both.noise_n() - 5e-3).abs() < 1e-12 && both.coloured);
        assert!((both.correlation - 32.36).abs() < 1e-9);
        // AND in a phase with a value of its own, here the hold, that counts.
        let mut by_phase_n = [None; PHASES.len()];
        by_phase_n[3] = Some(0.0);
        let remainder = Remainder {
            by_phase_n,
            ..remainder
        };
        let both = white.beside(&remainder, 1e3);
        let variances = both.variances(&[1e-3; 2], &[1e-2, 0.0]);
        assert!((variances[0] - 25e-6).abs() < 1e-12 && (variances[1] - 9e-6).abs() < 1e-12);
        assert_eq!(white.variances(&[1e-3], &[0.0]), [9e-6]);
    }

    #[test]
    fn what_a_model_left_is_worth_sixty_four_values_at_least() {
        assert_eq!(most_correlation(6400.0), 100.0);
        assert_eq!(most_correlation(10.0), 1.0);
    }
}
