//! Harder rigs, a row for each group: imperfect sensors, other forms, other scales, sampling as it is.

use super::{Runs, coverage, runs, share};
use crate::hidden::score::judge::Mark;
use crate::hidden::score::scored::Scored;
use crate::hidden::score::share::Share;
use crate::quantile::quantile;

/// The groups: their row, and the kinds of rigs that belong to them. A kind that is in none has a row of
/// its own.
const GROUPS: [(&str, &[&str]); 7] = [
    (
        "one effect, other form",
        &["other", "mismatched", "foreign"],
    ),
    ("one effect, same form", &["same", "single"]),
    ("nothing", &["none"]),
    ("two effects", &["pair", "pair_mismatched"]),
    ("three effects", &["triple"]),
    ("in no catalogue", &["unknown"]),
    ("small, poor, other scale", &["weak", "poor", "scale"]),
];

/// An answer that is adequate leaves no more than this multiple of the true floor.
const ADEQUATE: f64 = 1.3;

/// The table, then each run that is neither right and alone nor right or open; with `list` every run.
pub fn text(scored: &[Scored], list: bool) -> String {
    let mut text = format!(
        "{:<25}{:>5}{:>11}{:>10}{:>8}{:>8}{:>7}{:>14}{:>9}{:>12}{:>7}\n",
        "", "", "right and", "right or", "wrong", "nothing", "false", "R", "R", "covered, %", "s"
    );
    text += &format!(
        "{:<25}{:>5}{:>11}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}{:>9}{:>7}{:>5}{:>7}\n",
        "group",
        "n",
        "alone, %",
        "open, %",
        "name, %",
        "named",
        "alarms",
        "median",
        "p90",
        "> 1.3",
        "95 %",
        "3 σ",
        "p95"
    );
    for (name, runs) in groups(scored) {
        text += &row(&name, &runs);
    }
    let all: Runs<'_> = scored.iter().collect();
    text += &row("all", &all);
    text += "right: where nothing is hidden nothing named, in no catalogue unexplained and nothing named. wrong\n\
             name: as certain or strong. nothing named: something of the catalogue is hidden and the answer names\n\
             nothing. R: held-out RMSE after, over the true floor, where right; > 1.3: answers that are adequate by\n\
             their own word above 1.3 floors, of how many. covered: truths of base and added parameters within\n\
             their 95 % interval and within three standard errors. s: of wall clock.\n";
    let missed = scored.iter().filter(|one| list || !right_or_open(one));
    missed.map(runs::line).for_each(|line| text += &line);
    text
}

fn groups(scored: &[Scored]) -> Vec<(String, Runs<'_>)> {
    let mut groups: Vec<(String, Runs<'_>)> = Vec::new();
    let known = GROUPS
        .iter()
        .map(|(name, _)| ((*name).to_string(), Vec::new()));
    groups.extend(known);
    for one in scored {
        let kind = one.truth.kind.as_str();
        let group = GROUPS.iter().find(|(_, kinds)| kinds.contains(&kind));
        let name = group.map_or(kind, |(name, _)| name);
        match groups.iter_mut().find(|(known, _)| known == name) {
            Some((_, runs)) => runs.push(one),
            None => groups.push((name.to_string(), vec![one])),
        }
    }
    groups.retain(|(_, runs)| !runs.is_empty());
    groups
}

fn alone(one: &Scored) -> bool {
    [Mark::Exact, Mark::NotAdequate].contains(&one.mark())
}

fn right_or_open(one: &Scored) -> bool {
    alone(one) || one.mark() == Mark::InGroup
}

fn row(name: &str, of: &[&Scored]) -> String {
    let percent = |share: Share| match share.of {
        0 => "–".to_string(),
        of => format!("{:.1}", 100.0 * share.hits as f64 / of as f64),
    };
    let is = |what: &dyn Fn(&Scored) -> bool| share(of, what);
    let something = |one: &Scored| !one.truth.effects.is_empty() && one.truth.kind != "unknown";
    let silent = is(&|one| something(one) && !one.names_effects());
    // Where nothing is hidden, whatever is not right is an alarm.
    let alarms = is(&|one| one.truth.effects.is_empty() && one.mark() != Mark::Exact);
    let named: Vec<f64> = of
        .iter()
        .filter(|one| alone(one) && something(one) || one.truth.effects.is_empty())
        .map(|one| one.ratio())
        .filter(|ratio| ratio.is_finite())
        .collect();
    let adequate: Runs<'_> = of
        .iter()
        .copied()
        .filter(|one| ["no_missing_effect", "missing_effects"].contains(&one.verdict()))
        .collect();
    let above = share(&adequate, |one| one.ratio() > ADEQUATE);
    let covered = coverage::of(of.iter().copied());
    let both = Share {
        hits: covered.added.hits + covered.base.hits,
        of: covered.added.of + covered.base.of,
    };
    let seconds: Vec<f64> = of
        .iter()
        .filter_map(|one| Some(one.answer.as_ref().ok()?.seconds))
        .collect();
    let shown = |value: f64, decimals: usize| match value.is_nan() {
        true => "–".to_string(),
        false => format!("{value:.decimals$}"),
    };
    format!(
        "{name:<25}{:>5}{:>11}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}{:>9}{:>7}{:>5}{:>7}\n",
        of.len(),
        percent(is(&alone)),
        percent(is(&right_or_open)),
        percent(is(&|one| one.mark() == Mark::ConfidentWrong)),
        silent.hits,
        alarms.hits,
        shown(quantile(&named, 0.5), 2),
        shown(quantile(&named, 0.9), 2),
        format!("{}/{}", above.hits, above.of),
        percent(both),
        match covered.near.of {
            0 => "–".to_string(),
            of => format!("{:.0}", 100.0 * covered.near.hits as f64 / of as f64),
        },
        shown(quantile(&seconds, 0.95), 1),
    )
}
