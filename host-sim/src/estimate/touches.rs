//! Touches in figures that need no model, from the raw log: how hard, how deep, how stiff on average, what
//! was lost, and how much of the force a hold leaves.
//!
//! Forces are over the resting force, and depths count from where the force leaves its baseline: later than
//! the surface of a soft or relaxing contact, by as much as the noise hides.

use std::borrow::Cow;
use std::ops::Range;

use estimator_core::{Fault, Faults};

use crate::log::UniformLog;
use crate::replay::{Replay, Touch, between};
use crate::signal::parabola;
use crate::stats::{median, robust_deviation};

/// Half of the stretch (s) that a parabola smooths around a sample: one sample at 10 Hz, 5 at 1 kHz, 100 at
/// 20 kHz. A touch of 20 ms loses 1 % of its peak.
const SMOOTH_S: f64 = 5e-3;
/// The force has left its baseline above this many standard deviations of the smoothed force.
const LEAVES_SIGMAS: f64 = 3.0;
/// Fewest samples of free air that tell where a force rests.
const FEWEST_FREE: usize = 10;
/// The shortest hold (s), and its fewest samples.
const HOLD_S: f64 = 0.2;
const HOLD_SAMPLES: usize = 5;
/// A hold moves by less than this share of the depth reached.
const STILL: f64 = 0.01;
/// Share of a hold at its end that its last force is the mean of.
const LAST: f64 = 0.1;

/// Touches of a replayed log.
pub(super) fn touches(log: &UniformLog, replay: &Replay) -> Vec<Touch> {
    let smooth = Smooth::of(log, replay);
    each(log, replay, &smooth).map(|one| one.touch()).collect()
}

/// Where a force leaves its baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Departure {
    /// The last position (m) at which it is within its baseline, and the first at which it has left it
    /// however suddenly: a step begins to show before it, by half of the stretch that is smoothed over.
    pub(crate) from_m: f64,
    pub(crate) to_m: f64,
    /// Sample of the latter.
    pub(crate) at: usize,
    /// The longest way between two samples from the one to the other (m).
    pub(crate) step_m: f64,
    /// How far over rest (N) it is no longer within its baseline.
    pub(crate) over_n: f64,
}

/// Where the force of the shallowest touch leaves its baseline; `None` if the log does not show it.
pub(crate) fn departure(log: &UniformLog, replay: &Replay) -> Option<Departure> {
    let smooth = Smooth::of(log, replay);
    let departures = each(log, replay, &smooth).filter_map(|one| {
        let before = one.onset()?;
        let at = (before + 1 + smooth.half_width).min(log.len() - 1);
        let way = log.position_m[before..=at].windows(2);
        let steps = way.map(|pair| (pair[1] - pair[0]).abs());
        Some(Departure {
            from_m: log.position_m[before],
            step_m: steps.fold(0.0, f64::max),
            to_m: log.position_m[at],
            at,
            over_n: one.leaves_n,
        })
    });
    departures.min_by(|a, b| a.to_m.total_cmp(&b.to_m))
}

fn each<'a>(
    log: &'a UniformLog,
    replay: &'a Replay,
    smooth: &'a Smooth<'a>,
) -> impl Iterator<Item = One<'a>> {
    let contacts = replay.contacts();
    let ends: Vec<usize> = contacts.iter().map(|contact| contact.end).collect();
    let before = std::iter::once(0).chain(ends);
    let second = contacts.get(1).map_or(log.len(), |second| second.start);
    contacts
        .into_iter()
        .zip(before)
        .map(move |(contact, free_from)| {
            // Of a touch that the log begins in the rest is seen after it.
            let free = match contact.start {
                0 => contact.end..second,
                start => free_from..start,
            };
            let free: Vec<f64> = free.map(|at| smooth.force_n(at)).collect();
            let rest_n = match free.len() >= FEWEST_FREE {
                true => median(free.iter().copied()),
                false => f64::from(replay.rest_n[contact.start]),
            };
            // A baseline wanders more than its noise; the median does not see where it begins to rise.
            let strays = free.iter().map(|force| force - rest_n);
            let wander_n = match free.len() >= FEWEST_FREE {
                true => robust_deviation(strays),
                false => 0.0,
            };
            One {
                log,
                smooth,
                rest_n,
                leaves_n: LEAVES_SIGMAS * wander_n.max(replay.noise_n / smooth.averages),
                free_from,
                contact,
            }
        })
}

/// A force smoothed over a few milliseconds.
struct Smooth<'a> {
    log: &'a UniformLog,
    /// The force (N), with a line over each spike.
    bridged_n: Cow<'a, [f64]>,
    is_faulty: Vec<bool>,
    half_width: usize,
    /// Noise of a sample over that of a smoothed one.
    averages: f64,
}

impl<'a> Smooth<'a> {
    fn of(log: &'a UniformLog, replay: &Replay) -> Smooth<'a> {
        let mut is_faulty = vec![false; replay.records.len()];
        let mut bridged_n = Cow::Borrowed(log.force_n.as_slice());
        for (range, said) in replay.records.stretches() {
            if said.faults.has(Fault::ForceUnusable) {
                let inner = range.start.max(1)..range.end.min(log.len() - 1);
                inner.for_each(|at| {
                    bridged_n.to_mut()[at] = between(&log.force_n, at);
                });
            }
            is_faulty[range].fill(said.faults != Faults::NONE);
        }
        let half_width = (SMOOTH_S * log.rate_hz) as usize;
        // A parabola over 2m + 1 samples leaves 9/4 of the variance of their mean.
        let averages = ((2 * half_width + 1) as f64 / 2.25).sqrt().max(1.0);
        Smooth {
            log,
            bridged_n,
            is_faulty,
            half_width,
            averages,
        }
    }

    /// The smoothed force (N) at a sample.
    fn force_n(&self, at: usize) -> f64 {
        parabola(&self.bridged_n, at, self.half_width, self.log.period_s()).0
    }
}

/// One touch in its log.
struct One<'a> {
    log: &'a UniformLog,
    smooth: &'a Smooth<'a>,
    rest_n: f64,
    leaves_n: f64,
    /// End of the touch before.
    free_from: usize,
    contact: Range<usize>,
}

impl One<'_> {
    fn force_n(&self, at: usize) -> f64 {
        self.smooth.force_n(at) - self.rest_n
    }

    /// The last sample before the force leaves its baseline; `None` if the touch follows from another
    /// without free air.
    fn onset(&self) -> Option<usize> {
        let before = self.free_from..self.contact.start;
        before.rev().find(|at| self.force_n(*at) <= self.leaves_n)
    }

    fn touch(&self) -> Touch {
        let (log, onset) = (self.log, self.onset());
        let first = onset.unwrap_or(self.contact.start);
        let all = first..self.contact.end;
        // A sample with a fault is no measurement, and one in a gap was invented.
        let is_measured =
            |at: &usize| self.smooth.is_faulty.get(*at) != Some(&true) && !log.in_gap[*at];
        let hardest = all
            .clone()
            .filter(is_measured)
            .max_by(|a, b| self.force_n(*a).total_cmp(&self.force_n(*b)))
            .unwrap_or(first);
        let start_m = log.position_m[first];
        let depth = |at: usize| log.position_m[at] - start_m;
        let peak_depth_m = all
            .clone()
            .filter(is_measured)
            .map(depth)
            .fold(0.0, f64::max);
        let peak_force_n = self.force_n(hardest).max(0.0);
        let secant = peak_force_n / depth(hardest);
        let is_whole = onset.is_some() && self.contact.end < log.len();
        Touch {
            from_s: log.time_s[self.contact.start],
            to_s: log.time_s[self.contact.end - 1],
            peak_force_n,
            peak_depth_m,
            secant_stiffness: (onset.is_some() && secant.is_finite() && secant > 0.0)
                .then_some(secant),
            dissipated_j: is_whole.then(|| self.work_j(all.clone())),
            relaxation_ratio: self.relaxation(all, STILL * peak_depth_m),
        }
    }

    /// ∮F dx of the raw samples (J).
    fn work_j(&self, samples: Range<usize>) -> f64 {
        let force = |at: usize| self.smooth.bridged_n[at] - self.rest_n;
        let pairs = samples.clone().zip(samples.skip(1));
        pairs
            .map(|(a, b)| {
                0.5 * (force(a) + force(b)) * (self.log.position_m[b] - self.log.position_m[a])
            })
            .sum()
    }

    /// The longest hold's last force over its first.
    fn relaxation(&self, samples: Range<usize>, still_m: f64) -> Option<f64> {
        let hold = self.longest_hold(samples, still_m)?;
        let last = ((hold.len() as f64 * LAST) as usize).max(1);
        let end = hold.end - last..hold.end;
        let left = end
            .map(|at| self.smooth.bridged_n[at] - self.rest_n)
            .sum::<f64>()
            / last as f64;
        let ratio = left / self.force_n(hold.start);
        (self.force_n(hold.start) > 2.0 * self.leaves_n && ratio.is_finite()).then_some(ratio)
    }

    fn longest_hold(&self, samples: Range<usize>, still_m: f64) -> Option<Range<usize>> {
        let position = &self.log.position_m;
        let fewest = ((HOLD_S * self.log.rate_hz) as usize).max(HOLD_SAMPLES);
        let mut longest: Option<Range<usize>> = None;
        let mut from = samples.start;
        while from < samples.end {
            let moved = |at: &usize| (position[*at] - position[from]).abs() > still_m;
            let to = (from..samples.end).find(moved).unwrap_or(samples.end);
            let longer = longest.as_ref().is_none_or(|hold| to - from > hold.len());
            if to - from >= fewest && longer {
                longest = Some(from..to);
            }
            // The start of a hold is then found to an eighth of the stretches around it.
            from += ((to - from) / 8).max(1);
        }
        longest
    }
}
