//! Where a model and the logs disagree: the energy of the residuals above the noise, by the phase of the
//! contact, by depth, by speed and by time. Where nothing is touched, by the way it goes instead of the phase and by
//! its place in the travel instead of the depth.
//!
//! A region is named when its excess is significant against the noise. Benjamini and Hochberg's
//! procedure keeps the share of false names among them low.

use crate::gap::finding::Region;
use crate::gap::say::{lines::lines, log_residuals::LogResiduals};
use crate::gap::thresholds::Regions;
use crate::phase::{Course, PHASES};
use crate::stats::{lowest, median, range};

/// The regions in which the excess is significant, the largest share first.
pub(crate) fn regions(
    logs: &[LogResiduals<'_>],
    correlation: f64,
    decide: &Regions,
) -> Vec<Region> {
    let mut tallies = Tallies::default();
    logs.iter().for_each(|log| tallies.add_log(log));
    let mut tested: Vec<(f64, Region)> = tallies
        .regions
        .iter()
        .filter(|(_, tally)| tally.count >= decide.fewest_samples)
        .map(|(id, tally)| {
            let region = tally.region(id, tallies.whole_n2(id), tallies.total.count);
            (tally.p_value(correlation), region)
        })
        .collect();
    tested.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut regions: Vec<Region> = discoveries(tested, decide.false_discoveries);
    regions.retain(|region| region.share > decide.least_share);
    regions.sort_by(|a, b| b.share.total_cmp(&a.share));
    if !regions.is_empty() {
        let first = logs.first().into_iter();
        regions.extend(first.flat_map(|log| lines(log, decide.line_share)));
    }
    regions
}

/// Benjamini and Hochberg's procedure on regions that are sorted by their p-values.
fn discoveries(tested: Vec<(f64, Region)>, false_share: f64) -> Vec<Region> {
    let count = tested.len() as f64;
    let is_below = |(rank, (p_value, _)): &(usize, &(f64, Region))| {
        *p_value <= false_share * (*rank as f64 + 1.0) / count
    };
    let last = tested.iter().enumerate().rfind(is_below);
    let named = last.map_or(0, |(rank, _)| rank + 1);
    let named = tested.into_iter().take(named);
    named.map(|(_, region)| region).collect()
}

/// The tallies of all regions.
#[derive(Default)]
struct Tallies {
    regions: Vec<(&'static str, Tally)>,
    total: Tally,
}

impl Tallies {
    fn add_log(&mut self, residuals: &LogResiduals<'_>) {
        let LogResiduals {
            log,
            depth_m,
            residuals,
            variances,
        } = residuals;
        let course = Course::of(depth_m, &log.speed_mps);
        let (lowest_m, travel_m) = (
            lowest(log.position_m.iter().copied()),
            range(&log.position_m),
        );
        let speeds = log.speed_mps.iter().map(|v| v.abs());
        let median_mps = median(speeds.filter(|v| !course.is_still(*v)));
        for at in (0..log.len()).filter(|at| variances[*at] > 0.0) {
            let (depth, speed) = (depth_m[at], log.speed_mps[at]);
            let (square, variance) = (residuals[at].powi(2), variances[at]);
            let mut add = |id: &'static str| self.add(id, square, variance);
            add(course.phase(depth, speed));
            if depth > 0.0 {
                add(["depth_low", "depth_mid", "depth_high"][third(depth / course.deepest_m)]);
            } else if course.deepest_m <= 0.0 && travel_m > 0.0 {
                let share = (log.position_m[at] - lowest_m) / travel_m;
                add(["travel_low", "travel_mid", "travel_high"][third(share)]);
            }
            if !course.is_still(speed) {
                let is_slow = speed.abs() < median_mps;
                add(if is_slow { "slow" } else { "fast" });
            }
            let is_early = 2 * at < log.len();
            add(if is_early { "early" } else { "late" });
            self.total.add(square, variance);
        }
    }

    /// The excess (N²) of which a region has its share: that of all samples, or of all regions of its cut that have any. One
    /// in which there is less than the noise makes no other more than all.
    fn whole_n2(&self, id: &str) -> f64 {
        let own = self.regions.iter().filter(|(of, _)| cut(of) == cut(id));
        let whole: f64 = own.map(|(_, tally)| tally.excess_n2.max(0.0)).sum();
        whole.max(self.total.excess_n2)
    }

    fn add(&mut self, id: &'static str, square: f64, variance: f64) {
        match self.regions.iter_mut().find(|(of, _)| *of == id) {
            Some((_, tally)) => tally.add(square, variance),
            None => {
                let mut tally = Tally::default();
                tally.add(square, variance);
                self.regions.push((id, tally));
            }
        }
    }
}

/// Which way of cutting the log a region is of: by phase, depth or travel, speed, time.
fn cut(id: &str) -> usize {
    match id {
        "slow" | "fast" => 2,
        "early" | "late" => 3,
        _ if PHASES.contains(&id) => 0,
        _ => 1,
    }
}

/// The third in which a share lies.
fn third(share: f64) -> usize {
    ((3.0 * share) as usize).min(2)
}

/// Sums over the samples of a region.
#[derive(Clone, Copy, Default)]
struct Tally {
    excess_n2: f64,
    energy_n2: f64,
    /// Σ(r²/σ² − 1)
    surprise: f64,
    count: f64,
}

impl Tally {
    fn add(&mut self, square: f64, variance: f64) {
        self.excess_n2 += square - variance;
        self.energy_n2 += square;
        self.surprise += square / variance - 1.0;
        self.count += 1.0;
    }

    /// The probability that noise alone gives as much surprise: χ² of many degrees of freedom is normal.
    fn p_value(&self, correlation: f64) -> f64 {
        let deviations = self.surprise / (2.0 * self.count * correlation).sqrt();
        0.5 * libm::erfc(deviations / std::f64::consts::SQRT_2)
    }

    /// The region, of a `whole_n2` excess and so many samples in all.
    fn region(&self, id: &'static str, whole_n2: f64, count: f64) -> Region {
        Region {
            id,
            share: (self.excess_n2 / whole_n2.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0),
            rms_n: (self.energy_n2 / self.count).sqrt(),
            samples: self.count / count,
            pattern: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_one_cut_are_no_more_than_all_where_a_region_is_below_the_noise() {
        // GIVEN 9 N² in loading, 3 N² in holds, and free air that is 8 N² below its noise
        let mut tallies = Tallies::default();
        let mut add = |id: &'static str, square: f64, variance: f64| {
            tallies.add(id, square, variance);
            tallies.total.add(square, variance);
        };
        add("loading", 10.0, 1.0);
        add("hold", 4.0, 1.0);
        add("free", 1.0, 9.0);
        let share = |(id, tally): &(&'static str, Tally)| {
            tally
                .region(id, tallies.whole_n2(id), tallies.total.count)
                .share
        };
        let shares: Vec<f64> = tallies.regions.iter().map(share).collect();
        assert_eq!(shares, [0.75, 0.25, 0.0]);
    }

    #[test]
    fn the_deepest_is_in_the_last_third() {
        assert_eq!([0.0, 0.34, 0.99, 1.0].map(third), [0, 1, 2, 2]);
    }
}
