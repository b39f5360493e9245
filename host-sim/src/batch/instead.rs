//! The fit of the whole log where no recursion explains it.

use estimator_core::estimate::Estimated;
use estimator_core::{Config, Status};

use super::{batch, lateness::is_late_instead, options::Options, result::Batch, result::Parameter};
use crate::diagnostic::Diagnostic;
use crate::estimate::{Estimation, Reason, explain::times};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::number::quantity;

/// A fit that leaves up to so many times the noise explains a force for which a lateness would do as well. With
/// [`crate::estimate::EXPLAINED`] a gel whose force came 10 ms late had 26.1 ± 1.6 N s/m for 36, at 1.9 times the noise.
const NEARLY_NOISE: f64 = 1.5;
/// A law that leaves so many times the noise of a sample explains it all the same, where the noise is slower. Beside 1/f
/// noise a recursion had λ 8.8 ± 0.3 and 11.0 ± 0.14 N s/m of 10; a fit of the whole log, which measures it at rest, 9.0 ± 1.5
/// and 10.95 ± 0.44.
const SLOW: f64 = 1.3;
/// A parameter is known well if its standard error is less than this share of it. Not measured.
const WELL_KNOWN: f64 = 0.2;

/// The fit of a whole log in place of an estimate whose law does not explain it; `None` where the estimate
/// stands: it explains the force, nothing is touched, or the fit leaves no less. Where it says by which lateness it
/// would explain the force, only a fit that does explain it is better.
///
/// # Errors
/// As [`batch`].
pub fn batch_instead(
    log: &UniformLog,
    base: Config,
    options: &Options,
    estimation: &Estimation,
) -> Result<Option<Batch>, Diagnostic> {
    let Some(cause) = cause(log, estimation) else {
        return Ok(None);
    };
    let mut fitted = batch(log, base, options)?;
    // An answer that stands gives way to one that is better founded only.
    let is_answered = matches!(
        cause,
        Cause::Doubted | Cause::LowPassed | Cause::SlowNoise | Cause::Changed | Cause::Unfinished
    );
    if is_answered && fitted.status != Status::Converged {
        return Ok(None);
    }
    let leaves_at_most = |times: f64| {
        let left_n = fitted.force_rmse_n;
        left_n.is_some_and(|left_n| left_n <= times * fitted.allowed_n)
    };
    let is_known = || fitted.parameters.iter().all(is_well_known);
    let is_refused = match cause {
        Cause::LowPassed | Cause::SlowNoise | Cause::Changed => !leaves_at_most(SLOW),
        Cause::Unfinished => !leaves_at_most(NEARLY_NOISE) || !is_known(),
        // A zero that wanders within the noise at rest is noise.
        Cause::Doubted if estimation.outcome.reason == Some(Reason::Zero) => {
            log.low_pass_hz.is_none() && fitted.noise_n < SLOW * estimation.replay.noise_n
        }
        _ => false,
    };
    if is_refused {
        return Ok(None);
    }
    let explains = leaves_at_most(NEARLY_NOISE);
    if estimation.evidence.lateness.is_some() && !explains {
        return Ok(None);
    }
    // After a change of material the recursion is right of what was touched last, and nobody of the whole.
    let before_n = estimation.outcome.force_rmse_n;
    // Where the estimate saw means, its noise is less than that of the samples that the fit sees.
    let averaged = estimation.seen.as_ref();
    let finer = averaged.map_or(1.0, |means| (log.rate_hz / means.rate_hz).sqrt());
    let is_less = match (fitted.force_rmse_n, before_n) {
        (Some(after), Some(before)) => after < before * finer,
        (after, _) => after.is_some(),
    };
    // What was before a log moves the law of a recursion that remembers: 1013 ± 3 N/m of 1000 at the noise.
    let remembers = estimation.evidence.has_no_zero && estimation.outcome.law.law().info().relaxes;
    // Beside noise that is slower than a sample a recursion that follows the resting force leaves less.
    let settles = fitted.status == Status::Converged && !estimation.is_explained();
    // And what it leaves more than the noise of a sample may be hum, which a fit measures at rest.
    let is_better = is_less || is_answered || explains && (remembers || settles);
    if !is_better {
        return Ok(None);
    }
    fitted.notes.insert(0, instead_in_words(estimation, cause));
    Ok(Some(fitted))
}

/// Why a fit of the whole log is asked.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cause {
    /// No free air at the start shows the resting force.
    NoZero,
    /// The material was touched again before it had recovered.
    Dent,
    /// A late force explains more than the relaxation that was found.
    Late,
    /// The best recursive method has not converged.
    Nearer,
    /// No recursive method explains the force.
    Unexplained,
    /// One explains it, and is doubted all the same.
    Doubted,
    /// One explains it, and the force went through a low-pass, which only a fit of the whole log knows.
    LowPassed,
    /// One explains it, and leaves more than the noise of a sample.
    SlowNoise,
    /// One explains it, as that of several materials.
    Changed,
    /// One explains it, and has seen too little of it to be sure.
    Unfinished,
}

/// `None` where the estimate stands, or nothing is touched.
fn cause(log: &UniformLog, estimation: &Estimation) -> Option<Cause> {
    let (outcome, evidence) = (&estimation.outcome, &estimation.evidence);
    if outcome.touches.is_empty() {
        return None;
    }
    let is_slow = evidence.misfit.is_some_and(|misfit| misfit > SLOW);
    Some(match () {
        () if evidence.has_no_zero => Cause::NoZero,
        () if evidence.is_dented => Cause::Dent,
        () if is_late_instead(log, estimation) => Cause::Late,
        () if !estimation.is_explained() && evidence.has_nearer_law => Cause::Nearer,
        () if !estimation.is_explained() => Cause::Unexplained,
        () if is_doubted(estimation) => Cause::Doubted,
        () if log.low_pass_hz.is_some() => Cause::LowPassed,
        () if outcome.status == Status::Converged && is_slow => Cause::SlowNoise,
        () if outcome.segments.len() > 1 => Cause::Changed,
        () if is_unfinished(estimation) => Cause::Unfinished,
        () => return None,
    })
}

/// Whether a recursion explains a force, and waits for more of it: of one touch nothing is seen twice. A fit of the whole log
/// was right on six of six of them.
fn is_unfinished(estimation: &Estimation) -> bool {
    let outcome = &estimation.outcome;
    outcome.status == Status::Converging
        && matches!(
            outcome.reason,
            Some(Reason::Excitation | Reason::Surface | Reason::Law)
        )
}

/// Whether a parameter is known well: a surface is a place, and is if it is known at all.
fn is_well_known(parameter: &Parameter) -> bool {
    let within = |own: Estimated<f64>| own.std_error < WELL_KNOWN * own.value.abs();
    parameter
        .estimate
        .is_some_and(|own| parameter.name == "surface" || within(own))
}

/// Whether a law that leaves little is doubted for what it leaves, which a fit of the whole log may not leave: 1.8 times the
/// noise of 1/f beside hum, with 997 ± 5 N/m that 999.0 ± 0.5 explain.
fn is_doubted(estimation: &Estimation) -> bool {
    let outcome = &estimation.outcome;
    outcome.status == Status::ModelSuspect
        && matches!(
            outcome.reason,
            Some(
                Reason::Residual
                    | Reason::Law
                    | Reason::Relaxing
                    | Reason::Surface
                    | Reason::Bound
                    | Reason::Zero
            )
        )
}

/// Why the numbers are those of a fit of the whole log, and not of the recursion that was estimated with.
fn instead_in_words(estimation: &Estimation, cause: Cause) -> String {
    let law = law_title(estimation.outcome.law.name());
    let left = match estimation.outcome.force_rmse_n {
        Some(left) => format!(
            "{law}, the best of them, leaves {}, {} the noise",
            quantity(left, 3, "N"),
            times(left / estimation.replay.noise_n)
        ),
        None => "none determines all its parameters".into(),
    };
    let why = match cause {
        Cause::NoZero => "no free air at the start shows a recursive method the resting force (",
        Cause::Dent => "no recursive method knows a dent that has not recovered (",
        Cause::Late => "a late force explains more than the relaxation of a recursive method (",
        Cause::Nearer => {
            "the best recursive method has not converged on the law that leaves least (of those that have, "
        }
        Cause::Unexplained => "no recursive method explains this force (",
        Cause::Doubted => {
            "a recursive method is doubted, and a fit of the whole log is not (of those that there are, "
        }
        Cause::Changed => {
            "one law explains the whole log, and the changes of material that a recursive method noticed are none (by itself "
        }
        Cause::Unfinished => {
            "a recursive method has seen too little to be sure, and a fit of the whole log knows every parameter (of those \
             that there are, "
        }
        Cause::LowPassed => {
            "the force went through a low-pass, which a recursive method does not know (without it "
        }
        Cause::SlowNoise => {
            "the noise is slower than a sample, and a recursive method's standard errors are too small beside it ("
        }
    };
    format!(
        "{why}{left}): these are the numbers of a fit of the whole log at once (--method batch)"
    )
}
