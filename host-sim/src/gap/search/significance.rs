//! The reduction of Σ w r² that makes an effect significant.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::{error::rests, fit::Fit};
use crate::gap::search::{run::Search, sets::is_repeated};

impl Search<'_> {
    /// Whether an effect takes off what it must, and is significant even if every rest is off by what
    /// the error of the encoder makes there. With 0.3 µm at 5 kN/m a hold of a thousand samples under
    /// 3.4 mN is off by 13 of its own standard errors, and a cogging of 35 µm fitted eight of them (one
    /// of 260 logs with white noise).
    pub(crate) fn is_significant(
        &self,
        id: EffectId,
        without: &Fit,
        with: &Fit,
        base_cost: f64,
    ) -> bool {
        let gained = without.cost - with.cost;
        let certain = gained - self.gain_of_rest_offsets(without) + self.gain_of_rest_offsets(with);
        gained > self.effect_threshold(id, without.cost, with, base_cost)
            && certain > self.noise_threshold(with)
    }

    /// What noise alone does not take off Σ w r² with any effect of the catalogue.
    fn noise_threshold(&self, fit: &Fit) -> f64 {
        let chi2 = self.dataset.thresholds.significance.chi2_of(self.ids.len());
        self.correlation * chi2 * (fit.cost / self.noise_cost).max(1.0)
    }

    /// What an offset of each rest would take off Σ w r², as large as the error of the position allows:
    /// Σ over rests (Σ w r e)² / (1 + Σ w e²).
    fn gain_of_rest_offsets(&self, fit: &Fit) -> f64 {
        let weights = &self.weights;
        let problem = self.problem();
        let used = problem.used();
        let residuals = problem.residuals(&fit.shape, &fit.numbers);
        rests(&problem, fit, &used)
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

    /// What an effect must take off Σ w r² to be added to a fit with the cost `without`. `fit` has the
    /// effect.
    pub(crate) fn effect_threshold(
        &self,
        id: EffectId,
        without: f64,
        fit: &Fit,
        base_cost: f64,
    ) -> f64 {
        let thresholds = self.dataset.thresholds;
        let decide = &thresholds.significance;
        let floors = self.dataset.floors.iter();
        let coloured = floors
            .filter(|floor| floor.coloured || floor.lines_n > decide.lines * floor.used_n)
            .map(|floor| f64::max(decide.coloured, thresholds.floor.sigmas * floor.uncertainty))
            .fold(decide.white, f64::max);
        let suffices = without < thresholds.explained.sufficient * self.noise_cost
            && without < decide.sufficient * base_cost;
        let least = if suffices || self.is_allowed(without) {
            coloured.max(decide.beside_sufficient)
        } else {
            coloured
        };
        self.form_threshold(id, without, fit, base_cost)
            .max(least * fit.cost)
    }

    /// What a number that refines the form of an effect must take off Σ w r².
    pub(crate) fn form_threshold(
        &self,
        id: EffectId,
        without: f64,
        fit: &Fit,
        base_cost: f64,
    ) -> f64 {
        let decide = &self.dataset.thresholds.significance;
        let form = decide.form * (base_cost - self.noise_cost).max(0.0);
        let certain = if is_repeated(id, fit) {
            decide.certain_of_repeated
        } else {
            decide.certain_of_new
        };
        self.noise_threshold(fit)
            .max(form.min(certain * (without - self.noise_cost).max(0.0)))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::gap::data::fit_data::FitData;
    use crate::gap::data::scales::Scales;
    use crate::gap::model::dataset::Dataset;
    use crate::gap::model::start::whole;
    use crate::gap::progress::Silent;
    use crate::gap::search::run::MOST_ADDED;
    use crate::gap::search::screen::Screen;
    use crate::gap::{NoiseFloor, Options};
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

    /// A spring of 5 kN/m with a damper.
    fn spring() -> Environment {
        let parameter = |name: &str, value, unit| Parameter {
            name: name.into(),
            value,
            unit,
        };
        Environment {
            law: LawId::KelvinVoigt,
            values: vec![
                parameter("stiffness", STIFFNESS, "N/m"),
                parameter("damping", 1.0, "N s/m"),
            ],
            surface_m: 0.0,
            reference_depth_m: 1e-3,
            recovery: None,
            fit: Kept::default(),
        }
    }

    /// What is asked of a search in a log that knows nothing but its base.
    pub(in crate::gap::search) fn in_search<T>(
        log: &UniformLog,
        base: &Environment,
        ask: impl FnOnce(&mut Search<'_>) -> T,
    ) -> T {
        let floors = [NoiseFloor::of(log, &Default::default())];
        let logs = [FitData::of(log)];
        let scales = Scales::of(&logs);
        let options = Options::default();
        let screen = Screen::of(&logs);
        ask(&mut Search {
            screen: &screen,
            dataset: Dataset {
                logs: &logs,
                floors: &floors,
                low_pass: None,
                scales: &scales,
                known: None,
                thresholds: &options.thresholds,
            },
            weights: vec![1.0; log.len()],
            base,
            given: &[],
            ids: &options.catalogue,
            most_added: MOST_ADDED,
            progress: &Silent,
            noise_cost: 0.0,
            correlation: 1.0,
            tried: Vec::new(),
        })
    }

    /// What a cogging takes off Σ w r² in units of its threshold, and whether it is significant.
    fn taken(cogging_n: f64) -> (f64, bool) {
        in_search(&steps(cogging_n), &spring(), |search| {
            let fit = search.base_fit();
            search.weights = search.dataset.weights(&fit);
            let without = search.refitted(&fit);
            let mut row = [0.0; MOST_PARAMETERS];
            row[..3].copy_from_slice(&[cogging_n.max(1e-3), PITCH_M, 0.0]);
            let terms = vec![whole(EffectId::Cogging, row, 3)];
            let (shape, start) = without.with_terms(terms, search.dataset.scales);
            let with = search.problem().fit(&shape, start);
            search.noise_cost = with.cost;
            let (id, cost) = (EffectId::Cogging, without.cost);
            let threshold = search.effect_threshold(id, cost, &with, cost);
            let is_significant = search.is_significant(id, &without, &with, cost);
            ((cost - with.cost) / threshold, is_significant)
        })
    }

    #[test]
    fn a_cogging_that_the_encoders_error_in_ten_holds_imitates_is_not_significant() {
        // GIVEN holds that are off by up to half a count at 5 kN/m, and no cogging, THEN a cogging takes
        // off what the threshold asks, and still is not significant.
        let (taken, significant) = taken(0.0);
        assert!(taken > 1.0 && !significant, "{taken} {significant}");
        // AND a cogging of four counts is significant.
        let (taken, significant) = self::taken(20e-3);
        assert!(taken > 1.5 && significant, "{taken} {significant}");
    }
}
