//! The effects of the base model.

use crate::diagnostic::Diagnostic;
use crate::gap::model::shape::Term;
use crate::model::Model;

/// The effects that the base model has already: in the fit from the start, and to stay.
pub(in crate::gap) fn given(model: &Model) -> Result<Vec<Term>, Diagnostic> {
    let term = |own: &crate::model::Effect| -> Result<Term, Diagnostic> {
        let effect = own.core()?;
        let id = effect.id();
        let (row, infos) = (effect.row(), id.info().parameters);
        let free = |at: usize| {
            // A number that is 0 because the model does not give it is a form, not a start.
            infos.get(at).is_some_and(|info| {
                let form = info.default.is_some() && row[at] == 0.0;
                let fixed = own.fit.fixed.iter().any(|name| name == info.name);
                !(form || fixed)
            })
        };
        Ok(Term {
            id,
            row,
            free: std::array::from_fn(free),
            given: true,
        })
    };
    model.effects.iter().map(term).collect()
}
