//! Kelvin–Voigt by recursive least squares: y = F, φ = [δ, δ̇], (1) and (20)–(24).

use nalgebra::Vector2;

use super::params::IdentifyParams;
use super::{Confidence, ForceNoise, Identify, Instant};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::{Excitation, Rls};
use crate::maths::scalar::Real;

/// The linear estimator, scaled: θ = [K, λ].
#[derive(Clone, Debug)]
pub struct Linear<T: Real> {
    rls: Rls<T, 2>,
    confidence: Confidence<T, 2>,
    excitation: Excitation<T, 2>,
}

impl<T: Real> Linear<T> {
    /// θ̂(0) and P(0) from the configuration.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = params.start;
        Linear {
            rls: Rls::new(
                Vector2::new(start.stiffness, start.damping),
                start.covariance,
            ),
            confidence: Confidence::new(start.covariance),
            excitation: Excitation::default(),
        }
    }
}

fn regressor<T: Real>(at: &Instant<T>) -> Vector2<T> {
    Vector2::new(at.depth, at.speed)
}

impl<T: Real> Identify<T> for Linear<T> {
    fn predict(&self, at: &Instant<T>, noise: &ForceNoise<T>, surface_error: T) -> (T, T) {
        let phi = regressor(at);
        let by_surface = self.rls.theta.x * surface_error;
        let variance = self.confidence.force_variance(&phi, noise) + by_surface * by_surface;
        (self.rls.predict(&phi), variance)
    }

    fn learn(
        &mut self,
        params: &IdentifyParams<T>,
        at: &Instant<T>,
        _noise: &ForceNoise<T>,
        beta: T,
    ) -> Option<T> {
        let phi = regressor(at);
        let moving = self.excitation.admits(&phi, params.excitation_step);
        if moving {
            self.rls.update(&phi, at.force, beta);
            self.confidence.update(&phi, -self.rls.theta.x, beta);
        }
        moving.then_some(beta)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>) {
        let covariance = params.start.covariance;
        self.rls = Rls::new(self.rls.theta, covariance);
        self.confidence = Confidence::new(covariance);
    }

    fn estimates(
        &self,
        noise: &ForceNoise<T>,
        surface_error: T,
    ) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let errors = self.confidence.std_errors(noise, surface_error);
        let [stiffness, damping]: [T; 2] = self.rls.theta.into();
        estimates(
            &[spring(stiffness), damper(damping, stiffness)],
            errors.iter(),
        )
    }
}

/// What an error of a stiffness or damping is compared with: its value, but at least a tenth of the
/// stiffness, since at the reference speed a damping smaller than that is a force that hardly
/// counts.
pub(super) fn size<T: Real>(value: T, stiffness: T) -> T {
    value.abs().max_of(T::from_f64(0.1) * stiffness.abs())
}

/// A stiffness and its size.
pub(super) fn spring<T: Real>(stiffness: T) -> (T, T) {
    (stiffness, size(stiffness, stiffness))
}

/// A damping and its size.
pub(super) fn damper<T: Real>(damping: T, stiffness: T) -> (T, T) {
    (damping, size(damping, stiffness))
}

/// Values with their sizes, and standard errors, in the order of the law's slots.
pub(super) fn estimates<'a, T: Real>(
    values: &[(T, T)],
    errors: impl Iterator<Item = &'a T>,
) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
    let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
    for ((slot, (value, scale)), std_error) in estimates.iter_mut().zip(values).zip(errors) {
        *slot = ParameterEstimate {
            value: *value,
            std_error: *std_error,
            scale: *scale,
        };
    }
    estimates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::Config;

    #[test]
    fn spring_and_damper_are_told_apart() {
        let params = Config::default().validate().unwrap().identify;
        let mut linear = Linear::<f64>::new(&params);
        let noise = ForceNoise {
            raw: 0.02,
            filtered: 0.007,
        };
        for i in 1..=500 {
            let angle = 7.5e-3 * f64::from(i);
            let (depth, speed) = (1.0 - libm::cos(angle), libm::sin(angle));
            let at = Instant {
                depth,
                speed,
                force: 2.26 * depth + 1.23 * speed,
                ..Instant::default()
            };
            assert!(linear.learn(&params, &at, &noise, 0.999).is_some());
        }
        let [stiffness, damping, ..] = linear.estimates(&noise, 0.0);
        // P(0) = 10⁴ is worth 10⁻⁴ of one sample.
        assert!((stiffness.value - 2.26).abs() < 1e-5);
        assert!((damping.value - 1.23).abs() < 1e-5);
        assert!(stiffness.observable() && damping.observable());
    }

    #[test]
    fn a_hold_teaches_nothing() {
        let params = Config::default().validate().unwrap().identify;
        let mut linear = Linear::<f64>::new(&params);
        let noise = ForceNoise {
            raw: 0.02,
            filtered: 0.007,
        };
        let at = Instant {
            depth: 2.0,
            speed: 0.0,
            force: 4.0,
            ..Instant::default()
        };
        let learned = (0..100_000)
            .filter(|_| linear.learn(&params, &at, &noise, 0.96).is_some())
            .count();
        assert!(learned < 100, "{learned}");
    }
}
