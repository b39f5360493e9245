//! Dry friction of the drive or the guide, between the motor and the load cell.

use super::{load_memory::LoadPathMemory, load_memory::Rubbing, row::effect};
use crate::maths::scalar::Scalar;

effect! {
    /// The friction F_c·sgn(v). With a width the surfaces stick elastically before they slide (Dahl),
    /// and the force stays in a hold.
    CoulombFriction = "coulomb_friction" {
        /// F_c (N)
        force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(2.0, Force));
        /// The width of the elastic stick (m); 0: the surfaces only slide.
        width_m = "width", Metre, NotNegative = 0.0,
            Form("it only slides", OfTheStart), Logarithmic(Times(1.0, PositionNoise), Times(0.2, Travel));
        /// v_t (m/s): tanh(v/v_t) in place of the sign; 0: the sign. No dry contact reverses at once.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it reverses at once", Dropped), Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: DryFriction, simpler: None, is_physical: |_| true,
    example: [0.4, 1e-5, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Times(1.0, SmallForce)), Held(0.0), Each(&[
            Largest([(1.0, SpeedNoise), (2e-3, Speed)]), Largest([(4.0, SpeedNoise), (2e-3, Speed)]),
        ])]),
        Starts::at(&[At(Times(1.0, SmallForce)), Each(&[Times(1.5e-3, Travel), Times(5e-3, Travel), Times(1.5e-2, Travel)])]),
    ],
    law: "F_c·sgn(v); width > 0: elastic before it slides",
    signature: "a step at each reversal, also in free motion; whether it stays in a hold tells sliding from pre-sliding",
    motion: "free motion with reversals, and a hold",
}

impl<S: Scalar> CoulombFriction<S> {
    /// Its force (N).
    pub(super) fn force_n(&self, memory: &mut LoadPathMemory<S>, rubbing: &Rubbing<S>) -> S {
        self.force_n * memory.side(rubbing, self.width_m, self.transition_mps)
    }
}
