//! Dry friction that is larger near standstill.

use super::direction;
use super::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// [F_c + (F_s − F_c)e^{−(v/v_s)²}]·sgn(v)
    StribeckFriction = "stribeck_friction", LoadPath {
        /// F_c (N)
        kinetic_n = "kinetic_force", Newton, NotNegative;
        /// F_s (N)
        static_n = "static_force", Newton, NotNegative;
        /// v_s (m/s)
        speed_mps = "speed", MetrePerSecond, Positive;
        /// v_t (m/s): tanh(v/v_t) in place of the sign; 0: the sign.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative, 0.0;
    }
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
