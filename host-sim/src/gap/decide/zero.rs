//! Whether a zero that is off stands still, or drifts.
//!
//! One is not a rival of the other in a search, since a drift that comes to rest becomes an offset. In a log that rests
//! nearly all of its time what is left of either may be the same: a base takes the rest on as a relaxation. A drift through
//! the 1600 s of a foam's record was an offset of 0.1 N, strong, and left as little.

use estimator_core::physics::effect::EffectId;

use super::acceptance::refitted_with;
use super::decision::Decision;
use super::rivals::margin;
use crate::gap::model::{dataset::Dataset, shape::Term, start::of_size};

/// The decision, in which an offset and a drift that leave as little stand for each other.
pub(super) fn open_where_zero_drifts(dataset: &Dataset<'_>, mut decision: Decision) -> Decision {
    let added = decision.best.added().into_iter().enumerate();
    let open: Vec<(usize, EffectId)> = added
        .filter_map(|(at, number)| Some((at, as_well(dataset, &decision, number)?)))
        .collect();
    for (at, other) in open {
        decision.open_with_evidence(at, other);
    }
    decision
}

/// The drift that leaves as little as an offset, or the offset that does as a drift.
fn as_well(dataset: &Dataset<'_>, decision: &Decision, number: usize) -> Option<EffectId> {
    let best = &decision.best;
    let mut terms = best.shape.terms_at(&best.numbers);
    let other = other(&terms[number], dataset.scales.duration_s)?;
    let id = other.id;
    terms[number] = other;
    let margin = margin(dataset, best, decision.samples(), decision.correlation);
    (refitted_with(dataset, decision, terms).cost < best.cost + margin).then_some(id)
}

/// The drift of an offset through a log of so many seconds, and the offset of a drift that does not come to rest.
fn other(term: &Term, duration_s: f64) -> Option<Term> {
    let size = term.row[0];
    let (id, size) = match term.id {
        EffectId::ForceOffset => (EffectId::ForceDrift, 2.0 * size / duration_s),
        EffectId::ForceDrift if !term.free[1] => (EffectId::ForceOffset, 0.5 * size * duration_s),
        _ => return None,
    };
    Some(of_size(id, size))
}
