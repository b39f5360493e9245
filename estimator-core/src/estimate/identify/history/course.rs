//! What was touched how, condensed: means over blocks of samples, the last [`BLOCKS`] of them.
//!
//! Where the depth moves a block is [`SHORTEST`] samples long, in a hold 4 % of the time since the
//! motion ended, in free air as long as the flight: a press and a hold of a minute are 150 blocks, a
//! stroke of a palpation 60. A law that is linear in its memory gives the mean force of a block from
//! the mean of its elastic response, however long the block.

use crate::estimate::identify::Instant;
use crate::maths::scalar::Real;

/// Blocks that are kept.
pub(super) const BLOCKS: usize = 160;
/// Samples of a block in motion: half the memory of the default filter.
const SHORTEST: u32 = 8;
/// A block ends when the depth has moved by this share of itself,
const MOVES: f64 = 0.03;
/// or when it is this share of the time since the motion ended.
const HOLD_SHARE: f64 = 0.04;
/// A probe this many standard errors of the surface above it is in free air.
const CLEAR: f64 = 6.0;

/// Means over a block, scaled; see [`Instant`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Block<T> {
    pub(super) position: T,
    pub(super) speed: T,
    pub(super) force: T,
    pub(super) position_variance: T,
    pub(super) position_velocity_cov: T,
    pub(super) duration_s: T,
    /// Samples that the force is worth; 0 if it must not be learned from, −1 in free air.
    pub(super) count: T,
}

impl<T: Real> Block<T> {
    /// One instant as a block.
    pub(super) fn of(at: &Instant<T>) -> Self {
        Block {
            position: at.position(),
            speed: at.speed,
            force: at.force,
            position_variance: at.position_variance,
            position_velocity_cov: at.position_velocity_cov,
            duration_s: at.elapsed_s,
            count: T::one(),
        }
    }
}

/// How an instant counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Kind {
    /// In free air, nothing happens.
    #[default]
    Free,
    /// In or near the material, but not to be learned from.
    Passed,
    /// To be learned from.
    Learned,
}

/// The block that is under way.
#[derive(Clone, Copy, Debug, Default)]
struct Open<T> {
    kind: Kind,
    samples: u32,
    duration_s: T,
    /// Position of its first sample; the sums are of differences to it.
    first: T,
    position: T,
    square: T,
    speed: T,
    mixed: T,
    force: T,
    position_variance: T,
    position_velocity_cov: T,
}

impl<T: Real> Open<T> {
    fn add(&mut self, at: &Instant<T>) {
        if self.samples == 0 {
            self.first = at.position();
        }
        let moved = at.position() - self.first;
        self.samples = self.samples.saturating_add(1);
        self.duration_s += at.elapsed_s;
        self.position += moved;
        self.square += moved * moved;
        self.speed += at.speed;
        self.mixed += moved * at.speed;
        self.force += at.force;
        self.position_variance += at.position_variance;
        self.position_velocity_cov += at.position_velocity_cov;
    }

    fn closed(&self) -> Block<T> {
        let count = T::from_f64(f64::from(self.samples));
        let share = T::one() / count;
        let (moved, speed) = (self.position * share, self.speed * share);
        let position_variance = (self.position_variance + self.square) * share - moved * moved;
        Block {
            position: self.first + moved,
            speed,
            force: self.force * share,
            position_variance: T::zero().max_of(position_variance),
            position_velocity_cov: (self.position_velocity_cov + self.mixed) * share
                - moved * speed,
            duration_s: self.duration_s,
            count: match self.kind {
                Kind::Learned => count,
                Kind::Passed => T::zero(),
                Kind::Free => -T::one(),
            },
        }
    }
}

/// The last blocks, numbered from 0 on, and the one under way.
#[derive(Clone, Debug)]
pub(super) struct Course<T> {
    blocks: [Block<T>; BLOCKS],
    /// Number of the next block, and of the first that still counts.
    next: u32,
    first: u32,
    open: Open<T>,
    since_motion_s: T,
}

impl<T: Real> Course<T> {
    pub(super) fn new() -> Self {
        Course {
            blocks: [Block::default(); BLOCKS],
            next: 0,
            first: 0,
            open: Open::default(),
            since_motion_s: T::zero(),
        }
    }

    /// Number of the block that will come next.
    pub(super) fn next(&self) -> u32 {
        self.next
    }

    /// Number of the oldest block that is kept.
    pub(super) fn oldest(&self) -> u32 {
        self.first.max(self.next.saturating_sub(BLOCKS as u32))
    }

    /// A block by its number, if it is kept.
    pub(super) fn get(&self, number: u32) -> Option<&Block<T>> {
        let kept = number >= self.oldest() && number < self.next;
        self.blocks.get(number as usize % BLOCKS).filter(|_| kept)
    }

    pub(super) fn push(&mut self, block: Block<T>) {
        if let Some(slot) = self.blocks.get_mut(self.next as usize % BLOCKS) {
            *slot = block;
        }
        self.next = self.next.wrapping_add(1);
    }

    /// Forgets what came before the last flight; gives the number of blocks after it that can be
    /// learned from.
    pub(super) fn keep_last_touch(&mut self) -> u32 {
        let mut learned = 0;
        let mut number = self.next;
        while number > self.oldest() {
            number -= 1;
            let count = self.get(number).map_or(T::zero(), |block| block.count);
            if count < T::zero() {
                break;
            }
            learned += u32::from(count > T::zero());
        }
        self.first = number;
        learned
    }

    /// The block that is under way, as far as it goes.
    pub(super) fn open(&self) -> Option<Block<T>> {
        (self.open.samples > 0).then(|| self.open.closed())
    }

    /// Takes an instant; gives the block that it ends, to be pushed. `depth` is how deep it is, as
    /// far as is known, and how far that is off: not from the last impact, which says nothing where
    /// the material has not recovered.
    pub(super) fn follow(
        &mut self,
        at: &Instant<T>,
        depth: Option<(T, T)>,
        usable: bool,
        touching: bool,
    ) -> Option<Block<T>> {
        let (depth, error) = depth.unwrap_or((-T::one(), T::zero()));
        let near = depth > -(T::from_f64(CLEAR) * error);
        let kind = if usable {
            Kind::Learned
        } else if touching || near {
            Kind::Passed
        } else {
            Kind::Free
        };
        let mut ended = None;
        if self.open.samples > 0 && self.open.kind != kind {
            ended = Some(self.close());
            self.since_motion_s = T::zero();
        }
        self.open.kind = kind;
        self.open.add(at);
        if ended.is_none() && self.is_full(at, depth.abs().max_of(error)) {
            ended = Some(self.close());
        }
        ended
    }

    fn is_full(&mut self, at: &Instant<T>, depth: T) -> bool {
        if self.open.kind == Kind::Free || self.open.samples < SHORTEST {
            return false;
        }
        let moved = (at.position() - self.open.first).abs();
        if moved > T::from_f64(MOVES) * depth {
            self.since_motion_s = T::zero();
            return true;
        }
        let still_s = self.since_motion_s + self.open.duration_s;
        self.open.duration_s >= T::from_f64(HOLD_SHARE) * still_s
    }

    fn close(&mut self) -> Block<T> {
        self.since_motion_s += self.open.duration_s;
        let block = self.open.closed();
        self.open = Open::default();
        block
    }
}
