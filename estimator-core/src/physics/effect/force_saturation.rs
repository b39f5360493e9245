//! A load cell at the end of its range.

use super::{effect, ramp};
use crate::maths::scalar::Scalar;

effect! {
    /// min(F, F_max); with a softness s the limit is rounded: F_max − s ln(1 + e^{(F_max − F)/s}).
    ForceSaturation = "force_saturation", ForceReading {
        /// F_max (N)
        limit_n = "limit", Newton, Positive;
        /// s (N): over how much force the amplifier gives way; 0: at once.
        softness_n = "softness", Newton, NotNegative, 0.0;
    }
    law: "min(F, F_max); softness > 0: rounded over it",
    signature: "flat tops",
    motion: "press harder than the range",
}

impl<S: Scalar> ForceSaturation<S> {
    /// The reading (N).
    pub(crate) fn reading_n(&self, force_n: S) -> S {
        self.limit_n - ramp(self.limit_n - force_n, self.softness_n)
    }
}
