//! What an effect must be worth to be named.

use estimator_core::effect::EffectId;

use super::fit::Fit;
use super::search::Search;

/// Σ w r² in units of the floor's at which names suffice: the square of `decide`'s bound.
const SUFFICIENT: f64 = 1.25;
/// Share of what is left that is no error of form: of a new name, and of one more of the same.
const MOST: f64 = 0.5;
const MORE: f64 = 0.2;

/// Whether an effect stands in a fit more than once.
fn is_repeated(id: EffectId, fit: &Fit) -> bool {
    fit.shape.terms.iter().filter(|term| term.id == id).count() > 1
}

impl Search<'_> {
    /// What an effect must take off Σ w r² to be there, when `without` is left without it.
    pub(super) fn price(&self, id: EffectId, without: f64, fit: &Fit, base: f64) -> f64 {
        // 4 % of what is left, for the errors of the noise's own model, 10 % where that is coloured.
        let coloured = self
            .floors
            .iter()
            .any(|own| own.coloured || own.lines_n > 0.3 * own.used_n);
        // Beside names that suffice another one has to earn its place: what is left then is mostly
        // the form of the first (a Stribeck's where the catalogue says Coulomb's).
        let suffices = without < SUFFICIENT * self.floor && without < 0.5 * base;
        let least = if suffices {
            0.15
        } else if coloured {
            0.10
        } else {
            0.04
        };
        self.form_price(id, without, fit, base)
            .max(least * fit.cost)
    }

    /// The same of a number that refines the form of an effect.
    pub(super) fn form_price(&self, id: EffectId, without: f64, fit: &Fit, base: f64) -> f64 {
        // Significance, with the catalogue's size; and a share of what the base left, for the errors of
        // the effects' forms.
        let catalogue = 2.0 * (self.ids.len() as f64).ln();
        let significant = self.correlation * (25.0 + catalogue) * (fit.cost / self.floor).max(1.0);
        let form = 0.02 * (base - self.floor).max(0.0);
        // What takes most of all that is left is no error of form, however bad the base was; nor is
        // one more mode of a spectrum, which adds no name.
        let most = if is_repeated(id, fit) { MORE } else { MOST };
        significant.max(form.min(most * (without - self.floor).max(0.0)))
    }
}
