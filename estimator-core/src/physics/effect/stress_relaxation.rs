//! One more relaxation mode of the elastic force, equation (10).

use super::effect;
use crate::maths::scalar::Scalar;
use crate::physics::law::RelaxationMode;

effect! {
    /// c and ν of one more mode. May enter several times: a spectrum.
    StressRelaxation = "stress_relaxation", Relaxation {
        /// c: the share of the elastic force that it takes away in time.
        fraction = "fraction", One, Fraction;
        /// ν (1/s)
        rate_per_s = "rate", PerSecond, Positive;
    }
    law: "Fᵉ − c(Fᵉ − w), ẇ = Ḟᵉ − νw",
    signature: "force decays in a hold, slow tail after a step",
    motion: "press and hold for several time constants; press at different speeds",
}

impl<S: Scalar> StressRelaxation<S> {
    /// The mode that it adds.
    pub(crate) fn mode(&self) -> RelaxationMode<S> {
        RelaxationMode {
            fraction: self.fraction,
            rate_per_s: self.rate_per_s,
        }
    }
}
