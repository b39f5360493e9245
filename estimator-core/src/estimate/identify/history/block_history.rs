//! The recent past, condensed: means over blocks of samples, the last [`BLOCKS`] of them.
//!
//! Where the depth moves a block is [`SHORTEST`] samples long, or moves by 3 % of the depth, in a hold 4 % of
//! the time since the motion ended, in free air as long as the flight: a press and a hold of a minute are
//! 150 blocks, a stroke of a palpation 60. A law whose memory is linear gives the mean force of a block from the
//! mean of its elastic response, however long the block.

use super::block::{Block, Kind, OpenBlock};
use crate::estimate::identify::Instant;
use crate::maths::scalar::Real;

/// Blocks that are kept: ten strokes. What has left them is known at one reference only, and the two modes of a
/// material that is never held take three strokes and more to be told from one.
pub(super) const BLOCKS: usize = 640;
/// Samples of a block in motion: half the memory of the default filter.
pub(super) const SHORTEST: u32 = 8;
/// A block ends when the depth has moved by this share of itself,
pub(super) const MOVES: f64 = 0.03;
/// when it has moved by half of that and not evenly, as a law with memory takes it: a slow press may become a hold
/// within a block of 0.3 s, two time constants of a mode of 6.5/s;
/// or when it is this share of the time since the motion ended.
const HOLD_SHARE: f64 = 0.04;
/// A probe this many standard errors of the surface above it is in free air.
const CLEAR: f64 = 6.0;

/// The last blocks, numbered from 0 on, and the one under way.
#[derive(Clone, Debug)]
pub(super) struct BlockHistory<T> {
    blocks: [Block<T>; BLOCKS],
    /// Number of the next block, and of the first that still counts.
    next: u32,
    first: u32,
    open: OpenBlock<T>,
    since_motion_s: T,
}

impl<T: Real> BlockHistory<T> {
    pub(super) fn new() -> Self {
        BlockHistory {
            blocks: [Block::default(); BLOCKS],
            next: 0,
            first: 0,
            open: OpenBlock::default(),
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

    /// Forgets what came before the last flight; returns the number of blocks after it that can be
    /// learned from.
    pub(super) fn keep_last_touch(&mut self) -> u32 {
        let mut usable = 0;
        let mut number = self.next;
        while number > self.oldest() {
            number -= 1;
            let count = self.get(number).map_or(T::zero(), |block| block.count);
            if count < T::zero() {
                break;
            }
            usable += u32::from(count > T::zero());
        }
        self.first = number;
        usable
    }

    /// The block that is under way, as far as it goes.
    pub(super) fn open(&self) -> Option<Block<T>> {
        (self.open.samples > 0).then(|| self.open.block())
    }

    /// Takes an instant; returns the block that it ends, to be pushed. `depth` is the depth, as far
    /// as it is known, with its standard error: not from the last impact, which says nothing where
    /// the material has not recovered.
    pub(super) fn add(
        &mut self,
        at: &Instant<T>,
        depth: Option<(T, T)>,
        usable: bool,
        in_contact: bool,
    ) -> Option<Block<T>> {
        let (depth, error) = depth.unwrap_or((-T::one(), T::zero()));
        let near = depth > -(T::from_f64(CLEAR) * error);
        let kind = if usable {
            Kind::Usable
        } else if in_contact || near {
            Kind::Observed
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
        let moves = T::from_f64(MOVES) * depth;
        if moved > moves || (moved + moved > moves && self.open.is_uneven(moved)) {
            self.since_motion_s = T::zero();
            return true;
        }
        let still_s = self.since_motion_s + self.open.duration_s;
        self.open.duration_s >= T::from_f64(HOLD_SHARE) * still_s
    }

    fn close(&mut self) -> Block<T> {
        self.since_motion_s += self.open.duration_s;
        let block = self.open.block();
        self.open = OpenBlock::default();
        block
    }
}
