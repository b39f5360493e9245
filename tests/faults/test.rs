//! The small fault table against its snapshot, and the rig of it against closed forms.

mod rig;

use std::path::Path;
use tests::faults::score::snapshot;

/// Set to 1, the table of this run becomes the snapshot.
const ACCEPT: &str = "FAULTS_ACCEPT";

/// Any change of an outcome fails, for the better as well: a table that is not looked at is none.
#[test]
fn every_fault_ends_as_in_the_snapshot() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("faults/snapshot.txt");
    let table = snapshot::text();
    if std::env::var(ACCEPT).is_ok_and(|value| value == "1") {
        std::fs::write(&path, &table).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    let (old, new): (Vec<&str>, Vec<&str>) = (kept.lines().collect(), table.lines().collect());
    let gone = old.iter().filter(|line| !new.contains(line));
    let come = new.iter().filter(|line| !old.contains(line));
    let changes: Vec<String> = gone
        .map(|line| format!("- {line}"))
        .chain(come.map(|line| format!("+ {line}")))
        .collect();
    assert!(
        kept == table,
        "outcomes differ from faults/snapshot.txt:\n{}\nIf they should: {ACCEPT}=1 cargo test -p tests --test faults",
        changes.join("\n")
    );
}
