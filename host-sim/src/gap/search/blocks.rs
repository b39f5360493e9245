//! The pieces of the logs in which an effect must speak for itself.
//!
//! What acts at lift-off acts in every touch, and not in every window of one length: an adhesion with another neck than
//! the catalogue's took off 83 % of what stood without it, in 56 % of 24 windows and in every touch. A block is therefore
//! a touch, or a turn to and fro of what touches nothing; a window where there are too few of these.

use std::ops::Range;

use crate::gap::data::fit_data::FitData;
use crate::gap::model::{dataset::Dataset, fit::Fit, simulate::depths};
use crate::stats::{extent, highest};

/// Windows of the logs, and blocks that touches are put together to where they are twice as many: a palpation of 15 s
/// has about as many strokes.
const USUAL: usize = 24;
/// Fewest touches: with fewer a share of them says little. Rigs press 4 to 7 times in 15 s.
const FEWEST: usize = 4;
/// A touch begins where this share of the greatest depth is reached, so that the noise of the position at the surface is
/// none.
const TOUCHED: f64 = 0.05;
/// A turn begins this share of the travel above its lower end, and ends as far below its upper end.
const TURNED: f64 = 0.6;

/// An effect acts in a block if it changes the forces there by at least this share of the mean square.
const ACTS: f64 = 0.2;

/// Pieces of the logs, one after another, that are all of them.
pub(super) struct Blocks {
    ranges: Vec<Range<usize>>,
}

impl Blocks {
    /// The touches in the logs as a fit sees them.
    pub(super) fn of(dataset: &Dataset<'_>, fit: &Fit) -> Blocks {
        Blocks::at(&cuts(dataset, fit))
    }

    /// Blocks between cuts, of which the first is 0 and the last the length.
    fn at(cuts: &[usize]) -> Blocks {
        let len = cuts.last().copied().unwrap_or(0);
        if cuts.len() <= FEWEST {
            return Blocks::windows(len);
        }
        let together = ((cuts.len() - 1) / USUAL).max(1);
        let mut kept: Vec<usize> = cuts[..cuts.len() - 1]
            .iter()
            .copied()
            .step_by(together)
            .collect();
        kept.push(len);
        let ranges = kept.windows(2).map(|pair| pair[0]..pair[1]);
        Blocks {
            ranges: ranges.collect(),
        }
    }

    /// Windows of one length.
    pub(super) fn windows(len: usize) -> Blocks {
        let size = len.div_ceil(USUAL).max(1);
        let starts = (0..len).step_by(size);
        Blocks {
            ranges: starts.map(|from| from..(from + size).min(len)).collect(),
        }
    }

    /// The fraction of blocks in which one fit leaves more than the other, of those in which they differ.
    pub(super) fn better(&self, more: &[f64], less: &[f64]) -> f64 {
        let rows: Vec<[f64; 2]> = more
            .iter()
            .zip(less)
            .map(|(a, b)| [a * a - b * b, (a - b).powi(2)])
            .collect();
        let sum = |block: &[[f64; 2]]| {
            block
                .iter()
                .fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]])
        };
        let blocks: Vec<[f64; 2]> = self.each(&rows, 0).map(sum).collect();
        let mean = blocks.iter().map(|block| block[1]).sum::<f64>() / blocks.len().max(1) as f64;
        let acting = blocks.iter().filter(|block| block[1] > ACTS * mean);
        let better = acting.clone().filter(|block| block[0] > 0.0).count();
        better as f64 / acting.count().max(1) as f64
    }

    /// What the blocks make of values that lack the first `missing` of the logs.
    pub(super) fn each<'a, T>(
        &'a self,
        values: &'a [T],
        missing: usize,
    ) -> impl Iterator<Item = &'a [T]> {
        let within = move |range: &Range<usize>| {
            let at = |at: usize| at.saturating_sub(missing).min(values.len());
            &values[at(range.start)..at(range.end)]
        };
        self.ranges.iter().map(within)
    }
}

/// Where the touches in the logs begin and end as a fit sees them, from 0 to the length.
fn cuts(dataset: &Dataset<'_>, fit: &Fit) -> Vec<usize> {
    let depths = depths(&fit.shape, &fit.numbers, dataset.logs);
    let deepest = highest(depths.iter().flatten().copied());
    let (mut cuts, mut from) = (vec![0], 0);
    for (log, depths) in dataset.logs.iter().zip(&depths) {
        let own = match deepest > 0.0 {
            true => between(depths, TOUCHED * deepest, 0.0),
            false => turns(log),
        };
        cuts.extend(own.into_iter().map(|at| from + at));
        from += log.len();
        cuts.push(from);
    }
    cuts
}

/// Whether the logs have too few touches for a share of them to say something: one press tells of a friction at one
/// reversal.
pub(crate) fn are_touches_few(dataset: &Dataset<'_>, fit: &Fit) -> bool {
    cuts(dataset, fit).len() <= FEWEST
}

/// Where a log is cut so that each piece has one stay above: in the middle between one's end and the next one's begin.
fn between(values: &[f64], begin: f64, end: f64) -> Vec<usize> {
    let (mut cuts, mut left, mut is_in) = (Vec::new(), None, false);
    for (at, value) in values.iter().enumerate() {
        if is_in && *value <= end {
            (is_in, left) = (false, Some(at));
        } else if !is_in && *value > begin {
            is_in = true;
            cuts.extend(left.map(|left: usize| left.midpoint(at)));
        }
    }
    cuts
}

fn turns(log: &FitData) -> Vec<usize> {
    let (least, most) = extent(&log.position_m);
    let at = |share: f64| least + share * (most - least);
    between(&log.position_m, at(TURNED), at(1.0 - TURNED))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(blocks: &Blocks) -> Vec<Range<usize>> {
        blocks.ranges.clone()
    }

    #[test]
    fn a_log_is_cut_in_the_middle_of_what_is_between_touches() {
        let depths = [0.0, 1.0, 1.0, 0.0, 0.0, 0.01, 0.0, 1.0, 0.5, 0.0, 0.0, 1.0];
        // A hundredth of the depth is no touch.
        assert_eq!(between(&depths, 0.05, 0.0), [5, 10]);
    }

    #[test]
    fn many_touches_are_put_together_and_few_are_windows() {
        let cut = |touches: usize| {
            let cuts: Vec<usize> = (0..=touches).map(|at| 10 * at).collect();
            ranges(&Blocks::at(&cuts))
        };
        assert_eq!(cut(12)[1], 10..20);
        assert_eq!(cut(12).len(), 12);
        assert_eq!(cut(100)[1], 40..80);
        assert_eq!(cut(100).last(), Some(&(960..1000)));
        assert_eq!(cut(4).len(), 4);
        assert_eq!(cut(3), ranges(&Blocks::windows(30)));
        assert_eq!(ranges(&Blocks::windows(110)).len(), 22);
        assert!(ranges(&Blocks::windows(0)).is_empty());
    }

    #[test]
    fn values_that_lack_the_first_ones_stay_with_their_blocks() {
        let blocks = Blocks {
            ranges: vec![0..2, 2..5],
        };
        let values = [12, 13, 14];
        let each: Vec<&[i32]> = blocks.each(&values, 2).collect();
        assert_eq!(each, [&[] as &[i32], &[12, 13, 14]]);
    }
}
