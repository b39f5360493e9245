//! A material that gives way at a depth, as a rubber dome does.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A smooth step of −F about a depth: −F/2·(1 + tanh((δ − d)/w)).
    SnapThrough = "snap_through" {
        /// F (N)
        force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(2.0, Force));
        /// d (m)
        depth_m = "depth", Metre, Positive, Shape, FitRange::up_to(Times(1.0, Travel));
        /// w (m)
        width_m = "width", Metre, Positive, Shape, Logarithmic(Times(2.0, PositionNoise), Times(0.1, Travel));
    }
    stage: Elastic, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None,
    // A step that is as wide as a third of its depth bends the whole curve, and fitted any other bend.
    is_physical: |[_, depth_m, width_m, ..]| *depth_m > 4.0 * *width_m,
    example: [1.0, 2e-3, 1e-4, 0.0, 0.0], starts: &[
        Starts::at(&[
            At(Times(1.0, SmallForce)),
            Each(&[
                Times(0.1, Travel), Times(0.15, Travel), Times(0.2, Travel), Times(0.25, Travel), Times(0.3, Travel),
                Times(0.35, Travel), Times(0.4, Travel), Times(0.5, Travel), Times(0.6, Travel), Times(0.7, Travel),
            ]),
            Each(&[Times(0.01, Travel), Times(0.03, Travel)]),
        ]),
    ],
    law: "−F/2·(1 + tanh((δ − d)/w))",
    signature: "the force falls, or rises less, while pressing on through a depth, both ways",
    motion: "slow strokes through the depth",
}

impl<S: Scalar> SnapThrough<S> {
    /// What it adds to the elastic force (N).
    pub(crate) fn force_n(&self, depth_m: S) -> S {
        let through = ((depth_m - self.depth_m) / self.width_m).tanh();
        -(self.force_n * S::from_f64(0.5) * (S::one() + through))
    }
}
