//! A spring that is not linear.

use super::row::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::Elastic;

effect! {
    /// The elastic force of a linear law becomes Kδ₀(δ/δ₀)ⁿ.
    PowerLawStiffness = "power_law_stiffness" {
        /// n
        exponent = "exponent", One, Positive, Shape, Linear(Number(0.3), Number(5.0));
    }
    stage: Elastic, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: LinearElasticity, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [1.4, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[Each(&[Number(1.15), Number(1.4), Number(1.8), Number(0.85)])])],
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
