//! Whether the force has leapt in a hold.

use crate::maths::scalar::Real;

/// In a hold nothing is learned, and what relaxes leaves the prediction there, too: only a force that has leapt
/// is of another material. Of means over blocks of half as many samples as a change takes, the newest and the one
/// two before it are alike to this share (and two standard deviations), and the one six before it, with the leap
/// between, was so much smaller. What relaxes within 30 ms is the fastest that does not leap.
const LEAP_ALIKE: f64 = 0.1;
const LEAP_BEFORE: f64 = 0.25;
const LEAP_BLOCKS: usize = 6;

/// Normalized innovations up to now in a hold, in which nothing is learned. Those before it are among them: the gate
/// stays open 64 samples into a hold, and a material that changed as it closed was not noticed before the way out.
#[derive(Clone, Debug)]
pub(super) struct Hold<T> {
    sum: T,
    samples: u32,
    /// Means of the last blocks, the newest first, and how many there were.
    means: [T; LEAP_BLOCKS],
    blocks: u32,
}

impl<T: Real> Default for Hold<T> {
    fn default() -> Self {
        Hold {
            sum: T::zero(),
            samples: 0,
            means: [T::zero(); LEAP_BLOCKS],
            blocks: 0,
        }
    }
}

impl<T: Real> Hold<T> {
    /// Takes a sample; says by how much the force has leapt, if it has, at the end of a block of so many.
    pub(super) fn take(&mut self, normalized: T, samples: u32) -> Option<T> {
        self.sum += normalized;
        self.samples += 1;
        if self.samples < samples {
            return None;
        }
        let mean = self.sum / T::from_u32(self.samples);
        let size = mean.abs();
        let [_, recent, .., before] = self.means;
        let alike = (mean - recent).abs() < T::from_f64(LEAP_ALIKE) * size + T::from_f64(2.0);
        let leapt = before.abs() < T::from_f64(LEAP_BEFORE) * size;
        let is_known = self.blocks as usize >= LEAP_BLOCKS;
        self.means.rotate_right(1);
        if let Some(newest) = self.means.first_mut() {
            *newest = mean;
        }
        (self.sum, self.samples, self.blocks) = (T::zero(), 0, self.blocks.saturating_add(1));
        (is_known && alike && leapt).then_some(size)
    }
}
