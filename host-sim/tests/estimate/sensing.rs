//! `estimate` and `gap` on springs, dampers and gels as sensors show them: late, in coarse counts, drifting, sampled
//! seldom for how fast they are tapped. The contacts are summed here, by nothing of this project.

use std::f64::consts::TAU;

use crate::common::{Folder, estimated, named, number, parameter, white};
use serde_json::Value;

const SURFACE_M: f64 = 0.5e-3;

/// A contact, and how it is seen.
struct Seen {
    rate_hz: f64,
    /// Force (N) of a depth (m) and a speed (m/s).
    law: fn(f64, f64) -> f64,
    /// Position (m) at a time (s).
    way: fn(f64) -> f64,
    /// The force is that of so long ago (s).
    late_s: f64,
    /// One count of the encoder (m), which rounds down.
    count_m: f64,
    position_noise_m: f64,
    /// Amplitude and pitch (m) of what the encoder reads too much.
    eccentric_m: (f64, f64),
    /// N/s.
    drift: f64,
    /// What opposes the motion (N), in contact and in free air.
    friction: f64,
    seed: u32,
}

/// Presses of a spring of 1 N/mm and a damper of 10 N s/m at 1 kHz, in counts of 1 µm.
const PRESSES: Seen = Seen {
    rate_hz: 1000.0,
    law: spring_and_damper,
    way: trapezoids,
    late_s: 0.0,
    count_m: 1e-6,
    position_noise_m: 0.0,
    eccentric_m: (0.0, 1.0),
    drift: 0.0,
    friction: 0.0,
    seed: 0,
};

/// The same contact under triangles.
const STROKES: Seen = Seen {
    way: triangles,
    ..PRESSES
};

impl Seen {
    /// The log, with noise of 20 mN.
    fn log(&self) -> String {
        let row = |at: u32| {
            let t = f64::from(at) / self.rate_hz;
            let then = t - self.late_s;
            let speed = ((self.way)(then + 1e-5) - (self.way)(then - 1e-5)) / 2e-5;
            let depth = (self.way)(then) - SURFACE_M;
            let force = if depth > 0.0 {
                (self.law)(depth, speed)
            } else {
                0.0
            };
            let seed = 100_000 * self.seed + 2 * at;
            let is_m = (self.way)(t);
            let (amplitude_m, pitch_m) = self.eccentric_m;
            let x = is_m
                + amplitude_m * (TAU * is_m / pitch_m).sin()
                + self.position_noise_m * white(seed);
            format!(
                "{t:.6},{:.8},{:.4}\n",
                (x / self.count_m).floor() * self.count_m,
                force + self.friction * speed.signum() + self.drift * t + 0.02 * white(seed + 1)
            )
        };
        let rows: String = (0..(9.0 * self.rate_hz) as u32).map(row).collect();
        format!("t_s,x_m,f_n\n{rows}")
    }

    /// What is estimated.
    fn estimated(&self, options: &str) -> Value {
        let folder = Folder::with("log.csv", self.log());
        estimated(&folder, "log.csv", options)
    }
}

fn spring_and_damper(depth_m: f64, speed_mps: f64) -> f64 {
    (1000.0 * depth_m + 10.0 * speed_mps).max(0.0)
}

/// Hunt and Crossley's, K 1350 N/m, λ 36 N s/m, n 1.35.
fn gel(depth_m: f64, speed_mps: f64) -> f64 {
    (1.35 + 36.0 * speed_mps).max(0.0) * (depth_m / 1e-3).powf(1.35)
}

/// Four presses of 2 mm with rounded corners.
fn trapezoids(t: f64) -> f64 {
    let turn = (t - 0.8).rem_euclid(2.0);
    if t < 0.8 {
        return -1e-3;
    }
    let rounded = |share: f64| share * share * (3.0 - 2.0 * share);
    let share = match turn {
        turn if turn < 0.5 => rounded(turn / 0.5),
        turn if turn < 0.9 => 1.0,
        turn if turn < 1.4 => 1.0 - rounded((turn - 0.9) / 0.5),
        _ => 0.0,
    };
    -1e-3 + 3.5e-3 * share
}

/// Triangles of 5 mm in 1.003 s, whose corners are on no sample.
fn triangles(t: f64) -> f64 {
    let turn = ((t - 0.5).max(0.0) / 1.003).rem_euclid(1.0);
    -1e-3 + 6.5e-3 * (1.0 - (2.0 * turn - 1.0).abs())
}

/// One press of 2 mm and back, at 0.5 mm/s.
fn a_slow_press(t: f64) -> f64 {
    (2.5e-3 - 0.5e-3 * (t - 5.0).abs()).max(0.0)
}

/// Strokes that begin in contact, 0.1 to 2.9 mm.
fn strokes_from_inside(t: f64) -> f64 {
    1.5e-3 + 1.4e-3 * (TAU * 0.7 * t).sin() + 0.4e-3 * (TAU * 0.11 * t).sin()
}

/// Taps of 2.5 mm, 9.87 a second.
fn quick_taps(t: f64) -> f64 {
    taps(t, 9.87)
}

/// The same, 3.31 a second.
fn taps_of_0_3_s(t: f64) -> f64 {
    taps(t, 3.31)
}

fn taps(t: f64, per_second: f64) -> f64 {
    1.5e-3 - 1.5e-3 * (TAU * per_second * (t - 1.0).max(0.0)).cos()
}

/// Whether a parameter is what it is, within a share of it.
fn is_near(json: &Value, name: &str, is: f64, share: f64) {
    let (value, _) = parameter(json, name);
    assert!((value / is - 1.0).abs() < share, "{name} {value}: {json}");
}

#[test]
fn noise_of_the_position_is_no_relaxation() {
    // GIVEN a position that is known to 15 µm: 15 mN of a force with noise of 20 mN
    let seen = Seen {
        position_noise_m: 15e-6,
        count_m: 1e-7,
        ..PRESSES
    };
    let json = seen.estimated("");
    // THEN a law with a memory, which fits some of that noise, is not taken for the nearer one: it had K 1660 ± 90 N/m.
    assert_eq!(json["law"], "kelvin_voigt", "{json}");
    is_near(&json, "stiffness", 1000.0, 0.01);
    is_near(&json, "damping", 10.0, 0.1);
    // AND what a skew would do to its damping is said.
    let notes = json["notes"].to_string();
    assert!(notes.contains("read at the same instant"), "{notes}");
}

#[test]
fn a_damper_whose_force_is_late_is_no_relaxation() {
    for seed in [1, 2, 3] {
        // GIVEN triangles whose force is read 5 ms late: a relaxation of 11 ms leaves little more than the noise
        let late = Seen {
            late_s: 5e-3,
            seed,
            ..STROKES
        };
        let json = late.estimated("");
        // THEN it is Kelvin and Voigt's law, AND its damping is right within its errors or not converged.
        assert_eq!(json["law"], "kelvin_voigt", "{json}");
        is_near(&json, "stiffness", 1000.0, 0.01);
        let (damping, error) = parameter(&json, "damping");
        let is_right = (damping - 10.0).abs() < 3.0 * error;
        assert!(is_right || json["status"] != "converged", "{json}");
        // AND the fit of the whole log takes the lateness off.
        let json = late.estimated("--law kelvin_voigt --method batch");
        let (damping, error) = parameter(&json, "damping");
        assert!((damping - 10.0).abs() < 3.0 * error, "{damping} ± {error}");
        let late_s = number(&json, "/skew_s/value");
        assert!((late_s - 5e-3).abs() < 1e-3, "{late_s}");
    }
}

#[test]
fn counts_of_an_encoder_are_no_lateness() {
    for seed in [4, 5, 6] {
        // GIVEN 20 µm a count, and a force that is read at the instant of the position
        let coarse = Seen {
            count_m: 20e-6,
            seed,
            ..STROKES
        };
        let json = coarse.estimated("");
        // THEN nothing is late: it came 10.7 ± 1.7 ms late.
        assert_eq!(json["status"], "converged", "{json}");
        is_near(&json, "damping", 10.0, 0.05);
    }
}

#[test]
fn a_press_that_is_slow_for_its_counts_does_not_know_the_damping() {
    // GIVEN counts of 20 µm at 0.5 mm/s: a force of 20 mN beside the 5 mN of the damping
    let slow = Seen {
        way: a_slow_press,
        count_m: 20e-6,
        ..PRESSES
    };
    let json = slow.estimated("--law kelvin_voigt");
    let (damping, error) = parameter(&json, "damping");
    assert!(json["status"] != "converged", "{json}");
    assert!(error > 0.1 * damping.abs(), "{damping} ± {error}");
    is_near(&json, "stiffness", 1000.0, 0.01);
}

/// Presses whose position is new once in 5 ms, at 1 kHz.
fn held(t: f64) -> f64 {
    trapezoids((t * 200.0 + 1e-6).floor() / 200.0)
}

#[test]
fn a_position_that_is_refreshed_slowly_bends_the_damping_and_that_is_no_estimate() {
    // GIVEN a position at 200 Hz in a log of 1 kHz: on average 2 ms late
    let truth = PRESSES.log();
    let seen = Seen {
        way: held,
        ..PRESSES
    }
    .log();
    let force = truth.lines().map(|row| row.rsplit(',').next().unwrap());
    let rows = seen.lines().zip(force);
    let rows = rows.map(|(row, force)| format!("{},{force}\n", row.rsplit_once(',').unwrap().0));
    let folder = Folder::with("log.csv", rows.collect::<String>());
    let json = estimated(&folder, "log.csv", "");
    // THEN the damping is 12 N s/m for 10, AND not converged.
    let (damping, _) = parameter(&json, "damping");
    assert!((11.5..12.5).contains(&damping), "{json}");
    assert_eq!(json["status"], "model_suspect");
    assert_eq!(json["status_reason"], "skew");
    let notes = json["notes"].to_string();
    assert!(notes.contains("is new once in 5 samples"), "{notes}");
}

#[test]
fn a_log_that_begins_in_contact_lets_go_and_does_not_pull() {
    let inside = Seen {
        way: strokes_from_inside,
        ..PRESSES
    };
    let json = inside.estimated("");
    let notes = json["notes"].to_string();
    assert!(!notes.contains("below rest"), "{notes}");
    is_near(&json, "stiffness", 1000.0, 0.01);
}

#[test]
fn a_resting_force_that_drifts_bends_the_damping_and_that_is_said() {
    let drifting = |drift: f64| {
        let seen = Seen { drift, ..STROKES };
        seen.estimated("")
    };
    let is_said = |json: &Value| {
        let notes = json["notes"].to_string();
        notes.contains("the resting force drifts by")
    };
    // GIVEN 40 mN/s: 0.36 N over the log, and 6 % of the damping
    let json = drifting(0.04);
    // THEN it is said, AND taken off: it was 9.4 N s/m, suspect.
    assert!(is_said(&json), "{json}");
    assert_eq!(json["status"], "converged", "{json}");
    is_near(&json, "damping", 10.0, 0.03);
    // AND 2 mN/s are not: they take 0.5 % off it.
    let json = drifting(2e-3);
    assert!(!is_said(&json), "{json}");
    is_near(&json, "damping", 10.0, 0.03);
}

#[test]
fn a_friction_that_free_air_shows_bends_the_damping_and_that_is_said() {
    let rubs = Seen {
        friction: 0.02,
        ..STROKES
    };
    let json = rubs.estimated("");
    // It was 11.4 ± 0.1 N s/m for 10, `converged`.
    assert_eq!(json["status"], "model_suspect", "{json}");
    assert!(
        json["notes"].to_string().contains("opposes the motion"),
        "{json}"
    );
    // AND without one nothing is said of it.
    let json = STROKES.estimated("");
    assert_eq!(json["status"], "converged", "{json}");
    assert!(!json["notes"].to_string().contains("opposes"), "{json}");
}

#[test]
fn a_damping_that_is_negative_is_no_materials() {
    let late = Seen {
        late_s: 0.02,
        ..PRESSES
    };
    let json = late.estimated("--law kelvin_voigt --method rls_surface");
    assert_eq!(json["status"], "model_suspect", "{json}");
    assert!(
        json["notes"]
            .to_string()
            .contains("the damping is negative"),
        "{json}"
    );
}

#[test]
fn taps_that_are_fast_for_their_sampling_are_right_or_not_trusted() {
    for (rate_hz, way) in [
        (1000.0, quick_taps as fn(f64) -> f64),
        (100.0, taps_of_0_3_s),
    ] {
        for seed in [7, 8, 9] {
            let taps = Seen {
                rate_hz,
                law: gel,
                way,
                seed,
                ..PRESSES
            };
            // THEN they had K 10 and 15 % off, and were converged: the motion counted as noise of the position, and a
            // mean over the instant at which the force ends as a force.
            let json = taps.estimated("--law hunt_crossley --method batch");
            for (name, is) in [("stiffness", 1350.0), ("damping", 36.0), ("exponent", 1.35)] {
                let (value, error) = parameter(&json, name);
                let off = (value - is).abs();
                assert!(
                    off < 0.01 * is || off < 3.0 * error && error < 0.05 * is,
                    "{name} {value} ± {error}: {json}"
                );
            }
        }
    }
}

#[test]
fn an_encoders_error_of_two_cycles_in_contact_is_named_alone() {
    // GIVEN a gel pressed by 5 mm, and an encoder whose error of 40 µm repeats every 2.2 mm of them
    let seen = Seen {
        law: gel,
        eccentric_m: (40e-6, 2.2e-3),
        ..STROKES
    };
    let folder = Folder::with("log.csv", seen.log());
    folder.write(
        "model.toml",
        "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 1500.0\ndamping = 30.0\nexponent = 1.3\n",
    );
    folder.succeeds("gap --model model.toml --log log.csv --out out");
    let json: Value = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    // THEN it stands alone: sought up to 2 mm only it came with a snap, a layer or a delay.
    assert_eq!(
        named(&json),
        ["encoder_periodic_error"],
        "{}",
        json["effects"]
    );
    let of = |name: &str| number(&json, &format!("/effects/0/params/{name}/value"));
    assert!((of("amplitude") / 40e-6 - 1.0).abs() < 0.05, "{json}");
    assert!((of("pitch") / 2.2e-3 - 1.0).abs() < 0.02, "{json}");
    assert_eq!(json["verdict"], "missing_effects");
    // AND the model says with which noise it was identified, for a log of later.
    let model = folder.read("out/model.toml");
    let noise = model.split("noise = ").nth(1).unwrap();
    let noise: f64 = noise.lines().next().unwrap().parse().unwrap();
    // It is known to a quarter.
    assert!((0.015..0.025).contains(&noise), "{model}");
}

#[test]
fn a_noise_that_has_grown_is_said_though_the_model_explained_its_log() {
    let folder = Folder::with("log.csv", PRESSES.log());
    // GIVEN a model that was identified to its noise, of 5 mN
    folder.write(
        "model.toml",
        "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 10.0\n\
         std_error = { stiffness = 1.0, damping = 0.1 }\n\
         [remainder]\nrms = 0.0\nnoise = 0.005\ncorrelation_time = 0.001\n",
    );
    folder.succeeds("gap --model model.toml --log log.csv --out out");
    let json: Value = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    // THEN nothing is missing, AND the noise of 20 mN is four times that.
    assert_eq!(json["verdict"], "no_missing_effect", "{json}");
    let notes = json["notes"].to_string();
    assert!(
        notes.contains("times what it was when the model was identified"),
        "{notes}"
    );
}
