//! Steps of the surface: from a touch on it is nearer or farther by one amount, as where a sample has slipped between two.
//!
//! Nothing is seen of it in free air, so that its instant is known to the stretch between two touches. A permanent set, which
//! recedes within its first touch, takes off less.

use crate::gap::model::fit::Fit;
use crate::gap::model::problem::Problem;
use crate::gap::model::shape::Owner;
use crate::gap::model::zero_step::{LEAST_OWN, LEAST_SHARE, Left, MOST_STEPS};
use crate::lsq::basis::{dot, project_out};

/// The surface acts where it makes more than this share of the most that it does. Derived: a relaxation that decays out of
/// contact is below it.
const ACTS: f64 = 1e-3;

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
        let (Some(surface), Some(log)) = (surface(fit), problem.logs.first()) else {
            return Vec::new();
        };
        let linear = problem.linearize(&fit.shape, &fit.numbers);
        let left = Left::of_linear(problem, fit, &linear);
        let each = linear.columns[surface][..log.len()].iter();
        let by_surface: Vec<f64> = each
            .zip(&left.roots)
            .map(|(slope, root)| slope * root)
            .collect();
        steps(&left, &by_surface)
    }
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
    let without = dot(&left.white, &left.white);
    let between = between_touches(by_surface);
    let column = |at: usize| {
        let mut column = vec![0.0; left.white.len()];
        column[at..by_surface.len()].copy_from_slice(&by_surface[at..]);
        column
    };
    let mut steps: Vec<SurfaceStep> = Vec::new();
    let mut beside = left.clone();
    while steps.len() < MOST_STEPS {
        let now = dot(&beside.white, &beside.white);
        let gain = |at: &usize| {
            let mut own = column(*at);
            let whole = dot(&own, &own);
            project_out(&mut own, &beside.basis);
            let square = dot(&own, &own);
            let gain = dot(&own, &beside.white).powi(2) / square;
            (square > LEAST_OWN * whole).then_some((*at, gain))
        };
        let most = between
            .iter()
            .filter_map(gain)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((at, gain)) = most.filter(|(_, gain)| *gain > LEAST_SHARE * now) else {
            break;
        };
        beside.know(column(at));
        let share = gain / without;
        steps.push(SurfaceStep {
            at,
            by_m: 0.0,
            share,
        });
    }
    steps.sort_by_key(|own| own.at);
    let amounts = left.amounts(steps.iter().map(|own| column(own.at)).collect());
    let each = steps.iter_mut().zip(amounts.into_iter().flatten());
    each.for_each(|(step, by_m)| step.by_m = by_m);
    steps
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
