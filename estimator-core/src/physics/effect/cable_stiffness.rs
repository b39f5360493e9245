//! A cable or hose that pulls back.

use super::row::effect;
use crate::maths::scalar::Scalar;

effect! {
    /// A spring k_c·x that is relaxed at x = 0; or one that hardens with its way, as a bellows, a flexure or a joint
    /// near its end does.
    CableStiffness = "cable_stiffness" {
        /// k_c (N/m)
        stiffness_n_per_m = "stiffness", NewtonPerMetre, Any, Size, FitRange::ANY;
        /// l_h (m): the way at which its force is twice that of a straight spring; 0: it is always as stiff.
        hardening_m = "hardening_length", Metre, NotNegative = 0.0,
            Form("it is always as stiff", TakenOn { start: Times(1.0, Reach), first: 0.7 }),
            Logarithmic(Times(0.03, Reach), Times(10.0, Reach));
    }
    stage: LoadPath, sign: Either, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [100.0, 0.0, 0.0, 0.0, 0.0], starts: &[Starts::at(&[At(Ratio(1.0, SmallForce, Reach))])],
    law: "k_c·x; with a hardening length l_h k_c·x·(1 + (x/l_h)²)",
    signature: "linear in x, or steeper towards the ends, also in free motion",
    motion: "free motion over a long way",
}

impl<S: Scalar> CableStiffness<S> {
    /// Its force (N).
    pub(crate) fn force_n(&self, position_m: S) -> S {
        let straight_n = self.stiffness_n_per_m * position_m;
        if self.hardening_m <= S::zero() {
            return straight_n;
        }
        let way = position_m / self.hardening_m;
        straight_n * (S::one() + way * way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_its_hardening_length_it_pulls_twice_as_much_either_way() {
        let straight = CableStiffness {
            stiffness_n_per_m: 30.0,
            hardening_m: 0.0,
        };
        let bellows = CableStiffness {
            hardening_m: 0.5,
            ..straight
        };
        for way_m in [0.5, -0.5] {
            assert_eq!(straight.force_n(way_m), 30.0 * way_m);
            assert_eq!(bellows.force_n(way_m), 60.0 * way_m);
        }
    }
}
