//! Whether the names of a decision stand.

use estimator_core::effect::EffectId;

use super::decide::Decision;
use super::fit::Fit;
use super::result::Tried;
use super::rivals::{apart, related};
use super::search::added;
use super::shape::Owner;

/// Share of the base's excess that names must explain together to stand where something is left.
const CERTAIN: f64 = 0.95;
/// Or they stand if they leave at most this share of the excess, and any other set as large at least
/// so many times as much: 3.1 for the nearest effect to a crackling that is in no catalogue, 4.7 for a
/// soft limit.
const AHEAD_LEFT: f64 = 0.25;
const AHEAD: f64 = 4.0;
/// Of what is left, the share that an effect must take off at least where much is left.
const IDLE: f64 = 0.01;
/// Standard errors that the size of an effect must be, to be one.
const KNOWN: f64 = 3.0;

/// The fit without an effect that takes nothing off.
pub(super) fn idle(decision: &Decision) -> Option<&Fit> {
    let count = decision.variances.iter().filter(|v| **v > 0.0).count() as f64;
    let cost = decision.best.cost;
    let most = cost + apart(&decision.best, count, decision.correlation).min(IDLE * cost);
    let least = decision.without.iter();
    least
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .filter(|fit| fit.cost < most)
}

/// An effect whose size may as well be 0, if nothing else could stand in its place: of 810 names that were
/// right one was that badly known, of 36 wrong ones ten.
pub(super) fn unsized_effect(decision: &Decision) -> Option<usize> {
    let Decision {
        best, std_errors, ..
    } = decision;
    let is_known = |number: usize| {
        let owner = Owner::Effect(number, 0);
        let at = best.shape.free.iter().position(|own| own.owner == owner);
        at.and_then(|at| Some((best.shape.natural(at, best.numbers[at]), std_errors[at]?)))
            .is_none_or(|(size, error)| size.abs() >= KNOWN * error)
    };
    // Modes of one spectrum share theirs, and no name hangs on one of them.
    let is_one = |number: usize| {
        let id = best.shape.terms[number].id;
        best.shape.terms.iter().filter(|own| own.id == id).count() == 1
    };
    let mut each = best.added().into_iter().zip(&decision.alternatives);
    each.position(|(number, others)| others.is_empty() && is_one(number) && !is_known(number))
}

/// Whether names stand though something is left.
pub(super) fn stand(decision: &Decision, tried: &[Tried]) -> bool {
    let excess = |ratio: f64| (ratio * ratio - 1.0).max(0.0);
    let explained = 1.0 - excess(decision.ratio.1) / excess(decision.ratio.0).max(1e-12);
    explained >= CERTAIN || is_ahead(&added(&decision.best), tried)
}

/// Whether a set of effects that leaves something explains most of the excess, and every other set as
/// large leaves several times as much: the form of one of them is another than the catalogue's.
fn is_ahead(ids: &[EffectId], tried: &[Tried]) -> bool {
    let excess = |own: &Tried| (own.ratio * own.ratio - 1.0).max(0.0);
    let of = |ids: &[EffectId]| tried.iter().find(|own| own.ids == ids).map(excess);
    let (Some(base), Some(left)) = (of(&[]), of(ids)) else {
        return false;
    };
    let others = tried
        .iter()
        .filter(|own| own.ids.len() == ids.len() && own.ids != ids)
        .filter(|own| !own.ids.iter().zip(ids).all(|(a, b)| related(*a, *b)));
    let next = others.map(excess).fold(base, f64::min);
    left <= AHEAD_LEFT * base && next >= AHEAD * left
}
