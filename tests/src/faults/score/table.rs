//! The table as text.

use super::cell::Cell;
use super::judge::Verdict;
use super::run::Flag;
use crate::faults::rig::case::names;
use crate::quantile::quantile;
use crate::tolerance::CLOSE;
use estimator_core::Status;
use std::fmt::Write;

/// Rows without a fault: what they report as a change is false.
const HONEST: [&str; 3] = ["none", "fast_touches", "rate"];

/// The head of the table.
pub fn head() -> String {
    format!(
        "{:<20} {} {:>4} {:>4} {:>9} {:>5} {:>4} | {:^26} | {:>11} | {:^24} | {:>4} {:>4}\n{:<20} {} {:>4} {:>4} {:>9} {:>5} {:>4} | {:>8} {:>8} {:>8} | {:>11} | {:>4} {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4}\n",
        "",
        " ",
        "",
        "",
        "wrong and",
        "not",
        "over",
        "first remark: logs, after s",
        "recovered",
        "ends (%)",
        "in %",
        "",
        "fault",
        "#",
        "logs",
        "n",
        "longest s",
        "seen",
        "bar",
        "suspect",
        "change",
        "fault",
        "in 1 s",
        "conv",
        "susp",
        "chng",
        "cing",
        "else",
        "<1%",
        "<5%",
    )
}

/// A row.
pub fn row(cell: &Cell) -> String {
    let logs = cell.verdicts.len();
    let share = |n: usize| format!("{:.0}", 100.0 * n as f64 / logs.max(1) as f64);
    let flagged = |kind| match cell.flagged(kind) {
        (0, _) => "-".to_string(),
        (n, after_s) => format!("{n} {after_s:.2}"),
    };
    let recovery = match cell.recovery() {
        (0, ..) => "-".to_string(),
        (of, timely, median_s) => format!("{timely}/{of} {median_s:.2}"),
    };
    let ends = [
        Status::Converged,
        Status::ModelSuspect,
        Status::Changed,
        Status::Converging,
    ];
    let named: usize = ends.iter().map(|status| cell.ends(*status)).sum();
    let mut row = format!(
        "{:<20} {} {logs:>4} {:>4} {:>9.2} {:>5} {:>4} | {:>8} {:>8} {:>8} | {recovery:>11} |",
        cell.fault.name,
        cell.severity,
        cell.wrong(),
        cell.longest_s(),
        logs - cell.seeable(),
        if cell.over_the_bar() { "*" } else { "" },
        flagged(Flag::Suspect),
        flagged(Flag::Change),
        flagged(Flag::Fault),
    );
    for status in ends {
        let _ = write!(row, " {:>4}", share(cell.ends(status)));
    }
    let _ = writeln!(
        row,
        " {:>4} | {:>4} {:>4}",
        share(logs - named),
        share(cell.count(Verdict::strict)),
        share(cell.count(|v| v.error < CLOSE)),
    );
    row
}

/// Why logs of a cell were left out: what the law offline makes of them, K, λ and n (medians).
pub fn left_out(cell: &Cell) -> Option<String> {
    let shifts = || cell.verdicts.iter().filter_map(|v| v.unseeable);
    let number = shifts().count();
    let median = |slot: usize| 100.0 * quantile(shifts().map(|u| u.shift[slot]), 0.5);
    (number > 0).then(|| {
        format!(
            "  {:<20} {} {number:>4}: the law fits to the noise with K {:+.1} %, λ {:+.1} %, n {:+.1} %\n",
            cell.fault.name,
            cell.severity,
            median(0),
            median(1),
            median(2)
        )
    })
}

/// The logs of a cell that count and are wrong, one a line.
pub fn wrong_logs(cell: &Cell) -> String {
    let numbered = cell.verdicts.iter().enumerate();
    let wrong = numbered.filter(|(_, verdict)| verdict.wrong_and_seeable());
    let line = |(index, verdict): (usize, &Verdict)| {
        let (material, motion) = names(index as u64);
        let flag = verdict
            .flag
            .map_or("no remark".to_string(), |(flag, after_s)| {
                format!("{flag:?} after {after_s:.2} s")
            });
        format!(
            "    log {index:>3} {material:<7} {motion:<5} wrong from {:.2} s for {:.2} s by {:.0} %, {flag}\n",
            verdict.wrong_from_s,
            verdict.wrong_s,
            100.0 * verdict.wrong_by,
        )
    };
    wrong.map(line).collect()
}

/// The logs of a cell that did not recover in time, one a line.
pub fn late_logs(cell: &Cell) -> String {
    let numbered = cell.verdicts.iter().enumerate();
    let late = numbered.filter_map(|(index, verdict)| {
        let after_s = verdict.recovered_s.filter(|_| !verdict.recovered_in_time())?;
        let (material, motion) = names(index as u64);
        let efficient = verdict.efficient.map_or(String::new(), |share| {
            format!(", an efficient estimator by 1 s with {:.0} %", 100.0 * share)
        });
        Some(format!(
            "    log {index:>3} {material:<7} {motion:<5} within 5 % after {after_s:.2} s of contact{efficient}\n"
        ))
    });
    late.collect()
}

/// What all cells come to.
pub fn summary(cells: &[Cell]) -> String {
    let sum = |of: fn(&Cell) -> usize| cells.iter().map(of).sum::<usize>();
    let over = cells.iter().filter(|cell| cell.over_the_bar()).count();
    let (logs, seeable) = (sum(|c| c.verdicts.len()), sum(Cell::seeable));
    let (wrong, refused) = (sum(Cell::wrong), sum(|c| c.count(|v| v.refused.is_some())));
    let mut text = format!(
        "{over} of {} cells over the bar of 2 in 100; wrong and converged for longer than 50 ms: {wrong} of \
         {seeable} logs that count ({logs} logs, {} not to be seen, {refused} refused)\n",
        cells.len(),
        logs - seeable,
    );
    let recoveries: Vec<(usize, usize, f64)> = cells.iter().map(Cell::recovery).collect();
    let asked: usize = recoveries.iter().map(|r| r.0).sum();
    let timely: usize = recoveries.iter().map(|r| r.1).sum();
    if asked > 0 {
        let _ = writeln!(
            text,
            "recovered to 5 % within 1 s of contact: {timely} of {asked} ({:.1} %)",
            100.0 * timely as f64 / asked as f64
        );
    }
    let relearned = cells.iter().map(Cell::relearned);
    let (swapped, learned, efficient) =
        relearned.fold((0, 0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
    if swapped > 0 {
        let _ = writeln!(
            text,
            "of these another material was to be learned in {swapped}, and was in {learned}; an estimator at the \
             Cramér–Rao bound that knows of the swap at once: {efficient:.0}; all others {} of {}",
            timely - learned,
            asked - swapped,
        );
    }
    for cell in cells
        .iter()
        .filter(|cell| HONEST.contains(&cell.fault.name))
    {
        let settles = |share| quantile(cell.verdicts.iter().map(|v| v.settled_s), share);
        let (number, hours) = cell.changes();
        let _ = writeln!(
            text,
            "{} {}: {number} false changes in {hours:.2} h, {:.1} an hour; settles {:.2} s median, {:.2} s p95",
            cell.fault.name,
            cell.severity,
            number as f64 / hours,
            settles(0.5),
            settles(0.95)
        );
    }
    let left: Vec<String> = cells.iter().filter_map(left_out).collect();
    if !left.is_empty() {
        let _ = write!(text, "not to be seen in the data:\n{}", left.concat());
    }
    text
}
