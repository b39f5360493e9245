//! The sweep of a threshold: every threshold can be named, is read somewhere, and changes answers.

use palpate::gap::Options;
use palpate::gap::thresholds::Thresholds;
use palpate::threshold::Adjustable;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use tests::hidden::rig::case::Case;
use tests::hidden::rig::kind::Kind;
use tests::hidden::score::judge::Mark;
use tests::hidden::score::{library, sweep};

/// Coulomb friction, as in `small`: named exactly with the default thresholds.
const FRICTION: (Kind, u64, u64) = (Kind::Single, 1, 10);

fn friction(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("hidden-sweep-{name}"));
    let (kind, seed, index) = FRICTION;
    Case::brief(kind, seed, index).save(&folder).unwrap();
    folder
}

/// The text of the sources of the gap workflow, without the thresholds themselves.
fn sources(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| !path.ends_with("thresholds.rs"))
        .map(|path| match path.is_dir() {
            true => sources(&path),
            false => std::fs::read_to_string(&path).unwrap(),
        })
        .collect()
}

#[test]
fn every_threshold_has_a_name_of_its_own_a_default_and_a_reason_that_says_how_it_was_found() {
    let names = sweep::names();
    let different: BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(different.len(), names.len());
    // A field that `all` forgets would still be in the text of the struct.
    let shown = format!("{:?}", Thresholds::default());
    let numbers = shown
        .split(": ")
        .filter(|part| part.starts_with(|c: char| c.is_ascii_digit()));
    assert_eq!(numbers.count(), names.len(), "{shown}");
    for own in Thresholds::default().all() {
        let found = own.reason.contains("Not measured") || own.reason.contains("Derived: ");
        let measured = own.reason.chars().any(|c| c.is_ascii_digit());
        let sentence = own.reason.ends_with('.');
        assert!(
            (found || measured) && sentence,
            "{}: {}",
            own.name,
            own.reason
        );
        assert!(sweep::list().contains(&format!("{} = {}\n", own.name, own.value)));
    }
}

#[test]
fn every_threshold_is_read_where_something_is_decided() {
    let gap = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/src/gap");
    let read = |path: PathBuf| std::fs::read_to_string(path).unwrap();
    let declared = read(gap.join("thresholds.rs"));
    // A method of the thresholds reads two of them.
    let (_, methods) = declared.split_once("\nimpl ").unwrap();
    let text = sources(&gap) + &read(gap.with_extension("rs")) + methods;
    for name in sweep::names() {
        let (_, field) = name.split_once('.').unwrap();
        let read = text.match_indices(&format!(".{field}")).any(|(at, found)| {
            let next = text[at + found.len()..].chars().next();
            next.is_some_and(|c| !c.is_alphanumeric() && c != '_')
        });
        assert!(read, "{name} decides nothing");
    }
}

#[test]
fn a_name_that_no_threshold_has_is_answered_with_the_nearest() {
    let error = sweep::known("explained.residual").unwrap_err();
    assert!(error.contains("write \"explained.residuals\""), "{error}");
    let error = sweep::known("size_sigma").unwrap_err();
    assert!(
        error.contains("write \"acceptance.size_sigmas\""),
        "{error}"
    );
    assert!(sweep::known("significance.chi2").is_ok());
}

#[test]
fn a_threshold_that_is_set_changes_the_answer() {
    let rig = friction("set");
    let mut options = Options::default();
    assert_eq!(library::score(&rig, &options).unwrap().mark(), Mark::Exact);
    // WHEN no effect takes enough off to be significant, THEN the friction has no name.
    options.thresholds.set("significance.chi2", 1e9).unwrap();
    let mark = library::score(&rig, &options).unwrap().mark();
    assert!([Mark::Doubtful, Mark::Missed].contains(&mark), "{mark:?}");
}

#[test]
fn a_sweep_scores_three_values_and_says_what_each_changes() {
    let text = sweep::text("significance.chi2", &[friction("table")], 1).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with("single"))
        .map(|line| line.split_whitespace().collect())
        .collect();
    let values: Vec<&str> = rows.iter().map(|row| row[row.len() - 9]).collect();
    assert_eq!(values, ["18.7500", "25.0000", "31.2500"], "{text}");
    // One friction, far beyond any of the three: right and alone, right or open, and nothing else.
    for row in rows {
        assert_eq!(
            row[row.len() - 8..],
            ["1", "1", "1", "0", "0", "0", "0", "0"]
        );
    }
    let folder = friction("marks");
    let with = |factor: f64| {
        let mut options = Options::default();
        options.thresholds.set("significance.chi2", factor).unwrap();
        vec![library::score(&folder, &options).unwrap()]
    };
    // In a line: none becomes right, none ceases to be.
    let (usual, rig) = (with(1.0), [friction("line")]);
    let line = sweep::row("significance.chi2", &usual, &rig, 1).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[1..], ["25", "0", "0", "+0", "0", "0", "+0"], "{line}");
    assert!(sweep::heading(&usual).starts_with("1 rigs, 1 of them right"));
    // What ceases to be right is counted at once.
    let other = sweep::row("significance.chi2", &with(1e9), &rig, 1).unwrap();
    let words: Vec<&str> = other.split_whitespace().collect();
    assert_eq!(words[2..4], ["1", "0"], "{other}");
    // Where the answers differ the rig is named with both marks.
    let text = sweep::table(
        "chi2",
        &[("0", 25.0, with(1.0)), ("+25 %", 2.5e10, with(1e9))],
    );
    assert!(text.contains("hidden-sweep-marks: Exact → "), "{text}");
}
