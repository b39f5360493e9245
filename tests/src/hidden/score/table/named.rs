//! Rigs with one, two or three effects of the catalogue: how many answers name them.

use super::{Runs, count, share, with_forms};
use crate::hidden::score::judge::Mark;
use crate::hidden::score::truth::CRUDE;
use std::fmt::Write as _;

/// The kinds whose hidden effects are in the catalogue.
const NAMED: [&str; 9] = [
    "single",
    "mismatched",
    "machine",
    "machine_mismatched",
    "foreign",
    "pair",
    "pair_mismatched",
    "triple",
    "weak",
];

/// The marks that have a column with their count.
const COUNTED: [Mark; 7] = [
    Mark::NotAdequate,
    Mark::InGroup,
    Mark::Incomplete,
    Mark::ConfidentWrong,
    Mark::Doubtful,
    Mark::Missed,
    Mark::Failed,
];

/// The table, empty where there is no such rig.
pub(super) fn text<'a>(of: &dyn Fn(&str) -> Runs<'a>) -> String {
    let mut text = format!(
        "{:<15}{:>5} {:>14} {:>14} {:>14}{:>5}{:>5}{:>5}{:>5}{:>5}{:>5}{:>5}\n",
        "named, %",
        "n",
        "alone",
        "and adequate",
        "or left open",
        "inad",
        "open",
        "part",
        "bad",
        "iffy",
        "null",
        "fail"
    );
    let mut rows = 0;
    let mut row = |kind: &str, runs: Runs<'_>| {
        if runs.is_empty() {
            return;
        }
        rows += 1;
        let one_of = |marks: &[Mark]| share(&runs, |one| marks.contains(&one.mark())).to_string();
        let _ = write!(
            text,
            "{kind:<15}{:>5} {:>14} {:>14} {:>14}",
            runs.len(),
            one_of(&[Mark::Exact, Mark::NotAdequate]),
            one_of(&[Mark::Exact]),
            one_of(&[Mark::Exact, Mark::NotAdequate, Mark::InGroup]),
        );
        for mark in COUNTED {
            let _ = write!(text, "{:>5}", count(&runs, mark));
        }
        text.push('\n');
    };
    for kind in NAMED {
        for (name, runs) in with_forms(kind, of(kind)) {
            row(name, runs);
        }
    }
    if rows == 0 {
        return String::new();
    }
    line!(
        text,
        "alone: first and alone, of several all and only they, whether `missing_effects` or `unexplained`;\n\
         adequate: as `missing_effects`. open: `ambiguous`, what is there among names or alternatives; part:\n\
         some of it, nothing else; bad: a wrong name as `missing_effects`; iffy: `ambiguous` or\n\
         `unexplained` with something wrong. Best base fit at least 1.5 floors, `weak` less. Crude: the\n\
         catalogue's form leaves {CRUDE} floors and more, so that `unexplained` is the honest verdict."
    );
    text
}
