//! `estimate` on logs in which the material changes. The contacts are summed here, by nothing of this project.

use crate::common::{Folder, estimated, parameter, pressed, white};

/// Presses at 1 kHz into springs, each with a damper of 6 N s/m beside it; 5 mN of noise.
fn presses(stiffnesses: &[f64]) -> String {
    // Every other one deeper and faster, and its hold longer.
    let depth_m = |t: f64| {
        let (at, more) = (
            (t - 0.6).max(0.0).rem_euclid(1.0),
            (t - 0.6).max(0.0) as u32 % 2,
        );
        let (way_m, hold_s) = (4e-3 + 1e-3 * f64::from(more), 0.15 + 0.2 * f64::from(more));
        -2e-3 + way_m * pressed(at, 0.2, hold_s)
    };
    let mut text = String::from("t_s,x_m,f_n\n");
    for at in 0..600 + 1000 * stiffnesses.len() as u32 {
        let t = 1e-3 * f64::from(at);
        let stiffness = stiffnesses[(t - 0.6).max(0.0) as usize];
        let x_m = depth_m(t);
        let speed = (depth_m(t + 1e-6) - depth_m(t - 1e-6)) / 2e-6;
        let force_n = match x_m > 0.0 {
            true => (stiffness * x_m + 6.0 * speed).max(0.0),
            false => 0.0,
        };
        let (force_n, x_m) = (
            force_n + 5e-3 * white(2 * at),
            x_m + 1e-7 * white(2 * at + 1),
        );
        text += &format!("{t:.3},{x_m:.8},{force_n:.5}\n");
    }
    text
}

#[test]
fn materials_that_were_touched_twice_each_are_told_apart() {
    let folder = Folder::with(
        "log.csv",
        presses(&[1000.0, 1000.0, 3000.0, 3000.0, 1000.0, 1000.0]),
    );
    let json = estimated(&folder, "log.csv", "");
    // One law for all of it, "model_suspect", 1700 ± 600 N/m. Two touches are few: it may be converging.
    assert_ne!(json["status"], "model_suspect", "{json:#}");
    let (stiffness, _) = parameter(&json, "stiffness");
    assert!((stiffness - 1000.0).abs() < 5.0, "{json:#}");
    let segments = json["segments"].as_array().expect("segments");
    let each = segments
        .iter()
        .map(|own| own["parameters"]["stiffness"]["value"].as_f64());
    let each: Vec<f64> = each.flatten().collect();
    assert!(
        each.len() == 3 && (each[1] - 3000.0).abs() < 15.0,
        "{json:#}"
    );
}
