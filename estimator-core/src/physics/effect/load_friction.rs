//! Friction that grows with the load, as of a screw, a bearing or a tendon in its sheath.

use super::{row::effect, shapes::direction};
use crate::maths::scalar::Scalar;

effect! {
    /// The friction μ·|F_contact + k_c·x_d|·sgn(v).
    LoadFriction = "load_friction" {
        /// μ; with 1 a drive locks itself.
        coefficient = "coefficient", One, Positive, Size, FitRange::up_to(Number(0.9));
        /// v_t (m/s): tanh(v/v_t) in place of the sign; 0: the sign.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it reverses at once", Dropped), Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.1, 2e-4, 0.0, 0.0], starts: &[
        Starts::at(&[At(Number(0.05)), Each(&[
            Largest([(1.0, SpeedNoise), (2e-3, Speed)]), Largest([(4.0, SpeedNoise), (2e-2, Speed)]),
        ])]),
    ],
    law: "μ·|F_contact + k_c·x_d|·sgn(v)",
    signature: "steps at reversals that grow with the load",
    motion: "reversals at several depths, and a hold",
}

impl<S: Scalar> LoadFriction<S> {
    /// Its force for each newton of load.
    pub(crate) fn share_of_load(&self, speed_mps: S) -> S {
        self.coefficient * direction(speed_mps, self.transition_mps)
    }
}
