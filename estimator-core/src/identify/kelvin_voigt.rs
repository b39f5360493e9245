//! Kelvin–Voigt by recursive least squares: y = F, φ = [δ, δ̇], (1) and (20)–(24).

use nalgebra::Vector2;

use super::{Confidence, ForceNoise, Identify, Instant};
use crate::config::Params;
use crate::estimate::PARAMETER_SLOTS;
use crate::rls::{Excitation, Rls};
use crate::scalar::Real;
use crate::status::Judged;

/// The linear estimator, scaled: θ = [K, λ].
#[derive(Clone, Debug)]
pub struct Linear<T: Real> {
    rls: Rls<T, 2>,
    confidence: Confidence<T, 2>,
    excitation: Excitation<T, 2>,
}

impl<T: Real> Linear<T> {
    /// θ̂(0) and P(0) from the configuration.
    pub fn new(params: &Params<T>) -> Self {
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
    fn predict(&self, at: &Instant<T>, noise: &ForceNoise<T>) -> (T, T) {
        let phi = regressor(at);
        (
            self.rls.predict(&phi),
            self.confidence.force_variance(&phi, noise),
        )
    }

    fn learn(
        &mut self,
        params: &Params<T>,
        at: &Instant<T>,
        _noise: &ForceNoise<T>,
        beta: T,
    ) -> bool {
        let phi = regressor(at);
        let moving = self.excitation.admits(&phi, params.excitation_step);
        if moving {
            self.rls.update(&phi, at.force, beta);
            self.confidence.update(&phi, -self.rls.theta.x, beta);
        }
        moving
    }

    fn judged(&self, noise: &ForceNoise<T>, surface_error: T) -> [Judged<T>; PARAMETER_SLOTS] {
        let errors = self.confidence.std_errors(noise, surface_error);
        let theta = &self.rls.theta;
        let mut judged = [Judged::default(); PARAMETER_SLOTS];
        for ((slot, value), std_error) in judged.iter_mut().zip(theta.iter()).zip(errors.iter()) {
            *slot = Judged {
                value: *value,
                std_error: *std_error,
                scale: size(*value, theta.x),
            };
        }
        judged
    }
}

/// What an error of a stiffness or damping is compared with: its value, but at least a tenth of the
/// stiffness, since at the reference speed a damping smaller than that is a force that hardly
/// counts.
pub(super) fn size<T: Real>(value: T, stiffness: T) -> T {
    value
        .magnitude()
        .max_of(T::from_f64(0.1) * stiffness.magnitude())
}
