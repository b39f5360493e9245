//! `estimate` and `check` on logs from outside this project: the numbers have the right scale, and the reason
//! why a law does not fit is named. Only this test reads the truth of the simulated rigs.

use crate::common::{Folder, complained, flowing, record, said};
use serde_json::Value;

const AFM: &str = "afm_relaxation_rheos/data.csv.gz";
const FOAM: &str = "nist_foam_relaxation/data_0da.csv";
const RIG_06: &str = "hidden-effects/rig-06/measured.csv.gz";
const RIG_13: &str = "hidden-effects/rig-13/measured.csv.gz";

/// An estimate of a record with its files.
struct Estimated {
    folder: Folder,
    said: String,
    json: Value,
}

impl Estimated {
    fn of(name: &str, options: &str) -> Estimated {
        let folder = Folder::new();
        let done = folder.palpate(&format!("estimate {} --out out {options}", record(name)));
        assert_eq!(done.status.code(), Some(0), "{name}: {}", complained(&done));
        assert_eq!(complained(&done), "", "{name}");
        let json = serde_json::from_str(&folder.read("out/estimate.json")).unwrap();
        let said = said(&done);
        Estimated { folder, said, json }
    }

    fn parameter(&self, name: &str, field: &str) -> f64 {
        let value = &self.json["parameters"][name][field];
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{name}.{field} in {}", self.json))
    }

    fn value(&self, name: &str) -> f64 {
        self.parameter(name, "value")
    }

    /// All notes in one piece, with plain spaces.
    fn notes(&self) -> String {
        let notes = self.json["notes"].as_array().unwrap();
        let notes: Vec<&str> = notes.iter().filter_map(Value::as_str).collect();
        flowing(&notes.join("\n"))
    }
}

/// The truth of a rig: K (N/m), λ (N s/m), n, surface (m).
fn truth(rig: &str) -> [(&'static str, f64); 4] {
    let text =
        std::fs::read_to_string(record(&format!("hidden-effects/{rig}/truth.json"))).unwrap();
    let truth: Value = serde_json::from_str(&text).unwrap();
    let base = |key: &str| truth["base"][key].as_f64().unwrap();
    [
        ("stiffness", base("K")),
        ("damping", base("lam")),
        ("exponent", base("n")),
        ("surface", base("x0")),
    ]
}

fn assert_within(what: &str, value: f64, bounds: std::ops::RangeInclusive<f64>) {
    assert!(
        bounds.contains(&value),
        "{what}: {value:e} outside {bounds:?}"
    );
}

fn assert_says(text: &str, words: &[&str]) {
    let text = flowing(text);
    for word in words {
        assert!(text.contains(word), "no `{word}` in {text}");
    }
}

#[test]
fn an_afm_log_is_estimated_at_its_own_scale_and_nobody_calls_it_converged() {
    let estimated = Estimated::of(AFM, "");
    let json = &estimated.json;
    assert_eq!(json["reference_depth_m"], 1e-6);
    // No recursion explains this record, so the whole of it is fitted. 2.2 µN over 2.1 µm is 1.05 N/m on the
    // way in, with some of it relaxed already; 0.8 µN over 2 µm 0.4 N/m at the end of the hold.
    assert_eq!(
        (&json["law"], &json["method"]),
        (&"quasi_linear".into(), &"batch".into())
    );
    let modes = (1..=4).map(|mode| format!("relaxation_fraction_{mode}"));
    let relaxing: f64 = modes.map(|name| estimated.value(&name)).sum();
    assert_within("K", estimated.value("stiffness"), 1.0..=2.0);
    assert_within(
        "relaxed",
        estimated.value("stiffness") * (1.0 - relaxing),
        0.2..=0.5,
    );
    // README: the contact point is at 6.29 µm of travel, by a fit.
    assert_within("surface", estimated.value("surface"), 6.2e-6..=6.4e-6);
    assert_within(
        "its error",
        estimated.parameter("surface", "std_error"),
        1e-8..=3e-7,
    );
    assert_ne!(json["status"], "converged");
    // One approach and one retract; a resting force that ends 6 nN higher is no touch.
    let touches = json["touches"].as_array().unwrap();
    assert_eq!(touches.len(), 1, "{touches:?}");
    assert_within(
        "peak",
        touches[0]["peak_force_n"].as_f64().unwrap(),
        2.1e-6..=2.3e-6,
    );
    assert_says(
        &estimated.notes(),
        &[
            "reference depth 1 µm",
            "does not explain this force",
            "relaxes by 2",
            "below rest: adhesion",
        ],
    );
    // Four modes leave 7.4 nN in the record's README, and no mode 0.19 µN.
    assert_within(
        "rmse",
        json["force_rmse_n"].as_f64().unwrap(),
        1e-9..=8.1e-9,
    );
}

#[test]
fn a_foam_is_as_stiff_as_its_record_says_and_its_relaxation_has_a_name() {
    let estimated = Estimated::of(FOAM, "");
    // 4.0 N over 0.76 mm is 5.3 kN/m after a ramp of 8 s, in which most has relaxed; 1.58 N is 2.1 kN/m after
    // 1600 s. K holds at 1 mm and at once.
    let fractions = ["relaxation_fraction_1", "relaxation_fraction_2"];
    let relaxing: f64 = fractions.map(|name| estimated.value(name)).iter().sum();
    assert_within("K", estimated.value("stiffness"), 5.3e3..=20e3);
    assert_within(
        "relaxed",
        estimated.value("stiffness") * (1.0 - relaxing),
        1.8e3..=2.3e3,
    );
    assert_eq!(estimated.json["reference_depth_m"], 1e-3);
    assert_ne!(estimated.json["status"], "converged");
    assert_says(
        &estimated.notes(),
        &[
            "relaxes by 26 %",
            "does not explain this force",
            "interpolated to 50 Hz",
            "samples are interpolated",
        ],
    );
}

/// Asserts that every parameter is within 1 % of the truth, and within three standard errors or 0.1 %.
fn assert_found(estimated: &Estimated, truth: &[(&str, f64)]) {
    for (name, truth) in truth {
        let error = (estimated.value(name) - truth).abs();
        let std_error = estimated.parameter(name, "std_error");
        // The surface is a place: a percentage of it means nothing, so that of a millimetre.
        let size = if *name == "surface" {
            1e-3
        } else {
            truth.abs()
        };
        assert!(error < 0.01 * size, "{name}: off by {error}");
        assert!(
            error < (3.0 * std_error).max(1e-3 * size),
            "{name}: off by {error} ± {std_error}"
        );
        // Two-sided: 25 s of 13 mN of noise on 10 N cannot tell anything to better than 0.005 %.
        assert_within(name, std_error / size, 5e-5..=5e-3);
    }
}

#[test]
fn rig_13_is_found_with_its_surface_to_one_percent_and_three_standard_errors() {
    let estimated = Estimated::of(RIG_13, "--law hunt_crossley");
    assert_found(&estimated, &truth("rig-13"));
    assert_eq!(estimated.json["status"], "converged");
    // The rig's floor is 12.7 mN, and the truth itself leaves 13.3 mN.
    let rmse = estimated.json["force_rmse_n"].as_f64().unwrap();
    assert_within("rmse", rmse, 12e-3..=18e-3);
}

#[test]
fn the_two_stages_on_rig_13_say_what_the_impact_costs() {
    let estimated = Estimated::of(RIG_13, "--law hunt_crossley --method two_stage");
    for (name, truth) in truth("rig-13") {
        let error = (estimated.value(name) - truth).abs();
        let std_error = estimated.parameter(name, "std_error");
        assert!(
            error < 4.0 * std_error,
            "{name}: off by {error} ± {std_error}"
        );
        // Two-sided: a surface that is known to 58 µm of 4 mm cannot give K to 1 %.
        assert_within(name, std_error / truth.abs(), 0.005..=0.3);
    }
    // The threshold of 80 mN is 110 µm deep; half of that is what the impact is known to.
    let surface = truth("rig-13")[3].1;
    assert_within(
        "surface",
        estimated.value("surface") - surface,
        -60e-6..=60e-6,
    );
    assert_says(
        &estimated.notes(),
        &["the surface is taken from the impact"],
    );
}

#[test]
fn rig_13_with_its_surface_given_is_found_to_two_percent() {
    let [stiffness, damping, exponent, (_, surface_m)] = truth("rig-13");
    let options = format!("--law hunt_crossley --method two_stage --surface {surface_m}");
    let estimated = Estimated::of(RIG_13, &options);
    for (name, truth) in [stiffness, damping, exponent] {
        assert_within(name, estimated.value(name) / truth, 0.98..=1.02);
    }
    assert_eq!(estimated.json["status"], "converged");
    // The rig's floor is 12.7 mN; a law without misfit leaves it, and never less.
    let rmse = estimated.json["force_rmse_n"].as_f64().unwrap();
    assert_within("rmse", rmse, 12e-3..=50e-3);
}

#[test]
fn auto_takes_the_law_that_the_rig_has() {
    let of = |name: &str| Estimated::of(name, "");
    let (spring, rig_13) = (of(RIG_06), of(RIG_13));
    assert_eq!(rig_13.json["law"], "hunt_crossley");
    assert_eq!(rig_13.json["method"], "bank");
    assert_eq!(spring.json["law"], "kelvin_voigt");
    assert_eq!(spring.json["method"], "rls_surface");
    let [stiffness, damping, _, surface] = truth("rig-06");
    assert_found(&spring, &[stiffness, damping, surface]);
    let laws = spring.json["selection"].as_array().unwrap();
    let laws: Vec<&Value> = laws.iter().map(|tried| &tried["law"]).collect();
    // The quasi-linear law with one mode and with two, by the cascade and by the bank.
    let all = [
        "kelvin_voigt",
        "hunt_crossley",
        "zener",
        "quasi_linear",
        "quasi_linear",
        "quasi_linear",
        "quasi_linear",
    ];
    assert_eq!(laws, all);
    assert_says(&spring.said, &["laws tried: kelvin_voigt leaves"]);
}

/// The names of an object's fields, in their order.
fn fields(object: &Value) -> Vec<&str> {
    object
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

#[test]
fn estimate_json_has_the_documented_fields_and_units() {
    let json = Estimated::of(RIG_13, "").json;
    let documented = "law method reference_depth_m status status_reason parameters force_rmse_n \
                      force_noise_n skew_s settled_at_s segments touches events selection compensated notes";
    assert_eq!(fields(&json).join(" "), documented);
    let parameters = json["parameters"].as_object().unwrap();
    let units: Vec<_> = parameters
        .iter()
        .map(|(name, parameter)| {
            assert_eq!(fields(parameter), ["value", "std_error", "unit"], "{name}");
            (name.as_str(), parameter["unit"].as_str().unwrap())
        })
        .collect();
    let documented = [
        ("stiffness", "N/m"),
        ("damping", "N s/m"),
        ("exponent", "1"),
        ("surface", "m"),
    ];
    assert_eq!(units, documented);
    let first = |list: &str| fields(&json[list][0]).join(" ");
    assert_eq!(first("segments"), "from_s to_s parameters");
    let of_a_touch =
        "from_s to_s peak_force_n peak_depth_m secant_stiffness dissipated_j relaxation_ratio";
    assert_eq!(first("touches"), of_a_touch);
    assert_eq!(first("events"), "t_s kind");
    assert_eq!(first("selection"), "law method force_rmse_n");
    // What begins together is said to begin together, and a touch ends where it is released.
    let touches = json["touches"].as_array().unwrap();
    let events = json["events"].as_array().unwrap();
    assert_eq!(json["segments"][0]["from_s"], touches[0]["from_s"]);
    for touch in touches {
        let contact = events.iter().find(|event| event["t_s"] == touch["from_s"]);
        assert_eq!(contact.unwrap()["kind"], "contact");
    }
}

#[test]
fn estimate_csv_has_a_row_a_sample_and_every_tenth_on_request() {
    let rows = |options: &str| {
        let csv = Estimated::of(RIG_06, options)
            .folder
            .read("out/estimate.csv");
        let header = csv.lines().next().unwrap().to_string();
        (header, csv.lines().count() - 1)
    };
    let (header, all) = rows("");
    assert_eq!(
        header,
        "t_s,phase,status,depth_m,speed_mps,force_n,prediction_n,test_ratio,beta,\
         stiffness,stiffness_std_error,damping,damping_std_error,surface,surface_std_error,event,faults"
    );
    assert_eq!(all, 26_966);
    assert_eq!(rows("--every 10"), (header, 2_697));
}

#[test]
fn the_report_of_each_record_is_one_file_without_network() {
    for name in [AFM, FOAM, RIG_06, RIG_13] {
        let html = Estimated::of(name, "").folder.read("out/report.html");
        assert_within(name, html.len() as f64, 50e3..=2e6);
        assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"));
        for reference in [
            "src=\"http",
            "href=\"http",
            "url(http",
            "@import",
            "<script src",
            "<link",
        ] {
            assert!(!html.contains(reference), "{name}: {reference}");
        }
        for figure in [
            "Hysteresis loop",
            "Power exchange",
            "Stiffness",
            "Elastic response",
        ] {
            assert!(html.contains(figure), "{name}: {figure}");
        }
        // Quantities are for people: 371 mN and 1 µm, not 3.71e-1 N and 1000 nm. A law that explains
        // its log needs no notes, but for what a spring and damper cannot know.
        let notes = html.split("<h2>Notes</h2>").nth(1).unwrap_or_default();
        let notes = notes.split("</ul>").next().unwrap_or_default();
        let of_a_damper = notes.matches("read at the same instant").count();
        assert_eq!(of_a_damper, usize::from(name.contains("rig-06")), "{name}");
        assert_eq!(
            notes.matches("<li>").count() > of_a_damper,
            [AFM, FOAM].contains(&name),
            "{name}: {notes}"
        );
        let exponents = notes
            .match_indices("e-")
            .map(|(at, _)| notes.as_bytes()[at - 1]);
        assert!(
            !exponents.into_iter().any(|before| before.is_ascii_digit()),
            "{name}: {notes}"
        );
        assert!(!html.contains("of 1000\u{a0}nm"), "{name}");
    }
}

#[test]
fn check_names_what_is_in_each_record() {
    #[rustfmt::skip]
    let records: [(&str, &[&str]); 4] = [
        (AFM,    &["76600 samples", "5000 Hz", "touches 1", "relaxes by 21.6 %", "615 nN below rest: adhesion", "damping (at "]),
        (FOAM,   &["1982 samples", "50 Hz", "1198 gaps", "touches 1", "relaxes by 26.0 %", "further temp_c", "relaxation (a hold of 1600 s)"]),
        (RIG_06, &["26966 samples", "1000 Hz, no jitter", "steps of 1.00 µm", "touches 8", "damping (speeds from"]),
        (RIG_13, &["25645 samples", "1000 Hz, no jitter", "steps of 1.00 µm", "touches 2", "damping (speeds from"]),
    ];
    for (name, words) in records {
        let done = Folder::new().palpate(&format!("check {}", record(name)));
        assert_eq!(done.status.code(), Some(0));
        let text = said(&done);
        assert_says(&text, words);
        assert!(text.lines().count() <= 30, "{name}: {text}");
        assert!(!text.contains("  ! "), "{name}: {text}");
    }
}
