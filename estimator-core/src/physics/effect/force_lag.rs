//! A load cell amplifier that is slow.

use super::row::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::high_passed;

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
    /// The reading (N) one period after `reading_n`, while the force went from `before_n` to
    /// `force_n`: exact for a force that is linear in between.
    pub(crate) fn reading_n(&self, reading_n: S, before_n: S, force_n: S, period_s: S) -> S {
        // The difference e = F − y has ė = Ḟ − e/τ.
        let rate_per_s = S::one() / self.time_constant_s;
        let behind = high_passed(
            before_n - reading_n,
            force_n - before_n,
            rate_per_s,
            period_s,
        );
        force_n - behind
    }
}
