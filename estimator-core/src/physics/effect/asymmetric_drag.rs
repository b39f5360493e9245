//! The part of a drag that depends on the direction.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The drag c·|v|: the part that pushes the same way in both directions.
    AsymmetricDrag = "asymmetric_drag" {
        /// c (N s/m)
        coefficient_ns_per_m = "coefficient", NewtonSecondPerMetre, Any, Size, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Drag, simpler: None, is_physical: |_| true,
    example: [5.0, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Ratio(1.0, SmallForce, Speed))])],
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
