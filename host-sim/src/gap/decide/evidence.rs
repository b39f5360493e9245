//! What a decision rests on, and what it comes to.

use estimator_core::physics::effect::EffectId;

use crate::gap::data::fit_data::Course;
use crate::gap::data::low_pass::LowPass;
use crate::gap::data::scales::Scales;
use crate::gap::finding::Verdict;
use crate::gap::model::fit::{Fit, Problem, along};
use crate::gap::noise::floor::Floor;

/// Windows of a log, of which every third is held out.
const WINDOWS: usize = 12;
/// Held-out residuals within this of what is allowed: explained. Errors of form, of the motion
/// between samples, and of the floor itself are below.
pub(in crate::gap) const ADEQUATE: f64 = 1.12;

/// A judged answer.
pub(in crate::gap) struct Decision {
    pub(in crate::gap) verdict: Verdict,
    /// Fits to the whole log.
    pub(in crate::gap) base: Fit,
    pub(in crate::gap) best: Fit,
    /// A rival that explains more, as the search left it.
    pub(in crate::gap) better: Option<Fit>,
    /// Standard errors of `best`'s free numbers, in the parameters' units; None at a bound.
    pub(in crate::gap) std_errors: Vec<Option<f64>>,
    /// For every added effect of `best`, in the order of its terms: who else could it be, and what
    /// the held-out part loses without it.
    pub(in crate::gap) alternatives: Vec<Vec<EffectId>>,
    pub(in crate::gap) gains: Vec<f64>,
    /// Fits with one added effect left out, for the regions where each matters.
    pub(in crate::gap) without: Vec<Fit>,
    /// RMSE (N) of the raw force on the held-out part, before and after.
    pub(in crate::gap) rmse_n: (f64, f64),
    /// Residuals over what is allowed, there.
    pub(in crate::gap) ratio: (f64, f64),
    pub(in crate::gap) variances: Vec<f64>,
    pub(in crate::gap) held_out: Vec<bool>,
    pub(in crate::gap) correlation: f64,
}

/// What deciding needs to know.
pub(in crate::gap) struct Evidence<'a> {
    pub(in crate::gap) courses: &'a [Course],
    pub(in crate::gap) floors: &'a [Floor],
    pub(in crate::gap) low_pass: Option<LowPass>,
    pub(in crate::gap) scales: &'a Scales,
}

impl Evidence<'_> {
    pub(in crate::gap) fn problem<'a>(&'a self, weights: &'a [f64]) -> Problem<'a> {
        Problem {
            courses: self.courses,
            weights,
            low_pass: self.low_pass,
        }
    }

    pub(in crate::gap) fn held_out(&self) -> Vec<bool> {
        let mut held_out = Vec::new();
        for course in self.courses {
            let count = course.len();
            held_out.extend((0..count).map(|at| (at * WINDOWS / count) % 3 == 1));
        }
        held_out
    }

    /// RMSE (N) and weighted ratio of a fit on the held-out part.
    pub(in crate::gap) fn held_out_error(
        &self,
        all: &Problem<'_>,
        fit: &Fit,
        held_out: &[bool],
    ) -> (f64, f64) {
        let residuals = all.residuals(&fit.shape, &fit.numbers);
        let measured = self.courses.iter().flat_map(|course| &course.count);
        let (mut squares, mut count, mut weighted, mut used) = (0.0, 0.0, 0.0, 0.0);
        for (((residual, weight), out), measured) in residuals
            .iter()
            .zip(all.weights)
            .zip(held_out)
            .zip(measured)
        {
            if !out || *measured == 0.0 {
                continue;
            }
            squares += residual * residual;
            count += 1.0;
            if *weight > 0.0 {
                weighted += weight * residual * residual;
                used += 1.0;
            }
        }
        (
            (squares / f64::max(count, 1.0)).sqrt(),
            (weighted / f64::max(used, 1.0)).sqrt(),
        )
    }
}

/// Depths (m) of a fit along the courses, log after log.
pub(in crate::gap) fn depths(fit: &Fit, courses: &[Course]) -> Vec<Vec<f64>> {
    courses
        .iter()
        .map(|course| {
            let mut depths = Vec::with_capacity(course.len());
            along(
                &fit.shape,
                &fit.numbers,
                course,
                |_, reading: estimator_core::physics::rig::Reading<f64>| {
                    depths.push(reading.touch.depth_m);
                },
            );
            depths
        })
        .collect()
}
