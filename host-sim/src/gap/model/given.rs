//! The effects that the base model has.

use estimator_core::physics::effect::{EffectId, Form, Role};

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
    let is_fixed = |name: &str| effect.fit.fixed.iter().any(|fixed| fixed == name);
    // An optional parameter that is 0 since the model does not give it is not part of the form.
    let is_absent = |at: usize| infos[at].default.is_some() && row[at] == 0.0;
    let is_free = |at: usize| at < infos.len() && !is_absent(at) && !is_fixed(infos[at].name);
    // An identified model too: its own record may not have shown that a friction first bends, and a Stribeck friction, a
    // drag that is 59 % larger and a cable were what the next log of the same rig got instead.
    let is_open = |at: usize| {
        at < infos.len() && is_absent(at) && !is_fixed(infos[at].name) && is_form(id, at)
    };
    Ok(Term {
        id,
        row,
        free: std::array::from_fn(is_free),
        given: true,
        open: std::array::from_fn(is_open),
    })
}

/// Whether a number of an effect is that of an optional form, which comes by itself, and which a search would not have
/// dropped. A speed at which a friction reverses is no property of dry surfaces, and a force that is 1.3 ms late looks
/// like one of 9 mm/s.
fn is_form(id: EffectId, at: usize) -> bool {
    let role = id.info().fits.get(at).map(|fit| fit.role);
    matches!(role, Some(Role::Form(_, form)) if !matches!(form, Form::Beside(_) | Form::Dropped))
}
