//! Error-dependent forgetting (24): the larger the error, the faster the past is forgotten.

use crate::estimate::{config::Config, error::ConfigError, error::require_each};
use crate::maths::scalar::Real;

/// Default of α₂α₃, and default of α₃ over the noise of the raw force.
///
/// Chosen for the two stages on gel and plastic over 16 seeds (largest error of K, λ, n: 1.2 %) and
/// on 200 materials (K 300–20 000 N/m, λ/K 3–40 ms, n 1.05–1.7; 166 end within 5 %). A softer or
/// higher threshold forgets at zero error, which makes λ of plastic 3.9 % wrong at 2 and 1.5. With α₁
/// of 0.08 or more, n runs into its bound and stays there.
const STEEPNESS: f64 = 8.0;
const THRESHOLD_SIGMAS: f64 = 1.0;

/// Checked coefficients of the forgetting factor (24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForgettingParams<T> {
    alpha_1: T,
    alpha_2_per_n: Option<T>,
    alpha_3_n: Option<T>,
}

impl<T: Real> ForgettingParams<T> {
    pub(crate) fn validate(config: &Config, default_alpha_1: f32) -> Result<Self, ConfigError> {
        let forgetting = config.forgetting;
        let alpha_1 = forgetting.alpha_1.unwrap_or(default_alpha_1);
        let steepness = forgetting.alpha_2_per_n.unwrap_or(1.0);
        let threshold = forgetting.alpha_3_n.unwrap_or(1.0);
        require_each! {
            (0.0..=0.5).contains(&alpha_1), "forgetting.alpha_1", alpha_1,
                "must lie between 0 (never forget) and 0.5";
            steepness > 0.0 && steepness.is_finite(), "forgetting.alpha_2_per_n", steepness,
                "must be positive, in 1/N, or absent";
            threshold > 0.0 && threshold.is_finite(), "forgetting.alpha_3_n", threshold,
                "must be positive, in N, or absent";
        }
        let from = |value: f32| T::from_f64(f64::from(value));
        Ok(ForgettingParams {
            alpha_1: from(alpha_1),
            alpha_2_per_n: forgetting.alpha_2_per_n.map(from),
            alpha_3_n: forgetting.alpha_3_n.map(from),
        })
    }

    /// The coefficients α₁, α₂ (1/N) and α₃ (N) for a raw force with this noise (N).
    pub fn alphas(&self, noise_n: T) -> (T, T, T) {
        let alpha_3 = self
            .alpha_3_n
            .unwrap_or(T::from_f64(THRESHOLD_SIGMAS) * noise_n);
        let alpha_2 = self
            .alpha_2_per_n
            .unwrap_or(T::from_f64(STEEPNESS) / alpha_3);
        (self.alpha_1, alpha_2, alpha_3)
    }

    /// The forgetting factor β for an error F − F̂ (N) of a raw force with this noise (N), (24).
    pub fn beta(&self, error_n: T, noise_n: T) -> T {
        let (alpha_1, alpha_2, alpha_3) = self.alphas(noise_n);
        let angle = (alpha_2 * (error_n.abs() - alpha_3)).atan();
        let turn = T::from_f64(core::f64::consts::FRAC_1_PI) * angle + T::from_f64(0.5);
        T::one() - alpha_1 * turn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> ForgettingParams<f64> {
        let mut config = Config::default();
        config.forgetting.alpha_1 = Some(0.1);
        config.forgetting.alpha_2_per_n = Some(50.0);
        config.forgetting.alpha_3_n = Some(0.2);
        ForgettingParams::validate(&config, 0.001).unwrap()
    }

    #[test]
    fn small_errors_keep_the_past_and_large_ones_drop_it() {
        let p = params();
        let alpha_1 = f64::from(0.1_f32);
        // 1 − α₁·(½ − arctan(10)/π) at zero error, half way at α₃, 1 − α₁ far above.
        assert!((p.beta(0.0, 1.0) - (1.0 - alpha_1 * 0.031_725_5)).abs() < 1e-6);
        assert!((p.beta(f64::from(0.2_f32), 1.0) - (1.0 - 0.5 * alpha_1)).abs() < 1e-9);
        assert!((p.beta(1e6, 1.0) - (1.0 - alpha_1)).abs() < 1e-8);
    }

    #[test]
    fn the_sign_of_the_error_does_not_matter() {
        let p = params();
        assert_eq!(p.beta(0.3, 1.0), p.beta(-0.3, 1.0));
    }
}
