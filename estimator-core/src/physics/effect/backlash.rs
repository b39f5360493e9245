//! Play between the motor and the tip.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// Play: the tip stays where it is until the motor has used the play up.
    Backlash = "backlash" {
        /// w (m), the whole play
        width_m = "width", Metre, Positive, Size, FitRange::up_to(Times(0.3, Travel));
    }
    stage: Transmission, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [1e-4, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[Each(&[Times(5e-3, Travel), Times(0.015, Travel), Times(0.05, Travel)])])],
    law: "play of ±w/2 about x",
    signature: "flat pieces after each reversal, in contact only",
    motion: "reversals in contact",
}

impl<S: Scalar> Backlash<S> {
    /// Where the far side is (m) after the near side has moved to `position_m`, and whether it is
    /// taken along.
    pub(crate) fn follow(&self, far_m: S, position_m: S) -> (S, bool) {
        let half = self.width_m * S::from_f64(0.5);
        if position_m - half > far_m {
            (position_m - half, true)
        } else if position_m + half < far_m {
            (position_m + half, true)
        } else {
            (far_m, false)
        }
    }
}
