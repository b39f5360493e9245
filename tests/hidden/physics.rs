//! The generator's rig against closed forms.

use tests::hidden::rig::effect::{Effect, Friction};
use tests::hidden::rig::material::{Law, Material};
use tests::hidden::rig::motion::{Profile, Track};
use tests::hidden::rig::plant::Plant;
use tests::hidden::rig::random::Random;

/// The sub-step of these runs (s), which is the generator's.
const DT_S: f64 = 5e-5;
const K: f64 = 2000.0;
const LAMBDA: f64 = 20.0;

fn linear(hidden: Vec<Effect>) -> Plant {
    let material = Material::from_numbers(Law::KelvinVoigt, &[K, LAMBDA, 0.0]);
    let mut plant = Plant::bare(material);
    plant.hidden = hidden;
    plant
}

/// The force along a position x(t), given with its two derivatives.
fn forces(plant: &Plant, seconds: f64, x: impl Fn(f64) -> [f64; 3]) -> Vec<f64> {
    let motion: Vec<[f64; 3]> = (0..(seconds / DT_S) as usize)
        .map(|k| x(k as f64 * DT_S))
        .collect();
    let column = |index: usize| -> Vec<f64> { motion.iter().map(|m| m[index]).collect() };
    plant.force(&column(0), &column(1), &column(2), DT_S)
}

/// The force on a tip that is out of contact for 10 ms, then held at `depth`.
fn held(plant: &Plant, depth: f64, seconds: f64) -> Vec<f64> {
    forces(plant, seconds, |t| {
        [if t < 0.01 { -1e-3 } else { depth }, 0.0, 0.0]
    })
}

/// A sine of 5 mm at 1 Hz, 20 mm off the surface.
fn free_sine(t: f64) -> [f64; 3] {
    let w = std::f64::consts::TAU;
    let (sin, cos) = (w * t).sin_cos();
    [-20e-3 + 5e-3 * sin, 5e-3 * w * cos, -5e-3 * w * w * sin]
}

fn close(value: f64, expected: f64, relative: f64) {
    assert!(
        (value / expected - 1.0).abs() < relative,
        "{value} is not {expected}"
    );
}

#[test]
fn the_motor_moves_as_its_speed_and_acceleration_say() {
    let track = Track::draw(Profile::Mixed, 0.0, 4e-3, &mut Random::new(1, 1));
    for k in 1..track.x.len() - 1 {
        let v = (track.x[k + 1] - track.x[k - 1]) / (2.0 * DT_S);
        let a = (track.v[k + 1] - track.v[k - 1]) / (2.0 * DT_S);
        // Jerk and its rate times a sub-step: 10⁴ m/s³ times 5·10⁻⁵ s is 0.5 m/s² at a corner of the set point.
        assert!((v - track.v[k]).abs() < 1e-5, "{k}: {v} for {}", track.v[k]);
        assert!((a - track.a[k]).abs() < 0.1, "{k}: {a} for {}", track.a[k]);
    }
}

#[test]
fn a_hold_relaxes_at_its_rate() {
    let plant = linear(vec![Effect::Modes(vec![(0.3, 2.0)])]);
    let force = held(&plant, 1e-3, 1.0);
    for t in [0.1_f64, 0.4, 0.9] {
        let expected = K * 1e-3 * (1.0 - 0.3 * (1.0 - (-2.0 * t).exp()));
        // The step is a ramp of one sub-step, 5·10⁻⁵ s: 10⁻⁴ of the rate.
        close(force[((t + 0.01) / DT_S).round() as usize], expected, 1e-4);
    }
}

#[test]
fn a_dent_fills_at_the_retardation_time() {
    let (series, parallel, damper) = (2000.0, 3000.0, 2500.0);
    let material = Material::from_numbers(Law::Zener, &[series, parallel, damper, 0.0]);
    // Held at 2 mm for ten relaxation times, left for 0.4 s, and met again at 10 mm/s.
    let x = |t: f64| {
        let at = match t {
            t if t < 0.01 => [-1e-3, 0.0],
            t if t < 5.0 => [2e-3, 0.0],
            t if t < 5.4 => [-1e-3, 0.0],
            t => [1e-2 * (t - 5.4), 1e-2],
        };
        [at[0], at[1], 0.0]
    };
    let met = |creeps: bool| {
        let mut plant = Plant::bare(material);
        plant.creeps = creeps;
        let force = forces(&plant, 5.6, x);
        let from = (5.4 / DT_S) as usize + 1;
        let at = force[from..].iter().position(|f| *f > 0.0).unwrap();
        (from + at) as f64 * DT_S
    };
    let t = met(true);
    let dent_m = 2e-3 * series / (series + parallel) * (-(t - 5.0) * parallel / damper).exp();
    // A sub-step more, 0.5 µm, and what the way out takes: 5·10⁻⁵ s of 0.8 s.
    let depth_m = x(t)[0];
    assert!((depth_m - dent_m).abs() < 2e-6, "{depth_m} of {dent_m}");
    // A surface that follows the probe recovers at the rate of the relaxation, which is faster.
    assert!(met(false) < t - 0.005, "{} {t}", met(false));
}

#[test]
fn a_spring_in_series_lets_the_contact_creep() {
    let spring = 3000.0;
    let plant = linear(vec![Effect::Compliance {
        stiffness: spring,
        progressive: 0.0,
        scale: 1.0,
    }]);
    let force = held(&plant, 1e-3, 0.2);
    let (rate, end) = ((K + spring) / LAMBDA, 1e-3 * K * spring / (K + spring));
    for t in [0.002_f64, 0.005, 0.1] {
        let expected = end + (spring * 1e-3 - end) * (-rate * t).exp();
        // Where the tip meets the surface is known to a sub-step: rate·dt is 1 % of what creeps.
        close(force[((t + 0.01) / DT_S).round() as usize], expected, 0.01);
    }
}

#[test]
fn friction_takes_its_energy_from_every_cycle() {
    let friction = Effect::Friction(Friction::coulomb(0.4));
    let force = forces(&linear(vec![friction]), 1.0, free_sine);
    let work: f64 = force
        .iter()
        .enumerate()
        .map(|(k, f)| f * free_sine(k as f64 * DT_S)[1] * DT_S)
        .sum();
    close(work, 4.0 * 5e-3 * 0.4, 1e-3);
}

#[test]
fn in_free_air_there_is_nothing_but_offset_mass_and_drag() {
    assert!(
        forces(&linear(vec![]), 1.0, free_sine)
            .iter()
            .all(|f| *f == 0.0)
    );
    let hidden = vec![
        Effect::Offset {
            force: 0.2,
            settling: 0.0,
            time: 1.0,
        },
        Effect::Inertia {
            mass: 0.3,
            loose: 0.0,
            hz: 1.0,
            damping: 0.0,
        },
        Effect::Drag {
            linear: 5.0,
            quadratic: 0.0,
        },
    ];
    let force = forces(&linear(hidden), 1.0, free_sine);
    for (k, force) in force.iter().enumerate() {
        let [_, v, a] = free_sine(k as f64 * DT_S);
        assert!((force - (0.2 + 0.3 * a + 5.0 * v)).abs() < 1e-12);
    }
}

#[test]
fn a_lag_damps_and_delays_as_a_low_pass_does() {
    let (time, hz) = (8e-3, 20.0);
    let wave = Effect::Disturbance {
        amplitude: 1.0,
        hz,
        phase: 0.0,
        second: 0.0,
        breathing: 0.0,
    };
    let force = forces(
        &linear(vec![wave, Effect::Lag { time, order: 1 }]),
        1.0,
        free_sine,
    );
    let w = std::f64::consts::TAU * hz;
    for (k, force) in force.iter().enumerate().skip(10_000) {
        let angle = w * k as f64 * DT_S - (w * time).atan();
        let expected = angle.sin() / (1.0 + (w * time).powi(2)).sqrt();
        // A linear hold in the place of a sine: (ω·dt)²/12.
        assert!((force - expected).abs() < 1e-5, "{force} for {expected}");
    }
}

#[test]
fn after_a_reversal_a_play_moves_the_tip_only_when_it_is_used_up() {
    let plays = vec![(0.2e-3, 1.0)];
    let plant = linear(vec![Effect::Backlash { plays }]);
    // In at 10 mm/s to 2 mm, and out again at the same speed.
    let x = |t: f64| {
        if t < 0.3 {
            [-1e-3 + 10e-3 * t, 10e-3, 0.0]
        } else {
            [5e-3 - 10e-3 * t, -10e-3, 0.0]
        }
    };
    let force = forces(&plant, 0.5, x);
    let at = |t: f64| force[(t / DT_S).round() as usize];
    // In: depth x − w/2. Then 20 ms of rest at the deepest point, without damping. Out: depth x + w/2.
    close(at(0.2), K * 0.9e-3 + LAMBDA * 10e-3, 1e-9);
    close(at(0.31), K * 1.9e-3, 1e-4);
    close(at(0.4), K * 1.1e-3 - LAMBDA * 10e-3, 1e-9);
}

#[test]
fn a_bonded_tip_pulls_until_its_neck_tears() {
    let adhesion = Effect::Adhesion {
        force: 0.3,
        neck: 0.5e-3,
        loading: 1.0,
        shape: 1.0,
    };
    let plant = linear(vec![adhesion]);
    let x = |t: f64| {
        if t < 0.2 {
            [-1e-3 + 10e-3 * t, 10e-3, 0.0]
        } else {
            [3e-3 - 10e-3 * t, -10e-3, 0.0]
        }
    };
    let force = forces(&plant, 0.5, x);
    let at = |t: f64| force[(t / DT_S).round() as usize];
    assert_eq!(at(0.05), 0.0, "before the touch");
    close(at(0.32), -0.3 * (1.0 - 0.2e-3 / 0.5e-3), 1e-6);
    assert_eq!(at(0.36), 0.0, "torn");
}

#[test]
fn the_loop_of_a_rate_independent_contact_does_not_know_the_rate() {
    let elements = vec![(0.5, 0.2e-3)];
    let area = |hz: f64| {
        let plant = linear(vec![Effect::Hysteresis {
            elements: elements.clone(),
            jenkins: false,
        }]);
        let bare = linear(vec![]);
        let x = move |t: f64| {
            let w = std::f64::consts::TAU * hz;
            let (sin, cos) = (w * t).sin_cos();
            [2e-3 + 1e-3 * sin, 1e-3 * w * cos, 0.0]
        };
        let work = |plant: &Plant| -> f64 {
            let force = forces(plant, 2.0 / hz, x);
            let second = force.len() / 2;
            let work = |(k, f): (usize, &f64)| f * x((second + k) as f64 * DT_S)[1] * DT_S;
            force[second..].iter().enumerate().map(work).sum()
        };
        work(&plant) - work(&bare)
    };
    let (slow, fast) = (area(0.5), area(5.0));
    close(fast, slow, 2e-3);
    // z = 1 − 2e^{−s/d} after a reversal: the rectangle 4·A·F_h less d at each end.
    close(slow, 4.0 * 0.5 * (1e-3 - 0.2e-3), 1e-3);
}

#[test]
fn elements_that_slip_take_their_energy_from_every_cycle() {
    let elements = vec![(0.1, 0.2e-3), (0.3, 1e-3)];
    let lost = |(force, slips): &(f64, f64)| 4.0 * force * (5e-3 - slips);
    let expected: f64 = elements.iter().map(lost).sum();
    let force = forces(&linear(vec![Effect::Iwan { elements }]), 2.0, free_sine);
    // The first cycle starts in the middle.
    let work = |k: usize| force[k] * free_sine(k as f64 * DT_S)[1] * DT_S;
    close(
        (force.len() / 2..force.len()).map(work).sum(),
        expected,
        2e-3,
    );
}

#[test]
fn a_load_cell_that_resonates_is_late_by_its_damping() {
    let (hz, damping, rate) = (40.0, 0.5, 3.0);
    let ramp = Effect::Drift {
        rate,
        time: 0.0,
        bend: 0.0,
        scale: 1.0,
    };
    let hidden = vec![ramp, Effect::Resonance { hz, damping }];
    let force = forces(&linear(hidden), 1.0, free_sine);
    let late_s = 0.9 - force[(0.9 / DT_S).round() as usize] / rate;
    // 2ζ/ω for a ramp, to a sub-step.
    close(late_s, 2.0 * damping / (std::f64::consts::TAU * hz), 0.02);
}

#[test]
fn an_attraction_pulls_before_the_touch_as_after_it() {
    let attraction = Effect::Attraction {
        force: 0.3,
        range: 0.2e-3,
    };
    let at = |x: f64| forces(&linear(vec![attraction.clone()]), 0.01, |_| [x, 0.0, 0.0])[100];
    close(at(-0.2e-3), -0.3 / 4.0, 1e-9);
    close(at(1e-3), K * 1e-3 - 0.3, 1e-9);
}
