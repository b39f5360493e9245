//! What an effect of the load path remembers, and the play in front of it.

use super::shapes::{direction, slid};
use crate::maths::scalar::Scalar;

/// What moves a dry friction from one sample to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rubbing<S> {
    /// Speed of the motor side (m/s).
    pub(crate) speed_mps: S,
    /// Way of the motor side since the last sample (m).
    pub(crate) change_m: S,
    /// A play in front of surfaces that stick (m).
    pub(crate) play_m: S,
}

#[cfg(test)]
impl Rubbing<f64> {
    pub(super) fn without_play(speed_mps: f64, change_m: f64) -> Self {
        Rubbing {
            speed_mps,
            change_m,
            play_m: 0.0,
        }
    }
}

/// What an effect of the load path remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LoadPathMemory<S> {
    /// Its internal state.
    pub(super) z: S,
    /// Where it is within a play in front of it (m), from −w/2 to w/2.
    pub(super) gap_m: S,
}

impl<S: Scalar> LoadPathMemory<S> {
    /// Before anything has moved.
    pub(crate) fn at_rest() -> LoadPathMemory<S> {
        LoadPathMemory {
            z: S::zero(),
            gap_m: S::zero(),
        }
    }

    /// Gives it an internal state.
    pub(crate) fn wind(&mut self, z: S) {
        self.z = z;
    }
}

/// What is left of a position (m) behind a play about zero of the width (m): how far it is beyond a flank.
pub(crate) fn beyond_play<S: Scalar>(position_m: S, play_m: S) -> S {
    let half = play_m * S::from_f64(0.5);
    if position_m > half {
        position_m - half
    } else if position_m < -half {
        position_m + half
    } else {
        S::zero()
    }
}

impl<S: Scalar> LoadPathMemory<S> {
    /// The side to which a dry friction pulls, −1 to 1: one that sticks elastically over a width follows the way
    /// (Dahl), one that only slides has the direction of the speed.
    pub(super) fn side(&mut self, rubbing: &Rubbing<S>, width_m: S, transition_mps: S) -> S {
        if width_m > S::zero() {
            return self.follow(rubbing.change_m, rubbing.play_m, |z, way_m| {
                slid(z, way_m, width_m)
            });
        }
        direction(rubbing.speed_mps, transition_mps)
    }

    /// The state z of an effect that follows the way, after a way of `change_m` with a play of `play_m` in
    /// front of it: `follow(z, way)` is its state after a way that pushes it. Where z passes through 0 the
    /// flank lets go, and the rest of the way is taken from the play before the other flank pushes.
    pub(super) fn follow(&mut self, change_m: S, play_m: S, follow: impl Fn(S, S) -> S) -> S {
        let zero = S::zero();
        if play_m <= zero {
            self.z = follow(self.z, change_m);
            return self.z;
        }
        let half = play_m * S::from_f64(0.5);
        let mut way_m = change_m;
        if self.z != zero {
            let next = follow(self.z, way_m);
            if (next > zero) == (self.z > zero) && (next < zero) == (self.z < zero) {
                self.z = next;
                return next;
            }
            self.gap_m = if self.z > zero { half } else { -half };
            way_m = way_m * (next / (next - self.z));
            self.z = zero;
        }
        let at_m = self.gap_m + way_m;
        self.gap_m = at_m.max_of(-half).min_of(half);
        let pushed_m = beyond_play(at_m, play_m);
        if pushed_m != zero {
            self.z = follow(zero, pushed_m);
        }
        self.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::effect::shapes::slid;

    const PLAY_M: f64 = 1e-3;

    #[test]
    fn between_the_flanks_nothing_pushes_and_on_a_flank_the_way_counts() {
        for (at, beyond) in [
            (0.4e-3, 0.0),
            (-0.5e-3, 0.0),
            (0.9e-3, 0.4e-3),
            (-2e-3, -1.5e-3),
        ] {
            assert!((beyond_play(at, PLAY_M) - beyond).abs() < 1e-18, "{at}");
        }
    }

    #[test]
    fn after_a_reversal_a_friction_unwinds_then_the_play_is_crossed_without_force() {
        // GIVEN a friction that sticks over 0.2 mm behind a play of 1 mm, pushed far on one flank
        let mut memory = LoadPathMemory::at_rest();
        let follow = |z: f64, way_m: f64| slid(z, way_m, 0.2e-3);
        let pushed = memory.follow(5e-3, PLAY_M, follow);
        assert!((pushed - 1.0).abs() < 1e-9, "{pushed}");
        // WHEN the motor goes back in steps of a micrometre
        let way: [f64; 3000] = core::array::from_fn(|_| memory.follow(-1e-6, PLAY_M, follow));
        let free = way.iter().filter(|z| **z == 0.0).count();
        let unwound = way.iter().position(|z| *z <= 0.0).unwrap();
        // THEN it has let go after w ln 2 of the way, is without force over the play, and pushes the other way.
        let exact = 0.2e-3 * core::f64::consts::LN_2 * 1e6;
        assert!((unwound as f64 - exact).abs() < 2.0, "{unwound} of {exact}");
        assert!((free as f64 - 1000.0).abs() < 2.0, "{free}");
        assert!(way[2999] < -0.999, "{}", way[2999]);
    }

    #[test]
    fn without_a_play_the_way_is_the_motors() {
        let (mut with, mut without) = (LoadPathMemory::at_rest(), 0.0);
        for way_m in [3e-5, 4e-5, -2e-5, -9e-5] {
            without = slid(without, way_m, 1e-4);
            assert_eq!(
                with.follow(way_m, 0.0, |z, way| slid(z, way, 1e-4)),
                without
            );
        }
    }
}
