//! Which low-pass a force went through before it was logged: the one behind which the laws leave least.
//!
//! The noise at rest says that there is one, and roughly where its corner is ([`crate::estimate::low_passed`]); whether it
//! has a delay only the contact says. Every kind is tried with the simpler laws, and its corner walks to where what is left
//! has nothing of it any more: the residuals are regressed on what the force does by the logarithm of the corner, after
//! everything that the parameters can do is taken off.

use std::cmp::Ordering;

use estimator_core::estimate::Estimated;
use rayon::prelude::*;

use super::blocks::Use;
use super::course::Course;
use super::family::Family;
use super::fit::{Fit, Problem, STILL};
use super::low_pass::{Kind, LowPass};
use super::regression::Regression;
use super::result::FoundLowPass;
use super::scales::Scales;
use super::select::{Candidate, Fixed, roughly_fitted};
use crate::stats::lowest;

/// What is tried.
const KINDS: [Kind; 10] = [
    Kind::butterworth(1, false),
    Kind::butterworth(2, false),
    Kind::butterworth(3, false),
    Kind::butterworth(4, false),
    Kind::bessel(4, false),
    Kind::butterworth(1, true),
    Kind::butterworth(2, true),
    Kind::butterworth(3, true),
    Kind::butterworth(4, true),
    Kind::bessel(2, true),
];
/// Most modes of a law that a kind is chosen with.
const FEW_MODES: usize = 2;
/// So many block means tell the kind; 5000 take a second.
const MOST_NODES: usize = 20_000;
/// What is left is noise up to so many times that at rest.
const NEARLY_NOISE: f64 = 1.5;
/// Where the first corner leaves more than this share of what is left without a low-pass, another one is not looked for: a
/// walk from it reaches three times as far.
const HOPELESS: f64 = 0.8;
/// So many laws, those that leave least behind the first corner, tell where it is.
const LAWS: usize = 2;
/// Most steps of a corner, and the longest, of its logarithm.
const MOST_STEPS: usize = 16;
const LONGEST_STEP: f64 = 0.5;
/// A step of less than this share of its standard error is the last.
const SETTLED: f64 = 0.1;
/// Two corners are the same within this share of their error.
const SAME: f64 = 0.5;
/// For the slope by the logarithm of the corner.
const NEARBY: f64 = 1e-3;
/// A corner beyond this many times what the noise shows, or below its inverse, is something else.
const FARTHEST: f64 = 3.0;

/// A low-pass, with the standard error of the logarithm of its corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filtered {
    pub(super) low_pass: LowPass,
    pub(super) ln_error: f64,
}

impl Filtered {
    /// Whether two corners are the same, to a part of their errors.
    pub(super) fn is_at(&self, other: &Filtered) -> bool {
        let way = (self.low_pass.corner_hz / other.low_pass.corner_hz).ln();
        way.abs() <= SAME * self.ln_error
    }

    /// For a reader.
    pub(super) fn told(&self) -> FoundLowPass {
        let LowPass { corner_hz, kind } = self.low_pass;
        FoundLowPass {
            corner_hz: Estimated {
                value: corner_hz,
                std_error: self.ln_error * corner_hz,
            },
            shape: kind.shape.name(),
            order: kind.order,
            both_ways: kind.both_ways,
            delay_s: self.low_pass.delay_s(),
        }
    }

    /// Sizes with the corner one standard error higher.
    pub(super) fn moved(&self, scales: &Scales) -> Scales {
        scales.behind(self.low_pass.moved(self.ln_error.exp()))
    }
}

/// The low-pass of each kind behind which the laws leave least, that one first which leaves least of all. Corners are looked
/// for from each of `corners_hz` on, until what is left is no more than noise, or not clearly less than without.
pub(super) fn filtered(
    course: &Course,
    families: &[Family],
    fixed: &Fixed,
    corners_hz: &[f64],
    (noise_n, without_n): (f64, f64),
) -> Vec<Filtered> {
    let course = &course.beginning(MOST_NODES);
    let simple = families.iter().filter(|own| own.modes <= FEW_MODES);
    let simple: Vec<Family> = simple.copied().collect();
    let families = if simple.is_empty() { families } else { &simple };
    let counted = course.nodes.iter().filter(|own| own.used != Use::Out);
    let counted = counted.count() as f64;
    let cost = |left_n: f64| (left_n / course.scales.noise_n).powi(2) * counted;
    let enough = cost(NEARLY_NOISE * noise_n);
    let hopeless = cost(HOPELESS * without_n);
    let mut best: [Option<(Filtered, Fit)>; KINDS.len()] = Default::default();
    for corner_hz in corners_hz {
        best.par_iter_mut().zip(KINDS).for_each(|(best, kind)| {
            let begin = LowPass::of_power(*corner_hz, kind);
            let mut first = roughly_fitted(&course.behind(begin), families, fixed);
            first.sort_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost));
            let first = first.into_iter().take(LAWS);
            let tuned = first.filter_map(|one| tuned(course, begin, one, fixed));
            *best = tuned.chain(best.take()).min_by(least);
        });
        let least = best.iter().flatten().map(|(_, fit)| fit.cost);
        let least = lowest(least);
        if least < enough || least > hopeless {
            break;
        }
    }
    let mut found: Vec<(Filtered, Fit)> = best.into_iter().flatten().collect();
    found.sort_by(least);
    found.into_iter().map(|(own, _)| own).collect()
}

fn least(a: &(Filtered, Fit), b: &(Filtered, Fit)) -> Ordering {
    a.1.cost.total_cmp(&b.1.cost)
}

impl Course {
    /// The first of its block means.
    fn beginning(&self, most: usize) -> Course {
        let mut course = self.clone();
        course.nodes.truncate(most);
        course
    }
}

/// A corner walked to where the residuals of a law have nothing of it, from `begin` on; `None` where it does not come to
/// rest nearby.
pub(super) fn tuned(
    course: &Course,
    begin: LowPass,
    candidate: Candidate,
    fixed: &Fixed,
) -> Option<(Filtered, Fit)> {
    let stay = fixed.of(candidate.fit.family, &course.scales);
    let (mut low_pass, mut from, mut step) = (begin, candidate.fit, 0.0f64);
    let mut best: Option<(Filtered, Fit)> = None;
    for _ in 0..MOST_STEPS {
        let scales = course.scales.behind(low_pass);
        let problem = Problem {
            family: from.family,
            nodes: &course.nodes,
            weights: &candidate.weights,
            scales: &scales,
            fixed: &stay,
        };
        let fit = problem.fit(from.free, STILL);
        from = match best {
            Some((before, ref kept)) if kept.cost < fit.cost => {
                // Too far: half of the way.
                step *= 0.5;
                if step.abs() < SETTLED * before.ln_error {
                    return best;
                }
                low_pass = before.low_pass.moved(step.exp());
                kept.clone()
            }
            _ => {
                let found = by_corner(low_pass, &problem, &fit.free)?;
                let own = Filtered {
                    low_pass,
                    ln_error: found.std_error,
                };
                if found.slope.abs() < SETTLED * found.std_error {
                    return Some((own, fit));
                }
                best = Some((own, fit.clone()));
                step = found.slope.clamp(-LONGEST_STEP, LONGEST_STEP);
                low_pass = low_pass.moved(step.exp());
                fit
            }
        };
        let way = low_pass.corner_hz / begin.corner_hz;
        if !(FARTHEST.recip()..FARTHEST).contains(&way) {
            return None;
        }
    }
    None
}

/// The residuals on what the force of a fit does by the logarithm of the corner.
fn by_corner(low_pass: LowPass, problem: &Problem, free: &[f64]) -> Option<Regression> {
    let forces = |factor: f64| {
        let scales = problem.scales.behind(low_pass.moved(factor));
        let own = Problem {
            scales: &scales,
            ..*problem
        };
        own.forces(free)
    };
    let both = std::iter::zip(forces(NEARBY.exp()), forces((-NEARBY).exp()));
    let column: Vec<f64> = both
        .map(|(more, less)| (more - less) / (2.0 * NEARBY))
        .collect();
    let alike = vec![0.0; column.len()];
    problem.regression(free, &column, &alike)
}
