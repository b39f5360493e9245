//! The table as text.

use super::cell::Cell;
use super::judge::Verdict;
use super::run::Flag;
use crate::acceptance::score::quantile;
use crate::tolerance::CLOSE;
use estimator_core::Status;
use std::fmt::Write;

/// The head of the table.
pub fn head() -> String {
    format!(
        "{:<20} {} {:>4} {:>4} {:>9} {:>5} {:>4} | {:^26} | {:>11} | {:^24} | {:>4} {:>4}\n{:<20} {} {:>4} {:>4} {:>9} {:>5} {:>4} | {:>8} {:>8} {:>8} | {:>11} | {:>4} {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4}\n",
        "", " ", "", "", "wrong and", "not", "over",
        "first remark: logs, after s", "recovered", "ends (%)", "in %", "",
        "fault", "#", "logs", "n", "longest s", "seen", "bar",
        "suspect", "change", "fault", "in 1 s", "conv", "susp", "chng", "cing", "else", "<1%", "<5%",
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
            "recovered to 5 % within 1 s of contact: {timely} of {asked} ({:.0} %)",
            100.0 * timely as f64 / asked as f64
        );
    }
    let honest: Vec<&Cell> = cells.iter().filter(|c| c.fault.name == "none").collect();
    for cell in honest {
        let settles = |share| quantile(cell.verdicts.iter().map(|v| v.settled_s), share);
        let _ = writeln!(
            text,
            "none {}: false changes {:.1} an hour; settles {:.2} s median, {:.2} s p95",
            cell.severity,
            cell.changes_an_hour(),
            settles(0.5),
            settles(0.95)
        );
    }
    text
}
