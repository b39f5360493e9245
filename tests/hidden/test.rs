//! Tests of the rigs with hidden effects: the same seed gives the same rig, and its physics agrees with
//! closed forms and with the project's catalogue, with which it shares no code. Then the scorer, and the
//! whole workflow on short rigs.

mod catalogue;
mod harder;
mod injected;
mod physics;
mod scoring;
mod small;
mod sweeping;

use std::path::Path;
use tests::hidden::rig::case::{Case, LEAST_RATIO};
use tests::hidden::rig::form;
use tests::hidden::rig::kind::Kind;
use tests::tolerance::BEST_FIT;

#[test]
fn the_generator_uses_no_code_of_the_project_and_not_the_scorer() {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src/hidden/rig")];
    let mut read = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            read += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| !line.trim().starts_with("//"));
            for line in code {
                for foreign in ["estimator_core", "palpate::", "crate::", "score::"] {
                    assert!(!line.contains(foreign), "{}: {line}", path.display());
                }
            }
        }
    }
    assert!(read > 15, "{read} files");
}

#[test]
fn the_same_seed_gives_the_same_files_and_another_one_others() {
    let files = |seed| {
        let case = Case::generate(Kind::Mismatched, seed, 11);
        (case.base_toml(), case.csv(), case.truth().to_string())
    };
    let first = files(7);
    assert_eq!(first, files(7));
    let other = files(8);
    assert_ne!(first.1, other.1);
    assert_ne!(first.2, other.2);
}

#[test]
fn a_best_fit_of_the_base_leaves_a_hidden_effect_and_nothing_else() {
    for (kind, index) in [
        (Kind::Single, 5),
        (Kind::Pair, 3),
        (Kind::Unknown, 0),
        (Kind::Poor, 2),
    ] {
        let case = Case::generate(kind, 3, index);
        assert!(
            case.gap_ratio() >= LEAST_RATIO,
            "{kind:?}: {}",
            case.gap_ratio()
        );
    }
    for index in 0..4 {
        // The noise is white and coloured in turn.
        let case = Case::generate(Kind::None, 3, index);
        let ratio = case.gap_ratio();
        assert!(BEST_FIT.contains(&ratio), "{case}: {ratio}");
    }
}

#[test]
fn the_files_hold_what_the_rig_did() {
    let case = Case::generate(Kind::Single, 3, 10);
    assert!(
        case.base_toml().starts_with("[environment]\nlaw = "),
        "{}",
        case.base_toml()
    );
    assert!(
        case.base_toml().ends_with("surface = 0.0\n"),
        "{}",
        case.base_toml()
    );
    let csv = case.csv();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("t_s,x_m,f_n"));
    assert_eq!(lines.clone().count(), case.rows.len());
    for (line, row) in lines.zip(&case.rows) {
        let read: Vec<f64> = line
            .split(',')
            .filter_map(|text| text.parse().ok())
            .collect();
        // Half a digit of what is written: 1 ms, 1 µm, 1 mN.
        for ((read, row), half) in read.iter().zip(row).zip([5e-4, 5e-7, 5e-4]) {
            assert!((read - row).abs() < half, "{line}: {row:e}");
        }
    }
    let truth = case.truth();
    assert_eq!(truth["effects"][0], "coulomb_friction");
    assert!(truth["params"]["coulomb_friction"]["force"].as_f64() > Some(0.0));
}

#[test]
fn base_and_effect_fitted_together_leave_the_noise_alone() {
    for (index, id) in [
        (0, "stress_relaxation"),
        (10, "coulomb_friction"),
        (18, "cogging"),
    ] {
        let case = Case::generate(Kind::Single, 4, index);
        assert_eq!(case.hidden[0].id, id);
        let ratio = form::best_rmse_n(&case, &case.hidden[0]) / case.floor_n;
        assert!(
            BEST_FIT.contains(&ratio),
            "{id}: {ratio} of {}",
            case.gap_ratio()
        );
    }
}

#[test]
fn another_form_is_still_what_it_is_called() {
    // A progressive spring. On a linear material the base would hide its linear part.
    let case = Case::generate(Kind::Mismatched, 1, 20);
    assert_eq!(case.hidden[0].id, "series_compliance");
    let excess = |ratio: f64| ratio * ratio - 1.0;
    let form = case.form_rmse_n.unwrap_or(f64::INFINITY) / case.floor_n;
    assert!(
        excess(form) < 0.5 * excess(case.gap_ratio()),
        "{form} of {}",
        case.gap_ratio()
    );
    // A low-pass of second order that a delay describes as well may have either name.
    let either = Case::generate(Kind::Mismatched, 1, 22);
    assert_eq!(either.truth()["accepts"]["force_lag"][0], "time_delay");
}
