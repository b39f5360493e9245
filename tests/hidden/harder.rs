//! Harder rigs: what sensors and sampling do to a log, and that the harder kinds exist.

use palpate::gap::Options;
use std::collections::BTreeSet;
use std::path::Path;
use tests::hidden::rig::case::{Case, LEAST_RATIO};
use tests::hidden::rig::fit::rms;
use tests::hidden::rig::harder::{GROUPS, Group, Rig};
use tests::hidden::rig::kind::Kind;
use tests::hidden::rig::motion::{FINE_HZ, Profile, Track};
use tests::hidden::rig::random::Random;
use tests::hidden::score::judge::Mark;
use tests::hidden::score::library;
use tests::hidden::score::truth::Truth;

const SEED: u64 = 1;

fn group(name: &str) -> &'static Group {
    let found = GROUPS.iter().find(|group| group.name == name);
    found.unwrap_or_else(|| panic!("{name} is no group"))
}

/// The rows of a rig's file.
fn rows(rig: &Rig) -> Vec<[f64; 3]> {
    let row = |line: &str| -> [f64; 3] {
        let mut cells = line.split(',').filter_map(|cell| cell.parse().ok());
        std::array::from_fn(|_| cells.next().unwrap_or(f64::NAN))
    };
    rig.csv().lines().skip(1).map(row).collect()
}

fn steps(rows: &[[f64; 3]]) -> Vec<f64> {
    rows.windows(2)
        .map(|pair| pair[1][0] - pair[0][0])
        .collect()
}

#[test]
fn the_same_seed_gives_the_same_harder_rig_and_its_truth_is_read() {
    let draw = || Rig::draw(group("none"), SEED, 1);
    let (first, second) = (draw(), draw());
    assert_eq!(first.csv(), second.csv());
    assert_ne!(first.csv(), Rig::draw(group("none"), SEED + 1, 1).csv());
    let truth = Truth::parse(&first.truth().to_string()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        (truth.kind.as_str(), truth.label.as_str()),
        ("none", "none")
    );
}

#[test]
fn noise_behind_a_filter_is_no_missing_effect() {
    // GIVEN noise behind corners of 10 to 100 Hz, of which second differences see a twentieth to a third
    for name in ["filtered", "filtered, no rest"] {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("hidden-{name}"));
        let written = Rig::draw(group(name), SEED, 3).save(&folder);
        written.unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        // THEN nothing is missing.
        let one = library::score(&folder, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(one.mark(), Mark::Exact, "{name}: {:?}", one.answer);
    }
}

#[test]
fn only_what_a_row_is_about_is_wrong_with_its_sampling() {
    let nominal = 1e-3;
    let counted = |name: &str| {
        let rows = rows(&Rig::draw(group(name), SEED, 0));
        let steps = steps(&rows);
        assert!(
            steps.iter().all(|step| *step > 0.0),
            "{name}: time runs backward"
        );
        let span_s = rows[rows.len() - 1][0] - rows[0][0];
        (rows.len() as f64 / (span_s / nominal), steps)
    };
    let (there, steps) = counted("drops 2 %");
    // 400 of 20 000: three standard deviations of a binomial are 0.3 %.
    assert!((0.977..0.983).contains(&there), "{there}");
    assert!(
        steps
            .iter()
            .all(|step| (step / nominal - (step / nominal).round()).abs() < 1e-6)
    );
    let (there, steps) = counted("stamps off 20 µs");
    let off: Vec<f64> = steps.iter().map(|step| step - nominal).collect();
    // Of a difference of two stamps.
    let off_s = rms(&off) / 2f64.sqrt();
    assert!(
        there > 0.999 && (19e-6..21e-6).contains(&off_s),
        "{off_s} s"
    );
    let (there, steps) = counted("uneven 50 µs, unseen");
    assert!(there > 0.999 && steps.iter().all(|step| (step - nominal).abs() < 1.1e-6));
    let (there, steps) = counted("thinned holds");
    let longest_s = steps.iter().copied().fold(0.0, f64::max);
    // A hold of 0.7 s and more is thinned to a thirtieth of its age.
    assert!(
        there < 0.95 && (0.018..0.15).contains(&longest_s),
        "{there} {longest_s} s"
    );
}

#[test]
fn a_slow_machine_is_slow_in_its_file() {
    let rows = rows(&Rig::draw(group("rate 10 Hz"), SEED, 0));
    let steps = steps(&rows);
    assert!(steps.iter().all(|step| (step - 0.1).abs() < 1e-5));
    assert!(
        rows[rows.len() - 1][0] > 100.0,
        "a slow machine's log lasts minutes"
    );
}

#[test]
fn every_foreign_form_and_at_least_sixteen_unknown_kinds_can_be_drawn_and_show() {
    let drawn = |kind, count: u64| -> BTreeSet<String> {
        let label = |index| {
            let case = Case::brief(kind, SEED, index);
            assert!(case.gap_ratio() >= LEAST_RATIO, "{case}");
            let truth = Truth::parse(&case.truth().to_string());
            truth.unwrap_or_else(|e| panic!("{e}")).label
        };
        (0..count).map(label).collect()
    };
    assert_eq!(drawn(Kind::Foreign, 15).len(), 15);
    assert!(drawn(Kind::Unknown, 19).len() >= 16);
}

#[test]
fn motions_that_follow_each_other_are_one_motion_of_a_probe_that_does_not_jump() {
    let mut random = Random::new(3, 1);
    let mut draw = || Track::draw(Profile::Mixed, 0.0, 2e-3, &mut random);
    let (mut all, next) = (draw(), draw());
    let first_s = all.seconds();
    all.go_on(&next);
    assert!((all.seconds() - (first_s + 1.0 + next.seconds())).abs() < 1e-9);
    assert!(all.x.len() as f64 > all.seconds() * FINE_HZ);
    assert_eq!(all.x.len(), all.v.len());
    assert_eq!(all.x.len(), all.a.len());
    // The speed is that of the position, but for the third order in steps of 50 µs: 4 µm/s for a motor of 35 Hz.
    let steps = all.x.windows(2).zip(all.v.windows(2));
    let off = steps.map(|(x, v)| ((x[1] - x[0]) * FINE_HZ - 0.5 * (v[0] + v[1])).abs());
    assert!(off.fold(0.0, f64::max) < 1e-4);
}
