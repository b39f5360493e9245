//! The elastic response of a law, before anything relaxes.

use crate::maths::scalar::Scalar;

/// The elastic response F⁽ᵉ⁾(δ): the force at once, before anything relaxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elastic<S> {
    /// Kδ₀(δ/δ₀)ⁿ: (14) with the depth in units of δ₀; n = q + 1, and p = nKδ₀^(1−n).
    Power {
        /// K (N/m): the secant stiffness at δ₀.
        stiffness_n_per_m: S,
        /// n
        exponent: S,
        /// δ₀ (m)
        reference_depth_m: S,
    },
    /// (m/b)(e^{bδ} − 1), (13).
    Exponential {
        /// m (N/m): the stiffness at the surface.
        stiffness_n_per_m: S,
        /// b (1/m); 0 is a spring.
        stiffening_rate_per_m: S,
    },
}

impl<S: Scalar> Elastic<S> {
    /// F⁽ᵉ⁾ (N) at a depth (m); 0 outside the material, slope included.
    pub fn force_n(&self, depth_m: S) -> S {
        if depth_m <= S::zero() {
            return S::zero();
        }
        match *self {
            Elastic::Power {
                stiffness_n_per_m,
                exponent,
                reference_depth_m,
            } => {
                let depth = depth_m / reference_depth_m;
                stiffness_n_per_m * reference_depth_m * depth.pow_positive(exponent)
            }
            Elastic::Exponential {
                stiffness_n_per_m,
                stiffening_rate_per_m,
            } => stiffness_n_per_m * depth_m * (stiffening_rate_per_m * depth_m).exprel(),
        }
    }
}
