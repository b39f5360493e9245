//! Where a model and the log disagree: the residuals' energy above the floor, by what the probe does,
//! by depth, by speed, by time, and in lines of frequency and of pitch.
//!
//! A region is named when its excess is significant against the floor; Benjamini & Hochberg's
//! procedure keeps the share of false names among them at 1 %.

use crate::gap::finding::Region;
use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::gap::data::fit_data::Course;
use crate::gap::data::scales::quantile;

/// Share of false names.
const FALSE_DISCOVERIES: f64 = 0.01;
/// Depths below this share of the deepest are the touch and the lift-off.
const NEAR: f64 = 0.05;
/// Speeds below this share of the usual are a hold.
const STILL: f64 = 0.02;
/// A line must hold this share of the residual's energy.
const LEAST_LINE: f64 = 0.1;

/// One log's residuals with what is needed to sort them.
pub(in crate::gap) struct Sorted<'a> {
    pub(in crate::gap) course: &'a Course,
    /// Penetration (m).
    pub(in crate::gap) depth_m: &'a [f64],
    /// Residuals (N), and the variances (N²) that they should have, 0 where they say nothing.
    pub(in crate::gap) residuals: &'a [f64],
    pub(in crate::gap) variances: &'a [f64],
}

#[derive(Clone, Copy, Default)]
struct Tally {
    excess_n2: f64,
    energy_n2: f64,
    /// Σ(r²/σ² − 1)
    surprise: f64,
    count: f64,
}

/// The phase that the probe is in.
pub(crate) fn phase(depth_m: f64, speed_mps: f64, deepest_m: f64, usual_mps: f64) -> &'static str {
    let near_m = NEAR * deepest_m;
    if depth_m <= -near_m {
        "free"
    } else if depth_m < near_m && speed_mps > STILL * usual_mps {
        "touch"
    } else if depth_m < near_m && speed_mps < -STILL * usual_mps {
        "lift_off"
    } else if depth_m <= 0.0 {
        "free"
    } else if speed_mps.abs() <= STILL * usual_mps {
        "hold"
    } else if speed_mps > 0.0 {
        "loading"
    } else {
        "unloading"
    }
}

/// The regions in which the excess is significant, largest share first.
pub(in crate::gap) fn regions(logs: &[Sorted<'_>], correlation: f64) -> Vec<Region> {
    let mut tallies: Vec<(&'static str, Tally)> = Vec::new();
    let mut total = Tally::default();
    for log in logs {
        let course = log.course;
        let deepest_m = log.depth_m.iter().copied().fold(0.0, f64::max);
        let mut speeds: Vec<f64> = course.speed_mps.iter().map(|v| v.abs()).collect();
        speeds.sort_unstable_by(f64::total_cmp);
        let usual_mps = quantile(&speeds, 0.95);
        let moving = &speeds[speeds.partition_point(|v| *v <= STILL * usual_mps)..];
        let typical_mps = quantile(moving, 0.5);
        for at in (0..course.len()).filter(|at| log.variances[*at] > 0.0) {
            let (depth, speed) = (log.depth_m[at], course.speed_mps[at]);
            let (square, variance) = (log.residuals[at].powi(2), log.variances[at]);
            let mut add = |id: &'static str| {
                let tally = match tallies.iter_mut().find(|own| own.0 == id) {
                    Some(own) => &mut own.1,
                    None => {
                        tallies.push((id, Tally::default()));
                        &mut tallies.last_mut().expect("just pushed").1
                    }
                };
                tally.add(square, variance);
            };
            add(phase(depth, speed, deepest_m, usual_mps));
            if depth > 0.0 && deepest_m > 0.0 {
                let third = (3.0 * depth / deepest_m) as usize;
                add(["depth_low", "depth_mid", "depth_high"][third.min(2)]);
            }
            if speed.abs() > STILL * usual_mps {
                add(if speed.abs() < typical_mps {
                    "slow"
                } else {
                    "fast"
                });
            }
            add(if 2 * at < course.len() {
                "early"
            } else {
                "late"
            });
            total.add(square, variance);
        }
    }
    let mut tested: Vec<(f64, Region)> = tallies
        .into_iter()
        .filter(|(_, tally)| tally.count >= 10.0)
        .map(|(id, tally)| (tally.chance(correlation), tally.region(id, &total)))
        .collect();
    tested.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = tested.len() as f64;
    let named = tested
        .iter()
        .enumerate()
        .filter(|(rank, (chance, _))| *chance <= FALSE_DISCOVERIES * (*rank as f64 + 1.0) / count)
        .map(|(rank, _)| rank + 1)
        .next_back()
        .unwrap_or(0);
    let mut regions: Vec<Region> = tested
        .into_iter()
        .take(named)
        .map(|(_, region)| region)
        .collect();
    regions.retain(|region| region.share > 0.02);
    regions.sort_by(|a, b| b.share.total_cmp(&a.share));
    if !regions.is_empty() {
        regions.extend(logs.first().into_iter().flat_map(lines));
    }
    regions
}

impl Tally {
    fn add(&mut self, square: f64, variance: f64) {
        self.excess_n2 += square - variance;
        self.energy_n2 += square;
        self.surprise += square / variance - 1.0;
        self.count += 1.0;
    }

    /// Chance of so much surprise from noise alone: χ² of many degrees is normal.
    fn chance(&self, correlation: f64) -> f64 {
        let deviations = self.surprise / (2.0 * self.count * correlation).sqrt();
        0.5 * libm::erfc(deviations / std::f64::consts::SQRT_2)
    }

    fn region(&self, id: &'static str, total: &Tally) -> Region {
        Region {
            id,
            share: (self.excess_n2 / total.excess_n2.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0),
            rms_n: (self.energy_n2 / self.count).sqrt(),
            samples: self.count / total.count,
            hz: None,
            pitch_m: None,
        }
    }
}

/// The strongest line in time and the strongest along the way, if they hold a tenth of the energy.
fn lines(log: &Sorted<'_>) -> Vec<Region> {
    let course = log.course;
    let own: Vec<f64> = (0..course.len())
        .map(|at| {
            if log.variances[at] > 0.0 {
                log.residuals[at]
            } else {
                0.0
            }
        })
        .collect();
    let energy: f64 = own.iter().map(|r| r * r).sum();
    let count = own.len() as f64;
    let region = |id, share: f64, hz, pitch_m| Region {
        id,
        share,
        rms_n: (share * energy / count).sqrt(),
        samples: 1.0,
        hz,
        pitch_m,
    };
    let mut found = Vec::new();
    let mut bins: Vec<Complex<f64>> = own.iter().map(|r| Complex::new(*r, 0.0)).collect();
    FftPlanner::new()
        .plan_fft_forward(bins.len())
        .process(&mut bins);
    let power = |at: usize| 2.0 * bins[at].norm_sqr() / (count * energy.max(f64::MIN_POSITIVE));
    let strongest = (4..bins.len() / 2).max_by(|a, b| power(*a).total_cmp(&power(*b)));
    if let Some(at) = strongest.filter(|at| course.even && power(*at) > LEAST_LINE) {
        let hz = at as f64 / (count * course.period_s);
        found.push(region("line", power(at).min(1.0), Some(hz), None));
    }
    let lowest = course
        .position_m
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let travel = course
        .position_m
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max)
        - lowest;
    let stride = (course.len() / 3000).max(1);
    let along = |halves: usize| {
        let per_m = TAU * 0.5 * halves as f64 / travel.max(f64::MIN_POSITIVE);
        let (mut re, mut im, mut energy) = (0.0, 0.0, 0.0);
        for at in (0..own.len()).step_by(stride) {
            let (sin, cos) = (per_m * course.position_m[at]).sin_cos();
            re += own[at] * cos;
            im += own[at] * sin;
            energy += own[at] * own[at];
        }
        let used = own.len().div_ceil(stride) as f64;
        2.0 * (re * re + im * im) / (used * energy.max(f64::MIN_POSITIVE))
    };
    let finest = (travel / (16.0 * course.position_noise_m)).clamp(4.0, 200.0) as usize;
    let shares: Vec<f64> = (6..2 * finest).map(along).collect();
    let best = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
    if let Some(at) = best.filter(|at| shares[*at] > LEAST_LINE) {
        let pitch_m = 2.0 * travel / (at + 6) as f64;
        found.push(region("pitch", shares[at].min(1.0), None, Some(pitch_m)));
    }
    found
}
