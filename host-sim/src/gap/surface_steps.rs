//! A surface that steps: the sample has slipped between two touches, or was put back.
//!
//! From a touch on the surface is nearer or farther by one amount. No effect of the catalogue is that, and a later log would
//! not have it: where it is nearly all that remains it is taken off, said, and the rest is asked for again.

use super::finding::{Curves, Finding, Region};
use super::zero_steps::{is_better, may_be_an_effect, nearly_all};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::number::quantity;

/// The steps take more than this share off what remains. Not measured: that of a zero that steps.
const NEARLY_ALL: f64 = 0.9;
/// Where the amounts are found again the errors that they had to first order are more than this share.
const MOSTLY: f64 = 0.5;
/// Most times that the amounts are found again. 200 µm under a gel with an exponent of 1.5 needed two.
const MOST_REFITS: usize = 4;
/// Most times that steps are taken off. Not measured.
const MOST_ROUNDS: usize = 2;

/// The finding on one log without the steps of its surface, and what is said of them; `ask` finds what is missing, and
/// `refit` fits the model alone.
///
/// # Errors
/// Those of `ask` and `refit`.
pub(super) fn taken_off(
    logs: &[UniformLog],
    ask: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
    refit: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    let mut finding = ask(logs)?;
    let [log] = logs else { return Ok(finding) };
    let mut log = log.clone();
    for _ in 0..MOST_ROUNDS {
        let steps = nearly_all(&finding, NEARLY_ALL, Region::surface_step);
        if steps.is_empty() {
            break;
        }
        let mut moved = with(&log, &steps);
        for _ in 0..MOST_REFITS {
            let left = refit(std::slice::from_ref(&moved))?;
            let more = nearly_all(&left, MOSTLY, Region::surface_step);
            if more.is_empty() {
                break;
            }
            moved = with(&moved, &more);
        }
        let next = ask(std::slice::from_ref(&moved))?;
        if !is_better(&next, &finding) || may_be_an_effect(&next, &finding, steps.len()) {
            break;
        }
        (finding, log) = (next, moved);
    }
    let all = &log.compensated.surface_steps;
    let steps = finding
        .curves
        .first()
        .map_or(Vec::new(), |curves| merged(all, curves));
    finding.notes.splice(0..0, steps.into_iter().map(in_words));
    Ok(finding)
}

/// A log whose surface steps as well by amounts (m) from instants (s) on.
fn with(log: &UniformLog, steps: &[(f64, f64)]) -> UniformLog {
    let mut log = log.clone();
    let all = &mut log.compensated.surface_steps;
    all.extend_from_slice(steps);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    log
}

/// Steps, those between the same two touches together.
fn merged(all: &[(f64, f64)], curves: &Curves) -> Vec<(f64, f64)> {
    let row = |s: f64| curves.time_s.partition_point(|stamp| *stamp < s);
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for (s, m) in all {
        let is_same = |last: &&mut (f64, f64)| {
            let between = &curves.depth_m[row(last.0)..row(*s)];
            between.iter().all(|depth| *depth <= 0.0)
        };
        match steps.last_mut().filter(is_same) {
            Some(last) => last.1 += m,
            None => steps.push((*s, *m)),
        }
    }
    steps
}

fn in_words((s, m): (f64, f64)) -> String {
    format!(
        "the surface steps by {} at about {s:.2} s, between two touches, and stays there, as where the sample slips: taken \
         off",
        quantity(m, 3, "m")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_between_the_same_touches_are_one() {
        // GIVEN touches up to 1 s, and from 2 s on
        let time_s: Vec<f64> = (0..300).map(|at| 1e-2 * f64::from(at)).collect();
        let depth = |s: &f64| if (1.0..2.0).contains(s) { 0.0 } else { 1e-3 };
        let depth_m: Vec<f64> = time_s.iter().map(depth).collect();
        let curves = Curves {
            depth_m,
            time_s,
            ..Curves::default()
        };
        let log = with(&UniformLog::default(), &[(1.6, 2e-5), (2.5, 1e-5)]);
        let log = with(&log, &[(1.4, 1e-4)]);
        let merged = merged(&log.compensated.surface_steps, &curves);
        assert_eq!(merged, [(1.4, 1e-4 + 2e-5), (2.5, 1e-5)]);
    }
}
