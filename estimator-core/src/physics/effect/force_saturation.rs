//! A load cell at the end of its range.

use super::{row::effect, shapes::ramp};
use crate::maths::scalar::Scalar;

effect! {
    /// The limit min(F, F_max); with a softness s it is rounded: F_max − s ln(1 + e^{(F_max − F)/s}).
    ForceSaturation = "force_saturation" {
        /// F_max (N). A rounded limit is never quite reached.
        limit_n = "limit", Newton, Positive, Shape, Linear(Times(0.2, HighestForce), Times(1.5, HighestForce));
        /// s (N): the force over which the amplifier gives way; 0: it gives way at once.
        softness_n = "softness", Newton, NotNegative = 0.0,
            Form("the limit is sharp", OfTheStart), Logarithmic(Times(1e-4, HighestForce), Times(0.3, HighestForce));
    }
    stage: ForceReading, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [7.0, 0.0, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[Each(&[Times(0.97, HighestForce), Times(0.9, HighestForce)])]),
        Starts::at(&[At(Times(1.0, HighestForce)), At(Times(0.03, HighestForce))]),
    ],
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
