//! Steps of the zero: from an instant on the force is off by one amount, beside all that the numbers of a fit can do.
//!
//! No effect of the catalogue is one, and several take most of it off: a zero of a load cell that jumped by 0.15 N in
//! the middle of a log was a drift, an offset or a loop of hysteresis, each with strong evidence.

use std::ops::Range;

use crate::gap::data::low_pass::LowPass;
use crate::gap::model::fit::Fit;
use crate::gap::model::problem::{Linearization, Problem};
use crate::lsq::basis::{add_column, dot, project_out};
use crate::lsq::dense;

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
/// The same beside other steps, where each has less of its own: in the middle of three beside a zero and a ramp 0.07. Derived:
/// ten times the standard error.
const LEAST_BESIDE: f64 = 0.01;
/// Most steps in a log, and the least share that one takes off what the others leave. Not measured.
const MOST_STEPS: usize = 4;
const LEAST_SHARE: f64 = 0.2;
/// The largest jumps that are looked at: a touch that a fit has at another instant jumps, too.
const MOST_JUMPS: usize = 12;

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
            Some((
                number,
                left.largest_step(
                    rows.clone(),
                    (rows, LEAST_OWN),
                    clear(problem, log.period_s),
                )?,
            ))
        });
        each.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
    }

    /// The sharp steps of the first log, in the order of time, each with the share that it takes off beside those before which
    /// it was found. Two tares and a knock leave one step among others, of which none is nearly all.
    pub(crate) fn all(problem: &Problem<'_>, fit: &Fit) -> Vec<ZeroStep> {
        let Some(log) = problem.logs.first() else {
            return Vec::new();
        };
        Left::of(problem, fit).steps(0..log.len(), clear(problem, log.period_s))
    }
}

/// Samples on either side of an instant that are left out.
fn clear(problem: &Problem<'_>, period_s: f64) -> usize {
    CLEAR.max(problem.low_pass.map_or(0, |own| rise(own, period_s)))
}

/// Samples in which a step behind a low-pass rises.
fn rise(low_pass: LowPass, period_s: f64) -> usize {
    (0.5 / (low_pass.corner_hz * period_s)).ceil() as usize
}

/// What a fit leaves, and what its numbers can do about it.
#[derive(Clone)]
pub(super) struct Left {
    /// √w of each sample.
    pub(super) roots: Vec<f64>,
    /// √w r, without what the numbers can take off.
    pub(super) white: Vec<f64>,
    /// Orthonormal changes of √w·force that they make.
    pub(super) basis: Vec<Vec<f64>>,
}

impl Left {
    fn of(problem: &Problem<'_>, fit: &Fit) -> Left {
        let linear = problem.linearize(&fit.shape, &fit.numbers);
        Left::of_linear(problem, fit, &linear)
    }

    pub(super) fn of_linear(problem: &Problem<'_>, fit: &Fit, linear: &Linearization) -> Left {
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

    /// The sharp steps within some rows. Where a force jumps nothing slow hides it: of the instants at which it jumps most
    /// those stay that are needed beside the others. Adding one step after the other ends elsewhere: of 0.1, −0.15 and 0.2 N
    /// beside a zero and a ramp the step that alone takes most off was none of them.
    fn steps(&self, rows: Range<usize>, clear: usize) -> Vec<ZeroStep> {
        let mut all = self.jumps(&rows, clear);
        let one = self.largest_step(rows.clone(), (rows.clone(), LEAST_OWN), clear);
        all.extend(one.map(|own| rows.start + own.at));
        all.sort_unstable();
        all.dedup_by_key(|at| *at / clear);
        let column = |at: &usize| self.column(*at..rows.end);
        let needed = self.needed(all.iter().map(column).collect());
        let mut steps: Vec<ZeroStep> = Vec::new();
        for own in &needed {
            let mut beside = self.clone();
            let others = needed.iter().filter(|other| other.at != own.at);
            others.for_each(|other| beside.know(column(&all[other.at])));
            let near = all[own.at].saturating_sub(2 * clear)..all[own.at] + 2 * clear;
            let step = beside.largest_step(rows.clone(), (near, LEAST_BESIDE), clear);
            steps.extend(step.map(|step| ZeroStep {
                share: own.share,
                ..step
            }));
        }
        steps
    }

    /// The instants within some rows at which what is left jumps most.
    fn jumps(&self, rows: &Range<usize>, clear: usize) -> Vec<usize> {
        let far = clear * (1 + AVERAGED);
        let mut sums = vec![(0.0, 0.0)];
        for at in rows.clone() {
            let (along, square) = sums[sums.len() - 1];
            let root = self.roots[at];
            sums.push((along + root * self.white[at], square + root * root));
        }
        let mean = |from: usize, to: usize| {
            let (along, square) = (sums[to].0 - sums[from].0, sums[to].1 - sums[from].1);
            if square > 0.0 { along / square } else { 0.0 }
        };
        let inner = far..rows.len().saturating_sub(far);
        let jump = |at: usize| mean(at + clear, at + far) - mean(at - far, at - clear);
        let mut order: Vec<(f64, usize)> = inner.map(|at| (jump(at).abs(), at)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut chosen: Vec<usize> = Vec::new();
        for (_, at) in order {
            if chosen.iter().all(|other| other.abs_diff(at) >= far) {
                chosen.push(at);
            }
            if chosen.len() == MOST_JUMPS {
                break;
            }
        }
        chosen.into_iter().map(|at| rows.start + at).collect()
    }

    /// What a newton in some rows is of √w·force.
    fn column(&self, rows: Range<usize>) -> Vec<f64> {
        let mut column = vec![0.0; self.roots.len()];
        column[rows.clone()].copy_from_slice(&self.roots[rows]);
        column
    }

    /// Adds a change of √w·force to those that the numbers can make.
    pub(super) fn know(&mut self, column: Vec<f64>) {
        let known = self.basis.len();
        add_column(&mut self.basis, column, &[]);
        project_out(&mut self.white, &self.basis[known..]);
    }

    /// How much of each of some changes of √w·force is in what is left, all at once; `None` where that cannot be told.
    pub(super) fn amounts(&self, mut columns: Vec<Vec<f64>>) -> Option<Vec<f64>> {
        let each = columns.iter_mut();
        each.for_each(|column| project_out(column, &self.basis));
        let places: Vec<usize> = (0..columns.len()).collect();
        Some(Normal::of(&columns, &self.white).solved(&places)?.0)
    }

    /// Which of some changes of √w·force are needed beside the others: without it a good share more is left. None where that
    /// are more than there may be steps.
    pub(super) fn needed(&self, columns: Vec<Vec<f64>>) -> Vec<Needed> {
        let (mut kept, mut own) = (Vec::new(), Vec::new());
        for (at, mut column) in columns.into_iter().enumerate() {
            let whole = dot(&column, &column);
            project_out(&mut column, &self.basis);
            if dot(&column, &column) > LEAST_BESIDE * whole {
                kept.push(at);
                own.push(column);
            }
        }
        let mut places: Vec<usize> = (0..own.len()).collect();
        let normal = Normal::of(&own, &self.white);
        while let Some((amounts, cost)) = normal.solved(&places) {
            let without = |out: usize| {
                let mut rest = places.clone();
                rest.remove(out);
                normal.solved(&rest).map_or(f64::INFINITY, |own| own.1)
            };
            let costs: Vec<f64> = (0..places.len()).map(without).collect();
            let least = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b]));
            match least.filter(|at| cost > (1.0 - LEAST_SHARE) * costs[*at]) {
                Some(idle) => drop(places.remove(idle)),
                None if places.len() > MOST_STEPS => return Vec::new(),
                None => return normal.shared(&kept, &places, &amounts, (cost, &costs)),
            }
        }
        Vec::new()
    }

    /// The step within some rows that takes most off, of those at some of them; `None` if that is not sharp.
    fn largest_step(
        &self,
        rows: Range<usize>,
        (among, least_own): (Range<usize>, f64),
        clear: usize,
    ) -> Option<ZeroStep> {
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
            if before < side || after < side || own < least_own * square || !among.contains(&at) {
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

/// One of several changes of the force that are needed beside each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needed {
    /// Its place among all.
    pub(super) at: usize,
    /// How much of it is in what is left.
    pub(super) amount: f64,
    /// The share of Σ w r² that it takes off.
    pub(super) share: f64,
}

/// The normal equations of some changes of √w·force to what is left.
struct Normal {
    square: f64,
    pairs: Vec<f64>,
    along: Vec<f64>,
}

impl Normal {
    fn of(columns: &[Vec<f64>], left: &[f64]) -> Normal {
        let n = columns.len();
        let pair = |at: usize| dot(&columns[at / n], &columns[at % n]);
        Normal {
            square: dot(left, left),
            pairs: (0..n * n).map(pair).collect(),
            along: columns.iter().map(|column| dot(column, left)).collect(),
        }
    }

    /// How much of each of those at some places there is, and Σ w r² with them; `None` for none, or if they are alike.
    fn solved(&self, places: &[usize]) -> Option<(Vec<f64>, f64)> {
        let (n, of) = (places.len(), self.along.len());
        let each = (0..n * n).map(|at| self.pairs[places[at / n] * of + places[at % n]]);
        let along: Vec<f64> = places.iter().map(|at| self.along[*at]).collect();
        let amounts = dense::solve(&dense::cholesky(&each.collect::<Vec<_>>(), n)?, n, &along);
        let cost = self.square - dot(&amounts, &along);
        Some((amounts, cost))
    }

    /// Those at some places of `kept`, with what they take off together by what each takes off beside the others.
    fn shared(
        &self,
        kept: &[usize],
        places: &[usize],
        amounts: &[f64],
        (cost, without): (f64, &[f64]),
    ) -> Vec<Needed> {
        // Without the only one all of it is left.
        let more = |own: &f64| own.min(self.square) - cost;
        let all: f64 = without.iter().map(more).sum();
        let together = 1.0 - cost / self.square;
        let each = places.iter().zip(amounts).zip(without);
        each.map(|((place, amount), own)| Needed {
            at: kept[*place],
            amount: *amount,
            share: together * more(own) / all,
        })
        .collect()
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
        let found = left(step(1e-3))
            .largest_step(0..2000, (0..2000, LEAST_OWN), CLEAR)
            .unwrap();
        assert!(found.at.abs_diff(700) <= 1, "{found:?}");
        assert!((found.force_n + 0.15).abs() < 0.005, "{found:?}");
        // What the wave leaves.
        assert!((found.cost - 0.4).abs() < 0.02, "{found:?}");
        assert_eq!(
            left(step(400.0)).largest_step(0..2000, (0..2000, LEAST_OWN), CLEAR),
            None
        );
    }

    #[test]
    fn of_several_steps_each_is_found_with_its_amount() {
        // GIVEN three tares of 0.1, -0.15 and 0.2 N of a zero that drifts, too
        let steps = [(450, 0.1), (900, -0.15), (1500, 0.2)];
        let wave = |at: usize| 0.004 * (0.3 * at as f64).sin();
        let off = |at: usize| -> f64 {
            let before = steps.iter().filter(|own| at >= own.0);
            before.map(|own| own.1).sum()
        };
        let white = |at: usize| off(at) + wave(at) + 1e-4 * at as f64;
        let found = left((0..2000).map(white).collect()).steps(0..2000, CLEAR);
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, (at, force_n)) in found.iter().zip(steps) {
            assert!(found.at.abs_diff(at) <= 1, "{found:?}");
            assert!((found.force_n - force_n).abs() < 0.003, "{found:?}");
        }
        let share: f64 = found.iter().map(|own| own.share).sum();
        assert!((0.98..=1.0).contains(&share), "{share}");
        // AND of one there is one.
        let one = left(
            (0..2000)
                .map(|at| f64::from(u8::from(at > 800)) + wave(at))
                .collect(),
        );
        assert_eq!(one.steps(0..2000, CLEAR).len(), 1);
    }

    #[test]
    fn what_is_off_at_the_ends_of_a_log_or_nowhere_is_no_step() {
        let late = |at: usize| f64::from(u8::from(at >= 1990));
        let found =
            left((0..2000).map(late).collect()).largest_step(0..2000, (0..2000, LEAST_OWN), CLEAR);
        assert!(found.is_none_or(|own| own.at < 1960), "{found:?}");
        assert_eq!(
            left(vec![0.0; 2000]).largest_step(0..2000, (0..2000, LEAST_OWN), CLEAR),
            None
        );
    }
}
