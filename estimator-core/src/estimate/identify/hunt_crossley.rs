//! Hunt–Crossley by two recursive least squares in feedback, (25)–(37).
//!
//! Γ₁ estimates [K, λ] from y₁ = F, φ₁ = [δ₀(δ/δ₀)ⁿ̂, (δ/δ₀)ⁿ̂δ̇];
//! Γ₂ estimates n from y₂ = ln(F/(K̂δ₀ + λ̂δ̇)), φ₂ = ln(δ/δ₀).
//! Each uses the other's latest estimate. Both forget by (24) with the same error |F − F̂|.

use nalgebra::{Vector1, Vector2, Vector3};

use super::bounds::{EXPONENT, within};
use super::params::IdentifyParams;
use super::slots::{damper, in_slots, spring};
use super::{Confidence, Identify, Instant};
use crate::estimate::method::{MethodInfo, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::rls::{Excitation, Rls};
use crate::maths::scalar::Real;

/// Γ₂ learns from forces above this many standard deviations of the filtered force: the logarithm of
/// a noisy force is biased by −σ²/2F², 0.03 % of a unit of n at 40σ and ln(δ/δ₀) = −1.
pub(super) const LOG_SIGMAS: f64 = 40.0;
/// Γ₂ learns from samples on which damping is less than this share of the spring: K̂δ₀ + λ̂δ̇ must be
/// positive and not small.
const DAMPING_SHARE: f64 = 0.8;

methods! {
    /// Hunt–Crossley by two recursive least squares in feedback, (25)–(37).
    HUNT_CROSSLEY_TWO_STAGE = 2, HuntCrossley, "two_stage", "Two recursive least squares in feedback",
        alpha_1: 0.03;
}

/// The chapter's two-stage estimator of Hunt–Crossley, scaled: θ₁ = [K, λ], θ₂ = n.
#[derive(Clone, Debug)]
pub struct TwoStage<T: Real> {
    gamma_1: Rls<T, 2>,
    gamma_2: Rls<T, 1>,
    confidence: Confidence<T, 3>,
    excitation: Excitation<T, 2>,
}

/// The two factors of F = (K + λw)·dⁿ at an instant, with the current estimates.
struct Split<T> {
    /// (δ/δ₀)^n̂
    shape: T,
    /// K̂ + λ̂w
    modulus: T,
    /// n̂ within bounds
    exponent: T,
}

impl<T: Real> TwoStage<T> {
    /// The estimator before the first contact, with θ̂(0) and P(0) of the configuration.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let start = params.start;
        TwoStage {
            gamma_1: Rls::new(
                Vector2::new(start.stiffness, start.damping),
                start.covariance,
            ),
            gamma_2: Rls::new(Vector1::new(start.exponent), start.covariance),
            confidence: Confidence::new(start.covariance),
            excitation: Excitation::default(),
        }
    }

    fn exponent(&self) -> T {
        within(self.gamma_2.theta.x, EXPONENT)
    }

    fn split(&self, at: &Instant<T>) -> Split<T> {
        let exponent = self.exponent();
        let theta = &self.gamma_1.theta;
        Split {
            shape: at.depth.pow_positive(exponent),
            modulus: theta.x + theta.y * at.speed,
            exponent,
        }
    }

    /// The derivative ∂F/∂x₀, for d > 0.
    fn by_surface(at: &Instant<T>, split: &Split<T>) -> T {
        -(split.exponent * split.modulus * split.shape / at.depth)
    }

    /// The gradient of F by (K, λ, n), for d > 0.
    fn gradient(at: &Instant<T>, split: &Split<T>) -> Vector3<T> {
        let force = split.modulus * split.shape;
        Vector3::new(split.shape, split.shape * at.speed, force * at.depth.ln())
    }
}

impl<T: Real> Identify<T> for TwoStage<T> {
    const METHODS: &'static [MethodInfo] = METHODS;

    fn predict(&self, at: &Instant<T>) -> (T, T) {
        if at.depth <= T::zero() {
            return (T::zero(), T::zero());
        }
        let split = self.split(at);
        let by_surface = Self::by_surface(at, &split) * at.surface_error;
        let gradient = Self::gradient(at, &split);
        let variance =
            self.confidence.force_variance(&gradient, &at.noise) + by_surface * by_surface;
        (split.modulus * split.shape, variance)
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        if at.depth <= T::zero() {
            return None;
        }
        let Split { shape, .. } = self.split(at);
        let phi_1 = Vector2::new(shape, shape * at.speed);
        if !self.excitation.admits(&phi_1, params.excitation_step) {
            return None;
        }
        self.gamma_1.update(&phi_1, at.force, beta);

        let split = self.split(at);
        let theta = &self.gamma_1.theta;
        let spring_leads = (theta.y * at.speed).abs() < T::from_f64(DAMPING_SHARE) * theta.x;
        if spring_leads && at.force > T::from_f64(LOG_SIGMAS) * at.noise.filtered {
            let y_2 = (at.force / split.modulus).ln();
            if y_2.is_finite() {
                self.gamma_2.update(&Vector1::new(at.depth.ln()), y_2, beta);
            }
        }

        let by_surface = Self::by_surface(at, &split);
        self.confidence
            .update(&Self::gradient(at, &split), by_surface, beta);
        Some(beta)
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        let covariance = params.start.covariance;
        self.gamma_1 = Rls::new(self.gamma_1.theta, covariance);
        self.gamma_2 = Rls::new(self.gamma_2.theta, covariance);
        self.confidence = Confidence::new(covariance);
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let errors = self.confidence.std_errors(&at.noise, at.surface_error);
        let [stiffness, damping]: [T; 2] = self.gamma_1.theta.into();
        // An exponent at its bound is not an estimate: a scale of 0 makes it not observable.
        let bounded = self.exponent() != self.gamma_2.theta.x;
        let exponent = (self.exponent(), if bounded { T::zero() } else { T::one() });
        let values = [spring(stiffness), damper(damping, stiffness), exponent];
        in_slots(&values, errors.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::config::Config;
    use crate::estimate::identify::ForceNoise;
    use crate::physics::law::{ContactLaw, HuntCrossley};

    const NOISE: ForceNoise<f64> = ForceNoise {
        raw: 0.02,
        filtered: 0.007,
    };

    /// 20 s of 1.2 Hz strokes on gel, without noise, scaled by 1 mm, 10 mm/s and 1 N.
    fn palpate(stages: &mut TwoStage<f64>, params: &IdentifyParams<f64>) {
        let gel = HuntCrossley::new(1350.0, 36.0, 1.35, 1e-3);
        for i in 0..20_000 {
            let angle = core::f64::consts::TAU * 1.2 * f64::from(i) * 1e-3;
            let depth_m = 2e-3 * (1.0 - libm::cos(angle));
            let speed_mps = 2e-3 * core::f64::consts::TAU * 1.2 * libm::sin(angle);
            let force = gel.force_n(depth_m, speed_mps);
            let at = Instant {
                depth: depth_m / 1e-3,
                speed: speed_mps / 0.01,
                force,
                noise: NOISE,
                ..Instant::default()
            };
            let beta = params
                .forgetting
                .beta(force - stages.predict(&at).0, NOISE.raw);
            stages.learn(params, &at, beta);
        }
    }

    #[test]
    fn the_two_stages_agree_on_the_material() {
        let params = Config::default().validate().unwrap().identify;
        let mut stages = TwoStage::new(&params);
        palpate(&mut stages, &params);
        let [stiffness, damping, exponent, ..] = stages.estimates(&Instant::uncertain(NOISE, 0.0));
        // Once its error is below α₃ the feedback closes slowly: 0.9 % of K after 6 s, 0.25 % now.
        assert!((stiffness.value / 1.35 - 1.0).abs() < 3e-3, "{stiffness:?}");
        assert!((damping.value / 0.36 - 1.0).abs() < 3e-3, "{damping:?}");
        assert!((exponent.value - 1.35).abs() < 3e-3, "{exponent:?}");
    }

    #[test]
    fn at_the_reference_depth_the_second_stage_is_blind() {
        // ln(δ/δ₀) = 0: n̂ must stay where it is, whatever the force.
        let params = Config::default().validate().unwrap().identify;
        let mut stages = TwoStage::<f64>::new(&params);
        for i in 0..100 {
            let speed = 0.1 * f64::from(i % 7);
            let at = Instant {
                depth: 1.0,
                speed,
                force: 5.0,
                noise: NOISE,
                ..Instant::default()
            };
            stages.learn(&params, &at, 0.99);
        }
        let exponent = stages.estimates(&Instant::uncertain(NOISE, 0.0))[2];
        assert!((exponent.value - f64::from(1.3_f32)).abs() < 1e-12);
        assert!(!exponent.observable());
    }

    #[test]
    fn a_surface_that_may_be_off_widens_every_error() {
        let params = Config::default().validate().unwrap().identify;
        let mut stages = TwoStage::new(&params);
        palpate(&mut stages, &params);
        let (sure, unsure) = (
            stages.estimates(&Instant::uncertain(NOISE, 0.0)),
            stages.estimates(&Instant::uncertain(NOISE, 0.05)),
        );
        for (sure, unsure) in sure.iter().zip(&unsure).take(3) {
            assert!(
                unsure.std_error > 5.0 * sure.std_error,
                "{sure:?} {unsure:?}"
            );
        }
    }
}
