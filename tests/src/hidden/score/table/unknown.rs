//! Rigs with a misfit that is in no catalogue: how often it is left without a name.

use super::{Runs, count, share};
use crate::hidden::score::judge::Mark;
use crate::hidden::score::scored::Scored;
use std::collections::BTreeMap;

/// The table, empty where there is no such rig.
pub(super) fn text(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut kinds: BTreeMap<&str, Runs<'_>> = BTreeMap::new();
    for one in of {
        kinds.entry(&one.truth.label).or_default().push(one);
    }
    let mut text = format!(
        "{:<15}{:>5} {:>16} {:>14} {:>16} {:>10} {:>6} {:>6}\n",
        "no catalogue's",
        "n",
        "unexplained, %",
        "no name, %",
        "wrong names, %",
        "ambiguous",
        "null",
        "fail"
    );
    let mut row = |name: &str, runs: &[&Scored]| {
        let says = |verdict: &str| share(runs, |one| one.verdict() == verdict);
        let silent = share(runs, |one| {
            one.verdict() == "unexplained" && !one.names_effects()
        });
        line!(
            text,
            "{name:<15}{:>5} {:>16} {:>14} {:>16} {:>10} {:>6} {:>6}",
            runs.len(),
            says("unexplained").to_string(),
            silent.to_string(),
            says("missing_effects").to_string(),
            says("ambiguous").hits,
            says("no_missing_effect").hits,
            count(runs, Mark::Failed),
        );
    };
    row(&format!("{} kinds", kinds.len()), of);
    for (kind, runs) in &kinds {
        row(&format!("  {kind}"), runs);
    }
    line!(
        text,
        "wrong names: as a certainty, `missing_effects`. no name: of all, unexplained and nothing named."
    );
    text
}
