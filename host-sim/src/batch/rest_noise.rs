//! Noise of the force that is slower than a sample: what a probe that rests in free air reads.
//!
//! The noise from sample to sample is what white noise would be. An amplifier flickers, and mains hum: of 1/f noise of 10 mN
//! it is 2.9 mN, and a law that explains the force to its noise leaves three times that. A stretch of rest in free air
//! shows the rest. What is slower than a stretch (a drift) is left out: it is no noise of a touch.

use super::blocks::Use;
use super::course::Course;
use crate::log::UniformLog;
use crate::stats::{deviation, quantile};

/// Samples next to a touch that are no rest: a probe that is pushed by less than the noise is not in free air.
const MARGIN: usize = 32;
/// The shortest stretch of rest (s), and its fewest samples.
const SHORTEST_S: f64 = 0.2;
const FEWEST: usize = 50;
/// A probe rests if it moves by less than this share of the deepest depth.
const STILL: f64 = 0.01;
/// The lower half of the stretches is noise for sure: in others a surface that sticks may pull.
const SHARE: f64 = 0.5;
/// It counts where it is so many times the noise from sample to sample; that of a short stretch scatters by a tenth.
const LARGER: f64 = 1.3;

impl Course {
    /// The standard deviation of the force (N) within stretches of rest in free air, where that is clearly more than its noise
    /// from sample to sample.
    pub(super) fn rest_noise_n(&self, log: &UniformLog) -> Option<f64> {
        let mut deviations_n = Vec::new();
        let mut at = 0;
        for run in self.uses.chunk_by(|a, b| a == b) {
            let here = at..at + run.len();
            at = here.end;
            let inner = here.start + MARGIN..here.end.saturating_sub(MARGIN);
            if run[0] == Use::Free && !inner.is_empty() {
                let fewest = FEWEST.max((SHORTEST_S * log.rate_hz) as usize);
                let still = still(&log.position_m[inner.clone()], STILL * self.scales.depth_m);
                let still = still.into_iter().filter(|own| own.len() >= fewest);
                let forces =
                    still.map(|own| &log.force_n[inner.start + own.start..inner.start + own.end]);
                deviations_n.extend(forces.map(deviation));
            }
        }
        let noise_n = quantile(deviations_n, SHARE);
        (noise_n > LARGER * self.scales.noise_n).then_some(noise_n)
    }
}

/// Stretches within which a position moves by less than a way (m).
fn still(position_m: &[f64], way_m: f64) -> Vec<std::ops::Range<usize>> {
    let mut stretches = Vec::new();
    let mut from = 0;
    while from < position_m.len() {
        let moved = |at: &usize| (position_m[*at] - position_m[from]).abs() > way_m;
        let to = (from..position_m.len())
            .find(moved)
            .unwrap_or(position_m.len());
        stretches.push(from..to);
        from = to;
    }
    stretches
}
