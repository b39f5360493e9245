//! The scorer on answers that are written by hand.

use tests::hidden::score::answer::Answer;
use tests::hidden::score::judge::{Mark, errors, mark};
use tests::hidden::score::process::cpu;
use tests::hidden::score::scored::Scored;
use tests::hidden::score::share::Share;
use tests::hidden::score::table::{self, WIDE};
use tests::hidden::score::truth::Truth;

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
        // Either name is right, both together are one too many.
        (
            r#"["coulomb_friction"]"#,
            "missing_effects",
            r#"[{"id": "coulomb_friction"}, {"id": "stribeck_friction"}]"#,
            Mark::ConfidentWrong,
        ),
        // One name does not stand for two effects, by its alternative.
        (
            r#"["force_lag", "time_delay"]"#,
            "ambiguous",
            LAG_OR_DELAY,
            Mark::Incomplete,
        ),
    ];
    for (effects, verdict, named, expected) in rows {
        let given = mark(&truth(effects, "{}"), &answer(verdict, named));
        assert_eq!(given, expected, "{effects}: {verdict} {named}");
    }
}

/// Names with their grades.
type Graded = &'static [(&'static str, &'static str)];

/// The names as the answer writes them.
fn graded(names: Graded) -> String {
    let one = |(id, grade): &(&str, &str)| {
        format!(r#"{{"id": "{id}", "alternatives": ["time_delay"], "grade": "{grade}"}}"#)
    };
    let all: Vec<String> = names.iter().map(one).collect();
    format!("[{}]", all.join(","))
}

#[test]
fn a_name_is_judged_by_its_grade() {
    let rows: [(&str, &str, Graded, Mark); 11] = [
        (
            "[]",
            "partly_explained",
            &[("cogging", "strong")],
            Mark::ConfidentWrong,
        ),
        ("[]", "unexplained", &[("cogging", "open")], Mark::Doubtful),
        (
            r#"["unknown"]"#,
            "partly_explained",
            &[("cogging", "strong")],
            Mark::ConfidentWrong,
        ),
        (
            r#"["unknown"]"#,
            "partly_explained",
            &[("cogging", "open")],
            Mark::Junk,
        ),
        (
            r#"["unknown"]"#,
            "ambiguous",
            &[("cogging", "certain")],
            Mark::ConfidentWrong,
        ),
        (
            r#"["cogging"]"#,
            "partly_explained",
            &[("cogging", "strong")],
            Mark::NotAdequate,
        ),
        (
            r#"["cogging"]"#,
            "partly_explained",
            &[("cogging", "open")],
            Mark::InGroup,
        ),
        (
            r#"["cogging"]"#,
            "partly_explained",
            &[("backlash", "strong")],
            Mark::ConfidentWrong,
        ),
        // A rival leaves it open that the right one stands.
        (
            r#"["time_delay"]"#,
            "partly_explained",
            &[("force_lag", "open")],
            Mark::InGroup,
        ),
        // One of two stands, the other is open and wrong.
        (
            r#"["cogging", "backlash"]"#,
            "partly_explained",
            &[("cogging", "strong"), ("force_drift", "open")],
            Mark::Doubtful,
        ),
        (
            r#"["cogging", "backlash"]"#,
            "partly_explained",
            &[("cogging", "strong")],
            Mark::Incomplete,
        ),
    ];
    for (effects, verdict, named, expected) in rows {
        let given = mark(&truth(effects, "{}"), &answer(verdict, &graded(named)));
        assert_eq!(given, expected, "{effects}: {verdict} {named:?}");
    }
}

#[test]
fn true_parts_that_are_not_asked_for_are_no_wrong_names() {
    let truth = |effects: &str| {
        let text = format!(
            r#"{{"category": "same", "kind": "cogging", "effects": {effects}, "floor_n": 0.01,
                "accept": [["cogging"], ["cogging", "backlash"]],
                "tolerate": ["periodic_disturbance@50", "force_offset"],
                "params": {{"cogging.amplitude": 0.2}}, "law": "hunt_crossley", "base": {{"K": 1000.0}}}}"#
        );
        Truth::parse(&text).unwrap_or_else(|e| panic!("{e}"))
    };
    let line = |hz: f64| {
        format!(
            r#"{{"id": "periodic_disturbance", "params": {{"frequency": {{"value": {hz}, "std_error": 0.01}}}}}}"#
        )
    };
    let cogging = r#"{"id": "cogging"}"#;
    let marked = |effects: &str, named: &[&str]| {
        let named = format!("[{}]", named.join(","));
        mark(&truth(effects), &answer("missing_effects", &named))
    };
    // Who names the hum beside what is in no catalogue names nothing wrong, and has missed it.
    let stranger = r#"["unknown"]"#;
    assert_eq!(marked(stranger, &[&line(50.02)]), Mark::Missed);
    assert_eq!(marked(stranger, &[&line(55.0)]), Mark::ConfidentWrong);
    let something = r#"["cogging"]"#;
    assert_eq!(marked(something, &[cogging, &line(50.02)]), Mark::Exact);
    assert_eq!(
        marked(something, &[cogging, r#"{"id": "force_offset"}"#]),
        Mark::Exact
    );
    assert_eq!(
        marked(something, &[cogging, r#"{"id": "backlash"}"#]),
        Mark::Exact
    );
    assert_eq!(
        marked(something, &[cogging, &line(44.0)]),
        Mark::ConfidentWrong
    );
    // Where nothing else is hidden, the hum alone is no alarm.
    assert_eq!(marked("[]", &[&line(50.02)]), Mark::Exact);
    assert_eq!(marked("[]", &[&line(44.0)]), Mark::ConfidentWrong);
    let read = truth(something);
    assert_eq!(read.params["cogging"]["amplitude"], 0.2);
    assert_eq!(read.base["stiffness"], 1000.0);
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
}

/// A scored rig of a kind, from texts in place of files.
fn run(kind: &str, effects: &str, more: &str, verdict: &str, named: &str) -> Scored {
    let ids: Vec<String> = serde_json::from_str(effects).unwrap_or_else(|e| panic!("{e}"));
    let form = |id: &String| format!(r#""{id}": "catalogue""#);
    let forms = ids.iter().map(form).collect::<Vec<_>>().join(", ");
    let text = format!(
        r#"{{"kind": "{kind}", "effects": {effects}, "forms": {{{forms}}}, "floor_n": 0.01{more}}}"#
    );
    Scored {
        rig: format!("{kind}/rig-001").into(),
        truth: Truth::parse(&text).unwrap_or_else(|e| panic!("{e}")),
        answer: Ok(answer(verdict, named)),
        further: None,
    }
}

/// The words of the first line that starts with `start`.
fn words(text: &str, start: &str) -> Vec<String> {
    let line = text.lines().find(|line| line.starts_with(start));
    let line = line.unwrap_or_else(|| panic!("no {start} in\n{text}"));
    line.split_whitespace().map(String::from).collect()
}

#[test]
fn names_are_counted_alone_adequate_and_left_open_apart() {
    let one = |more, verdict, named| run("single", r#"["cogging"]"#, more, verdict, named);
    let text = table::text(
        &[
            one("", "missing_effects", COGGING),
            one("", "missing_effects", COGGING),
            one("", "unexplained", COGGING),
            run("single", r#"["time_delay"]"#, "", "ambiguous", LAG_OR_DELAY),
            one("", "no_missing_effect", "[]"),
            one(r#", "gap_ratio": 1.4"#, "no_missing_effect", "[]"),
            run(
                "mismatched",
                r#"["cogging"]"#,
                r#", "form_ratio": 1.3"#,
                "unexplained",
                COGGING,
            ),
        ],
        false,
    );
    let row = words(&text, "single");
    assert_eq!((row[1].as_str(), row[2].as_str()), ("5", "60.0"), "{text}");
    assert_eq!(
        (row[4].as_str(), row[6].as_str()),
        ("40.0", "80.0"),
        "{text}"
    );
    // inad, open, part, bad, iffy, null, fail
    assert_eq!(row[8..], ["1", "1", "0", "0", "0", "1", "0"], "{text}");
    // What the base nearly hides is in no bar.
    assert_eq!(words(&text, "weak")[1], "1");
    // A form that the catalogue cannot follow counts among all, and again in a row of its own.
    assert_eq!(words(&text, "mismatched")[1..3], ["1", "100.0"]);
    assert_eq!(words(&text, "  crude form")[2..4], ["1", "100.0"]);
}

#[test]
fn false_alarms_have_their_bound_and_coloured_noise_its_row() {
    let quiet = |noise: &str| {
        let noise = format!(r#", "noise": "{noise}""#);
        run("none", "[]", &noise, "no_missing_effect", "[]")
    };
    let mut runs: Vec<Scored> = (0..298).map(|_| quiet("white")).collect();
    runs.push(quiet("pink"));
    runs.push(run(
        "none",
        "[]",
        r#", "noise": "ar1_5_hz""#,
        "unexplained",
        "[]",
    ));
    let text = table::text(&runs, false);
    // 1 of 300: 1 − p such that (1−p)³⁰⁰ + 300·p·(1−p)²⁹⁹ = 0.05.
    assert_eq!(
        words(&text, "all")[1..],
        ["300", "1", "1.57", "0", "1", "0"]
    );
    // 298 without one: 1 − 0.05^(1/298).
    assert_eq!(words(&text, "white")[1..4], ["298", "0", "1.00"]);
    assert_eq!(words(&text, "coloured")[1..3], ["2", "1"]);
    assert_eq!(words(&text, "  ar1")[1..3], ["1", "1"]);
}

#[test]
fn what_is_in_no_catalogue_is_counted_by_kind() {
    let one = |form: &str, verdict, named| {
        let mut one = run("unknown", r#"["unknown"]"#, "", verdict, named);
        one.truth.label = form.into();
        one
    };
    let text = table::text(
        &[
            one("spikes", "unexplained", "[]"),
            one("spikes", "unexplained", COGGING),
            one("chatter", "missing_effects", COGGING),
            one("chatter", "ambiguous", LAG_OR_DELAY),
        ],
        false,
    );
    let row = words(&text, "2 kinds");
    let shares = [&row[3], &row[5], &row[7], &row[9]];
    assert_eq!(shares, ["50.0", "25.0", "25.0", "1"], "{text}");
    assert_eq!(words(&text, "  spikes")[1..3], ["2", "100.0"]);
}

#[test]
fn an_advised_motion_resolves_if_both_logs_together_give_the_name() {
    let open = |further: Option<(&str, &str)>| Scored {
        further: further.map(|(verdict, named)| Ok(answer(verdict, named))),
        ..run("poor", r#"["time_delay"]"#, "", "ambiguous", LAG_OR_DELAY)
    };
    let delay = r#"[{"id": "time_delay"}]"#;
    let text = table::text(
        &[
            open(Some(("missing_effects", delay))),
            open(Some(("ambiguous", LAG_OR_DELAY))),
            open(None),
            run("poor", r#"["backlash"]"#, "", "missing_effects", COGGING),
        ],
        false,
    );
    let lines: Vec<&str> = text.lines().take(5).collect();
    assert!(
        lines[0].contains("of 4") && lines[0].contains("75.0"),
        "{text}"
    );
    assert!(lines[1].contains("median 2, most 2"), "{text}");
    assert!(
        lines[2].contains("for 2 of them") && lines[2].contains("33.3"),
        "{text}"
    );
    assert!(text.contains("time_delay → no motion advised"), "{text}");
    assert!(text.contains("time_delay → force_lag?"), "{text}");
}

#[test]
fn whoever_was_taken_for_another_has_a_row_and_no_line_is_too_wide() {
    let long = r#"["encoder_periodic_error", "depth_dependent_damping", "exponential_stiffening"]"#;
    let text = table::text(
        &[
            run("single", r#"["backlash"]"#, "", "missing_effects", COGGING),
            run("single", r#"["backlash"]"#, "", "no_missing_effect", "[]"),
            run("single", r#"["cogging"]"#, "", "missing_effects", COGGING),
            run("none", "[]", "", "missing_effects", COGGING),
            run("triple", long, "", "unexplained", COGGING),
            run("unknown", r#"["unknown"]"#, "", "unexplained", "[]"),
            run("poor", r#"["time_delay"]"#, "", "ambiguous", LAG_OR_DELAY),
        ],
        true,
    );
    // n, itself, open, null, taken for
    let row = ["backlash", "2", "0", "0", "1", "cogging", "1"];
    assert_eq!(words(&text, "  backlash"), row, "{text}");
    assert!(text.contains("always right: "), "{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= WIDE, "{line}");
    }
}

#[test]
fn two_modes_in_parallel_have_no_order() {
    let text = r#"{"kind": "single", "effects": ["stress_relaxation"],
        "forms": {"stress_relaxation": "catalogue"}, "floor_n": 0.01,
        "params": {"stress_relaxation": {"fraction": 0.1, "rate": 10.0}},
        "base": {"relaxation_fraction_1": 0.4, "relaxation_rate_1": 1.0}}"#;
    let truth = Truth::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let number = |value: f64| (value, 0.1);
    let mut given = answer(
        "missing_effects",
        r#"[{"id": "stress_relaxation", "params": {"fraction": {"value": 0.4, "std_error": 0.1},
            "rate": {"value": 1.1, "std_error": 0.1}}}]"#,
    );
    given
        .base
        .insert("relaxation_fraction_1".into(), number(0.1));
    given.base.insert("relaxation_rate_1".into(), number(9.9));
    let (added, base) = errors(&truth, &given);
    let sizes = added.iter().chain(&base).map(|(_, error)| error.abs());
    assert_eq!(sizes.clone().count(), 4);
    assert!(sizes.fold(0.0, f64::max) < 1.1);
}

#[test]
fn the_bound_on_a_share_is_the_one_of_clopper_and_pearson() {
    // 1 of 10: 0.3942; none of 30: 1 − 0.05^(1/30) = 0.0950; all: 1.
    for (hits, of, upper) in [(1, 10, 0.3942), (0, 30, 0.0950), (5, 5, 1.0)] {
        let found = Share { hits, of }.upper();
        assert!((found - upper).abs() < 1e-4, "{hits} of {of}: {found}");
    }
}

#[test]
fn processor_time_is_that_of_the_whole_process_whatever_it_is_called() {
    let stat = "4711 (a (b) c) S 1 2 3 4 5 6 7 8 9 10 123 27 0 0 20 0 4 0";
    assert_eq!(cpu(stat), Some(1.5));
    assert_eq!(cpu("4711 (a"), None);
}
