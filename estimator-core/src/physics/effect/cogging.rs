//! A force that repeats along the way: cogging, ripple of a screw.

use super::{row::effect, shapes::angular_of, shapes::wave};
use crate::maths::scalar::Scalar;

effect! {
    /// The force A sin(2πx/p + φ).
    Cogging = "cogging" {
        /// A (N)
        amplitude_n = "amplitude", Newton, NotNegative, Size, FitRange::up_to(Times(1.0, Force));
        /// p (m)
        pitch_m = "pitch", Metre, Positive, Shape, Linear(Times(4.0, PositionNoise), Times(0.5, Travel));
        /// φ (rad) at x = 0
        phase_rad = "phase", Radian, Angle, Shape, FitRange::ANY;
    }
    stage: LoadPath, sign: Either, proportional: false, several: true, repeats: AlongTheWay, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.15, 1e-3, 0.3, 0.0, 0.0], starts: &[],
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
