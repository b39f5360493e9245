//! A load cell amplifier that is slow.

use super::row::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::Decay;

effect! {
    /// A low-pass of first order on the force.
    ForceLag = "force_lag" {
        /// τ (s)
        time_constant_s = "time_constant", Second, Positive, Size, Linear(Times(0.02, Period), Part(Duration, 20.0));
    }
    stage: ForceReading, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Lateness, simpler: None, is_physical: |_| true,
    example: [8e-3, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[Each(&[Times(1.5, Period), Times(6.0, Period), Times(25.0, Period)])])],
    law: "first-order low-pass on F",
    signature: "force late at every rate, high frequencies damped",
    motion: "fast strokes, and a step",
}

impl<S: Scalar> ForceLag<S> {
    /// What a period (s) does to e = F − y, which has ė = Ḟ − e/τ.
    pub(crate) fn decay(&self, period_s: S) -> Decay<S> {
        Decay::over(S::one() / self.time_constant_s, period_s)
    }
}
