//! What a log must hold before anything is fitted to it, and what looks wrong in it.
//!
//! The fits never fail: without a motion, a contact or enough samples they would still end in a
//! verdict. Such a log is refused; one that only looks wrong is fitted, with a note.

use crate::diagnostic::Diagnostic;
use crate::inspect::{exchanged, suspicions, suspicions_without_contact};
use crate::log::UniformLog;
use crate::model::Model;
use crate::number::quantity;
use crate::signal;

/// Fewest samples: the twelve windows of which every third is held out, each as wide as half of the
/// filter that finds the speed (15 samples) and one more.
const FEWEST: usize = 12 * 16;
/// A position that stays within so many standard deviations of its noise does not move: the range of
/// 10⁵ normal samples is 8.8 of them.
const STILL: f64 = 10.0;
/// The same of a force; a touch that does not stand out is none.
const SILENT: f64 = 12.0;

/// What looks wrong in a log, a sentence each.
///
/// # Errors
/// A log that nothing can be fitted to: too short, no motion, a force that never changes, columns
/// exchanged, or no contact where the model has one.
pub(in crate::gap) fn suspected(
    model: &Model,
    log: &UniformLog,
) -> Result<Vec<String>, Diagnostic> {
    let refuse =
        |what: String, remedy: &str| Err(Diagnostic::new(what).in_file(&log.path).remedy(remedy));
    if log.len() < FEWEST {
        return refuse(
            format!(
                "{} samples, fewer than {FEWEST}: a third of them must be held out",
                log.len()
            ),
            "record longer: free air, presses at several speeds and a hold take some seconds",
        );
    }
    let travel_m = signal::range(&log.position_m);
    if travel_m <= STILL * signal::noise(&log.position_m) {
        return refuse(
            format!(
                "the position never changes by more than its noise: {}",
                quantity(travel_m, 2, "m")
            ),
            "give the column that holds the position (--columns x=NAME), or record a motion",
        );
    }
    let span_n = signal::range(&log.force_n);
    if span_n == 0.0 {
        return refuse(
            format!(
                "the force is {} all the time",
                quantity(log.force_n[0], 3, "N")
            ),
            "give the column that holds the force (--columns f=NAME), or look whether the sensor is on",
        );
    }
    if model.environment.is_free() {
        return Ok(suspicions_without_contact(log));
    }
    if let Some(text) = exchanged(log) {
        return refuse(text, "give the columns as they are: --columns x=f_n,f=x_m");
    }
    if span_n <= SILENT * log.force_noise_n() {
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
