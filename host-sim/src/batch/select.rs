//! Which law: every candidate is fitted to the whole course, and the one with the smallest Bayesian
//! information criterion is taken.
//!
//! BIC = M·ln(χ²/N) + p·ln M. M is the number of *independent* residuals, N over the correlation
//! time that the best candidate leaves: with N itself the long holds of a measured record would buy a
//! mode for every wiggle. Modes of the quasi-linear law are chosen by the same score.
//!
//! **Weights.** A block mean of m samples has the variance σ²/m of the noise, and the variance s² of
//! what even the best candidate misses, which no mean removes: w = 1/(σ²/m + s²). Where a law fits,
//! s = 0 and every sample counts; where none fits, a block counts as one however long, and a hold
//! weighs by its logarithm: 15 s at 5 kHz do not drown the approach. s makes χ² = N at the best
//! candidate of a first round with s = 0, and the second round is the result.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::course::{Course, Node, Scales, Use};
use super::error::correlation;
use super::family::{Family, SURFACE, natural};
use super::fit::{Fit, Problem};
use super::start::{Given, scan};

/// A block on the surface within so many samples' travel may be on either side of it.
const STRADDLE: f64 = 1.0;

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
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fixed {
    /// Free number of the surface.
    pub(super) surface: Option<f64>,
    /// n
    pub(super) exponent: Option<f64>,
}

impl Fixed {
    /// The numbers that stay, of a family.
    pub(super) fn of(&self, family: Family) -> Vec<usize> {
        let surface = self.surface.map(|_| SURFACE);
        let exponent = self.exponent.and(family.exponent());
        surface.into_iter().chain(exponent).collect()
    }
}

/// Fits every family; best score first is not the order, the families' own is.
pub(super) fn candidates(course: &Course, families: &[Family], fixed: Fixed) -> Vec<Candidate> {
    let (nodes, scales) = (&course.nodes, &course.scales);
    let noise_only = weights(nodes, scales, 0.0);
    let given = Given {
        surface: fixed.surface,
        exponent: fixed.exponent,
    };
    let starts = scan(families, nodes, &noise_only, scales, given);
    let first = in_parallel(families, |family| {
        fit_from(course, family, &noise_only, fixed, starts.of(family))
    });
    let missed = missed_n2(course, &first);
    let second = if missed > 0.0 {
        let weights = weights(nodes, scales, missed);
        in_parallel(families, |family| {
            let own = first.iter().flatten().find(|c| c.fit.family == family);
            let own = own.map(|candidate| candidate.fit.free.clone());
            // The weights move the minimum: the starts of the scan are tried again as well.
            fit_from(course, family, &weights, fixed, own.into_iter().chain(starts.of(family)))
        })
    } else {
        first
    };
    scored(course, second.into_iter().flatten().collect())
}

/// w = 1/(σ²/m + s²) for what is used.
fn weights(nodes: &[Node], scales: &Scales, missed_n2: f64) -> Vec<f64> {
    let weight = |node: &Node| match node.used {
        Use::Out => 0.0,
        _ if node.count == 0.0 => 0.0,
        _ => 1.0 / (scales.noise_n.powi(2) / node.count + missed_n2),
    };
    nodes.iter().map(weight).collect()
}

/// Runs `work` for each family on all cores.
fn in_parallel<T: Send>(families: &[Family], work: impl Fn(Family) -> T + Sync) -> Vec<T> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..cores.min(families.len()) {
            scope.spawn(|| {
                loop {
                    // The last family has the most parameters and takes longest.
                    let taken = next.fetch_add(1, Ordering::Relaxed);
                    let Some(index) = families.len().checked_sub(taken + 1) else {
                        break;
                    };
                    let result = work(families[index]);
                    done.lock().expect("no fit panics").push((index, result));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("no fit panics");
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// The best minimum from several starts; Kelvin–Voigt twice, the second time without the samples on
/// the surface.
fn fit_from(
    course: &Course,
    family: Family,
    weights: &[f64],
    fixed: Fixed,
    starts: impl Iterator<Item = Vec<f64>>,
) -> Option<Candidate> {
    let stay = fixed.of(family);
    let problem = Problem {
        family,
        nodes: &course.nodes,
        weights,
        scales: &course.scales,
        fixed: &stay,
    };
    let fits = starts.map(|start| problem.fit(start));
    let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let mut candidate = Candidate {
        fit: best,
        weights: weights.to_vec(),
        score: 0.0,
    };
    if family == Family::KelvinVoigt {
        mask_surface(&mut candidate.weights, course, &candidate.fit);
        let masked = Problem {
            weights: &candidate.weights,
            ..problem
        };
        candidate.fit = masked.fit(candidate.fit.free);
    }
    Some(candidate)
}

/// At the surface the force of (1) jumps by λδ̇: on which side a sample is, its rounding decides.
fn mask_surface(weights: &mut [f64], course: &Course, fit: &Fit) {
    let scales = &course.scales;
    let surface_m = natural(fit.family, &fit.free, scales).surface_m;
    for (weight, node) in weights.iter_mut().zip(&course.nodes) {
        let travel_m = STRADDLE * node.speed_mps.abs() * scales.period_s;
        if (node.position_m - surface_m).abs() <= travel_m + 2.0 * scales.position_noise_m {
            *weight = 0.0;
        }
    }
}

/// s² (N²) with which the best candidate has χ² = N; 0 if the noise alone explains it.
fn missed_n2(course: &Course, candidates: &[Option<Candidate>]) -> f64 {
    let best = candidates.iter().flatten();
    let Some(best) = best.min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost)) else {
        return 0.0;
    };
    let noise_n2 = course.scales.noise_n.powi(2);
    let law = natural(best.fit.family, &best.fit.free, &course.scales);
    let mut squares = Vec::new();
    law.along(best.fit.family, &course.nodes, |node, force| {
        if node.used != Use::Out && node.count > 0.0 {
            squares.push(((node.force_n - force).powi(2), noise_n2 / node.count));
        }
    });
    let count = squares.len() as f64;
    let chi_2 = |missed: f64| {
        let terms = squares.iter().map(|(square, noise)| square / (noise + missed));
        terms.sum::<f64>() / count
    };
    // χ² of pure noise scatters by √(2/N).
    if chi_2(0.0) < 1.0 + 3.0 * (2.0 / count).sqrt() {
        return 0.0;
    }
    let (mut low, mut high) = (1e-6 * noise_n2, noise_n2);
    while chi_2(high) > 1.0 {
        high *= 4.0;
    }
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        if chi_2(middle) > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
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
    let independent = (count / correlation(&all[best])).max(2.0 * candidates[best].fit.free.len() as f64);
    for (candidate, chi_2) in candidates.iter_mut().zip(&chi_2) {
        let parameters = candidate.fit.free.len() as f64;
        candidate.score = independent * (chi_2 / count).ln() + parameters * independent.ln();
    }
    let least = candidates.iter().map(|c| c.score).fold(f64::INFINITY, f64::min);
    for candidate in &mut candidates {
        candidate.score -= least;
    }
    candidates
}

