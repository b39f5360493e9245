//! The rig as a whole: what it records is what happened, and material can be swapped.

use super::super::{GEL, PLASTIC};
use super::*;
use crate::motion::Segment;
use estimator_core::physics::law::{KelvinVoigt, Law};

const SEED: u64 = 7;

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_palpation_reaches_the_depths_and_forces_of_the_chapters_figures() {
    // The chapter: gel 4–4.5 mm and 10–12 N, plastic ≈ 1 mm and 12–14 N.
    for (material, depth, force) in [
        (GEL, 4.0e-3..4.3e-3, 9.0..12.0),
        (PLASTIC, 0.88e-3..1.02e-3, 9.5..14.0),
    ] {
        let motion = Motion::palpation(material.peak_depth_m);
        let schedule = Stage::throughout(material.at(0.0));
        let run = Rig::default().run(&schedule, &motion, SEED).unwrap();
        let (deepest, strongest) = (largest(&run.truth.position_m), largest(&run.truth.force_n));
        assert!(depth.contains(&deepest), "{}: {deepest} m", material.name);
        assert!(
            force.contains(&strongest),
            "{}: {strongest} N",
            material.name
        );
        assert_eq!(run.clipped, 0);
        assert!(run.log.notes.is_empty());
        assert_eq!(run.log.rate_hz(), 1000.0);
    }
}

#[test]
fn the_sensors_differ_from_the_truth_by_their_own_errors_only() {
    let schedule = Stage::throughout(GEL.at(0.0));
    let run = Rig::default()
        .run(&schedule, &Motion::palpation(4.2e-3), SEED)
        .unwrap();
    let errors = |read: &[f64], truth: &[f64]| -> Vec<f64> {
        read.iter()
            .zip(truth)
            .map(|(read, truth)| read - truth)
            .collect()
    };
    let force = errors(&run.log.force_n, &run.truth.force_n);
    let rms = (force.iter().map(|e| e * e).sum::<f64>() / force.len() as f64).sqrt();
    // √(20² + 5²/12) mN, five standard errors of 8000 samples.
    assert!((rms - 0.02005).abs() < 8e-4, "{rms}");
    let position = errors(&run.log.position_m, &run.truth.position_m);
    assert!(position.iter().all(|error| error.abs() <= 1e-6));
}

#[test]
fn the_pressed_motor_comes_to_rest_where_the_forces_balance() {
    let contact = Contact {
        law: Law::KelvinVoigt(KelvinVoigt {
            stiffness_n_per_m: 2260.0,
            damping_ns_per_m: 123.0,
        }),
        surface_m: 0.5e-3,
        ..Contact::FREE
    };
    let motion = Motion::new(
        -1e-3,
        vec![
            Segment::Ramp {
                to_m: 3e-3,
                speed_mps: 0.02,
            },
            Segment::Hold { seconds: 1.0 },
        ],
    )
    .unwrap();
    let rig = Rig {
        sensors: Sensors::PERFECT,
        ..Rig::default()
    };
    let run = rig.run(&Stage::throughout(contact), &motion, SEED).unwrap();
    // kp(r − x) = K(x − s)
    let kp = rig.motor.stiffness_n_per_m;
    let exact_m = (kp * 3e-3 + 2260.0 * 0.5e-3) / (kp + 2260.0);
    let rest_m = run.log.position_m.last().unwrap();
    // 1 s is 300 time constants: only rounding is left.
    assert!((rest_m - exact_m).abs() < 1e-15, "{rest_m} {exact_m}");
}

#[test]
fn a_material_is_swapped_while_lifted_off_and_only_then() {
    let first = Motion::palpation(0.9e-3);
    let motion = first.clone().then(&first);
    let swap_at = |until_s| {
        [
            Stage {
                until_s,
                contact: GEL.at(0.0),
            },
            Stage {
                until_s: f64::INFINITY,
                contact: PLASTIC.at(0.0),
            },
        ]
    };
    let run = Rig::default()
        .run(&swap_at(first.duration_s()), &motion, SEED)
        .unwrap();
    let middle = run.log.len() / 2;
    let soft = largest(&run.truth.force_n[..middle]);
    let stiff = largest(&run.truth.force_n[middle..]);
    assert!(stiff > 7.0 * soft, "{soft} N, then {stiff} N");
    // 0.65 s into the sines (which begin at 0.9 s) the probe is deep in the gel.
    let error = Rig::default()
        .run(&swap_at(1.45), &motion, SEED)
        .unwrap_err();
    assert!(error.what.contains("swapped at 1.45 s"), "{error}");
}

#[test]
fn one_seed_is_one_recording_and_the_truth_needs_none() {
    let run = |seed| {
        let schedule = Stage::throughout(GEL.at(0.0));
        Rig::default()
            .run(&schedule, &Motion::palpation(4.2e-3), seed)
            .unwrap()
    };
    let (a, b, c) = (run(1), run(1), run(2));
    assert_eq!(a, b);
    assert_eq!(a.truth, c.truth);
    assert_ne!(a.log.force_n, c.log.force_n);
}

#[test]
fn a_force_beyond_the_converter_is_clipped_and_said_so() {
    let schedule = Stage::throughout(PLASTIC.at(0.0));
    let run = Rig::default()
        .run(&schedule, &Motion::palpation(2e-3), SEED)
        .unwrap();
    assert!(run.clipped > 100);
    assert!(run.log.notes[0].contains("end of the converter's range"));
}

#[test]
fn a_material_that_the_steps_cannot_follow_is_refused() {
    let contact = Contact {
        law: Law::KelvinVoigt(KelvinVoigt {
            stiffness_n_per_m: 1e12,
            damping_ns_per_m: 1e9,
        }),
        surface_m: 0.0,
        ..Contact::FREE
    };
    let motion = Motion::palpation(4e-3);
    let outcome = Rig::default().run(&Stage::throughout(contact), &motion, SEED);
    assert!(outcome.is_err());
}
