//! The tables, within 100 columns: one for each group of gap.md's bars.

use super::judge::Mark;
use super::scored::Scored;
use super::share::Share;

/// Adds a line; writing to a String cannot fail.
macro_rules! line {
    ($to:expr, $($what:tt)*) => {{
        use std::fmt::Write as _;
        let _ = writeln!($to, $($what)*);
    }};
}

mod confusion;
mod coverage;
mod errors_and_times;
mod false_alarms;
pub mod hard;
pub mod injected;
mod named;
mod poor;
mod runs;
mod unknown;

/// The widest line has this many columns.
pub const WIDE: usize = 100;

/// The kinds of rigs in the order of the rows.
const KINDS: [&str; 12] = [
    "single",
    "mismatched",
    "machine",
    "machine_mismatched",
    "foreign",
    "pair",
    "pair_mismatched",
    "triple",
    "weak",
    "poor",
    "none",
    "unknown",
];

type Runs<'a> = Vec<&'a Scored>;

/// All tables; with `list` they name every run, without it those that are not right.
pub fn text(scored: &[Scored], list: bool) -> String {
    let of = |kind: &str| -> Runs<'_> { scored.iter().filter(|s| s.truth.kind == kind).collect() };
    let parts = [
        named::text(&of),
        false_alarms::text(&of("none")),
        unknown::text(&of("unknown")),
        poor::text(&of("poor")),
        errors_and_times::text(&of),
        coverage::text(scored),
        confusion::text(scored),
        runs::text(scored, list),
    ];
    let said: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    said.join("\n")
}

fn share(of: &[&Scored], hit: impl Fn(&Scored) -> bool) -> Share {
    Share {
        hits: of.iter().filter(|one| hit(one)).count(),
        of: of.len(),
    }
}

fn count(of: &[&Scored], mark: Mark) -> usize {
    share(of, |one| one.mark() == mark).hits
}

/// The rows of a kind: all its runs, and where some have a crude form, the close and the crude ones
/// by themselves.
fn with_forms<'a>(kind: &'static str, runs: Runs<'a>) -> Vec<(&'static str, Runs<'a>)> {
    let (crude, close): (Runs<'_>, Runs<'_>) = runs.iter().partition(|s| s.truth.crude);
    let mut rows = vec![(kind, runs)];
    if !crude.is_empty() {
        rows.extend([("  close form", close), ("  crude form", crude)]);
    }
    rows
}

/// The text in lines of at most [`WIDE`] columns, all but the first indented by four; a word that is
/// longer has a line to itself.
pub(super) fn wrapped(lead: &str, text: &str) -> String {
    let mut lines = String::new();
    let mut line = lead.to_string();
    for word in text.split(' ') {
        if line.chars().count() + word.chars().count() > WIDE && !line.trim().is_empty() {
            lines += line.trim_end();
            lines.push('\n');
            line = "    ".into();
        }
        line += word;
        line.push(' ');
    }
    lines + line.trim_end() + "\n"
}
