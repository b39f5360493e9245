//! What the effects of a load path share: a play, and a load.

use super::effect::{Effect, LoadFriction, LoadPathMemory, beyond_play};
use crate::maths::scalar::Scalar;

/// The play in front of whatever restores in the load path (m); 0 without one.
pub(crate) fn play_m<'a, S: Scalar>(effects: impl Iterator<Item = &'a Effect<S>>) -> S {
    effects.fold(S::zero(), |sum, effect| match effect {
        Effect::DriveBacklash(play) => sum + play.width_m,
        _ => sum,
    })
}

/// The force of the cables (N) behind a play of `play_m`.
pub(crate) fn cables_n<'a, S: Scalar>(
    effects: impl Iterator<Item = &'a Effect<S>>,
    position_m: S,
    play_m: S,
) -> S {
    let pulled_m = beyond_play(position_m, play_m);
    effects.fold(S::zero(), |sum, effect| match effect {
        Effect::CableStiffness(cable) => sum + cable.force_n(pulled_m),
        _ => sum,
    })
}

/// Winds an effect that sticks up to a `side`, from −1 to 1 what it takes to slide.
pub(crate) fn wind<S: Scalar>(effect: &Effect<S>, memory: &mut LoadPathMemory<S>, side: S) {
    let zero = S::zero();
    memory.wind(match effect {
        Effect::CoulombFriction(own) if own.width_m > zero => side,
        Effect::StribeckFriction(own) if own.width_m > zero => side,
        Effect::LoadFriction(own) if own.width_m > zero => side,
        Effect::BoucWen(own) => side * own.largest_m(),
        _ => zero,
    });
}

/// What the frictions that grow with the load add for each newton of it, a `share` each; `None` without one.
pub(crate) fn share_of_load<'a, S: Scalar>(
    effects: impl Iterator<Item = (&'a Effect<S>, &'a mut LoadPathMemory<S>)>,
    share: impl Fn(&'a LoadFriction<S>, &'a mut LoadPathMemory<S>) -> S,
) -> Option<S> {
    effects.fold(None, |sum, (effect, memory)| match effect {
        Effect::LoadFriction(friction) => Some(sum.unwrap_or(S::zero()) + share(friction, memory)),
        _ => sum,
    })
}

/// The contact force F (N), of which F + share·|F + C| is known, with the force C of the cables (N).
pub(crate) fn without_load_friction_n<S: Scalar>(known_n: S, cables_n: S, share: S) -> S {
    const LEAST: f64 = 0.05;
    let load_n = known_n + cables_n;
    let share = if load_n < S::zero() { -share } else { share };
    // Beyond 1 a drive locks itself, and nothing can be said of the contact.
    load_n / S::from_f64(LEAST).max_of(S::one() + share) - cables_n
}
