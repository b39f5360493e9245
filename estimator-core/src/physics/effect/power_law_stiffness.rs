//! A spring that is not linear.

use super::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::Elastic;

effect! {
    /// The elastic force of a linear law becomes Kδ₀(δ/δ₀)ⁿ.
    PowerLawStiffness = "power_law_stiffness", Elastic {
        /// n
        exponent = "exponent", One, Positive;
    }
    law: "Kδ → Kδ₀(δ/δ₀)ⁿ",
    signature: "curvature of F(δ), the same both ways",
    motion: "press to different depths, slowly",
}

impl<S: Scalar> PowerLawStiffness<S> {
    /// The elastic response with this exponent, if it was a power.
    pub(crate) fn bend(&self, elastic: Elastic<S>) -> Elastic<S> {
        match elastic {
            Elastic::Power {
                stiffness_n_per_m,
                reference_depth_m,
                ..
            } => Elastic::Power {
                stiffness_n_per_m,
                exponent: self.exponent,
                reference_depth_m,
            },
            exponential => exponential,
        }
    }
}
