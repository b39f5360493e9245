//! Elastic force that grows exponentially with depth.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The elastic force times e^{bδ}.
    ExponentialStiffening = "exponential_stiffening", Elastic {
        /// b (1/m)
        rate_per_m = "rate", PerMetre, Positive;
        /// q: how much the rate itself grows, towards a depth that locks.
        bend = "bend", One, NotNegative, 0.0;
    }
    law: "Fᵉ·e^{bδ}; with a bend q: Fᵉ·e^{bδ(1 + q·bδ)}",
    signature: "misfit grows at the deepest strokes",
    motion: "press deep",
}

impl<S: Scalar> ExponentialStiffening<S> {
    /// The factor on the elastic force.
    pub(crate) fn factor(&self, depth_m: S) -> S {
        let growth = self.rate_per_m * depth_m;
        (growth + self.bend * growth * growth).exp()
    }
}
