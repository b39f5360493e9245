//! Which law: every candidate is fitted to the whole course, and the one with the smallest Bayesian
//! information criterion is taken.
//!
//! BIC = M·ln(χ²/N) + p·ln M. M is the number of *independent* residuals, N over the correlation
//! time that the best candidate leaves: with N itself the long holds of a measured record would buy a
//! mode for every wiggle. Modes of the quasi-linear law are chosen by the same score.

use rayon::prelude::*;

use super::course::Course;
use super::family::{Family, Form};
use super::fit::{Fit, Problem, STILL};
use super::held::Held;
use super::scales::Scales;
use super::start::{Given, Starts, scan};
use super::weights::{mask_surface, second_weights};
use crate::stats::correlation;

/// The first round ends where a step promises less than this of χ²; the second where it promises
/// nothing any more (`STILL`).
const ROUGH: f64 = 1e-2;
/// A mode that is added to a fit begins with this share of what does not relax.
const SMALL_MODE: f64 = 0.03;

/// A law that was fitted.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Its minimum.
    pub(super) fit: Fit,
    /// Weights of the nodes.
    pub(super) weights: Vec<f64>,
    /// BIC, less that of the best candidate.
    pub(super) score: f64,
}

/// What is fixed in advance.
#[derive(Clone, Debug, Default)]
pub(super) struct Fixed {
    /// Parameters that are held.
    pub(super) held: Held,
    /// The depth that their values hold at (m).
    pub(super) reference_depth_m: f64,
    /// The force is taken as read at the instant of the position.
    pub(super) without_skew: bool,
}

impl Fixed {
    /// The free numbers that stay, of a family.
    pub(super) fn of(&self, family: Family, scales: &Scales) -> Vec<usize> {
        let held = self.values(family, scales).into_iter().map(|(at, _)| at);
        held.collect()
    }

    fn values(&self, family: Family, scales: &Scales) -> Vec<(usize, f64)> {
        let mut held = self.held.fixed(family, scales, self.reference_depth_m);
        held.extend(
            family
                .skew()
                .filter(|_| self.without_skew)
                .map(|at| (at, 0.0)),
        );
        held.sort_by_key(|(at, _)| *at);
        held
    }

    /// What the scan of starts is given.
    fn given(&self, scales: &Scales) -> Given {
        let surface = self.held.value("surface");
        Given {
            surface: surface.map(|at| (at - scales.touch_m) / scales.depth_m),
            exponent: self.held.value("exponent"),
        }
    }
}

/// Fits every family, in their order; those without a minimum, and modes that nothing asks for, are
/// left out.
pub(super) fn candidates(course: &Course, families: &[Family], fixed: &Fixed) -> Vec<Candidate> {
    finished(course, roughly_fitted(course, families, fixed), fixed)
}

/// The first round: every family with the weights of the noise alone.
pub(super) fn roughly_fitted(
    course: &Course,
    families: &[Family],
    fixed: &Fixed,
) -> Vec<Candidate> {
    let noise_only = course.noise_weights();
    let starts = scan(families, course, &noise_only, fixed.given(&course.scales));
    let round = Round {
        course,
        weights: &noise_only,
        fixed,
        still: ROUGH,
    };
    let (chain, alone): (Vec<Family>, Vec<Family>) = families
        .iter()
        .partition(|family| family.listed_modes() > 0);
    // The chains take longest, so they are begun first.
    let of_form = |form| {
        chain
            .iter()
            .copied()
            .filter(move |family| family.elastic == form)
    };
    let mut tasks: Vec<Vec<Family>> = Form::ALL.map(|form| of_form(form).collect()).into();
    tasks.extend(alone.into_iter().map(|family| vec![family]));
    let chains = tasks.par_iter().map(|task| round.chain(task, &starts));
    let mut first: Vec<Candidate> = chains.flatten_iter().collect();
    let place = |candidate: &Candidate| families.iter().position(|f| *f == candidate.fit.family);
    first.sort_by_key(place);
    first
}

/// The second round, with the weights that the best of the first calls for, and the scores.
pub(super) fn finished(course: &Course, first: Vec<Candidate>, fixed: &Fixed) -> Vec<Candidate> {
    let best = first
        .iter()
        .min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost));
    let Some(best) = best else { return first };
    let weights = second_weights(course, &best.fit);
    let round = Round {
        course,
        weights: &weights,
        fixed,
        still: STILL,
    };
    let again = |Candidate { fit, .. }| round.fit(fit.family, [fit.free]);
    let again: Vec<Candidate> = first.into_par_iter().filter_map(again).collect();
    scored(course, round.nested(again))
}

/// Fits with one set of weights.
#[derive(Clone, Copy)]
struct Round<'a> {
    course: &'a Course,
    weights: &'a [f64],
    fixed: &'a Fixed,
    still: f64,
}

impl Round<'_> {
    /// One family after another, each also from the one before with a mode more; until a mode brings
    /// less than its two numbers are worth.
    fn chain(&self, families: &[Family], starts: &Starts) -> Vec<Candidate> {
        let mut chain: Vec<Candidate> = Vec::new();
        for family in families {
            let last = chain.last().map(|candidate| &candidate.fit);
            let nested = last.map(|fit| one_mode_more(&fit.free, fit.family));
            let nested = nested.filter(|free| free.len() == family.free());
            let Some(candidate) = self.fit(*family, starts.of(*family).chain(nested)) else {
                continue;
            };
            let before = last.map_or(f64::INFINITY, |fit| fit.cost);
            let gained = before - candidate.fit.cost;
            let worth =
                self.course.thresholds.selection.mode_worth * (self.course.nodes.len() as f64).ln();
            chain.push(candidate);
            if gained < worth {
                break;
            }
        }
        chain
    }

    /// The candidates, of which none with a mode more leaves more: under other weights another minimum may be the best
    /// one, and three modes left 59 mN where two of them left 40.
    fn nested(&self, candidates: Vec<Candidate>) -> Vec<Candidate> {
        let mut nested: Vec<Candidate> = Vec::new();
        for candidate in candidates {
            let Fit { family, cost, .. } = candidate.fit;
            let with_fewer = nested
                .last()
                .map(|last| &last.fit)
                .filter(|last| last.family.with_a_mode_more() == Some(family) && last.cost < cost);
            let starts = with_fewer.map(|last| one_mode_more(&last.free, last.family));
            let better = starts.and_then(|start| self.fit(family, [start]));
            nested.push(match better {
                Some(better) if better.fit.cost < cost => better,
                _ => candidate,
            });
        }
        nested
    }

    /// The best minimum from several starts; Kelvin–Voigt twice, the second time without the samples
    /// on the surface.
    fn fit(&self, family: Family, starts: impl IntoIterator<Item = Vec<f64>>) -> Option<Candidate> {
        let scales = &self.course.scales;
        let stay = self.fixed.of(family, scales);
        let problem = Problem {
            family,
            nodes: &self.course.nodes,
            weights: self.weights,
            scales: &self.course.scales,
            fixed: &stay,
        };
        let mut starts: Vec<Vec<f64>> = starts.into_iter().collect();
        let begin = self
            .fixed
            .held
            .initial(family, scales, self.fixed.reference_depth_m);
        if let Some(first) = starts.first().filter(|_| !begin.is_empty()) {
            let mut own = first.clone();
            begin.into_iter().for_each(|(at, value)| own[at] = value);
            starts.push(own);
        }
        let values = self.fixed.values(family, scales);
        for start in &mut starts {
            values.iter().for_each(|(at, value)| start[*at] = *value);
        }
        let starts = starts.into_par_iter();
        let fits = starts.map(|start| problem.fit(start, self.still));
        let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let mut candidate = Candidate {
            fit: best,
            weights: self.weights.to_vec(),
            score: 0.0,
        };
        if family == Family::KELVIN_VOIGT {
            mask_surface(&mut candidate.weights, self.course, &candidate.fit);
            let masked = Problem {
                weights: &candidate.weights,
                ..problem
            };
            candidate.fit = masked.fit(candidate.fit.free, self.still);
        }
        Some(candidate)
    }
}

/// The free numbers with a small mode in the widest gap between the rates.
fn one_mode_more(free: &[f64], family: Family) -> Vec<f64> {
    let mut rates: Vec<f64> = free[family.first_mode()..]
        .chunks(2)
        .map(|m| m[1])
        .collect();
    rates.sort_unstable_by(f64::total_cmp);
    // Half a decade beyond either end counts as a gap of its own.
    let slower = (1.2, rates[0] - 1.2);
    let gaps = rates
        .windows(2)
        .map(|pair| (0.5 * (pair[1] - pair[0]), 0.5 * (pair[0] + pair[1])));
    let widest = gaps.chain([slower]).max_by(|a, b| a.0.total_cmp(&b.0));
    let rate = widest.map_or(rates[0], |(_, rate)| rate);
    [free, &[SMALL_MODE.ln(), rate]].concat()
}

/// The scores, over the nodes that all candidates see.
fn scored(course: &Course, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    let mut common = match candidates.first() {
        Some(first) => first.weights.clone(),
        None => return candidates,
    };
    for candidate in &candidates {
        for (weight, other) in common.iter_mut().zip(&candidate.weights) {
            *weight = weight.min(*other);
        }
    }
    let residuals = |candidate: &Candidate| {
        let problem = Problem {
            family: candidate.fit.family,
            nodes: &course.nodes,
            weights: &common,
            scales: &course.scales,
            fixed: &[],
        };
        problem.residuals(&candidate.fit.free)
    };
    let all: Vec<Vec<f64>> = candidates.iter().map(residuals).collect();
    let chi_2: Vec<f64> = all.iter().map(|r| r.iter().map(|r| r * r).sum()).collect();
    let best = (0..chi_2.len()).min_by(|a, b| chi_2[*a].total_cmp(&chi_2[*b]));
    let Some(best) = best else { return candidates };
    let count = all[best].len() as f64;
    // Twice as many independent residuals as parameters at least.
    let independent =
        (count / correlation(&all[best])).max(2.0 * candidates[best].fit.free.len() as f64);
    for (candidate, chi_2) in candidates.iter_mut().zip(&chi_2) {
        let parameters = candidate.fit.free.len() as f64;
        candidate.score = independent * (chi_2 / count).ln() + parameters * independent.ln();
    }
    let least = candidates
        .iter()
        .map(|c| c.score)
        .fold(f64::INFINITY, f64::min);
    for candidate in &mut candidates {
        candidate.score -= least;
    }
    candidates
}
