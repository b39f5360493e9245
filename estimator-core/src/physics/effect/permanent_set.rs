//! A surface that stays where it was pushed.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// Beyond the yield depth the surface recedes with the largest depth so far; the recession changes
    /// while that grows.
    PermanentSet = "permanent_set" {
        /// α: the share of the depth beyond yield that remains.
        fraction = "fraction", One, Fraction, Size, FitRange::up_to(Number(0.95));
        /// δ_y (m)
        yield_depth_m = "yield_depth", Metre, NotNegative, Shape, FitRange::up_to(Times(1.0, Travel));
    }
    stage: Depth, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.1, 5e-4, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Number(0.1)), Each(&[Number(0.0), Times(0.15, Travel), Times(0.3, Travel)])])],
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
