//! Hunt–Crossley by one recursive least squares on the logarithm of the force (Haddadi &
//! Hashtrudi-Zaad 2012).
//!
//! ln F = ln K + n·ln d + ln(1 + λw/K) ≈ ln K + (λ/K)·w + n·ln d: linear in (ln K, λ/K, n) as long as
//! the damping is a small share of the force. On gel it is not (1 + λw/K goes from
//! 0.6 to 1.4), and K is 5 % low. This is a baseline and no recommendation.

use nalgebra::{Vector2, Vector3};

use super::bounds::{EXPONENT, within};
use super::params::IdentifyParams;
use super::slots::{damper, in_slots, spring};
use super::{Confidence, Identify, Instant};
use crate::estimate::method::{MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::{Excitation, Rls};
use crate::maths::scalar::Real;

/// Bound of |ln K|: single precision can hold the power.
const LOG_STIFFNESS: f64 = 30.0;

methods! {
    /// Hunt–Crossley by one recursive least squares on the logarithm of the force.
    // Listed, its name would make the refusal of another one wider than a terminal.
    HUNT_CROSSLEY_LOG_LINEAR = 9, HuntCrossley, "log_linear",
        "Recursive least squares on the logarithm of the force, a baseline",
        offer: Offer::Unlisted;
}

/// The log-linear estimator of Hunt–Crossley, scaled: θ = [ln K, λ/K, n].
#[derive(Clone, Debug)]
pub struct LogLinear<T: Real> {
    rls: Rls<T, 3>,
    confidence: Confidence<T, 3>,
    excitation: Excitation<T, 2>,
}

impl<T: Real> LogLinear<T> {
    /// The estimator before the first contact, with θ̂(0) and P(0) of the configuration.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = params.start;
        let stiffness = T::from_f64(1e-6).max_of(start.stiffness);
        let theta = Vector3::new(stiffness.ln(), start.damping / stiffness, start.exponent);
        LogLinear {
            rls: Rls::new(theta, start.covariance),
            confidence: Confidence::new(start.covariance),
            excitation: Excitation::default(),
        }
    }

    /// The estimates K, λ and n within their bounds.
    fn values(&self) -> [T; 3] {
        let [log, share, exponent]: [T; 3] = self.rls.theta.into();
        let stiffness = within(log, (-LOG_STIFFNESS, LOG_STIFFNESS)).exp();
        let exponent = within(exponent, EXPONENT);
        [stiffness, share * stiffness, exponent]
    }

    /// The gradient of F by (K, λ, n), F and ∂F/∂x₀, for d > 0.
    fn gradient(&self, at: &Instant<T>) -> (Vector3<T>, T, T) {
        let [stiffness, damping, exponent] = self.values();
        let shape = at.depth.pow_positive(exponent);
        let force = (stiffness + damping * at.speed) * shape;
        let gradient = Vector3::new(shape, shape * at.speed, force * at.depth.ln());
        (gradient, force, -(exponent * force / at.depth))
    }
}

impl<T: Real> Identify<T> for LogLinear<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        if at.depth <= T::zero() {
            return (T::zero(), T::zero());
        }
        let (gradient, force, by_surface) = self.gradient(at);
        let shift = by_surface * at.surface_error;
        let variance = self.confidence.force_variance(&gradient, &at.noise) + shift * shift;
        (force, variance)
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        let moving = Vector2::new(at.depth, at.speed);
        let deep = at.depth > T::zero() && at.force > T::zero();
        if !deep || !self.excitation.admits(&moving, params.excitation_step) {
            return None;
        }
        let phi = Vector3::new(T::one(), at.speed, at.depth.ln());
        self.rls.update(&phi, at.force.ln(), beta);
        let (gradient, _, by_surface) = self.gradient(at);
        self.confidence.update(&gradient, by_surface, beta);
        Some(beta)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        let covariance = params.start.covariance;
        self.rls = Rls::new(self.rls.theta, covariance);
        self.confidence = Confidence::new(covariance);
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let errors = self.confidence.std_errors(&at.noise, at.surface_error);
        let [stiffness, damping, exponent] = self.values();
        let bounded = exponent != self.rls.theta.z;
        let exponent = (exponent, if bounded { T::zero() } else { T::one() });
        let values = [spring(stiffness), damper(damping, stiffness), exponent];
        in_slots(&values, errors.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::Config;
    use crate::estimate::identify::ForceNoise;

    const NOISE: ForceNoise<f64> = ForceNoise {
        raw: 0.02,
        filtered: 0.007,
    };

    /// 5 s of 1.2 Hz strokes of a law with a damping of `damping`, scaled, without noise.
    fn palpated(damping: f64) -> [f64; 3] {
        let params = Config::default().validate().unwrap().identify;
        let mut log_linear = LogLinear::<f64>::new(&params);
        for i in 0..5000 {
            let angle = core::f64::consts::TAU * 1.2e-3 * f64::from(i);
            let depth = 0.05 + 2.0 * (1.0 - libm::cos(angle));
            let speed = 1.5 * libm::sin(angle);
            let force = (1.35 + damping * speed) * libm::pow(depth, 1.35);
            let at = Instant {
                depth,
                speed,
                force,
                noise: NOISE,
                ..Instant::default()
            };
            log_linear.learn(&params, &at, 0.9995);
        }
        log_linear.values()
    }

    #[test]
    fn a_little_damping_is_found_and_gel_is_biased_by_what_the_logarithm_leaves_out() {
        // λw/K up to 0.011: ½(λw/K)² is 6e-5.
        let [stiffness, damping, exponent] = palpated(0.01);
        assert!((stiffness / 1.35 - 1.0).abs() < 1e-4, "{stiffness}");
        assert!((damping / 0.01 - 1.0).abs() < 1e-2, "{damping}");
        assert!((exponent - 1.35).abs() < 1e-4, "{exponent}");
        // Gel, λw/K up to 0.4: K loses the mean of ½(λw/K)², 4 %.
        let bent = 1.0 - palpated(0.36)[0] / 1.35;
        assert!((0.02..0.08).contains(&bent), "{bent}");
    }
}
