//! What an effect must be worth to be named.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::error::rests;
use crate::gap::model::fit::Fit;
use crate::gap::noise::floor::FLOOR_ERRORS;
use crate::gap::search::search::Search;

/// Σ w r² in units of the floor's at which names suffice: the square of `decide`'s bound.
const SUFFICIENT: f64 = 1.25;
/// Share of what is left that is no error of form: of a new name, and of one more of the same.
const MOST: f64 = 0.5;
const MORE: f64 = 0.2;

/// Whether an effect stands in a fit more than once.
pub(in crate::gap) fn is_repeated(id: EffectId, fit: &Fit) -> bool {
    fit.shape.terms.iter().filter(|term| term.id == id).count() > 1
}

impl Search<'_> {
    /// Whether an effect is worth its price, and significant even if every rest is off by what the
    /// encoder's error makes there: with 0.3 µm at 5 kN/m a hold of a thousand samples under 3.4 mN is off by
    /// 13 of its own standard errors, and a cogging of 35 µm fitted eight of them (one of 260 logs with white noise).
    pub(in crate::gap) fn pays(&self, id: EffectId, without: &Fit, with: &Fit, base: f64) -> bool {
        let gained = without.cost - with.cost;
        let certain = gained - self.at_rest(without) + self.at_rest(with);
        gained > self.price(id, without.cost, with, base) && certain > self.significant(with)
    }

    /// What no noise takes off Σ w r², with the catalogue's size.
    fn significant(&self, fit: &Fit) -> f64 {
        let catalogue = 2.0 * (self.ids.len() as f64).ln();
        self.correlation * (25.0 + catalogue) * (fit.cost / self.floor).max(1.0)
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
    pub(in crate::gap) fn price(&self, id: EffectId, without: f64, fit: &Fit, base: f64) -> f64 {
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
    pub(in crate::gap) fn form_price(
        &self,
        id: EffectId,
        without: f64,
        fit: &Fit,
        base: f64,
    ) -> f64 {
        // Significance, and a share of what the base left, for the errors of the effects' forms.
        let form = 0.02 * (base - self.floor).max(0.0);
        // What takes most of all that is left is no error of form, however bad the base was; nor is
        // one more mode of a spectrum, which adds no name.
        let most = if is_repeated(id, fit) { MORE } else { MOST };
        self.significant(fit)
            .max(form.min(most * (without - self.floor).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::fit_data::Course;
    use crate::gap::data::scales::Scales;
    use crate::gap::model::start::whole;
    use crate::gap::model::weights::{variances, weights};
    use crate::gap::progress::Silent;
    use crate::gap::{Floor, Options};
    use crate::log::UniformLog;
    use crate::model::{Environment, Fit as Kept, Parameter};
    use estimator_core::physics::effect::MOST_PARAMETERS;
    use estimator_core::physics::law::LawId;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use std::f64::consts::TAU;

    const SEED_NOISE: u64 = 5;
    const SIGMA_N: f64 = 3e-3;
    const STIFFNESS: f64 = 5e3;
    const PITCH_M: f64 = 35e-6;

    /// Ten steps into 5 kN/m, a second each at 1 kHz with an encoder of 1 µm, and a cogging.
    fn steps(cogging_n: f64) -> UniformLog {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE);
        let normal = Normal::new(0.0, SIGMA_N).unwrap();
        // A fifth of each second it moves on, so that the log shows what a count is.
        let hold_um = |k: usize| 400.0 + 32.37 * (k * (3 + k)) as f64;
        let true_m = |at: usize| {
            let (k, moved) = (at / 1000, f64::min((at % 1000) as f64 / 200.0, 1.0));
            let from_um = hold_um(k.saturating_sub(1));
            1e-6 * (from_um + moved * (hold_um(k) - from_um))
        };
        let x = |at: usize| 1e-6 * (1e6 * true_m(at)).round();
        let force = |at: usize| {
            let wave = cogging_n * (TAU * true_m(at) / PITCH_M).sin();
            STIFFNESS * true_m(at) + wave + normal.sample(&mut rng)
        };
        UniformLog {
            rate_hz: 1000.0,
            time_s: (0..10_000).map(|at| 1e-3 * at as f64).collect(),
            force_n: (0..10_000).map(force).collect(),
            position_m: (0..10_000).map(x).collect(),
            in_gap: vec![false; 10_000],
            ..UniformLog::default()
        }
    }

    /// What a cogging takes off Σ w r² in units of its price, and whether it is worth it.
    fn taken(cogging_n: f64) -> (f64, bool) {
        let log = steps(cogging_n);
        let floors = [Floor::of(&log)];
        let courses = [Course::of(&log)];
        let scales = Scales::of(&courses);
        let base = Environment {
            law: LawId::KelvinVoigt,
            values: vec![
                Parameter {
                    name: "stiffness".into(),
                    value: STIFFNESS,
                    unit: "N/m",
                },
                Parameter {
                    name: "damping".into(),
                    value: 1.0,
                    unit: "N s/m",
                },
            ],
            surface_m: 0.0,
            reference_depth_m: 1e-3,
            fit: Kept::default(),
        };
        let options = Options::default();
        let mut search = Search {
            courses: &courses,
            floors: &floors,
            low_pass: None,
            weights: vec![1.0; log.len()],
            base: &base,
            given: &[],
            scales: &scales,
            ids: &options.catalogue,
            progress: &Silent,
            floor: 0.0,
            correlation: 1.0,
            tried: Vec::new(),
        };
        let fit = search.base_fit();
        search.weights = weights(&variances(&fit, &courses, &floors, None));
        let without = search.refitted(&fit);
        let mut row = [0.0; MOST_PARAMETERS];
        row[..3].copy_from_slice(&[cogging_n.max(1e-3), PITCH_M, 0.0]);
        let terms = vec![whole(EffectId::Cogging, row, 3)];
        let (shape, start) = without.with_terms(terms, &scales);
        let with = search.problem().fit(&shape, start);
        search.floor = with.cost;
        let price = search.price(EffectId::Cogging, without.cost, &with, without.cost);
        let pays = search.pays(EffectId::Cogging, &without, &with, without.cost);
        ((without.cost - with.cost) / price, pays)
    }

    #[test]
    fn a_cogging_that_the_encoders_error_in_ten_holds_imitates_is_not_worth_its_price() {
        // GIVEN holds that are off by up to half a count at 5 kN/m, and no cogging, THEN one has what the
        // price asks, and still is none.
        let (taken, pays) = taken(0.0);
        assert!(taken > 1.0 && !pays, "{taken} {pays}");
        // AND a cogging of four counts is one.
        let (taken, pays) = self::taken(20e-3);
        assert!(taken > 1.5 && pays, "{taken} {pays}");
    }
}
