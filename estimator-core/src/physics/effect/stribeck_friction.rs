//! Dry friction that is larger near standstill.

use super::{load_memory::LoadPathMemory, load_memory::Rubbing, row::effect};
use super::{shapes::direction, shapes::slid_to};
use crate::maths::scalar::Scalar;

effect! {
    /// The friction g(v)·sgn(v), g = F_c + (F_s − F_c)e^{−(v/v_s)²}. With a width w the surfaces stick before they
    /// slide with the stiffness F_s/w (LuGre): dF/ds = (F_s/w)·(1 − F·sgn(v)/g(v)), and the force stays in a hold.
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
        /// w (m): F_s over the stiffness with which it sticks; 0: the surfaces only slide.
        width_m = "width", Metre, NotNegative = 0.0,
            Form("it only slides", OfTheStart), Logarithmic(Times(1.0, PositionNoise), Times(0.2, Travel));
    }
    stage: LoadPath, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: true, family: DryFriction, simpler: Some("coulomb_friction"),
    // A friction that is smaller at rest than sliding imitates a drag.
    is_physical: |[kinetic_n, static_n, ..]| static_n >= kinetic_n,
    example: [0.3, 0.6, 2e-3, 1e-4, 0.0], starts: &[
        Starts::at(&[
            At(Times(1.0, SmallForce)), At(Times(1.5, SmallForce)), Each(&[Times(0.03, Speed), Times(0.1, Speed), Times(0.3, Speed)]),
            At(Largest([(1.0, SpeedNoise), (3e-3, Speed)])),
        ]),
        Starts::at(&[
            Held(0.0), At(Times(1.5, SmallForce)), Each(&[Times(0.03, Speed), Times(0.2, Speed)]),
            Held(0.0), Each(&[Times(2e-4, Travel), Times(1.5e-3, Travel), Times(1.5e-2, Travel)]),
        ])
        // Alone it has room enough to follow a foam that relaxes, and halved what nothing else explained of it.
        .beside("coulomb_friction"),
    ],
    law: "[F_c + (F_s − F_c)e^{−(v/v_s)²}]·sgn(v); width > 0: elastic before it slides",
    signature: "a step at each reversal, also in free motion, larger near v = 0",
    motion: "free motion with slow and fast reversals, and a hold",
}

impl<S: Scalar> StribeckFriction<S> {
    /// Its force (N).
    pub(super) fn force_n(&self, memory: &mut LoadPathMemory<S>, rubbing: &Rubbing<S>) -> S {
        /// A friction that slides with less of what it sticks with than this is none at that speed.
        const LEAST: f64 = 1e-6;
        let sliding_n = self.sliding_n(rubbing.speed_mps);
        if self.width_m <= S::zero() || self.static_n <= S::zero() {
            return sliding_n * direction(rubbing.speed_mps, self.transition_mps);
        }
        let most = (sliding_n / self.static_n).max_of(S::from_f64(LEAST));
        let z = memory.follow(rubbing.change_m, rubbing.play_m, |z, way_m| {
            slid_to(most, z, way_m, self.width_m)
        });
        self.static_n * z
    }

    /// g(v): what it takes to slide (N).
    fn sliding_n(&self, speed_mps: S) -> S {
        let share = speed_mps / self.speed_mps;
        let near = (-(share * share)).exp();
        self.kinetic_n + (self.static_n - self.kinetic_n) * near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STICKS: StribeckFriction<f64> = StribeckFriction {
        kinetic_n: 0.4,
        static_n: 0.6,
        speed_mps: 1e-3,
        transition_mps: 0.0,
        width_m: 20e-6,
    };

    #[test]
    fn it_sticks_like_a_spring_lets_go_at_its_static_force_and_slides_with_less() {
        // GIVEN a friction that is pushed slowly, in steps of 0.1 µm
        let mut memory = LoadPathMemory::at_rest();
        let mut slow = |_| STICKS.force_n(&mut memory, &Rubbing::without_play(1e-6, 0.1e-6));
        let way: [f64; 2000] = core::array::from_fn(&mut slow);
        // THEN it is a spring of F_s/w at first, and levels off at F_s.
        let stiffness = way[0] / 0.1e-6;
        assert!((stiffness * 20e-6 / 0.6 - 1.0).abs() < 0.01, "{stiffness}");
        assert!((way[1999] - 0.6).abs() < 1e-4, "{}", way[1999]);
        // WHEN it is fast, THEN it falls to F_c within a few widths, and keeps that in a hold.
        let fast = STICKS.force_n(&mut memory, &Rubbing::without_play(20e-3, 0.2e-3));
        assert!((fast - 0.4).abs() < 1e-5, "{fast}");
        assert_eq!(
            STICKS.force_n(&mut memory, &Rubbing::without_play(0.0, 0.0)),
            fast
        );
    }

    #[test]
    fn one_that_is_nothing_when_fast_stays_finite_and_without_a_static_force_nothing_sticks() {
        let only_at_rest = StribeckFriction {
            kinetic_n: 0.0,
            ..STICKS
        };
        let mut memory = LoadPathMemory::at_rest();
        let fast = only_at_rest.force_n(&mut memory, &Rubbing::without_play(1.0, 1e-3));
        assert!((0.0..1e-5).contains(&fast), "{fast}");
        let none = StribeckFriction {
            static_n: 0.0,
            ..only_at_rest
        };
        assert_eq!(
            none.force_n(&mut memory, &Rubbing::without_play(1.0, 1e-3)),
            0.0
        );
    }
}
