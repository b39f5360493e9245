//! Holds in contact: the depth stays, and the force tells whether the material relaxes.

use std::ops::Range;

use crate::log::UniformLog;
use crate::replay::Replay;

/// The shortest hold (s), or eight delays of the filter where they take longer.
const SHORTEST_S: f64 = 0.2;
/// A hold moves by less than this share of the depth reached.
const STILL: f64 = 0.02;
/// It begins when the speed is below this share of the fastest: a damping that is worth the whole
/// force at full speed is then worth 0.3 % of it.
const QUIET: f64 = 0.003;

/// A stretch of contact at constant depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// From (s).
    pub from_s: f64,
    /// To (s).
    pub to_s: f64,
    /// Position (m): a depth would need a surface, and each method has its own.
    pub position_m: f64,
    /// Force at the start (N).
    pub from_n: f64,
    /// Force at the end (N).
    pub to_n: f64,
    /// By what share of the force at the start it fell, less what the depth that gave way meanwhile
    /// explains; 0 where that does not exceed the noise.
    pub relaxed: f64,
}

/// All holds of a log.
pub fn holds(log: &UniformLog, replay: &Replay) -> Vec<Hold> {
    let contact = replay.contacts().into_iter().flatten();
    let deepest = contact
        .map(|index| replay.final_depth_m(index))
        .fold(0.0, f64::max);
    let shortest = ((SHORTEST_S / log.period_s()) as usize).max(8 * replay.delay);
    let noise_n = log.force_noise_n();
    let speed = |index: usize| f64::from(replay.records.speed_mps(index).abs());
    let fastest = replay
        .contacts()
        .into_iter()
        .flatten()
        .map(speed)
        .fold(0.0, f64::max);
    let mut found = Vec::new();
    for contact in replay.contacts() {
        let mut from = contact.start;
        while from < contact.end {
            if speed(from) > QUIET * fastest {
                from += 1;
                continue;
            }
            let to = still_until(replay, from, contact.end, STILL * deepest);
            // On the way out a damping takes off the force what it added on the way in: a gel of 30 N/m that leaves
            // gently relaxed by 5 %.
            let is_quiet = |at: &usize| speed(*at) <= QUIET * fastest;
            let quiet = (from..to).rev().find(is_quiet).map_or(from, |at| at + 1);
            if quiet - from >= shortest {
                found.push(hold((log, noise_n), replay, from..quiet));
            }
            from = to.max(from + 1);
        }
    }
    found
}

/// The first record after `from` whose depth has left that of `from` by more than `still_m`.
fn still_until(replay: &Replay, from: usize, end: usize, still_m: f64) -> usize {
    let depth = replay.final_depth_m(from);
    let left = |index: &usize| (replay.final_depth_m(*index) - depth).abs() > still_m;
    (from..end).find(left).unwrap_or(end)
}

/// The hold in a stretch of records of a log with a noise (N).
fn hold((log, noise_n): (&UniformLog, f64), replay: &Replay, stretch: Range<usize>) -> Hold {
    let (from, to) = (stretch.start, stretch.end);
    // A tenth at either end, without the window of the filter that still sees the way in or out.
    let edge = ((to - from) / 10).max(1);
    let lead = ((to - from) / 50).max(2 * replay.delay + 1);
    let (early, late) = (from + lead..from + lead + edge, to - lead - edge..to - lead);
    let force = |index: usize| f64::from(replay.records.force_n(index));
    let depth = |index: usize| replay.final_depth_m(index);
    let (from_n, to_n) = (mean(&early, force), mean(&late, force));
    let depth_m = mean(&early, depth);
    let gave_way_m = depth_m - mean(&late, depth);
    // An exponent of 2 is the steepest of a common contact: twice the share of depth.
    let explained = if depth_m > 0.0 {
        2.0 * (gave_way_m / depth_m).max(0.0)
    } else {
        1.0
    };
    let noise = 4.0 * noise_n / (edge as f64).sqrt() / from_n.abs().max(f64::MIN_POSITIVE);
    let fell = 1.0 - to_n / from_n - explained;
    Hold {
        from_s: replay.time_s(from),
        to_s: replay.time_s(to - 1),
        position_m: mean(&early, |index| {
            replay
                .sample_of(index)
                .map_or(f64::NAN, |at| log.position_m[at])
        }),
        from_n,
        to_n,
        relaxed: if from_n > 0.0 && fell > noise {
            fell
        } else {
            0.0
        },
    }
}

fn mean(range: &Range<usize>, of: impl Fn(usize) -> f64) -> f64 {
    range.clone().map(of).sum::<f64>() / range.len() as f64
}
