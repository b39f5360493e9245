//! What of a log the fit looks at: block means along the motion, each with the number of
//! measurements in it.
//!
//! **Thinning.** Where the depth moves, neighbours are joined as long as the depth changes by less
//! than 4 % of itself and up to eight of them: the mean of a power law over such a block differs from
//! the law at the mean depth by n(n−1)/24·0.04², 5·10⁻⁵ of the force for n = 3/2. In a hold a block is as
//! long as 2 % of the time since the motion ended: a hold of any length then has about 50 blocks per
//! e-fold of time, and an exponential e^{−νt} differs within one by (0.02νt)²/24. A hold of 1600 s at
//! 50 Hz is 600 blocks instead of 80 000 samples. Nothing is thrown away: a block weighs what its
//! samples weigh (see `select` for where that ends).
//!
//! Where depth and speed change together, a mean of λδ̇δⁿ differs from that of the means by n/12 of the product of their
//! shares, and that product stays below 2·10⁻³: around the crests of taps of 10 Hz eight samples were 88 mN off.
//!
//! Where a force ends though the probe is still inside, samples stay alone: a block across that corner is no force
//! at a mean depth. Of taps of 10 Hz at 1 kHz such blocks left 15 mN of 1 mN.
//!
//! **Gaps.** Samples that the resampling invented are not measurements. They are left out, and a law
//! with memory gets the straight line between the measurements on either side, which is what they
//! were invented from; where the depth moves within a gap they stay as points without weight.
//!
//! **What no law here has.** On the way out a contact may pull (adhesion), or let go before the depth
//! is zero because the material recovers more slowly than the probe leaves. What a law says there is
//! not what a unilateral contact does, so the samples from where the force has fallen to 3 % of the
//! touch's peak until the probe is out of the material are left out, and counted.

use std::ops::Range;

use super::thresholds::{Samples, Thresholds};
use crate::kinematics::Kinematics;
use crate::log::UniformLog;
use crate::stats::{highest, lowest, median};

/// Half-width of the moving mean that decides about it (samples): 7 samples.
const MEAN_HALF_WIDTH: usize = 3;
/// Change of depth within a block, of the depth.
const DEPTH_SHARE: f64 = 0.04;
/// Product of the changes of depth and speed within a block, of the depth and of the fast speed.
const JOINT_SHARE: f64 = 2e-3;
/// Duration of a block, of the time since the motion ended.
const HOLD_SHARE: f64 = 0.02;
/// Most samples of a block in motion, and far out in free air.
const MOST_MOVING: usize = 8;
const MOST_FREE: usize = 64;
/// Slower than this share of the fast speed in contact (its 90 % quantile) is a hold.
const HOLD_SPEED: f64 = 0.02;
/// Before the first force, of the deepest depth: there the surface may be.
const NEAR: f64 = 0.3;

/// What a sample is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// Nothing.
    Out,
    /// The resting force.
    Free,
    /// The law; with the number of the touch.
    Contact(usize),
}

/// A block mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Time (s).
    pub(super) time_s: f64,
    /// Since the node before (s).
    pub(super) period_s: f64,
    /// Position (m).
    pub(super) position_m: f64,
    /// Speed (m/s).
    pub(super) speed_mps: f64,
    /// Acceleration (m/s²).
    pub(super) acceleration_mps2: f64,
    /// Raw force (N).
    pub(super) force_n: f64,
    /// Measurements that it is the mean of; 0 if it is there for the law's memory only.
    pub(super) count: f64,
    /// Samples over which the error of the position stays the same.
    pub(super) held: f64,
    /// What they are good for.
    pub(super) used: Use,
}

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
}

/// A log as the fit sees it.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Block means in order of time.
    pub(super) nodes: Vec<Node>,
    /// What each sample of the log is good for.
    pub(super) uses: Vec<Use>,
    /// Sizes.
    pub(super) scales: Scales,
    /// Touches as ranges of samples.
    pub(super) touches: Vec<Range<usize>>,
    /// What decides about it.
    pub(super) thresholds: Thresholds,
}

impl Course {
    /// Lays the course of a log over its touches, as ranges of samples; `None` if nothing is touched.
    pub(super) fn of(
        log: &UniformLog,
        motion: &Kinematics,
        touches: Vec<Range<usize>>,
        thresholds: Thresholds,
    ) -> Option<Course> {
        let force_n = moving_mean(&log.force_n);
        let scales = scales(
            log,
            motion,
            &force_n,
            &touches,
            thresholds.samples.firm_touch,
        )?;
        let uses = uses(log, motion, &force_n, &touches, &scales, thresholds.samples);
        let nodes = nodes(log, motion, &uses, &corners(&uses), &scales);
        Some(Course {
            nodes,
            uses,
            scales,
            touches,
            thresholds,
        })
    }

    /// Measurements in contact that are left out, and all in contact.
    pub(super) fn left_out(&self, log: &UniformLog) -> (usize, usize) {
        let samples = self.touches.iter().cloned().flatten();
        let measured: Vec<usize> = samples.filter(|at| !log.in_gap[*at]).collect();
        let out = measured.iter().filter(|at| self.uses[**at] == Use::Out);
        (out.count(), measured.len())
    }

    /// Measurements in free air.
    pub(super) fn free(&self) -> f64 {
        let free = self.nodes.iter().filter(|node| node.used == Use::Free);
        free.map(|node| node.count).sum()
    }
}

fn moving_mean(channel: &[f64]) -> Vec<f64> {
    let around = |at: usize| {
        let from = at.saturating_sub(MEAN_HALF_WIDTH);
        &channel[from..(at + MEAN_HALF_WIDTH + 1).min(channel.len())]
    };
    (0..channel.len())
        .map(|at| around(at).iter().sum::<f64>() / around(at).len() as f64)
        .collect()
}

fn scales(
    log: &UniformLog,
    motion: &Kinematics,
    force_n: &[f64],
    touches: &[Range<usize>],
    firm: f64,
) -> Option<Scales> {
    let first = touches.first()?.start;
    let rest_n = median(log.force_n[..first].iter().copied());
    let peak = |touch: &Range<usize>| highest(force_n[touch.clone()].iter().copied()) - rest_n;
    let hardest = touches.iter().map(peak).fold(0.0, f64::max);
    let firm = touches.iter().filter(|touch| peak(touch) >= firm * hardest);
    let touch_m = lowest(firm.map(|touch| motion.position_m[touch.start]));
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
    })
}

/// The 90 % quantile of the speeds that are not rest.
fn fast(mut speeds: Vec<f64>) -> f64 {
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    speeds.retain(|speed| *speed >= 0.05 * fastest);
    speeds.sort_unstable_by(f64::total_cmp);
    speeds.get(speeds.len() * 9 / 10).copied().unwrap_or(0.0)
}

fn uses(
    log: &UniformLog,
    motion: &Kinematics,
    force_n: &[f64],
    touches: &[Range<usize>],
    scales: &Scales,
    decide: Samples,
) -> Vec<Use> {
    let mut uses = vec![Use::Free; log.len()];
    let mean_noise = scales.noise_n / ((2 * MEAN_HALF_WIDTH + 1) as f64).sqrt();
    for (number, touch) in touches.iter().enumerate() {
        let peak = highest(force_n[touch.clone()].iter().copied()) - scales.rest_n;
        let let_go =
            scales.rest_n + (decide.released_force * peak).max(decide.contact_sigmas * mean_noise);
        let mut gone_in = false;
        for at in touch.clone() {
            let pressed = force_n[at] >= let_go;
            gone_in |= pressed;
            uses[at] = if pressed || !gone_in {
                Use::Contact(number)
            } else {
                Use::Out
            };
        }
        let next = touches.get(number + 1).map_or(log.len(), |next| next.start);
        let pulls = |at: usize| force_n[at] < scales.rest_n - decide.contact_sigmas * mean_noise;
        let out_m = scales.touch_m - decide.outside_depth * scales.depth_m;
        let out = (touch.end..next).find(|at| motion.position_m[*at] < out_m && !pulls(*at));
        let out = out.unwrap_or_else(|| {
            // It never left: the way in again begins where it was farthest out.
            let farthest = (touch.end..next)
                .min_by(|a, b| motion.position_m[*a].total_cmp(&motion.position_m[*b]));
            farthest.unwrap_or(touch.end)
        });
        uses[touch.end..out].fill(Use::Out);
    }
    uses
}

/// A block under construction.
#[derive(Clone, Copy)]
struct Block {
    from: usize,
    samples: usize,
    node: Node,
}

/// Whether a force ends near each sample while the probe is still inside: within what the moving mean that finds the end
/// reaches, and one more.
fn corners(uses: &[Use]) -> Vec<bool> {
    let mut corners = vec![false; uses.len()];
    for (at, pair) in uses.windows(2).enumerate() {
        if matches!(pair[0], Use::Contact(_)) && pair[1] == Use::Out {
            let from = at.saturating_sub(MEAN_HALF_WIDTH);
            corners[from..(at + MEAN_HALF_WIDTH + 2).min(uses.len())].fill(true);
        }
    }
    corners
}

fn nodes(
    log: &UniformLog,
    motion: &Kinematics,
    uses: &[Use],
    corners: &[bool],
    scales: &Scales,
) -> Vec<Node> {
    let mut nodes = Vec::new();
    let mut block: Option<Block> = None;
    let mut moved_at = 0;
    for (at, is_corner) in corners.iter().enumerate() {
        if motion.speed_mps[at].abs() > HOLD_SPEED * scales.speed_mps {
            moved_at = at;
        }
        let sample = sample(log, motion, uses, at);
        if log.in_gap[at] && is_still(&nodes, block.as_ref(), &sample, scales) {
            continue;
        }
        let most = ((at - moved_at) as f64 * HOLD_SHARE) as usize;
        if let Some(block) = &mut block
            && !is_corner
            && joins(block, &sample, motion, at, most, scales)
        {
            block.join(&sample);
            continue;
        }
        nodes.extend(block.map(|block| block.node));
        block = Some(Block {
            from: at,
            samples: 1,
            node: sample,
        });
    }
    nodes.extend(block.map(|block| block.node));
    let mut before_s = nodes
        .first()
        .map_or(0.0, |first| first.time_s - log.period_s());
    for node in &mut nodes {
        node.period_s = node.time_s - before_s;
        before_s = node.time_s;
    }
    nodes
}

fn sample(log: &UniformLog, motion: &Kinematics, uses: &[Use], at: usize) -> Node {
    let used = if log.in_gap[at] { Use::Out } else { uses[at] };
    Node {
        time_s: log.time_s[at],
        period_s: 0.0,
        position_m: motion.position_m[at],
        speed_mps: motion.speed_mps[at],
        acceleration_mps2: motion.acceleration_mps2[at],
        force_n: log.force_n[at],
        count: f64::from(u8::from(used != Use::Out)),
        held: motion.held[at],
        used,
    }
}

/// Whether an invented sample adds nothing: the depth is that of the last node.
fn is_still(nodes: &[Node], block: Option<&Block>, sample: &Node, scales: &Scales) -> bool {
    let last = block.map(|block| &block.node).or(nodes.last());
    last.is_some_and(|last| (last.position_m - sample.position_m).abs() < 0.01 * scales.depth_m)
}

/// Whether a sample may join a block; `most` is how many samples a block of a hold may have.
fn joins(
    block: &Block,
    sample: &Node,
    motion: &Kinematics,
    at: usize,
    most: usize,
    scales: &Scales,
) -> bool {
    let start_m = motion.position_m[block.from];
    let depth = start_m.min(sample.position_m) - scales.touch_m;
    let far_out = -depth > NEAR * scales.depth_m
        && sample.position_m.max(start_m) < scales.touch_m - NEAR * scales.depth_m;
    let (most, change_m) = if far_out {
        (MOST_FREE, scales.depth_m)
    } else {
        let moving = if depth > 0.0 { MOST_MOVING } else { 1 };
        let change_m = (DEPTH_SHARE * depth).max(3.0 * scales.position_noise_m);
        (most.max(moving), change_m)
    };
    let moved_m = (sample.position_m - start_m).abs();
    let noise_mps = motion.speed_noise_mps[block.from].hypot(motion.speed_noise_mps[at]);
    let faster = (sample.speed_mps - motion.speed_mps[block.from]).abs() - 3.0 * noise_mps;
    let faster = faster.max(0.0) / scales.speed_mps;
    let is_joint = depth <= 0.0 || moved_m * faster <= JOINT_SHARE * depth;
    block.node.used == sample.used
        && is_joint
        && (block.node.count > 0.0) == (sample.count > 0.0)
        && at - block.from < most
        && moved_m <= change_m
}

impl Block {
    fn join(&mut self, sample: &Node) {
        self.samples += 1;
        let share = 1.0 / self.samples as f64;
        let node = &mut self.node;
        let towards = |mean: &mut f64, value: f64| *mean += share * (value - *mean);
        towards(&mut node.time_s, sample.time_s);
        towards(&mut node.position_m, sample.position_m);
        towards(&mut node.speed_mps, sample.speed_mps);
        towards(&mut node.acceleration_mps2, sample.acceleration_mps2);
        towards(&mut node.force_n, sample.force_n);
        towards(&mut node.held, sample.held);
        node.count += sample.count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Choices, setup};
    use crate::kinematics::kinematics;
    use crate::log::Log;
    use estimator_core::Config;
    use estimator_core::estimate::method::Method;

    /// 1 s of rest, 0.1 s to 2 mm into 2 N/mm, a hold, and back; the release pulls with 0.5 N.
    fn course(hold_s: f64, rate_hz: f64) -> (UniformLog, Course) {
        let end_s = 1.4 + hold_s;
        let time: Vec<f64> = (0..((end_s + 1.0) * rate_hz) as usize)
            .map(|i| i as f64 / rate_hz)
            .collect();
        let depth = |t: f64| 0.02 * (t - 1.0).clamp(0.0, 0.15) - 0.02 * (t - end_s).clamp(0.0, 0.2);
        let x: Vec<f64> = time.iter().map(|t| depth(*t) - 1e-3).collect();
        let force = |(t, x): (&f64, &f64)| {
            let pulls = *x < 1e-4 && *x > -4e-4 && *t > end_s;
            if pulls { -0.5 } else { 2000.0 * x.max(0.0) }
        };
        let f = time.iter().zip(&x).map(force);
        // A step of 1 mN, so that there is a noise.
        let f = f.map(|f| (f / 1e-3).round() * 1e-3).collect();
        let log = Log::from_channels(time, x, f).uniform().unwrap();
        let config = setup(
            &log,
            Config::default(),
            Method::KELVIN_VOIGT,
            Choices::default(),
        )
        .config;
        let replay = crate::replay::replay(&log, &config).unwrap();
        let course = Course::of(
            &log,
            &kinematics(&log),
            replay.contacts(),
            Thresholds::default(),
        )
        .unwrap();
        (log, course)
    }

    #[test]
    fn a_hold_weighs_by_its_logarithm_and_loses_no_sample() {
        // WHEN a hold lasts ten times as long
        let (short, long) = (course(10.0, 1000.0), course(100.0, 1000.0));
        let nodes = |course: &Course| {
            let own = course.nodes.iter();
            own.filter(|node| matches!(node.used, Use::Contact(_)))
                .count()
        };
        let more = nodes(&long.1) - nodes(&short.1);
        // THEN it has 50·ln 10 = 115 blocks more.
        assert!((100..130).contains(&more), "{more}");
        for (log, course) in [short, long] {
            let counted: f64 = course.nodes.iter().map(|node| node.count).sum();
            let used = course.uses.iter().filter(|used| **used != Use::Out).count();
            assert_eq!(counted, used as f64);
            assert_eq!(course.uses.len(), log.len());
        }
    }

    #[test]
    fn what_pulls_on_the_way_out_is_left_out() {
        let (log, course) = course(1.0, 1000.0);
        for (at, used) in course.uses.iter().enumerate() {
            assert!(
                log.force_n[at] > -0.1 || *used == Use::Out,
                "{at}: {used:?}"
            );
        }
        // The rest, the way in and the hold are all there.
        let kept = course.uses.iter().filter(|used| **used != Use::Out).count();
        assert!(
            kept as f64 > 0.95 * log.len() as f64,
            "{kept} of {}",
            log.len()
        );
    }
}
