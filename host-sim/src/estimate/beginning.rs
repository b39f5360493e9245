//! Logs that begin in contact, and where their probe is in free air after all.

use std::ops::Range;

use super::setup::begins_in_contact;
use crate::log::UniformLog;
use crate::number::quantity;
use crate::stats::{median, range};

/// Samples of a block, of which the means are looked at.
const BLOCK: usize = 50;
/// Samples of a mean that finds where a touch begins within one.
const MEAN: usize = 7;
/// Free air is at the force of this outermost share of the travel,
const OUTERMOST: f64 = 0.05;
/// within this share of what the force does in all and so many standard errors of a mean,
const SAME_FORCE: f64 = 0.01;
const SAME_SIGMAS: f64 = 4.0;
/// over this share of the travel at least: a hold in contact is as still as free air, and does not move. A force that grows
/// as the square of the depth moves by SAME_FORCE there.
const LEAST_TRAVEL: f64 = 0.1;
/// What is left of a log from its first free air on is enough if its force does this share of what it does in all.
const ENOUGH: f64 = 0.5;

/// The touches of a log that begins in contact, as ranges of samples: all of it where its probe is nowhere in free air.
/// `None` of a log that begins in free air.
pub(crate) fn touched(log: &UniformLog) -> Option<Vec<Range<usize>>> {
    if !begins_in_contact(log) {
        return None;
    }
    let (free, level_n) = free_air(log);
    let first = free.first().map_or(log.len(), |free| free.start);
    let ends = free.iter().map(|free| rises(log, free.end, level_n));
    let starts = free.iter().skip(1).map(|free| free.start);
    let between = ends.zip(starts.chain([log.len()]));
    let all = [(0, first)].into_iter().chain(between);
    let touches: Vec<Range<usize>> = all
        .filter(|(from, to)| from < to)
        .map(|(from, to)| from..to)
        .collect();
    (first > 0).then_some(touches)
}

/// A log that begins in contact, from where its probe is first in free air; `None` of another, or if not enough follows.
pub(super) fn from_free_air(log: &UniformLog) -> Option<UniformLog> {
    let start = touched(log)?.first()?.end;
    if start >= log.len() || range(&log.force_n[start..]) < ENOUGH * range(&log.force_n) {
        return None;
    }
    let mut rest = log.part(start..log.len());
    rest.notes.push(format!(
        "the log starts in contact: a recursion begins where the probe is first in free air, at {}",
        quantity(rest.time_s[0], 3, "s")
    ));
    Some(rest)
}

/// Whether a log shows free air, and that is where a sample lies and its probe moves from there.
pub(super) fn is_free_from(log: &UniformLog, sample: usize) -> bool {
    let (free, _) = free_air(log);
    !begins_in_contact(log) && free.first().is_some_and(|own| own.contains(&sample))
}

/// The first sample from a block on whose force is that of free air no longer.
fn rises(log: &UniformLog, from: usize, level_n: f64) -> usize {
    let within_n = SAME_SIGMAS * log.force_noise_n() / (MEAN as f64).sqrt();
    let means = log.force_n[from..].windows(MEAN).take(BLOCK);
    let risen = |own: &[f64]| (own.iter().sum::<f64>() / MEAN as f64 - level_n).abs() > within_n;
    let risen = means.map(risen).position(|risen| risen);
    from + risen.unwrap_or(0)
}

/// Stretches of free air (samples), where the force is that of the outermost positions and stays it on the way; and
/// that force (N).
fn free_air(log: &UniformLog) -> (Vec<Range<usize>>, f64) {
    let blocks: Vec<Range<usize>> = (0..log.len() / BLOCK)
        .map(|at| at * BLOCK..(at + 1) * BLOCK)
        .collect();
    let means = |channel: &[f64]| -> Vec<f64> {
        let means = blocks
            .iter()
            .map(|own| channel[own.clone()].iter().sum::<f64>() / BLOCK as f64);
        means.collect()
    };
    let (force_n, position_m) = (means(&log.force_n), means(&log.position_m));
    let travel_m = range(&position_m);
    let outermost_m = position_m.iter().copied().fold(f64::INFINITY, f64::min);
    let is_outermost = |at: &usize| position_m[*at] <= outermost_m + OUTERMOST * travel_m;
    let level_n = median((0..blocks.len()).filter(is_outermost).map(|at| force_n[at]));
    let within_n =
        SAME_FORCE * range(&force_n) + SAME_SIGMAS * log.force_noise_n() / (BLOCK as f64).sqrt();
    let is_free = |at: &usize| (force_n[*at] - level_n).abs() <= within_n;
    let free: Vec<usize> = (0..blocks.len()).filter(is_free).collect();
    let ways_m: Vec<f64> = free.iter().map(|at| position_m[*at]).collect();
    if free.is_empty() || range(&ways_m) < LEAST_TRAVEL * travel_m {
        return (Vec::new(), level_n);
    }
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for at in free {
        match stretches.last_mut() {
            Some(last) if last.end == at * BLOCK => last.end += BLOCK,
            _ => stretches.push(blocks[at].clone()),
        }
    }
    if let Some(last) = stretches.last_mut()
        && last.end == blocks.len() * BLOCK
    {
        last.end = log.len();
    }
    (stretches, level_n)
}
