//! Held-out error, processor time and wall-clock time of each kind of rig.

use super::{KINDS, Runs, with_forms};
use crate::hidden::score::answer::Answer;
use crate::hidden::score::judge::Mark;
use crate::hidden::score::scored::Scored;
use crate::quantile::quantile;

/// The table, a row for each kind that has runs.
pub(super) fn text<'a>(of: &dyn Fn(&str) -> Runs<'a>) -> String {
    let mut text = format!(
        "{:<15}{:>5}  {:>13}  {:>13}  {:>13}  {:>20}\n{:<15}{:>5}  {:>6} {:>6}  {:>6} {:>6}  {:>6} {:>6}  {:>6} {:>6} {:>6}\n",
        "",
        "",
        "R, named",
        "R, all",
        "CPU s",
        "wall s",
        "",
        "n",
        "median",
        "p90",
        "median",
        "p90",
        "median",
        "p90",
        "median",
        "p90",
        "most"
    );
    for (kind, runs) in KINDS
        .into_iter()
        .flat_map(|kind| with_forms(kind, of(kind)))
    {
        if runs.is_empty() {
            continue;
        }
        let ratios = |keep: &dyn Fn(&Scored) -> bool| -> Vec<f64> {
            runs.iter()
                .filter(|one| keep(one))
                .map(|one| one.ratio())
                .collect()
        };
        let named = ratios(&|one| [Mark::Exact, Mark::NotAdequate].contains(&one.mark()));
        let all = ratios(&|_| true);
        let time = |of: fn(&Answer) -> f64| -> Vec<f64> {
            runs.iter()
                .filter_map(|s| Some(of(s.answer.as_ref().ok()?)))
                .collect()
        };
        let (cpu, wall) = (time(|a| a.cpu_s), time(|a| a.seconds));
        let shown = |values: &[f64], share: f64, decimals: usize| {
            let value = quantile(values.iter().filter(|one| one.is_finite()), share);
            let text = format!("{value:.decimals$}");
            format!("{:>6}", if value.is_nan() { "–" } else { &text })
        };
        line!(
            text,
            "{kind:<15}{:>5}  {} {}  {} {}  {} {}  {} {} {}",
            runs.len(),
            shown(&named, 0.5, 3),
            shown(&named, 0.9, 3),
            shown(&all, 0.5, 3),
            shown(&all, 0.9, 3),
            shown(&cpu, 0.5, 2),
            shown(&cpu, 0.9, 2),
            shown(&wall, 0.5, 2),
            shown(&wall, 0.9, 2),
            shown(&wall, 1.0, 2),
        );
    }
    line!(
        text,
        "R: RMSE of the raw force on the held-out part, after, over the true noise floor."
    );
    text
}
