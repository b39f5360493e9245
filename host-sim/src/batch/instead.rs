//! The fit of the whole log where no recursion explains it.

use estimator_core::{Config, Status};

use super::{batch, lateness::is_late_instead, options::Options, result::Batch};
use crate::diagnostic::Diagnostic;
use crate::estimate::{Estimation, Reason, explain::times};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::number::quantity;

/// A fit that leaves up to so many times the noise explains a force for which a lateness would do as well. With
/// [`crate::estimate::EXPLAINED`] a gel whose force came 10 ms late had 26.1 ± 1.6 N s/m for 36, at 1.9 times the noise.
const NEARLY_NOISE: f64 = 1.5;

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
    let touches = !estimation.outcome.touches.is_empty();
    let is_late = touches && is_late_instead(log, estimation);
    let is_dented = estimation.evidence.is_dented;
    let has_no_zero = estimation.evidence.has_no_zero;
    let is_answered = estimation.is_explained() && !is_late && !is_dented && !has_no_zero;
    if is_answered && !is_doubted(estimation) || !touches {
        return Ok(None);
    }
    let mut fitted = batch(log, base, options)?;
    if is_answered && fitted.status != Status::Converged {
        return Ok(None);
    }
    let most_n = NEARLY_NOISE * fitted.noise_n;
    let explains = fitted.force_rmse_n.is_some_and(|left| left <= most_n);
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
    let remembers = has_no_zero && estimation.outcome.law.law().info().relaxes;
    // Beside noise that is slower than a sample a recursion that follows the resting force leaves less.
    let settles = fitted.status == Status::Converged && !estimation.is_explained();
    // And what it leaves more than the noise of a sample may be hum, which a fit measures at rest.
    let is_better = is_less || is_answered || explains && (remembers || settles);
    if !is_better {
        return Ok(None);
    }
    fitted
        .notes
        .insert(0, instead_in_words(estimation, is_late));
    Ok(Some(fitted))
}

/// Whether a law that leaves little is doubted for what it leaves, which a fit of the whole log may not leave: 1.8 times the
/// noise of 1/f beside hum, with 997 ± 5 N/m that 999.0 ± 0.5 explain.
fn is_doubted(estimation: &Estimation) -> bool {
    let outcome = &estimation.outcome;
    outcome.status == Status::ModelSuspect
        && matches!(
            outcome.reason,
            Some(Reason::Residual | Reason::Law | Reason::Relaxing)
        )
}

/// Why the numbers are those of a fit of the whole log, and not of the recursion that was estimated with.
fn instead_in_words(estimation: &Estimation, is_late: bool) -> String {
    let law = law_title(estimation.outcome.law.name());
    let left = match estimation.outcome.force_rmse_n {
        Some(left) => format!(
            "{law}, the best of them, leaves {}, {} the noise",
            quantity(left, 3, "N"),
            times(left / estimation.replay.noise_n)
        ),
        None => "none determines all its parameters".into(),
    };
    let why = match estimation.evidence.has_nearer_law {
        _ if estimation.evidence.has_no_zero => {
            "no free air at the start shows a recursive method the resting force ("
        }
        _ if estimation.evidence.is_dented => {
            "no recursive method knows a dent that has not recovered ("
        }
        _ if is_late => "a late force explains more than the relaxation of a recursive method (",
        _ if estimation.is_explained() && is_doubted(estimation) => {
            "a recursive method leaves more than a fit of the whole log (of those that there are, "
        }
        true => {
            "the best recursive method has not converged on the law that leaves least (of those that have, "
        }
        false => "no recursive method explains this force (",
    };
    format!(
        "{why}{left}): these are the numbers of a fit of the whole log at once (--method batch)"
    )
}
