//! A force that repeats along the way: cogging, ripple of a screw.

use super::effect;
use super::{angular_of, wave};
use crate::maths::scalar::Scalar;

effect! {
    /// A sin(2πx/p + φ)
    Cogging = "cogging", LoadPath {
        /// A (N)
        amplitude_n = "amplitude", Newton, NotNegative;
        /// p (m)
        pitch_m = "pitch", Metre, Positive;
        /// φ (rad) at x = 0
        phase_rad = "phase", Radian, Angle;
    }
    law: "A sin(2πx/p + φ)",
    signature: "periodic in x, also in free motion",
    motion: "free motion over many pitches",
}

impl<S: Scalar> Cogging<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, position_m: S) -> S {
        wave(
            self.amplitude_n,
            angular_of(self.pitch_m),
            self.phase_rad,
            position_m,
        )
        .0
    }
}
