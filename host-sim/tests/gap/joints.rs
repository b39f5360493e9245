//! `gap` on joints that turn, with an encoder as coarse as joints have: 14 bits of a turn. Their torques are written down here,
//! with frictions, weights and loops of their own.

use crate::common::{Folder, complained, csv, flowing, grown, said, tables};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// A joint: inertia (kg m²), drag (N m s/rad), friction (N m) over its width (rad), weight (N m), offset (N m), drag by the
/// square of the speed (N m s²/rad²), spring (N m/rad), and a loop of stiffness (N m/rad), β, γ and ν.
#[derive(Clone, Copy)]
struct Joint {
    inertia: f64,
    drag: f64,
    friction: (f64, f64),
    weight: f64,
    offset: f64,
    square: f64,
    spring: f64,
    the_loop: [f64; 4],
    /// What the readings remember (N m rms): noise of 1/f in four corners.
    slow_noise: f64,
}

const JOINT: Joint = Joint {
    inertia: 0.02,
    drag: 0.05,
    friction: (0.15, 3e-3),
    weight: 1.2,
    offset: 0.0,
    square: 0.0,
    spring: 0.0,
    the_loop: [0.0, 1.0, 0.0, 1.0],
    slow_noise: 0.0,
};

const RATE_HZ: f64 = 1000.0;
const COUNT: f64 = TAU / 16384.0;
const NOISE: f64 = 8e-3;
/// Corners of the slow noise (Hz).
const CORNERS_HZ: [f64; 4] = [0.3, 2.0, 12.0, 70.0];

impl Joint {
    /// 16 s: 0.6 s of rest, then three sines that share no period.
    fn rows(&self, seed: u64) -> Vec<[f64; 3]> {
        const FINER: usize = 10;
        let mut random = Pcg64::seed_from_u64(seed);
        let way = |t: f64| {
            let t = (t - 0.6).max(0.0);
            let grown = grown(t);
            let phase = seed as f64;
            grown
                * (0.8 * (TAU * 0.23 * t + phase).sin()
                    + 0.25 * (TAU * 0.91 * t).sin()
                    + 0.05 * (TAU * 2.7 * t).sin())
        };
        let (mut bent, mut looped, mut last) = (0.0, 0.0_f64, way(0.0));
        let mut slow = [0.0; CORNERS_HZ.len()];
        let [stiffness, beta, gamma, exponent] = self.the_loop;
        let mut row = |at: usize| {
            for step in 1..=FINER {
                let t = (at as f64 - 1.0 + step as f64 / FINER as f64) / RATE_HZ;
                let x = way(t);
                let moved: f64 = x - last;
                last = x;
                bent += moved / self.friction.1 * (1.0 - bent * moved.signum());
                bent = f64::clamp(bent, -1.0, 1.0);
                let size = f64::abs(looped);
                looped += moved
                    - beta * moved.abs() * size.powf(exponent - 1.0) * looped
                    - gamma * moved * size.powf(exponent);
            }
            let (t, h) = (at as f64 / RATE_HZ, 1e-4);
            let (x, before, after) = (way(t), way(t - h), way(t + h));
            let (v, a) = (
                (after - before) / (2.0 * h),
                (after - 2.0 * x + before) / (h * h),
            );
            for (state, hz) in slow.iter_mut().zip(CORNERS_HZ) {
                let keeps = (-TAU * hz / RATE_HZ).exp();
                let new: f64 = StandardNormal.sample(&mut random);
                *state = keeps * *state + (1.0 - keeps * keeps).sqrt() * new;
            }
            let white: f64 = StandardNormal.sample(&mut random);
            let remembered = 0.5 * self.slow_noise * slow.iter().sum::<f64>();
            let torque = self.inertia * a
                + self.drag * v
                + self.square * v * v.abs()
                + self.friction.0 * bent
                + self.weight * x.sin()
                + self.spring * x
                + self.offset
                + stiffness * looped;
            [
                t,
                (x / COUNT).round() * COUNT,
                torque + NOISE * white + remembered,
            ]
        };
        (0..16_000).map(&mut row).collect()
    }
}

/// A model of the joint with these effects.
fn model(effects: &[(&str, &str)]) -> String {
    let effects = tables(effects);
    format!("kind = \"rotary\"\n[environment]\nlaw = \"free\"\n{effects}")
}

const INERTIA: (&str, &str) = (
    "tool_inertia",
    "mass = 0.02\nstd_error = { mass = 0.00005 }",
);
const DRAG: (&str, &str) = (
    "viscous_drag",
    "coefficient = 0.05\nstd_error = { coefficient = 0.001 }",
);
const FRICTION: (&str, &str) = (
    "coulomb_friction",
    "force = 0.15\nwidth = 0.003\nstd_error = { force = 0.001, width = 0.0001 }",
);
const WEIGHT: (&str, &str) = (
    "gravity_torque",
    "amplitude = 1.2\nphase = 0\nstd_error = { amplitude = 0.002, phase = 0.001 }",
);

/// The answer to a log of a joint, what was said, and the model that was written if one was.
fn asked(model: &str, joint: &Joint, seed: u64) -> (serde_json::Value, String, Option<String>) {
    let folder = Folder::with("base.toml", model);
    let rows = csv(joint.rows(seed));
    folder.write("log.csv", rows.replacen("t_s,x_m,f_n", "t_s,x_rad,f_nm", 1));
    let done = folder.palpate("gap --model base.toml --log log.csv --out out");
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let json = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    let written = std::fs::read_to_string(folder.path("out/model.toml")).ok();
    (json, flowing(&said(&done)), written)
}

fn names(json: &serde_json::Value) -> Vec<&str> {
    let effects = json["effects"].as_array().unwrap().iter();
    effects.filter_map(|own| own["id"].as_str()).collect()
}

#[test]
fn a_zero_that_moved_is_an_offset_and_no_phase_of_the_weight() {
    // GIVEN a joint that was identified, and whose torque reads 0.1 N m more since
    let moved = Joint {
        offset: 0.1,
        ..JOINT
    };
    let known = model(&[INERTIA, DRAG, FRICTION, WEIGHT]);
    let (json, said, _) = asked(&known, &moved, 1);
    // THEN that is what is found. It was "nothing is missing, but the phase is 5250 % larger", within an error of the
    // acceleration that was twice what there is.
    assert_eq!(names(&json), ["force_offset"], "{said}");
    let found = json["effects"][0]["params"]["force"]["value"].as_f64();
    assert!((found.unwrap() - 0.1).abs() < 0.02, "{said}");
    assert!(!said.contains("gravity_torque.phase is"), "{said}");
    // AND of one whose zero stayed nothing is said.
    let (json, said, _) = asked(&known, &JOINT, 2);
    assert_eq!(json["verdict"], "no_missing_effect", "{said}");
}

#[test]
fn a_drag_that_grows_as_the_square_is_no_friction_of_stribecks() {
    let fan = Joint {
        weight: 0.0,
        square: 0.02,
        spring: 0.5,
        ..JOINT
    };
    let friction = ("coulomb_friction", "force = 0.1");
    let (json, said, _) = asked(&model(&[INERTIA, DRAG, friction]), &fan, 3);
    let mut found = names(&json);
    found.sort_unstable();
    assert_eq!(found, ["cable_stiffness", "quadratic_drag"], "{said}");
}

#[test]
fn slow_noise_of_a_machine_that_rests_in_the_middle_of_its_travel_is_noise() {
    // GIVEN readings with 5 mN m of 1/f noise, of a joint without a weight, which rests where no torque holds it
    let noisy = Joint {
        weight: 0.0,
        slow_noise: 5e-3,
        ..JOINT
    };
    for seed in [4, 5] {
        let (json, said, _) = asked(&model(&[INERTIA, DRAG, FRICTION]), &noisy, seed);
        // THEN nothing is missing: it was "something is missing that is not in the catalogue".
        assert_eq!(json["verdict"], "no_missing_effect", "{said}");
    }
}

#[test]
fn a_loop_is_named_with_its_exponent_and_the_next_log_of_it_has_not_changed() {
    // GIVEN a loop of exponent 1.5 that levels off at 0.05 rad
    let beta = 0.6 * 0.05_f64.powf(-1.5);
    let looped = Joint {
        weight: 0.0,
        friction: (0.0, 1.0),
        the_loop: [10.0, beta, beta * 2.0 / 3.0, 1.5],
        ..JOINT
    };
    let (json, said, written) = asked(&model(&[INERTIA, DRAG]), &looped, 6);
    // THEN it is found with it: a start held 1, 4.3 floors were left,
    assert_eq!(names(&json), ["bouc_wen"], "{said}");
    let exponent = json["effects"][0]["params"]["exponent"]["value"].as_f64();
    assert!((exponent.unwrap() - 1.5).abs() < 0.1, "{said}");
    // AND the same rig, asked again with the model that was written, is as it was: β had changed by 17 times.
    let (json, said, _) = asked(&written.unwrap(), &looped, 7);
    assert_eq!(json["effects"], serde_json::json!([]), "{said}");
    assert!(said.contains("changed nothing"), "{said}");
}
