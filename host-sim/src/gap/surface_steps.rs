//! A surface that steps: the sample has slipped between two touches, or was put back.
//!
//! From a touch on the surface is nearer or farther by one amount. No effect of the catalogue is that, and a later log would
//! not have it: where it is nearly all that remains it is taken off, said, and the rest is asked for again.

use super::finding::{Curves, Finding, Region};
use super::zero_steps::{is_better, may_be_an_effect, together};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::model::Model;
use crate::number::quantity;
use crate::stats::highest;

/// The steps take more than this share off what remains. Not measured: that of a zero that steps.
const NEARLY_ALL: f64 = 0.9;
/// Amounts that are off by less than this share of the largest are known. An amount that was 2 % off left 1.07 times the noise
/// under a gel, and a permanent set and a wave were certain in its place.
const EXACT: f64 = 1e-3;
/// Most times that the amounts are found again. 200 µm under a gel with an exponent of 1.5 needed three.
const MOST_REFITS: usize = 6;
/// Most times that steps are taken off. Not measured.
const MOST_ROUNDS: usize = 2;

/// The finding on one log without the steps of its surface, and what is said of them; `ask` finds what is missing in the model,
/// and `refit` fits a model alone.
///
/// # Errors
/// Those of `ask` and `refit`.
pub(super) fn taken_off(
    model: &Model,
    logs: &[UniformLog],
    ask: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
    refit: impl Fn(&Model, &[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    let first = ask(logs)?;
    let [log] = logs else { return Ok(first) };
    let (mut finding, mut log) = (first.clone(), log.clone());
    for _ in 0..MOST_ROUNDS {
        let steps = together(&finding, NEARLY_ALL, Region::surface_step);
        if steps.is_empty() {
            break;
        }
        let (mut moved, _) = exact(model, with(&log, &steps), &refit)?;
        let mut next = ask(std::slice::from_ref(&moved))?;
        if !next.effects.is_empty() {
            // Beside what the model lacks the amounts are others.
            let (again, is_another) = exact(&next.model, moved.clone(), &refit)?;
            if is_another {
                moved = again;
                next = ask(std::slice::from_ref(&moved))?;
            }
        }
        if !is_better(&next, &finding) || may_be_an_effect(&next, &finding, steps.len()) {
            break;
        }
        (finding, log) = (next, moved);
    }
    // Another material from a touch on is no slip, though one explains most of it: 308 µm, and 39 mN of 21 mN were left.
    if finding.verdict.leaves_a_remainder() {
        return Ok(first);
    }
    let all = &log.compensated.surface_steps;
    let steps = finding
        .curves
        .first()
        .map_or(Vec::new(), |curves| merged(all, curves));
    finding.notes.splice(0..0, steps.into_iter().map(in_words));
    Ok(finding)
}

/// A log with the amounts of its steps found again beside a model, and whether they are others than before.
fn exact(
    model: &Model,
    mut log: UniformLog,
    refit: impl Fn(&Model, &[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<(UniformLog, bool), Diagnostic> {
    let size = |own: &[(f64, f64)]| highest(own.iter().map(|step| step.1.abs()));
    for round in 0..MOST_REFITS {
        let off = refit(model, std::slice::from_ref(&log))?.surface_off;
        if off.is_empty() || size(&off) < EXACT * size(&log.compensated.surface_steps) {
            return Ok((log, round > 0));
        }
        log = with(&log, &off);
    }
    Ok((log, true))
}

/// A log whose surface steps as well by amounts (m) from instants (s) on.
fn with(log: &UniformLog, steps: &[(f64, f64)]) -> UniformLog {
    let mut log = log.clone();
    let all = &mut log.compensated.surface_steps;
    for (s, m) in steps {
        match all.iter_mut().find(|own| own.0 == *s) {
            Some(own) => own.1 += m,
            None => all.push((*s, *m)),
        }
    }
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
