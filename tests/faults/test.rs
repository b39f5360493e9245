//! The small fault table against its snapshot, and the rig of it against closed forms.

mod rig;

use std::path::Path;
use tests::faults::rig::{case::Case, fault};
use tests::faults::score::gap::{Worth, asked};
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

/// `cargo run --release -p tests --example faults -- gap` in small: a log of each fault that a sensor or a logger has.
#[test]
fn a_sensors_fault_is_no_missing_effect() {
    let faults = [
        "stuck_adc",
        "stuck_adc_first",
        "stuck_enc",
        "spikes_force",
        "spikes_position",
        "spike_one_position",
        "coarse_adc",
        "enc_jump",
        "enc_jump_air",
        "lost_rows",
        "thinned_rows",
        "jitter_both",
        "late_samples",
        "toggling",
    ];
    for name in faults {
        let fault = fault::named(name).unwrap_or_else(|| panic!("no fault {name}"));
        let severity = if name == "coarse_adc" { 2 } else { 1 };
        let one = asked(&Case::new(fault, severity, 77, 1));
        assert!(
            one.worth == Worth::Right && !one.off,
            "{name}: {}",
            one.label
        );
    }
}

/// Counts of 0.1 mm on a stiff material leave some numbers of the catalogue no room: that was a panic.
#[test]
fn an_encoder_of_five_counts_a_press_is_answered() {
    let fault = fault::named("coarse_enc").unwrap_or_else(|| panic!("no such fault"));
    for index in [3, 7] {
        let one = asked(&Case::new(fault, 2, 1050, index));
        assert!(one.worth != Worth::Refused, "{}", one.label);
    }
}

#[test]
fn what_an_effect_does_is_named_among_faults_as_well() {
    for name in [
        "breathing",
        "adhesion",
        "backlash",
        "creep_slow",
        "saturated",
        "lag",
    ] {
        let fault = fault::named(name).unwrap_or_else(|| panic!("no fault {name}"));
        let one = asked(&Case::new(fault, 1, 77, 1));
        assert!(one.worth == Worth::Right, "{name}: {}", one.label);
    }
}
