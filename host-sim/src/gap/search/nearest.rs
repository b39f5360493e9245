//! Which of two fits is nearer to the logs where both say that these are known.
//!
//! What a residual may be hangs on the model: a friction that turns within 0.13 mm/s makes 1.3 N of the 10 µm/s that a speed
//! is not known by. Under the errors of a base without it Stribeck's own friction left 4.2 times the noise, and a
//! loop of Bouc and Wen that is not there 4.0.

use rayon::prelude::*;

use crate::gap::model::fit::Fit;
use crate::gap::model::weights::weights;
use crate::gap::search::run::Search;

/// Most fits that are compared with the first.
const MOST: usize = 3;
/// A fit is nearer if it leaves less than this share of what the first does. Stribeck's friction left 0.88. Derived: a
/// twentieth of the squares, as leaves a richer form open.
const CLEARLY: f64 = 0.95;

impl Search<'_> {
    /// The place of the nearest of fits that are far from the noise, the best under the present weights first. Near the noise
    /// the errors are what they are by any of them.
    pub(super) fn nearest(&self, fits: &[Fit]) -> usize {
        let Some(first) = fits.first().filter(|fit| self.is_far(fit)) else {
            return 0;
        };
        let others = fits.par_iter().enumerate().skip(1).take(MOST);
        let ratios = others.map(|(at, fit)| {
            let (of_first, own) = self.refitted_beside(first, fit);
            (at, self.score(&own) / self.score(&of_first))
        });
        let nearest = ratios.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|own| own.1 < CLEARLY).map_or(0, |own| own.0)
    }

    /// Two fits, with the larger of the errors that either allows.
    fn refitted_beside(&self, fit: &Fit, other: &Fit) -> (Fit, Fit) {
        let dataset = &self.dataset;
        let each = dataset.variances(fit).into_iter();
        let each = each.zip(dataset.variances(other));
        let variances: Vec<f64> = each
            .map(|(a, b)| if a > 0.0 && b > 0.0 { a.max(b) } else { 0.0 })
            .collect();
        let weights = weights(&variances);
        let problem = dataset.problem(&weights);
        let refit = |fit: &Fit| problem.fit(&fit.shape, fit.numbers.clone());
        rayon::join(|| refit(fit), || refit(other))
    }
}

#[cfg(test)]
mod tests {
    use crate::gap::model::start::whole;
    use crate::gap::search::significance::tests::in_search;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;
    use estimator_core::physics::effect::EffectId;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    use std::path::Path;

    const SEED_NOISE: u64 = 11;
    const MODEL: &str =
        "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 1.0\n";

    /// Eight moves of 0.5 to 1.5 mm into 1 N/mm, each in 0.15 to 0.4 s with a hold of a second after it, at 1 kHz in counts of
    /// 5 µm with 30 mN of noise. A friction of 1.2 N turns within 0.1 mm/s.
    fn moves() -> Log {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(SEED_NOISE);
        let normal = Normal::new(0.0, 0.03).unwrap();
        let (mut from_m, mut x, mut v) = (1e-3, Vec::new(), Vec::new());
        let ends_mm = [2.1, 1.7, 0.5, 1.5, 0.6, 1.9, 0.7, 1.95];
        for (number, to_mm) in ends_mm.into_iter().enumerate() {
            let (way_m, samples) = (1e-3 * to_mm - from_m, 150 + 35 * number);
            for at in 0..samples + 1000 {
                let part = f64::min(at as f64 / samples as f64, 1.0);
                // A cubic from rest to rest.
                x.push(from_m + way_m * part * part * (3.0 - 2.0 * part));
                v.push(way_m * 6.0 * part * (1.0 - part) / (1e-3 * samples as f64));
            }
            from_m += way_m;
        }
        let force =
            |(x, v): (&f64, &f64)| 1e3 * x + 1.2 * (v / 1e-4_f64).tanh() + normal.sample(&mut rng);
        let forces = x.iter().zip(&v).map(force).collect();
        let counts = x.iter().map(|x| 5e-6 * (x / 5e-6).round()).collect();
        let time = (0..x.len()).map(|at| 1e-3 * at as f64).collect();
        Log::from_channels(time, counts, forces)
    }

    #[test]
    fn of_two_frictions_the_one_that_is_there_is_the_nearest_by_the_errors_of_both() {
        let path = Path::new("base.toml");
        let model = Model::from_toml(&TomlFile::parse(MODEL.into(), path).unwrap(), path).unwrap();
        in_search(&moves().uniform().unwrap(), &model.environment, |search| {
            // GIVEN errors of the force alone, and two that turn within 0.8 and 0.1 mm/s
            let base = search.base_fit();
            search.weights.fill(30e-3_f64.powi(-2));
            search.noise_cost = search.weights.len() as f64;
            let turning = |within_mps: f64| {
                let row = [1.2, 0.0, within_mps, 0.0, 0.0];
                let mut term = whole(EffectId::CoulombFriction, row, 1);
                term.free[2] = false;
                let (shape, start) = base.with_terms(vec![term], search.dataset.scales);
                search.problem().fit(&shape, start)
            };
            let (slow, fast) = (turning(8e-4), turning(1e-4));
            // THEN the true one is the nearest, wherever it comes by them.
            assert_eq!(search.nearest(&[fast.clone(), slow.clone()]), 0);
            assert_eq!(search.nearest(&[slow.clone(), fast.clone()]), 1);
            // AND nothing is compared near the noise.
            search.noise_cost = slow.cost;
            assert_eq!(search.nearest(&[slow, fast]), 0);
        });
    }
}
