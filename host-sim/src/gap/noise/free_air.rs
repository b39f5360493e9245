//! Where a log is in free air, and where it rests there.

use std::ops::Range;

use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::signal;
use crate::stats::{lowest, range, rms};

/// Most samples in a row that may be invented in a rest. With 30 % of them missing 128 in a row are never
/// measured, and what is there at rest was not seen at all.
const LONGEST_GAP: usize = 8;
/// `rests_agree` where nothing is touched, with its reason there.
const RESTS_AGREE: f64 = 2.0;

impl Floor {
    /// What decides where nothing is touched: the outermost part of the travel may be an end that is held.
    pub(crate) fn without_free_air(self) -> Floor {
        Floor {
            fewest_at_rest: self.shortest_rest,
            rests_agree: RESTS_AGREE,
            ..self
        }
    }
}

/// For each sample, whether it is measured in free air: in the quarter of the travel that is furthest out.
pub(super) fn in_free_air(log: &UniformLog, decide: &Floor) -> Vec<bool> {
    let deepest_m = deepest_in_free_air_m(&log.position_m, decide);
    let each = log.position_m.iter().zip(&log.in_gap);
    each.map(|(x, gap)| *x <= deepest_m && !gap).collect()
}

fn deepest_in_free_air_m(position_m: &[f64], decide: &Floor) -> f64 {
    let lowest = lowest(position_m.iter().copied());
    lowest + decide.free_air * range(position_m)
}

/// The rests in free air: stretches in which the position stays within two counts.
pub(super) fn rests(log: &UniformLog, decide: &Floor) -> Vec<Range<usize>> {
    if decide.rests_agree > 0.0 {
        let all = rests_up_to(f64::INFINITY, log, decide);
        if agree(&all, log, decide) {
            return all;
        }
        let at_no_force = without_force(&all, log, decide);
        if !at_no_force.is_empty() {
            return at_no_force;
        }
    }
    rests_up_to(deepest_in_free_air_m(&log.position_m, decide), log, decide)
}

/// Whether rests, two at least, are all at one force, and that is not what an end is held with: at no force, or at more
/// than one place.
fn agree(rests: &[Range<usize>], log: &UniformLog, decide: &Floor) -> bool {
    let mean = |channel: &[f64]| channel.iter().sum::<f64>() / channel.len() as f64;
    let means = |channel: &[f64]| -> Vec<f64> {
        let each = rests.iter().map(|rest| mean(&channel[rest.clone()]));
        each.collect()
    };
    let (forces_n, places_m) = (means(&log.force_n), means(&log.position_m));
    let at_rest = rests.iter().zip(&forces_n).flat_map(|(rest, mean)| {
        let away = move |force: &f64| force - mean;
        log.force_n[rest.clone()].iter().map(away)
    });
    let most_n = decide.rests_agree * rms(at_rest);
    let is_apart = range(&places_m) > decide.free_air * range(&log.position_m);
    rests.len() > 1
        && range(&forces_n) <= most_n
        && (is_apart || forces_n.iter().all(|force| force.abs() <= most_n))
}

/// The rests at no force, as before a machine starts: those that a friction or a weight holds may be held with anything. Of
/// twenty dampers and gears without a rest on the outer quarter of their travel 14 were `unexplained` under 1/f noise.
fn without_force(rests: &[Range<usize>], log: &UniformLog, decide: &Floor) -> Vec<Range<usize>> {
    let is_without = |rest: &&Range<usize>| {
        let forces_n = &log.force_n[(*rest).clone()];
        let mean_n = forces_n.iter().sum::<f64>() / forces_n.len() as f64;
        mean_n.abs() <= decide.rests_agree * rms(forces_n.iter().map(|force| force - mean_n))
    };
    rests.iter().filter(is_without).cloned().collect()
}

/// The rests no further in than a position.
fn rests_up_to(deepest_m: f64, log: &UniformLog, decide: &Floor) -> Vec<Range<usize>> {
    let position = &log.position_m;
    let counts = |samples: usize| {
        let is_long = samples as f64 >= decide.least_rest_s * log.rate_hz;
        samples as f64 >= decide.shortest_rest || is_long && samples as f64 >= decide.fewest_at_rest
    };
    let still_m =
        decide.rest_steps * signal::step(position).unwrap_or(signal::noise(position) * 4.0);
    let mut rests = Vec::new();
    let (mut from, mut invented) = (0, 0);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (at, x) in position.iter().copied().enumerate() {
        let (lower, higher) = (low.min(x), high.max(x));
        invented = if log.in_gap[at] { invented + 1 } else { 0 };
        if higher - lower > still_m || x > deepest_m || invented > LONGEST_GAP {
            if counts(at - from) {
                rests.push(from..at);
            }
            from = at + 1;
            (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        } else {
            (low, high) = (lower, higher);
        }
    }
    if counts(position.len() - from.min(position.len())) {
        rests.push(from..position.len());
    }
    rests
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::thresholds::Thresholds;
    use crate::log::Log;

    /// Two strokes of ±1 mm with rests of a second in the middle, at these forces (N), in a noise of 1 N.
    fn rests_of(held_n: [f64; 2]) -> usize {
        let time_s: Vec<f64> = (0..4000).map(|at| 1e-3 * f64::from(at)).collect();
        let is_rest = |t: f64| (t as u32).is_multiple_of(2);
        let position = |t: f64| match is_rest(t) {
            true => 0.0,
            false => 1e-3 * (std::f64::consts::TAU * t).sin(),
        };
        let position_m = time_s.iter().map(|t| position(*t)).collect();
        let force =
            |at: i32| held_n[(at / 2000) as usize] + (f64::from(at * at * 7 % 101) - 50.0) / 29.0;
        let force_n = (0..4000).map(force).collect();
        let log = Log::from_channels(time_s, position_m, force_n);
        let floor = Thresholds::default().floor;
        rests(&log.uniform().unwrap(), &floor.without_free_air()).len()
    }

    #[test]
    fn a_rig_that_touches_nothing_rests_anywhere_where_no_friction_holds_it() {
        assert_eq!(rests_of([0.0, 0.0]), 2);
        // A friction may hold one of them, not the one at no force.
        assert_eq!(rests_of([0.0, 5.0]), 1);
        assert_eq!(rests_of([4.0, 5.0]), 0);
        // At one place and one force an end may be held.
        assert_eq!(rests_of([5.0, 5.0]), 0);
    }
}
