//! The way to the first touch, condensed.
//!
//! A force threshold finds a touch late: at 0.3 mm/s and 30 mN of noise after 0.36 s and 0.1 mm, more than two time
//! constants of a mode of 6.5/s. Until then nobody knows that there is a surface, and a material that was taken to be
//! at rest where the force was found had its mode at 4.1 ± 0.2 and a stiffness of 2440 ± 40 for 3000 N/m.

use super::block::{Block, Kind, OpenBlock};
use super::block_history::{MOVES, SHORTEST};
use crate::estimate::identify::Instant;
use crate::maths::scalar::Real;

/// Blocks that are kept: half a reference depth.
const KEPT: usize = 16;

/// The last blocks before the first touch, each a step of the way, however long it takes.
#[derive(Clone, Debug)]
pub(super) struct Approach<T> {
    blocks: [Block<T>; KEPT],
    /// How many there were.
    count: usize,
    open: OpenBlock<T>,
}

impl<T: Real> Approach<T> {
    pub(super) fn new() -> Self {
        Approach {
            blocks: [Block::default(); KEPT],
            count: 0,
            open: OpenBlock::default(),
        }
    }

    /// Takes an instant before the first touch.
    pub(super) fn add(&mut self, at: &Instant<T>) {
        self.open.kind = Kind::Observed;
        self.open.add(at);
        let moved = (at.position() - self.open.first).abs();
        if self.open.samples >= SHORTEST && moved > T::from_f64(MOVES) {
            self.close();
        }
    }

    fn close(&mut self) {
        if let Some(slot) = self.blocks.get_mut(self.count % KEPT) {
            *slot = self.open.block();
        }
        self.count = self.count.wrapping_add(1);
        self.open = OpenBlock::default();
    }

    /// The blocks up to the touch, the oldest first.
    pub(super) fn touched(&mut self) -> impl Iterator<Item = Block<T>> + '_ {
        if self.open.samples > 0 {
            self.close();
        }
        let kept = self.count.min(KEPT);
        let oldest = self.count - kept;
        (oldest..self.count).filter_map(|number| self.blocks.get(number % KEPT).copied())
    }
}
