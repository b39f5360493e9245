//! A cable or hose that pulls back.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A spring k_c·x that is relaxed at x = 0.
    CableStiffness = "cable_stiffness" {
        /// k_c (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Any, Size, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [100.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Ratio(1.0, SmallForce, Reach))])],
    law: "k_c·x",
    signature: "linear in x, also in free motion",
    motion: "free motion over a long way",
}

impl<S: Scalar> CableStiffness<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, position_m: S) -> S {
        self.stiffness_n_per_m * position_m
    }
}
