//! Elastic force that grows exponentially with depth.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// The elastic force times e^{bδ}.
    ExponentialStiffening = "exponential_stiffening" {
        /// b (1/m)
        rate_per_m = "rate", PerMetre, Positive, Size, FitRange::up_to(Per(20.0, Travel));
        /// q: how much the rate itself grows, towards a depth that locks.
        bend = "bend", One, NotNegative = 0.0,
            // Half of a growth of e^{1.5} is the bend's.
            Form("its rate is constant", TakenOn { start: Number(1.3), first: 0.5 }), FitRange::up_to(Number(10.0));
    }
    stage: Elastic, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: NotExponential, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [60.0, 0.0, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Per(0.2, Travel))]),
        // A power of the depth imitates an exponential, and its residuals show nothing of one: an exponent of
        // 4.4 for 1.5 and e^{1.2}.
        Starts::at(&[At(Per(1.0, Travel))]).also_from_the_file(),
        Starts::at(&[At(Per(0.4, Travel)), At(Number(0.5))]),
    ],
    law: "Fᵉ·e^{bδ}; with a bend q: Fᵉ·e^{bδ(1 + q·bδ)}",
    signature: "misfit grows at the deepest strokes",
    motion: "press deep",
}

impl<S: Scalar> ExponentialStiffening<S> {
    /// The factor on the elastic force.
    pub(crate) fn factor(&self, depth_m: S) -> S {
        let growth = self.rate_per_m * depth_m;
        (growth + self.bend * growth * growth).exp()
    }
}
