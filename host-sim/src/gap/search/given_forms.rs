//! Forms that the effects of the base model take on.
//!
//! A model file gives a friction by its force alone, and every friction bends before it slides. That is no missing effect
//! but a number that the file leaves at 0: a stage whose friction had a width of 20 µm was missing Bouc and Wen's loop,
//! certain, and its own friction was 9 mN instead of 2 N.

use estimator_core::physics::effect::{EffectId, Family};

use crate::gap::model::fit::Fit;
use crate::gap::search::{forms::Choice, run::Search};

/// A form must take off so much of what stands above the noise, or leave hardly more than it: a model that lacks an effect
/// takes on any form a little.
const MOST: f64 = 0.5;

impl Search<'_> {
    /// The base with the forms that its effects lack.
    pub(crate) fn with_forms_of_given(&self, mut base: Fit) -> Fit {
        let first = base.cost;
        loop {
            if self.is_adequate(&base) {
                return base;
            }
            let fits = Choice::all().filter_map(|choice| {
                let fit = self.with_form(&base, choice)?;
                let threshold = self.form_threshold(choice.id, base.cost, &fit, first);
                let left = (fit.cost - self.noise_cost) / (base.cost - self.noise_cost);
                let is_most = left < 1.0 - MOST || self.is_adequate(&fit);
                (is_most && base.cost - fit.cost > threshold).then_some(fit)
            });
            let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
            match best.filter(|fit| self.is_adequate(fit) || !self.is_behind_an_effect(&base, fit))
            {
                Some(fit) => base = fit,
                None => return base,
            }
        }
    }

    /// Whether an effect alone leaves less beside the base than a form: a drive's force that is 1.3 ms late is nearly a
    /// friction with a width. One that is another form of the same, as a loop of a friction, is no such effect.
    fn is_behind_an_effect(&self, base: &Fit, with_form: &Fit) -> bool {
        let given = &base.shape.terms;
        let is_other = |id: EffectId| {
            let family = id.info().family;
            let same = given.iter().filter(|term| term.id.info().family == family);
            family == Family::Alone || same.count() == 0
        };
        let alone = self.expanded(base);
        let mut ahead = alone.iter().filter(|fit| fit.cost < with_form.cost);
        ahead.any(|fit| fit.added_ids().into_iter().any(is_other))
    }
}
