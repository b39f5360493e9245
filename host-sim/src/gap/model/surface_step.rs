//! Steps of the surface: from a touch on it is nearer or farther by one amount, as where a sample has slipped between two.
//!
//! Nothing is seen of it in free air, so that its instant is known to the stretch between two touches. A permanent set, which
//! recedes within its first touch, takes off less. One touch that differs from those before and after it is no slip: on either
//! side of each step there are two at least.

use crate::gap::model::fit::Fit;
use crate::gap::model::problem::Problem;
use crate::gap::model::shape::Owner;
use crate::gap::model::zero_step::{Left, Needed};
use crate::lsq::basis::{dot, project_out};

/// The surface acts where it makes more than this share of the most that it does. Derived: a relaxation that decays out of
/// contact is below it.
const ACTS: f64 = 1e-3;

/// Fewest touches on either side of a step. Of a rig whose every touch differed by a force that ran away, steps of ±0.7 mm
/// around one touch took most off.
const TOUCHES: usize = 2;
/// The stretches between touches that are looked at, those first that alone take most off.
const MOST: usize = 24;

/// A step of the surface beside a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceStep {
    /// A sample of the log between the touches before and after it.
    pub(crate) at: usize,
    /// By what the surface is nearer (negative) or farther (m) from there on.
    pub(crate) by_m: f64,
    /// The share of Σ w r² that it takes off.
    pub(crate) share: f64,
}

impl SurfaceStep {
    /// The steps of the surface of the first log, in the order of time, with the numbers of the fit refitted to first order;
    /// none where the model holds its surface.
    pub(crate) fn all(problem: &Problem<'_>, fit: &Fit) -> Vec<SurfaceStep> {
        let beside = beside(problem, fit);
        beside.map_or(Vec::new(), |(left, by_surface)| steps(&left, &by_surface))
    }
}

/// Instants (s) of the steps of the surface that are known of the first log, and by what each is still off (m), with the
/// numbers of the fit refitted to first order.
pub(crate) fn off_by(problem: &Problem<'_>, fit: &Fit) -> Vec<(f64, f64)> {
    let known = problem
        .logs
        .first()
        .filter(|log| !log.surface_steps.is_empty());
    let Some((log, (left, by_surface))) = known.zip(beside(problem, fit)) else {
        return Vec::new();
    };
    let at = |own: &(f64, f64)| log.time_s.partition_point(|stamp| *stamp < own.0);
    let each = log.surface_steps.iter();
    let columns = each.map(|own| after(&by_surface, at(own), left.white.len()));
    let amounts = left.amounts(columns.collect()).into_iter().flatten();
    let each = log.surface_steps.iter().zip(amounts);
    each.map(|((s, _), by_m)| (*s, by_m)).collect()
}

/// What a fit leaves, and what a metre of the surface makes of √w·force in each row of the first log; `None` where the model
/// holds its surface.
fn beside(problem: &Problem<'_>, fit: &Fit) -> Option<(Left, Vec<f64>)> {
    let (surface, log) = (surface(fit)?, problem.logs.first()?);
    let linear = problem.linearize(&fit.shape, &fit.numbers);
    let left = Left::of_linear(problem, fit, &linear);
    let each = linear.columns[surface][..log.len()].iter();
    let by_surface = each.zip(&left.roots).map(|(slope, root)| slope * root);
    let by_surface = by_surface.collect();
    Some((left, by_surface))
}

/// What a metre of the surface makes from a row on, in so many rows of all logs.
fn after(by_surface: &[f64], at: usize, len: usize) -> Vec<f64> {
    let mut column = vec![0.0; len];
    column[at..by_surface.len()].copy_from_slice(&by_surface[at..]);
    column
}

/// The number of a fit that is its surface.
fn surface(fit: &Fit) -> Option<usize> {
    let parameters = fit.shape.base.parameters();
    let own = parameters.iter().position(|own| own.name == "surface")?;
    let mut free = fit.shape.free.iter();
    free.position(|free| free.owner == Owner::Environment(own))
}

/// The steps of what is left, where a metre of the surface makes so much of √w·force in each row of the first log.
fn steps(left: &Left, by_surface: &[f64]) -> Vec<SurfaceStep> {
    let between = between_touches(by_surface);
    let column = |at: usize| after(by_surface, at, left.white.len());
    // The number of touches before each stretch, and one more in the last.
    let inner = TOUCHES..(between.len() + 2).saturating_sub(TOUCHES);
    let gain = |touches: &usize| {
        let mut own = column(between[touches - 1]);
        project_out(&mut own, &left.basis);
        dot(&own, &left.white).powi(2) / dot(&own, &own).max(f64::MIN_POSITIVE)
    };
    let mut open: Vec<(f64, usize)> = inner.map(|touches| (gain(&touches), touches)).collect();
    open.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut open: Vec<usize> = open.into_iter().take(MOST).map(|own| own.1).collect();
    open.sort_unstable();
    let columns = open.iter().map(|touches| column(between[touches - 1]));
    let needed = left.needed(columns.collect());
    let mut pairs = needed.windows(2);
    if pairs.any(|pair| open[pair[1].at] - open[pair[0].at] < TOUCHES) {
        return Vec::new();
    }
    let step = |own: &Needed| SurfaceStep {
        at: between[open[own.at] - 1],
        by_m: own.amount,
        share: own.share,
    };
    needed.iter().map(step).collect()
}

/// The middle of each stretch between two touches.
fn between_touches(by_surface: &[f64]) -> Vec<usize> {
    let most = by_surface
        .iter()
        .fold(0.0_f64, |most, own| most.max(own.abs()));
    let acts: Vec<usize> = (0..by_surface.len())
        .filter(|at| by_surface[*at].abs() > ACTS * most)
        .collect();
    // A sample without a weight at touch is no stretch.
    let apart = acts.windows(2).filter(|pair| pair[1] - pair[0] > 8);
    apart.map(|pair| pair[0].midpoint(pair[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lsq::basis::add_column;

    #[test]
    fn a_surface_that_steps_twice_is_found_between_its_touches() {
        // GIVEN ten touches of 100 samples, 100 apart, deeper and deeper, and numbers for surface and stiffness
        let depth = |at: usize| {
            let touch = (at % 200) as f64 / 100.0;
            let deepest = 1.0 + (at / 200) as f64;
            (touch < 1.0).then(|| deepest * (std::f64::consts::PI * touch).sin())
        };
        let slope: Vec<f64> = (0..2000)
            .map(|at| depth(at).map_or(0.0, |own| -1.5 * own.max(0.0).sqrt()))
            .collect();
        let force = (0..2000).map(|at| depth(at).map_or(0.0, |own| own.max(0.0).powf(1.5)));
        let mut basis = Vec::new();
        add_column(&mut basis, slope.clone(), &[]);
        add_column(&mut basis, force.collect(), &[]);
        let off = |at: usize| {
            [(500, 0.1), (1300, -0.06)]
                .iter()
                .filter(|own| at >= own.0)
                .map(|own| own.1)
                .sum::<f64>()
        };
        let mut white: Vec<f64> = (0..2000)
            .map(|at| off(at) * slope[at] + 1e-3 * (0.7 * at as f64).sin())
            .collect();
        project_out(&mut white, &basis);
        let left = Left {
            roots: vec![1.0; 2000],
            white,
            basis,
        };
        let found = steps(&left, &slope);
        let said: Vec<(usize, f64)> = found
            .iter()
            .map(|own| (own.at / 100, (1e3 * own.by_m).round()))
            .collect();
        // THEN each is found in the air between the third and fourth, and the seventh and eighth touch.
        assert_eq!(said, [(5, 100.0), (13, -60.0)], "{found:?}");
        assert!(
            found.iter().map(|own| own.share).sum::<f64>() > 0.99,
            "{found:?}"
        );
    }
}
