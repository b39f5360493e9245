//! Mass between the load cell and the material.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The force m·a.
    ToolInertia = "tool_inertia" {
        /// m (kg)
        mass_kg = "mass", Kilogram, Positive, Size, FitRange::NOT_NEGATIVE;
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.4, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Ratio(1.0, SmallForce, Acceleration))])],
    law: "m·a",
    signature: "proportional to a, also in free motion",
    motion: "free motion with hard accelerations",
}

impl<S: Scalar> ToolInertia<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, acceleration_mps2: S) -> S {
        self.mass_kg * acceleration_mps2
    }
}
