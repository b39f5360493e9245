//! The sets of effects that fits add to the base model.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::fit::Fit;

/// The effects that a fit adds to the base model, in the order of the catalogue.
pub(crate) fn added_effects(fit: &Fit) -> Vec<EffectId> {
    let added = fit.added().into_iter();
    let mut ids: Vec<EffectId> = added.map(|at| fit.shape.terms[at].id).collect();
    ids.sort();
    ids
}

/// Whether a fit has an effect more than once.
pub(crate) fn is_repeated(id: EffectId, fit: &Fit) -> bool {
    fit.shape.terms.iter().filter(|term| term.id == id).count() > 1
}

/// Whether a fit has its last effect more than once.
pub(crate) fn is_last_repeated(fit: &Fit) -> bool {
    let last = fit.shape.terms.last();
    last.is_some_and(|term| is_repeated(term.id, fit))
}

/// Keeps the first item with each set of effects.
pub(crate) fn keep_first<T>(list: &mut Vec<T>, ids: impl Fn(&T) -> Vec<EffectId>) {
    let mut seen: Vec<Vec<EffectId>> = Vec::new();
    list.retain(|item| {
        let ids = ids(item);
        let is_new = !seen.contains(&ids);
        seen.push(ids);
        is_new
    });
}

/// Keeps the first `most` items, and of the others those that are to stay.
pub(crate) fn truncate<T>(list: &mut Vec<T>, most: usize, stays: impl Fn(&T) -> bool) {
    let mut rank = 0;
    list.retain(|item| {
        rank += 1;
        rank <= most || stays(item)
    });
}
