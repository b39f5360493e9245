use std::path::Path;

use estimator_core::physics::effect::EffectId as E;

use super::*;
use crate::motion::Segment;
use crate::plant::{Rig, Stage};
use crate::toml_reader::TomlFile;

fn model(environment: &str) -> Model {
    let path = Path::new("model.toml");
    Model::from_toml(&TomlFile::parse(environment.into(), path).unwrap(), path).unwrap()
}

fn gel() -> Model {
    model("[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 2000.0\ndamping = 10.0\n")
}

fn of(plan: &Plan, id: E) -> &PlannedEffect {
    plan.effects.iter().find(|effect| effect.id == id).unwrap()
}

fn sigma_between(plan: &Plan, id: E, rival: E) -> f64 {
    of(plan, id)
        .rivals
        .iter()
        .find(|(other, _)| *other == rival)
        .unwrap()
        .1
}

#[test]
fn a_palpation_shows_friction_and_a_slow_sine_in_contact_does_not_tell_drag_from_damping() {
    // GIVEN a palpation with free air, and one slow sine that never leaves the material
    let palpation = plan(&gel(), None, None, &Options::default()).unwrap();
    let sine = Motion::new(
        1e-3,
        vec![Segment::Sine {
            mean_m: 2.5e-3,
            amplitude_m: 1.5e-3,
            frequency_hz: 0.5,
            seconds: 10.0,
        }],
    )
    .unwrap();
    let slow = plan(&gel(), Some(&sine), None, &Options::default()).unwrap();
    // THEN the first shows friction and drag, and tells friction from everything
    for id in [
        E::CoulombFriction,
        E::ViscousDrag,
        E::ForceOffset,
        E::StressRelaxation,
    ] {
        assert!(palpation.counts(of(&palpation, id).seen_sigma), "{id:?}");
    }
    let friction = of(&palpation, E::CoulombFriction);
    assert!(
        palpation.counts(friction.rivals[0].1),
        "{:?}",
        friction.rivals[0]
    );
    // the second does not show drag (the damper does the same), nor an offset (the surface does),
    for id in [E::ViscousDrag, E::ForceOffset, E::CableStiffness] {
        let effect = of(&slow, id);
        assert!(
            !slow.counts(effect.seen_sigma),
            "{id:?}: {} σ",
            effect.seen_sigma
        );
        // and one of the excitations does.
        assert!(effect.further.is_some(), "{id:?}");
    }
}

#[test]
fn lag_and_series_compliance_are_one_group_on_a_linear_contact_that_lasts() {
    // Both move the force of a Kelvin–Voigt contact by a time: K/k_s·… and T are the same derivative.
    let sine = Motion::new(
        1e-3,
        vec![Segment::Sine {
            mean_m: 2.5e-3,
            amplitude_m: 1.5e-3,
            frequency_hz: 1.0,
            seconds: 10.0,
        }],
    )
    .unwrap();
    let plan = plan(&gel(), Some(&sine), Some(0.2), &Options::default()).unwrap();
    let groups = plan.groups();
    let lag = of(&plan, E::ForceLag);
    let together = |ids: &Vec<E>| ids.contains(&E::ForceLag) && ids.contains(&E::SeriesCompliance);
    assert!(
        !plan.counts(lag.seen_sigma) || groups.iter().any(together),
        "{} σ, {groups:?}",
        lag.seen_sigma
    );
}

#[test]
fn a_plan_is_the_same_at_any_scale() {
    // GIVEN the same rig a million times smaller and ten thousand times weaker
    let small = model(
        "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 0.2\ndamping = 1e-3\nreference_depth = 1e-6\n\
         [sensors]\nforce_noise = 2e-9\nposition_step = 1e-9\nforce_step = 1e-10\n",
    );
    let large = model(
        "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 2000.0\ndamping = 10.0\n\
         [sensors]\nforce_noise = 0.02\nposition_step = 1e-6\nforce_step = 1e-3\n",
    );
    let (small, large) = (
        plan(&small, None, None, &Options::default()).unwrap(),
        plan(&large, None, None, &Options::default()).unwrap(),
    );
    for (a, b) in small.effects.iter().zip(&large.effects) {
        // 10 nm and 10 N over 5 mm are no exact multiples of the counts: a tenth.
        let near = (a.seen_sigma - b.seen_sigma).abs() <= 0.1 * b.seen_sigma.max(1.0);
        assert!(
            a.id == b.id && near,
            "{:?}: {} and {} σ",
            a.id,
            a.seen_sigma,
            b.seen_sigma
        );
    }
    assert!(sigma_between(&large, E::ForceOffset, E::ViscousDrag) > large.least_sigma);
}

#[test]
fn an_advised_motion_stays_within_the_range_of_the_rigs_own_cell() {
    // GIVEN a damped contact on which fast strokes to the depth of 10 N pushed with 21 N, and a cell that ends at 15.4 N
    let model = model(
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1350.0\ndamping = 36.0\nexponent = 1.35\nsurface = 0.0\n",
    );
    let plan = plan(&model, None, None, &Options::default()).unwrap();
    let mut advised: Vec<&FurtherMotion> = Vec::new();
    for further in plan.effects.iter().filter_map(|own| own.further.as_ref()) {
        if advised.iter().all(|other| other.name != further.name) {
            advised.push(further);
        }
    }
    assert!(!advised.is_empty());
    // THEN what is expected of each motion and what the simulated rig reads stay within it.
    for further in advised {
        let peak_n = further.peak_n.unwrap();
        assert!(peak_n <= 0.9 * 15.36, "{}: {peak_n} N", further.name);
        let (contact, effects) = model.simulated().unwrap();
        let rig = Rig {
            sensors: model.sensors,
            effects,
            ..Rig::default()
        };
        let run = rig.run(&Stage::throughout(contact), &further.motion, 1);
        assert_eq!(run.unwrap().clipped, 0, "{}", further.name);
    }
}
