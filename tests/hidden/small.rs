//! The whole workflow on short rigs, with at least one for each kind of answer. The scorer of the full
//! table judges them; nothing else knows what is hidden.

use palpate::gap::Options;
use std::path::{Path, PathBuf};
use tests::hidden::rig::case::{Case, LEAST_RATIO};
use tests::hidden::rig::kind::Kind;
use tests::hidden::score::further;
use tests::hidden::score::judge::{Mark, errors};
use tests::hidden::score::library;
use tests::hidden::score::scored::Scored;
use tests::tolerance;

/// The seed of all rigs.
const SEED: u64 = 1;

/// Indices into the catalogue.
const COULOMB: u64 = 10;
const DRIFT: u64 = 16;
/// Together with a buried layer.
const COULOMB_OF_TWO: u64 = 10;
/// An index into the list for poor excitation.
const LAG_UNDER_A_SLOW_SINE: u64 = 0;
/// An index into the misfits that are in no catalogue.
const RINGING: u64 = 6;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("hidden-{name}"))
}

/// Writes the rig `index` of a kind to files, and scores the answer to them.
fn scored(kind: Kind, index: u64) -> Scored {
    let folder = folder(&format!("{}-{index}", kind.name()));
    let written = Case::brief(kind, SEED, index).save(&folder);
    written.unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    library::score(&folder, &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The answer names exactly what is hidden, is adequate, and is at the floor on the held-out part.
fn exactly_right(one: &Scored) {
    assert_eq!(one.mark(), Mark::Exact, "{:?}", one.answer);
    assert!(
        tolerance::EXPLAINED.contains(&one.ratio()),
        "{}",
        one.ratio()
    );
}

/// No estimate is far from the truth; gives the number of those that were compared.
fn within_its_intervals(one: &Scored) -> usize {
    let answer = one.answer.as_ref().unwrap_or_else(|e| panic!("{e}"));
    let (added, base) = errors(&one.truth, answer);
    for (name, error) in added.iter().chain(&base) {
        assert!(
            error.abs() < tolerance::FAR,
            "{name} is {error} standard errors off"
        );
    }
    added.len()
}

#[test]
fn one_effect_in_the_catalogues_form_is_named_alone_with_its_parameters() {
    let one = scored(Kind::Single, COULOMB);
    exactly_right(&one);
    assert!(within_its_intervals(&one) > 0);
}

#[test]
fn one_effect_in_another_form_is_named_alone() {
    exactly_right(&scored(Kind::Mismatched, DRIFT));
}

#[test]
fn each_effect_that_measured_machines_asked_for_is_named_or_left_open_and_nothing_else_is() {
    // 14 of 14 brief rigs of this seed were so, 13 of them named alone: a friction that grows with the load is left
    // open where it stands in 1.13 floors.
    let mut exact = 0;
    for index in 0..7 {
        let one = scored(Kind::Machine, index);
        assert!(
            [Mark::Exact, Mark::InGroup].contains(&one.mark()),
            "{index}: {:?}",
            one.answer
        );
        exact += usize::from(one.mark() == Mark::Exact);
    }
    assert!(exact >= 6, "{exact}");
}

#[test]
fn of_two_effects_both_and_only_both_are_named() {
    let pair = scored(Kind::Pair, COULOMB_OF_TWO);
    exactly_right(&pair);
    assert!(within_its_intervals(&pair) > 3);
}

#[test]
fn where_nothing_is_hidden_nothing_is_missing_whatever_the_noise() {
    let mut noises = Vec::new();
    for index in 0..6 {
        let one = scored(Kind::None, index);
        assert_eq!(
            one.mark(),
            Mark::Exact,
            "{}: {:?}",
            one.truth.noise,
            one.answer
        );
        assert!(
            tolerance::NOTHING_HIDDEN.contains(&one.ratio()),
            "{}",
            one.ratio()
        );
        noises.push(one.truth.noise);
    }
    let coloured = noises.iter().filter(|noise| *noise != "white").count();
    assert_eq!(coloured, 3, "{noises:?}");
}

#[test]
fn what_is_in_no_catalogue_is_unexplained_and_has_no_name() {
    let one = scored(Kind::Unknown, RINGING);
    assert_eq!(one.mark(), Mark::Exact, "{:?}", one.answer);
    assert!(one.ratio() > LEAST_RATIO, "{}", one.ratio());
}

#[test]
fn one_slow_sine_leaves_the_right_group_open_at_most() {
    let one = scored(Kind::Poor, LAG_UNDER_A_SLOW_SINE);
    assert!(
        [Mark::Exact, Mark::InGroup].contains(&one.mark()),
        "{:?}",
        one.answer
    );
    // Lag, delay, a soft tip: a group of all effects would hold the right name, too.
    let group = one.answer.map_or(0, |answer| answer.group());
    assert!((1..=3).contains(&group), "{group} names");
}

/// A motion as `gap` writes it to OUT/motion.toml.
const MOTION: &str = "start = -0.001\n\
    [[segment]]\nkind = \"hold\"\nseconds = 1.5\n\
    [[segment]]\nkind = \"ramp\"\nto = 0.001\nspeed = 0.01\n\
    [[segment]]\nkind = \"hold\"\nseconds = 0.5\n";

/// The rows of a log.
fn rows(path: &Path) -> Vec<[f64; 3]> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let row = |line: &str| -> [f64; 3] {
        let mut cells = line.split(',').filter_map(|cell| cell.parse().ok());
        std::array::from_fn(|_| cells.next().unwrap_or(f64::NAN))
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_rig_that_is_recorded_again_follows_the_motion_and_is_the_same_rig() {
    let case = Case::brief(Kind::Poor, SEED, 3);
    let (rig, out) = (folder("again"), folder("again-out"));
    let write = |path: PathBuf, text: &str| std::fs::write(path, text);
    let made = case
        .save(&rig)
        .and_then(|()| std::fs::create_dir_all(&out))
        .and_then(|()| write(out.join("motion.toml"), MOTION));
    made.unwrap_or_else(|e| panic!("{e}"));
    let record = || further::record(&rig, &out.join("motion.toml"), &out);
    let log = record().unwrap_or_else(|e| panic!("{e}"));
    let rows = rows(&log);
    // 1.5 s, 2 mm at 10 mm/s with its blend, 0.5 s, at 100 Hz.
    assert!((2.2..2.24).contains(&rows[rows.len() - 1][0]));
    // A motor of 18 Hz and more has arrived after half a second; a count is 1 µm.
    let end = rows[rows.len() - 1];
    assert!((rows[0][1] + 1e-3).abs() < 1.1e-6 && (end[1] - 1e-3).abs() < 1.1e-6);
    // At rest in free air there is the noise of the first log alone: 150 samples tell it to 6 %.
    let free: Vec<f64> = rows.iter().take(150).map(|row| row[2]).collect();
    let noise_n = tests::hidden::rig::fit::rms(&free);
    assert!(
        (0.75..1.3).contains(&(noise_n / case.floor_n)),
        "{noise_n} N of {} N",
        case.floor_n
    );
    assert!(end[2] > 20.0 * noise_n, "in contact: {} N", end[2]);
    // Beside the log of another rig nothing is recorded.
    let other = write(rig.join("measured.csv"), "t_s,x_m,f_n\n");
    assert!(other.is_ok() && record().is_err_and(|e| e.contains("another generator")));
}
