//! From a search's result to an answer: everything refitted at the log's own rate, held-out parts
//! judged, uncertain names dropped, rivals counted.
//!
//! The log is cut into twelve windows; every third is held out. A fit to the others predicts them:
//! the states (relaxation, play) run through all windows, only the residuals are left out.

use estimator_core::physics::effect::EffectId;
use rayon::prelude::*;

use super::attenuation::corrected;
use super::course::{Course, Scales};
use super::error::std_errors;
use super::fit::{Fit, Problem, along};
use super::floor::Floor;
use super::low_pass::LowPass;
use super::names::{idle, stand, unsized_effect};
use super::result::{Tried, Verdict};
use super::rivals::Rivals;
use super::search::Found;
use super::weights::{variances, weights};

/// Windows of a log, of which every third is held out.
const WINDOWS: usize = 12;
/// Held-out residuals within this of what is allowed: explained. Errors of form, of the motion
/// between samples, and of the floor itself are below.
pub(super) const ADEQUATE: f64 = 1.12;
/// A base model within this explains a log in which nothing more is found.
const NOTHING_LEFT: f64 = 1.08;
/// How much further both go where the noise is coloured: a rest of a second does not say what it does
/// in ten (of 64 floors of pink noise the lowest was 0.82 of the truth); or so many standard errors of the
/// floor, if that is more.
const COLOURED: f64 = 1.25;
pub(super) const FLOOR_ERRORS: f64 = 3.0;

/// A judged answer.
pub(super) struct Decision {
    pub(super) verdict: Verdict,
    /// Fits to the whole log.
    pub(super) base: Fit,
    pub(super) best: Fit,
    /// A rival that explains more, as the search left it.
    pub(super) better: Option<Fit>,
    /// Standard errors of `best`'s free numbers, in the parameters' units; None at a bound.
    pub(super) std_errors: Vec<Option<f64>>,
    /// For every added effect of `best`, in the order of its terms: who else could it be, and what
    /// the held-out part loses without it.
    pub(super) alternatives: Vec<Vec<EffectId>>,
    pub(super) gains: Vec<f64>,
    /// Fits with one added effect left out, for the regions where each matters.
    pub(super) without: Vec<Fit>,
    /// RMSE (N) of the raw force on the held-out part, before and after.
    pub(super) rmse_n: (f64, f64),
    /// Residuals over what is allowed, there.
    pub(super) ratio: (f64, f64),
    pub(super) variances: Vec<f64>,
    pub(super) held_out: Vec<bool>,
    pub(super) correlation: f64,
}

/// What deciding needs to know.
pub(super) struct Evidence<'a> {
    pub(super) courses: &'a [Course],
    pub(super) floors: &'a [Floor],
    pub(super) low_pass: Option<LowPass>,
    pub(super) scales: &'a Scales,
}

impl Evidence<'_> {
    fn problem<'a>(&'a self, weights: &'a [f64]) -> Problem<'a> {
        Problem {
            courses: self.courses,
            weights,
            low_pass: self.low_pass,
        }
    }

    /// `tried` are the sets of effects that were fitted.
    pub(super) fn decide(&self, base: &Fit, found: Found, tried: &[Tried]) -> Decision {
        let mut found = found;
        loop {
            let decision = self.corrected(self.decided(base, found, tried));
            match unsized_effect(&decision) {
                Some(at) => {
                    found = Found {
                        best: decision.without[at].clone(),
                        rivals: Vec::new(),
                    };
                }
                None => return decision,
            }
        }
    }

    /// Without what the errors of the motion do to the numbers, and how well they are known.
    fn corrected(&self, decision: Decision) -> Decision {
        let weights = weights(&decision.variances);
        let problem = self.problem(&weights);
        let best = corrected(&problem, &decision.best);
        Decision {
            std_errors: std_errors(&problem, &best),
            best,
            ..decision
        }
    }

    fn decided(&self, base: &Fit, found: Found, tried: &[Tried]) -> Decision {
        let mut found = found;
        let mut swapped = false;
        loop {
            let mut decision = self.judge(base, &found);
            // At one sample of four a compliance seemed worse than the delay that it is not. One swap, so
            // that two fits that get stuck in turn do not swap for ever.
            if let Some(better) = decision.better.take().filter(|_| !swapped) {
                found.rivals.push(vec![found.best]);
                found.best = better;
                swapped = true;
                continue;
            }
            // What seemed worth its price on the search's blocks, and takes nothing off at the log's own
            // rate, is none: a delay of 2 µs that moved a play's turn by a sample.
            if let Some(best) = idle(&decision) {
                found = Found {
                    best: best.clone(),
                    ..found
                };
                continue;
            }
            if decision.without.is_empty() || decision.verdict != Verdict::Unexplained {
                return decision;
            }
            let certain = decision.alternatives.iter().all(Vec::is_empty);
            let stands = stand(&decision, tried);
            if stands && certain {
                return decision;
            }
            // Names that leave much unexplained are no names; of those that explain most, the ones
            // that another name could replace are none.
            found = Found {
                best: if stands {
                    self.certain(&decision)
                } else {
                    base.clone()
                },
                rivals: Vec::new(),
            };
        }
    }

    /// The best fit without the effects that others could replace.
    fn certain(&self, decision: &Decision) -> Fit {
        let best = &decision.best;
        let own = best.added();
        let mut terms = best.shape.terms_at(&best.numbers);
        for (at, _) in own
            .iter()
            .zip(&decision.alternatives)
            .rev()
            .filter(|own| !own.1.is_empty())
        {
            terms.remove(*at);
        }
        let (shape, start) = best.with_terms(terms, self.scales);
        self.problem(&weights(&decision.variances))
            .fit(&shape, start)
    }

    fn judge(&self, base: &Fit, found: &Found) -> Decision {
        let low_pass = self.low_pass;
        let variances = variances(&found.best, self.courses, self.floors, low_pass);
        let all = weights(&variances);
        let held_out = self.held_out();
        let train: Vec<f64> = all
            .iter()
            .zip(&held_out)
            .map(|(w, out)| if *out { 0.0 } else { *w })
            .collect();
        let (all, train) = (self.problem(&all), self.problem(&train));
        let refit = |fit: &Fit| all.fit(&fit.shape, fit.numbers.clone());
        let (base, best) = rayon::join(|| refit(base), || refit(&found.best));
        let own = best.added();
        let without: Vec<Fit> = own
            .par_iter()
            .map(|at| {
                let (shape, start) = best.without(*at, self.scales);
                all.walk(&shape, start, 12)
            })
            .collect();
        let trained: Vec<Fit> = [&base, &best]
            .into_iter()
            .chain(&without)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|fit| train.walk(&fit.shape, fit.numbers.clone(), 8))
            .collect();
        let judged: Vec<(f64, f64)> = trained
            .par_iter()
            .map(|fit| self.held_out_error(&all, fit, &held_out))
            .collect();
        let residuals: Vec<f64> = all
            .residuals(&best.shape, &best.numbers)
            .iter()
            .zip(all.weights)
            .filter(|(_, w)| **w > 0.0)
            .map(|(r, w)| r * w.sqrt())
            .collect();
        let correlation = crate::stats::correlation(&residuals);
        let Rivals {
            alternatives,
            better,
        } = self.rivals(&all, &best, found, correlation);
        let (before, after) = (judged[0], judged[1]);
        let gains = judged[2..]
            .iter()
            .map(|own| 1.0 - (after.0 / own.0).powi(2))
            .collect();
        let named = !own.is_empty();
        // Hum in a band is no effect of the catalogue, and no line either: what rest shows of lines may
        // stay, once a periodic disturbance has not taken it.
        let lines = self
            .floors
            .iter()
            .map(|own| {
                1.0 + (own.lines_n / own.used_n.max(f64::MIN_POSITIVE))
                    .powi(2)
                    .min(1.0)
            })
            .fold(1.0, f64::max)
            .sqrt();
        let coloured = self.floors.iter().filter(|own| own.coloured);
        let uncertain = lines
            * coloured
                .map(|own| COLOURED.max(1.0 + FLOOR_ERRORS * own.uncertainty))
                .fold(1.0, f64::max);
        let limit = uncertain * if named { ADEQUATE } else { NOTHING_LEFT };
        let verdict = if after.1 > limit {
            Verdict::Unexplained
        } else if !named {
            Verdict::NoMissingEffect
        } else if alternatives.iter().any(|ids| !ids.is_empty()) {
            Verdict::Ambiguous
        } else {
            Verdict::MissingEffects
        };
        Decision {
            verdict,
            alternatives,
            gains,
            without,
            rmse_n: (before.0, after.0),
            ratio: (before.1, after.1),
            base,
            best,
            better,
            std_errors: Vec::new(),
            variances,
            held_out,
            correlation,
        }
    }

    fn held_out(&self) -> Vec<bool> {
        let mut held_out = Vec::new();
        for course in self.courses {
            let count = course.len();
            held_out.extend((0..count).map(|at| (at * WINDOWS / count) % 3 == 1));
        }
        held_out
    }

    /// RMSE (N) and weighted ratio of a fit on the held-out part.
    fn held_out_error(&self, all: &Problem<'_>, fit: &Fit, held_out: &[bool]) -> (f64, f64) {
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
pub(super) fn depths(fit: &Fit, courses: &[Course]) -> Vec<Vec<f64>> {
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
