//! The sets of effects that fits add to the base model.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::fit::Fit;
use crate::gap::search::relatives::related;

/// The effects that a fit adds to the base model, in the order of the catalogue.
pub(crate) fn added_effects(fit: &Fit) -> Vec<EffectId> {
    let mut ids = fit.added_ids();
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

/// Keeps the first item with each key, as a set of effects or a sentence.
pub(crate) fn keep_first<T, K: PartialEq>(list: &mut Vec<T>, key: impl Fn(&T) -> K) {
    let mut seen: Vec<K> = Vec::new();
    list.retain(|item| {
        let key = key(item);
        let is_new = !seen.contains(&key);
        seen.push(key);
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

/// The first relative in the catalogue of each effect that a fit adds: sets that differ by a special case only
/// are one.
fn kinds(fit: &Fit) -> Vec<EffectId> {
    let first = |id: &EffectId| EffectId::ALL.iter().find(|other| related(**other, *id));
    let added = added_effects(fit);
    let mut kinds: Vec<EffectId> = added.iter().filter_map(first).copied().collect();
    kinds.sort();
    kinds
}

/// Keeps the first `most` kinds of sets with the relatives of each, and of the others those that are to stay.
pub(crate) fn keep_kinds(fits: &mut Vec<Fit>, most: usize, stays: impl Fn(&Fit) -> bool) {
    let mut seen: Vec<Vec<EffectId>> = Vec::new();
    fits.retain(|fit| {
        let kinds = kinds(fit);
        if !seen.contains(&kinds) {
            seen.push(kinds);
        }
        seen.len() <= most || stays(fit)
    });
}

/// Keeps one fit of each kind of set, the simplest of those that leave hardly more than the best of the kind, in
/// its place.
pub(crate) fn keep_simplest_of_each_kind(fits: &mut Vec<Fit>) {
    const HARDLY_MORE: f64 = 1.03;
    let all = std::mem::take(fits);
    for fit in all {
        let alike = fits.iter_mut().find(|kept| kinds(kept) == kinds(&fit));
        match alike {
            None => fits.push(fit),
            Some(kept) => {
                let is_simpler = fit.numbers.len() < kept.numbers.len();
                if is_simpler && fit.cost < HARDLY_MORE * kept.cost {
                    *kept = fit;
                }
            }
        }
    }
}
