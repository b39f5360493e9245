//! A second, stiffer layer below.

use super::{effect, ramp};
use crate::maths::scalar::Scalar;

effect! {
    /// A spring more from a depth on.
    BuriedLayer = "buried_layer", Elastic {
        /// k₂ (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive;
        /// d₂ (m)
        depth_m = "depth", Metre, Positive;
        /// w (m): over how much depth it sets in; 0: at once.
        rounding_m = "rounding", Metre, NotNegative, 0.0;
    }
    law: "+ k₂·max(δ − d₂, 0); rounding > 0: sets in over it",
    signature: "a kink at a fixed depth",
    motion: "press deep, to different depths",
}

impl<S: Scalar> BuriedLayer<S> {
    /// What it adds to the elastic force (N).
    pub(crate) fn force_n(&self, depth_m: S) -> S {
        let above = |depth_m: S| ramp(depth_m - self.depth_m, self.rounding_m);
        // A rounded one sets in before the contact does: less that, so that it starts at 0.
        self.stiffness_n_per_m * (above(depth_m) - above(S::zero()))
    }
}
