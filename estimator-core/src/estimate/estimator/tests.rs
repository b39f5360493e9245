//! The whole loop on strokes over gel: what it finds, and what it makes of samples that are none.

use super::*;
extern crate std;
use crate::estimate::config::{Config, Surface};
use crate::estimate::status::Status;
use crate::physics::law::{ContactLaw, HuntCrossley};

fn params() -> Params<f32> {
    let mut config = Config::default();
    config.contact.surface = Surface::Known { position_m: 0.0 };
    config.contact.force_noise_n = Some(0.02);
    config.validate().unwrap()
}

/// Sample number `i` of 0.5 s of rest and then 1.2 Hz strokes to 3 mm on gel, 5 mN steps.
fn stroke(i: u32) -> Sample<f32> {
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let omega = core::f64::consts::TAU * 1.2;
    let angle = omega * (f64::from(i.max(500)) - 500.0) * 1e-3;
    let position_m = -5e-4 + 1.75e-3 * (1.0 - libm::cos(angle));
    let force_n = gel.force_n(position_m, 1.75e-3 * omega * libm::sin(angle));
    Sample {
        time_us: u64::from(i + 1) * 1000,
        position_m: position_m as f32,
        force_n: (libm::round(force_n / 5e-3) * 5e-3) as f32,
        faults: Faults::NONE,
    }
}

fn run(state: &mut State<f32>, samples: core::ops::Range<u32>) -> Estimate<f32> {
    let params = params();
    samples
        .map(|i| step(&params, state, stroke(i)))
        .last()
        .unwrap()
}

#[test]
fn gel_is_found_from_nothing() {
    let mut state = State::new(&params());
    let end = run(&mut state, 0..7000);
    assert_eq!(end.status, Status::Converged);
    let value = |slot: usize| end.parameters[slot].unwrap().value;
    // The error of the method on gel is 0.3 % (median of 200 materials 0.5 %).
    assert!((value(0) / 1350.0 - 1.0).abs() < 0.02, "{}", value(0));
    assert!((value(1) / 36.0 - 1.0).abs() < 0.02, "{}", value(1));
    assert!((value(2) / 1.35 - 1.0).abs() < 0.02, "{}", value(2));
}

/// The largest error of the stiffness (in its own standard errors) in presses at 0.3 counts a sample, an encoder of
/// 5 µm read `latches` times in each; with what it claims (N/m).
fn of_slow_presses(latches: u32, count_m: Option<f32>) -> (f64, f64) {
    const COUNT: f64 = 5e-6;
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let mut config = Config::default();
    config.contact.position_step_m = count_m;
    let params = config.validate::<f32>().unwrap();
    let mut state = State::new(&params);
    let way_m = |s: f64| {
        let phase = (s - 0.5).max(0.0) % 2.4;
        1.5e-3 * (if phase < 1.2 { phase } else { 2.4 - phase }) - 3e-4
    };
    let mut seed = 7_u32;
    let mut noise = || {
        // Twelve uniform numbers: normal to the third digit, and the same everywhere.
        let sum: f64 = (0..12)
            .map(|_| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(seed >> 8) / f64::from(1 << 24)
            })
            .sum();
        0.02 * (sum - 6.0)
    };
    let mut worst = 0.0_f64;
    let mut claimed = 0.0;
    for i in 0_u32..12_000 {
        let at = |part: f64| (f64::from(i) + part) * 1e-3;
        let read = |part: f64| libm::floor(way_m(at(part)) / COUNT + 0.37) * COUNT;
        let parts = (0..latches).map(|k| (f64::from(k) + 0.5) / f64::from(latches));
        let position_m = parts.map(read).sum::<f64>() / f64::from(latches);
        let speed_mps = (way_m(at(0.51)) - way_m(at(0.49))) / 2e-5;
        let end = step(
            &params,
            &mut state,
            Sample {
                time_us: u64::from(i + 1) * 1000,
                position_m: position_m as f32,
                force_n: (gel.force_n(way_m(at(0.5)), speed_mps) + noise()) as f32,
                faults: Faults::NONE,
            },
        );
        if end.status == Status::Converged {
            let stiffness = end.parameters[0].unwrap();
            claimed = f64::from(stiffness.std_error);
            worst = worst.max((f64::from(stiffness.value) - 1350.0).abs() / claimed);
        }
    }
    (worst, claimed)
}

#[test]
fn an_encoder_that_is_read_32_times_a_sample_has_the_error_of_a_count_all_the_same() {
    let (off, claimed) = of_slow_presses(1, None);
    let (off_of_sums, claimed_of_sums) = of_slow_presses(32, Some(5e-6));
    assert!(off < 3.0 && off_of_sums < 3.0, "{off} {off_of_sums}");
    // By the smallest step of the sums, 5 µm / 32, it never converged: what was left was far above its errors.
    let ratio = claimed_of_sums / claimed;
    assert!((0.9..1.1).contains(&ratio), "{claimed} {claimed_of_sums}");
}

#[test]
fn learning_can_be_switched_off_and_the_estimates_cleared() {
    let params = params();
    let mut state = State::new(&params);
    let learned = run(&mut state, 0..3000);
    state.enable_learning(false);
    let held = run(&mut state, 3000..4000);
    assert_eq!(held.parameters, learned.parameters);
    assert!(held.innovation.variance_n2 > 0.0 || held.phase != Phase::Contact);
    state.enable_learning(true);
    assert_ne!(run(&mut state, 4000..4500).parameters, learned.parameters);
    state.reset_estimates(&params);
    assert_eq!(run(&mut state, 4500..4501).parameters[0], None);
    let anew = run(&mut state, 4501..7000).parameters[0].unwrap().value;
    // What gel_is_found_from_nothing allows.
    assert!((anew / 1350.0 - 1.0).abs() < 0.02, "{anew}");
}

#[test]
fn what_is_not_a_number_is_dropped_and_changes_nothing() {
    let params = params();
    let mut state = State::new(&params);
    run(&mut state, 0..3000);
    let mut disturbed = state.clone();
    let bad = [
        (f32::NAN, 0.0),
        (f32::INFINITY, 0.0),
        (0.0, f32::NAN),
        (1e30, 0.0),
        (0.0, 1e30),
    ];
    for (i, (force_n, position_m)) in bad.into_iter().enumerate() {
        let time_us = 3_000_001 + i as u64;
        let faults = Faults::NONE;
        let out = step(
            &params,
            &mut disturbed,
            Sample {
                time_us,
                position_m,
                force_n,
                faults,
            },
        );
        assert!(out.is_finite());
        let fault = if position_m == 0.0 {
            Fault::ForceUnusable
        } else {
            Fault::PositionUnusable
        };
        assert!(out.faults.has(fault), "{:?}", out.faults);
    }
    assert_eq!(run(&mut state, 3000..4000), run(&mut disturbed, 3000..4000));
}

#[test]
fn time_that_stands_still_or_runs_back_is_dropped() {
    let params = params();
    let mut state = State::new(&params);
    run(&mut state, 0..3000);
    for i in [2999, 17] {
        let out = step(&params, &mut state, stroke(i));
        assert_eq!(out.faults, Faults::NONE.with(Fault::TimeNotAdvancing));
    }
}

#[test]
fn after_a_gap_the_filter_window_is_refilled_before_anything_is_learned() {
    let params = params();
    let mut state = State::new(&params);
    run(&mut state, 0..900);
    let after = step(&params, &mut state, stroke(920));
    assert_eq!(after.faults, Faults::NONE.with(Fault::SampleMissed));
    assert_eq!(after.phase, Phase::Contact);
    // 17 samples of window, the first of them the one after the gap.
    assert_eq!(run(&mut state, 921..936).forgetting, 1.0);
    assert!(run(&mut state, 936..956).forgetting < 1.0);
}

/// Strokes of 0.4 to 1.2 s into gel and at once back into it, 40 to 90 ms of air on each side of a turn;
/// switched on within a press, after `from` samples of the first.
fn switched_on_in_a_press(from: u32, seed: u64) -> impl Iterator<Item = Sample<f32>> {
    let gel = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3);
    let mut random = seed;
    let mut unit = move || {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut started, mut lasts, mut way_m) = (0.0, 0.0, 0.0);
    let strokes = (0_u32..).map(move |i| {
        let t = f64::from(i) * 1e-3;
        if t >= started + lasts {
            (started, lasts, way_m) = (t, 0.4 + 0.8 * unit(), 2.5e-3 + 2.5e-3 * unit());
        }
        let u = (t - started) / lasts;
        let position_m = way_m * 16.0 * u * u * (1.0 - u) * (1.0 - u) - 5e-4;
        let speed = way_m * 32.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / lasts;
        let noise_n = 0.02 * ((0..12).map(|_| unit()).sum::<f64>() - 6.0);
        let force_n = gel.force_n(position_m, speed).max(0.0) + noise_n;
        Sample {
            time_us: u64::from(i + 1) * 1000,
            position_m: (libm::floor(position_m * 1e6) * 1e-6) as f32,
            force_n: (libm::round(force_n / 5e-3) * 5e-3) as f32,
            faults: Faults::NONE,
        }
    });
    strokes.skip(from as usize)
}

#[test]
fn switched_on_in_a_press_it_finds_the_zero_and_converges() {
    // GIVEN a board that takes a force of some newtons, and how it changes, for zero and its noise
    let params: Params<f32> = Config::default().validate().unwrap();
    for seed in 1..=20_u64 {
        let mut state = State::new(&params);
        let from = 90 + 17 * seed as u32;
        let mut converged = 0;
        // WHEN it goes on for six seconds of strokes
        for sample in switched_on_in_a_press(from, seed).take(6000) {
            let estimate = step(&params, &mut state, sample);
            if estimate.status == Status::Converged {
                converged += 1;
                // THEN what it calls converged is right
                let k = estimate.parameters[0].unwrap().value;
                assert!((k / 1350.0 - 1.0).abs() < 0.05, "seed {seed}: {k}");
            }
        }
        // AND it finds its way back, some 1 to 5 s before the end.
        assert!(converged > 800, "seed {seed}: {converged} samples");
    }
}

#[test]
fn every_fault_of_the_sensor_is_passed_on() {
    let params = params();
    let mut state = State::new(&params);
    let faults = Faults::NONE
        .with(Fault::Overrun)
        .with(Fault::ForceSaturated);
    let out = step(
        &params,
        &mut state,
        Sample {
            faults,
            ..stroke(0)
        },
    );
    assert_eq!(out.faults, faults);
}

/// Fault × what the estimate does with a sample that a board reports it for, in the middle of a
/// stroke: dropped, learned from, and for how many samples nothing is learned.
#[test]
fn what_an_estimate_does_with_each_reported_fault() {
    let memory = 17;
    let table = [
        (Fault::ForceUnusable, true, 0),
        (Fault::PositionUnusable, true, 0),
        (Fault::TimeNotAdvancing, true, 0),
        (Fault::SampleMissed, false, memory),
        (Fault::ForceSaturated, false, memory),
        (Fault::Overrun, false, 0),
        (Fault::NotFinite, false, 0),
        (Fault::ForceStuck, false, memory),
        (Fault::PositionJump, false, memory),
        (Fault::PositionStuck, false, memory),
        (Fault::SettingsInvalid, false, 0),
        (Fault::NotCalibrated, false, 0),
        (Fault::EstimatorSuspect, false, 0),
        (Fault::ClockInternal, false, 0),
        (Fault::RenderStopped, false, 0),
        (Fault::RenderUnusable, false, 0),
    ];
    assert_eq!(table.map(|(fault, ..)| fault), Fault::ALL);
    let params = params();
    for (fault, dropped, unlearned) in table {
        let mut state = State::new(&params);
        // On the way down into the gel, where every sample is learned from.
        let before = run(&mut state, 0..800);
        assert!(before.phase == Phase::Contact && before.forgetting < 1.0);
        let faults = Faults::NONE.with(fault);
        let bad = Sample {
            faults,
            ..stroke(800)
        };
        let out = step(&params, &mut state, bad);
        assert!(out.faults.has(fault) && out.is_finite());
        assert_eq!(out.time_us == before.time_us, dropped, "{fault:?}");
        // A dropped sample leaves a hole of one period: the next one counts as missed after 1.5.
        let last = (0..60)
            .filter(|i| step(&params, &mut state, stroke(801 + i)).forgetting == 1.0)
            .last();
        let quiet = last.map_or(0, |i| i + 2);
        let expected = if dropped { memory + 1 } else { unlearned };
        assert_eq!(quiet, expected, "{fault:?}");
    }
}
