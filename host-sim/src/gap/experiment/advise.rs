//! Which motion to record next: of the menu, the one that would tell most.
//!
//! Predicted on the log and the further motion together, with the fit's own numbers, as
//! [`super::apart`] predicts it.

use crate::gap::finding::MOTION;
use estimator_core::physics::effect::{Bounds, EffectId};
use rayon::prelude::*;

use crate::dense;
use crate::gap::data::fit_data::Course;
use crate::gap::decide::evidence::{Decision, Evidence};
use crate::gap::decide::rivals::are_late;
use crate::gap::experiment::discriminability::least;
use crate::gap::experiment::excitations::{Dish, Reach, menu};
use crate::gap::experiment::plan::{Further, Recorded, Sensor, best};
use crate::gap::finding::words;
use crate::gap::finding::{Advised, Finding, Verdict};
use crate::gap::model::fit::{Fit, forces};
use crate::gap::model::shape::{Owner, Shape, Term};
use crate::gap::model::start::repeats;

/// Samples of the log on the bench.
const SAMPLES: usize = 2_000;
/// A standard error beyond this share of its number: the log does not observe it.
const UNOBSERVED: f64 = 0.7;
/// A motion this many times as fast as the log is said to be faster.
const FASTER: f64 = 1.5;
/// The share of its own standard error that a further motion must leave at most, to be advised; and it
/// must observe the number.
const BETTER: f64 = 0.5;

/// How many times the standard deviations that count a motion must promise between a lag and a delay,
/// which errors of a rig that last imitate.
const SURE: f64 = 3.0;

/// Paces of the menu, in that of the log: a lag of 5 ms and a delay of 5 ms are the same at 0.2 Hz
/// and at three times that, whatever the motion. The slowest that tells is advised.
const PACES: [f64; 3] = [1.0, 4.0, 16.0];

/// The log thinned, and the menus for its rig, a pace each.
struct Next {
    recorded: Recorded,
    sensor: Sensor,
    menus: Vec<Vec<Dish>>,
}

impl Next {
    fn new(evidence: &Evidence<'_>, fit: &Fit) -> Next {
        let scales = evidence.scales;
        let samples: usize = evidence.courses.iter().map(Course::len).sum();
        let step = samples.div_ceil(SAMPLES);
        let courses: Vec<Course> = evidence
            .courses
            .iter()
            .map(|own| own.thinned(step))
            .collect();
        let sensor = Sensor {
            rate_hz: 1.0 / evidence.courses[0].period_s,
            // A count's error is evenly spread.
            position_step_m: scales.position_noise_m * 12.0_f64.sqrt(),
            noise_n: evidence.floors[0].used_n.max(f64::MIN_POSITIVE),
        };
        Next {
            recorded: Recorded {
                repeats: vec![step as f64; courses.len()],
                floors: evidence.floors.to_vec(),
                courses,
            },
            sensor,
            menus: PACES
                .iter()
                .map(|pace| menu(reach(evidence, fit, *pace)))
                .collect(),
        }
    }

    /// The log and a motion, the force on it that the fit predicts.
    fn with(&self, dish: &Dish, fit: &Fit) -> Recorded {
        let mut both = self.recorded.and(&dish.motion, self.sensor);
        if let Some(course) = both.courses.last_mut() {
            course.force_n = forces(&fit.shape, &fit.numbers, std::slice::from_ref(course));
        }
        both
    }

    fn best(
        &self,
        sigma: impl Fn(&Dish) -> Option<f64> + Copy + Sync + Send,
        least: f64,
    ) -> Option<Further> {
        self.menus.iter().find_map(|menu| {
            let each: Vec<Option<f64>> = menu.par_iter().map(sigma).collect();
            best(menu, |at| each[at], least)
        })
    }
}

/// As deep as the log went, and `pace` times as fast.
fn reach(evidence: &Evidence<'_>, fit: &Fit, pace: f64) -> Reach {
    let scales = evidence.scales;
    let touches = !fit.shape.base.is_free();
    let parameters = fit
        .shape
        .base
        .parameters()
        .into_iter()
        .zip(fit.shape.environment_at(&fit.numbers));
    let surface = parameters
        .filter(|(own, _)| own.name == "surface")
        .map(|(_, value)| value)
        .next();
    let surface_m = surface
        .filter(|_| touches)
        .unwrap_or(scales.deepest_m - 0.5 * scales.travel_m);
    let depth = scales.deepest_m - surface_m;
    let depth_m = if depth > 0.05 * scales.travel_m {
        depth
    } else {
        0.5 * scales.travel_m
    };
    // The palpation's fastest stroke is 7.2 depths in a stroke's time.
    let stroke_s = 7.2 * depth_m / (pace * scales.speed_mps).max(f64::MIN_POSITIVE);
    let period_s = evidence.courses[0].period_s;
    Reach {
        surface_m,
        touches,
        depth_m,
        stroke_s: stroke_s.clamp(100.0 * period_s, scales.duration_s.max(100.0 * period_s)),
    }
}

/// What to do next, in a sentence or two, and the motion to do it with.
pub(in crate::gap) fn advice(
    finding: &Finding,
    evidence: &Evidence<'_>,
    decision: &Decision,
) -> (String, Option<Advised>) {
    let ambiguous = finding
        .effects
        .iter()
        .find(|own| !own.alternatives.is_empty());
    let said = match (finding.verdict, ambiguous) {
        (Verdict::NoMissingEffect, _) => {
            "Nothing is missing: the base model explains this log to its noise.".into()
        }
        (Verdict::Ambiguous, Some(own)) => match between(evidence, decision) {
            // One motion at a time: what it leaves unobserved, the next run says.
            Some(advised) => return (record(&advised, finding), Some(advised)),
            None => format!(
                "{} Record {}.",
                not_told(own.id, &own.alternatives),
                own.id.info().motion,
            ),
        },
        (Verdict::Unexplained, _) if finding.remaining.is_empty() => {
            "Something is there that the catalogue does not explain, in no part of the log more than in \
             others. Look at the residuals before trusting the parameters."
                .into()
        }
        (Verdict::Unexplained, _) => format!(
            "Something is there that the catalogue does not explain: {}. Look at the residuals there \
             before trusting the parameters.",
            words(&finding.remaining)
        ),
        _ => "Use model.toml: simulate with it, or hand it to estimate --compensate.".into(),
    };
    match unobserved(evidence, &decision.best, &decision.std_errors) {
        Some(advised) => (
            format!("{said} {}", record(&advised, finding)),
            Some(advised),
        ),
        None => (said, None),
    }
}

/// A motion, with what the log does not tell and what both together should.
fn advised(further: Further, gap: &str, gain: &str) -> Advised {
    Advised {
        motion: further.motion,
        words: further.words,
        purpose: format!("{gap} Both logs together {gain}."),
    }
}

fn record(advised: &Advised, finding: &Finding) -> String {
    let times = advised.motion.limits().fastest_mps / finding.limits().fastest_mps;
    let caution = match times > FASTER {
        true => format!(" It goes {times:.0} times as fast as the log: check that the rig may."),
        false => String::new(),
    };
    format!(
        "{} Record {MOTION} ({}) and run gap with both logs, `--log OLD --log NEW`.{caution}",
        advised.purpose, advised.words
    )
}

fn not_told(id: EffectId, rivals: &[EffectId]) -> String {
    format!(
        "This log does not tell {} from {}.",
        id.name(),
        listed(rivals)
    )
}

fn listed(ids: &[EffectId]) -> String {
    ids.iter()
        .map(|id| id.name())
        .collect::<Vec<_>>()
        .join(", ")
}

/// What tells the effects of an ambiguous answer from their alternatives.
fn between(evidence: &Evidence<'_>, decision: &Decision) -> Option<Advised> {
    let best = &decision.best;
    let own = best.added();
    let at = decision
        .alternatives
        .iter()
        .position(|ids| !ids.is_empty())?;
    let (number, rivals) = (*own.get(at)?, &decision.alternatives[at]);
    let terms = best.shape.terms_at(&best.numbers);
    let target = terms[number].clone();
    let base = without(best, number, evidence);
    let next = Next::new(evidence, &base);
    let sigma = |dish: &Dish| {
        let both = next.with(dish, &base);
        let bench = both.bench(&base.shape, &base.numbers, evidence.scales);
        let presence = bench.presence(target.clone())?;
        let mut rivals_of = bench.presences(rivals);
        // What repeats starts where the accepted one does.
        for (id, starts) in rivals.iter().zip(&mut rivals_of) {
            if repeats(*id) && repeats(target.id) {
                starts.extend(bench.presence(Term {
                    id: *id,
                    ..target.clone()
                }));
            }
        }
        let apart = rivals_of
            .iter()
            .map(|starts| bench.apart(&presence, 1.0, starts));
        Some(apart.fold(f64::INFINITY, f64::min).sqrt()).filter(|sigma| sigma.is_finite())
    };
    // The run with both logs asks that one is better throughout; where no motion promises that, the
    // best of those that promise a difference.
    let enough = least(rivals.len()).sqrt();
    let sure = match rivals.iter().any(|id| are_late(target.id, *id)) {
        true => SURE,
        false => 1.0,
    };
    let further = next
        .best(sigma, sure * enough)
        .or_else(|| next.best(sigma, enough))?;
    let gain = format!(
        "should tell them apart by {:.0} standard deviations",
        further.sigma
    );
    Some(advised(further, &not_told(target.id, rivals), &gain))
}

/// A fit with one effect taken out, everything else as it stands.
fn without(fit: &Fit, number: usize, evidence: &Evidence<'_>) -> Fit {
    let (shape, numbers) = fit.without(number, evidence.scales);
    Fit {
        shape,
        numbers,
        cost: fit.cost,
    }
}

/// The first number of a fit whose standard error is more than 70 % of it, if a motion would help.
fn unobserved(evidence: &Evidence<'_>, fit: &Fit, errors: &[Option<f64>]) -> Option<Advised> {
    let at = (0..fit.numbers.len()).find(|at| {
        let value = fit.shape.natural(*at, fit.numbers[*at]).abs();
        has_size(&fit.shape, *at)
            && value > 0.0
            && errors[*at].is_some_and(|e| e > UNOBSERVED * value)
    })?;
    let next = Next::new(evidence, fit);
    let before = share(&next.recorded, fit, evidence, at)?;
    let sigma = |dish: &Dish| Some(1.0 / share(&next.with(dish, fit), fit, evidence, at)?);
    let enough = f64::min(BETTER * before, UNOBSERVED);
    let further = next.best(sigma, 1.0 / enough)?;
    let gap = format!("This log hardly observes the {}.", name(&fit.shape, at));
    let gain = format!(
        "should bring its standard error to {:.0} %",
        (100.0 / further.sigma).max(1.0)
    );
    Some(advised(further, &gap, &gain))
}

/// Whether a number's size means something: not a place, a phase or an angle.
fn has_size(shape: &Shape, at: usize) -> bool {
    match shape.free[at].owner {
        Owner::Environment(own) => shape.base.parameters()[own].name != "surface",
        Owner::Effect(number, own) => {
            let infos = shape.terms[number].id.info().parameters;
            infos
                .get(own)
                .is_some_and(|info| info.bounds != Bounds::Angle && info.default.is_none())
        }
    }
}

fn name(shape: &Shape, at: usize) -> String {
    match shape.free[at].owner {
        Owner::Environment(own) => shape.base.parameters()[own].name.clone(),
        Owner::Effect(number, own) => {
            let info = shape.terms[number].id.info();
            format!("{} of {}", info.parameters[own].name, info.name)
        }
    }
}

/// Standard error of a number as a share of it, if the noise is all there is.
fn share(recorded: &Recorded, fit: &Fit, evidence: &Evidence<'_>, at: usize) -> Option<f64> {
    let bench = recorded.bench(&fit.shape, &fit.numbers, evidence.scales);
    let n = fit.numbers.len();
    let curvature = bench.curvature();
    let size: Vec<f64> = (0..n)
        .map(|i| curvature[i * n + i].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let scaled: Vec<f64> = (0..n * n)
        .map(|k| {
            curvature[k] / (size[k / n] * size[k % n]) + if k % (n + 1) == 0 { 1e-12 } else { 0.0 }
        })
        .collect();
    let factor = dense::cholesky(&scaled, n)?;
    let mut unit = vec![0.0; n];
    unit[at] = 1.0;
    let variance = dense::solve(&factor, n, &unit)[at] / (size[at] * size[at]);
    let value = fit.shape.natural(at, fit.numbers[at]).abs();
    let scale = if fit.shape.free[at].logarithmic {
        1.0
    } else {
        value
    };
    Some(variance.sqrt() / scale).filter(|share| share.is_finite() && *share > 0.0)
}
