//! How far an estimate can be trusted, in one word.

use crate::config::Config;
use crate::error::{ConfigError, require};
use crate::estimate::{Event, PARAMETER_SLOTS};
use crate::scalar::Real;

/// The state of an estimate. Names and numbers are stable: JSON, frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Nothing has been touched yet.
    #[default]
    NoContact = 0,
    /// In contact, but the motion so far does not tell all parameters apart.
    Unobservable = 1,
    /// Parameters still move, or their standard errors are above the bound.
    Converging = 2,
    /// Parameters are steady and their standard errors are within the bound.
    Converged = 3,
    /// The material has just changed; the old values are being left.
    Changed = 4,
    /// The law does not explain the force: innovations stay far above the measured noise.
    ModelSuspect = 5,
}

impl Status {
    /// All states in the order of their numbers.
    pub const ALL: [Status; 6] = [
        Status::NoContact,
        Status::Unobservable,
        Status::Converging,
        Status::Converged,
        Status::Changed,
        Status::ModelSuspect,
    ];

    /// The stable number.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The one with a number.
    pub fn from_code(code: u8) -> Option<Status> {
        Status::ALL.into_iter().find(|one| one.code() == code)
    }

    /// The name in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Status::NoContact => "no_contact",
            Status::Unobservable => "unobservable",
            Status::Converging => "converging",
            Status::Converged => "converged",
            Status::Changed => "changed",
            Status::ModelSuspect => "model_suspect",
        }
    }
}

/// Snapshots of the parameters that steadiness is judged over.
const SNAPSHOTS: usize = 8;
/// Memory of the quick mean of the test ratio (samples): 20 ms at 1 kHz.
const QUICK: f64 = 20.0;
/// A change: the quick mean is this many times what the law used to leave. At 20 independent
/// samples the quick mean exceeds 12 by chance with probability below 10⁻³⁰.
const CHANGE_RATIO: f64 = 12.0;

/// Bounds of the judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatusParams<T> {
    converged_within: T,
    window: u32,
    suspect_ratio: T,
    slow_gain: T,
}

impl<T: Real> StatusParams<T> {
    pub(crate) fn validate(config: &Config) -> Result<Self, ConfigError> {
        let judgement = config.judgement;
        let window = judgement.window_s * config.rate_hz;
        require(
            (16.0..=1e6).contains(&window),
            "judgement.window_s",
            judgement.window_s,
            "must cover 16 to 1 000 000 samples",
        )?;
        require(
            judgement.converged_within > 0.0 && judgement.converged_within <= 0.5,
            "judgement.converged_within",
            judgement.converged_within,
            "must lie between 0 and 0.5",
        )?;
        require(
            (2.0..=1e6).contains(&judgement.suspect_ratio),
            "judgement.suspect_ratio",
            judgement.suspect_ratio,
            "must lie between 2 and 1e6",
        )?;
        Ok(StatusParams {
            converged_within: T::from_f64(f64::from(judgement.converged_within)),
            window: window as u32,
            suspect_ratio: T::from_f64(f64::from(judgement.suspect_ratio)),
            slow_gain: T::from_f64(1.0 / f64::from(window)),
        })
    }
}

/// One parameter as the judge sees it: value, standard error and the size that both are compared
/// with, all in the same unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Judged<T> {
    /// The estimate.
    pub value: T,
    /// Its standard error.
    pub std_error: T,
    /// The size of a contribution that matters.
    pub scale: T,
}

impl<T: Real> Judged<T> {
    /// A parameter with half its size of error is not known.
    pub fn observable(&self) -> bool {
        self.std_error < T::from_f64(0.5) * self.scale
    }
}

/// State of the judgement: called for every sample that was learned from.
#[derive(Clone, Debug)]
pub struct Judge<T> {
    status: Status,
    quick: T,
    slow: T,
    snapshots: [[T; PARAMETER_SLOTS]; SNAPSHOTS],
    taken: usize,
    until_snapshot: u32,
    changed_for: u32,
}

impl<T: Real> Judge<T> {
    /// Before the first contact.
    pub fn new() -> Self {
        Judge {
            status: Status::NoContact,
            quick: T::unit(),
            slow: T::unit(),
            snapshots: [[T::nil(); PARAMETER_SLOTS]; SNAPSHOTS],
            taken: 0,
            until_snapshot: 0,
            changed_for: 0,
        }
    }

    /// The verdict so far.
    pub fn status(&self) -> Status {
        self.status
    }

    /// By how much the innovations exceed the noise, 1 or more; multiplies standard errors.
    pub fn misfit(&self) -> T {
        T::unit().max_of(self.slow).root()
    }

    /// Something is being touched.
    pub fn touched(&mut self) {
        if self.status == Status::NoContact {
            self.status = Status::Unobservable;
        }
    }

    /// Takes the parameters after a sample and the test ratio before it.
    pub fn update(
        &mut self,
        params: &StatusParams<T>,
        parameters: &[Judged<T>],
        test_ratio: T,
    ) -> Option<Event> {
        let ratio = if test_ratio > T::from_f64(1e6) {
            T::from_f64(1e6)
        } else {
            test_ratio
        };
        self.quick += T::from_f64(1.0 / QUICK) * (ratio - self.quick);
        let usual = T::unit().max_of(self.slow);
        self.slow += params.slow_gain * (ratio - self.slow);
        let steady_so_far = matches!(self.status, Status::Converged | Status::ModelSuspect);
        if steady_so_far && self.quick > T::from_f64(CHANGE_RATIO) * usual {
            self.start_anew(params);
            return Some(Event::MaterialChange);
        }
        let steady = self.steady(params, parameters);
        self.changed_for = self.changed_for.saturating_sub(1);
        self.status = if self.changed_for > 0 {
            Status::Changed
        } else if self.taken >= SNAPSHOTS && self.slow > params.suspect_ratio {
            Status::ModelSuspect
        } else if !parameters.iter().all(Judged::observable) {
            Status::Unobservable
        } else if steady {
            Status::Converged
        } else {
            Status::Converging
        };
        None
    }

    fn start_anew(&mut self, params: &StatusParams<T>) {
        self.status = Status::Changed;
        self.changed_for = params.window / 2;
        self.taken = 0;
        self.slow = T::unit();
    }

    /// Every standard error within the bound, and every parameter within it of all the snapshots,
    /// which span one window of learning.
    fn steady(&mut self, params: &StatusParams<T>, parameters: &[Judged<T>]) -> bool {
        let mut steady = self.taken >= SNAPSHOTS;
        for (slot, parameter) in parameters.iter().enumerate() {
            let bound = params.converged_within * parameter.scale;
            steady &= parameter.std_error < bound;
            for snapshot in &self.snapshots {
                let then = snapshot.get(slot).copied().unwrap_or_default();
                steady &= (parameter.value - then).magnitude() < bound;
            }
        }
        if self.until_snapshot == 0 {
            self.until_snapshot = params.window / SNAPSHOTS as u32;
            if let Some(snapshot) = self.snapshots.get_mut(self.taken % SNAPSHOTS) {
                for (then, parameter) in snapshot.iter_mut().zip(parameters) {
                    *then = parameter.value;
                }
            }
            // Counts on in a circle, above SNAPSHOTS once it is full.
            self.taken = if self.taken + 1 < 2 * SNAPSHOTS {
                self.taken + 1
            } else {
                SNAPSHOTS
            };
        }
        self.until_snapshot = self.until_snapshot.saturating_sub(1);
        steady
    }
}

impl<T: Real> Default for Judge<T> {
    fn default() -> Self {
        Judge::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> StatusParams<f64> {
        StatusParams::validate(&Config::default()).unwrap()
    }

    fn at(value: f64) -> [Judged<f64>; 1] {
        [Judged {
            value,
            std_error: 0.01,
            scale: 1.0,
        }]
    }

    fn feed(judge: &mut Judge<f64>, samples: u32, value: f64, ratio: f64) -> u32 {
        (0..samples)
            .filter(|_| judge.update(&params(), &at(value), ratio).is_some())
            .count() as u32
    }

    #[test]
    fn steady_parameters_converge_after_a_window_and_not_before() {
        let mut judge = Judge::new();
        feed(&mut judge, 400, 1.0, 1.0);
        assert_eq!(judge.status(), Status::Converging);
        feed(&mut judge, 200, 1.0, 1.0);
        assert_eq!(judge.status(), Status::Converged);
    }

    #[test]
    fn a_parameter_that_moves_is_not_converged() {
        let mut judge = Judge::new();
        for i in 0..2000 {
            judge.update(&params(), &at(1.0 + 2e-4 * f64::from(i)), 1.0);
        }
        assert_eq!(judge.status(), Status::Converging);
    }

    #[test]
    fn a_large_standard_error_is_unobservable() {
        let mut judge = Judge::new();
        let unknown = [Judged {
            value: 1.0,
            std_error: 0.6,
            scale: 1.0,
        }];
        (0..1000).for_each(|_| {
            judge.update(&params(), &unknown, 1.0);
        });
        assert_eq!(judge.status(), Status::Unobservable);
    }

    #[test]
    fn a_change_is_flagged_once_and_only_after_convergence() {
        let mut judge = Judge::new();
        assert_eq!(
            feed(&mut judge, 100, 1.0, 1e4),
            0,
            "still converging: no old material"
        );
        assert_eq!(feed(&mut judge, 6000, 1.0, 1.0), 0);
        assert_eq!(judge.status(), Status::Converged);
        assert_eq!(feed(&mut judge, 100, 1.5, 1e4), 1);
        assert_eq!(judge.status(), Status::Changed);
    }

    #[test]
    fn a_lasting_misfit_is_suspect() {
        let mut judge = Judge::new();
        feed(&mut judge, 3000, 1.0, 60.0);
        assert_eq!(judge.status(), Status::ModelSuspect);
        assert!((judge.misfit() - libm::sqrt(60.0)).abs() < 0.1);
    }
}
