//! Forms of an effect that are not its plain one: an optional number each, free only where it pays.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use crate::gap::data::scales::Scales;
use crate::gap::model::fit::Fit;
use crate::gap::model::shape::Term;
use crate::gap::search::search::Search;

/// An optional number of an effect.
type Form = (EffectId, usize);

/// Those that a named effect may take on, and loses again where it does not pay.
const TAKEN_ON: [Form; 4] = [
    (EffectId::SeriesCompliance, 1),
    (EffectId::Adhesion, 3),
    (EffectId::ExponentialStiffening, 1),
    (EffectId::BuriedLayer, 2),
];
/// Those that starts come with, and that go where they do not pay.
const COME_WITH: [Form; 1] = [(EffectId::CoulombFriction, 2)];

/// Where such a number starts.
fn start(form: Form, s: &Scales) -> f64 {
    match form.0 {
        EffectId::SeriesCompliance => 0.5 * s.force_n,
        EffectId::BuriedLayer => 0.03 * s.travel_m,
        EffectId::ExponentialStiffening => 1.3,
        _ => 0.3,
    }
}

/// What the effect's first number is worth once it has the other: half of a growth of e^{1.5} is the bend's.
fn left(id: EffectId) -> f64 {
    match id {
        EffectId::ExponentialStiffening => 0.5,
        _ => 1.0,
    }
}

/// Whether an added term has a number free.
fn has(term: &Term, form: Form) -> bool {
    term.id == form.0 && !term.given && term.free[form.1]
}

/// Whether an added term could take a number on: a bond has its own memory.
fn lacks(term: &Term, form: Form) -> bool {
    let is_bond = term.id == EffectId::Adhesion && term.row[2] > 0.0;
    term.id == form.0 && !term.given && !term.free[form.1] && !is_bond
}

impl Search<'_> {
    /// The fit with the forms that pay; what is left near the floor needs none.
    pub(in crate::gap) fn formed(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in TAKEN_ON {
            if self.is_adequate(&best) {
                break;
            }
            let value = start(form, self.scales);
            if let Some(fit) = self.with_form(&best, |term| lacks(term, form), form.1, Some(value))
                && best.cost - fit.cost > self.form_price(form.0, best.cost, &fit, base_cost)
            {
                best = fit;
            }
        }
        best
    }

    /// The fit with a form in the place of another effect that only took its error: a pull that differs
    /// by direction where a friction seemed to come to a pull that does not.
    pub(in crate::gap) fn formed_instead(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in TAKEN_ON {
            let others = best.added().into_iter();
            let others: Vec<usize> = others
                .filter(|at| best.shape.terms[*at].id != form.0)
                .collect();
            let value = start(form, self.scales);
            let instead = others.into_par_iter().filter_map(|at| {
                let id = best.shape.terms[at].id;
                let (shape, numbers) = best.without(at, self.scales);
                let without = Fit {
                    shape,
                    numbers,
                    cost: best.cost,
                };
                let lacks = |term: &Term| lacks(term, form);
                let fit = self.with_form(&without, lacks, form.1, Some(value))?;
                let price = self.price(id, fit.cost, &best, base_cost);
                (fit.cost - best.cost < price).then_some(fit)
            });
            if let Some(fit) = instead.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
                best = fit;
            }
        }
        best
    }

    /// The fit without the forms that do not pay.
    pub(in crate::gap) fn plainer(&self, mut best: Fit, base_cost: f64) -> Fit {
        for form in TAKEN_ON.into_iter().chain(COME_WITH) {
            if let Some(fit) = self.with_form(&best, |term| has(term, form), form.1, None)
                && fit.cost - best.cost < self.form_price(form.0, fit.cost, &best, base_cost)
            {
                best = fit;
            }
        }
        best
    }

    /// A refit with one term's number free from a value on, or 0.
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
            Some(_) => left(term.id),
            None => 1.0 / left(term.id),
        };
        let (shape, start) = fit.with_terms(terms, self.scales);
        Some(self.problem().fit(&shape, start))
    }
}
