//! A loop that does not depend on the rate: Bouc and Wen's.

use super::{row::effect, shapes::slid};
use crate::maths::scalar::Scalar;

effect! {
    /// The force F_h·z with ż = (δ̇/d_h)(1 − z·sgn δ̇), and z → 0 out of contact.
    HystereticDamping = "hysteretic_damping" {
        /// F_h (N)
        force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(1.0, Force));
        /// d_h (m)
        yield_displacement_m = "yield_displacement", Metre, Positive, Shape,
            Logarithmic(Times(2.0, PositionNoise), Times(1.0, Travel));
    }
    stage: Contact, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.5, 2e-4, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Times(1.0, SmallForce)), Series(Series { first: Times(0.5, Travel), ratio: 0.5, powers: [1, 7], below: Number(f64::INFINITY) })])],
    law: "F_h·z, ż = (δ̇/d_h)(1 − z·sgn δ̇)",
    signature: "loop area independent of the rate, in contact only",
    motion: "the same stroke at several speeds",
}

impl<S: Scalar> HystereticDamping<S> {
    /// Its force (N) after the depth has changed to `depth_m`; `z` is its memory.
    pub(crate) fn force_n(&self, z: &mut S, depth_m: S, change_m: S) -> S {
        *z = if depth_m > S::zero() {
            slid(*z, change_m, self.yield_displacement_m)
        } else {
            S::zero()
        };
        self.force_n * *z
    }
}
