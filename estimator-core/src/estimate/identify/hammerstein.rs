//! The quasi-linear law by two recursive least squares in cascade, (39)–(42).
//!
//! Γ₁ estimates the elastic response F⁽ᵉ⁾ = γ₁δ^γ₂ from y₁ = ln F, φ₁ = [1, ln δ], θ₁ = [ln γ₁, γ₂],
//! weighted, from the samples that press faster than δ̇*: there nothing has relaxed yet.
//! Γ₂ estimates the filter from y₂ = F − F̂⁽ᵉ⁾ and φ₂ = [F(h−1)…, F̂⁽ᵉ⁾(h−1)…] of all the others.
//!
//! Γ₂ is written in differences of z = F − F̂⁽ᵉ⁾, which is the same model for the same data; for r =
//! 1 (z(h) − z(h−1))/T = −α·z(h−1) + β·F̂⁽ᵉ⁾(h−1), a₁ = αT − 1, b₁ = βT − 1 + αT. At 1 kHz a mode of
//! 0.1/s is a pole at 0.9999, whose distance from 1 single precision keeps to three digits. Γ₂
//! therefore takes means over half of the filter's memory (r = 1, 8 ms by default) or forty times as
//! long (r = 2, whose second differences amplify noise with 1/T²).

mod elastic;
mod relaxation;
mod split_force;

use elastic::ElasticStage;
use nalgebra::{Matrix2, Vector2};
use relaxation::RelaxationStage;

use super::contract::{ForceNoise, Identify, Instant};
use super::modes::ModelPeriod;
use super::params::IdentifyParams;
use crate::estimate::method::{MethodInfo, Offer, methods};
use crate::estimate::monitor::ParameterEstimate;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::maths::scalar::Real;
use crate::physics::law::RelaxationMode;

methods! {
    /// The quasi-linear law with one mode by two recursive least squares in cascade, (39)–(42).
    HAMMERSTEIN_CASCADE = 4, QuasiLinear, "cascade",
        "Elastic response while loading, then its relaxation in one mode",
        offer: Offer::Default;
    /// The quasi-linear law with two modes by two recursive least squares in cascade, (39)–(42).
    HAMMERSTEIN_CASCADE_2 = 7, QuasiLinear2, "cascade_2", "The same in two modes",
        offer: Offer::Default;
}

/// The chapter's cascade for `R` relaxation modes, in scaled units; `N` = 2R. It is used as
/// [`Cascade1`] and [`Cascade2`].
#[derive(Clone, Debug)]
pub struct Cascade<T: Real, const R: usize, const N: usize> {
    elastic: ElasticStage<T>,
    relaxation: RelaxationStage<T, R, N>,
    loading_speed: T,
    memory_samples: u32,
    /// Whether nothing has been touched yet.
    untouched: bool,
}

/// The cascade for one relaxation mode.
pub type Cascade1<T> = Cascade<T, 1, 2>;
/// The cascade for two relaxation modes.
pub type Cascade2<T> = Cascade<T, 2, 4>;

impl<T: Real, const R: usize, const N: usize> Cascade<T, R, N> {
    /// Starts from θ̂(0) and P(0) of the configuration, with a material that does not relax.
    pub fn new(params: &IdentifyParams<T>) -> Self {
        let half_window = ModelPeriod::new(params);
        Cascade {
            elastic: ElasticStage::new(params, half_window.seconds()),
            relaxation: RelaxationStage::new(params, half_window),
            loading_speed: params.cascade.loading_speed,
            memory_samples: params.memory_samples,
            untouched: true,
        }
    }

    /// cᵢ and νᵢ (1/s), fast to slow; `None` while the poles of Γ₂ are not those of a relaxation.
    pub fn modes(&self) -> Option<[RelaxationMode<T>; R]> {
        self.relaxation.modes()
    }

    /// Covariance of θ̂₁ by noise and by what Γ₁ neglects, without the surface.
    fn elastic_covariance(&self, noise: &ForceNoise<T>) -> Matrix2<T> {
        self.elastic
            .covariance(noise, self.relaxation.decay_per_s())
    }
}

impl<T: Real, const R: usize, const N: usize> Identify<T> for Cascade<T, R, N> {
    const METHODS: &'static [MethodInfo] = &[METHODS[R - 1]];

    /// F̂ = F̂⁽ᵉ⁾ + ẑ, with z from the last period on.
    fn predict(&self, at: &Instant<T>) -> (T, T) {
        if at.depth <= T::zero() {
            return (T::zero(), T::zero());
        }
        let now = self.elastic.split(at);
        let gradient = Vector2::new(now.gradient.x, now.gradient.y);
        let by_surface = now.gradient.z * at.surface_error;
        let variance = gradient.dot(&(self.elastic_covariance(&at.noise) * gradient))
            + by_surface * by_surface;
        let Some(last) = self.relaxation.last() else {
            return (now.elastic, variance);
        };
        // An error of F̂⁽ᵉ⁾ is in z as well, and cancels where the depth stays.
        let moved = T::one() - last.elastic / now.elastic;
        (
            now.elastic + last.relaxed + self.relaxation.change(&now),
            at.noise.filtered * at.noise.filtered + variance * moved * moved,
        )
    }

    fn learn(&mut self, params: &IdentifyParams<T>, at: &Instant<T>, beta: T) -> Option<T> {
        if at.depth <= T::zero() {
            return None;
        }
        if at.speed > self.loading_speed {
            self.elastic.learn(params, at);
            if R == 1 {
                // While θ̂₁ moves, z of two periods would belong to two elastic responses.
                self.relaxation.break_off();
                return Some(beta);
            }
        }
        if R > 1 && core::mem::take(&mut self.untouched) {
            self.relaxation.start_at_rest(self.memory_samples);
        }
        let sample = self.elastic.split(at);
        self.relaxation.learn(params, &sample, &at.noise, beta);
        // A prediction over two long periods says nothing about a stroke that is over in less.
        let predictable = R == 1 || at.speed.abs() < self.loading_speed;
        predictable.then_some(beta)
    }

    fn observe(&mut self, _at: &Instant<T>, _in_contact: bool) {
        self.relaxation.break_off();
    }

    fn reset_covariance(&mut self, params: &IdentifyParams<T>, _since_touch: bool) {
        self.elastic.reset_covariance(params.start.covariance);
        self.relaxation.reset_covariance(params.start.covariance);
    }

    fn estimates(&self, at: &Instant<T>) -> [ParameterEstimate<T>; PARAMETER_SLOTS] {
        let mut estimates = [ParameterEstimate::default(); PARAMETER_SLOTS];
        let covariance = self.elastic_covariance(&at.noise);
        let elastic = self.elastic.estimates(&covariance, at.surface_error);
        for (slot, estimate) in estimates.iter_mut().zip(elastic) {
            *slot = estimate;
        }
        self.relaxation.estimate(
            estimates.get_mut(elastic.len()..).unwrap_or_default(),
            (&covariance, &self.elastic.by_surface()),
            at,
        );
        estimates
    }
}

#[cfg(test)]
mod tests;
