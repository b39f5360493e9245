//! Drag of a bearing or a fluid.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// b·v
    ViscousDrag = "viscous_drag", LoadPath {
        /// b (N s/m)
        coefficient_ns_per_m = "coefficient", NewtonSecondPerMetre, Positive;
    }
    law: "b·v",
    signature: "proportional to v, also in free motion",
    motion: "free motion at several speeds",
}

impl<S: Scalar> ViscousDrag<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, speed_mps: S) -> S {
        self.coefficient_ns_per_m * speed_mps
    }
}
