//! Which effects are special cases of each other, or differ by less than a rig errs.

use estimator_core::physics::effect::{EffectId, Family};

use crate::gap::model::{shape::Term, start::of_size};

/// Whether one effect is a special case of the other: that is no ambiguity, and the simpler one wins
/// where it is adequate.
pub(crate) fn related(one: EffectId, other: EffectId) -> bool {
    let family = one.info().family;
    one == other || (family.is_nested() && family == other.info().family)
}

/// The simpler effect of the family that an effect has as a special case.
pub(crate) fn simpler(id: EffectId) -> Option<EffectId> {
    EffectId::from_name(id.info().simpler?)
}

/// A term as the simpler effect of its family, with its size and what has the same name: a Stribeck friction that is none
/// near standstill. `None` where its size is in another unit, as the stiffness of a loop is.
pub(crate) fn as_simpler(term: &Term) -> Option<Term> {
    let simpler = simpler(term.id)?;
    let (own, others) = (term.id.info().parameters, simpler.info().parameters);
    if own[0].unit != others[0].unit {
        return None;
    }
    let mut plain = of_size(simpler, term.row[0]);
    for (at, parameter) in others.iter().enumerate() {
        if let Some(from) = own.iter().position(|own| own.name == parameter.name) {
            (plain.row[at], plain.free[at]) = (term.row[from], term.free[from]);
        }
    }
    Some(plain)
}

/// Whether an effect only makes the force late, by its first number (s).
pub(crate) fn is_lateness(id: EffectId) -> bool {
    id.info().family == Family::Lateness
}

/// Whether both effects only make the force late: in slow motion they differ by less than the errors of
/// a rig.
pub(crate) fn are_late(one: EffectId, other: EffectId) -> bool {
    one != other && is_lateness(one) && is_lateness(other)
}

/// Whether both effects oppose the motion, and differ by how they depend on its speed: at one speed they are one.
pub(crate) fn oppose_motion(one: EffectId, other: EffectId) -> bool {
    let opposes = |id: EffectId| {
        let family = id.info().family;
        matches!(family, Family::DryFriction | Family::Drag) || id == EffectId::QuadraticDrag
    };
    one != other && opposes(one) && opposes(other)
}

/// Whether one is a zero that is off and the other one that drifts: the place is the same, and what is to be taken off is
/// not, so that either leaves the other open.
pub(crate) fn is_another_zero(one: EffectId, other: EffectId) -> bool {
    let is_zero = |id: EffectId| id.info().family == Family::ForceZero;
    one != other && is_zero(one) && is_zero(other)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::model::start::whole;

    #[test]
    fn a_stribeck_friction_is_coulombs_with_its_kinetic_force_and_forms_and_a_loop_is_not() {
        let whole = |id, row: [f64; 5]| whole(id, row, 5);
        let own = whole(EffectId::StribeckFriction, [0.3, 0.5, 1e-2, 2e-4, 3e-5]);
        let plain = as_simpler(&own).unwrap();
        assert_eq!(plain.id, EffectId::CoulombFriction);
        assert_eq!(plain.row, [0.3, 3e-5, 2e-4, 0.0, 0.0]);
        assert_eq!(plain.free, [true, true, true, false, false]);
        let held = Term {
            free: [true, true, true, true, false],
            ..own
        };
        assert!(!as_simpler(&held).unwrap().free[1]);
        assert_eq!(as_simpler(&of_size(EffectId::BoucWen, 1.0)), None);
        assert_eq!(as_simpler(&plain), None);
    }

    #[test]
    fn a_lag_stands_for_a_delay_and_a_friction_under_load_for_a_loading_curve_and_no_more() {
        let (lag, delay) = (EffectId::ForceLag, EffectId::TimeDelay);
        let (friction, curve) = (EffectId::LoadFriction, EffectId::LoadingCurve);
        for (one, other) in [(lag, delay), (friction, curve), (curve, friction)] {
            assert!(are_alike(one, other) && stands_for(one, other));
            // It is no special case: both names stay.
            assert!(!related(one, other));
        }
        assert!(!are_alike(friction, friction) && stands_for(friction, friction));
        assert!(!stands_for(friction, EffectId::CoulombFriction) && !stands_for(lag, curve));
        let (dry, wet) = (EffectId::CoulombFriction, EffectId::ViscousDrag);
        assert!(oppose_motion(dry, wet) && oppose_motion(wet, EffectId::QuadraticDrag));
        assert!(!oppose_motion(dry, dry) && !oppose_motion(dry, EffectId::Adhesion));
        // Only lateness may hide in the lasting errors of a rig.
        assert!(are_late(lag, delay) && !are_late(friction, curve));
    }
}
