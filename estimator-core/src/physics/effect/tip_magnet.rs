//! An invented effect, the worked example of [`crate::physics::effect`]: only a test has it.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A magnet below the encoder's zero, which pulls at the tip as it passes.
    TipMagnet = "tip_magnet" {
        /// F (N), at x = 0
        force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(1.0, Force));
        /// d (m): where half of the pull is left
        reach_m = "reach", Metre, Positive, Shape, Logarithmic(Times(0.02, Travel), Times(0.5, Travel));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.3, 5e-4, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Times(1.0, SmallForce)), Each(&[Times(0.05, Travel), Times(0.1, Travel), Times(0.2, Travel)])]),
    ],
    law: "−F/(1 + (x/d)²)",
    signature: "a pull near x = 0, also in free motion",
    motion: "free motion past x = 0",
}

impl<S: Scalar> TipMagnet<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, position_m: S) -> S {
        let share = position_m / self.reach_m;
        -(self.force_n / (S::one() + share * share))
    }
}
