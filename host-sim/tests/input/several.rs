//! Several logs with one table, and the ways in which a program asks: JSON, quiet, completions, manuals.

use crate::common::{Folder, MODEL, complained, csv, flowing, press, said};
use serde_json::Value;

/// Two presses of 2 N/mm in `runs`, one more in a folder below, and a file that is no log.
fn runs() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("runs/deeper")).unwrap();
    for name in ["runs/a.csv", "runs/b.csv", "runs/deeper/a.csv"] {
        folder.write(name, csv(press()));
    }
    folder.write("runs/notes.md", "no log");
    folder
}

#[test]
fn a_folder_of_logs_comes_with_one_table_in_every_form() {
    let folder = runs();
    let text = folder.succeeds("estimate runs --out out");
    assert!(text.contains("summary: out/summary.csv"), "{text}");
    let json: Value = serde_json::from_str(&folder.read("out/summary.json")).unwrap();
    let logs = json["logs"].as_array().unwrap();
    assert_eq!(logs.len(), 3);
    for log in logs {
        assert_eq!(log["error"], Value::Null);
        assert!(
            (log["stiffness"].as_f64().unwrap() / 2000.0 - 1.0).abs() < 0.05,
            "{log}"
        );
    }
    let table = folder.read("out/summary.csv");
    assert!(
        table.starts_with("log,status,status_reason,law,stiffness,stiffness_std_error,"),
        "{table}"
    );
    assert_eq!(table.lines().count(), 4);
    for name in ["a", "b", "a-2"] {
        assert!(
            folder.path(&format!("out/{name}/estimate.json")).exists(),
            "{name}"
        );
    }
    let pattern = folder.succeeds("check runs/**/a.csv --out checked");
    assert!(pattern.contains("runs/deeper/a.csv"), "{pattern}");
    assert_eq!(folder.read("checked/summary.csv").lines().count(), 3);
}

#[test]
fn a_log_that_cannot_be_used_does_not_stop_the_others() {
    let folder = runs();
    folder.write("runs/c.csv", "Time (s),Extension (mm),Load\n0,0,0\n");
    let done = folder.palpate("estimate runs --out out");
    assert_eq!(done.status.code(), Some(2));
    let errors = flowing(&complained(&done));
    assert!(
        errors.contains("its unit is not said") && errors.contains("1 of 4 logs cannot be used"),
        "{errors}"
    );
    let json: Value = serde_json::from_str(&folder.read("out/summary.json")).unwrap();
    let failed: Vec<&Value> = json["logs"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|log| log["error"].is_string())
        .collect();
    assert_eq!(failed.len(), 1);
    assert!(folder.path("out/b/estimate.json").exists());
}

#[test]
fn json_is_the_result_alone_and_quiet_is_nothing() {
    let folder = Folder::with("log.csv", csv(press()));
    folder.write("model.toml", MODEL);
    for line in [
        "estimate log.csv --json",
        "estimate log.csv --method batch --json",
        "estimate log.csv log.csv --json",
        "check log.csv --json",
        "simulate --model model.toml --out run --json",
        "gap --plan --model model.toml --json",
        "effects --json",
        "effects coulomb_friction --json",
    ] {
        let text = folder.succeeds(line);
        let json: Result<Value, _> = serde_json::from_str(&text);
        assert!(
            json.is_ok_and(|json| json.is_object() || json.is_array()),
            "{line}: {text}"
        );
        let quiet = line.replace("--json", "--quiet");
        assert_eq!(folder.succeeds(&quiet), "", "{quiet}");
    }
    let same: Value =
        serde_json::from_str(&folder.succeeds("--json estimate log.csv --out out")).unwrap();
    let written: Value = serde_json::from_str(&folder.read("out/estimate.json")).unwrap();
    assert_eq!(same, written);
    let refused = folder.palpate("monitor --port simulated --json");
    assert_eq!(refused.status.code(), Some(2), "{}", complained(&refused));
}

#[test]
fn a_gap_is_as_its_schema_says() {
    let folder = Folder::with("model.toml", MODEL);
    folder.succeeds("simulate --model model.toml --out run");
    folder.succeeds("gap --model model.toml --log run/log.csv --out out");
    folder.succeeds("gap --plan --model model.toml --out plan");
    // The folder compares every JSON file with its schema when it goes.
    assert!(folder.path("out/gap.json").exists() && folder.path("plan/plan.json").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_found_out_before_the_work() {
    let folder = Folder::with("log.csv", csv(press()));
    for line in [
        "estimate log.csv --out log.csv/out",
        "check log.csv --out log.csv/out",
    ] {
        let failed = folder.palpate(line);
        assert_eq!(failed.status.code(), Some(1), "{line}");
        assert_eq!(said(&failed), "", "{line}");
        assert!(
            complained(&failed).starts_with("error: cannot write log.csv/out/"),
            "{line}"
        );
    }
}

#[test]
fn shells_and_readers_of_manuals_get_theirs() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let text = folder.succeeds(&format!("completions {shell}"));
        assert!(text.contains("trace-column"), "{shell}");
    }
    folder.succeeds("man --out man1");
    assert!(folder.read("man1/palpate-estimate.1").contains("segment"));
    assert!(folder.succeeds("--version").starts_with("palpate "));
}

#[test]
fn an_estimate_in_mcap_is_a_log_again() {
    let folder = Folder::with("log.csv", csv(press()));
    folder.succeeds("estimate log.csv --out out --mcap");
    let first: Value = serde_json::from_str(&folder.read("out/estimate.json")).unwrap();
    let again = folder.palpate("estimate out/estimate.mcap --json");
    let again: Value = serde_json::from_str(&said(&again)).unwrap();
    assert_eq!(again["parameters"], first["parameters"]);
}

#[test]
#[cfg(unix)]
fn ctrl_c_ends_a_verb_with_the_status_that_shells_expect() {
    use std::io::Write;
    let folder = Folder::new();
    let mut command = folder.command(&["check", "-"]);
    let mut child = command.stdin(std::process::Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    // More than a pipe holds: whoever takes it is past its beginning.
    input.write_all(&vec![b'\n'; 1 << 20]).unwrap();
    let pressed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(pressed.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
