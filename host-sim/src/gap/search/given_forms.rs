//! Forms that the effects of the base model take on.
//!
//! A model file gives a friction by its force alone, and every friction bends before it slides. That is no missing effect
//! but a number that the file leaves at 0: a stage whose friction had a width of 20 µm was missing Bouc and Wen's loop,
//! certain, and its own friction was 9 mN instead of 2 N.

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
            match fits.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
                Some(fit) => base = fit,
                None => return base,
            }
        }
    }
}
