//! What the best set leaves, as a coloured process of its own, and what an effect takes off beside it.
//!
//! A remainder that wanders is followed by whatever wanders as well: under a pendulum's record a wave of 0.05 Hz
//! took 60 % off the squares, and 6 % of what a prediction from the last samples leaves. What a record has put
//! into it (a play, a lag, a cogging) is sharper than its remainder and keeps its gain there.

use crate::gap::search::blocks::Blocks;

/// Samples that predict the next one.
const ORDER: usize = 6;

/// A process that is predicted from its last samples.
pub(super) struct Remainder {
    /// What each of them counts, the latest first.
    shares: [f64; ORDER],
}

impl Remainder {
    /// The process that residuals are a piece of: Levinson's recursion on their products at 0…6 samples.
    pub(super) fn of(residuals: &[f64]) -> Remainder {
        let product = |lag: usize| -> f64 {
            let late = residuals.get(lag..).unwrap_or_default();
            residuals.iter().zip(late).map(|(a, b)| a * b).sum()
        };
        let products: [f64; ORDER + 1] = std::array::from_fn(product);
        // A share of white noise keeps a pure tone from being predicted for ever.
        let mut left = products[0] * (1.0 + 1e-6);
        let mut shares = [0.0; ORDER];
        for order in 0..ORDER {
            if left <= 0.0 {
                break;
            }
            let known = (0..order).map(|at| shares[at] * products[order - at]);
            let new = (products[order + 1] - known.sum::<f64>()) / left;
            let before = shares;
            for at in 0..order {
                shares[at] -= new * before[order - 1 - at];
            }
            shares[order] = new;
            left *= 1.0 - new * new;
        }
        Remainder { shares }
    }

    /// What its prediction leaves of residuals, from the first sample on that has all before it.
    pub(super) fn unpredicted(&self, residuals: &[f64]) -> Vec<f64> {
        let windows = residuals.windows(ORDER + 1);
        let left = |window: &[f64]| {
            let last = window.iter().rev().skip(1).zip(&self.shares);
            window[ORDER] - last.map(|(value, share)| value * share).sum::<f64>()
        };
        windows.map(left).collect()
    }

    /// How many times as many squares one fit leaves as another beside the process, and how many standard errors
    /// its logarithm is from 0, from the scatter of the blocks.
    pub(super) fn gain(&self, more: &[f64], less: &[f64], blocks: &Blocks) -> (f64, f64) {
        let (more, less) = (self.unpredicted(more), self.unpredicted(less));
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let pairs = blocks.each(&more, ORDER).zip(blocks.each(&less, ORDER));
        let ratios: Vec<f64> = pairs
            .map(|(more, less)| squares(more) / squares(less))
            .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
            .map(f64::ln)
            .collect();
        let count = ratios.len() as f64;
        let mean = ratios.iter().sum::<f64>() / count;
        let scatter = ratios.iter().map(|own| (own - mean).powi(2)).sum::<f64>();
        let error = (scatter / (count - 1.0) / count).sqrt();
        (squares(&more) / squares(&less), mean / error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    const SEED_REMAINDER: u64 = 11;

    /// What wanders with a memory of a hundred samples, and the shocks that drive it.
    fn wandering() -> (Vec<f64>, Vec<f64>) {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_REMAINDER);
        let normal = Normal::new(0.0, 1.0).unwrap();
        let shocks: Vec<f64> = (0..4800).map(|_| normal.sample(&mut rng)).collect();
        let mut value = 0.0;
        let keep = |shock: &f64| {
            value = 0.99 * value + shock;
            value
        };
        (shocks.iter().map(keep).collect(), shocks)
    }

    #[test]
    fn a_process_with_a_memory_is_predicted_to_its_shocks() {
        let (wandering, shocks) = wandering();
        let left = Remainder::of(&wandering).unpredicted(&wandering);
        let squares = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let ratio = squares(&left) / squares(&shocks[ORDER..]);
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn what_wanders_with_the_remainder_gains_little_and_what_is_sharp_gains_much() {
        // GIVEN a remainder, and beside it a slow wave or a friction of as many squares
        let (wandering, _) = wandering();
        let process = Remainder::of(&wandering);
        let size = (wandering.iter().map(|v| v * v).sum::<f64>() / 4800.0).sqrt();
        let slow = |at: usize| 1.4 * size * (2e-3 * at as f64).sin();
        let sharp = |at: usize| {
            if (at / 100).is_multiple_of(2) {
                size
            } else {
                -size
            }
        };
        let with = |add: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let each = wandering.iter().enumerate();
            each.map(|(at, value)| value + add(at)).collect()
        };
        // THEN the wave takes off hardly anything beside the process, and the friction does in every block:
        // a step of 14 shocks in each 100 samples.
        let (slow, _) = process.gain(&with(&slow), &wandering, &Blocks::windows(4800));
        let (sharp, sigmas) = process.gain(&with(&sharp), &wandering, &Blocks::windows(4800));
        assert!(slow < 1.02, "{slow}");
        assert!(sharp > 1.5 && sigmas > 10.0, "{sharp} {sigmas}");
    }

    #[test]
    fn residuals_that_are_nothing_gain_nothing() {
        let process = Remainder::of(&[0.0; 100]);
        let (ratio, sigmas) = process.gain(&[0.0; 100], &[0.0; 100], &Blocks::windows(100));
        assert!(
            ratio.is_nan() && sigmas.is_nan(),
            "no evidence: {ratio} {sigmas}"
        );
    }
}
