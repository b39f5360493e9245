//! The small table: a letter a log, so that a change of any outcome shows.

use super::judge::{Look, Verdict, judge};
use crate::faults::rig::case::{Case, names};
use crate::faults::rig::fault::{self, Fault};
use estimator_core::Status;
use rayon::prelude::*;
use std::fmt::Write;

/// The logs of each severity: every material and every motion at the middle one, half of them at the
/// others, which keeps the test to a few seconds.
const LOGS: [&[u64]; 3] = [&[0, 3], &[0, 5, 10, 3], &[5, 10]];
/// The seed.
const SEED: u64 = 1;

/// The letter of an outcome.
fn letter(verdict: &Verdict) -> char {
    if verdict.wrong() {
        return if verdict.unseeable.is_some() {
            'u'
        } else {
            'W'
        };
    }
    match verdict.status {
        Some(Status::Converged) => 'c',
        Some(Status::ModelSuspect) => 's',
        Some(Status::Changed) => 'h',
        Some(Status::Converging) => 'g',
        Some(_) => 'n',
        None => 'r',
    }
}

/// The outcomes of a cell.
fn cell(fault: &'static Fault, severity: usize) -> String {
    let logs = LOGS[severity].iter();
    let judged =
        logs.map(|index| judge(&Case::new(fault, severity, SEED, *index), Look::WhereWrong));
    judged.map(|verdict| letter(&verdict)).collect()
}

/// The text of the small table.
pub fn text() -> String {
    let faults: Vec<&'static Fault> = fault::all().collect();
    let places = (0..3 * faults.len()).into_par_iter();
    let cells = places.map(|place| cell(faults[place / 3], place % 3));
    let cells: Vec<String> = cells.collect();
    let mut text = head();
    for (fault, cells) in faults.iter().zip(cells.chunks(3)) {
        let _ = writeln!(
            text,
            "{:<19} {}  {}",
            fault.name,
            cells.join(" "),
            fault.severities
        );
    }
    let letters = || cells.iter().flat_map(|cell| cell.chars());
    let wrong = letters().filter(|letter| *letter == 'W').count();
    let _ = writeln!(
        text,
        "\nwrong and converged: {wrong} of {} logs",
        letters().count()
    );
    text
}

fn head() -> String {
    let logs = LOGS.map(|logs| {
        let logs = logs.iter().map(|index| {
            let (material, motion) = names(*index);
            format!("{material} {motion}")
        });
        logs.collect::<Vec<_>>().join(", ")
    });
    format!(
        "Fault and its three severities, a letter a log ({}).\n\
         W wrong and converged for longer than 50 ms; u the same where the data cannot tell. Otherwise the end:\n\
         c converged, s model_suspect, h changed, g converging, n unobservable or no contact, r refused.\n\n",
        logs.join(" | ")
    )
}
