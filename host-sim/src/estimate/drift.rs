//! A resting force that drifts from touch to touch.
//!
//! The zero is taken in free air, and within a touch it goes on: what it drifts by then is taken from the force on the way
//! in and added on the way out, as a damper does. A load cell that drifted by 20 mN/s took 13 % off a damping of
//! 10 N s/m, which was converged.

use std::ops::Range;

use super::damping::{MATTERS, carried};
use super::outcome::Outcome;
use crate::log::UniformLog;
use crate::number::quantity;
use crate::replay::Replay;
use crate::stats::{median, robust_deviation};

/// Fewest stretches of free air that a drift is told from.
const FEWEST_RESTS: usize = 4;
/// Fewest samples of free air in one.
const FEWEST_SAMPLES: usize = 20;
/// At either end of one, as a share of it, a contact may still pull or already push.
const MARGIN: f64 = 0.25;
/// Most of them, evenly spread: an hour of taps has 36 000, and their pairs are 5 GB.
const MOST_RESTS: usize = 512;
/// A drift counts beyond so many of its standard errors.
const SIGMAS: f64 = 5.0;

/// A drift that bends the damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    rate_n_per_s: f64,
    /// Share of the force of the damping.
    bends: f64,
}

impl Drift {
    /// The drift of a log, if the damping that was estimated feels it.
    pub(super) fn of(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> Option<Drift> {
        let rate_n_per_s = rate(&rests(log, &replay.contacts()))?;
        let bends = (rate_n_per_s * carried(replay, outcome, |now| now.since_s)?).abs();
        (bends > MATTERS).then_some(Drift {
            rate_n_per_s,
            bends,
        })
    }

    /// A sentence for people.
    pub(super) fn sentence(&self) -> String {
        format!(
            "the resting force drifts by {} from touch to touch, and within a touch the damping takes that on, about {:.0} % \
             of it: --compensate takes off a force_drift of a model, which palpate gap finds",
            quantity(self.rate_n_per_s, 2, "N/s"),
            100.0 * self.bends
        )
    }
}

/// The stretches of free air before, between and after touches: their times (s) and forces (N).
fn rests(log: &UniformLog, touches: &[Range<usize>]) -> Vec<(f64, f64)> {
    let rest = |inside: Range<usize>| {
        let middle_s = log.time_s[(inside.start + inside.end) / 2];
        let force = inside.filter(|at| log.has_force(*at));
        let force: Vec<f64> = force.map(|at| log.force_n[at]).collect();
        (force.len() >= FEWEST_SAMPLES).then(|| (middle_s, median(force)))
    };
    let each = free_air(log, touches, MARGIN).step_by((touches.len() + 1).div_ceil(MOST_RESTS));
    each.filter_map(rest).collect()
}

/// The samples of free air before, between and after touches, without a margin at either end (a share of each).
pub(super) fn free_air(
    log: &UniformLog,
    touches: &[Range<usize>],
    margin: f64,
) -> impl Iterator<Item = Range<usize>> {
    let ends = touches.iter().map(|touch| touch.end);
    let starts = touches.iter().map(|touch| touch.start);
    let each = std::iter::once(0)
        .chain(ends)
        .zip(starts.chain([log.len()]));
    let inside = move |(from, to): (usize, usize)| {
        let margin = (margin * to.saturating_sub(from) as f64) as usize;
        from + margin..to.saturating_sub(margin)
    };
    each.map(inside).filter(|inside| !inside.is_empty())
}

/// The rate (N/s) of the line through resting forces, if it is significant: the median slope of all pairs, and the
/// scatter about that line.
fn rate(rests: &[(f64, f64)]) -> Option<f64> {
    if rests.len() < FEWEST_RESTS {
        return None;
    }
    let pairs = (0..rests.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let slope = |(a, b): (usize, usize)| (rests[b].1 - rests[a].1) / (rests[b].0 - rests[a].0);
    let rate = median(pairs.map(slope));
    let count = rests.len() as f64;
    let mean_s = rests.iter().map(|rest| rest.0).sum::<f64>() / count;
    let spread_s2: f64 = rests.iter().map(|rest| (rest.0 - mean_s).powi(2)).sum();
    let scatter_n = robust_deviation(rests.iter().map(|(at_s, force_n)| force_n - rate * at_s));
    let std_error = scatter_n / spread_s2.sqrt();
    (rate.abs() > SIGMAS * std_error).then_some(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_that_of_the_resting_forces_and_none_of_their_scatter() {
        let scatter = [1.0, -2.0, 2.0, -1.0, 1.0, -1.0, 2.0, -2.0];
        let rests = |rate: f64| -> Vec<(f64, f64)> {
            let each = scatter.iter().enumerate();
            each.map(|(at, own)| (at as f64, rate * at as f64 + 1e-3 * own))
                .collect()
        };
        // GIVEN eight rests, a second from each other, that scatter by 1.6 mN
        let found = rate(&rests(0.02)).expect("it drifts");
        assert!((found - 0.02).abs() < 1e-3, "{found}");
        // THEN 0.5 mN/s are none of a drift, AND three rests tell nothing.
        assert_eq!(rate(&rests(5e-4)), None);
        assert_eq!(rate(&rests(0.02)[..3]), None);
    }
}
