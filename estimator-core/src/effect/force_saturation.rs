//! A load cell at the end of its range.

use super::effect;
use crate::scalar::Scalar;

effect! {
    /// min(F, F_max)
    ForceSaturation = "force_saturation", ForceReading {
        /// F_max (N)
        limit_n = "limit", Newton, Positive;
    }
    law: "min(F, F_max)",
    signature: "flat tops",
    motion: "press harder than the range",
}

impl<S: Scalar> ForceSaturation<S> {
    /// The reading (N).
    pub(crate) fn reading_n(&self, force_n: S) -> S {
        self.limit_n.min_of(force_n)
    }
}
