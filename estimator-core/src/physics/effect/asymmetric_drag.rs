//! The part of a drag that depends on the direction.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// c·|v|
    AsymmetricDrag = "asymmetric_drag", LoadPath {
        /// c (N s/m)
        coefficient_ns_per_m = "coefficient", NewtonSecondPerMetre, Any;
    }
    law: "c·|v|",
    signature: "differs by direction, also in free motion",
    motion: "free motion both ways at several speeds",
}

impl<S: Scalar> AsymmetricDrag<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, speed_mps: S) -> S {
        self.coefficient_ns_per_m * speed_mps.abs()
    }
}
