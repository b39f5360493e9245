//! Friction that grows with the load, as of a screw, a bearing or a tendon in its sheath.

use super::{load_memory::LoadPathMemory, load_memory::Rubbing, row::effect};
use crate::maths::scalar::Scalar;

effect! {
    /// The friction μ·|F_contact + k_c·x_d|·sgn(v). A lubricated one is larger near standstill:
    /// μ·(1 + e/(1 + (v/v_s)²)), after Hess and Soom. With a width the surfaces stick elastically before they slide
    /// (Dahl), and the force stays in a hold.
    LoadFriction = "load_friction" {
        /// μ; with 1 a drive locks itself.
        coefficient = "coefficient", One, Positive, Size, FitRange::up_to(Number(0.9));
        /// v_t (m/s): tanh(v/v_t) in place of the sign; 0: the sign.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it reverses at once", Dropped), Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
        /// e: how much more there is of it at standstill.
        excess = "standstill_excess", One, NotNegative = 0.0,
            Form("the same at every speed", TakenOn { start: Number(0.3), first: 0.9 }), FitRange::up_to(Number(5.0));
        /// v_s (m/s): where half of that is gone.
        speed_mps = "speed", MetrePerSecond, NotNegative = 0.0,
            Form("the same at every speed", Beside(&[Times(0.1, Speed), Times(0.3, Speed)])),
            Logarithmic(Times(3e-3, Speed), Times(1.0, Speed));
        /// The width of the elastic stick (m); 0: the surfaces only slide.
        width_m = "width", Metre, NotNegative = 0.0,
            Form("it only slides", OfTheStart), Logarithmic(Times(1.0, PositionNoise), Times(0.2, Travel));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: LoopOfLoad, simpler: None, is_physical: |_| true,
    example: [0.1, 2e-4, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Number(0.05)), Each(&[
            Largest([(1.0, SpeedNoise), (2e-3, Speed)]), Largest([(4.0, SpeedNoise), (2e-2, Speed)]),
        ])]),
        Starts::at(&[At(Number(0.05)), Held(0.0), Held(0.0), Held(0.0),
            Each(&[Times(2e-4, Travel), Times(1.5e-3, Travel), Times(1.5e-2, Travel)])]),
    ],
    law: "μ·|F_contact + k_c·x_d|·sgn(v); with an excess e: times 1 + e/(1 + (v/v_s)²); width > 0: elastic before it slides",
    signature: "steps at reversals that grow with the load",
    motion: "reversals at several depths, and a hold",
}

impl<S: Scalar> LoadFriction<S> {
    /// Its force for each newton of load.
    pub(crate) fn share_of_load(&self, memory: &mut LoadPathMemory<S>, rubbing: &Rubbing<S>) -> S {
        let share = self.coefficient * memory.side(rubbing, self.width_m, self.transition_mps);
        if self.excess == S::zero() || self.speed_mps <= S::zero() {
            return share;
        }
        let fast = rubbing.speed_mps / self.speed_mps;
        share * (S::one() + self.excess / (S::one() + fast * fast))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LUBRICATED: LoadFriction<f64> = LoadFriction {
        coefficient: 0.1,
        transition_mps: 0.0,
        excess: 0.4,
        speed_mps: 5e-3,
        width_m: 0.0,
    };

    fn share(friction: &LoadFriction<f64>, speed_mps: f64) -> f64 {
        friction.share_of_load(
            &mut LoadPathMemory::at_rest(),
            &Rubbing::without_play(speed_mps, 0.0),
        )
    }

    #[test]
    fn its_excess_is_whole_at_standstill_half_at_its_speed_and_gone_far_beyond() {
        for (speed_mps, exact) in [(1e-9, 0.14), (5e-3, 0.12), (-5e-3, -0.12), (5.0, 0.1)] {
            // At a thousand times the speed a millionth of the excess is left.
            let own = share(&LUBRICATED, speed_mps);
            assert!((own - exact).abs() < 1e-7, "{speed_mps}: {own}");
        }
        let dry = LoadFriction {
            excess: 0.0,
            ..LUBRICATED
        };
        assert_eq!(share(&dry, -5e-3), -0.1);
    }

    #[test]
    fn what_sticks_stays_in_a_hold_and_turns_over_its_width() {
        // GIVEN a friction that sticks over 20 µm, pushed for 0.2 mm
        let sticky = LoadFriction {
            excess: 0.0,
            width_m: 20e-6,
            ..LUBRICATED
        };
        let mut memory = LoadPathMemory::at_rest();
        let mut pushed = |speed_mps, way_m| {
            sticky.share_of_load(&mut memory, &Rubbing::without_play(speed_mps, way_m))
        };
        let slides = pushed(5e-3, 0.2e-3);
        assert!((slides - 0.1).abs() < 1e-5, "{slides}");
        // THEN it is the same at rest, and 0 after w ln 2 on the way back.
        assert_eq!(pushed(0.0, 0.0), slides);
        let turned = pushed(-5e-3, -20e-6 * core::f64::consts::LN_2);
        assert!(turned.abs() < 1e-5, "{turned}");
    }
}
