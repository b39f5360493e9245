//! A force that opposes the motion in free air: a friction of the guide, or a drag.
//!
//! In contact it acts as well, and a damping takes it on: 10 mN, half of the noise, made 6.07 ± 0.05 N s/m of 5, and
//! nothing showed it. Free air does.

use super::damping::{MATTERS, carried};
use super::drift::free_air;
use super::outcome::Outcome;
use crate::log::UniformLog;
use crate::number::quantity;
use crate::replay::Replay;
use crate::stats::median;

/// Fewest ways in, and out, that it is told from.
const FEWEST_WAYS: usize = 3;
/// Fewest samples of one.
const FEWEST_SAMPLES: usize = 20;
/// The share of a stretch of free air at either end in which a contact may still pull or already push.
const MARGIN: f64 = 0.02;
/// A sample moves at more than this share of the fastest speed: an encoder trembles at rest.
const MOVING: f64 = 0.05;
/// A friction counts beyond so many of its standard errors.
const SIGMAS: f64 = 5.0;

/// A friction that bends the damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Friction {
    force_n: f64,
    /// Share of the force of the damping.
    bends: f64,
}

impl Friction {
    /// The friction of a log, if the damping that was estimated feels it.
    pub(super) fn of(log: &UniformLog, replay: &Replay, outcome: &Outcome) -> Option<Friction> {
        let force_n = in_free_air(log, replay)?;
        let bends = carried(replay, outcome, |now| force_n * now.speed_mps.signum())?.abs();
        (bends > MATTERS).then_some(Friction { force_n, bends })
    }

    /// A sentence for people.
    pub(super) fn sentence(&self) -> String {
        format!(
            "in free air a force of {} opposes the motion, a friction or a drag, and in contact the damping takes that on, \
             about {:.0} % of it: --compensate takes off what palpate gap finds",
            quantity(self.force_n, 2, "N"),
            100.0 * self.bends
        )
    }
}

/// Half of what the force in free air is larger on the way in than on the way out (N), if that is significant.
fn in_free_air(log: &UniformLog, replay: &Replay) -> Option<f64> {
    let speed_mps = |at: usize| f64::from(replay.records.speed_mps(at));
    let fastest_mps = (0..log.len())
        .map(|at| speed_mps(at).abs())
        .fold(0.0, f64::max);
    let mut ways = [Vec::new(), Vec::new()];
    for rest in free_air(log, &replay.contacts(), MARGIN) {
        let samples: Vec<usize> = rest.filter(|at| log.has_force(*at)).collect();
        for (way, sign) in ways.iter_mut().zip([1.0, -1.0]) {
            let is_moving = |at: &&usize| sign * speed_mps(**at) > MOVING * fastest_mps;
            let moving = samples.iter().filter(is_moving);
            let force: Vec<f64> = moving.map(|at| log.force_n[*at]).collect();
            if force.len() >= FEWEST_SAMPLES {
                way.push(median(force));
            }
        }
    }
    opposing(&ways)
}

/// Half of the difference between the means of two lists (N), if that is significant and not negative.
fn opposing([inwards, outwards]: &[Vec<f64>; 2]) -> Option<f64> {
    if inwards.len().min(outwards.len()) < FEWEST_WAYS {
        return None;
    }
    let count = |way: &[f64]| way.len() as f64;
    let mean = |way: &[f64]| way.iter().sum::<f64>() / count(way);
    let squares = |way: &[f64]| way.iter().map(|own| (own - mean(way)).powi(2)).sum::<f64>();
    let freedom = count(inwards) + count(outwards) - 2.0;
    let scatter = ((squares(inwards) + squares(outwards)) / freedom).sqrt();
    let std_error = 0.5 * scatter * (1.0 / count(inwards) + 1.0 / count(outwards)).sqrt();
    let half = 0.5 * (mean(inwards) - mean(outwards));
    (half > SIGMAS * std_error).then_some(half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_opposes_the_motion_is_half_of_what_the_ways_differ_by() {
        let ways = |friction: f64| {
            let scatter = [1.0, -2.0, 2.0, -1.0, 1.0, -1.0];
            [1.0, -1.0].map(|sign| {
                let each = scatter.iter();
                each.map(|own| sign * friction + 1e-3 * own)
                    .collect::<Vec<f64>>()
            })
        };
        let found = opposing(&ways(0.01)).expect("it rubs");
        assert!((found - 0.01).abs() < 1e-3, "{found}");
        // 1 mN is none beside a scatter of 1.5 mN, a force that helps the motion is no friction, AND two ways say nothing.
        assert_eq!(opposing(&ways(1e-3)), None);
        assert_eq!(opposing(&ways(-0.01)), None);
        let few = ways(0.01).map(|way| way[..2].to_vec());
        assert_eq!(opposing(&few), None);
    }
}
