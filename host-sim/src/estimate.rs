//! The board's step over a log, and what it comes to.

mod baseline;
mod beginning;
mod damping;
mod drift;
mod evidence;
pub(crate) mod explain;
mod friction;
mod lateness;
mod low_pass;
pub mod outcome;
mod reason;
mod residual;
mod settling;
mod setup;
mod stiffening;
pub(crate) mod touches;

use std::ops::Range;

use estimator_core::estimate::{identify::method_info, method::Method};
use estimator_core::{Config, Status};

pub use baseline::undrifted;
use beginning::from_free_air;
pub(crate) use beginning::touched;
use damping::{is_negative, widen_by_counts, widen_by_low_pass};
use drift::Drift;

pub(crate) use evidence::RELAXES;
use evidence::{evidence, surface_late_m};
pub use explain::explain;
use friction::Friction;
pub(crate) use lateness::carrier;
pub use lateness::{Form, Lateness};
pub use low_pass::low_passed;
pub(crate) use low_pass::{delay_s, may_be_the_filter};
pub use outcome::Outcome;
pub use reason::{EXPLAINED, Evidence, NOISE_ALONE, Reason, judged};
pub(crate) use reason::{NEGATIVE_DAMPING, meaning, trust_in_words};
use residual::{Motions, times_the_errors};
pub use settling::settled;
pub use setup::{Choices, Setup, setup};
pub(crate) use stiffening::stiffening;

use crate::diagnostic::Diagnostic;
use crate::inspect::{Inspection, inspect};
use crate::log::{FEWEST_SAMPLES, UniformLog};
use crate::number::quantity;
use crate::replay::{Replay, decimated, replay};

/// What a simpler law may leave more than the best one and still be chosen: 2 %.
const SIMPLER_MARGIN: f64 = 1.02;
/// A log of more than twice this (s) is compared with the laws by its beginning: four laws over an hour take 15 s.
const BEGINNING_S: f64 = 300.0;
/// A method that is not trusted by itself is taken where the best of the others leaves so much more.
const WELL_ABOVE: f64 = 1.5;

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
    pub selection: Vec<Compared>,
    /// What a reader must know, a sentence each.
    pub notes: Vec<String>,
    /// What the status was judged by.
    pub evidence: Evidence,
    /// What the estimator saw, where that is not the log: means of one that was too fast for it, and one that begins in
    /// contact from its first free air on.
    pub seen: Option<UniformLog>,
}

impl Estimation {
    /// Whether the law explains the force to its noise, and no other one that was tried does so better.
    pub fn is_explained(&self) -> bool {
        self.evidence.misfit.is_some()
            && !self.evidence.is_unexplained()
            && !self.evidence.has_nearer_law
    }

    /// Takes whether the material was touched again before it had recovered, and judges again.
    pub fn take_dent(&mut self, is_dented: bool) {
        if !is_dented {
            return;
        }
        self.evidence.is_dented = true;
        let (status, reason) = judged(self.outcome.method_status, &self.evidence);
        (self.outcome.status, self.outcome.reason) = (status, reason);
        self.notes.push(
            "the material was touched again before it had recovered: the surface was deeper than a recursive method takes it to \
             be, and relaxation and damping are wrong by that. --method batch fits the dent; or leave the material alone for \
             longer between touches"
                .into(),
        );
    }

    /// Takes how late the force is against the position, and judges again.
    pub fn take_lateness(&mut self, late: Option<Lateness>) {
        let Some(late) = late else { return };
        self.evidence.lateness = late.reason().or(self.evidence.lateness);
        self.outcome.skew.get_or_insert(late.late_s);
        let (status, reason) = judged(self.outcome.method_status, &self.evidence);
        (self.outcome.status, self.outcome.reason) = (status, reason);
        let law = self.outcome.law.law();
        self.notes.extend(late.sentence(law));
    }

    /// The log that the records belong to, of the one that was given.
    pub fn log<'a>(&'a self, given: &'a UniformLog) -> &'a UniformLog {
        self.seen.as_ref().unwrap_or(given)
    }
}

/// A law that was tried by a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Name of the law.
    pub law: &'static str,
    /// The method; a law has several.
    pub method: Method,
    /// What it leaves (N rms); `None` where it cannot be determined.
    pub force_rmse_n: Option<f64>,
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
    let begun = from_free_air(log);
    let begins_in_contact = begun.is_some();
    let seen = decimated(begun.as_ref().unwrap_or(log)).or(begun);
    let log = seen.as_ref().unwrap_or(log);
    let mut estimation = match by_its_beginning(log, base, methods, choices)? {
        Some(estimation) => estimation,
        None => compared(log, base, methods, choices)?,
    };
    estimation.evidence.has_no_zero |= begins_in_contact;
    estimation.seen = seen;
    Ok(estimation)
}

/// Chooses the law of a long log by its beginning, and runs that law alone over all of it; `None` where the
/// beginning decides nothing, or what it decides does not explain the rest.
fn by_its_beginning(
    log: &UniformLog,
    base: Config,
    methods: &[Method],
    choices: Choices,
) -> Result<Option<Estimation>, Diagnostic> {
    let beginning = (BEGINNING_S * log.rate_hz) as usize;
    if methods.len() < 2 || log.len() < 2 * beginning {
        return Ok(None);
    }
    let Ok(begun) = compared(&log.first(beginning), base, methods, choices) else {
        return Ok(None);
    };
    if begun.outcome.touches.is_empty() || !begun.is_explained() {
        return Ok(None);
    }
    let method = begun.replay.config.method;
    let selection = begun.selection;
    drop(begun.replay);
    let mut whole = compared(log, base, &[method], choices)?;
    if !whole.is_explained() {
        return Ok(None);
    }
    whole.selection = selection;
    whole.notes.push(format!(
        "the log is long: the laws were compared over its first {}, and the best of them was run over all of it",
        quantity(BEGINNING_S, 3, "s")
    ));
    Ok(Some(whole))
}

/// Runs every method over the whole log and keeps the best.
fn compared(
    log: &UniformLog,
    base: Config,
    methods: &[Method],
    choices: Choices,
) -> Result<Estimation, Diagnostic> {
    let motions = Motions::of(log);
    let touched = touched(log);
    let mut best: Option<(Replay, Outcome, Vec<String>)> = None;
    let (mut selection, mut rmses_n) = (Vec::new(), Vec::new());
    for method in methods {
        let Setup { config, notes } = setup(log, base, *method, choices);
        let replay = replayed(log, &config, touched.clone())?;
        long_enough(log, &replay)?;
        let outcome = Outcome::along(log, &replay, &motions);
        selection.push(Compared {
            law: outcome.law.name(),
            method: *method,
            force_rmse_n: outcome.force_rmse_n,
        });
        rmses_n.push(outcome.whole_log_rmse_n);
        let is_better = best.as_ref().is_none_or(|(before, kept, _)| {
            let kept = Residual::of(before, kept);
            let margin = match is_trusted(&outcome, *method, methods) {
                true => SIMPLER_MARGIN,
                false => WELL_ABOVE,
            };
            Residual::of(&replay, &outcome).is_below(&kept, margin)
        });
        if is_better {
            best = Some((replay, outcome, notes));
        }
    }
    let best = best.ok_or_else(|| Diagnostic::new("no method to try"))?;
    Ok(with_evidence(log, best, selection, &rmses_n))
}

/// The best of the methods, judged by what the log says for and against it.
fn with_evidence(
    log: &UniformLog,
    (replay, mut outcome, mut notes): (Replay, Outcome, Vec<String>),
    selection: Vec<Compared>,
    rmses_n: &[Option<f64>],
) -> Estimation {
    let inspection = inspect(log, &replay, &outcome.touches);
    let mut evidence = evidence(log, &replay, &outcome, &inspection, rmses_n);
    let friction = Friction::of(log, &replay, &outcome);
    // What opposes the motion is no drift where the first way goes in and the last comes out.
    let drift = match friction {
        Some(_) => None,
        None => Drift::of(log, &replay, &outcome),
    };
    evidence.drifts = drift.is_some();
    evidence.has_other_force = friction.is_some();
    if evidence.is_surface_doubtful {
        outcome.widen_one("surface", surface_late_m(log, &replay, &outcome));
    }
    notes.extend(widen_by_counts(log, &replay, &mut outcome));
    widen_by_low_pass(log, &mut outcome);
    if log.low_pass_hz.is_some() {
        // Its noise remembers, and a method takes it for white.
        outcome.widen(times_the_errors(log, &replay, &outcome.replayed_n).max(1.0));
    }
    (outcome.status, outcome.reason) = judged(outcome.method_status, &evidence);
    notes.extend(log.notes.iter().cloned());
    notes.extend(explain(log, &replay, &outcome, &inspection));
    notes.extend(drift.iter().map(Drift::sentence));
    notes.extend(friction.iter().map(Friction::sentence));
    notes.extend(is_negative(&outcome).then(|| NEGATIVE_DAMPING.into()));
    if evidence.is_unexplained() && !evidence.is_surface_doubtful && log.low_pass_hz.is_none() {
        // A damper that plays left 115 times the noise, and had a surface of 27 mm to 1.6 µm. What the surface's error
        // leaves is in all errors already.
        outcome.widen(times_the_errors(log, &replay, &outcome.replayed_n).max(1.0));
    }
    Estimation {
        replay,
        outcome,
        inspection,
        selection,
        notes,
        evidence,
        seen: None,
    }
}

/// The board's step over a log, with the touches that a log which begins in contact has ([`touched`]).
///
/// # Errors
/// The field of the configuration that cannot be used.
pub(crate) fn replayed(
    log: &UniformLog,
    config: &Config,
    touched: Option<Vec<Range<usize>>>,
) -> Result<Replay, Diagnostic> {
    let replay = replay(log, config).map_err(|error| {
        Diagnostic::new("the configuration cannot be used")
            .at_key(error.field)
            .value(error.value)
            .remedy(error.expected)
    })?;
    Ok(Replay { touched, ..replay })
}

/// What laws are compared by.
struct Residual {
    /// Over the material that the parameters stand for, in noises.
    misfit: f64,
    /// The same, and no less than noise leaves there.
    beyond_noise: f64,
    /// Over the whole log, and no less than noise leaves (N).
    whole_log_n: f64,
    /// Whether the material has changed, so that the two are of other stretches.
    has_changed: bool,
}

impl Residual {
    /// A law that leaves less than the noise of force and position would leave of it fits the noise: it counts as one
    /// that leaves that.
    fn of(replay: &Replay, outcome: &Outcome) -> Residual {
        let or_infinite = |rmse: Option<f64>| rmse.unwrap_or(f64::INFINITY);
        let rmse_n = or_infinite(outcome.force_rmse_n);
        Residual {
            misfit: rmse_n / outcome.noise_n,
            beyond_noise: rmse_n.max(outcome.allowed_n) / replay.noise_n,
            whole_log_n: or_infinite(outcome.whole_log_rmse_n).max(outcome.allowed_n),
            has_changed: outcome.whole_log_rmse_n != outcome.force_rmse_n,
        }
    }

    /// Whether this one is smaller by a margin. A law that explains the material that was touched last is
    /// better than one that does not, whatever was touched before. Of two that do not, whole logs decide
    /// unless both say that the material has changed: a false change leaves a stretch that any law fits.
    fn is_below(&self, kept: &Residual, margin: f64) -> bool {
        match (self.misfit <= EXPLAINED, kept.misfit <= EXPLAINED) {
            (true, true) => self.beyond_noise * margin < kept.beyond_noise,
            (false, false) if self.has_changed && kept.has_changed => {
                self.beyond_noise * margin < kept.beyond_noise
            }
            (false, false) => self.whole_log_n * margin < kept.whole_log_n,
            (explains, _) => explains,
        }
    }
}

/// Whether a method may be chosen for a little less. One over a history only once it has converged, unless
/// nothing else was asked for: on the hold of 1600 s of a foam, longer than its history, it never does.
fn is_trusted(outcome: &Outcome, method: Method, methods: &[Method]) -> bool {
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
