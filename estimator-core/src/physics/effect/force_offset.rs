//! A load cell whose zero is not zero.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A constant force.
    ForceOffset = "force_offset" {
        /// The offset (N)
        force_n = "force", Newton, Any, Size, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: ForceZero, simpler: None, is_physical: |_| true,
    example: [0.3, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Times(1.0, SmallForce))])],
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
