//! The effects that the base model has.

use crate::diagnostic::Diagnostic;
use crate::gap::model::shape::Term;
use crate::model::{Effect, Model};

/// The effects of the base model as terms: they are in every fit.
///
/// # Errors
/// An effect that the catalogue does not have, or with parameters that it cannot have.
pub(crate) fn given(model: &Model) -> Result<Vec<Term>, Diagnostic> {
    model.effects.iter().map(term).collect()
}

fn term(effect: &Effect) -> Result<Term, Diagnostic> {
    let core = effect.core()?;
    let (id, row) = (core.id(), core.row());
    let infos = id.info().parameters;
    let is_free = |at: usize| {
        infos.get(at).is_some_and(|info| {
            // An optional parameter that is 0 since the model does not give it is not part of the form.
            let is_absent = info.default.is_some() && row[at] == 0.0;
            let is_fixed = effect.fit.fixed.iter().any(|name| name == info.name);
            !(is_absent || is_fixed)
        })
    };
    Ok(Term {
        id,
        row,
        free: std::array::from_fn(is_free),
        given: true,
    })
}
