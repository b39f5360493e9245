//! A cable or hose that pulls back.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// k_c·x, zero at x = 0.
    CableStiffness = "cable_stiffness", LoadPath {
        /// k_c (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Any;
    }
    law: "k_c·x",
    signature: "linear in x, also in free motion",
    motion: "free motion over a long way",
}

impl<S: Scalar> CableStiffness<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, position_m: S) -> S {
        self.stiffness_n_per_m * position_m
    }
}
