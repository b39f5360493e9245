//! Holds in contact: the depth stays, and the force tells whether the material relaxes.

use crate::log::UniformLog;
use crate::replay::Replay;
use crate::signal;

/// The shortest hold (s), or 20 samples where they take longer.
const SHORTEST_S: f64 = 0.2;
/// A hold moves by less than this share of the depth reached.
const STILL: f64 = 0.02;

/// A stretch of contact at constant depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// From (s).
    pub from_s: f64,
    /// To (s).
    pub to_s: f64,
    /// Depth (m).
    pub depth_m: f64,
    /// Force at the start (N).
    pub from_n: f64,
    /// Force at the end (N).
    pub to_n: f64,
    /// By what share of the force at the start it fell; only what exceeds the noise counts.
    pub relaxed: f64,
}

/// All holds of a log.
pub fn holds(log: &UniformLog, replay: &Replay) -> Vec<Hold> {
    let deepest = replay
        .records
        .iter()
        .map(|r| f64::from(r.depth_m))
        .fold(0.0, f64::max);
    let shortest = ((SHORTEST_S / log.period_s()) as usize).max(20);
    let noise_n = signal::noise(&log.force_n);
    let mut found = Vec::new();
    for contact in replay.contacts() {
        let mut from = contact.start;
        while from < contact.end {
            let to = still_until(replay, from, contact.end, STILL * deepest);
            if to - from >= shortest {
                found.push(hold(replay, from, to, noise_n));
            }
            from = to.max(from + 1);
        }
    }
    found
}

/// The first record after `from` whose depth has left that of `from` by more than `still_m`.
fn still_until(replay: &Replay, from: usize, end: usize, still_m: f64) -> usize {
    let depth = f64::from(replay.records[from].depth_m);
    let left = |index: &usize| (f64::from(replay.records[*index].depth_m) - depth).abs() > still_m;
    (from..end).find(left).unwrap_or(end)
}

fn hold(replay: &Replay, from: usize, to: usize, noise_n: f64) -> Hold {
    // A tenth at either end, a second at most: the depth creeps into a hold and out of it.
    let edge = ((to - from) / 10).max(1);
    let mean = |range: std::ops::Range<usize>| {
        let count = range.len() as f64;
        replay.records[range]
            .iter()
            .map(|r| f64::from(r.force_n))
            .sum::<f64>()
            / count
    };
    let lead = (to - from) / 50;
    let (from_n, to_n) = (mean(from + lead..from + lead + edge), mean(to - edge..to));
    let certain = (from_n - to_n).abs() > 4.0 * noise_n / (edge as f64).sqrt();
    Hold {
        from_s: replay.time_s(from),
        to_s: replay.time_s(to - 1),
        depth_m: f64::from(replay.records[from].depth_m),
        from_n,
        to_n,
        relaxed: if certain && from_n > 0.0 {
            (1.0 - to_n / from_n).max(0.0)
        } else {
            0.0
        },
    }
}
