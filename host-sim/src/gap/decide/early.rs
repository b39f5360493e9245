//! Whether a force that is earlier than the position is a delay, or a damper.
//!
//! A force that is early by T looks like one with a damper of T times the stiffness: what a law without a damper lacks, or a
//! mount that damps, comes out as a delay of −T. A delay acts on all of the force, in free air as well, and in the second order;
//! a damper acts in contact only. Where dampers of a few forms do nearly as well in its place the log does not tell.

use estimator_core::physics::effect::EffectId;

use super::decision::Decision;
use crate::gap::model::{
    dataset::Dataset, fit::Fit, problem::Problem, simulate::depths, weights::weights,
};
use crate::lsq::basis::{add_column, dot, project_out};

/// Forms of a damper: c·δ^q·v, from a plain one to one of the next higher order than Hertz's.
const FORMS: [f64; 5] = [0.0, 0.5, 1.0, 1.5, 2.0];

/// The decision, in which a delay that may be a damper is open.
pub(super) fn open_where_early(dataset: &Dataset<'_>, mut decision: Decision) -> Decision {
    let best = &decision.best;
    let terms = best.shape.terms_at(&best.numbers);
    let is_early = |number: &usize| {
        let term = &terms[*number];
        term.id == EffectId::TimeDelay && term.row[0] < 0.0
    };
    let Some(at) = best.added().iter().position(is_early) else {
        return decision;
    };
    if best.shape.base.is_free() || !is_as_well_a_damper(dataset, &decision, best.added()[at]) {
        return decision;
    }
    decision.may_be_a_damper = true;
    decision.open_with_evidence(at, EffectId::DepthDependentDamping);
    decision
}

/// Whether dampers in the place of a delay leave less than what a rival must leave.
fn is_as_well_a_damper(dataset: &Dataset<'_>, decision: &Decision, delay: usize) -> bool {
    let weights = weights(&decision.variances);
    let problem = dataset.problem(&weights);
    let (shape, numbers) = decision.best.without(delay, dataset.scales);
    let cost = problem.cost(&shape, &numbers);
    let without = Fit {
        shape,
        numbers,
        cost,
    };
    let lead = decision.thresholds.evidence.lead;
    with_dampers(dataset, &problem, &without) < lead * decision.best.cost
}

/// Σ w r² of a fit with dampers beside it, all refitted to first order.
fn with_dampers(dataset: &Dataset<'_>, problem: &Problem<'_>, fit: &Fit) -> f64 {
    let linear = problem.linearize(&fit.shape, &fit.numbers);
    let roots: Vec<f64> = problem.weights.iter().map(|w| w.sqrt()).collect();
    let weighted = |channel: &[f64]| -> Vec<f64> {
        let each = channel.iter().zip(&roots);
        each.map(|(value, root)| value * root).collect()
    };
    let mut basis = Vec::new();
    for column in &linear.columns {
        add_column(&mut basis, weighted(column), &[]);
    }
    let depths: Vec<f64> = depths(&fit.shape, &fit.numbers, dataset.logs).concat();
    let speeds = dataset.logs.iter().flat_map(|log| &log.speed_mps);
    let speeds: Vec<f64> = speeds.copied().collect();
    let scale_m = dataset.scales.deepest_m.abs().max(f64::MIN_POSITIVE);
    for form in FORMS {
        let each = depths.iter().zip(&speeds);
        let damper = each.map(|(depth, speed)| match *depth > 0.0 {
            true => libm::pow(depth / scale_m, form) * speed,
            false => 0.0,
        });
        let mut damper: Vec<f64> = damper.collect();
        problem.without_steps(&mut damper);
        add_column(&mut basis, weighted(&damper), &[]);
    }
    let mut left = weighted(&linear.residuals);
    project_out(&mut left, &basis);
    dot(&left, &left)
}
