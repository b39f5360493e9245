//! A spring in series with the probe, which the law does not have, watched beside the estimates.
//!
//! It gives way by c·F, so that the material is pressed c·F less deeply and c·Ḟ less fast than the encoder says. A
//! linear contact takes that up as a softer material; of any other it moves stiffness and damping first (a spring that
//! gives by 3 % of the depth makes λ of gel 9 % too small) and leaves a residual that is a tenth of the noise: far
//! too little to be seen by its size, and hundreds of samples' worth of evidence in the one direction that is looked at.

use nalgebra::Vector5;

use super::super::pool::Pooled;
use super::predicted::Predicted;
use crate::maths::scalar::Real;

/// A constant that is left out of a recursive fit, and what the innovations of that fit say of it: the filter of the
/// bias beside the filter without one (Friedland 1969), which is exact.
#[derive(Clone, Debug)]
pub(super) struct Compliance<T: Real> {
    /// By how much the deviations move per unit of it.
    moved: Vector5<T>,
    /// Its information, and its gradient of the cost.
    information: T,
    score: T,
}

impl<T: Real> Default for Compliance<T> {
    fn default() -> Self {
        Compliance {
            moved: Vector5::repeat(T::zero()),
            information: T::zero(),
            score: T::zero(),
        }
    }
}

/// What the fit of the law took from a pool.
pub(super) struct Step<T: Real> {
    /// The gradient over the noise, and the gain.
    pub(super) phi: Vector5<T>,
    pub(super) gain: Vector5<T>,
    /// The innovation over the noise, and the weight that it has left beside the errors of the parameters.
    pub(super) error: T,
    pub(super) weight: T,
    pub(super) beta: T,
}

impl<T: Real> Compliance<T> {
    /// dF/dc = −(F·∂F/∂x + Ḟ·∂F/∂v), by the law's own force: the measured one has the noise of the innovation in it.
    pub(super) fn gradient(there: &Predicted<T>, damping: T, at: &Pooled<T>) -> T {
        there.force * there.gradient.w - damping * there.gradient.x * at.rate
    }

    /// Takes the gradient over the noise of a pool that was learned from.
    pub(super) fn learn(&mut self, gradient: T, step: &Step<T>) {
        let left = gradient - step.phi.dot(&self.moved);
        self.moved += step.gain * left;
        let weighted = step.weight * left;
        self.information = self.information * step.beta + weighted * left;
        self.score = self.score * step.beta + weighted * step.error;
    }

    /// The compliance that the data speak for, and its standard error, scaled; `None` before any tell.
    pub(super) fn found(&self) -> Option<(T, T)> {
        let error = T::one() / self.information.sqrt();
        (self.information > T::zero() && error.is_finite())
            .then(|| (self.score / self.information, error))
    }

    /// By how much the deviations are moved by a compliance that is left out.
    pub(super) fn moved_by(&self, compliance: T) -> Vector5<T> {
        self.moved * compliance
    }
}
