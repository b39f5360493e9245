//! Where a log is in free air, and where it rests there.

use std::ops::Range;

use crate::gap::thresholds::Floor;
use crate::log::UniformLog;
use crate::signal;
use crate::stats::{lowest, range};

/// Most samples in a row that may be invented in a rest. With 30 % of them missing 128 in a row are never
/// measured, and what is there at rest was not seen at all.
const LONGEST_GAP: usize = 8;

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
    let position = &log.position_m;
    let deepest_m = deepest_in_free_air_m(position, decide);
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
