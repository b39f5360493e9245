//! A second, stiffer layer below.

use super::{row::effect, shapes::ramp};
use crate::maths::scalar::Scalar;

effect! {
    /// A second spring that acts from a depth on.
    BuriedLayer = "buried_layer" {
        /// k₂ (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Positive, Size, FitRange::up_to(Times(1e3, Stiffness));
        /// d₂ (m)
        depth_m = "depth", Metre, Positive, Shape, Linear(Times(0.02, Travel), Times(0.98, Travel));
        /// w (m): the depth over which the layer sets in; 0: it sets in at once.
        rounding_m = "rounding", Metre, NotNegative = 0.0,
            Form("it sets in at once", TakenOn { start: Times(0.03, Travel), first: 1.0 }),
            Logarithmic(Times(1.0, PositionNoise), Times(0.2, Travel));
    }
    stage: Elastic, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None,
    // A layer that sets in over a quarter of its depth pushes from the touch on, with 2 % of its
    // stiffness: it is no layer, but any stiffening.
    is_physical: |[_, depth_m, rounding_m, ..]| *rounding_m <= 0.25 * depth_m,
    example: [1500.0, 2.5e-3, 0.0, 0.0, 0.0], starts: &[
        // Down to a twentieth of the travel, most of which may be free air.
        Starts::at(&[At(Times(0.6, Stiffness)), Series(Series { first: Times(1.0, Travel), ratio: 0.8, powers: [1, 13], below: Number(f64::INFINITY) })]),
        Starts::at(&[At(Times(0.6, Stiffness)), Each(&[Times(0.2, Travel), Times(0.4, Travel), Times(0.6, Travel)]), At(Times(0.03, Travel))]),
    ],
    law: "+ k₂·max(δ − d₂, 0); rounding > 0: sets in over it",
    signature: "a kink at a fixed depth",
    motion: "press deep, to different depths",
}

impl<S: Scalar> BuriedLayer<S> {
    /// What it adds to the elastic force (N).
    pub(crate) fn force_n(&self, depth_m: S) -> S {
        let above = |depth_m: S| ramp(depth_m - self.depth_m, self.rounding_m);
        // A rounded one sets in before the contact does: less that, so that it starts at 0.
        self.stiffness_n_per_m * (above(depth_m) - above(S::zero()))
    }
}
