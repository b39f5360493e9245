//! Which effects are special cases of each other, or differ by less than a rig errs.

use estimator_core::physics::effect::{EffectId, Family};

/// Whether one effect is a special case of the other: that is no ambiguity, and the simpler one wins
/// where it is adequate.
pub(crate) fn related(one: EffectId, other: EffectId) -> bool {
    let family = one.info().family;
    one == other || (family.is_nested() && family == other.info().family)
}

/// Whether both effects only make the force late: in slow motion they differ by less than the errors of
/// a rig.
pub(crate) fn are_late(one: EffectId, other: EffectId) -> bool {
    let is_late = |id: EffectId| id.info().family == Family::Lateness;
    one != other && is_late(one) && is_late(other)
}

/// Whether two effects differ by less than the errors of a rig: they make the force late, or both make a loop
/// that is a share of the load.
pub(crate) fn are_alike(one: EffectId, other: EffectId) -> bool {
    let is_loop = |id: EffectId| id.info().family == Family::LoopOfLoad;
    are_late(one, other) || (one != other && is_loop(one) && is_loop(other))
}

/// Whether one effect stands for the other: a special case of it, or one that differs by less than a rig errs.
pub(crate) fn stands_for(one: EffectId, other: EffectId) -> bool {
    related(one, other) || are_alike(one, other)
}
