//! The sizes of a log that everything of a fit is measured against.

use std::ops::Range;

use super::low_pass::LowPass;
use crate::kinematics::Kinematics;
use crate::log::UniformLog;
use crate::stats::{highest, lowest, median};

/// Before the first force, of the deepest depth: there the surface may be.
pub(super) const NEAR: f64 = 0.3;

/// Sizes that everything is measured against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// Position at the first force (m).
    pub(super) touch_m: f64,
    /// From there to the deepest point (m).
    pub(super) depth_m: f64,
    /// Peak force over rest (N).
    pub(super) force_n: f64,
    /// Fast speed in contact (m/s).
    pub(super) speed_mps: f64,
    /// Force in free air, roughly (N).
    pub(super) rest_n: f64,
    /// Standard deviation of the raw force (N).
    pub(super) noise_n: f64,
    /// Standard deviation of the raw position (m).
    pub(super) position_noise_m: f64,
    /// Longest touch (s).
    pub(super) longest_s: f64,
    /// Time between samples (s).
    pub(super) period_s: f64,
    /// What the force went through before it was logged.
    pub(super) low_pass: Option<LowPass>,
}

impl Scales {
    /// Those of a force that went through a low-pass.
    pub(super) fn behind(&self, low_pass: LowPass) -> Scales {
        Scales {
            low_pass: Some(low_pass),
            ..*self
        }
    }
}

/// The sizes of a log with these touches, its force smoothed; a touch is firm that presses this share of the hardest.
pub(super) fn scales(
    log: &UniformLog,
    motion: &Kinematics,
    force_n: &[f64],
    touches: &[Range<usize>],
    firm: f64,
) -> Option<Scales> {
    let rest_n = rest_n(log, force_n, touches)?;
    let peak = |touch: &Range<usize>| highest(force_n[touch.clone()].iter().copied()) - rest_n;
    let hardest = touches.iter().map(peak).fold(0.0, f64::max);
    let firm = touches.iter().filter(|touch| peak(touch) >= firm * hardest);
    let begins_m = |touch: &Range<usize>| match touch.start {
        // The log begins in it.
        0 => lowest(motion.position_m[touch.clone()].iter().copied()),
        start => motion.position_m[start],
    };
    let touch_m = lowest(firm.map(begins_m));
    let samples = || touches.iter().cloned().flatten();
    let depth_m = highest(samples().map(|at| motion.position_m[at])) - touch_m;
    let longest = touches.iter().map(Range::len).max()?;
    (hardest > 0.0 && depth_m > 0.0).then(|| Scales {
        touch_m,
        depth_m,
        force_n: hardest,
        speed_mps: fast(samples().map(|at| motion.speed_mps[at].abs()).collect()),
        rest_n,
        noise_n: log.force_noise_n().max(1e-9 * hardest),
        position_noise_m: motion.noise_m,
        longest_s: longest as f64 * log.period_s(),
        period_s: log.period_s(),
        low_pass: None,
    })
}

/// The force in free air (N), roughly: before the first touch; of a log that begins in contact, between its touches; of one
/// that is nowhere in free air, the least.
fn rest_n(log: &UniformLog, mean_n: &[f64], touches: &[Range<usize>]) -> Option<f64> {
    let first = touches.first()?;
    if first.start > 0 {
        return Some(median(log.force_n[..first.start].iter().copied()));
    }
    let is_free = |at: &usize| !touches.iter().any(|touch| touch.contains(at));
    let free: Vec<f64> = (first.end..log.len())
        .filter(is_free)
        .map(|at| log.force_n[at])
        .collect();
    Some(match free.is_empty() {
        true => lowest(mean_n.iter().copied()),
        false => median(free),
    })
}

/// The 90 % quantile of the speeds that are not rest.
fn fast(mut speeds: Vec<f64>) -> f64 {
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    speeds.retain(|speed| *speed >= 0.05 * fastest);
    speeds.sort_unstable_by(f64::total_cmp);
    speeds.get(speeds.len() * 9 / 10).copied().unwrap_or(0.0)
}
