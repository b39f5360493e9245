//! Dry friction that is larger near standstill.

use super::{row::effect, shapes::direction};
use crate::maths::scalar::Scalar;

effect! {
    /// The friction [F_c + (F_s − F_c)e^{−(v/v_s)²}]·sgn(v).
    StribeckFriction = "stribeck_friction" {
        /// F_c (N)
        kinetic_n = "kinetic_force", Newton, NotNegative, Size, FitRange::up_to(Times(2.0, Force));
        /// F_s (N)
        static_n = "static_force", Newton, NotNegative, Size, FitRange::up_to(Times(2.0, Force));
        /// v_s (m/s)
        speed_mps = "speed", MetrePerSecond, Positive, Shape, Logarithmic(Times(3e-3, Speed), Times(1.0, Speed));
        /// v_t (m/s): tanh(v/v_t) in place of the sign; 0: the sign.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it reverses at once", OfTheStart), Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: DryFriction, simpler: Some("coulomb_friction"),
    // A friction that is smaller at rest than sliding imitates a drag.
    is_physical: |[kinetic_n, static_n, ..]| static_n >= kinetic_n,
    example: [0.3, 0.6, 2e-3, 1e-4], starts: &[
        Starts::at(&[
            At(Times(1.0, SmallForce)), At(Times(1.5, SmallForce)), Each(&[Times(0.03, Speed), Times(0.1, Speed), Times(0.3, Speed)]),
            At(Largest([(1.0, SpeedNoise), (3e-3, Speed)])),
        ]),
    ],
    law: "[F_c + (F_s − F_c)e^{−(v/v_s)²}]·sgn(v)",
    signature: "a step at each reversal, also in free motion, larger near v = 0",
    motion: "free motion with slow and fast reversals",
}

impl<S: Scalar> StribeckFriction<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, speed_mps: S) -> S {
        let share = speed_mps / self.speed_mps;
        let near = (-(share * share)).exp();
        let size = self.kinetic_n + (self.static_n - self.kinetic_n) * near;
        size * direction(speed_mps, self.transition_mps)
    }
}
