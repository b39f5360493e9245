//! A load cell whose zero wanders.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A ramp in time, or with a time constant a ramp that levels off.
    ForceDrift = "force_drift" {
        /// r (N/s)
        rate_n_per_s = "rate", NewtonPerSecond, Any, Size, FitRange::ANY;
        /// τ (s); 0: a ramp.
        time_constant_s = "time_constant", Second, NotNegative = 0.0,
            Form("it is a ramp", Dropped), Logarithmic(Times(10.0, Period), Times(3.0, Duration));
    }
    stage: LoadPath, sign: Either, proportional: true, several: false, repeats: Never, timed: true,
    laws: AnyLaw, needs_derivative: false, family: ForceZero, simpler: None, is_physical: |_| true,
    example: [0.03, 20.0, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Ratio(1.0, SmallForce, Duration))]),
        Starts::at(&[At(Ratio(3.0, SmallForce, Duration)), At(Times(0.2, Duration))]),
        Starts::at(&[At(Ratio(10.0, SmallForce, Duration)), At(Times(0.05, Duration))]),
    ],
    law: "r·t, or r·τ(1 − e^{−t/τ})",
    signature: "free-motion force wanders",
    motion: "rest in free air at the beginning and at the end",
}

impl<S: Scalar> ForceDrift<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, time_s: S) -> S {
        if self.time_constant_s > S::zero() {
            self.rate_n_per_s * time_s * (-(time_s / self.time_constant_s)).exprel()
        } else {
            self.rate_n_per_s * time_s
        }
    }
}
