//! What an effect must be worth to be named.

use estimator_core::effect::EffectId;

use super::decide::FLOOR_ERRORS;
use super::error::rests;
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
    /// What a fit takes off Σ w r² that another leaves, if no encoder's error at rest explains it: with
    /// 0.3 µm at 5 kN/m every hold is off by half a sigma of its own, a thousand samples long, and a
    /// cogging of 35 µm fits eight holds (of 260 logs with nothing but white noise one).
    pub(super) fn gained(&self, without: &Fit, with: &Fit) -> f64 {
        let plain = without.cost - with.cost;
        plain.min(plain - self.at_rest(without) + self.at_rest(with))
    }

    /// What offsets of the rests would take off Σ w r², each as large as the position's error allows:
    /// Σ over rests (Σ w r e)² / (1 + Σ w e²).
    fn at_rest(&self, fit: &Fit) -> f64 {
        let weights = &self.weights;
        let used: Vec<usize> = (0..weights.len()).filter(|at| weights[*at] > 0.0).collect();
        let residuals = self.problem().residuals(&fit.shape, &fit.numbers);
        rests(&self.problem(), fit, &used)
            .iter()
            .map(|(samples, error_n)| {
                let (mut along, mut square) = (0.0, 1.0);
                for (at, error) in used[samples.clone()].iter().zip(error_n) {
                    along += weights[*at] * residuals[*at] * error;
                    square += weights[*at] * error * error;
                }
                along * along / square
            })
            .sum()
    }

    /// What an effect must take off Σ w r² to be there, when `without` is left without it.
    pub(super) fn price(&self, id: EffectId, without: f64, fit: &Fit, base: f64) -> f64 {
        // 4 % of what is left, for the errors of the noise's own model; 10 % where that is coloured, and
        // more where its slowest part is a guess: a wander that rests of a second do not show.
        let coloured = self
            .floors
            .iter()
            .filter(|own| own.coloured || own.lines_n > 0.3 * own.used_n)
            .map(|own| f64::max(0.10, FLOOR_ERRORS * own.uncertainty))
            .fold(0.04, f64::max);
        // Beside names that suffice another one has to earn its place: what is left then is mostly
        // the form of the first (a Stribeck's where the catalogue says Coulomb's).
        let suffices = without < SUFFICIENT * self.floor && without < 0.5 * base;
        let least = if suffices {
            coloured.max(0.15)
        } else {
            coloured
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
