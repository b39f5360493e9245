//! What every contact law can do: turn a penetration and its rate into a force.

use crate::maths::scalar::Scalar;

/// A contact law without memory.
pub trait ContactLaw<S: Scalar> {
    /// Force on the probe (N) at penetration `depth_m` (m), which changes by `speed_mps` (m/s).
    /// Zero outside the material; not saturated, so a law that pulls while unloading does.
    fn force_n(&self, depth_m: S, speed_mps: S) -> S;
}

/// A contact law that may remember: the force depends on how the depth came about. Every
/// [`ContactLaw`] is one that does not, so that a rig or a fit can treat all laws alike.
pub trait RelaxingLaw<S: Scalar> {
    /// What the law remembers from sample to sample.
    type State: Copy + core::fmt::Debug;

    /// The state of a material that was never touched, or long ago.
    fn at_rest(&self) -> Self::State;

    /// Force on the probe (N) one period (s) after the last step, at penetration `depth_m` (m),
    /// which changes by `speed_mps` (m/s). To be called for every sample, in free air as well: the
    /// state runs on, decaying. Zero outside the material; not saturated.
    fn step(&self, state: &mut Self::State, depth_m: S, speed_mps: S, period_s: S) -> S;

    /// As [`step`](Self::step), of a surface that recovers by creep
    /// ([`Recovery::ByCreep`](super::Recovery)): where the law would pull, the probe is free, and there
    /// is no force until it reaches what has come back. A law without memory comes back at once.
    fn step_creeping(&self, state: &mut Self::State, depth_m: S, speed_mps: S, period_s: S) -> S {
        self.step(state, depth_m, speed_mps, period_s)
    }

    /// Force (N) at once: the depth was just reached, from rest, and nothing moves or has relaxed.
    fn elastic_n(&self, depth_m: S) -> S;
}

/// Makes a [`ContactLaw`] a [`RelaxingLaw`] without memory. A blanket implementation would keep every
/// other law out: a crate downstream might make it a [`ContactLaw`].
macro_rules! remembers_nothing {
    ($Law:ident) => {
        impl<S: $crate::maths::scalar::Scalar> RelaxingLaw<S> for $Law<S> {
            type State = ();

            fn at_rest(&self) {}

            fn step(&self, _state: &mut (), depth_m: S, speed_mps: S, _period_s: S) -> S {
                self.force_n(depth_m, speed_mps)
            }

            fn elastic_n(&self, depth_m: S) -> S {
                self.force_n(depth_m, S::zero())
            }
        }
    };
}
pub(super) use remembers_nothing;

/// The force (N) of a surface that does not stick: it pushes and never pulls. A simulated rig applies
/// it, estimators do not.
pub fn unilateral<S: Scalar>(force_n: S) -> S {
    S::zero().max_of(force_n)
}
