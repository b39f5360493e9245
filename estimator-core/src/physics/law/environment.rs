//! What is touched, in the parts that effects act on: elastic force, relaxation, damping.

use super::{
    elastic::Elastic, recovery::Recovery, relaxation::MOST_MODES, relaxation::RelaxationMode,
};
use crate::maths::scalar::Scalar;

/// The damping force λ(δ/δ₀)^q δ̇.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping<S> {
    /// λ (N s/m) at δ₀.
    pub coefficient_ns_per_m: S,
    /// q; 0 is a damper that does not know the depth.
    pub exponent: S,
    /// δ₀ (m)
    pub reference_depth_m: S,
}

/// A contact law in parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment<S> {
    /// F⁽ᵉ⁾(δ); `None` where there is nothing to touch.
    pub elastic: Option<Elastic<S>>,
    /// The damping force beside the elastic one.
    pub damping: Option<Damping<S>>,
    /// Relaxation of the elastic force. Unused modes have fraction 0.
    pub modes: [RelaxationMode<S>; MOST_MODES],
    /// Position of the surface (m).
    pub surface_m: S,
    /// How the surface comes back after a touch, where something relaxes.
    pub recovery: Recovery,
}

impl<S: Scalar> Damping<S> {
    /// The damping force (N); 0 outside the material.
    pub fn force_n(&self, depth_m: S, speed_mps: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        let linear = self.coefficient_ns_per_m * speed_mps;
        if self.exponent == S::zero() {
            return linear;
        }
        linear * (depth_m / self.reference_depth_m).pow_positive(self.exponent)
    }
}

impl<S: Scalar> Environment<S> {
    /// Free air.
    pub fn free() -> Environment<S> {
        Environment {
            elastic: None,
            damping: None,
            modes: [RelaxationMode::unused(); MOST_MODES],
            surface_m: S::zero(),
            recovery: Recovery::WithProbe,
        }
    }

    /// The same material somewhere else (m).
    #[must_use]
    pub fn at(self, surface_m: S) -> Environment<S> {
        Environment { surface_m, ..self }
    }

    /// The same material whose surface comes back like this.
    #[must_use]
    pub fn recovering(self, recovery: Recovery) -> Environment<S> {
        Environment { recovery, ..self }
    }

    /// An approximation of dF/dδ (N/m) where the speed follows the depth at `rate_per_s`: what Newton's method needs.
    pub(crate) fn slope(&self, depth_m: S, speed_mps: S, rate_per_s: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        // A share of a thousandth of the depth, at least a nanometre: for a slope, not for a value.
        let step_m = S::from_f64(1e-9).max_of(depth_m * S::from_f64(1e-3));
        let force = |depth_m: S, speed_mps: S| {
            let (elastic, damping) = (self.elastic.as_ref(), self.damping.as_ref());
            elastic.map_or(S::zero(), |elastic| elastic.force_n(depth_m))
                + damping.map_or(S::zero(), |damping| damping.force_n(depth_m, speed_mps))
        };
        let further = force(depth_m + step_m, speed_mps + rate_per_s * step_m);
        S::zero().max_of((further - force(depth_m, speed_mps)) / step_m)
    }
}
