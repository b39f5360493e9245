//! A step of the zero: from an instant on the force is off by one amount, beside all that the numbers of a fit can do.
//!
//! No effect of the catalogue is one, and several take most of it off: a zero of a load cell that jumped by 0.15 N in
//! the middle of a log was a drift, an offset or a loop of hysteresis, each with strong evidence.

use std::ops::Range;

use crate::gap::data::low_pass::LowPass;
use crate::gap::model::{fit::Fit, problem::Problem};
use crate::lsq::basis::{add_column, project_out};

/// Samples on either side of the instant that are left out where its sharpness is seen, and as many times as many that
/// are averaged.
const CLEAR: usize = 8;
const AVERAGED: usize = 4;
/// The share of the step that must be seen there. A ramp of a tenth of the log shows a tenth in 1 % of it.
const SHARP: f64 = 0.7;
/// The least share of a log's samples on either side: what is off in the last few samples is no zero.
const LEAST_SIDE: f64 = 0.02;
/// The least share of a step that the numbers of the fit cannot make. Derived: of less its size has three times the
/// standard error that it has beside no number.
const LEAST_OWN: f64 = 0.1;

/// A step of the zero beside a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ZeroStep {
    /// The first sample of the log after it.
    pub(crate) at: usize,
    /// By what the force is off from there on (N).
    pub(crate) force_n: f64,
    /// Σ w r² with it.
    pub(crate) cost: f64,
    /// The share of Σ w r² that it takes off.
    pub(crate) share: f64,
}

impl ZeroStep {
    /// The sharp step in one of the logs that takes most off what a fit leaves, with the numbers of the fit refitted to
    /// first order, and the number of its log.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Option<(usize, ZeroStep)> {
        let left = Left::of(problem, fit);
        let mut from = 0;
        let each = problem.logs.iter().enumerate().filter_map(|(number, log)| {
            let rows = from..from + log.len();
            from += log.len();
            let clear = CLEAR.max(problem.low_pass.map_or(0, |own| rise(own, log.period_s)));
            Some((number, left.largest_step(rows, clear)?))
        });
        each.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
    }
}

/// Samples in which a step behind a low-pass rises.
fn rise(low_pass: LowPass, period_s: f64) -> usize {
    (0.5 / (low_pass.corner_hz * period_s)).ceil() as usize
}

/// What a fit leaves, and what its numbers can do about it.
struct Left {
    /// √w of each sample.
    roots: Vec<f64>,
    /// √w r, without what the numbers can take off.
    white: Vec<f64>,
    /// Orthonormal changes of √w·force that they make.
    basis: Vec<Vec<f64>>,
}

impl Left {
    fn of(problem: &Problem<'_>, fit: &Fit) -> Left {
        let linear = problem.linearize(&fit.shape, &fit.numbers);
        let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
        let weighted = |channel: &[f64]| -> Vec<f64> {
            channel
                .iter()
                .zip(&roots)
                .map(|(v, root)| v * root)
                .collect()
        };
        let mut basis = Vec::new();
        for (column, is_at_bound) in linear.columns.iter().zip(fit.at_bound()) {
            if !is_at_bound {
                add_column(&mut basis, weighted(column), &[]);
            }
        }
        let mut from = 0;
        for log in problem.logs {
            for rows in log.after_steps() {
                let mut known = vec![0.0; roots.len()];
                let rows = from + rows.start..from + rows.end;
                known[rows.clone()].copy_from_slice(&roots[rows]);
                add_column(&mut basis, known, &[]);
            }
            from += log.len();
        }
        let mut white = weighted(&linear.residuals);
        project_out(&mut white, &basis);
        Left {
            roots,
            white,
            basis,
        }
    }

    /// The step within some rows that takes most off; `None` if that is not sharp.
    fn largest_step(&self, rows: Range<usize>, clear: usize) -> Option<ZeroStep> {
        let side = (LEAST_SIDE * rows.len() as f64) as usize + clear;
        // Sums from a row to the end of the log.
        let (mut along, mut square) = (0.0, 0.0);
        let mut shares = vec![0.0; self.basis.len()];
        let mut best: Option<(usize, f64, f64, Vec<f64>)> = None;
        for at in rows.clone().rev() {
            let root = self.roots[at];
            along += root * self.white[at];
            square += root * root;
            let each = shares.iter_mut().zip(&self.basis);
            each.for_each(|(share, direction)| *share += root * direction[at]);
            let own = square - shares.iter().map(|share| share * share).sum::<f64>();
            let (before, after) = (at - rows.start, rows.end - at);
            if before < side || after < side || own < LEAST_OWN * square {
                continue;
            }
            let gain = along * along / own;
            if best.as_ref().is_none_or(|(_, most, _, _)| gain > *most) {
                best = Some((at, gain, along / own, shares.clone()));
            }
        }
        let (at, gain, force_n, shares) = best?;
        let without: f64 = self.white.iter().map(|r| r * r).sum();
        let step = ZeroStep {
            at: at - rows.start,
            force_n,
            cost: without - gain,
            share: gain / without,
        };
        self.is_sharp(&rows, at, clear, force_n, &shares)
            .then_some(step)
    }

    /// Whether the residuals jump by a force at a row, where the numbers have made room for it by their `shares`.
    fn is_sharp(
        &self,
        rows: &Range<usize>,
        at: usize,
        clear: usize,
        force_n: f64,
        shares: &[f64],
    ) -> bool {
        let residual = |row: usize| {
            let made: f64 = self
                .basis
                .iter()
                .zip(shares)
                .map(|(own, share)| share * own[row])
                .sum();
            // What they take back of the step is not theirs once it is there.
            self.white[row] + force_n * made
        };
        let mean = |samples: Range<usize>| {
            let samples = samples.start.max(rows.start)..samples.end.min(rows.end);
            let (mut sum, mut weight) = (0.0, 0.0);
            for row in samples.filter(|row| self.roots[*row] > 0.0) {
                sum += self.roots[row] * residual(row);
                weight += self.roots[row] * self.roots[row];
            }
            sum / weight
        };
        let far = clear * (1 + AVERAGED);
        let jump = mean(at + clear..at + far) - mean(at.saturating_sub(far)..at - clear);
        jump / force_n >= SHARP
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log of `len` samples with what is left of it, where the model has a number for the zero and one for a ramp.
    fn left(white: Vec<f64>) -> Left {
        let len = white.len();
        let mut basis = Vec::new();
        add_column(&mut basis, vec![1.0; len], &[]);
        add_column(&mut basis, (0..len).map(|at| at as f64).collect(), &[]);
        let mut white = white;
        project_out(&mut white, &basis);
        Left {
            roots: vec![1.0; len],
            white,
            basis,
        }
    }

    #[test]
    fn a_step_is_found_beside_an_offset_and_a_ramp_and_a_slow_one_is_none() {
        let wave = |at: usize| 0.02 * (0.3 * at as f64).sin();
        let step = |width: f64| -> Vec<f64> {
            let rise = |at: usize| ((at as f64 - 700.0) / width + 0.5).clamp(0.0, 1.0);
            (0..2000).map(|at| -0.15 * rise(at) + wave(at)).collect()
        };
        let found = left(step(1e-3)).largest_step(0..2000, CLEAR).unwrap();
        assert!(found.at.abs_diff(700) <= 1, "{found:?}");
        assert!((found.force_n + 0.15).abs() < 0.005, "{found:?}");
        // What the wave leaves.
        assert!((found.cost - 0.4).abs() < 0.02, "{found:?}");
        assert_eq!(left(step(400.0)).largest_step(0..2000, CLEAR), None);
    }

    #[test]
    fn what_is_off_at_the_ends_of_a_log_or_nowhere_is_no_step() {
        let late = |at: usize| f64::from(u8::from(at >= 1990));
        let found = left((0..2000).map(late).collect()).largest_step(0..2000, CLEAR);
        assert!(found.is_none_or(|own| own.at < 1960), "{found:?}");
        assert_eq!(left(vec![0.0; 2000]).largest_step(0..2000, CLEAR), None);
    }
}
