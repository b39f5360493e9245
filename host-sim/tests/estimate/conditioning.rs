//! `estimate` on forces that are more than the contact: of an amplifier that settles, a zero that wanders, a low-pass before
//! the log, and of a position whose counts are newtons. The contacts are summed here, by nothing of this project.

use crate::common::{Folder, estimated, flowing, parameter, presses_m, white};
use serde_json::Value;

/// A spring and a damper, how deep they are pressed, and what is read.
struct Seen {
    /// N/m and N s/m.
    spring: f64,
    damper: f64,
    depth_m: f64,
    count_m: f64,
    noise_n: f64,
    presses: u32,
    /// What is added to the force (N) at a time (s).
    more_n: fn(f64) -> f64,
    /// Runs of this many samples that the force is averaged over twice, around each sample.
    averaged: usize,
}

const SEEN: Seen = Seen {
    spring: 1000.0,
    damper: 10.0,
    depth_m: 4e-3,
    count_m: 1e-7,
    noise_n: 5e-3,
    presses: 5,
    more_n: |_| 0.0,
    averaged: 1,
};

impl Seen {
    /// Presses of 1.45 s each at 1 kHz, of three depths, after 0.6 s of rest and before as much again.
    fn log(&self) -> String {
        let place_m = |t: f64| presses_m(t, self.depth_m, self.presses);
        let end = 1200 + 1450 * self.presses;
        let force = |at: u32| {
            let t = 1e-3 * f64::from(at);
            let x_m = place_m(t);
            let speed = (place_m(t + 1e-6) - place_m(t - 1e-6)) / 2e-6;
            let force_n = match x_m > 0.0 {
                true => (self.spring * x_m + self.damper * speed).max(0.0),
                false => 0.0,
            };
            force_n + (self.more_n)(t) + self.noise_n * white(2 * at)
        };
        let mut forces: Vec<f64> = (0..end).map(force).collect();
        for _ in 0..2 {
            forces = mean(&forces, self.averaged);
        }
        let mut text = String::from("t_s,x_m,f_n\n");
        for (at, force_n) in (0_u32..).zip(forces) {
            let t = 1e-3 * f64::from(at);
            let x_m = place_m(t) + 3e-8 * white(2 * at + 1);
            let x_m = (x_m / self.count_m).round() * self.count_m;
            text += &format!("{t:.3},{x_m:.9},{force_n:.6}\n");
        }
        text
    }

    fn estimated(&self, options: &str) -> Value {
        estimated(&Folder::with("log.csv", self.log()), "log.csv", options)
    }

    /// It has converged, and the parameters are within 5 % or three standard errors of what they are.
    fn is_right(&self, json: &Value) {
        assert_eq!(json["status"], "converged", "{json:#}");
        for (name, is) in [("stiffness", self.spring), ("damping", self.damper)] {
            let (value, std_error) = parameter(json, name);
            let off = (value - is).abs();
            assert!(
                off < (0.05 * is).max(3.0 * std_error),
                "{name}: {value} ± {std_error}"
            );
            assert!(off < 0.1 * is, "{name}: {value} ± {std_error}");
        }
    }
}

/// Means over so many samples around each.
fn mean(channel: &[f64], samples: usize) -> Vec<f64> {
    let around = |at: usize| {
        let from = at.saturating_sub(samples / 2);
        let own = &channel[from..(at + samples / 2 + 1).min(channel.len())];
        own.iter().sum::<f64>() / own.len() as f64
    };
    (0..channel.len()).map(around).collect()
}

fn notes(json: &Value) -> String {
    flowing(&json["notes"].to_string())
}

const METHODS: [&str; 3] = [
    "",
    "--method batch",
    "--law kelvin_voigt --method rls_surface",
];

#[test]
fn a_force_that_settles_when_the_log_begins_is_left_out() {
    let seen = Seen {
        more_n: |t| 1.0 - 1.8 * (-t / 0.06).exp(),
        ..SEEN
    };
    for options in METHODS {
        let json = seen.estimated(options);
        assert!(notes(&json).contains("the force settles by"), "{json:#}");
        assert_eq!(
            json["touches"].as_array().map(Vec::len),
            Some(5),
            "{json:#}"
        );
        seen.is_right(&json);
    }
}

#[test]
fn a_zero_that_drifts_or_warms_up_is_taken_off_whatever_the_method() {
    let drifts: [fn(f64) -> f64; 3] = [
        |t| 0.04 * t,
        |t| -0.02 * t,
        |t| 0.3 * (1.0 - (-t / 3.0).exp()),
    ];
    for more_n in drifts {
        for options in METHODS {
            let seen = Seen { more_n, ..SEEN };
            let json = seen.estimated(options);
            assert!(
                notes(&json).contains("the resting force drifts by"),
                "{json:#}"
            );
            seen.is_right(&json);
        }
    }
    // And of a zero that stays nothing is said.
    let said = notes(&SEEN.estimated(""));
    assert!(
        !said.contains("drifts") && !said.contains("settles"),
        "{said}"
    );
}

#[test]
fn counts_of_the_position_that_are_newtons_may_remain() {
    let stiff = Seen {
        spring: 1e6,
        damper: 2e3,
        depth_m: 1.5e-4,
        count_m: 1e-6,
        noise_n: 0.05,
        ..SEEN
    };
    for options in ["", "--method batch"] {
        let json = stiff.estimated(options);
        stiff.is_right(&json);
    }
}

#[test]
fn a_force_behind_a_low_pass_says_where_its_noise_ends() {
    // Twice the mean of 11 ms: half of the power at 29 Hz, without delay.
    let smooth = Seen {
        averaged: 11,
        ..SEEN
    };
    let json = smooth.estimated("");
    assert!(
        notes(&json).contains("the noise of the force ends at"),
        "{json:#}"
    );
    let noise_n = json["force_noise_n"].as_f64().unwrap();
    // 5 mN through 2/(3·11) of the band.
    assert!((0.8e-3..2e-3).contains(&noise_n), "{noise_n}");
    assert!(!notes(&SEEN.estimated("")).contains("ends at"));
}

#[test]
fn one_touch_that_tells_every_parameter_is_enough_for_a_fit_of_the_whole_log() {
    let one = Seen { presses: 1, ..SEEN };
    one.is_right(&one.estimated(""));
}
