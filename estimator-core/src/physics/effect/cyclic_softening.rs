//! Softening by the deepest stroke so far: Mullins' effect.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// Below the depth reached before the elastic force is smaller; at new depth it is all there.
    CyclicSoftening = "cyclic_softening", Elastic {
        /// α
        fraction = "fraction", One, Fraction;
        /// d_s (m)
        depth_scale_m = "depth_scale", Metre, Positive;
    }
    law: "Fᵉ·[1 − α(1 − e^{−(δ_max − δ)/d_s})]",
    signature: "the depth reached before matters, full recovery at new depth",
    motion: "strokes of growing depth, each repeated",
}

impl<S: Scalar> CyclicSoftening<S> {
    /// The factor on the elastic force.
    pub(crate) fn factor(&self, below_deepest_m: S) -> S {
        let below = S::zero().max_of(below_deepest_m);
        let one = S::one();
        one - self.fraction * (one - (-(below / self.depth_scale_m)).exp())
    }
}
