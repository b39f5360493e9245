//! `estimate` on forces that went through a filter before they were logged: what the filter is, and what the contact behind
//! it. Contacts and filters are summed here, sample by sample, by nothing of this project.

use std::f64::consts::PI;

use crate::common::{Folder, estimated, flowing, parameter, presses_m, white};
use serde_json::Value;

const RATE_HZ: f64 = 1000.0;
const NOISE_N: f64 = 0.02;

/// A contact K·x + λ·v, times √(x/mm) if it is round.
#[derive(Clone, Copy)]
struct Contact {
    spring: f64,
    damper: f64,
    is_round: bool,
}

const FLAT: Contact = Contact {
    spring: 1100.0,
    damper: 9.0,
    is_round: false,
};
const ROUND: Contact = Contact {
    spring: 1400.0,
    damper: 35.0,
    is_round: true,
};

fn place_m(t: f64) -> f64 {
    presses_m(t, 4e-3, 5)
}

impl Contact {
    fn force_n(self, t: f64) -> f64 {
        let x_m = place_m(t);
        let speed = (place_m(t + 1e-6) - place_m(t - 1e-6)) / 2e-6;
        let round = match self.is_round {
            true => (x_m.max(0.0) / 1e-3).sqrt(),
            false => 1.0,
        };
        match x_m > 0.0 {
            // Hunt and Crossley's damper has the depth, too.
            true if self.is_round => {
                ((self.spring + self.damper * speed / 1e-3) * x_m * round).max(0.0)
            }
            true => (self.spring * x_m + self.damper * speed).max(0.0),
            false => 0.0,
        }
    }

    /// Its log behind a filter.
    fn log(self, filter: impl Fn(Vec<f64>) -> Vec<f64>) -> String {
        let samples = 8400_u32;
        let time_s = |at: u32| f64::from(at) / RATE_HZ;
        let raw = (0..samples).map(|at| self.force_n(time_s(at)) + NOISE_N * white(2 * at));
        let mut text = String::from("t_s,x_m,f_n\n");
        for (at, force_n) in (0..samples).zip(filter(raw.collect())) {
            let t = time_s(at);
            let x_m = place_m(t) + 3e-8 * white(2 * at + 1);
            text += &format!("{t:.3},{x_m:.7},{force_n:.6}\n");
        }
        text
    }

    fn estimated(self, filter: impl Fn(Vec<f64>) -> Vec<f64>) -> Value {
        let folder = Folder::with("log.csv", self.log(filter));
        estimated(&folder, "log.csv", "")
    }

    /// It has converged, and every parameter is known to 10 % and where it is.
    fn is_right(self, json: &Value) {
        assert_eq!(json["status"], "converged", "{json:#}");
        self.is_not_wrong(json);
        for (name, is) in self.parameters() {
            let (value, std_error) = parameter(json, name);
            assert!(
                std_error < 0.1 * is,
                "{name}: {value} ± {std_error} of {is}"
            );
        }
    }

    /// Every parameter is where it is, within 1 % or three standard errors.
    fn is_not_wrong(self, json: &Value) {
        for (name, is) in self.parameters() {
            let (value, std_error) = parameter(json, name);
            assert!(
                (value - is).abs() < (0.01 * is).max(3.0 * std_error),
                "{name}: {value} ± {std_error} of {is}"
            );
        }
    }

    fn parameters(self) -> [(&'static str, f64); 2] {
        [("stiffness", self.spring), ("damping", self.damper)]
    }
}

/// Butterworth's filter of second order as a biquad, with the bilinear transform's tangent.
fn biquad(forces: Vec<f64>, corner_hz: f64) -> Vec<f64> {
    let k = (PI * corner_hz / RATE_HZ).tan();
    let norm = 1.0 / (1.0 + 2f64.sqrt() * k + k * k);
    let (b0, a1, a2) = (
        k * k * norm,
        2.0 * (k * k - 1.0) * norm,
        (1.0 - 2f64.sqrt() * k + k * k) * norm,
    );
    let first = forces[0];
    let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
    let mut step = |x: f64| {
        let y = b0 * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        (x2, x1, y2, y1) = (x1, x, y1, y);
        y
    };
    forces.into_iter().map(&mut step).collect()
}

fn reversed(mut forces: Vec<f64>) -> Vec<f64> {
    forces.reverse();
    forces
}

fn corner(json: &Value) -> (f64, f64) {
    let own = &json["force_low_pass"]["corner"];
    let number = |name: &str| own[name].as_f64().unwrap_or_else(|| panic!("{json:#}"));
    (number("value"), number("std_error"))
}

#[test]
fn a_force_that_was_filtered_forth_and_back_is_fitted_behind_that_filter() {
    for contact in [FLAT, ROUND] {
        let json = contact.estimated(|own| reversed(biquad(reversed(biquad(own, 20.0)), 20.0)));
        contact.is_right(&json);
        let found = &json["force_low_pass"];
        assert_eq!(found["shape"], "butterworth", "{found}");
        assert_eq!(found["order"], 2, "{found}");
        assert_eq!(found["both_ways"], true, "{found}");
        let (corner_hz, _) = corner(&json);
        assert!((corner_hz - 20.0).abs() < 0.6, "{corner_hz}");
        let notes = flowing(&json["notes"].to_string());
        assert!(notes.contains("behind the low-pass"), "{notes}");
    }
}

#[test]
fn a_filter_with_a_delay_takes_nothing_off_the_damping() {
    let json = ROUND.estimated(|own| biquad(own, 30.0));
    ROUND.is_right(&json);
    let found = &json["force_low_pass"];
    assert_eq!(found["both_ways"], false, "{found}");
    // √2/ω late: K times that is more than the damper.
    let late_s = found["delay_s"].as_f64().unwrap();
    assert!((late_s - 7.5e-3).abs() < 4e-4, "{late_s}");
}

#[test]
fn a_moving_mean_is_none_of_the_filters_that_are_tried_and_nothing_is_wrong_behind_it() {
    let mean = |own: Vec<f64>| -> Vec<f64> {
        let first = own[0];
        let before = |at: usize, back: usize| at.checked_sub(back).map_or(first, |at| own[at]);
        (0..own.len())
            .map(|at| (0..20).map(|back| before(at, back)).sum::<f64>() / 20.0)
            .collect()
    };
    for contact in [FLAT, ROUND] {
        let json = contact.estimated(mean);
        if json["status"] == "converged" {
            contact.is_not_wrong(&json);
        }
    }
}

#[test]
fn a_force_that_went_through_nothing_is_fitted_behind_nothing() {
    let json = FLAT.estimated(|own| own);
    FLAT.is_right(&json);
    assert!(json["force_low_pass"].is_null(), "{json:#}");
}
