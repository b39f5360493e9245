//! A surface that stays where it was pushed.

use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// Beyond the yield depth the surface recedes with the largest depth so far; it acts while that grows.
    PermanentSet = "permanent_set", Depth {
        /// α: the share of the depth beyond yield that remains.
        fraction = "fraction", One, Fraction;
        /// δ_y (m)
        yield_depth_m = "yield_depth", Metre, NotNegative;
    }
    law: "δ = tip − surface − α·max(δ_max − δ_y, 0)",
    signature: "the first stroke differs from the next ones",
    motion: "press to the same depth again and again, then deeper",
}

impl<S: Scalar> PermanentSet<S> {
    /// How far the surface has receded (m), and how much further per metre of new depth.
    pub(crate) fn recession_m(&self, deepest_m: S) -> (S, S) {
        let beyond = deepest_m - self.yield_depth_m;
        if beyond > S::zero() {
            (self.fraction * beyond, self.fraction)
        } else {
            (S::zero(), S::zero())
        }
    }
}
