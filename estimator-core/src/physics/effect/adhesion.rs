//! A contact that sticks.

use super::{row::effect, shapes::direction};
use crate::maths::scalar::Scalar;

effect! {
    /// A contact that sticks: a constant pull in all contact and a neck that tears on the way out; or a
    /// bond, which pulls only as far as the material is drawn out, so that after a hold it holds the
    /// probe back. Surfaces that close pull less than surfaces that part (adhesion hysteresis).
    Adhesion = "adhesion" {
        /// F_a (N)
        force_n = "force", Newton, Positive, Size, FitRange::up_to(Times(1.0, Force));
        /// d_a (m)
        neck_length_m = "neck_length", Metre, Positive, Shape, Linear(Times(2.0, PositionNoise), Times(1.0, Travel));
        /// 0: the contact pulls wherever it is. 1: a bond, max(relaxed + damping, −F_a) until it tears.
        bond = "bond", One, NotNegative = 0.0, Switch("it pulls in all contact"), Fixed(1.0);
        /// h: the share of F_a that is missing on the way in, and half of it at rest. A bond has none.
        hysteresis = "hysteresis", One, NotNegative = 0.0,
            Form("it pulls as much both ways", TakenOn { start: Number(0.3), first: 1.0 }), FitRange::up_to(Number(1.0));
        /// v_t (m/s): tanh(δ̇/v_t) in place of the sign; 0: the sign. In a hold a speed of counts that toggle has either.
        transition_mps = "transition_speed", MetrePerSecond, NotNegative = 0.0,
            Form("it turns at once", Beside(&[Largest([(4.0, SpeedNoise), (2e-3, Speed)]), Times(0.05, Speed)])),
            Logarithmic(Times(1e-3, Speed), Times(0.5, Speed));
    }
    stage: Contact, sign: OneWay, proportional: true, several: false, repeats: Never, timed: false,
    laws: AnyLaw, needs_derivative: false, family: Alone, simpler: None, is_physical: |_| true,
    example: [0.3, 4e-4, 0.0, 0.0, 0.0], starts: &[
        Starts::at(&[At(Times(1.0, SmallForce)), Each(&[Times(0.015, Travel), Times(0.05, Travel), Times(0.15, Travel)])]),
        // A bond carries what was pulled at most.
        Starts::at(&[At(Times(-1.0, LowestForce)), Each(&[Times(0.05, Travel), Times(0.15, Travel)]), Held(1.0)])
            .where_exceeds(Times(-1.0, LowestForce), Times(0.5, SmallForce)),
    ],
    law: "−F_a in contact; on the way out −F_a(1 + δ/d_a) for −d_a < δ < 0; bond = 1: none in contact, which pulls up to F_a; hysteresis h: F_a(1 − h) on the way in, with a transition speed F_a(1 − h(1 + tanh(δ̇/v_t))/2)",
    signature: "negative force after lift-off, none before touch",
    motion: "leave the contact slowly, and well clear of it",
}

impl<S: Scalar> Adhesion<S> {
    /// The pull (N, negative) at a depth. `attached` is 1 while the neck holds, and changes here.
    pub(crate) fn force_n(&self, attached: &mut S, depth_m: S, speed_mps: S) -> S {
        let (zero, one) = (S::zero(), S::one());
        if depth_m > zero {
            *attached = one;
            return -self.pull_n(speed_mps);
        }
        let left = one + depth_m / self.neck_length_m;
        if *attached > zero && left > zero {
            return -(self.pull_n(speed_mps) * left);
        }
        *attached = zero;
        zero
    }

    /// F_a(1 − h(1 + sgn δ̇)/2), the sign as tanh(δ̇/v_t)
    fn pull_n(&self, speed_mps: S) -> S {
        if self.hysteresis <= S::zero() {
            return self.force_n;
        }
        let closing = S::from_f64(0.5) * (S::one() + direction(speed_mps, self.transition_mps));
        self.force_n * S::zero().max_of(S::one() - self.hysteresis * closing)
    }

    /// The force (N) of a bonded contact that would be pushed by `pushed_n` if it could not tear.
    /// `state` is 1 while it holds, 0 before it is made and after its neck, −δ at tearing in between.
    pub(crate) fn bonded_n(&self, state: &mut S, depth_m: S, pushed_n: S) -> S {
        let (zero, one) = (S::zero(), S::one());
        // Pressing makes it, again after it tore.
        if depth_m > zero && pushed_n > zero {
            *state = one;
            return pushed_n;
        }
        let holds = pushed_n >= -self.force_n;
        let pull_n = if holds { pushed_n } else { -self.force_n };
        if *state > zero {
            if depth_m > zero {
                if !holds {
                    *state = -depth_m;
                }
                return pull_n;
            }
            let left = one + depth_m / self.neck_length_m;
            if left > zero {
                return pull_n * left;
            }
        } else if *state < zero {
            let left = one + (depth_m + *state) / self.neck_length_m;
            if left > zero {
                return -(self.force_n * left);
            }
        }
        *state = zero;
        zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pull_turns_with_the_speed_where_that_has_a_width() {
        let pull = |transition_mps: f64, speed_mps: f64| {
            let adhesion = Adhesion {
                force_n: 0.5,
                neck_length_m: 4e-4,
                bond: 0.0,
                hysteresis: 0.4,
                transition_mps,
            };
            adhesion.force_n(&mut 0.0, 1e-3, speed_mps)
        };
        // GIVEN a sign, THEN a count that toggles in a hold makes all of the difference, 0.2 N.
        assert!((pull(0.0, 1e-6) + 0.3).abs() < 1e-12);
        assert!((pull(0.0, -1e-6) + 0.5).abs() < 1e-12);
        // AND with 1 mm/s hardly any, though fast motion has it all.
        assert!((pull(1e-3, 1e-6) - pull(1e-3, -1e-6)).abs() < 1e-3);
        assert!((pull(1e-3, 0.05) + 0.3).abs() < 1e-12);
        assert!((pull(1e-3, -0.05) + 0.5).abs() < 1e-12);
    }
}
