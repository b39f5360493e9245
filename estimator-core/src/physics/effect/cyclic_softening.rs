//! Softening by the deepest stroke so far: Mullins' effect.

use super::{row::effect, shapes::leaves_some};
use crate::maths::scalar::Scalar;

effect! {
    /// Above the depth that was reached before the elastic force is smaller; at new depth all of it is
    /// there.
    CyclicSoftening = "cyclic_softening" {
        /// α
        fraction = "fraction", One, Fraction, SizeUpTo(0.6), FitRange::up_to(Number(0.95));
        /// d_s (m)
        depth_scale_m = "depth_scale", Metre, Positive, Shape, Logarithmic(Times(4.0, PositionNoise), Times(2.0, Travel));
    }
    stage: Elastic, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: leaves_some,
    example: [0.2, 1e-3, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Number(0.1)), Each(&[Times(0.025, Travel), Times(0.1, Travel), Times(0.3, Travel)])])],
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
