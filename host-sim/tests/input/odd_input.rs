//! Logs that can be read but hold a mistake: the estimate is honest, and a note names the mistake.

use crate::common::{Folder, complained, csv, flowing, press, said};

/// What a rig records by mistake, and the words that `estimate` and `check` have to say about it.
#[rustfmt::skip]
fn odd_logs() -> Vec<(&'static str, String, &'static str, &'static str)> {
    let changed = |change: fn([f64; 3]) -> [f64; 3]| csv(press().into_iter().map(change));
    // A force without touch: what is left of the noise above rest and below it.
    let untouched = |[t, x, f]: [f64; 3]| [t, x, f - 2000.0 * x.max(0.0)];
    let hum = |[t, x, f]: [f64; 3]| [t, x, f - 2000.0 * x.max(0.0) + 0.05 * (314.16 * t).sin()];
    vec![
        // what is odd, the file, the status, what both verbs say
        ("nothing touched",   changed(untouched),            "no_contact",   "no contact"),
        ("hum and no touch",  changed(hum),                  "no_contact",   "no contact"),
        ("no force",          changed(|[t, x, _]| [t, x, 0.0]), "no_contact", "the force never changes: another column may hold it (--columns f=NAME)"),
        ("no motion",         changed(|[t, _, f]| [t, 0.0, f]), "unobservable", "the position never changes: another column may hold it (--columns x=NAME)"),
        ("swapped columns",   changed(|[t, x, f]| [t, f, x]), "no trust",   "position and force may be exchanged (--columns x=f_n,f=x_m)"),
        ("millimetres",       changed(|[t, x, f]| [t, x * 1e3, f]), "any",   "millimetres or micrometres given as metres? (--columns x=x_m*1e-3)"),
        ("milliseconds",      changed(|[t, x, f]| [t * 1e3, x, f]), "no trust", "milliseconds given as seconds? (--columns t=t_s*1e-3)"),
        ("a spike",           spiked(1.0),                   "any",          "force is no usable number or a spike, sample dropped (at 1.00"),
        ("force sign",        changed(|[t, x, f]| [t, x, -f]), "no_contact", "its sign, or that of the position, may be reversed (--columns f=-f_n or x=-x_m)"),
    ]
}

#[test]
fn an_odd_log_is_estimated_honestly_and_both_verbs_say_what_is_odd() {
    for (case, content, status, words) in odd_logs() {
        let folder = Folder::with("log.csv", content);
        let done = folder.palpate("estimate log.csv --out out");
        assert_eq!(done.status.code(), Some(0), "{case}: {}", complained(&done));
        let json: serde_json::Value =
            serde_json::from_str(&folder.read("out/estimate.json")).unwrap();
        match status {
            // A spring in other units is a spring.
            "any" => {}
            "no trust" => assert_ne!(json["status"], "converged", "{case}"),
            status => assert_eq!(json["status"], status, "{case}"),
        }
        if status == "no_contact" {
            assert_eq!(
                json["parameters"]["stiffness"],
                serde_json::Value::Null,
                "{case}"
            );
            assert_eq!(json["touches"], serde_json::json!([]), "{case}");
        }
        // Whatever is not trusted says in a sentence why, and what to do.
        if let Some(reason) = json["status_reason"].as_str() {
            let (text, lead) = (said(&done), format!("\n  {reason}: "));
            assert!(text.contains(&lead), "{case}: no `{lead}` in {text}");
        }
        for said in [said(&done), said(&folder.palpate("check log.csv"))] {
            assert!(
                flowing(&said).contains(words),
                "{case}: no `{words}` in {said}"
            );
        }
    }
}

/// The press with 5 N more at one instant (s).
fn spiked(at_s: f64) -> String {
    let spike = |[t, x, f]: [f64; 3]| [t, x, f + if (t - at_s).abs() < 2e-4 { 5.0 } else { 0.0 }];
    csv(press().into_iter().map(spike))
}

#[test]
fn a_spike_at_the_peak_of_a_touch_is_not_its_peak() {
    // GIVEN 3 mm on 2 N/mm, deepest at 0.8 s
    let folder = Folder::with("log.csv", spiked(0.8));
    let done = folder.palpate("check log.csv --out out");
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    let json: serde_json::Value = serde_json::from_str(&folder.read("out/check.json")).unwrap();
    let peak_n = json["touches"][0]["peak_force_n"].as_f64().unwrap();
    assert!((peak_n - 6.0).abs() < 0.05, "{peak_n} N");
}

#[test]
fn check_holds_the_faults_that_an_estimate_holds() {
    let folder = Folder::with("log.csv", spiked(1.0));
    let events = |verb: &str| -> Vec<serde_json::Value> {
        let done = folder.palpate(&format!("{verb} log.csv --out {verb}"));
        assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
        let json: serde_json::Value =
            serde_json::from_str(&folder.read(&format!("{verb}/{verb}.json"))).unwrap();
        let events = json["events"].as_array().unwrap().iter();
        let faults = events.filter(|event| event["kind"] == "fault");
        faults.cloned().collect()
    };
    let faults = events("check");
    assert_eq!(faults, events("estimate"));
    assert!(
        faults.len() == 1 && faults[0]["name"] == "force_unusable",
        "{faults:?}"
    );
}

#[test]
fn a_good_log_raises_no_suspicion_however_it_is_written() {
    let good = csv(press());
    let semicolons = good.replace(',', ";").replace('.', ",");
    let milli = csv(press().into_iter().map(|[t, x, f]| [t * 1e3, x * 1e3, -f])).replacen(
        "t_s,x_m,f_n",
        "Time [ms],Pos (mm),Fz",
        1,
    );
    let folder = Folder::new();
    folder.write("good.csv", &good);
    folder.write("semicolons.csv", semicolons);
    folder.write("milli.csv", milli);
    let columns = "t=Time [ms]*1e-3,x=Pos (mm)*1e-3,f=-Fz";
    for arguments in [
        &["check", "good.csv"][..],
        &["check", "semicolons.csv"],
        &["check", "milli.csv", "--columns", columns],
    ] {
        let done = folder.command(arguments).output().unwrap();
        let text = said(&done);
        assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
        assert!(!text.contains("  ! "), "{text}");
        assert!(text.contains("touches   2"), "{text}");
    }
}
