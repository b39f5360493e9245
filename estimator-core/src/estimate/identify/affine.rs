//! Kelvin–Voigt with an unknown surface: F = K(x − x₀) + λδ̇ is linear in (K, λ, −Kx₀), so that one
//! recursive least squares finds all three exactly.

use nalgebra::Vector3;

use super::{ForceNoise, Identify, Instant};
use super::{params::IdentifyParams, slots::damper, slots::in_slots, slots::spring};
use crate::estimate::method::{MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::{Excitation, Rls};
use crate::maths::scalar::Real;

/// Forgetting factor of a memory of 50 000 samples: the estimates of one material only get better,
/// and another material clears the covariance.
const BETA: f64 = 0.99998;

methods! {
    /// Kelvin–Voigt by recursive least squares, the surface among the parameters.
    KELVIN_VOIGT_SURFACE = 6, KelvinVoigt, "rls_surface", "Recursive least squares, surface included",
        offer: Offer::Default, finds_surface: true;
}

/// The estimator of Kelvin–Voigt with the surface, scaled: θ = [K, λ, −K·(x₀ − origin)], where the
/// origin is the first impact.
#[derive(Clone, Debug)]
pub struct Affine<T: Real> {
    rls: Rls<T, 3>,
    origin: Option<T>,
    excitation: Excitation<T, 3>,
}

impl<T: Real> Affine<T> {
    /// The estimator before the first contact, with θ̂(0) and P(0) of the configuration.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = params.start;
        let theta = Vector3::new(start.stiffness, start.damping, T::zero());
        Affine {
            rls: Rls::new(theta, start.covariance),
            origin: None,
            excitation: Excitation::default(),
        }
    }

    fn regressor(&self, at: &Instant<T>) -> Vector3<T> {
        let origin = self.origin.unwrap_or(at.surface);
        Vector3::new(at.position() - origin, at.speed, T::one())
    }
}

impl<T: Real> Identify<T> for Affine<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn surface(&self, noise: &ForceNoise<T>) -> Option<(T, T)> {
        let origin = self.origin?;
        let [stiffness, _, offset]: [T; 3] = self.rls.theta.into();
        if stiffness <= T::zero() {
            return None;
        }
        let away = -(offset / stiffness);
        // x₀ = −c/K: its gradient by (K, c) is −(x₀, 1)/K.
        let slope = Vector3::new(away, T::zero(), T::one()) / stiffness;
        let error = self.rls.covariance.variance(&slope).sqrt() * noise.raw;
        Some((origin + away, error))
    }

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        let phi = self.regressor(at);
        let variance = self.rls.covariance.variance(&phi) * at.noise.raw * at.noise.raw;
        (self.rls.predict(&phi), variance)
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, _beta: T) -> Option<T> {
        self.origin.get_or_insert(at.surface);
        let phi = self.regressor(at);
        if !self.excitation.admits(&phi, params.excitation_step) {
            return None;
        }
        let beta = T::from_f64(BETA);
        self.rls.update(&phi, at.force, beta);
        Some(beta)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        *self = Affine::new(params);
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let errors = self.rls.covariance.variances().map(Real::sqrt) * at.noise.raw;
        let [stiffness, damping, _]: [T; 3] = self.rls.theta.into();
        in_slots(
            &[spring(stiffness), damper(damping, stiffness)],
            errors.iter(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::Config;

    const NOISE: ForceNoise<f64> = ForceNoise {
        raw: 0.02,
        filtered: 0.007,
    };

    /// A spring of 2.48 and a damper of 0.17 whose surface lies 0.07 before the impact.
    fn touch(i: u32) -> Instant<f64> {
        let angle = 7.5e-3 * f64::from(i);
        let (depth, speed) = (1.1 - libm::cos(angle), libm::sin(angle));
        let force = 2.48 * (depth + 0.07) + 0.17 * speed;
        Instant {
            depth,
            speed,
            force,
            surface: 5.0,
            noise: NOISE,
            ..Instant::default()
        }
    }

    #[test]
    fn spring_damper_and_surface_are_exact() {
        let params = Config::default().validate().unwrap().identify;
        let mut affine = Affine::<f64>::new(&params);
        for i in 0..2000 {
            affine.learn(&params, &touch(i), 0.9);
        }
        let [stiffness, damping, ..] = affine.estimates(&Instant::uncertain(NOISE, 0.0));
        // P(0) = 10⁴ is worth 10⁻⁴ of one sample.
        assert!((stiffness.value - 2.48).abs() < 1e-6 && (damping.value - 0.17).abs() < 1e-6);
        let (position, std_error) = affine.surface(&NOISE).unwrap();
        let position_m = position * params.scale.depth_m;
        assert!((position_m - 4.93e-3).abs() < 1e-9, "{position_m}");
        // 2000 samples of 0.02 N on 2.48 N/mm: about 0.02/2.48/√2000 mm, times 2 for the slope.
        let std_error_m = std_error * params.scale.depth_m;
        assert!((1e-7..1e-6).contains(&std_error_m), "{std_error_m}");
    }
}
