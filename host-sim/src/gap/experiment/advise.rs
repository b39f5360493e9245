//! What to do next: the advice of a finding, and the motion to record where one helps.

use estimator_core::physics::effect::{Bounds, EffectId};

use crate::gap::decide::decision::Decision;
use crate::gap::experiment::{
    design::ExperimentDesign, discriminability::Discriminability,
    discriminability::EffectSignature, excitations::Excitation, plan::FurtherMotion,
    recordings::Recordings,
};
use crate::gap::finding::{AdvisedMotion, Finding, MOTION, Region, Verdict, regions_in_words};
use crate::gap::model::{
    dataset::Dataset, fit::Fit, fit::RIDGE, shape::Owner, shape::Shape, shape::Term, start::repeats,
};
use crate::gap::search::relatives::are_late;
use crate::lsq::covariance::inverse;
use crate::stats::lowest;

/// What to do next, in a sentence or two, and the motion to do it with.
pub(crate) fn advice(
    finding: &Finding,
    dataset: &Dataset<'_>,
    decision: &Decision,
) -> (String, Option<AdvisedMotion>) {
    let faster = dataset.thresholds.advice.faster;
    let mut effects = finding.effects.iter();
    let ambiguous = effects.find(|effect| !effect.alternatives.is_empty());
    let text = match (finding.verdict, ambiguous) {
        (Verdict::Ambiguous, Some(effect)) => {
            // One motion at a time: what it leaves unobserved, the next run says.
            if let Some(advised) = discriminating_motion(dataset, decision) {
                return (record(&advised, finding, faster), Some(advised));
            }
            let gap = not_discriminated(effect.id, &effect.alternatives);
            format!("{gap} Record {}.", effect.id.info().motion)
        }
        _ => without_ambiguity(finding, dataset.thresholds.explained.residuals) + &steps(finding),
    };
    match observing_motion(dataset, &decision.best, &decision.std_errors) {
        Some(advised) => (
            format!("{text} {}", record(&advised, finding, faster)),
            Some(advised),
        ),
        None => (text, None),
    }
}

/// What to do with a finding that no motion has to disambiguate. What leaves less than `noise` times what is allowed is
/// explained to the noise as it was measured.
fn without_ambiguity(finding: &Finding, noise: f64) -> String {
    match finding.verdict {
        Verdict::NoMissingEffect if finding.ratio_before > noise => format!(
            "Nothing stands out: {:.2} times what noise and the motion's errors allow remains, which the noise may be, \
             since its slow part is hardly known from this log. A longer rest in free air would tell.",
            finding.ratio_before
        ),
        Verdict::NoMissingEffect => {
            "Nothing is missing: the base model explains this log to its noise.".into()
        }
        Verdict::Unexplained if finding.may_be_slow_noise() => {
            "What remains is little, and in no part of the log more than in others. The log shows no rest in free air, \
             from which slow noise of the force would be known: record a second of it before the motion, and ask again."
                .into()
        }
        Verdict::Unexplained if finding.nothing_new => {
            let words = match regions_in_words(&finding.remaining) {
                words if words.is_empty() => String::new(),
                words => format!(" ({words})"),
            };
            format!(
                "What remains{words} is about what the model left before, and as little explained: more than the name of \
                 a change the parameters do not bear."
            )
        }
        // A region may stand out without words, where it has hardly more than its share of the samples.
        Verdict::Unexplained => match regions_in_words(&finding.remaining) {
            words if words.is_empty() => {
                "Something remains that the catalogue does not explain, in no part of the log more than in \
                 others. Look at the residuals before trusting the parameters."
                    .into()
            }
            words => format!(
                "Something remains that the catalogue does not explain: {words}. Look at the residuals \
                 there before trusting the parameters."
            ),
        },
        Verdict::PartlyExplained => {
            let better = "model.toml is better than the base, but it does not explain everything: look at \
                          what remains before trusting its parameters.";
            match regions_in_words(&finding.remaining) {
                words if words.is_empty() => better.into(),
                words => format!("{better} Of it {}.", words.replace("of the excess ", "")),
            }
        }
        _ => format!(
            "Use model.toml: simulate with it, or hand it to estimate --compensate.{}",
            at_bounds(finding)
        ),
    }
}

/// What to do about a zero that steps; empty where none does.
fn steps(finding: &Finding) -> String {
    let step = finding.remaining.iter().find_map(Region::step);
    step.map_or_else(String::new, |(s, _)| {
        format!(
            " A force that is off from an instant on is a tare, a power cycle or a knock: ask again with the part of the \
             log before {s:.2} s, or with that after it."
        )
    })
}

/// Which numbers only say how far they were sought; empty where none does. What one of the law should be is in another
/// then: beside a damping of 0 a filter of second order was a lag of 3.0 ms for 5.8 ms.
fn at_bounds(finding: &Finding) -> String {
    let of_effects = finding.effects.iter().flat_map(|effect| {
        let numbers = effect.parameters.iter().filter(|number| number.at_bound);
        numbers.map(|number| format!("{} of {}", number.name, effect.id.name()))
    });
    let of_effects: Vec<String> = of_effects.collect();
    let of_base = finding.base_after.iter().filter(|number| number.at_bound);
    let of_base: Vec<&str> = of_base.map(|number| number.name.as_str()).collect();
    let mut said = String::new();
    if !of_effects.is_empty() {
        said += &format!(
            " At the end of the range in which it is sought, and no measurement, is the {}.",
            of_effects.join(", the ")
        );
    }
    if !of_base.is_empty() {
        said += &format!(
            " At the end of its range is the {}: what it should be is in other numbers.",
            of_base.join(", the ")
        );
    }
    said
}

/// A motion with what the log does not tell, and what both logs together should.
fn advised(further: FurtherMotion, gap: &str, gain: &str) -> AdvisedMotion {
    AdvisedMotion {
        motion: further.motion,
        words: further.words,
        purpose: format!("{gap} Both logs together {gain}."),
    }
}

fn record(advised: &AdvisedMotion, finding: &Finding, faster: f64) -> String {
    let times = advised.motion.limits().fastest_mps / finding.limits().fastest_mps;
    let caution = match times > faster {
        true => format!(" It goes {times:.0} times as fast as the log: check that the rig can."),
        false => String::new(),
    };
    format!(
        "{} Record {MOTION} ({}) and run gap with both logs, `--log OLD --log NEW`.{caution}",
        advised.purpose, advised.words
    )
}

fn not_discriminated(id: EffectId, rivals: &[EffectId]) -> String {
    let rivals: Vec<&str> = rivals.iter().map(|id| id.name()).collect();
    format!(
        "This log does not tell {} from {}.",
        id.name(),
        rivals.join(", ")
    )
}

/// The motion that tells the first ambiguous effect of a decision from its alternatives.
fn discriminating_motion(dataset: &Dataset<'_>, decision: &Decision) -> Option<AdvisedMotion> {
    let best = &decision.best;
    let added = best.added();
    let mut alternatives = decision.alternatives.iter();
    let at = alternatives.position(|ids| !ids.is_empty())?;
    let (number, rivals) = (*added.get(at)?, &decision.alternatives[at]);
    let target = best.shape.terms_at(&best.numbers).swap_remove(number);
    let (shape, numbers) = best.without(number, dataset.scales);
    let base = Fit {
        shape,
        numbers,
        cost: best.cost,
    };
    let decide = dataset.thresholds;
    let design = ExperimentDesign::new(dataset, &base);
    let sigma = |excitation: &Excitation| {
        let both = design.with(excitation, &base);
        let analysis = both.discriminability(&base.shape, &base.numbers, dataset.scales, decide);
        nearest_rival_sigma(&analysis, &target, rivals)
    };
    // The run with both logs asks that one is better throughout. Where no motion promises that, the best
    // of those that promise a difference is taken.
    let enough = decide.significance.chi2_of(rivals.len()).sqrt();
    let sure = match rivals.iter().any(|id| are_late(target.id, *id)) {
        true => decide.advice.sure,
        false => 1.0,
    };
    let further = design
        .best(sigma, sure * enough)
        .or_else(|| design.best(sigma, enough))?;
    let gain = format!(
        "should tell them apart by {:.0} standard deviations",
        further.sigma
    );
    Some(advised(
        further,
        &not_discriminated(target.id, rivals),
        &gain,
    ))
}

/// By how many standard deviations an effect differs from the nearest of its rivals.
fn nearest_rival_sigma(
    analysis: &Discriminability<'_>,
    target: &Term,
    rivals: &[EffectId],
) -> Option<f64> {
    let signature = analysis.signature(target.clone())?;
    let mut signatures: Vec<Vec<EffectSignature>> = analysis.signatures(rivals);
    // A rival that repeats also starts where the accepted effect does.
    for (id, starts) in rivals.iter().zip(&mut signatures) {
        if repeats(*id) && repeats(target.id) {
            let term = Term {
                id: *id,
                ..target.clone()
            };
            starts.extend(analysis.signature(term));
        }
    }
    let chi2 = signatures
        .iter()
        .map(|rival| analysis.discrimination_chi2(&signature, 1.0, rival));
    Some(lowest(chi2).sqrt()).filter(|sigma| sigma.is_finite())
}

/// The motion for the first number of a fit that the log does not observe, if a motion would help.
fn observing_motion(
    dataset: &Dataset<'_>,
    fit: &Fit,
    errors: &[Option<f64>],
) -> Option<AdvisedMotion> {
    let decide = &dataset.thresholds.advice;
    let at = (0..fit.numbers.len()).find(|at| {
        let value = fit.shape.natural(*at, fit.numbers[*at]).abs();
        has_size(&fit.shape, *at)
            && value > 0.0
            && errors[*at].is_some_and(|e| e > decide.unobserved * value)
    })?;
    let design = ExperimentDesign::new(dataset, fit);
    let before = relative_error(&design.recordings, fit, dataset, at)?;
    let sigma = |excitation: &Excitation| {
        let both = design.with(excitation, fit);
        Some(1.0 / relative_error(&both, fit, dataset, at)?)
    };
    let enough = f64::min(decide.better * before, decide.unobserved);
    let further = design.best(sigma, 1.0 / enough)?;
    let gap = format!("This log hardly observes the {}.", name(&fit.shape, at));
    let gain = format!(
        "should bring its standard error to {:.0} %",
        (100.0 / further.sigma).max(1.0)
    );
    Some(advised(further, &gap, &gain))
}

/// Whether the size of a number means something: it is no place, no phase and no angle.
fn has_size(shape: &Shape, at: usize) -> bool {
    match shape.free[at].owner {
        Owner::Environment(parameter) => shape.base.parameters()[parameter].name != "surface",
        Owner::Effect(number, parameter) => {
            let infos = shape.terms[number].id.info().parameters;
            infos
                .get(parameter)
                .is_some_and(|info| info.bounds != Bounds::Angle && info.default.is_none())
        }
    }
}

fn name(shape: &Shape, at: usize) -> String {
    match shape.free[at].owner {
        Owner::Environment(parameter) => shape.base.parameters()[parameter].name.clone(),
        Owner::Effect(number, parameter) => {
            let info = shape.terms[number].id.info();
            format!("{} of {}", info.parameters[parameter].name, info.name)
        }
    }
}

/// Standard error of a number as a share of it, if the noise is the only error.
fn relative_error(
    recordings: &Recordings,
    fit: &Fit,
    dataset: &Dataset<'_>,
    at: usize,
) -> Option<f64> {
    let analysis =
        recordings.discriminability(&fit.shape, &fit.numbers, dataset.scales, dataset.thresholds);
    let n = fit.numbers.len();
    let curvature = analysis.curvature();
    let unseen: Vec<bool> = (0..n).map(|i| curvature[i * n + i] <= 0.0).collect();
    let variance = inverse(&curvature, &unseen, RIDGE)?[at * n + at];
    let scale = match fit.shape.free[at].logarithmic {
        true => 1.0,
        false => fit.shape.natural(at, fit.numbers[at]).abs(),
    };
    Some(variance.sqrt() / scale).filter(|share| share.is_finite() && *share > 0.0)
}
