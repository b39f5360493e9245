//! The board's step over a log, and what it comes to.

pub(crate) mod explain;
pub mod outcome;
mod setup;

use estimator_core::estimate::{identify::method_info, method::Method};
use estimator_core::{Config, Status};

pub use explain::explain;
pub use outcome::Outcome;
pub use setup::{Choices, Setup, setup};

use crate::diagnostic::Diagnostic;
use crate::inspect::{Inspection, inspect};
use crate::log::{FEWEST_SAMPLES, UniformLog};
use crate::replay::{Replay, decimated, replay};

/// What a simpler law may leave more than the best one and still be chosen: 2 %.
const SIMPLER_MARGIN: f64 = 1.02;

/// An estimate of one log.
#[derive(Clone, Debug)]
pub struct Estimation {
    /// The replay of the law that was chosen.
    pub replay: Replay,
    /// What it comes to.
    pub outcome: Outcome,
    /// What is in the log.
    pub inspection: Inspection,
    /// Every law that was tried, with its RMSE (N).
    pub selection: Vec<(&'static str, Option<f64>)>,
    /// What a reader must know, a sentence each.
    pub notes: Vec<String>,
    /// The means that the estimator saw of a log that was too fast for it.
    pub decimated: Option<UniformLog>,
}

impl Estimation {
    /// The log that the records belong to, of the one that was given.
    pub fn log<'a>(&'a self, given: &'a UniformLog) -> &'a UniformLog {
        self.decimated.as_ref().unwrap_or(given)
    }
}

/// Estimates a log with each method and keeps the law that explains the force best; of two that do
/// so within 2 %, the simpler one.
///
/// # Errors
/// The field of the configuration that cannot be used.
pub fn estimate(
    log: &UniformLog,
    base: Config,
    methods: &[Method],
    choices: Choices,
) -> Result<Estimation, Diagnostic> {
    let decimated = decimated(log);
    let log = decimated.as_ref().unwrap_or(log);
    let mut best: Option<(Replay, Outcome, Vec<String>)> = None;
    let mut selection = Vec::new();
    for method in methods {
        let Setup { config, notes } = setup(log, base, *method, choices);
        let replay = replay(log, &config).map_err(|error| {
            Diagnostic::new("the configuration cannot be used")
                .at_key(error.field)
                .value(error.value)
                .remedy(error.expected)
        })?;
        long_enough(log, &replay)?;
        let outcome = Outcome::of(log, &replay);
        selection.push((outcome.law.name(), outcome.force_rmse_n));
        let rmse = outcome.force_rmse_n.unwrap_or(f64::INFINITY);
        let to_beat = best
            .as_ref()
            .map(|(_, kept, _)| kept.force_rmse_n.unwrap_or(f64::INFINITY));
        if trusted(&outcome, *method, methods)
            && to_beat.is_none_or(|kept| rmse * SIMPLER_MARGIN < kept)
        {
            best = Some((replay, outcome, notes));
        }
    }
    let (replay, outcome, mut notes) = best.ok_or_else(|| Diagnostic::new("no method to try"))?;
    let inspection = inspect(log, &replay, &outcome.touches);
    notes.extend(log.notes.iter().cloned());
    notes.extend(explain(log, &replay, &outcome, &inspection));
    Ok(Estimation {
        replay,
        outcome,
        inspection,
        selection,
        notes,
        decimated,
    })
}

/// Whether a method may be chosen. One over a history only once it has converged, unless nothing else
/// was asked for: on the hold of 1600 s of a foam, longer than its history, it never does, and leaves
/// 1.7 N where the whole log leaves 29 mN.
fn trusted(outcome: &Outcome, method: Method, methods: &[Method]) -> bool {
    let has_history = |method: &Method| method_info(*method).is_some_and(|info| info.has_history);
    !has_history(&method) || outcome.status == Status::Converged || methods.iter().all(has_history)
}

/// Without a window of the filter in contact and some free air before it nothing can be learned.
fn long_enough(log: &UniformLog, replay: &Replay) -> Result<(), Diagnostic> {
    let window = 2 * replay.delay + 1;
    if log.len() > window + FEWEST_SAMPLES {
        return Ok(());
    }
    Err(Diagnostic::new(format!(
        "the log has {} samples: the filter takes {window}, and free air at least {FEWEST_SAMPLES}",
        log.len()
    ))
    .in_file(&log.path)
    .value(log.len())
    .remedy("record longer: a touch at 1 kHz takes a few hundred samples"))
}
