//! Mass between the load cell and the material.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// m·a
    ToolInertia = "tool_inertia", LoadPath {
        /// m (kg)
        mass_kg = "mass", Kilogram, Positive;
    }
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
