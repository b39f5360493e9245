//! Which effect was taken for which; "nothing is missing" is a class of its own.

use super::{KINDS, wrapped};
use crate::hidden::score::answer::Answer;
use crate::hidden::score::judge::Mark;
use crate::hidden::score::scored::Scored;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Columns for the name of a truth; a longer one has a line to itself.
const NAME: usize = 42;

/// Counts of the answers to one truth.
#[derive(Default)]
struct Row {
    n: usize,
    itself: usize,
    open: usize,
    null: usize,
    others: BTreeMap<String, usize>,
}

impl Row {
    fn push(&mut self, one: &Scored) {
        self.n += 1;
        let label = |error: &String| format!("failed ({error})");
        let label = one.answer.as_ref().map_or_else(label, Answer::label);
        match (one.mark(), label.as_str()) {
            (_, "null") => self.null += 1,
            (Mark::Exact | Mark::NotAdequate, _) => self.itself += 1,
            (Mark::InGroup, _) => self.open += 1,
            _ => *self.others.entry(label).or_default() += 1,
        }
    }

    fn right(&self, nothing: bool) -> bool {
        self.n == if nothing { self.null } else { self.itself }
    }

    /// The other answers with their counts, the frequent ones first.
    fn others(&self) -> String {
        let mut others: Vec<(&String, &usize)> = self.others.iter().collect();
        others.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let said: Vec<String> = others.iter().map(|(to, n)| format!("{to} {n}")).collect();
        said.join(", ")
    }
}

/// A row for each truth, also for rigs that hide nothing; the rows without an error share a line.
pub(super) fn text(scored: &[Scored]) -> String {
    let mut text = format!(
        "{:<NAME$}{:>4}{:>7}{:>6}{:>6}  taken for (? open, ! unexplained)\n",
        "hidden", "n", "itself", "open", "null"
    );
    for kind in KINDS {
        let mut rows: BTreeMap<&str, Row> = BTreeMap::new();
        for one in scored.iter().filter(|one| one.truth.kind == kind) {
            rows.entry(&one.truth.label).or_default().push(one);
        }
        if rows.is_empty() {
            continue;
        }
        let _ = writeln!(text, "{kind}");
        let right = |row: &Row| row.right(kind == "none");
        for (label, row) in rows.iter().filter(|(_, row)| !right(row)) {
            text += &line(label, row);
        }
        let all: Vec<String> = rows
            .iter()
            .filter(|(_, row)| right(row))
            .map(|(label, row)| format!("{label} {}", row.n))
            .collect();
        if !all.is_empty() {
            text += &wrapped("  always right: ", &all.join(", "));
        }
    }
    text
}

fn line(label: &str, row: &Row) -> String {
    let mut lead = format!("  {label}");
    if lead.chars().count() >= NAME {
        lead.push('\n');
        lead += &" ".repeat(NAME);
    }
    let numbers = format!(
        "{:>4}{:>7}{:>6}{:>6}  ",
        row.n, row.itself, row.open, row.null
    );
    let (above, last) = lead
        .rsplit_once('\n')
        .map_or(("", lead.as_str()), |(a, l)| (a, l));
    let above = if above.is_empty() {
        String::new()
    } else {
        format!("{above}\n")
    };
    above + &wrapped(&format!("{last:<NAME$}{numbers}"), &row.others())
}
