//! `gap` on logs that it cannot use, or that look wrong: refused with a remedy, or fitted with a note.
//! The fits alone would give a verdict on any of them.

use crate::common::{Folder, complained, csv, flowing, press, said};
use std::process::Output;

const BASE: &str = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1800.0\ndamping = 1.0\n";
const FREE: &str = "[environment]\nlaw = \"free\"\n";

fn gap(model: &str, log: String) -> (Folder, Output) {
    let folder = Folder::with("base.toml", model);
    folder.write("log.csv", log);
    let done = folder.palpate("gap --model base.toml --log log.csv --out out");
    (folder, done)
}

fn assert_refused(case: &str, model: &str, log: String, words: &[&str]) {
    let (folder, done) = gap(model, log);
    let text = complained(&done);
    assert_eq!(done.status.code(), Some(2), "{case}: {text}{}", said(&done));
    assert_eq!(said(&done), "", "{case}");
    assert!(!folder.path("out").exists(), "{case}: something is written");
    let text = flowing(&text);
    for word in ["log.csv", "remedy: "].iter().chain(words) {
        assert!(text.contains(word), "{case}: no `{word}` in {text}");
    }
}

fn changed(change: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    csv(press().into_iter().map(change))
}

#[test]
fn a_log_that_nothing_can_be_fitted_to_is_refused_with_a_remedy() {
    let noise = |f: f64, x: f64| f - 2000.0 * x.max(0.0);
    let nan = csv(press()).replacen("\n0.015,", "\n0.015,nan,0\n0.0155,", 1);
    #[rustfmt::skip]
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("still position", changed(|[t, _, f]| [t, 1e-3, f]),  &["the position never changes by more than its noise", "--columns x=NAME"]),
        ("still force",    changed(|[t, x, _]| [t, x, 0.25]),  &["the force is 250 mN all the time", "--columns f=NAME"]),
        ("no contact",     changed(|[t, x, f]| [t, x, noise(f, x)]), &["nothing is touched", "law = \"free\""]),
        ("a few samples",  csv(press().into_iter().take(150)), &["150 samples, fewer than 192", "record longer"]),
        ("shorter than the filter", csv(press().into_iter().take(20)), &["20 samples", "record longer"]),
        ("NaN",            nan,                                &["not finite", "log.csv:17, column x_m", "--skip-bad-rows"]),
        ("exchanged",      changed(|[t, x, f]| [t, f, x]),     &["position and force may be exchanged", "--columns x=f_n,f=x_m"]),
    ];
    for (case, log, words) in cases {
        assert_refused(case, BASE, log, words);
    }
}

#[test]
fn motion_in_free_air_needs_no_contact_under_a_free_model() {
    let air = changed(|[t, x, f]| [t, x, f - 2000.0 * x.max(0.0)]);
    let (_, done) = gap(FREE, air);
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    assert!(
        said(&done).starts_with("nothing is missing"),
        "{}",
        said(&done)
    );
}

#[test]
fn units_and_signs_that_look_wrong_are_noted_first_and_in_every_file() {
    #[rustfmt::skip]
    let cases: [(&str, String, &[&str]); 3] = [
        ("millimetres",  changed(|[t, x, f]| [t, 1e3 * x, f]), &["millimetres or micrometres given as metres? (--columns x=x_m*1e-3)", "the fitted stiffness is 2.0"]),
        ("milliseconds", changed(|[t, x, f]| [1e3 * t, x, f]), &["milliseconds given as seconds? (--columns t=t_s*1e-3)"]),
        ("sign",         changed(|[t, x, f]| [t, x, -f]),      &["its sign, or that of the position, may be reversed (--columns f=-f_n or x=-x_m)"]),
    ];
    for (case, log, words) in cases {
        let (folder, done) = gap(BASE, log);
        assert_eq!(done.status.code(), Some(0), "{case}: {}", complained(&done));
        let text = said(&done);
        assert!(
            text.lines()
                .nth(1)
                .is_some_and(|line| line.starts_with("  note")),
            "{case}: {text}"
        );
        let json = folder.read("out/gap.json");
        for word in words {
            assert!(
                flowing(&text).contains(word),
                "{case}: no `{word}` in {text}"
            );
            assert!(
                flowing(&json).contains(word),
                "{case}: no `{word}` in {json}"
            );
        }
    }
}

#[test]
fn a_good_log_has_no_notes() {
    let (folder, done) = gap(BASE, csv(press()));
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let json: serde_json::Value = serde_json::from_str(&folder.read("out/gap.json")).unwrap();
    assert_eq!(json["notes"], serde_json::json!([]), "{json}");
    assert_eq!(json["verdict"], "no_missing_effect", "{}", said(&done));
}

#[test]
fn a_load_cell_that_hangs_is_left_out_and_nothing_is_missing() {
    // GIVEN a force that hangs where the press is steepest, and in free air, 60 ms each
    let samples = press();
    let period_s = samples[1][0] - samples[0][0];
    let count = (0.06 / period_s) as usize;
    let steepest = (1..samples.len())
        .max_by(|a, b| {
            let rise = |at: &usize| samples[*at][2] - samples[at - 1][2];
            rise(a).total_cmp(&rise(b))
        })
        .unwrap();
    for from in [10, steepest] {
        let mut hung = samples.clone();
        for row in &mut hung[from..from + count] {
            row[2] = samples[from][2];
        }
        let (_, done) = gap(BASE, csv(hung));
        let text = said(&done);
        assert!(text.starts_with("nothing is missing"), "{from}: {text}");
        assert!(text.contains("hangs, it does not change at all"), "{text}");
    }
}

#[test]
fn a_model_is_asked_behind_the_low_pass_that_it_was_identified_behind_and_none_is_above_half_the_rate()
 {
    // GIVEN a model that left 20 mN behind a low-pass of 40 Hz, beside a tenth of the log's noise there
    let left = "[remainder]\nrms = 0.02\nnoise = 0.0001\ncorrelation_time = 0.05\nbandwidth = 40\n";
    let (folder, done) = gap(&format!("{BASE}{left}"), csv(press()));
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let text = flowing(&said(&done));
    assert!(
        text.contains("the forces pass a low-pass of 40 Hz, as when"),
        "{text}"
    );
    assert!(
        text.contains("times what it was when the model was identified"),
        "{text}"
    );
    // WHEN it is asked behind another one, THEN that is said,
    let other = folder.palpate("gap --log log.csv --model base.toml --out other --bandwidth 30");
    let text = flowing(&said(&other));
    assert!(
        text.contains("behind a low-pass of 40 Hz, and not behind 30 Hz"),
        "{text}"
    );
    // AND one that takes nothing away, or all of it, is refused with what would be right.
    for (hz, right) in [
        ("1e9", "give less than 500 Hz"),
        ("0.01", "give more than "),
    ] {
        let with = format!("gap --log log.csv --model base.toml --out refused --bandwidth {hz}");
        let refused = folder.palpate(&with);
        assert_eq!(refused.status.code(), Some(2));
        let text = flowing(&complained(&refused));
        assert!(text.contains(right), "{text}");
    }
}
