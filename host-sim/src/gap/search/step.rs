//! Whether what was taken for a drift of the zero is one step of it.
//!
//! A cable that is pulled, a tare in mid-log and a friction that is not yet wound up when a log begins leave the force off
//! from an instant on. A ramp takes three quarters of such a step off and stands out of all that the catalogue has, although
//! nothing drifts.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::{dataset::Dataset, fit::Fit, start::whole};
use crate::gap::search::run::Search;

impl Search<'_> {
    /// The fit with an offset in the place of a drift that is a step, if most of what it took off stays off: a step
    /// early in the log. A cylinder's friction that began to act when it moved, 10 N off after the first of 20 s, was a
    /// drift of 0.7 N/s.
    pub(super) fn with_offset_for_step(&self, best: Fit) -> Fit {
        let Some(at) = drift_of(&best) else {
            return best;
        };
        if !is_rather_a_step(&self.dataset, &self.weights, &best) {
            return best;
        }
        let mut terms = best.shape.terms_at(&best.numbers);
        let [rate, time_constant, ..] = terms[at].row;
        let force_n = rate * time_constant.clamp(0.0, self.dataset.scales.duration_s);
        terms[at] = whole(EffectId::ForceOffset, [force_n, 0.0, 0.0, 0.0, 0.0], 1);
        let (shape, start) = best.with_terms(terms, self.dataset.scales);
        let offset = self.problem().fit(&shape, start);
        let without = self.without(&best, at);
        match 2.0 * offset.cost < best.cost + without.cost {
            true => offset,
            false => best,
        }
    }
}

/// The place of the added drift of a fit.
fn drift_of(best: &Fit) -> Option<usize> {
    let is_drift = |at: &usize| best.shape.terms[*at].id == EffectId::ForceDrift;
    best.added().into_iter().find(is_drift)
}

/// Whether the drift of a fit, if it has one, leaves more than a step in its place would.
pub(super) fn is_rather_a_step(dataset: &Dataset<'_>, weights: &[f64], best: &Fit) -> bool {
    let Some(at) = drift_of(best) else {
        return false;
    };
    let problem = dataset.problem(weights);
    let residuals = problem.residuals(&best.shape, &best.numbers);
    let with = problem.forces_of(&best.shape.rig(&best.numbers));
    let (shape, numbers) = best.without(at, dataset.scales);
    let without = problem.forces_of(&shape.rig(&numbers));
    let wanders: Vec<f64> = (residuals.iter().zip(&with).zip(&without))
        .map(|((residual, with), without)| residual + with - without)
        .collect();
    let mut from = 0;
    let (mut drift, mut step) = (0.0, 0.0);
    for log in dataset.logs {
        let own = from..from + log.len();
        drift += spread(&residuals[own.clone()], &weights[own.clone()]);
        step += spread_beside_a_step(&wanders[own.clone()], &weights[own]);
        from += log.len();
    }
    let most = dataset.thresholds.evidence.rather_a_step;
    step < most * drift
}

/// Σ w (r − r̄)².
fn spread(residuals: &[f64], weights: &[f64]) -> f64 {
    Sums::of(residuals, weights).spread()
}

/// The same with means of their own before and after the instant at which that leaves least.
fn spread_beside_a_step(residuals: &[f64], weights: &[f64]) -> f64 {
    let all = Sums::of(residuals, weights);
    let mut before = Sums::default();
    let each = residuals.iter().zip(weights);
    each.map(|(residual, weight)| {
        before.add(*residual, *weight);
        before.spread() + all.less(&before).spread()
    })
    .fold(f64::INFINITY, f64::min)
}

/// Σ w, Σ w r and Σ w r².
#[derive(Clone, Copy, Debug, Default)]
struct Sums([f64; 3]);

impl Sums {
    fn of(residuals: &[f64], weights: &[f64]) -> Sums {
        let mut sums = Sums::default();
        let each = residuals.iter().zip(weights);
        each.for_each(|(residual, weight)| sums.add(*residual, *weight));
        sums
    }

    fn add(&mut self, residual: f64, weight: f64) {
        let terms = [weight, weight * residual, weight * residual * residual];
        self.0
            .iter_mut()
            .zip(terms)
            .for_each(|(sum, term)| *sum += term);
    }

    fn less(&self, other: &Sums) -> Sums {
        let [a, b] = [self.0, other.0];
        Sums(std::array::from_fn(|at| a[at] - b[at]))
    }

    fn spread(&self) -> f64 {
        let [weight, sum, squares] = self.0;
        if weight > 0.0 {
            squares - sum * sum / weight
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_leaves_nothing_beside_a_step_and_a_ramp_a_quarter() {
        let weights = vec![2.0; 1000];
        let step: Vec<f64> = (0..1000).map(|at| f64::from(u8::from(at >= 300))).collect();
        assert!(spread_beside_a_step(&step, &weights) < 1e-9);
        // ∫(x − ½)² dx = 1/12, and two halves of a quarter of that.
        let ramp: Vec<f64> = (0..1000).map(|at| f64::from(at) * 1e-3).collect();
        let share = spread_beside_a_step(&ramp, &weights) / spread(&ramp, &weights);
        assert!((share - 0.25).abs() < 0.01, "{share}");
        // Samples without weight say nothing.
        let first: Vec<f64> = (0..1000).map(|at| f64::from(u8::from(at < 500))).collect();
        assert_eq!(
            spread_beside_a_step(&step, &first),
            spread_beside_a_step(&step[..500], &first[..500])
        );
    }
}
