//! Optional forms of effects: a number each, or two, that are free only where that is significant.

use estimator_core::physics::effect::{EffectId, Form, Role};
use estimator_core::physics::fit_range::Scaled;
use rayon::prelude::*;

use crate::gap::data::scales::Scales;
use crate::gap::model::{fit::Fit, shape::Term, start::starts_of_number};
use crate::gap::search::run::Search;

/// A form that a fit can choose: the effect, the place of its number in the row, and what its row says.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    pub(super) id: EffectId,
    place: usize,
    form: Form,
}

impl Choice {
    /// The forms of the catalogue that a fit may add or drop, and an effect of the model may take on.
    pub(super) fn all() -> impl Iterator<Item = Choice> {
        EffectId::ALL.iter().flat_map(|id| {
            let fits = id.info().fits.iter().enumerate();
            fits.filter_map(|(place, fit)| match fit.role {
                Role::Form(_, form) if !matches!(form, Form::Beside(_)) => Some(Choice {
                    id: *id,
                    place,
                    form,
                }),
                _ => None,
            })
        })
    }

    /// The forms that an added effect may take on, and loses again where they are not significant.
    fn taken_on() -> impl Iterator<Item = Choice> {
        Choice::all().filter(|choice| matches!(choice.form, Form::TakenOn { .. }))
    }

    /// The forms that starts have, and that an effect loses where they are not significant.
    fn dropped() -> impl Iterator<Item = Choice> {
        Choice::all().filter(|choice| choice.form == Form::Dropped)
    }

    /// Whether an added term has the form.
    fn is_in(&self, term: &Term) -> bool {
        term.id == self.id && !term.given && term.free[self.place]
    }

    /// Whether a term could take the form on. A switch that is on has chosen another law: adhesion that is a bond
    /// has a memory already.
    pub(super) fn is_open_to(&self, term: &Term) -> bool {
        let is_open = match term.given {
            true => term.open[self.place],
            false => matches!(self.form, Form::TakenOn { .. }),
        };
        is_open
            && term.id == self.id
            && !term.free[self.place]
            && !term.id.info().is_switched(&term.row)
    }

    /// The term with the form, from each of its starts.
    fn taken_on_by(&self, term: &Term, scales: &Scales) -> Vec<Term> {
        let Form::TakenOn { start, first } = self.form else {
            let starts = starts_of_number(self.id, self.place, scales).into_iter();
            return starts.map(|start| self.put_into(term, start)).collect();
        };
        let size = |number: Scaled| number.value(|scale| scales.size(scale));
        let mut own = self.put_into(term, size(start));
        own.row[0] *= first;
        let Some((place, starts)) = self.beside() else {
            return vec![own];
        };
        own.free[place] = true;
        let each = starts.iter().map(|start| {
            let mut own = own.clone();
            own.row[place] = size(*start);
            own
        });
        each.collect()
    }

    fn put_into(&self, term: &Term, value: f64) -> Term {
        let mut own = term.clone();
        own.row[self.place] = value;
        own.free[self.place] = true;
        own
    }

    /// The number that comes and goes with the form: its place, and where it starts.
    fn beside(&self) -> Option<(usize, &'static [Scaled])> {
        let place = self.place + 1;
        match self.id.info().fits.get(place)?.role {
            Role::Form(_, Form::Beside(starts)) => Some((place, starts)),
            _ => None,
        }
    }

    fn drop_from(&self, term: &mut Term) {
        let beside = self.beside().map(|(place, _)| place);
        for place in [self.place].into_iter().chain(beside) {
            term.row[place] = 0.0;
            term.free[place] = false;
        }
        if let Form::TakenOn { first, .. } = self.form {
            term.row[0] /= first;
        }
    }
}

impl Term {
    /// Frees the numbers that a start holds and no form is; whether there are any.
    fn free_what_is_held(&mut self) -> bool {
        let fits = self.id.info().fits.iter().enumerate();
        let held = fits.filter(|(_, fit)| !matches!(fit.role, Role::Form(..)));
        let mut is_freed = false;
        for (place, _) in held {
            is_freed |= !std::mem::replace(&mut self.free[place], true);
        }
        is_freed
    }
}

/// A term without its forms, if it has one: a ramp for a drift that comes to rest.
pub(crate) fn in_plain_form(term: &Term) -> Option<Term> {
    let mut plain = term.clone();
    for choice in Choice::all().filter(|choice| choice.is_in(term)) {
        choice.drop_from(&mut plain);
    }
    (plain.free != term.free).then_some(plain)
}

/// Most fits that are tried with their forms beside the best.
const MOST_COMPARED: usize = 2;

/// Whether an added effect of a fit could take a form on.
fn has_open_form(fit: &Fit) -> bool {
    let mut terms = fit.shape.terms.iter();
    terms.any(|term| Choice::taken_on().any(|choice| choice.is_open_to(term)))
}

impl Search<'_> {
    /// The fit with the forms that are significant. A fit that is left near the noise needs none.
    fn with_significant_forms(&self, best: Fit, base_cost: f64) -> Fit {
        self.with_forms_until(best, base_cost, |fit| self.is_adequate(fit))
    }

    /// The fit with every form that is significant, however near the noise: for fits that are compared.
    pub(crate) fn with_all_forms(&self, best: Fit, base_cost: f64) -> Fit {
        self.with_forms_until(best, base_cost, |_| false)
    }

    fn with_forms_until(
        &self,
        mut best: Fit,
        base_cost: f64,
        suffices: impl Fn(&Fit) -> bool,
    ) -> Fit {
        for choice in Choice::taken_on() {
            if suffices(&best) {
                break;
            }
            if let Some(fit) = self.with_form(&best, choice)
                && best.cost - fit.cost > self.form_threshold(choice.id, best.cost, &fit, base_cost)
            {
                best = fit;
            }
        }
        if suffices(&best) {
            return best;
        }
        self.with_held_numbers_free(best, base_cost)
    }

    /// The fit with the numbers free that the starts of its effects hold, where that is significant: a loop of exponent 1.5
    /// that was named with 1 left 4.3 floors, and on the next log, with all numbers of the model free, had changed by 17
    /// times.
    fn with_held_numbers_free(&self, best: Fit, base_cost: f64) -> Fit {
        let terms = best.shape.terms_at(&best.numbers);
        let freed = (0..terms.len()).filter_map(|at| {
            let mut terms = terms.clone();
            let id = terms[at].id;
            let is_freed = !terms[at].given && terms[at].free_what_is_held();
            is_freed.then(|| (id, self.with_terms(&best, terms)))
        });
        let freed: Vec<(EffectId, Fit)> = freed.collect();
        let significant = freed.into_iter().filter(|(id, fit)| {
            best.cost - fit.cost > self.form_threshold(*id, best.cost, fit, base_cost)
        });
        let least = significant.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        least.map_or(best, |(_, fit)| fit)
    }

    /// The best of a fit and of others that leave hardly more, each with the forms that are significant: a
    /// loading curve that grows with the depth is nearer to a friction under load that does not, than to a
    /// loading curve that does not.
    pub(crate) fn best_with_forms(&self, best: Fit, others: &[Fit], base_cost: f64) -> Fit {
        let most = self.dataset.thresholds.rivalry.followed * best.cost;
        let best = self.with_significant_forms(best, base_cost);
        if self.is_adequate(&best) {
            return best;
        }
        let others = others.iter().filter(|fit| has_open_form(fit));
        let others = others.map(|fit| self.with_present_cost(fit));
        let near = others.filter(|fit| fit.cost < most).take(MOST_COMPARED);
        let fits = near.map(|fit| self.with_significant_forms(self.refitted(&fit), base_cost));
        fits.chain([best.clone()])
            .min_by(|a, b| self.score(a).total_cmp(&self.score(b)))
            .unwrap_or(best)
    }

    /// The fit with a form in the place of another effect that only took its error: a pull that differs by
    /// direction, where a friction seemed to come to a pull that does not. Or a friction of the model that first bends,
    /// where a loop seemed to come to one that does not.
    pub(crate) fn with_form_instead_of_effect(&self, mut best: Fit, base_cost: f64) -> Fit {
        for choice in Choice::all() {
            let others = best.added().into_iter();
            let others: Vec<usize> = others
                .filter(|at| best.shape.terms[*at].id != choice.id)
                .collect();
            let instead = others.into_par_iter().filter_map(|at| {
                let id = best.shape.terms[at].id;
                let (shape, numbers) = best.without(at, self.dataset.scales);
                let without = Fit {
                    shape,
                    numbers,
                    cost: best.cost,
                };
                let fit = self.with_form(&without, choice)?;
                // A form of an effect that is there already is no explanation by itself: it stands for another form of
                // the same, or leaves less.
                let is_given = |term: &Term| term.given && term.open[choice.place];
                let mut own = fit.shape.terms.iter().filter(|term| term.id == choice.id);
                let is_same = id.info().family == choice.id.info().family;
                let threshold = match own.any(is_given) && !is_same {
                    true => 0.0,
                    false => self.effect_threshold(id, fit.cost, &best, base_cost),
                };
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
        for choice in Choice::taken_on().chain(Choice::dropped()) {
            if let Some(fit) = self.without_form(&best, choice)
                && fit.cost - best.cost < self.form_threshold(choice.id, fit.cost, &best, base_cost)
            {
                best = fit;
            }
        }
        best
    }

    /// Refits with a form that an added effect lacks.
    pub(super) fn with_form(&self, fit: &Fit, choice: Choice) -> Option<Fit> {
        let terms = fit.shape.terms_at(&fit.numbers);
        let at = terms.iter().position(|term| choice.is_open_to(term))?;
        let starts = choice.taken_on_by(&terms[at], self.dataset.scales);
        let fits = starts.into_par_iter().map(|own| {
            let mut terms = terms.clone();
            terms[at] = own;
            self.with_terms(fit, terms)
        });
        fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// Refits without a form that an added effect has.
    fn without_form(&self, fit: &Fit, choice: Choice) -> Option<Fit> {
        let mut terms = fit.shape.terms_at(&fit.numbers);
        let term = terms.iter_mut().find(|term| choice.is_in(term))?;
        choice.drop_from(term);
        Some(self.with_terms(fit, terms))
    }

    /// Refits with other terms, from the values that they have.
    pub(super) fn with_terms(&self, fit: &Fit, terms: Vec<Term>) -> Fit {
        let (shape, start) = fit.with_terms(terms, self.dataset.scales);
        self.problem().fit(&shape, start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::model::start::whole;

    #[test]
    fn a_drift_that_comes_to_rest_is_a_ramp_in_its_plain_form() {
        let resting = whole(EffectId::ForceDrift, [0.2, 1.8, 0.0, 0.0, 0.0], 2);
        let ramp = in_plain_form(&resting).unwrap();
        assert_eq!(
            ramp,
            whole(EffectId::ForceDrift, [0.2, 0.0, 0.0, 0.0, 0.0], 1)
        );
        // What has no form has no plainer one.
        assert_eq!(in_plain_form(&ramp), None);
    }
}
