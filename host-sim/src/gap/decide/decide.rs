//! From a search's result to an answer: everything refitted at the log's own rate, held-out parts
//! judged, uncertain names dropped, rivals counted.
//!
//! The log is cut into twelve windows; every third is held out. A fit to the others predicts them:
//! the states (relaxation, play) run through all windows, only the residuals are left out.

use super::evidence::{ADEQUATE, Decision, Evidence};
use crate::gap::noise::floor::FLOOR_ERRORS;
use rayon::prelude::*;

use crate::gap::decide::acceptance::{idle, stand, unsized_effect};
use crate::gap::decide::rivals::Rivals;
use crate::gap::finding::{Tried, Verdict};
use crate::gap::model::attenuation::corrected;
use crate::gap::model::error::std_errors;
use crate::gap::model::fit::Fit;
use crate::gap::model::weights::{variances, weights};
use crate::gap::search::search::Found;

/// A base model within this explains a log in which nothing more is found.
const NOTHING_LEFT: f64 = 1.08;
/// How much further both go where the noise is coloured: a rest of a second does not say what it does
/// in ten (of 64 floors of pink noise the lowest was 0.82 of the truth); or so many standard errors of the
/// floor, if that is more.
const COLOURED: f64 = 1.25;

impl Evidence<'_> {
    /// `tried` are the sets of effects that were fitted.
    pub(in crate::gap) fn decide(&self, base: &Fit, found: Found, tried: &[Tried]) -> Decision {
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
}
