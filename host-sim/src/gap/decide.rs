//! From a search's result to an answer: everything refitted at the log's own rate, held-out parts
//! judged, uncertain names dropped, rivals counted.
//!
//! The log is cut into twelve windows; every third is held out. A fit to the others predicts them:
//! the states (relaxation, play) run through all windows, only the residuals are left out.

use estimator_core::effect::EffectId;
use rayon::prelude::*;

use super::attenuation::corrected;
use super::course::{Course, Scales};
use super::error::std_errors;
use super::fit::{Fit, Problem, along};
use super::floor::Floor;
use super::low_pass::LowPass;
use super::result::{Tried, Verdict};
use super::search::{Found, added};
use super::shape::Owner;
use super::weights::{variances, weights};

/// Windows of a log, of which every third is held out.
const WINDOWS: usize = 12;
/// Held-out residuals within this of what is allowed: explained. Errors of form, of the motion
/// between samples, and of the floor itself are below.
const ADEQUATE: f64 = 1.12;
/// A base model within this explains a log in which nothing more is found.
const NOTHING_LEFT: f64 = 1.08;
/// How much further both go where the noise is coloured: a rest of a second does not say what it does
/// in ten (of 64 floors of pink noise the lowest was 0.82 of the truth); or so many standard errors of the
/// floor, if that is more.
const COLOURED: f64 = 1.25;
pub(super) const FLOOR_ERRORS: f64 = 3.0;
/// Share of the base's excess that names must explain together to stand where something is left.
const CERTAIN: f64 = 0.95;
/// Or they stand if they leave at most this share of the excess, and any other set as large at least
/// so many times as much: 3.1 for the nearest effect to a crackling that is in no catalogue, 4.7 for a
/// soft limit.
const AHEAD_LEFT: f64 = 0.25;
const AHEAD: f64 = 4.0;
/// Rivals whose Σ w r² is within so many independent standard errors squared are not told apart.
const APART: f64 = 12.0;

/// Of what is left, the share that an effect must take off at least where much is left.
const IDLE: f64 = 0.01;
/// Standard errors that the size of an effect must be, to be one.
const KNOWN: f64 = 3.0;
/// Stretches of the logs for [`Evidence::is_worse_throughout`], and the standard errors it asks for.
const STRETCHES: usize = 48;
const SURE: f64 = 2.0;
/// A share of Σ w r² that no such errors make: 6.6 % and more for a lag that was one, mostly in the
/// fastest of 48 stretches.
const LATE: f64 = 0.05;

/// A judged answer.
pub(super) struct Decision {
    pub(super) verdict: Verdict,
    /// Fits to the whole log.
    pub(super) base: Fit,
    pub(super) best: Fit,
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

/// Σ w r² within which two fits are not told apart.
fn apart(best: &Fit, count: f64, correlation: f64) -> f64 {
    APART * correlation * (best.cost / count).max(1.0)
}

/// An effect whose size may as well be 0, if nothing else could stand in its place: of 810 names that were
/// right one was that badly known, of 36 wrong ones ten.
fn unsized_effect(decision: &Decision) -> Option<usize> {
    let Decision {
        best, std_errors, ..
    } = decision;
    let is_known = |number: usize| {
        let owner = Owner::Effect(number, 0);
        let at = best.shape.free.iter().position(|own| own.owner == owner);
        at.and_then(|at| Some((best.shape.natural(at, best.numbers[at]), std_errors[at]?)))
            .is_none_or(|(size, error)| size.abs() >= KNOWN * error)
    };
    // Modes of one spectrum share theirs, and no name hangs on one of them.
    let is_one = |number: usize| {
        let id = best.shape.terms[number].id;
        best.shape.terms.iter().filter(|own| own.id == id).count() == 1
    };
    let mut each = best.added().into_iter().zip(&decision.alternatives);
    each.position(|(number, others)| others.is_empty() && is_one(number) && !is_known(number))
}

/// The fit without an effect that takes nothing off.
fn idle(decision: &Decision) -> Option<&Fit> {
    let count = decision.variances.iter().filter(|v| **v > 0.0).count() as f64;
    let cost = decision.best.cost;
    let most = cost + apart(&decision.best, count, decision.correlation).min(IDLE * cost);
    let least = decision.without.iter();
    least
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .filter(|fit| fit.cost < most)
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
        loop {
            let decision = self.judge(base, &found);
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
            let excess = |ratio: f64| (ratio * ratio - 1.0).max(0.0);
            let explained = 1.0 - excess(decision.ratio.1) / excess(decision.ratio.0).max(1e-12);
            let certain = decision.alternatives.iter().all(Vec::is_empty);
            let stands = explained >= CERTAIN || is_ahead(&added(&found.best), tried);
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
        let correlation = crate::batch::error::correlation(&residuals);
        let alternatives = self.alternatives(&all, &best, found, correlation);
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

    /// Whether a rival is worse in most of the log and not by a few stretches of it: Vuong's test of
    /// two models of which none holds the other, on sums over stretches, so that errors which last
    /// (steps of the force channel, a touch) count once each. A delay of 4.5 ms under a sine of 0.2 Hz
    /// was worse than a lag by 80, 0.7 standard errors of that sum.
    fn is_worse_throughout(&self, all: &Problem<'_>, best: &Fit, rival: &Fit) -> bool {
        let squares = |fit: &Fit| -> Vec<f64> {
            let residuals = all.residuals(&fit.shape, &fit.numbers);
            let each = residuals.iter().zip(all.weights);
            each.map(|(r, w)| w * r * r).collect()
        };
        let each = squares(rival).into_iter().zip(squares(best));
        let more: Vec<f64> = each.map(|(rival, best)| rival - best).collect();
        let stretches = more.chunks(more.len().div_ceil(STRETCHES).max(1));
        let sums: Vec<f64> = stretches.map(|own| own.iter().sum()).collect();
        let spread = sums.iter().map(|own| own * own).sum::<f64>().sqrt();
        sums.iter().sum::<f64>() > SURE * spread
    }

    /// For every added effect the ids that fit as well in its place.
    fn alternatives(
        &self,
        all: &Problem<'_>,
        best: &Fit,
        found: &Found,
        correlation: f64,
    ) -> Vec<Vec<EffectId>> {
        let ids = added(best);
        let count = all.weights.iter().filter(|w| **w > 0.0).count() as f64;
        let apart = apart(best, count, correlation);
        // At the search's coarse resolution a rival may be further off than at this one: a compliance that
        // follows in 2 ms, seen every 4, by 14 %.
        let coarse = found.best.cost;
        let close: Vec<&Fit> = found
            .rivals
            .iter()
            .flatten()
            .filter(|fit| fit.cost < coarse * 1.20 + apart)
            .collect();
        let refitted: Vec<Fit> = close
            .into_par_iter()
            .map(|fit| all.walk(&fit.shape, fit.numbers.clone(), 30))
            .collect();
        best.added()
            .into_iter()
            .map(|at| {
                let own = best.shape.terms[at].id;
                let mut alternatives = Vec::new();
                for fit in &refitted {
                    let others = added(fit);
                    let Some(other) = replaced(&ids, &others, own) else {
                        continue;
                    };
                    let more = fit.cost - best.cost;
                    let open = are_late(own, other)
                        && more < LATE * best.cost
                        && !self.is_worse_throughout(all, best, fit);
                    if (more < apart || open)
                        && !related(own, other)
                        && !alternatives.contains(&other)
                    {
                        alternatives.push(other);
                    }
                }
                alternatives
            })
            .collect()
    }
}

/// Whether both only make the force late: in slow motion they differ by less than a rig errs.
pub(super) fn are_late(one: EffectId, other: EffectId) -> bool {
    use EffectId as E;
    matches!(
        (one, other),
        (E::ForceLag, E::TimeDelay) | (E::TimeDelay, E::ForceLag)
    )
}

/// Whether a set of effects that leaves something explains most of the excess, and every other set as
/// large leaves several times as much: the form of one of them is another than the catalogue's.
fn is_ahead(ids: &[EffectId], tried: &[Tried]) -> bool {
    let excess = |own: &Tried| (own.ratio * own.ratio - 1.0).max(0.0);
    let of = |ids: &[EffectId]| tried.iter().find(|own| own.ids == ids).map(excess);
    let (Some(base), Some(left)) = (of(&[]), of(ids)) else {
        return false;
    };
    let others = tried
        .iter()
        .filter(|own| own.ids.len() == ids.len() && own.ids != ids)
        .filter(|own| !own.ids.iter().zip(ids).all(|(a, b)| related(*a, *b)));
    let next = others.map(excess).fold(base, f64::min);
    left <= AHEAD_LEFT * base && next >= AHEAD * left
}

/// The id that stands in `others` where `own` stands in `ids`, if all else is the same.
fn replaced(ids: &[EffectId], others: &[EffectId], own: EffectId) -> Option<EffectId> {
    let mut rest = others.to_vec();
    for id in ids.iter().filter(|id| **id != own) {
        let at = rest.iter().position(|other| other == id)?;
        rest.remove(at);
    }
    match rest[..] {
        [other] if other != own => Some(other),
        _ => None,
    }
}

/// Whether one is a special case of the other: no ambiguity, the simpler one wins where it is adequate.
pub(super) fn related(one: EffectId, other: EffectId) -> bool {
    use EffectId as E;
    let family = |id: EffectId| match id {
        E::CoulombFriction | E::StribeckFriction => 1,
        E::ViscousDrag | E::AsymmetricDrag => 2,
        E::ForceOffset | E::ForceDrift => 3,
        _ => 0,
    };
    one == other || (family(one) != 0 && family(one) == family(other))
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
                |_, reading: estimator_core::rig::Reading<f64>| {
                    depths.push(reading.touch.depth_m);
                },
            );
            depths
        })
        .collect()
}
