//! What a log must hold before anything is fitted to it, and what looks wrong in it.
//!
//! A fit does not fail by itself: without a motion, a contact or enough samples it would still end in a
//! verdict. Such a log is refused here. A log that only looks wrong is fitted, and the finding says why it
//! looks wrong.

use crate::diagnostic::Diagnostic;
use crate::gap::thresholds::Input;
use crate::inspect::{exchanged, suspicions, suspicions_without_contact};
use crate::log::{Channel, UniformLog};
use crate::model::Model;
use crate::number::{quantity, setting};
use crate::signal;
use crate::stats::range;

/// No probe travels farther (m): millimetres of a palpation, read as metres, are less.
const FARTHEST_M: f64 = 100.0;

/// Describes what looks wrong in a log, a sentence for each suspicion.
///
/// # Errors
/// A log that nothing can be fitted to: it is too short, it has no motion, its force never changes, its
/// columns are exchanged, or it has no contact although the model has one.
pub(crate) fn suspected(
    model: &Model,
    log: &UniformLog,
    decide: &Input,
) -> Result<Vec<String>, Diagnostic> {
    let refuse =
        |what: String, remedy: &str| Err(Diagnostic::new(what).in_file(&log.path).remedy(remedy));
    if let Some((what, remedy)) = unusable(log, decide) {
        return refuse(what, remedy);
    }
    if model.environment.is_free() {
        return Ok(suspicions_without_contact(log));
    }
    if let Some(text) = exchanged(log) {
        let columns = log.columns();
        let mut remedy = format!("give the columns as they are: {}", columns.exchanged());
        if range(&log.position_m) > FARTHEST_M {
            let micrometres = columns.option(&[(Channel::Position, 1e-6)]);
            remedy = format!(
                "{remedy}; or the position in its unit, if it is in micrometres: {micrometres}"
            );
        }
        return refuse(text, &remedy);
    }
    let span_n = range(&log.force_n);
    if span_n <= decide.silent_sigmas * log.force_noise_n() {
        return refuse(
            format!(
                "the force never leaves its noise ({}): nothing is touched",
                quantity(span_n, 2, "N")
            ),
            "record presses into the material, or give a base model with law = \"free\" for a motion in air",
        );
    }
    Ok(suspicions(log))
}

/// Refuses a low-pass that a log is too slow or too short for.
///
/// # Errors
/// The log, and up to or from which frequency (Hz) on it goes.
pub(crate) fn can_be_filtered(
    logs: &[UniformLog],
    bandwidth_hz: Option<f64>,
    decide: &Input,
) -> Result<(), Diagnostic> {
    let Some(hz) = bandwidth_hz else {
        return Ok(());
    };
    let refused = |log: &UniformLog, what: String, limit: String| {
        Diagnostic::new(what)
            .in_file(&log.path)
            .at_key("bandwidth")
            .value(hz)
            .remedy(format!("give {limit}, or no --bandwidth"))
    };
    for log in logs {
        let fastest_hz = 0.5 * log.rate_hz;
        // Two values a cycle are all that passes.
        let duration_s = log.period_s() * log.len() as f64;
        let values = 2.0 * hz * duration_s;
        if hz >= fastest_hz {
            let what = "a low-pass above half the rate of a log takes nothing away".into();
            return Err(refused(log, what, format!("less than {fastest_hz} Hz")));
        }
        if values < decide.fewest_values {
            let what = format!(
                "behind this low-pass {} hold {:.0} independent values, fewer than {}",
                setting(duration_s, "s"),
                values.floor(),
                decide.fewest_values
            );
            let slowest = setting(decide.fewest_values / (2.0 * duration_s), "Hz");
            return Err(refused(log, what, format!("more than {slowest}")));
        }
    }
    Ok(())
}

/// Why no model at all can be fitted to a log, and what to do about it.
fn unusable(log: &UniformLog, decide: &Input) -> Option<(String, &'static str)> {
    let travel_m = range(&log.position_m);
    if (log.len() as f64) < decide.fewest_samples {
        Some((
            format!(
                "{} samples, fewer than {}: a third of them must be held out",
                log.len(),
                decide.fewest_samples
            ),
            "record longer: free air, presses at several speeds and a hold take some seconds",
        ))
    } else if travel_m <= decide.still_sigmas * signal::noise(&log.position_m) {
        let travel = quantity(travel_m, 2, "m");
        Some((
            format!("the position never changes by more than its noise: {travel}"),
            "give the column that holds the position (--columns x=NAME), or record a motion",
        ))
    } else if range(&log.force_n) == 0.0 {
        let force = quantity(log.force_n[0], 3, "N");
        Some((
            format!("the force is {force} all the time"),
            "give the column that holds the force (--columns f=NAME), or look whether the sensor is on",
        ))
    } else {
        None
    }
}
