//! Optional forms of effects: a number each that is free only where that is significant.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::data::scales::Scales;
use crate::gap::model::{fit::Fit, shape::Term};
use crate::gap::search::run::Search;

/// An optional number of an effect: the effect, and the place in its row.
type Form = (EffectId, usize);

/// The forms that an added effect may take on, and loses again where they are not significant.
const OPTIONAL: [Form; 4] = [
    (EffectId::SeriesCompliance, 1),
    (EffectId::Adhesion, 3),
    (EffectId::ExponentialStiffening, 1),
    (EffectId::BuriedLayer, 2),
];
/// The forms that starts have, and that an effect loses where they are not significant.
const INITIAL: [Form; 1] = [(EffectId::CoulombFriction, 2)];

/// The value from which the number of a form is fitted.
fn start(form: Form, s: &Scales) -> f64 {
    match form.0 {
        EffectId::SeriesCompliance => 0.5 * s.force_n,
        EffectId::BuriedLayer => 0.03 * s.travel_m,
        EffectId::ExponentialStiffening => 1.3,
        _ => 0.3,
    }
}

/// The factor on the first number of an effect that takes its form on: half of a growth of e^{1.5} is
/// then the form's.
fn size_factor(id: EffectId) -> f64 {
    match id {
        EffectId::ExponentialStiffening => 0.5,
        _ => 1.0,
    }
}

/// Whether an added term has a form.
fn has(term: &Term, form: Form) -> bool {
    term.id == form.0 && !term.given && term.free[form.1]
}

/// Whether an added term could take a form on. Adhesion that is a bond cannot: it has a memory already.
fn lacks(term: &Term, form: Form) -> bool {
    let is_bond = term.id == EffectId::Adhesion && term.row[2] > 0.0;
    term.id == form.0 && !term.given && !term.free[form.1] && !is_bond
}

impl Search<'_> {
    /// The fit with the forms that are significant. A fit that is left near the noise needs none.
    pub(crate) fn with_significant_forms(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in OPTIONAL {
            if self.is_adequate(&best) {
                break;
            }
            let value = start(form, self.dataset.scales);
            if let Some(fit) = self.with_form(&best, |term| lacks(term, form), form.1, Some(value))
                && best.cost - fit.cost > self.form_threshold(form.0, best.cost, &fit, base_cost)
            {
                best = fit;
            }
        }
        best
    }

    /// The fit with a form in the place of another effect that only took its error: a pull that differs by
    /// direction, where a friction seemed to come to a pull that does not.
    pub(crate) fn with_form_instead_of_effect(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in OPTIONAL {
            let others = best.added().into_iter();
            let others: Vec<usize> = others
                .filter(|at| best.shape.terms[*at].id != form.0)
                .collect();
            let value = start(form, self.dataset.scales);
            let instead = others.into_par_iter().filter_map(|at| {
                let id = best.shape.terms[at].id;
                let (shape, numbers) = best.without(at, self.dataset.scales);
                let without = Fit {
                    shape,
                    numbers,
                    cost: best.cost,
                };
                let lacks = |term: &Term| lacks(term, form);
                let fit = self.with_form(&without, lacks, form.1, Some(value))?;
                let threshold = self.effect_threshold(id, fit.cost, &best, base_cost);
                (fit.cost - best.cost < threshold).then_some(fit)
            });
            if let Some(fit) = instead.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
                best = fit;
            }
        }
        best
    }

    /// The fit without the forms that are not significant.
    pub(crate) fn without_insignificant_forms(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in OPTIONAL.into_iter().chain(INITIAL) {
            if let Some(fit) = self.with_form(&best, |term| has(term, form), form.1, None)
                && fit.cost - best.cost < self.form_threshold(form.0, fit.cost, &best, base_cost)
            {
                best = fit;
            }
        }
        best
    }

    /// Refits with the number of one term free from a value on, or fixed to 0.
    fn with_form(
        &self,
        fit: &Fit,
        is_it: impl Fn(&Term) -> bool,
        at: usize,
        value: Option<f64>,
    ) -> Option<Fit> {
        let mut terms = fit.shape.terms_at(&fit.numbers);
        let term = terms.iter_mut().find(|term| is_it(term))?;
        (term.row[at], term.free[at]) = (value.unwrap_or(0.0), value.is_some());
        term.row[0] *= match value {
            Some(_) => size_factor(term.id),
            None => 1.0 / size_factor(term.id),
        };
        let (shape, start) = fit.with_terms(terms, self.dataset.scales);
        Some(self.problem().fit(&shape, start))
    }
}
