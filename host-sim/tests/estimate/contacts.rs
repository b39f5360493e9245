//! `estimate` on contacts as they are: tissue that stiffens and relaxes, a cell, a law that no recursion
//! explains, force and position that are not of one instant, parameters that are held.

use crate::common::{Folder, estimated, flowing, number, parameter, record, white};
use serde_json::Value;

const AFM: &str = "afm_relaxation_rheos/data.csv.gz";
/// The sensors of the simulated rig.
const SENSORS: &str =
    "[sensors]\nforce_noise = 0.02\nforce_step = 0.005\nposition_step = 1e-6\nrate = 1000.0\n";

/// Simulates a model under the default palpation.
fn simulated(folder: &Folder, model: &str, seed: u64) {
    folder.write("model.toml", format!("{model}{SENSORS}"));
    folder.succeeds(&format!(
        "simulate --model model.toml --seed {seed} --out rig"
    ));
}

const TISSUE_SURFACE_M: f64 = 3.3e-3;
/// Stiffness at the surface (N/m), and rate (1/m).
const TISSUE: (f64, f64) = (110.0, 800.0);
/// Fraction and rate (1/s) of its modes.
const TISSUE_MODES: [(f64, f64); 2] = [(0.45, 2.5), (0.2, 0.22)];

/// Tissue under a testing machine at 10 Hz: 2.2 s through air at 1.5 mm/s, on to 5.4 mm, 12 s of hold; a
/// baseline with 1.5 mN of noise, 0.1 µm in the position. The law is summed in steps of 0.1 ms, by nothing of this project.
fn tissue() -> String {
    let (mut w, mut before_n) = ([0.0; 2], 0.0);
    let mut text = String::from("t_s,x_m,f_n\n");
    for step in 0..160_000_u32 {
        let time_s = 1e-4 * f64::from(step);
        let position_m = (1.5e-3 * (time_s - 0.4).max(0.0)).min(5.4e-3);
        let depth_m = (position_m - TISSUE_SURFACE_M).max(0.0);
        let elastic_n = TISSUE.0 / TISSUE.1 * ((TISSUE.1 * depth_m).exp() - 1.0);
        let mut force_n = elastic_n;
        for (w, (fraction, rate)) in w.iter_mut().zip(TISSUE_MODES) {
            *w += elastic_n - before_n - rate * 1e-4 * *w;
            force_n -= fraction * (elastic_n - *w);
        }
        before_n = elastic_n;
        if step.is_multiple_of(1000) {
            let read_n = force_n + 1.5e-3 * white(step / 1000);
            let read_m = position_m + 1e-7 * white(step / 1000 + 7919);
            text += &format!("{time_s:.3},{read_m:.9},{read_n:.6}\n");
        }
    }
    text
}

#[test]
fn the_contact_point_of_stiffening_relaxing_tissue_is_found_within_its_error() {
    let folder = Folder::with("tissue.csv", tissue());
    for options in ["", "--method batch", "--method online"] {
        let json = estimated(&folder, "tissue.csv", options);
        let surface = &json["parameters"]["surface"];
        let Some((at, error)) = surface["value"].as_f64().zip(surface["std_error"].as_f64()) else {
            continue;
        };
        // The force leaves its baseline where e^{bδ} has grown 4 mN: 36 µm deep, between two samples.
        let off = (at - TISSUE_SURFACE_M).abs();
        let converged = json["status"] == "converged";
        assert!(
            off <= 3.0 * error || !converged,
            "{options}: {at} ± {error}: {json}"
        );
    }
    let json = estimated(&folder, "tissue.csv", "");
    let (at, error) = parameter(&json, "surface");
    assert!(
        (at - TISSUE_SURFACE_M).abs() <= 3.0 * error,
        "{at} ± {error}"
    );
    assert!(error < 1e-3, "{error}");
}

#[test]
fn an_exponential_response_is_fitted_where_it_is_asked_for() {
    let folder = Folder::with("tissue.csv", tissue());
    folder.write("fung.toml", "[estimator]\nelastic = \"exponential\"\n");
    let json = estimated(&folder, "tissue.csv", "--config fung.toml");
    assert_eq!(json["elastic"], "exponential");
    assert_eq!(json["status"], "converged", "{json}");
    for (name, truth) in [("stiffening_rate", TISSUE.1), ("surface", TISSUE_SURFACE_M)] {
        let (value, error) = parameter(&json, name);
        assert!(
            (value - truth).abs() <= 3.0 * error,
            "{name}: {value} ± {error}"
        );
        assert!(error < 0.2 * truth, "{name}: {value} ± {error}");
    }
}

#[test]
fn touches_have_figures_that_need_no_model() {
    let folder = Folder::with("tissue.csv", tissue());
    let json = estimated(&folder, "tissue.csv", "");
    let touches = json["touches"].as_array().unwrap();
    assert_eq!(touches.len(), 1);
    let text = folder.read("tissue.csv");
    let raw = text
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').next().unwrap());
    let peak = raw
        .map(|force| force.parse::<f64>().unwrap())
        .fold(0.0, f64::max);
    // At 10 Hz no sample is averaged away: the peak is the largest one.
    let found = number(&touches[0], "/peak_force_n");
    assert!((found - peak).abs() < 5e-3, "{found} for {peak}");
    let depth = number(&touches[0], "/peak_depth_m");
    assert!((1.85e-3..2.3e-3).contains(&depth), "{depth}");
    let secant = number(&touches[0], "/secant_stiffness");
    assert!((secant / (found / depth) - 1.0).abs() < 0.1, "{secant}");
    // 1 − Σcᵢ = 0.35 of the force at once are left in the end, of a peak that has relaxed already.
    let left = number(&touches[0], "/relaxation_ratio");
    assert!((0.35..0.75).contains(&left), "{left}");
    // The log ends in contact: what it dissipates is not known.
    assert!(touches[0]["dissipated_j"].is_null());
}

#[test]
fn a_spring_dissipates_nothing_and_a_damper_its_loop() {
    let loss = |damping: f64| {
        let folder = Folder::new();
        let law = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 2000.0\n";
        simulated(&folder, &format!("{law}damping = {damping}\n"), 5);
        let json = estimated(&folder, "rig/log.csv", "--law kelvin_voigt");
        let touches = json["touches"].as_array().unwrap().clone();
        let sum = |key: &str| touches.iter().filter_map(|t| t[key].as_f64()).sum::<f64>();
        (
            sum("dissipated_j"),
            sum("peak_force_n") / touches.len() as f64,
        )
    };
    let ((spring, peak), (damper, _)) = (loss(0.0), loss(20.0));
    // Strokes of some millimetres at 10 N store 10 mJ and more.
    assert!(spring.abs() < 1e-3 * peak, "{spring} J");
    assert!(damper > 10.0 * spring.abs() && damper > 1e-2, "{damper} J");
}

#[test]
fn a_modulus_says_which_it_is_and_whether_it_holds() {
    let folder = Folder::new();
    // 1.9 µm deep: far beyond small strain under a sphere of 2 µm.
    let json = estimated(
        &folder,
        &record(AFM),
        "--method batch --indenter sphere:2e-6",
    );
    let modulus = &json["modulus"];
    assert_eq!(modulus["kind"], "instantaneous");
    assert_eq!(modulus["valid"], false);
    let why = modulus["why"].as_str().unwrap();
    assert!(why.contains("radius"), "{why}");
    // GIVEN a sphere of 50 mm on an elastic contact of its own exponent
    let law = "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 2000.0\ndamping = 20.0\nexponent = 1.5\n";
    simulated(&folder, law, 3);
    let json = estimated(
        &folder,
        "rig/log.csv",
        "--method batch --indenter sphere:0.05",
    );
    let modulus = &json["modulus"];
    assert_eq!(modulus["valid"], true, "{modulus}");
    assert_eq!(modulus["kind"], "relaxed");
    // F = ⁴⁄₃E*√R·δ^{3/2} with 2 N at 1 mm, ν = ½.
    let truth = 0.75 * 2.0 / (4.0 / 3.0 * 0.05_f64.sqrt() * 1e-3_f64.powf(1.5));
    let (value, error) = (number(modulus, "/value"), number(modulus, "/std_error"));
    assert!(
        (value - truth).abs() < 4.0 * error && error < 0.02 * truth,
        "{value} ± {error} for {truth}"
    );
}

#[test]
fn a_material_that_no_recursion_explains_is_fitted_as_a_whole() {
    let law = "[environment]\nlaw = \"quasi_linear\"\nstiffness = 2900.0\nexponent = 1.2\nsurface = 0.0\n\
               relaxation = [{ fraction = 0.3, rate = 0.5 }]\n";
    for seed in [3, 11, 12] {
        let folder = Folder::new();
        simulated(&folder, law, seed);
        let json = estimated(&folder, "rig/log.csv", "");
        assert_eq!(json["law"], "quasi_linear", "{seed}");
        assert_eq!(json["status"], "converged", "{seed}: {json}");
        for (name, truth) in [
            ("stiffness", 2900.0),
            ("exponent", 1.2),
            ("relaxation_rate_1", 0.5),
        ] {
            let (value, error) = parameter(&json, name);
            let far = (3.0 * error).max(2e-3 * truth);
            assert!(
                (value - truth).abs() < far,
                "{seed}, {name}: {value} ± {error}"
            );
        }
        for options in [
            "--law quasi_linear",
            "--law zener",
            "--method online",
            "--law hunt_crossley",
        ] {
            let json = estimated(&folder, "rig/log.csv", options);
            let misfit =
                json["force_rmse_n"].as_f64().unwrap_or(0.0) / number(&json, "/force_noise_n");
            let status = json["status"].as_str().unwrap();
            assert!(
                misfit <= 2.0 || status != "converged",
                "{seed}, {options}: {misfit}"
            );
            assert_eq!(
                json["status_reason"].is_null(),
                status == "converged",
                "{seed}, {options}"
            );
        }
    }
}

#[test]
fn an_afm_record_keeps_no_law_that_leaves_well_more_than_another() {
    let folder = Folder::new();
    let json = estimated(&folder, &record(AFM), "");
    let tried = json["selection"].as_array().unwrap();
    let left = tried.iter().filter_map(|law| law["force_rmse_n"].as_f64());
    let least = left.fold(f64::INFINITY, f64::min);
    assert!(number(&json, "/force_rmse_n") < 2.0 * least, "{json}");
    assert_eq!(json["status"], "model_suspect");
    assert!(json["status_reason"].is_string());
    let said = flowing(&json["notes"].to_string());
    assert!(
        said.contains("no recursive method explains this force"),
        "{said}"
    );
}

const HUNT_CROSSLEY: &str =
    "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 6000.0\ndamping = 45.0\nexponent = 1.25\n";

#[test]
fn skew_is_noticed_and_measured_and_a_clean_log_has_none() {
    for (seed, late_s) in [(21, 0.0), (22, 4e-4), (23, -4e-4), (24, 1.5e-3)] {
        let folder = Folder::new();
        let effect = format!("[[effect]]\nid = \"time_delay\"\ndelay = {late_s}\n");
        let effect = if late_s == 0.0 { "" } else { effect.as_str() };
        simulated(&folder, &format!("{HUNT_CROSSLEY}{effect}"), seed);
        let json = estimated(&folder, "rig/log.csv", "");
        let (value, error) = (
            number(&json, "/skew_s/value"),
            number(&json, "/skew_s/std_error"),
        );
        // 10 µs: the rig holds its signals for a sub-step.
        assert!(
            (value - late_s).abs() < 3.0 * error + 1e-5,
            "{value} ± {error} for {late_s}"
        );
        assert!(error < 5e-5, "{error}");
        let (status, reason) = match late_s == 0.0 {
            true => ("converged", Value::Null),
            false => ("model_suspect", "skew".into()),
        };
        assert_eq!(json["status"], status, "{late_s}");
        assert_eq!(json["status_reason"], reason, "{late_s}");
    }
}

#[test]
fn the_method_that_estimates_the_skew_counts_it_in_its_residual() {
    let folder = Folder::new();
    let effect = "[[effect]]\nid = \"time_delay\"\ndelay = 1.5e-3\n";
    simulated(&folder, &format!("{HUNT_CROSSLEY}{effect}"), 31);
    let json = estimated(&folder, "rig/log.csv", "--law hunt_crossley --method skew");
    let misfit = number(&json, "/force_rmse_n") / number(&json, "/force_noise_n");
    assert!((0.8..1.15).contains(&misfit), "{misfit}");
    let value = number(&json, "/skew_s/value");
    assert!((value - 1.5e-3).abs() < 5e-5, "{value}");
    assert_eq!(json["status"], "converged");
}

#[test]
fn an_exponent_is_held_where_the_settings_say_so() {
    let folder = Folder::new();
    simulated(&folder, HUNT_CROSSLEY, 41);
    folder.write(
        "held.toml",
        "[estimator]\nfixed = [\"exponent\"]\ninitial = { exponent = 1.5 }\n",
    );
    let json = estimated(
        &folder,
        "rig/log.csv",
        "--law hunt_crossley --method batch --config held.toml",
    );
    let (value, error) = parameter(&json, "exponent");
    assert!(
        (value - 1.5).abs() < 1e-9 && error < 1e-9,
        "{value} ± {error}"
    );
    // Another exponent than the material's does not explain it, and that is said.
    assert_eq!(json["status"], "model_suspect");
    let done =
        folder.palpate("estimate rig/log.csv --law hunt_crossley --method bank --config held.toml");
    assert_eq!(done.status.code(), Some(2));
}
