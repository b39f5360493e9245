//! Rigs with nothing hidden: how often something is found all the same.

use super::{Runs, count, share};
use crate::hidden::score::judge::Mark;
use crate::hidden::score::scored::Scored;

/// The table, empty where there is no such rig.
pub(super) fn text(of: &[&Scored]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "{:<15}{:>5} {:>14} {:>14} {:>14} {:>14} {:>6}\n",
        "nothing hidden", "n", "false alarms", "at most, %", "named", "unexplained", "fail"
    );
    let mut row = |name: &str, runs: Runs<'_>| {
        if runs.is_empty() {
            return;
        }
        // A run that fails is no alarm, but no answer either.
        let alarms = share(&runs, |one| one.mark() != Mark::Exact);
        let of = |what: &dyn Fn(&Scored) -> bool| share(&runs, what).hits;
        line!(
            text,
            "{name:<15}{:>5} {:>14} {:>14.2} {:>14} {:>14} {:>6}",
            runs.len(),
            alarms.hits,
            100.0 * alarms.upper(),
            of(&|one| ["missing_effects", "ambiguous"].contains(&one.verdict())),
            of(&|one| one.verdict() == "unexplained"),
            count(&runs, Mark::Failed),
        );
    };
    row("all", of.to_vec());
    let by = |keep: &dyn Fn(&str) -> bool| -> Runs<'_> {
        of.iter()
            .copied()
            .filter(|s| keep(&s.truth.noise))
            .collect()
    };
    row("white", by(&|noise| noise == "white"));
    row("coloured", by(&|noise| !["", "white"].contains(&noise)));
    for colour in ["ar1", "pink", "hump"] {
        row(
            &format!("  {colour}"),
            by(&|noise| noise.starts_with(colour)),
        );
    }
    line!(
        text,
        "at most: the one-sided 95 % bound of Clopper and Pearson. A failed run counts as an alarm."
    );
    text
}
