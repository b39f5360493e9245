//! Whether parts of the logs give an effect the same size: either half of the time, and free air and contact.
//!
//! A damping that grows with the square of the speed, in contact only, was followed by a quadratic drag in 88 % of
//! the blocks, with 1110 ± 190 N s²/m²: 1890 ± 23 in contact and 11 ± 6 in free air. Of effects that were put into
//! measured records none differs so. Loading and unloading are not compared: what a record's owner model leaves
//! makes a true cable differ by 8 standard errors there, a mass by 6.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::dataset::Dataset;
use crate::gap::model::{error::std_errors, error::std_errors_holding, fit::Fit};
use crate::gap::thresholds;

/// Most steps of the fit to a part of the logs.
const STEPS: usize = 12;

/// A fit to a part of the logs, and the standard errors of its numbers.
type Part = (Fit, Vec<Option<f64>>);

/// The numbers of a part that are at a bound, but for sizes of 0: that an effect is none there is what is asked. A drag of
/// 354 ± 2 N s²/m² in contact and none in free air was one everywhere.
fn held(fit: &Fit) -> Vec<bool> {
    let mut held = fit.at_bound();
    for at in (0..fit.shape.terms.len()).flat_map(|number| fit.shape.sizes_of(number)) {
        held[at] &= !fit.shape.free[at].is_at_lowest(fit.numbers[at]);
    }
    held
}

/// Fits to parts of the logs.
pub(super) struct Parts {
    /// Either half, and free air and contact.
    pairs: [[Part; 2]; 2],
    /// The standard errors of the fit to all samples.
    errors: Vec<Option<f64>>,
}

impl Parts {
    pub(super) fn of(dataset: &Dataset<'_>, weights: &[f64], best: &Fit) -> Parts {
        let of = |is_in: &(dyn Fn(usize) -> bool + Sync)| {
            let each = weights.iter().enumerate();
            let weights: Vec<f64> = each
                .map(|(at, w)| if is_in(at) { *w } else { 0.0 })
                .collect();
            let problem = dataset.problem(&weights);
            let fit = problem.fit_briefly(&best.shape, best.numbers.clone(), STEPS);
            let errors = std_errors_holding(&problem, &fit, &held(&fit));
            (fit, errors)
        };
        let both = |is_in: &(dyn Fn(usize) -> bool + Sync)| {
            let (a, b) = rayon::join(|| of(&|at| !is_in(at)), || of(&|at| is_in(at)));
            [a, b]
        };
        let surface_m = best.shape.surface_at(&best.numbers);
        let positions = dataset.logs.iter().flat_map(|log| &log.position_m);
        let touches: Vec<bool> = positions.map(|x| *x > surface_m).collect();
        Parts {
            pairs: [both(&|at| 2 * at >= weights.len()), both(&|at| touches[at])],
            errors: std_errors(&dataset.problem(weights), best),
        }
    }

    /// Whether the size of an effect is known, and each pair of parts gives the same.
    pub(super) fn agree(&self, best: &Fit, id: EffectId, decide: &thresholds::Evidence) -> bool {
        let is_own = |number: &usize| {
            let term = &best.shape.terms[*number];
            !term.given && term.id == id
        };
        let terms: Vec<usize> = (0..best.shape.terms.len()).filter(is_own).collect();
        // A relaxation of 0.95, as far as it goes, followed a material that tires.
        let known = |number: &usize| {
            let mut sizes = best.shape.sizes_of(*number);
            sizes.find(|at| self.errors[*at].is_some())
        };
        let mut sizes = terms.iter().filter_map(known);
        let of = |at: usize, (fit, errors): &Part| {
            Some((best.shape.natural(at, fit.numbers[at]), errors[at]?))
        };
        let differ = |at: usize| {
            self.pairs
                .iter()
                .any(|[a, b]| match (of(at, a), of(at, b)) {
                    (Some((a, ea)), Some((b, eb))) => (a - b).abs() > decide.halves * ea.hypot(eb),
                    // A part may not show the effect at all, as half a log an adhesion at the only lift-off.
                    _ => false,
                })
        };
        let Some(size) = sizes.next() else {
            return false;
        };
        // Modes of a spectrum trade their shares.
        terms.len() > 1 || !differ(size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::data::{fit_data::FitData, scales::Scales};
    use crate::gap::model::{shape::Shape, start::whole};
    use crate::gap::noise::floor::NoiseFloor;
    use crate::gap::thresholds::Thresholds;
    use crate::log::Log;
    use crate::model::Model;
    use crate::toml_reader::TomlFile;
    use std::path::Path;

    /// Whether the parts agree on a drag where there is one of so many N s²/m² in free air and in contact.
    fn agree(in_air: f64, in_contact: f64) -> bool {
        let path = Path::new("model.toml");
        let text = "[environment]\nlaw = \"kelvin_voigt\"\nstiffness = 1000.0\ndamping = 3.0\n";
        let model = Model::from_toml(&TomlFile::parse(text.into(), path).unwrap(), path).unwrap();
        let time_s: Vec<f64> = (0..4000).map(|at| f64::from(at) * 1e-3).collect();
        let motion = |t: f64| (5e-3 * (12.0 * t).sin(), 0.06 * (12.0 * t).cos());
        let force = |(at, t): (usize, &f64)| {
            let (x, v) = motion(*t);
            let contact = if x > 0.0 {
                (1e3 * x + 3.0 * v).max(0.0)
            } else {
                0.0
            };
            let drag = if x > 0.0 { in_contact } else { in_air };
            // 10 mN that nothing explains.
            let unknown = 0.01 * ((at * at % 97) as f64 / 48.0 - 1.0);
            contact + drag * v * v.abs() + unknown
        };
        let forces = time_s.iter().enumerate().map(force).collect();
        let positions = time_s.iter().map(|t| motion(*t).0).collect();
        let log = Log::from_channels(time_s, positions, forces)
            .uniform()
            .unwrap();
        let thresholds = Thresholds::default();
        let logs = [FitData::of(&log)];
        let scales = Scales::of(&logs);
        let dataset = Dataset {
            logs: &logs,
            floors: &[NoiseFloor::of(&log, &thresholds.floor)],
            low_pass: None,
            scales: &scales,
            known: None,
            thresholds: &thresholds,
        };
        let drag = whole(EffectId::QuadraticDrag, [in_contact, 0.0, 0.0, 0.0, 0.0], 1);
        let shape = Shape::new(&model.environment, vec![drag], &scales);
        let weights = vec![1e4; logs[0].force_n.len()];
        let fit = dataset.problem(&weights).fit(&shape, shape.start());
        let parts = Parts::of(&dataset, &weights, &fit);
        parts.agree(&fit, EffectId::QuadraticDrag, &thresholds.evidence)
    }

    #[test]
    fn a_drag_is_one_in_free_air_as_well() {
        assert!(agree(20.0, 20.0));
        assert!(!agree(0.0, 20.0));
        // AND where it is none, since it may not be less.
        assert!(!agree(-2.0, 20.0));
    }
}
