//! A zero of the force that steps: a tare, a power cycle, a knock of the load cell.
//!
//! From an instant on the force is off by one amount. No effect of the catalogue is that, and a later log would not have
//! it: where it is nearly all that remains it is taken off, said, and the rest is asked for again, beside an amount that
//! every fit finds anew.

use super::decide::episode::SHORT;
use super::finding::{Curves, Finding, Region};
use crate::diagnostic::Diagnostic;
use crate::log::UniformLog;
use crate::number::quantity;

/// The steps take more than this share off what remains. Zeros that stepped by 0.12 to 0.45 N in the middle of four logs:
/// 0.97 to 0.996; two steps beside a friction that was missing as well took 0.56 and 0.70 off what the base left, and without
/// them the friction explained the rest.
const MUCH: f64 = 0.5;
/// Less than this share (rms) remains then, with what is found beside them. Derived: steps that take half off must let an effect
/// be found that takes half of the rest.
const LESS: f64 = 0.5;
/// Effects that leave at least this share of what the step leaves (rms) are no better. A drift that came to rest and a
/// wave of three seconds were made of a step of 1 N, and left 1.05 times the noise. Derived: a tenth of the squares.
const AS_MUCH: f64 = 1.05;
/// An effect does as well as a step if it leaves less than this many times as much (rms). The best in the place of five
/// steps left 1.8 to 12 times as much.
const BY_ONE_EFFECT: f64 = 1.25;
/// A step is taken back if less than this share of it stays. Not measured.
const BACK: f64 = 0.2;
/// Most steps that are taken off. Not measured.
const MOST: usize = 4;
/// Samples within which the instant is sought again: a search takes one of eight where a log has 240 000.
const NEAR: usize = 8;

/// The finding on one log without the steps of its zero, and what is said of them; `ask` finds what is missing.
///
/// # Errors
/// Those of `ask`.
pub(super) fn taken_off(
    logs: &[UniformLog],
    ask: impl Fn(&[UniformLog]) -> Result<Finding, Diagnostic>,
) -> Result<Finding, Diagnostic> {
    let mut finding = ask(logs)?;
    let [log] = logs else { return Ok(finding) };
    let mut log = log.clone();
    let mut steps: Vec<(f64, f64)> = Vec::new();
    while steps.len() < MOST {
        let (mut without, mut new) = (log.clone(), remaining_steps(&finding));
        for step in &mut new {
            (without, step.0) = self::without(&without, step.0, step.1);
        }
        if new.is_empty() || comes_back(&new, &log) {
            break;
        }
        let next = ask(std::slice::from_ref(&without))?;
        if !is_better(&next, &finding) || may_be_an_effect(&next, &finding, new.len()) {
            break;
        }
        steps.extend(new);
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        (finding, log) = (next, without);
    }
    for curves in &mut finding.curves {
        correct(&mut steps, curves);
    }
    finding.notes.splice(0..0, steps.into_iter().map(in_words));
    Ok(finding)
}

/// Whether a step is taken back by the next, as soon as an episode is over: that is no zero but something that happens
/// meanwhile. A hand that pushed a stage for 0.3 s of 20 made steps of 9 and −9 N.
fn comes_back(steps: &[(f64, f64)], log: &UniformLog) -> bool {
    let soon_s = SHORT * log.len() as f64 * log.period_s();
    steps.windows(2).any(|pair| {
        let [(from_s, there_n), (to_s, back_n)] = [pair[0], pair[1]];
        to_s - from_s < soon_s && (there_n + back_n).abs() < BACK * there_n.abs()
    })
}

/// A log without a force (N) from about an instant (s) on, and the instant: the sample near it at which the force jumps
/// most.
fn without(log: &UniformLog, about_s: f64, force_n: f64) -> (UniformLog, f64) {
    let mut log = log.clone();
    let mut at_s = about_s;
    let taken = log.taken.iter_mut();
    let taken = taken.map(|own| (&own.time_s, &mut own.force_n));
    for (time_s, channel) in taken.chain([(&log.time_s, &mut log.force_n)]) {
        let about = time_s.partition_point(|stamp| *stamp < about_s);
        let near = about.saturating_sub(NEAR).max(1)..(about + NEAR).min(channel.len());
        let jump = |at: &usize| (channel[*at] - channel[*at - 1]) * force_n;
        let at = near.max_by(|a, b| jump(a).total_cmp(&jump(b)));
        let at = at.unwrap_or(about);
        let after = channel.iter_mut().skip(at);
        after.for_each(|force| *force -= force_n);
        at_s = time_s.get(at).copied().unwrap_or(about_s);
    }
    log.compensated.stepped_s.push(at_s);
    log.compensated.stepped_s.sort_by(f64::total_cmp);
    (log, at_s)
}

/// Whether a finding without a step leaves much less than the one with it, or no more with fewer effects.
pub(super) fn is_better(without: &Finding, with: &Finding) -> bool {
    let left = without.rmse_after_n / with.rmse_after_n;
    left < LESS || left < AS_MUCH && without.effects.len() < with.effects.len()
}

/// Whether effects in the place of so many steps do as well: on a machine that went up and came down once a friction
/// does. Where none was tried they may.
pub(super) fn may_be_an_effect(without: &Finding, with: &Finding, steps: usize) -> bool {
    let most = BY_ONE_EFFECT * without.ratio_after;
    let sets = 1..=without.effects.len() + steps;
    let tried = with
        .ladder
        .iter()
        .filter(|own| sets.contains(&own.ids.len()));
    let least = tried.map(|own| own.ratio).reduce(f64::min);
    least.is_none_or(|ratio| ratio < most)
}

/// Instants (s) and amounts (N) of the steps that are much of what remains, or of what the base leaves.
fn remaining_steps(finding: &Finding) -> Vec<(f64, f64)> {
    together(finding, MUCH, Region::step)
}

/// The steps of a kind that together are more than a share of what remains, or of what the base leaves.
pub(super) fn together<T>(
    finding: &Finding,
    share: f64,
    of: impl Fn(&Region) -> Option<T>,
) -> Vec<T> {
    for regions in [&finding.remaining, &finding.disagreement] {
        let steps = regions.iter().filter_map(|own| Some((own.share, of(own)?)));
        let (shares, steps): (Vec<f64>, Vec<T>) = steps.unzip();
        if shares.iter().sum::<f64>() > share {
            return steps;
        }
    }
    Vec::new()
}

/// Corrects the amounts of steps by what the last fit leaves after each, and the curves by that.
fn correct(steps: &mut [(f64, f64)], curves: &mut Curves) {
    let start = |at_s: f64| curves.time_s.partition_point(|stamp| *stamp < at_s);
    let starts: Vec<usize> = steps.iter().map(|own| start(own.0)).collect();
    let mut before_n = 0.0;
    for (number, (_, force_n)) in steps.iter_mut().enumerate() {
        let end = starts.get(number + 1).copied();
        let rows = starts[number]..end.unwrap_or(curves.time_s.len());
        let measured = &mut curves.measured_n[rows.clone()];
        let pairs = measured.iter().zip(&curves.after_n[rows]);
        let sum: f64 = pairs.map(|(measured, after)| measured - after).sum();
        let mean_n = sum / measured.len().max(1) as f64;
        measured.iter_mut().for_each(|own| *own -= mean_n);
        // Each is what a step is more off than the one before it.
        *force_n += mean_n - before_n;
        before_n = mean_n;
    }
}

fn in_words((at_s, force_n): (f64, f64)) -> String {
    format!(
        "the force steps by {} at {at_s:.2} s and stays off, as after a tare, a power cycle or a knock: taken off",
        quantity(force_n, 3, "N")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Log;

    #[test]
    fn a_force_is_taken_off_from_the_sample_at_which_it_jumps() {
        let time: Vec<f64> = (0..400).map(|at| 1e-2 * f64::from(at)).collect();
        let force = time.iter().map(|t| if *t > 1.995 { 1.0 } else { 0.0 });
        let log = Log::from_channels(time.clone(), time.clone(), force.collect());
        let log = log.uniform().unwrap();
        // GIVEN an instant that is known to some samples, and an amount to a tenth
        let (without, at_s) = without(&log, 2.05, 0.9);
        assert!((at_s - 2.0).abs() < 1e-9, "{at_s}");
        assert_eq!(without.compensated.stepped_s, [at_s]);
        let left = &without.force_n;
        assert!(left[..200].iter().all(|force| *force == 0.0));
        assert!(left[200..].iter().all(|force| (force - 0.1).abs() < 1e-12));
    }

    #[test]
    fn the_amounts_of_steps_are_what_the_last_fit_says() {
        let rows = |from: usize| (0..300).map(move |at| f64::from(u8::from(at >= from)));
        // GIVEN steps of 0.5 N after 100 samples and −0.3 N after 200, of which 0.4 and −0.1 N were taken off
        let measured = rows(100).zip(rows(200)).map(|(a, b)| 0.1 * a - 0.2 * b);
        let mut curves = Curves {
            time_s: (0..300).map(f64::from).collect(),
            measured_n: measured.collect(),
            after_n: vec![0.0; 300],
            ..Curves::default()
        };
        let mut steps = [(100.0, 0.4), (200.0, -0.1)];
        correct(&mut steps, &mut curves);
        let [(_, first), (_, second)] = steps;
        assert!(
            (first - 0.5).abs() < 1e-12 && (second + 0.3).abs() < 1e-12,
            "{steps:?}"
        );
        assert!(curves.measured_n.iter().all(|force| force.abs() < 1e-12));
    }
}
