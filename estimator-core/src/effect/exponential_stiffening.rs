//! Elastic force that grows exponentially with depth.

use super::effect;
use crate::scalar::Scalar;

effect! {
    /// The elastic force times e^{bδ}.
    ExponentialStiffening = "exponential_stiffening", Elastic {
        /// b (1/m)
        rate_per_m = "rate", PerMetre, Positive;
    }
    law: "Fᵉ·e^{bδ}",
    signature: "misfit grows at the deepest strokes",
    motion: "press deep",
}

impl<S: Scalar> ExponentialStiffening<S> {
    /// The factor on the elastic force.
    pub(crate) fn factor(&self, depth_m: S) -> S {
        (self.rate_per_m * depth_m).exp()
    }
}
