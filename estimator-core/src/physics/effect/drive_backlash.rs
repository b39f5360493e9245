//! Lost motion in a drive: play in front of whatever restores in the load path.

use super::{load_path::LoadPathMemory, row::effect};
use crate::maths::scalar::Scalar;

effect! {
    /// Play between the motor and what restores in the load path: a cable, a friction that sticks elastically
    /// before it slides, Bouc and Wen's loop. A flank only pushes, so that between the flanks there is no force.
    DriveBacklash = "drive_backlash" {
        /// w (m), the whole play
        width_m = "width", Metre, Positive, Shape, Logarithmic(Times(4.0, PositionNoise), Times(0.6, Travel));
    }
    stage: LoadPath, sign: OneWay, proportional: false, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [2e-4, 0.0, 0.0, 0.0], starts: &[Starts::at(&[
        Each(&[Times(0.01, Travel), Times(0.03, Travel), Times(0.1, Travel), Times(0.2, Travel)]),
    ])],
    law: "x_d = x ∓ w/2 on a flank that pushes; no force between the flanks",
    signature: "a flat gap without force after each reversal, without a contact",
    motion: "reversals in free motion, longer than the play",
}

/// What is left of a position (m) behind a play about zero of the width (m): how far it is beyond a flank.
pub(super) fn beyond_play<S: Scalar>(position_m: S, play_m: S) -> S {
    let half = play_m * S::from_f64(0.5);
    if position_m > half {
        position_m - half
    } else if position_m < -half {
        position_m + half
    } else {
        S::zero()
    }
}

impl<S: Scalar> LoadPathMemory<S> {
    /// The state z of an effect that follows the way, after a way of `change_m` with a play of `play_m` in
    /// front of it: `follow(z, way)` is its state after a way that pushes it. Where z passes through 0 the
    /// flank lets go, and the rest of the way is taken from the play before the other flank pushes.
    pub(super) fn follow(&mut self, change_m: S, play_m: S, follow: impl Fn(S, S) -> S) -> S {
        let zero = S::zero();
        if play_m <= zero {
            self.z = follow(self.z, change_m);
            return self.z;
        }
        let half = play_m * S::from_f64(0.5);
        let mut way_m = change_m;
        if self.z > zero || self.z < zero {
            let next = follow(self.z, way_m);
            if (next > zero) == (self.z > zero) && (next < zero) == (self.z < zero) {
                self.z = next;
                return next;
            }
            self.gap_m = if self.z > zero { half } else { -half };
            way_m = way_m * (next / (next - self.z));
            self.z = zero;
        }
        let at_m = self.gap_m + way_m;
        self.gap_m = at_m.max_of(-half).min_of(half);
        let pushed_m = beyond_play(at_m, play_m);
        if pushed_m > zero || pushed_m < zero {
            self.z = follow(zero, pushed_m);
        }
        self.z
    }
}
