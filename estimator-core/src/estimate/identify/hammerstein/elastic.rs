//! Γ₁, the elastic response F⁽ᵉ⁾ = γ₁δ^γ₂, from the samples of a fast press, (39)–(40).

use nalgebra::{Matrix2, Vector2, Vector3};

use super::split_force::SplitForce;
use crate::estimate::{
    config::Weight, identify::bounds::EXPONENT, identify::bounds::within,
    identify::contract::ForceNoise, identify::contract::Instant,
    identify::equation_error::Equation, identify::equation_error::EquationError,
    identify::hunt_crossley::LOG_SIGMAS, identify::params::IdentifyParams,
    identify::params::SPEED_PER_DEPTH, identify::slots::size, monitor::ParameterEstimate,
};
use crate::maths::scalar::Real;

/// Bound of |ln γ₁|, with γ₁ in units of the reference force.
const LOG_STIFFNESS: f64 = 20.0;

/// Γ₁ learns from depths of at least this many half windows of the filter: there the mean of δⁿ over
/// the window exceeds the power of the mean δ by n(n−1)/2·0.2/16, 0.5 % at n = 3/2.
const MIN_HALF_WINDOWS: f64 = 4.0;
/// Variance of time within the filter's window over the square of its half width: ⅕ for the weights
/// of a parabola.
const WINDOW_VARIANCE: f64 = 0.2;

/// The first stage: recursive least squares for y₁ = ln F, φ₁ = [1, ln δ], θ₁ = [ln γ₁, γ₂].
///
/// What it neglects are its considered quantities: the surface, the relaxation during the press, and
/// the filter's window.
#[derive(Clone, Debug)]
pub(super) struct ElasticStage<T: Real> {
    gamma_1: EquationError<T, 2, 3>,
    weight: Weight,
    /// Half of the filter's memory, as the depth that a scaled speed of 1 covers in it.
    window: T,
}

impl<T: Real> ElasticStage<T> {
    pub(super) fn new(params: &IdentifyParams<T>, half_window_s: T) -> Self {
        let start = params.start;
        let least = T::from_f64(libm::exp(-LOG_STIFFNESS));
        let log_stiffness = least.max_of(start.stiffness).ln();
        ElasticStage {
            gamma_1: EquationError::new(
                Vector2::new(log_stiffness, start.exponent),
                start.covariance,
            ),
            weight: params.cascade.weight,
            window: half_window_s * T::from_f64(SPEED_PER_DEPTH),
        }
    }

    /// ln γ̂₁ and γ̂₂ within their bounds.
    fn parameters(&self) -> (T, T) {
        let theta = &self.gamma_1.rls.theta;
        (
            within(theta.x, (-LOG_STIFFNESS, LOG_STIFFNESS)),
            within(theta.y, EXPONENT),
        )
    }

    /// Splits the force at a depth d > 0 into F̂⁽ᵉ⁾ and what has relaxed.
    pub(super) fn split(&self, at: &Instant<T>) -> SplitForce<T> {
        let (log_stiffness, exponent) = self.parameters();
        let log_depth = at.depth.ln();
        let elastic = (log_stiffness + exponent * log_depth).exp();
        SplitForce {
            relaxed: at.force - elastic,
            elastic,
            gradient: Vector3::new(
                elastic,
                elastic * log_depth,
                -(exponent * elastic / at.depth),
            ),
        }
    }

    /// Learns from one sample of a press.
    pub(super) fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>) {
        // The filter averages F and δ; the average of a power is the power of the average only where
        // the window is short against the depth.
        let window = at.speed * self.window;
        let short = window * T::from_f64(MIN_HALF_WINDOWS) < at.depth;
        if !short || at.force <= T::from_f64(LOG_SIGMAS) * at.noise.filtered {
            return;
        }
        let weight = match self.weight {
            Weight::Force => at.force,
            Weight::ForceSquared => at.force * at.force,
        };
        let equation = Equation {
            phi: Vector2::new(T::one(), at.depth.ln()),
            y: at.force.ln(),
            by_noise: [T::one() / at.force, T::zero(), T::zero()],
            by_considered: self.by_neglected(at),
        };
        // Γ₁ forgets by its own error: F̂ of the cascade follows F whatever the elastic response is.
        let beta = params.forgetting.beta(
            self.split(at).relaxed * params.scale.force_n,
            at.noise.raw * params.scale.force_n,
        );
        self.gamma_1.update(&equation, beta, weight);
    }

    /// ∂ε of Γ₁ by what it neglects: the surface; Σcᵢνᵢ, since with δ ∝ t the force F⁽ᵉ⁾ ∝ tⁿ loses
    /// Σcᵢνᵢ·t/(n+1) during the press; and the filter's window, over which the mean of δⁿ is larger
    /// than (the mean of δ)ⁿ.
    fn by_neglected(&self, at: &Instant<T>) -> Vector3<T> {
        let n = self.parameters().1;
        let time_s = at.depth / (at.speed * T::from_f64(SPEED_PER_DEPTH));
        let window = at.speed * self.window / at.depth;
        Vector3::new(
            n / at.depth,
            -time_s / (n + T::one()),
            T::from_f64(0.5 * WINDOW_VARIANCE) * n * (n - T::one()) * window * window,
        )
    }

    /// Covariance of θ̂₁ by noise, by a relaxation of Σcᵢνᵢ = `decay_per_s`, and by the filter's window;
    /// not by the surface.
    pub(super) fn covariance(&self, noise: &ForceNoise<T>, decay_per_s: T) -> Matrix2<T> {
        let covariance = self.gamma_1.covariance(noise.raw * noise.raw);
        let shift = self.gamma_1.shift();
        let relaxed = shift.column(1) * decay_per_s;
        let window = shift.column(2);
        covariance + relaxed * relaxed.transpose() + window * window.transpose()
    }

    /// ∂θ̂₁ by the position of the surface.
    pub(super) fn by_surface(&self) -> Vector2<T> {
        self.gamma_1.shift().column(0).into_owned()
    }

    /// γ̂₁ and γ̂₂ with their errors, of a θ̂₁ with this covariance and a surface with this error.
    pub(super) fn estimates(
        &self,
        covariance: &Matrix2<T>,
        surface_error: T,
    ) -> [ParameterEstimate<T>; 2] {
        let moved = self.by_surface() * surface_error;
        let (log_stiffness, exponent) = self.parameters();
        let theta = &self.gamma_1.rls.theta;
        let bounded = log_stiffness != theta.x || exponent != theta.y;
        let unlearned = self.gamma_1.ignorance() > T::from_f64(0.1);
        let scale = |scale: T| {
            if bounded || unlearned {
                T::zero()
            } else {
                scale
            }
        };
        let std_error = |variance: T, shift: T| (variance + shift * shift).sqrt();
        let stiffness = log_stiffness.exp();
        [
            ParameterEstimate {
                value: stiffness,
                std_error: stiffness * std_error(covariance.m11, moved.x),
                scale: scale(size(stiffness, stiffness)),
            },
            ParameterEstimate {
                value: exponent,
                std_error: std_error(covariance.m22, moved.y),
                scale: scale(T::one()),
            },
        ]
    }

    pub(super) fn reset_covariance(&mut self, covariance: T) {
        self.gamma_1.reset_covariance(covariance);
    }
}
