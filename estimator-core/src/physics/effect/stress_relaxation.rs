//! One more relaxation mode of the elastic force, equation (10).

use super::row::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::Decay;

effect! {
    /// One more relaxation mode. A rig can have several of them: a spectrum.
    StressRelaxation = "stress_relaxation" {
        /// c: the share of the elastic force that it takes away in time.
        fraction = "fraction", One, Fraction, SizeUpTo(0.6), FitRange::up_to(Number(0.95));
        /// ν (1/s)
        rate_per_s = "rate", PerSecond, Positive, Shape, Logarithmic(Per(0.1, Duration), Per(0.5, Period));
    }
    stage: Relaxation, sign: OneWay, proportional: true, several: true, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.2, 2.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Number(0.1)), Series(Series { first: Per(0.3, Duration), ratio: 4.0, powers: [0, 8], below: Per(0.2, Period) })])],
    law: "Fᵉ − c(Fᵉ − w), ẇ = Ḟᵉ − νw",
    signature: "force decays in a hold, slow tail after a step",
    motion: "press and hold for several time constants; press at different speeds",
}

impl<S: Scalar> StressRelaxation<S> {
    /// What a period (s) does to it.
    pub(crate) fn decay(&self, period_s: S) -> Decay<S> {
        Decay::over(self.rate_per_s, period_s)
    }
}
