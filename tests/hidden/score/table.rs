//! The table: shares by kind, held-out error, coverage, time, and who was taken for whom.

use super::judge::{Mark, errors, first, mark};
use super::run::Scored;
use super::share::{Share, quantile};
use std::collections::BTreeMap;

/// Order of the rows.
const KINDS: [&str; 10] = [
    "single",
    "mismatched",
    "crude",
    "pair",
    "pair_mismatched",
    "triple",
    "weak",
    "poor",
    "none",
    "unknown",
];

/// Runs of one kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    marks: Vec<Mark>,
    first: Share,
    ratios: Vec<f64>,
    exact_ratios: Vec<f64>,
    seconds: Vec<f64>,
}

impl Row {
    /// Adds one run.
    pub(crate) fn push(&mut self, scored: &Scored) {
        let Ok(answer) = &scored.answer else {
            self.marks.push(Mark::Failed);
            self.first.push(false);
            return;
        };
        let mark = mark(&scored.truth, answer);
        self.marks.push(mark);
        self.first.push(first(&scored.truth, answer));
        let ratio = answer.rmse_after_n / scored.truth.floor_n;
        self.ratios.push(ratio);
        if mark == Mark::Exact {
            self.exact_ratios.push(ratio);
        }
        self.seconds.push(answer.seconds);
    }

    /// Share of runs with one of these marks.
    pub(crate) fn share(&self, marks: &[Mark]) -> Share {
        let hits = self
            .marks
            .iter()
            .filter(|mark| marks.contains(mark))
            .count();
        Share {
            hits,
            of: self.marks.len(),
        }
    }

    fn print(&self, kind: &str) {
        let share = |marks: &[Mark]| self.share(marks).to_string();
        let count = |mark: Mark| self.share(&[mark]).hits;
        println!(
            "{kind:<15}{:>5} {:>16} {:>16} {:>16} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>6.3} {:>6.3} {:>6.3} {:>5.1} {:>5.1}",
            self.marks.len(),
            share(&[Mark::Exact]),
            share(&[Mark::Exact, Mark::InGroup]),
            self.first.to_string(),
            count(Mark::NotAdequate),
            count(Mark::Junk),
            count(Mark::Incomplete),
            count(Mark::Doubtful),
            count(Mark::Missed),
            count(Mark::ConfidentWrong),
            count(Mark::Failed),
            quantile(&self.exact_ratios, 0.5),
            quantile(&self.exact_ratios, 0.9),
            quantile(&self.ratios, 0.9),
            quantile(&self.seconds, 0.5),
            quantile(&self.seconds, 1.0),
        );
    }
}

/// Prints everything; `list` also each run.
pub(crate) fn print(scored: &[Scored], list: bool) {
    println!(
        "{:<15}{:>5} {:>16} {:>16} {:>16} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>5} {:>6} {:>6} {:>6} {:>5} {:>5}",
        "kind",
        "n",
        "exact %",
        "or in group %",
        "first name %",
        "inad.",
        "junk",
        "part",
        "doubt",
        "null",
        "wrong",
        "fail",
        "R med",
        "R p90",
        "all90",
        "s med",
        "s max"
    );
    for kind in KINDS {
        let mut row = Row::default();
        scored
            .iter()
            .filter(|s| s.truth.kind == kind)
            .for_each(|s| row.push(s));
        if !row.marks.is_empty() {
            row.print(kind);
        }
    }
    println!(
        "exact: the set named, adequate (none: no_missing_effect; unknown: unexplained, no name). inad.: the set, unexplained.\n\
         junk: unexplained, with names. part: some of the set. doubt: unexplained or ambiguous, with a wrong name. wrong: so, as a certainty.\n\
         crude: a form that the catalogue\'s own cannot follow within 15 % of the floor; `unexplained` is honest there.\n\
         R: held-out RMSE after over the true floor, of exact answers; all90: p90 of all. s: wall clock of the process."
    );
    coverage(scored);
    confusion(scored);
    for one in scored {
        if list || !right(one) {
            println!("{}", line(one));
        }
    }
}

/// Exactly right, or in a group.
fn right(scored: &Scored) -> bool {
    let mark = scored
        .answer
        .as_ref()
        .map(|answer| mark(&scored.truth, answer));
    matches!(mark, Ok(Mark::Exact | Mark::InGroup))
}

fn line(scored: &Scored) -> String {
    let truth = &scored.truth;
    match &scored.answer {
        Ok(answer) => format!(
            "{} {}: {} → {} [{:?}] R {:.3} floor {:.2} {:.1} s",
            scored.rig.display(),
            truth.kind,
            truth.label,
            answer.label(),
            mark(truth, answer),
            answer.rmse_after_n / truth.floor_n,
            answer.floor_n / truth.floor_n,
            answer.seconds,
        ),
        Err(error) => format!(
            "{} {}: {} → {error}",
            scored.rig.display(),
            truth.kind,
            truth.label
        ),
    }
}

/// 95 % intervals of exact answers in the catalogue's form.
fn coverage(scored: &[Scored]) {
    let (mut added, mut base) = (Share::default(), Share::default());
    let mut each: BTreeMap<String, Share> = BTreeMap::new();
    for one in scored {
        let Ok(answer) = &one.answer else { continue };
        let same_form = one.truth.params.len() == one.truth.effects.len();
        if !same_form || mark(&one.truth, answer) != Mark::Exact {
            continue;
        }
        let (of_added, of_base) = errors(&one.truth, answer);
        for (name, error) in of_added {
            added.push(error.abs() <= 1.96);
            each.entry(name).or_default().push(error.abs() <= 1.96);
        }
        for (name, error) in of_base {
            base.push(error.abs() <= 1.96);
            each.entry(format!("base.{name}"))
                .or_default()
                .push(error.abs() <= 1.96);
        }
    }
    println!(
        "95 % intervals cover: added parameters {added} % of {}, base {base} % of {}",
        added.of, base.of
    );
    // Lists only what is unlikely (< 5 %) for a true 95 %.
    let poor = each.iter().filter(|(_, share)| share.interval().1 < 0.95);
    let poor: Vec<String> = poor
        .map(|(name, s)| format!("{name} {}/{}", s.hits, s.of))
        .collect();
    if !poor.is_empty() {
        println!("  too narrow: {}", poor.join(", "));
    }
}

/// Rows truth, columns what was named.
fn confusion(scored: &[Scored]) {
    let mut rows: BTreeMap<(usize, &str), BTreeMap<String, usize>> = BTreeMap::new();
    for one in scored {
        let kind = KINDS
            .iter()
            .position(|kind| *kind == one.truth.kind)
            .unwrap_or(KINDS.len());
        let label = one
            .answer
            .as_ref()
            .map_or("failed".into(), super::answer::Answer::label);
        *rows
            .entry((kind, &one.truth.label))
            .or_default()
            .entry(label)
            .or_default() += 1;
    }
    println!("truth: answers (null: no_missing_effect; ?: ambiguous; !: unexplained)");
    let mut alone: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for ((kind, label), cells) in rows {
        let mut cells: Vec<(String, usize)> = cells.into_iter().collect();
        cells.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        // A row with nothing but its own name goes to one line with the others of that kind.
        if let [(to, count)] = cells.as_slice()
            && label.split(' ').next() == Some(to)
        {
            alone
                .entry(kind)
                .or_default()
                .push(format!("{label} {count}"));
            continue;
        }
        let cells: Vec<String> = cells
            .iter()
            .map(|(to, count)| format!("{to} {count}"))
            .collect();
        println!(
            "  {:<15} {label}: {}",
            KINDS.get(kind).unwrap_or(&""),
            cells.join(", ")
        );
    }
    for (kind, labels) in alone {
        println!(
            "  {:<15} as itself alone: {}",
            KINDS.get(kind).unwrap_or(&""),
            labels.join(", ")
        );
    }
}
