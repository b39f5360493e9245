//! How certain the parameters are, given the noise of the force and the error of the surface.

use nalgebra::SVector;

use super::ForceNoise;
use crate::estimate::rls::Ud;
use crate::maths::scalar::Real;

/// Standard errors of `N` parameters.
///
/// They have two parts. The first is the noise: P·σ², with P the inverse of Σβ^(N−h) ∇F ∇Fᵀ over
/// *all* parameters together (each stage of a two-stage estimator alone would claim too much), and σ
/// that of the raw force: filtering makes neighbours alike, so a filtered sample is worth no more
/// than a raw one. The second is the surface: an error of x₀ is not noise, it moves every sample
/// alike and the estimates by −P·Σβ^(N−h) ∇F ∂F/∂x₀ (a considered parameter, Schmidt 1966).
#[derive(Clone, Debug)]
pub struct Confidence<T: Real, const N: usize> {
    covariance: Ud<T, N>,
    surface_moment: SVector<T, N>,
}

impl<T: Real, const N: usize> Confidence<T, N> {
    /// The state before the first sample, P = `covariance`·I.
    pub fn new(covariance: T) -> Self {
        Confidence {
            covariance: Ud::new(covariance),
            surface_moment: SVector::repeat(T::zero()),
        }
    }

    /// Takes one sample: the gradient of F by the parameters, and ∂F/∂x₀.
    pub fn update(&mut self, gradient: &SVector<T, N>, by_surface: T, beta: T) {
        self.covariance.update(gradient, beta, T::one());
        self.surface_moment = self.surface_moment * beta + gradient * by_surface;
    }

    /// Variance of a predicted force whose gradient is `gradient`.
    pub fn force_variance(&self, gradient: &SVector<T, N>, noise: &ForceNoise<T>) -> T {
        self.covariance.variance(gradient) * noise.raw * noise.raw
    }

    /// Standard errors of the parameters for a noise and a standard error of the surface, all scaled.
    pub fn std_errors(&self, noise: &ForceNoise<T>, surface_error: T) -> SVector<T, N> {
        let mut errors = self.covariance.variances() * (noise.raw * noise.raw);
        if surface_error > T::zero() {
            let shift = self.covariance.matrix() * self.surface_moment * surface_error;
            for (error, by_surface) in errors.iter_mut().zip(shift.iter()) {
                *error += *by_surface * *by_surface;
            }
        }
        errors.map(Real::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    const NOISE: ForceNoise<f64> = ForceNoise {
        raw: 0.02,
        filtered: 0.007,
    };

    #[test]
    fn without_a_surface_error_it_is_the_textbook_standard_error() {
        // y = a + b·t at t = 0…9: var(b) = σ²/Σ(t − t̄)² = σ²/82.5.
        let mut confidence = Confidence::new(1e9);
        for i in 0..10 {
            confidence.update(&Vector2::new(1.0, f64::from(i)), 0.0, 1.0);
        }
        let expected = 0.02 / libm::sqrt(82.5);
        // The prior 1e9 is worth 1e-9 of the information.
        assert!((confidence.std_errors(&NOISE, 0.0)[1] / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_surface_error_moves_a_spring_by_its_own_size() {
        // F = Kδ at one depth d: an error e of the surface changes K by K·e/d.
        let (stiffness, depth, error) = (2.0_f64, 1.6, 0.05);
        let mut confidence = Confidence::new(1e9);
        for _ in 0..100 {
            confidence.update(&nalgebra::Vector1::new(depth), -stiffness, 1.0);
        }
        let quiet = ForceNoise {
            raw: 0.0,
            filtered: 0.0,
        };
        let moved = confidence.std_errors(&quiet, error)[0];
        assert!((moved - stiffness * error / depth).abs() < 1e-9, "{moved}");
    }
}
