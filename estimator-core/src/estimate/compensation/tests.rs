//! What the signal chain of a rig adds is removed again.

use super::*;
use crate::physics::effect::MOST_PARAMETERS;
use crate::physics::{effect::Motion, law::HuntCrossley, rig::Environment, rig::Rig};

const RATE_HZ: f32 = 1000.0;
const PERIOD_S: f64 = 1e-3;

const GEL: HuntCrossley<f64> = HuntCrossley {
    stiffness_n_per_m: 1350.0,
    damping_ns_per_m: 36.0,
    exponent: 1.35,
    damping_exponent: 1.35,
    reference_depth_m: 1e-3,
};

/// 1.5 mm at 1.5 Hz about 0.8 mm below the surface, in and out of contact.
fn palpation(time_s: f64) -> Motion<f64> {
    let w = 9.42;
    Motion {
        time_s,
        position_m: 8e-4 - 1.5e-3 * libm::cos(w * time_s),
        speed_mps: 1.5e-3 * w * libm::sin(w * time_s),
        acceleration_mps2: 1.5e-3 * w * w * libm::cos(w * time_s),
    }
}

/// Largest errors of the tip (m) and of the contact force (N) after the effects of a rig have been
/// removed from the readings of its sensors, from the tenth of a second on.
fn remaining_errors(effects: &[(EffectId, [f64; MOST_PARAMETERS])]) -> [f64; 2] {
    let mut rig = Rig::bare(Environment::from(GEL));
    for (id, row) in effects {
        rig = rig.with(Effect::new(*id, row));
    }
    let compensation = Compensation::<f64>::new(&rig.effects, RATE_HZ, 0.0).unwrap();
    let ripple = rig.effects().find_map(|effect| match effect {
        Effect::EncoderPeriodicError(error) => Some(*error),
        _ => None,
    });
    // The motor side is known here: the rig must not look for it behind an encoder.
    let mut chain = rig;
    let moves = |effect: &Effect<f64>| effect.id() != EffectId::EncoderPeriodicError;
    chain.effects = rig.effects.filtered(moves);
    let shift_s = rig.delay_s().unwrap_or(0.0);
    let (mut now, mut late) = (chain.at_rest(), chain.at_rest());
    let mut state = compensation.at_rest();
    let mut worst = [0.0_f64; 2];
    for at in 0..2000_u32 {
        let time_s = f64::from(at) * PERIOD_S;
        let force_n = chain
            .step(&mut late, palpation(time_s - shift_s), PERIOD_S)
            .force_n;
        let moved = palpation(time_s);
        let sample = Sample {
            time_us: u64::from(at) * 1000,
            position_m: ripple.map_or(moved.position_m, |error| error.reading_m(moved.position_m)),
            force_n,
            ..Sample::default()
        };
        let out = compensation.step(&mut state, sample);
        // What was true at the instant that the result belongs to.
        let then_s = time_s - compensation.delay_s();
        let touch = chain.step(&mut now, palpation(then_s), PERIOD_S).touch;
        if at > 100 {
            worst[0] = worst[0].max((out.position_m - touch.depth_m).abs());
            worst[1] = worst[1].max((out.force_n - touch.force_n).abs());
        }
    }
    worst
}

#[test]
fn each_effect_of_the_rig_is_removed_from_its_readings() {
    // (effect, parameters, error of the tip (m), error of the force (N)). A window of ±5 ms rounds the
    // touch off by 12 mN and the sine by ½ẍΣhₖ(kT)² = 0.406 µm; a rig without a window is exact.
    for (id, row, tip_m, force_n) in [
        (
            EffectId::ForceOffset,
            [0.5, 0.0, 0.0, 0.0, 0.0],
            1e-15,
            1e-12,
        ),
        (
            EffectId::ForceDrift,
            [0.05, 10.0, 0.0, 0.0, 0.0],
            1e-15,
            1e-12,
        ),
        (
            EffectId::CableStiffness,
            [100.0, 0.0, 0.0, 0.0, 0.0],
            1e-15,
            1e-12,
        ),
        (EffectId::Cogging, [0.3, 5e-4, 0.3, 0.0, 0.0], 1e-15, 1e-12),
        (
            EffectId::PeriodicDisturbance,
            [0.3, 12.0, 0.3, 0.0, 0.0],
            1e-15,
            1e-12,
        ),
        (
            EffectId::SeriesCompliance,
            [12_000.0, 0.0, 0.0, 0.0, 0.0],
            1e-9,
            1e-9,
        ),
        (
            EffectId::SeriesCompliance,
            [9_000.0, 2.0, 0.0, 0.0, 0.0],
            1e-9,
            1e-9,
        ),
        (EffectId::Backlash, [1e-4, 0.0, 0.0, 0.0, 0.0], 1e-15, 1e-12),
        (
            EffectId::EncoderPeriodicError,
            [1e-5, 4e-4, 0.2, 0.0, 0.0],
            1e-8,
            1e-9,
        ),
        (
            EffectId::TimeDelay,
            [4.3e-3, 0.0, 0.0, 0.0, 0.0],
            2e-8,
            1e-12,
        ),
        (
            EffectId::TimeDelay,
            [-4.3e-3, 0.0, 0.0, 0.0, 0.0],
            1e-15,
            2e-3,
        ),
        (
            EffectId::ViscousDrag,
            [5.0, 0.0, 0.0, 0.0, 0.0],
            4.1e-7,
            1.2e-2,
        ),
        (
            EffectId::AsymmetricDrag,
            [3.0, 0.0, 0.0, 0.0, 0.0],
            4.1e-7,
            1.2e-2,
        ),
        (
            EffectId::ToolInertia,
            [0.5, 0.0, 0.0, 0.0, 0.0],
            4.1e-7,
            1.2e-2,
        ),
        (
            EffectId::ForceLag,
            [5e-3, 0.0, 0.0, 0.0, 0.0],
            4.1e-7,
            1.2e-2,
        ),
        (
            EffectId::CoulombFriction,
            [0.4, 0.0, 0.0, 0.0, 0.0],
            4.1e-7,
            6e-2,
        ),
        (
            EffectId::CoulombFriction,
            [0.4, 2e-5, 0.0, 0.0, 0.0],
            1e-15,
            1e-12,
        ),
        (
            EffectId::StribeckFriction,
            [0.3, 0.5, 2e-3, 1e-4, 0.0],
            4.1e-7,
            6e-2,
        ),
        // One that sticks is taken after the way of the window's mean: a step at a reversal comes later there.
        (
            EffectId::StribeckFriction,
            [0.3, 0.5, 2e-3, 0.0, 2e-5],
            4.1e-7,
            6e-2,
        ),
        (
            EffectId::LoadFriction,
            [0.1, 0.0, 0.0, 0.0, 2e-5],
            1e-15,
            1e-12,
        ),
        (
            EffectId::LoadFriction,
            [0.1, 0.0, 0.4, 2e-3, 2e-5],
            4.1e-7,
            6e-2,
        ),
    ] {
        let [tip, force] = remaining_errors(&[(id, row)]);
        assert!(tip < tip_m, "{}: {tip:e} m", id.name());
        assert!(force < force_n, "{}: {force:e} N", id.name());
    }
}

#[test]
fn several_effects_are_removed_together_and_those_of_the_material_stay() {
    let together = [
        (EffectId::ToolInertia, [0.2, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::ForceLag, [3e-3, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::SeriesCompliance, [12_000.0, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::ForceOffset, [-0.7, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::Adhesion, [0.2, 4e-4, 0.0, 0.0, 0.0]),
        (EffectId::StressRelaxation, [0.3, 2.0, 0.0, 0.0, 0.0]),
    ];
    let [tip, force] = remaining_errors(&together);
    // Adhesion begins with a step of 0.2 N, half of which the window does not contain yet.
    assert!(tip < 1e-5 && force < 0.15, "{tip:e} {force:e}");
    let rig = together
        .iter()
        .fold(Rig::bare(Environment::from(GEL)), |rig, (id, row)| {
            rig.with(Effect::new(*id, row))
        });
    let compensation = Compensation::<f32>::new(&rig.effects, RATE_HZ, 1e-6).unwrap();
    assert_eq!(compensation.ids().count(), 4);
    assert!(compensation.ids().all(EffectId::belongs_to_rig));
}

#[test]
fn every_effect_is_the_rigs_or_the_materials() {
    // Of the first 26, ten are the material's; later ones have any number.
    for id in EffectId::ALL.iter().take(26) {
        assert_eq!(id.belongs_to_rig(), *id as u8 > 10, "{}", id.name());
    }
    assert!(!EffectId::SurfaceMotion.belongs_to_rig());
}

/// A compensation of effects with a first number each.
fn compensation<const N: usize>(effects: [(EffectId, f64); N]) -> Compensation<f32> {
    let effect = |(id, first)| Effect::new(id, &[first, 0.0, 0.0, 0.0, 0.0]);
    let effects = effects.into_iter().map(effect).collect();
    Compensation::new(&effects, RATE_HZ, 1e-6).unwrap()
}

#[test]
fn friction_has_no_direction_where_the_encoder_sees_no_motion() {
    let compensation = compensation([(EffectId::CoulombFriction, 0.4)]);
    let mut state = compensation.at_rest();
    for at in 0..200_u64 {
        // One count comes and goes.
        let position_m = if at % 40 < 20 { 0.1 } else { 0.1 + 1e-6 };
        let read = Sample {
            time_us: at * 1000,
            position_m,
            force_n: 1.0,
            ..Sample::default()
        };
        assert!(
            (compensation.step(&mut state, read).force_n - 1.0).abs() < 1e-5,
            "{at}"
        );
    }
}

#[test]
fn a_finite_sample_gives_a_finite_result_after_any_other() {
    let row = [0.5, 0.1, 0.05, 0.01, 0.0];
    for id in EffectId::ALL {
        let effects = Effects::from_iter([Effect::new(*id, &row)]);
        let Ok(compensation) = Compensation::<f32>::new(&effects, RATE_HZ, 1e-6) else {
            assert_eq!(
                *id,
                EffectId::TimeDelay,
                "half a second is too long a delay"
            );
            continue;
        };
        let mut state = compensation.at_rest();
        for (at, value) in [0.0, f32::NAN, 3.0, f32::INFINITY, -1e6, 1e6, 0.1, 0.2]
            .into_iter()
            .enumerate()
        {
            for (position_m, force_n) in [(value, 1.0), (1.0, value)] {
                let read = Sample {
                    time_us: at as u64 * 777,
                    position_m,
                    force_n,
                    ..Sample::default()
                };
                let out = compensation.step(&mut state, read);
                if value.is_finite() {
                    assert!(
                        out.position_m.is_finite() && out.force_n.is_finite(),
                        "{}",
                        id.name()
                    );
                }
            }
        }
    }
}

#[test]
fn a_force_at_the_limit_is_marked_until_the_window_has_forgotten_it() {
    let compensation = compensation([
        (EffectId::ForceSaturation, 3.0),
        (EffectId::ViscousDrag, 1.0),
    ]);
    let mut state = compensation.at_rest();
    let marked = (0..100_u64).filter(|at| {
        let force_n = if *at == 50 { 2.99 } else { 2.0 };
        let read = Sample {
            time_us: at * 1000,
            force_n,
            ..Sample::default()
        };
        compensation
            .step(&mut state, read)
            .faults
            .has(Fault::ForceSaturated)
    });
    // ±5 samples and one on either side for the difference, and itself.
    assert_eq!(marked.count(), 13);
}

#[test]
fn a_fault_of_a_sample_is_a_fault_of_every_result_that_contains_it() {
    let compensation = compensation([(EffectId::ViscousDrag, 1.0)]);
    // (at instant 50: the fault, the time that is missing (µs), the fault that lingers)
    for (fault, missing_us, lingers) in [
        (Some(Fault::ForceSaturated), 0, Fault::ForceSaturated),
        (Some(Fault::ForceStuck), 0, Fault::ForceStuck),
        (Some(Fault::PositionStuck), 0, Fault::PositionStuck),
        // The window starts anew.
        (Some(Fault::PositionJump), 0, Fault::SampleMissed),
        (None, 3000, Fault::SampleMissed),
    ] {
        let mut state = compensation.at_rest();
        for at in 0..100_u64 {
            let read = Sample {
                time_us: at * 1000 + if at >= 50 { missing_us } else { 0 },
                force_n: 2.0,
                faults: fault
                    .filter(|_| at == 50)
                    .map_or(Faults::NONE, |fault| Faults::NONE.with(fault)),
                ..Sample::default()
            };
            let faults = compensation.step(&mut state, read).faults;
            assert_eq!(
                faults.has(lingers),
                (50..63).contains(&at),
                "{fault:?} at {at}"
            );
        }
    }
}
