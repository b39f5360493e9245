//! Block means of a log: of samples over which neither depth nor speed changes much.
//!
//! **Thinning.** Where the depth moves, neighbours are joined as long as the depth changes by less
//! than 1 % of itself and up to eight of them: the mean of a power law over such a block differs from
//! the law at the mean depth by n(n−1)/24·0.01², 3·10⁻⁶ of the force for n = 3/2; with 4 % it was as much as the noise of
//! a mean, and stiffness and offset were off by four of their standard errors. In a hold a block is as
//! long as 2 % of the time since the motion ended: a hold of any length then has about 50 blocks per
//! e-fold of time, and an exponential e^{−νt} differs within one by (0.02νt)²/24. (At 100 Hz eight samples after a stop
//! were two time constants of a mode: 2000 N/m came out as 1958 ± 8, with a force that seemed 1.3 ms early.) A hold of 1600 s at
//! 50 Hz is 600 blocks instead of 80 000 samples. Nothing is thrown away: a block weighs what its
//! samples weigh (see `weights` for where that ends).
//!
//! Where depth and speed change together, a mean of λδ̇δⁿ differs from that of the means by n/12 of the product of their
//! shares, and that product stays below 2·10⁻³: around the crests of taps of 10 Hz eight samples were 88 mN off.
//!
//! Where a force ends though the probe is still inside, samples stay alone: a block across that corner is no force
//! at a mean depth. Of taps of 10 Hz at 1 kHz such blocks left 15 mN of 1 mN.

use super::scales::{NEAR, Scales};
use crate::kinematics::Kinematics;
use crate::log::UniformLog;

/// Change of depth within a block, of the depth.
const DEPTH_SHARE: f64 = 0.01;
/// Product of the changes of depth and speed within a block, of the depth and of the fast speed.
const JOINT_SHARE: f64 = 2e-3;
/// Duration of a block, of the time since the motion ended.
const HOLD_SHARE: f64 = 0.02;
/// Most samples of a block in motion, and far out in free air.
const MOST_MOVING: usize = 8;
const MOST_FREE: usize = 64;
/// And in motion of a force that went through a low-pass.
const MOST_FILTERED: usize = 2;
/// Longest block right after a stop (s): of a mode of 100/s its mean is 3 % off.
const JUST_STOPPED_S: f64 = 8.5e-3;
/// Slower than this share of the fast speed in contact (its 90 % quantile) is a hold.
const HOLD_SPEED: f64 = 0.02;

/// Half-width of the moving mean that decides about it (samples): 7 samples.
pub(super) const MEAN_HALF_WIDTH: usize = 3;

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

/// The block means of a log in order of time.
pub(super) fn nodes(
    log: &UniformLog,
    motion: &Kinematics,
    uses: &[Use],
    scales: &Scales,
) -> Vec<Node> {
    let mut nodes = Vec::new();
    let mut block: Option<Block> = None;
    let mut moved_at = 0;
    for (at, is_corner) in corners(uses).into_iter().enumerate() {
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
    let used = match log.has_force(at) {
        true => uses[at],
        false => Use::Out,
    };
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
        let moves = motion.speed_mps[at].abs() > HOLD_SPEED * scales.speed_mps;
        let most_moving = match scales.low_pass {
            Some(_) => MOST_FILTERED,
            None => MOST_MOVING,
        };
        let moving = match (depth > 0.0, moves) {
            (true, true) => most_moving,
            (true, false) => most_moving.min((JUST_STOPPED_S / scales.period_s) as usize),
            (false, _) => 1,
        };
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
