//! A load cell whose zero is not zero.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A constant.
    ForceOffset = "force_offset", LoadPath {
        /// Offset (N)
        force_n = "force", Newton, Any;
    }
    law: "constant",
    signature: "nonzero force at rest in free motion",
    motion: "rest in free air",
}

impl<S: Scalar> ForceOffset<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self) -> S {
        self.force_n
    }
}
