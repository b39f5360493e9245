//! The scorer on answers made by hand.

use crate::score::answer::Answer;
use crate::score::judge::{Mark, errors, mark};
use crate::score::share::{Share, quantile};
use crate::score::truth::Truth;

fn truth(effects: &str, forms: &str) -> Truth {
    let text = format!(
        r#"{{"kind": "single", "effects": {effects}, "forms": {forms}, "floor_n": 0.01,
            "accepts": {{"coulomb_friction": ["stribeck_friction"]}},
            "params": {{"cogging": {{"amplitude": 0.2, "phase": 3.0}}}}, "base": {{"stiffness": 1000.0}}}}"#
    );
    Truth::parse(&text).unwrap_or_else(|e| panic!("{e}"))
}

fn answer(verdict: &str, effects: &str) -> Answer {
    let text = format!(
        r#"{{"verdict": "{verdict}", "effects": {effects}, "rmse_n": {{"before": 1, "after": 0.02}},
            "noise_floor_n": 0.01, "base": {{"after": {{"stiffness": {{"value": 1002.0, "std_error": 2.0}}}}}}}}"#
    );
    Answer::parse(&text).unwrap_or_else(|e| panic!("{e}"))
}

const COGGING: &str = r#"[{"id": "cogging", "params": {}, "alternatives": []}]"#;
const LAG_OR_DELAY: &str = r#"[{"id": "force_lag", "params": {}, "alternatives": ["time_delay"]}]"#;
const TWICE: &str = r#"[{"id": "stress_relaxation"}, {"id": "stress_relaxation"}]"#;

#[test]
fn answers_get_the_mark_that_they_deserve() {
    let rows = [
        ("[]", "no_missing_effect", "[]", Mark::Exact),
        ("[]", "unexplained", "[]", Mark::Doubtful),
        ("[]", "missing_effects", COGGING, Mark::ConfidentWrong),
        (r#"["unknown"]"#, "unexplained", "[]", Mark::Exact),
        (r#"["unknown"]"#, "unexplained", COGGING, Mark::Junk),
        (
            r#"["unknown"]"#,
            "missing_effects",
            COGGING,
            Mark::ConfidentWrong,
        ),
        (r#"["cogging"]"#, "missing_effects", COGGING, Mark::Exact),
        (r#"["cogging"]"#, "unexplained", COGGING, Mark::NotAdequate),
        (r#"["cogging"]"#, "no_missing_effect", "[]", Mark::Missed),
        (r#"["cogging"]"#, "unexplained", "[]", Mark::Doubtful),
        (
            r#"["backlash"]"#,
            "missing_effects",
            COGGING,
            Mark::ConfidentWrong,
        ),
        (r#"["backlash"]"#, "unexplained", COGGING, Mark::Doubtful),
        (
            r#"["time_delay"]"#,
            "ambiguous",
            LAG_OR_DELAY,
            Mark::InGroup,
        ),
        (r#"["backlash"]"#, "ambiguous", LAG_OR_DELAY, Mark::Doubtful),
        (
            r#"["cogging", "backlash"]"#,
            "missing_effects",
            COGGING,
            Mark::Incomplete,
        ),
        (
            r#"["stress_relaxation"]"#,
            "missing_effects",
            TWICE,
            Mark::Exact,
        ),
        (
            r#"["coulomb_friction"]"#,
            "missing_effects",
            r#"[{"id": "stribeck_friction"}]"#,
            Mark::Exact,
        ),
    ];
    for (effects, verdict, named, expected) in rows {
        let given = mark(&truth(effects, "{}"), &answer(verdict, named));
        assert_eq!(given, expected, "{effects}: {verdict} {named}");
    }
}

#[test]
fn errors_are_counted_in_standard_errors_and_phases_modulo_a_turn() {
    let truth = truth(r#"["cogging"]"#, r#"{"cogging": "catalogue"}"#);
    // An amplitude of −0.2 half a turn on is the same wave.
    let named = r#"[{"id": "cogging", "params": {"amplitude": {"value": -0.21, "std_error": 0.01},
        "phase": {"value": -0.1616, "std_error": 0.01}}}]"#;
    let (added, base) = errors(&truth, &answer("missing_effects", named));
    let expected = [("cogging.amplitude", 1.0), ("cogging.phase", -2.0)];
    for ((name, error), (wanted, size)) in added.iter().zip(expected) {
        assert_eq!(name, wanted);
        // The phase is given to 10⁻⁴ rad, a hundredth of its error.
        assert!((error - size).abs() < 0.01, "{name}: {error}");
    }
    assert_eq!(added.len(), 2);
    assert_eq!(base, [("stiffness".to_string(), 1.0)]);
}

#[test]
fn the_older_rigs_read_as_well() {
    let text = r#"{"kind": "pair", "effects": ["coulomb_friction", "backlash"], "params": {"coul_f": 0.6,
        "backlash": 4e-5}, "law": "hunt_crossley", "base": {"K": 2873.1, "lam": 23.1, "n": 1.45, "c": 0.4,
        "nu": 1.2, "x0": 1e-4}, "floor_n": 0.0138}"#;
    let truth = Truth::parse(text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(truth.kind, "pair");
    assert_eq!(truth.params["coulomb_friction"]["force"], 0.6);
    assert_eq!(truth.params["backlash"]["width"], 4e-5);
    let names: Vec<&str> = truth.base.keys().map(String::as_str).collect();
    assert_eq!(names, ["damping", "exponent", "stiffness", "surface"]);
}

#[test]
fn a_verdict_that_does_not_exist_is_no_answer() {
    let error = Answer::parse(r#"{"verdict": "maybe"}"#).err();
    assert!(error.is_some_and(|e| e.contains("maybe") && e.contains("ambiguous")));
}

#[test]
fn shares_carry_the_interval_that_wilson_gives() {
    // 48 of 50: 0.9600, 0.8654–0.9890 (Newcombe 1998, method 3).
    let (low, high) = Share { hits: 48, of: 50 }.interval();
    assert!(
        (low - 0.8654).abs() < 1e-4 && (high - 0.9890).abs() < 1e-4,
        "{low} {high}"
    );
    assert_eq!(quantile(&[3.0, 1.0, 2.0, f64::NAN], 0.5), 2.0);
    assert!(quantile(&[], 0.5).is_nan());
}
