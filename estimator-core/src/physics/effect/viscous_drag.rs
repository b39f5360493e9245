//! Drag of a bearing or a fluid.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The force b·v.
    ViscousDrag = "viscous_drag" {
        /// b (N s/m)
        coefficient_ns_per_m = "coefficient", NewtonSecondPerMetre, Positive, Size, FitRange::NOT_NEGATIVE;
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Drag, simpler: None, is_physical: |_| true,
    example: [8.0, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Ratio(1.0, SmallForce, Speed))])],
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
