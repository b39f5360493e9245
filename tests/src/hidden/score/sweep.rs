//! What a threshold of the gap workflow does to the score: all rigs with it at −25 %, 0 and +25 %.
//!
//! The library is asked, in this process: the program has no switch for its thresholds. The answers are
//! those of the program all the same, since it reads the files of a rig as [`library`] does.

use super::judge::Mark;
use super::scored::Scored;
use super::{library, run};
use palpate::gap::Options;
use palpate::gap::thresholds::Thresholds;
use palpate::threshold::{Adjustable, Threshold};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The kinds of rigs without `--kind`: of each group of figures one, and what is foreign, weak or a machine's.
pub const KINDS: [&str; 8] = [
    "single",
    "mismatched",
    "pair",
    "none",
    "unknown",
    "foreign",
    "weak",
    "machine",
];

/// The factors on what a threshold has over its origin, with their names.
const FACTORS: [(f64, &str); 3] = [(0.75, "-25 %"), (1.0, "0"), (1.25, "+25 %")];

/// All thresholds with their defaults and reasons.
pub fn list() -> String {
    let mut text = String::new();
    for Threshold {
        name,
        value,
        reason,
        ..
    } in Thresholds::default().all()
    {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name} = {value}");
        text += &super::table::wrapped("    ", reason);
    }
    text
}

/// The names of all thresholds.
pub fn names() -> Vec<&'static str> {
    let mut all = Thresholds::default();
    all.all().into_iter().map(|own| own.name).collect()
}

/// Checks the name of a threshold.
///
/// # Errors
/// No threshold has this name; the nearest one is said.
pub fn known(name: &str) -> Result<(), String> {
    with(name, 1.0).map(drop)
}

/// The options with a threshold changed by a factor, and its value.
fn with(name: &str, factor: f64) -> Result<(Options, f64), String> {
    let mut options = Options::default();
    let changed = options.thresholds.set(name, factor);
    changed.map_err(|error| error.to_string())?;
    let mut all = options.thresholds.all().into_iter();
    let value = all
        .find(|own| own.name == name)
        .map_or(f64::NAN, |own| *own.value);
    Ok((options, value))
}

/// Scores rigs with a threshold at every factor.
///
/// # Errors
/// No threshold has this name, or a truth.json cannot be read.
pub fn text(name: &str, rigs: &[PathBuf], jobs: usize) -> Result<String, String> {
    let mut runs = Vec::new();
    for (factor, change) in FACTORS {
        let (options, value) = with(name, factor)?;
        let score = |rig: &Path, _| library::score(rig, &options);
        runs.push((change, value, run::each(rigs, jobs, score)?));
    }
    Ok(table(name, &runs))
}

/// The scores at one factor: its name, the value of the threshold, the runs.
type Swept = (&'static str, f64, Vec<Scored>);

/// What heads the rows of [`row`].
pub fn heading(usual: &[Scored]) -> String {
    let right = usual.iter().filter(|one| is_right(one.mark())).count();
    format!(
        "{} rigs, {right} of them right (or, without being adequate, right and alone); the numbers are of those that\n\
         become right, that cease to be, and of wrong names more (+) or fewer\n\
         {:<32}{:>10}   {:<21}+25 %\n",
        usual.len(),
        "threshold",
        "value",
        "-25 %"
    )
}

/// What a threshold's change by a quarter either way does to the answers, in a line.
///
/// # Errors
/// No threshold has this name, or a truth.json cannot be read.
pub fn row(name: &str, usual: &[Scored], rigs: &[PathBuf], jobs: usize) -> Result<String, String> {
    let mut text = format!("{name:<32}{:>10}", with(name, 1.0)?.1);
    for (factor, _) in FACTORS.into_iter().filter(|(factor, _)| *factor != 1.0) {
        let options = with(name, factor)?.0;
        let changed = run::each(rigs, jobs, |rig, _| library::score(rig, &options))?;
        let pairs = || changed.iter().zip(usual);
        let gained = pairs().filter(|(one, usual)| is_right(one.mark()) && !is_right(usual.mark()));
        let lost = pairs().filter(|(one, usual)| !is_right(one.mark()) && is_right(usual.mark()));
        let wrong = |all: &[Scored]| {
            let wrong = all.iter().filter(|one| one.mark() == Mark::ConfidentWrong);
            wrong.count() as i64
        };
        let wrong = wrong(&changed) - wrong(usual);
        let _ = write!(
            text,
            "   {:>3} {:>3} {wrong:>+3}      ",
            gained.count(),
            lost.count()
        );
    }
    Ok(text.trim_end().to_string() + "\n")
}

fn is_right(mark: Mark) -> bool {
    [Mark::Exact, Mark::NotAdequate].contains(&mark)
}

/// A row for each kind and factor, then the rigs that are answered in another way than at 0.
pub fn table(name: &str, runs: &[Swept]) -> String {
    let mut text = format!(
        "{name}\n{:<16}{:>6}{:>9}{:>5}{:>11}{:>10}{:>7}{:>7}{:>7}{:>8}{:>6}\n",
        "", "", "value", "n", "right and", "right or", "wrong", "wrong", "called", "false", ""
    );
    let _ = writeln!(
        text,
        "{:<16}{:>6}{:>9}{:>5}{:>11}{:>10}{:>7}{:>7}{:>7}{:>8}{:>6}",
        "kind", "", "", "", "alone", "open", "name", "open", "null", "alarms", "fail"
    );
    let first = runs.first().map_or(&[][..], |(_, _, scored)| scored);
    let kinds: BTreeSet<&str> = first.iter().map(|one| one.truth.kind.as_str()).collect();
    for kind in kinds {
        for (change, value, scored) in runs {
            let of: Vec<&Scored> = scored.iter().filter(|one| one.truth.kind == kind).collect();
            let _ = writeln!(text, "{kind:<16}{change:>6}{value:>9.4}{}", figures(&of));
        }
    }
    text += "wrong name: as a certainty; wrong open: in an answer that is `ambiguous` or `unexplained`; called\n\
             null: something is there; a threshold that says how far over 1 something is changes by that.\n";
    let Some((_, _, usual)) = runs.iter().find(|(change, ..)| *change == "0") else {
        return text;
    };
    for (change, _, scored) in runs {
        for (one, usual) in scored.iter().zip(usual) {
            let (mark, before) = (one.mark(), usual.mark());
            if mark != before {
                let rig = one.rig.display();
                let _ = writeln!(text, "{change:>6} {rig}: {before:?} → {mark:?}");
            }
        }
    }
    text
}

/// The figures of the runs of a kind.
fn figures(of: &[&Scored]) -> String {
    let nothing = |one: &&&Scored| one.truth.kind == "none";
    let marks = |marks: &[Mark]| of.iter().filter(|one| marks.contains(&one.mark())).count();
    // As `score` counts: a run of a rig with nothing hidden that is not right is an alarm.
    let alarms = of
        .iter()
        .filter(nothing)
        .filter(|one| one.mark() != Mark::Exact);
    format!(
        "{:>5}{:>11}{:>10}{:>7}{:>7}{:>7}{:>8}{:>6}",
        of.len(),
        marks(&[Mark::Exact, Mark::NotAdequate]),
        marks(&[Mark::Exact, Mark::NotAdequate, Mark::InGroup]),
        marks(&[Mark::ConfidentWrong]),
        marks(&[Mark::Doubtful, Mark::Junk]),
        marks(&[Mark::Missed]),
        alarms.count(),
        marks(&[Mark::Failed]),
    )
}
