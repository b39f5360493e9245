//! What the simulated rig adds, against closed forms.

use std::f64::consts::TAU;

use estimator_core::physics::effect::{Effect, EffectId, MOST_PARAMETERS};
use estimator_core::physics::{law::KelvinVoigt, law::Law};

use super::super::GEL;
use super::*;
use crate::motion::Segment;

const SEED: u64 = 7;

/// A rig with perfect sensors and these effects.
fn rig<const N: usize>(effects: [(EffectId, [f64; MOST_PARAMETERS]); N]) -> Rig {
    let effect = |(id, row): (EffectId, [f64; MOST_PARAMETERS])| Effect::new(id, &row);
    Rig {
        sensors: Sensors::PERFECT,
        effects: effects.into_iter().map(effect).collect(),
        ..Rig::default()
    }
}

fn run(rig: &Rig, contact: Contact, motion: &Motion) -> Run {
    rig.run(&Stage::throughout(contact), motion, SEED).unwrap()
}

fn spring(stiffness_n_per_m: f64) -> Contact {
    Contact {
        law: Law::KelvinVoigt(KelvinVoigt {
            stiffness_n_per_m,
            damping_ns_per_m: 0.0,
        }),
        surface_m: 0.0,
        ..Contact::FREE
    }
}

fn ramp(to_m: f64, speed_mps: f64) -> Segment {
    Segment::Ramp { to_m, speed_mps }
}

/// To 4 mm at 10 mm/s, a rest of half a second, and back.
fn there_and_back() -> Motion {
    let rest = Segment::Hold { seconds: 0.5 };
    Motion::new(0.0, vec![ramp(4e-3, 0.01), rest, ramp(0.0, 0.01)]).unwrap()
}

#[test]
fn friction_in_free_air_is_a_force_against_the_way_and_nothing_else() {
    let rig = rig([(EffectId::CoulombFriction, [0.4, 0.0, 0.0, 0.0, 0.0])]);
    let run = run(&rig, Contact::FREE, &there_and_back());
    let mut seen = [0, 0];
    for (force, speed) in run.log.force_n.iter().zip(&run.truth.velocity_mps) {
        if speed.abs() > 1e-6 {
            assert_eq!(*force, 0.4 * speed.signum());
            seen[usize::from(*speed > 0.0)] += 1;
        }
    }
    // At rest for 0.4 s it has no direction.
    assert_eq!(run.log.force_n[850], 0.0);
    // 0.4 s each way.
    assert!(seen.iter().all(|count| *count > 380), "{seen:?}");
    assert!(run.truth.force_n.iter().all(|force| *force == 0.0));
}

#[test]
fn the_load_cell_feels_a_tools_inertia_as_the_closed_loop_moves_it() {
    // X/R = (kp + jω·kd)/(kp − mω² + jω·kd), F = 0.2 kg·ω²|X|, an amplitude.
    let rig = rig([(EffectId::ToolInertia, [0.2, 0.0, 0.0, 0.0, 0.0])]);
    let sine = Segment::Sine {
        mean_m: 0.0,
        amplitude_m: 1e-3,
        frequency_hz: 10.0,
        seconds: 3.0,
    };
    let run = run(&rig, Contact::FREE, &Motion::new(0.0, vec![sine]).unwrap());
    let (motor, w) = (rig.motor, TAU * 10.0);
    let (kp, kd) = (motor.stiffness_n_per_m, w * motor.damping_ns_per_m);
    let gain = kp.hypot(kd) / (kp - motor.mass_kg * w * w).hypot(kd);
    let settled = &run.log.force_n[1000..2000];
    let peak = settled.iter().copied().fold(0.0_f64, f64::max);
    let exact = 0.2 * w * w * 1e-3 * gain;
    // 100 samples a cycle miss the peak by (π/100)²/2 = 5e-4 of it at most.
    assert!((peak / exact - 1.0).abs() < 5e-4, "{peak} {exact}");
}

/// Force and position at the end of the ramp of [`there_and_back`], where all has settled.
fn on_the_ramp(run: &Run) -> (f64, f64) {
    (run.log.force_n[380], run.log.position_m[380])
}

#[test]
fn a_ramp_of_force_comes_late_by_the_lag() {
    let cable = (EffectId::CableStiffness, [500.0, 0.0, 0.0, 0.0, 0.0]);
    let lag = (EffectId::ForceLag, [8e-3, 0.0, 0.0, 0.0, 0.0]);
    let (force, position) = on_the_ramp(&run(&rig([cable, lag]), Contact::FREE, &there_and_back()));
    let exact = 500.0 * (position - 8e-3 * 0.01);
    // e^{−0.38 s/8 ms} = 2e-21 of the start is left; the drive follows the ramp to rounding.
    assert!((force - exact).abs() < 1e-12, "{force} {exact}");
}

#[test]
fn a_delay_shifts_the_force_and_a_negative_one_the_position() {
    let cable = (EffectId::CableStiffness, [500.0, 0.0, 0.0, 0.0, 0.0]);
    for delay_s in [3.33e-3, -3.33e-3] {
        let delay = (EffectId::TimeDelay, [delay_s, 0.0, 0.0, 0.0, 0.0]);
        let run = run(&rig([cable, delay]), Contact::FREE, &there_and_back());
        let (force, position) = on_the_ramp(&run);
        let exact = 500.0 * (position - delay_s * 0.01);
        assert!((force - exact).abs() < 1e-12, "{force} {exact}");
        let late_m = run.truth.position_m[380] - position;
        let expected_m = (-delay_s * 0.01).max(0.0);
        assert!((late_m - expected_m).abs() < 1e-15, "{late_m}");
    }
}

#[test]
fn play_leaves_the_force_as_it_is_after_a_reversal() {
    let rig = rig([(EffectId::Backlash, [2e-4, 0.0, 0.0, 0.0, 0.0])]);
    let run = run(&rig, spring(2000.0), &there_and_back());
    let peak_m = run.truth.position_m.iter().copied().fold(0.0, f64::max);
    let (mut flat, mut further) = (0, 0);
    for (force, (position, speed)) in run
        .log
        .force_n
        .iter()
        .zip(run.truth.position_m.iter().zip(&run.truth.velocity_mps))
    {
        if *speed > -5e-3 || *position < 1e-3 {
            continue;
        }
        // On the way back: held for 0.2 mm, then 2 N/mm with the tip 0.1 mm above.
        let exact = 2000.0 * (position + 1e-4).min(peak_m - 1e-4);
        assert!((force - exact).abs() < 1e-12, "{force} {exact}");
        match position + 2e-4 > peak_m {
            true => flat += 1,
            false => further += 1,
        }
    }
    assert!(flat > 10 && further > 200, "{flat} {further}");
}

#[test]
fn a_spring_behind_the_probe_makes_the_contact_softer() {
    let rig = rig([(EffectId::SeriesCompliance, [6000.0, 0.0, 0.0, 0.0, 0.0])]);
    let run = run(&rig, spring(2000.0), &there_and_back());
    for (force, position) in run.log.force_n.iter().zip(&run.log.position_m) {
        let exact = 1500.0 * position.max(0.0);
        assert!((force - exact).abs() < 1e-9, "{force} {exact}");
    }
    assert!(run.log.force_n[500] > 5.0);
}

#[test]
fn the_encoder_reads_its_ripple_and_the_cell_no_more_than_its_limit() {
    let ripple = (EffectId::EncoderPeriodicError, [2e-5, 1e-3, 0.4, 0.0, 0.0]);
    let limit = (EffectId::ForceSaturation, [3.0, 0.0, 0.0, 0.0, 0.0]);
    let run = run(&rig([ripple, limit]), spring(2000.0), &there_and_back());
    for (read, truth) in run.log.position_m.iter().zip(&run.truth.position_m) {
        let exact = truth + 2e-5 * (TAU * 1e3 * truth + 0.4).sin();
        assert!((read - exact).abs() < 1e-15);
    }
    for (read, truth) in run.log.force_n.iter().zip(&run.truth.force_n) {
        // A limit without softness is F_max − max(F_max − F, 0): the last bit of F is not kept.
        assert!((read - truth.min(3.0)).abs() < 1e-14, "{read} {truth}");
    }
    assert!(run.truth.force_n[500] > 5.0);
}

#[test]
fn what_the_load_path_adds_does_not_move_the_motor() {
    let motion = Motion::palpation(4e-3);
    let plain = run(&rig([]), GEL.at(0.0), &motion);
    let hidden = rig([
        (EffectId::CoulombFriction, [5.0, 1e-5, 0.0, 0.0, 0.0]),
        (EffectId::ToolInertia, [1.0, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::ForceOffset, [2.0, 0.0, 0.0, 0.0, 0.0]),
        (EffectId::ForceLag, [2e-3, 0.0, 0.0, 0.0, 0.0]),
    ]);
    let hidden = run(&hidden, GEL.at(0.0), &motion);
    assert_eq!(plain.truth, hidden.truth);
    assert_ne!(plain.log.force_n, hidden.log.force_n);
}

#[test]
fn every_effect_of_the_catalogue_runs_on_the_rig() {
    let rest = Segment::Hold { seconds: 0.1 };
    let stroke = Motion::new(-1e-3, vec![ramp(3e-3, 0.02), rest, ramp(-1e-3, 0.02)]).unwrap();
    // A cable stands in every rig: a play in a drive changes nothing but what restores behind it.
    let cable = (EffectId::CableStiffness, [200.0, 0.0, 0.0, 0.0, 0.0]);
    let plain = run(&rig([cable]), GEL.at(0.0), &stroke);
    for id in EffectId::ALL {
        // Sizes of a palpation rig for each unit: N and N s/m near 1, lengths 0.1 mm, …
        let mut row = [0.0; MOST_PARAMETERS];
        for (own, info) in row.iter_mut().zip(id.info().parameters) {
            *own = match info.unit.symbol() {
                "m" if info.name == "hardening_length" => 3e-3,
                "m" => 1e-4,
                "m/s" => 1e-3,
                "N" | "N s/m" => 0.5,
                "N/m" => 5e3,
                "s" => 5e-3,
                "1/m" | "1/m^ν" => 100.0,
                "N s²/m²" => 50.0,
                "Hz" | "1/s" => 5.0,
                _ if info.name == "exponent" => 1.7,
                // A form: a bond pulls what has relaxed, and this gel does not.
                _ if info.name == "bond" => 0.0,
                _ => 0.2,
            };
        }
        let run = run(&rig([(*id, row), cable]), GEL.at(0.0), &stroke);
        let apart =
            |a: &[f64], b: &[f64], least: f64| a.iter().zip(b).any(|(a, b)| (a - b).abs() > least);
        let differs = apart(&run.log.force_n, &plain.log.force_n, 1e-3)
            || apart(&run.log.position_m, &plain.log.position_m, 1e-6);
        assert!(differs, "{}", id.name());
        assert!(
            run.log.force_n.iter().all(|force| force.abs() < 100.0),
            "{}",
            id.name()
        );
    }
}

#[test]
fn what_is_periodic_in_time_has_its_phase_by_the_clock_of_the_position() {
    // F(t − T_d) of A sin(2πft + φ), early or late.
    let hum = (EffectId::PeriodicDisturbance, [0.5, 12.0, 0.3, 0.0, 0.0]);
    for delay_s in [0.0, 4e-3, -4e-3] {
        let delay = (EffectId::TimeDelay, [delay_s, 0.0, 0.0, 0.0, 0.0]);
        let run = run(&rig([hum, delay]), Contact::FREE, &there_and_back());
        for (force, time_s) in run.log.force_n.iter().zip(&run.log.time_s).skip(10) {
            let exact = 0.5 * (TAU * 12.0 * (time_s - delay_s) + 0.3).sin();
            assert!((force - exact).abs() < 1e-12, "{delay_s}: {force} {exact}");
        }
    }
}
