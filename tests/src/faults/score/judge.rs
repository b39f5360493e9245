//! Whether an answer is right.

use super::efficient::recovers;
use super::fit::{Fit, LAGS, fit};
use super::run::{Answer, Flag, JUDGED, Said, answer};
use crate::faults::rig::RATE_HZ;
use crate::faults::rig::case::Case;
use crate::tolerance::{CLOSE, STRICT};
use estimator_core::Status;

/// An estimate is wrong when a parameter is off by more than [`CLOSE`] and by so many of its standard
/// errors.
const SURE_ERRORS: f64 = 3.0;
/// An estimate that claims to have converged may be wrong for so long (s).
pub const ALLOWED_S: f64 = 0.05;
/// A recovery may take so long in contact (s).
const RECOVERY_S: f64 = 1.0;
/// The quantile of χ² with 20 degrees of freedom that white noise exceeds once in a thousand logs.
const WHITE: f64 = 45.3;
/// So many standard deviations a residual may be above the noise.
const LARGER: f64 = 3.0;

/// The offline fit of the faulty log is another law when a parameter differs from that of the honest log
/// by this share: half of what an estimate may be off.
const ANOTHER: f64 = CLOSE / 2.0;

/// A log that does not count: offline, the law fits it to its noise, with other parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unseeable {
    /// Those of K, λ and n over the honest log's, less one.
    pub shift: [f64; JUDGED],
}

/// Which logs are fitted offline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// All of them.
    Everywhere,
    /// Those whose estimate is wrong: the others cannot leave the count of wrong ones.
    WhereWrong,
}

/// What one log came to.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Why the log was refused.
    pub refused: Option<String>,
    /// The longest time of claiming to have converged while wrong (s).
    pub wrong_s: f64,
    /// When that began (s).
    pub wrong_from_s: f64,
    /// The largest error of what was claimed then, relative.
    pub wrong_by: f64,
    /// Why the log does not count.
    pub unseeable: Option<Unseeable>,
    /// The first remark, and how long after the fault (s).
    pub flag: Option<(Flag, f64)>,
    /// Changes of material that were reported.
    pub changes: usize,
    /// Length of the log (s).
    pub seconds: f64,
    /// Seconds in contact after a fault that passes, until all is within 5 % for good; infinite if never;
    /// `None` where nothing had to recover.
    pub recovered_s: Option<f64>,
    /// The probability that an efficient estimator recovers within [`RECOVERY_S`] where another material has to be
    /// learned.
    pub efficient: Option<f64>,
    /// The status at the end.
    pub status: Option<Status>,
    /// The largest error at the end, relative.
    pub error: f64,
    /// From the first touch until all is within 5 % for good (s).
    pub settled_s: f64,
}

impl Verdict {
    /// Whether the estimate claimed to have converged while wrong, for longer than is allowed.
    pub fn wrong(&self) -> bool {
        self.wrong_s > ALLOWED_S
    }

    /// Whether all was within 5 % for good soon enough after the fault.
    pub fn recovered_in_time(&self) -> bool {
        self.recovered_s.is_some_and(|s| s <= RECOVERY_S)
    }

    /// Whether that counts.
    pub fn wrong_and_seeable(&self) -> bool {
        self.wrong() && self.unseeable.is_none()
    }

    /// Whether all parameters are within 1 % at the end.
    pub fn strict(&self) -> bool {
        self.error < STRICT
    }
}

fn off(value: f64, std_error: f64, truth: f64) -> bool {
    let error = (value - truth).abs();
    error > CLOSE * truth && error > SURE_ERRORS * std_error
}

fn wrong(said: &Said, case: &Case) -> bool {
    let Some(parameters) = said.parameters.filter(|_| said.converged) else {
        return false;
    };
    let truth = case.truth_at(said.time_s, said.depth_m);
    let judged = parameters.iter().zip(truth);
    case.counts(said.time_s) && judged.into_iter().any(|((v, e), t)| off(*v, *e, t))
}

/// The largest relative error.
fn error(said: &Said, case: &Case) -> f64 {
    let Some(parameters) = said.parameters else {
        return f64::INFINITY;
    };
    let truth = case.truth_at(said.time_s, said.depth_m);
    let errors = parameters.iter().zip(truth).take(JUDGED);
    errors
        .map(|((value, _), truth)| (value / truth - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Judges one log.
pub fn judge(case: &Case, look: Look) -> Verdict {
    let seconds = case.depth_m.len() as f64 / RATE_HZ;
    let blank = Verdict {
        refused: None,
        wrong_s: 0.0,
        wrong_from_s: f64::NAN,
        wrong_by: 0.0,
        unseeable: None,
        flag: None,
        changes: 0,
        seconds,
        recovered_s: None,
        efficient: None,
        status: None,
        error: f64::INFINITY,
        settled_s: f64::INFINITY,
    };
    let answer = match answer(case) {
        Ok(answer) => answer,
        Err(message) => {
            return Verdict {
                refused: Some(message),
                ..blank
            };
        }
    };
    let (wrong_s, wrong_from_s, wrong_by) = longest_wrong(&answer.said, case);
    let fits = look == Look::Everywhere || wrong_s > ALLOWED_S;
    let close: Vec<bool> = answer
        .said
        .iter()
        .map(|said| error(said, case) < CLOSE)
        .collect();
    let recovered_s = recovered_s(&answer, &close, case);
    let is_another = recovered_s.is_some() && case.fault.meets;
    Verdict {
        wrong_s,
        wrong_from_s,
        wrong_by,
        unseeable: fits.then(|| unseeable(case)).flatten(),
        flag: flag(&answer, case),
        changes: answer.flags.iter().filter(|f| f.1 == Flag::Change).count(),
        recovered_s,
        efficient: is_another.then(|| recovers(case, passed_s(case), RECOVERY_S)),
        status: Some(answer.status),
        error: answer
            .said
            .last()
            .map_or(f64::INFINITY, |said| error(said, case)),
        settled_s: settled_s(&answer, &close, case),
        ..blank
    }
}

/// The longest stretch (s), when it began (s), and by how much it was wrong.
fn longest_wrong(said: &[Said], case: &Case) -> (f64, f64, f64) {
    let mut longest = (0.0, f64::NAN, 0.0);
    let mut began: Option<f64> = None;
    let mut worst = 0.0_f64;
    for one in said {
        if !wrong(one, case) {
            (began, worst) = (None, 0.0);
            continue;
        }
        let from_s = *began.get_or_insert(one.time_s);
        worst = worst.max(error(one, case));
        let lasted_s = one.time_s - from_s + case.period_s();
        if lasted_s > longest.0 {
            longest = (lasted_s, from_s, worst);
        }
    }
    longest
}

/// The first remark after the fault began, or after the force showed it.
fn flag(answer: &Answer, case: &Case) -> Option<(Flag, f64)> {
    let shown_s = case.plan.onset_s.max(match case.counts_from_s.is_finite() {
        true => case.counts_from_s,
        false => 0.0,
    });
    // A converter that stops and a span of samples begin between two samples.
    let first = answer
        .flags
        .iter()
        .find(|(t, _)| *t >= case.plan.onset_s - 2e-3);
    first.map(|(t, flag)| (*flag, (t - shown_s).max(0.0)))
}

/// The first sample from which on all is close; the number of samples if the end is not.
fn for_good(close: &[bool]) -> usize {
    close
        .iter()
        .rposition(|close| !close)
        .map_or(0, |last| last + 1)
}

fn settled_s(answer: &Answer, close: &[bool], case: &Case) -> f64 {
    let touch = case.depth_m.iter().position(|depth| *depth > 0.0);
    let settled = answer.said.get(for_good(close));
    match (touch, settled) {
        (Some(touch), Some(settled)) => settled.time_s - touch as f64 / RATE_HZ,
        _ => f64::INFINITY,
    }
}

fn recovered_s(answer: &Answer, close: &[bool], case: &Case) -> Option<f64> {
    if !case.fault.passes {
        return None;
    }
    let index = |t: f64| answer.said.partition_point(|said| said.time_s < t);
    // What had not been found before has nothing to recover to.
    let onset = index(case.plan.onset_s);
    if onset == 0 || !close[onset - 1] {
        return None;
    }
    let from = index(passed_s(case));
    if from >= close.len() {
        return None;
    }
    let good = for_good(close);
    if good >= close.len() {
        return Some(f64::INFINITY);
    }
    let contact = |said: &Said| {
        let at = (said.time_s.max(0.0) * RATE_HZ) as usize;
        case.depth_m.get(at).is_some_and(|depth| *depth > 0.0)
    };
    let waited = answer.said[from..good.max(from)]
        .iter()
        .filter(|said| contact(said));
    Some(waited.count() as f64 * case.period_s())
}

/// When the fault has passed and has shown itself (s).
fn passed_s(case: &Case) -> f64 {
    let end_s = case.plan.end_s.unwrap_or(case.plan.onset_s);
    match case.fault.meets {
        true => case.counts_from_s.max(end_s),
        false => end_s,
    }
}

/// Whether the log itself speaks for another law than the same palpation without the fault: it fits the
/// log offline to its noise. Where the fit of both is the same, an estimate has no excuse.
fn unseeable(case: &Case) -> Option<Unseeable> {
    let found = fit(&case.rows, case.stages[0].material.numbers, case.surface_m)?;
    let honest = honest_fit(case)?;
    let shift = |slot: usize| found.values[slot] / honest.values[slot] - 1.0;
    let shift: [f64; JUDGED] = std::array::from_fn(shift);
    // After a swap that is hardly used the fit is still that of the material before: right for most of
    // the log, and no excuse for the rest.
    let another = shift.iter().any(|share| share.abs() > ANOTHER);
    (another && is_noise(&found, &honest, case.noise_gain())).then_some(Unseeable { shift })
}

/// The fit of the same palpation with the same sensors and no fault.
fn honest_fit(case: &Case) -> Option<Fit> {
    let rows = case.honest_rows();
    fit(&rows, case.stages[0].material.numbers, case.surface_m)
}

/// A residual that is neither larger nor less white than noise, of which the honest log's residual is
/// the measure: it has what smoothing leaves, too.
fn is_noise(found: &Fit, honest: &Fit, gain: f64) -> bool {
    let spread = LARGER * (2.0 / found.rows.max(1) as f64).sqrt();
    let larger = (found.rmse_n / gain / honest.rmse_n).powi(2) > 1.0 + spread;
    // A χ² that is not central has the variance 2·(20 + 2·what is beyond it).
    let whiteness = honest.portmanteau;
    let by_chance = LARGER * (2.0 * (LAGS as f64 + 2.0 * whiteness)).sqrt();
    let coloured = found.portmanteau > WHITE.max(whiteness + by_chance).max(1.5 * whiteness);
    !larger && !coloured
}
