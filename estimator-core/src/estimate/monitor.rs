//! Whether an estimate has converged: parameters that stay, standard errors within the bound, and
//! innovations that the noise explains.

use crate::estimate::config::Config;
use crate::estimate::error::{ConfigError, require};
use crate::estimate::phase::Event;
use crate::estimate::record::PARAMETER_SLOTS;
use crate::estimate::status::Status;
use crate::maths::scalar::Real;

/// Snapshots of the parameters that steadiness is judged over.
const SNAPSHOTS: usize = 8;
/// Memory of the quick mean of the test ratio (samples): 20 ms at 1 kHz.
const QUICK: f64 = 20.0;
/// A change: the quick mean is this many times what the law used to leave. At 20 independent
/// samples the quick mean exceeds 12 by chance with probability below 10⁻³⁰.
const CHANGE_RATIO: f64 = 12.0;

/// Bounds of the judgement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorParams<T> {
    converged_within: T,
    window: u32,
    suspect_ratio: T,
    slow_gain: T,
}

impl<T: Real> MonitorParams<T> {
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
        Ok(MonitorParams {
            converged_within: T::from_f64(f64::from(judgement.converged_within)),
            window: window as u32,
            suspect_ratio: T::from_f64(f64::from(judgement.suspect_ratio)),
            slow_gain: T::from_f64(1.0 / f64::from(window)),
        })
    }
}

/// One parameter as the monitor sees it: value, standard error and the size that both are compared
/// with, all in the same unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterEstimate<T> {
    /// The estimate.
    pub value: T,
    /// Its standard error.
    pub std_error: T,
    /// The size of a contribution that matters.
    pub scale: T,
}

impl<T: Real> ParameterEstimate<T> {
    /// A parameter with half its size of error is not known.
    pub fn observable(&self) -> bool {
        self.std_error < T::from_f64(0.5) * self.scale
    }
}

/// State of the judgement: called for every sample that was learned from.
#[derive(Clone, Debug)]
pub struct ConvergenceMonitor<T> {
    status: Status,
    quick: T,
    slow: T,
    snapshots: [[T; PARAMETER_SLOTS]; SNAPSHOTS],
    taken: usize,
    until_snapshot: u32,
    changed_for: u32,
}

impl<T: Real> ConvergenceMonitor<T> {
    /// Before the first contact.
    pub fn new() -> Self {
        ConvergenceMonitor {
            status: Status::NoContact,
            quick: T::one(),
            slow: T::one(),
            snapshots: [[T::zero(); PARAMETER_SLOTS]; SNAPSHOTS],
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
        T::one().max_of(self.slow).sqrt()
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
        params: &MonitorParams<T>,
        parameters: &[ParameterEstimate<T>],
        test_ratio: T,
    ) -> Option<Event> {
        let ratio = if test_ratio > T::from_f64(1e6) {
            T::from_f64(1e6)
        } else {
            test_ratio
        };
        self.quick += T::from_f64(1.0 / QUICK) * (ratio - self.quick);
        let usual = T::one().max_of(self.slow);
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
        } else if !parameters.iter().all(ParameterEstimate::observable) {
            Status::Unobservable
        } else if steady {
            Status::Converged
        } else {
            Status::Converging
        };
        None
    }

    fn start_anew(&mut self, params: &MonitorParams<T>) {
        self.status = Status::Changed;
        self.changed_for = params.window / 2;
        self.taken = 0;
        self.slow = T::one();
    }

    /// Every standard error within the bound, and every parameter within it of all the snapshots,
    /// which span one window of learning.
    fn steady(&mut self, params: &MonitorParams<T>, parameters: &[ParameterEstimate<T>]) -> bool {
        let mut steady = self.taken >= SNAPSHOTS;
        for (slot, parameter) in parameters.iter().enumerate() {
            let bound = params.converged_within * parameter.scale;
            steady &= parameter.std_error < bound;
            for snapshot in &self.snapshots {
                let then = snapshot.get(slot).copied().unwrap_or_default();
                steady &= (parameter.value - then).abs() < bound;
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

impl<T: Real> Default for ConvergenceMonitor<T> {
    fn default() -> Self {
        ConvergenceMonitor::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> MonitorParams<f64> {
        MonitorParams::validate(&Config::default()).unwrap()
    }

    fn at(value: f64) -> [ParameterEstimate<f64>; 1] {
        [ParameterEstimate {
            value,
            std_error: 0.01,
            scale: 1.0,
        }]
    }

    fn feed(monitor: &mut ConvergenceMonitor<f64>, samples: u32, value: f64, ratio: f64) -> u32 {
        (0..samples)
            .filter(|_| monitor.update(&params(), &at(value), ratio).is_some())
            .count() as u32
    }

    #[test]
    fn steady_parameters_converge_after_a_window_and_not_before() {
        let mut monitor = ConvergenceMonitor::new();
        feed(&mut monitor, 400, 1.0, 1.0);
        assert_eq!(monitor.status(), Status::Converging);
        feed(&mut monitor, 200, 1.0, 1.0);
        assert_eq!(monitor.status(), Status::Converged);
    }

    #[test]
    fn a_parameter_that_moves_is_not_converged() {
        let mut monitor = ConvergenceMonitor::new();
        for i in 0..2000 {
            monitor.update(&params(), &at(1.0 + 2e-4 * f64::from(i)), 1.0);
        }
        assert_eq!(monitor.status(), Status::Converging);
    }

    #[test]
    fn a_large_standard_error_is_unobservable() {
        let mut monitor = ConvergenceMonitor::new();
        let unknown = [ParameterEstimate {
            value: 1.0,
            std_error: 0.6,
            scale: 1.0,
        }];
        (0..1000).for_each(|_| {
            monitor.update(&params(), &unknown, 1.0);
        });
        assert_eq!(monitor.status(), Status::Unobservable);
    }

    #[test]
    fn a_change_is_flagged_once_and_only_after_convergence() {
        let mut monitor = ConvergenceMonitor::new();
        assert_eq!(
            feed(&mut monitor, 100, 1.0, 1e4),
            0,
            "still converging: no old material"
        );
        assert_eq!(feed(&mut monitor, 6000, 1.0, 1.0), 0);
        assert_eq!(monitor.status(), Status::Converged);
        assert_eq!(feed(&mut monitor, 100, 1.5, 1e4), 1);
        assert_eq!(monitor.status(), Status::Changed);
    }

    #[test]
    fn a_lasting_misfit_is_suspect() {
        let mut monitor = ConvergenceMonitor::new();
        feed(&mut monitor, 3000, 1.0, 60.0);
        assert_eq!(monitor.status(), Status::ModelSuspect);
        assert!((monitor.misfit() - libm::sqrt(60.0)).abs() < 0.1);
    }
}
