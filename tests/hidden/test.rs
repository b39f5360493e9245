//! The rigs with hidden effects are what they say: the same from the same seed, physics that
//! agrees with closed forms, and with the project's own catalogue although they share no code.

mod catalogue;
mod physics;
mod scoring;
mod small;

use tests::hidden::rig::case::{Case, LEAST_RATIO};
use tests::hidden::rig::form;
use tests::hidden::rig::kind::Kind;

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
        // White and coloured; 0.5 % of the floor for what few parameters fit of the noise, and 2 %
        // for what the impact and the finite differences leave.
        let case = Case::generate(Kind::None, 3, index);
        let ratio = case.gap_ratio();
        assert!((0.99..1.02).contains(&ratio), "{case}: {ratio}");
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
        // A few parameters fit 0.1 % of 10 000 samples' noise; 2 kHz in place of 20 kHz leave 1 %.
        assert!(
            (0.99..1.02).contains(&ratio),
            "{id}: {ratio} of {}",
            case.gap_ratio()
        );
    }
}

#[test]
fn another_form_is_still_what_it_is_called() {
    // A progressive spring: drawn on a linear material first, where the base hides its linear part.
    let case = Case::generate(Kind::Mismatched, 1, 20);
    assert_eq!(case.hidden[0].id, "series_compliance");
    let excess = |ratio: f64| ratio * ratio - 1.0;
    let form = case.form_rmse_n.unwrap_or(f64::INFINITY) / case.floor_n;
    assert!(
        excess(form) < 0.5 * excess(case.gap_ratio()),
        "{form} of {}",
        case.gap_ratio()
    );
    // A low-pass of second order that a delay describes as well is called either.
    let either = Case::generate(Kind::Mismatched, 1, 22);
    assert_eq!(either.truth()["accepts"]["force_lag"][0], "time_delay");
}
