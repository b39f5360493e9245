//! Kelvin–Voigt by recursive least squares: y = F, φ = [δ, δ̇], (1) and (20)–(24).

use nalgebra::Vector2;

use super::{Confidence, Identify, Instant};
use super::{params::IdentifyParams, slots::damper, slots::in_slots, slots::spring};
use crate::estimate::method::{Method, MethodInfo, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::{Excitation, Rls};
use crate::maths::scalar::Real;

methods! {
    /// Kelvin–Voigt by recursive least squares, the surface taken from the impact.
    KELVIN_VOIGT = 1, KelvinVoigt, "rls", "Recursive least squares, the surface from the impact";
}

/// The estimator of Kelvin–Voigt at a given surface, scaled: θ = [K, λ].
#[derive(Clone, Debug)]
pub struct Linear<T: Real> {
    rls: Rls<T, 2>,
    confidence: Confidence<T, 2>,
    excitation: Excitation<T, 2>,
}

impl<T: Real> Linear<T> {
    /// The estimator before the first contact, with θ̂(0) and P(0) of the configuration.
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
    const METHODS: &'static [MethodInfo] = METHODS;

    /// A surface that is configured need not be found.
    fn runs(params: &IdentifyParams<T>) -> bool {
        let known = params.method == Method::KELVIN_VOIGT_SURFACE && params.surface_known;
        known || params.method == Method::KELVIN_VOIGT
    }

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        let phi = regressor(at);
        let by_surface = self.rls.theta.x * at.surface_error;
        let variance = self.confidence.force_variance(&phi, &at.noise) + by_surface * by_surface;
        (self.rls.predict(&phi), variance)
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        let phi = regressor(at);
        let moving = self.excitation.admits(&phi, params.excitation_step);
        if moving {
            self.rls.update(&phi, at.force, beta);
            self.confidence.update(&phi, -self.rls.theta.x, beta);
        }
        moving.then_some(beta)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        let covariance = params.start.covariance;
        self.rls = Rls::new(self.rls.theta, covariance);
        self.confidence = Confidence::new(covariance);
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let errors = self.confidence.std_errors(&at.noise, at.surface_error);
        let [stiffness, damping]: [T; 2] = self.rls.theta.into();
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
    use crate::estimate::identify::ForceNoise;

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
                noise,
                ..Instant::default()
            };
            assert!(linear.learn(&params, &at, 0.999).is_some());
        }
        let [stiffness, damping, ..] = linear.estimates(&Instant::uncertain(noise, 0.0));
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
            noise,
            ..Instant::default()
        };
        let learned = (0..100_000)
            .filter(|_| linear.learn(&params, &at, 0.96).is_some())
            .count();
        assert!(learned < 100, "{learned}");
    }
}
