//! What the estimates claim of themselves: standard errors, how far the residuals exceed the noise, and doubt.
//!
//! They change with every pool and are asked for at every sample, and cost as much as the pool itself: they are
//! worked out every second pool, in two parts, each at a sample that has little else to do.

use super::super::{Instant, Refiner, bounds::EXPONENT};
use super::left_out;
use crate::estimate::misfit::Excess;
use crate::estimate::status::{Doubt, Reason};
use crate::maths::scalar::Real;

/// Standard errors below zero at which a damping is negative for sure, and the law at its bound.
const ACTIVE_SIGMAS: f64 = 3.0;

/// The claims of a refiner.
#[derive(Clone, Debug, Default)]
pub(super) struct Claims<T: Real> {
    /// Standard errors of K, λ, n, x₀ and τ, scaled, by the noise alone.
    pub(super) std_errors: [T; 5],
    pub(super) excess: Excess<T>,
    pub(super) doubt: Option<Doubt>,
    /// Whether another refiner has taken over since they were worked out.
    pub(super) is_stale: bool,
}

impl<T: Real> Claims<T> {
    /// Works all of them out.
    pub(super) fn renew(&mut self, refiner: &Refiner<T>, at: &Instant<T>) {
        self.is_stale = false;
        self.renew_errors(refiner, at);
        self.renew_doubt(refiner);
    }

    pub(super) fn renew_errors(&mut self, refiner: &Refiner<T>, at: &Instant<T>) {
        self.std_errors = refiner.std_errors(at.rest_error, at.rest_drift, &at.noise);
    }

    pub(super) fn renew_doubt(&mut self, refiner: &Refiner<T>) {
        self.excess = refiner.misfit().excess();
        let [_, damping, exponent, ..] = refiner.values();
        let [_, damping_error, ..] = self.std_errors;
        let (low, high) = EXPONENT;
        let bounded = exponent <= T::from_f64(low) || exponent >= T::from_f64(high);
        let active = damping < -T::from_f64(ACTIVE_SIGMAS) * damping_error;
        let at_bound = (bounded || active).then_some(Doubt::Against(Reason::Bound));
        self.doubt = left_out::doubt(refiner, self.excess.inflation).or(at_bound);
    }
}
