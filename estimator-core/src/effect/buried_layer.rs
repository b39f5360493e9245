//! A second, stiffer layer below.

use super::effect;
use crate::scalar::Scalar;

effect! {
    /// A spring more from a depth on.
    BuriedLayer = "buried_layer", Elastic {
        /// k₂ (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive;
        /// d₂ (m)
        depth_m = "depth", Metre, Positive;
    }
    law: "+ k₂·max(δ − d₂, 0)",
    signature: "a kink at a fixed depth",
    motion: "press deep, to different depths",
}

impl<S: Scalar> BuriedLayer<S> {
    /// What it adds to the elastic force (N).
    pub(crate) fn force_n(&self, depth_m: S) -> S {
        let beyond = depth_m - self.depth_m;
        if beyond > S::nil() {
            self.stiffness_n_per_m * beyond
        } else {
            S::nil()
        }
    }
}
