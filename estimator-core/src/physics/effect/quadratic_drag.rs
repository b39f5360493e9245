//! Drag of a fluid at speed.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The force c·v|v|.
    QuadraticDrag = "quadratic_drag" {
        /// c (N s²/m²)
        coefficient_ns2_per_m2 = "coefficient", NewtonSecondSquaredPerMetreSquared, Positive, Size, FitRange::NOT_NEGATIVE;
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Alone, simpler: None, is_physical: |_| true,
    example: [400.0, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(RatioOfSquare(1.0, SmallForce, Speed))])],
    law: "c·v|v|",
    signature: "grows faster than the speed, also in free motion",
    motion: "free motion at several speeds",
}

impl<S: Scalar> QuadraticDrag<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, speed_mps: S) -> S {
        self.coefficient_ns2_per_m2 * speed_mps * speed_mps.abs()
    }
}
