//! Decides whether an estimate has converged: its parameters are steady, their standard errors are
//! within the bound, and the noise explains the innovations.

mod hold;

use hold::Hold;

use crate::estimate::{
    Innovation, config::Config, error::ConfigError, error::require_each, misfit::Excess,
    misfit::Misfit, phase::Event, phase::Phase, record::PARAMETER_SLOTS, status::Doubt,
    status::Reason, status::Status,
};
use crate::maths::scalar::Real;

/// Number of snapshots of the parameters that steadiness is decided over.
const SNAPSHOTS: usize = 8;
/// Memory of the fast mean of the test ratio (samples): 20 ms at 1 kHz.
const FAST_SAMPLES: f64 = 20.0;
/// The material has changed when the test ratio exceeds its slow mean this many times in so many samples
/// more than not. An outlier stays in a filter's window of 17 samples and is no change of material.
const CHANGE_RATIO: f64 = 12.0;
const CHANGE_SAMPLES: u32 = 24;
/// The same as a time (s), where samples are faster.
const CHANGE_S: f64 = 0.024;
/// While the fast mean of the test ratio is above this, an estimate is not converged: four standard
/// deviations of a filtered force, which noise alone exceeds once in minutes of contact.
const DOUBT_RATIO: f64 = 16.0;
/// The same of the mean square over many strokes: a residual of twice the noise. With 3.5 some honest logs
/// with 5 mN of noise are doubted, where steps and lines of the filter count; with 8 a spring of 3 % in series
/// is believed twice as often.
const DOUBT_MEAN_SQUARE: f64 = 4.0;
/// Windows of samples after which an estimate that was suspect may be converged again: two seconds of
/// contact by default, the memory of the residuals. After a doubt by the means alone it is one window.
const SUSPECTED_WINDOWS: u32 = 4;
const DOUBTED_WINDOWS: u32 = 1;
/// Number of doubts after which their time is not doubled any more: 32 s of contact by default.
const MOST_DOUBTS: u32 = 5;
/// Number of windows without a doubt after which one of them is forgotten.
const FORGIVEN_WINDOWS: u32 = 16;
/// Largest test ratio that enters the means: an outlier of one window raises the slow mean by 3, and a law
/// that does not hold still raises it above any bound that can be set.
const MAX_RATIO: f64 = 100.0;
/// Largest test ratio that enters the mean which a change is measured against.
const MAX_BASELINE: f64 = 1e6;

/// Checked bounds of the convergence monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorParams<T> {
    converged_within: T,
    window: u32,
    suspect_ratio: T,
    slow_gain: T,
    change_samples: u32,
    /// Variance of the filtered over that of the raw force.
    noise_gain: T,
}

impl<T: Real> MonitorParams<T> {
    pub(crate) fn validate(config: &Config, noise_gain: T) -> Result<Self, ConfigError> {
        let judgement = config.judgement;
        let window = judgement.window_s * config.rate_hz;
        let (within, ratio) = (judgement.converged_within, judgement.suspect_ratio);
        require_each! {
            (16.0..=1e6).contains(&window), "judgement.window_s", judgement.window_s,
                "must cover 16 to 1 000 000 samples";
            within > 0.0 && within <= 0.5, "judgement.converged_within", within, "must lie between 0 and 0.5";
            (2.0..=1e6).contains(&ratio), "judgement.suspect_ratio", ratio, "must lie between 2 and 1e6";
        }
        Ok(MonitorParams {
            converged_within: T::from_f64(f64::from(within)),
            window: window as u32,
            suspect_ratio: T::from_f64(f64::from(ratio)),
            slow_gain: T::from_f64(1.0 / f64::from(window)),
            change_samples: CHANGE_SAMPLES.max((CHANGE_S * f64::from(config.rate_hz)) as u32),
            noise_gain,
        })
    }

    /// So many samples speak for another material before an estimator that looks back believes it.
    pub fn change_samples(&self) -> u32 {
        self.change_samples
    }
}

/// One parameter with its standard error and the scale that both are compared with, all in the same
/// unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterEstimate<T> {
    /// Estimated value.
    pub value: T,
    /// Standard error of the value.
    pub std_error: T,
    /// Change of the value that matters; 0 for a parameter that cannot be observed.
    pub scale: T,
}

impl<T: Real> ParameterEstimate<T> {
    /// Whether the data determine the parameter: its standard error is below half of its scale.
    pub fn observable(&self) -> bool {
        self.std_error < T::from_f64(0.5) * self.scale
    }
}

/// State of the convergence monitor, updated with every sample that was learned from.
#[derive(Clone, Debug)]
pub struct ConvergenceMonitor<T> {
    status: Status,
    reason: Option<Reason>,
    misfit: Misfit<T>,
    /// Means of the test ratio over 20 samples and over a window.
    fast_ratio: T,
    slow_ratio: T,
    /// Mean of the test ratio that a change of material is measured against: of a law that does not
    /// hold, every stroke would otherwise be another material.
    baseline: T,
    /// The fast mean without the bound.
    recent: T,
    snapshots: [[T; PARAMETER_SLOTS]; SNAPSHOTS],
    /// Number of snapshots taken; counts on in a circle above [`SNAPSHOTS`] once all are taken.
    taken: usize,
    /// Number of samples until the next snapshot.
    until_snapshot: u32,
    /// Number of samples for which the status stays [`Status::Changed`].
    changed_samples: u32,
    /// Whether the parameters have once been steady, so that there is something that can change.
    settled: bool,
    /// Number of samples that speak for another material, less those that do not.
    alien_samples: u32,
    /// Whether the estimate was converged before those samples.
    was_converged: bool,
    hold: Hold<T>,
    /// Number of samples until an estimate that was suspect may be converged again, and the reason.
    suspected: (u32, Option<Reason>),
    /// Number of times that the data have contradicted an estimate of this material, at most [`MOST_DOUBTS`], and the samples
    /// that have agreed since.
    doubts: u32,
    agreed: u32,
}

/// The state before the first contact.
impl<T: Real> Default for ConvergenceMonitor<T> {
    fn default() -> Self {
        ConvergenceMonitor {
            status: Status::NoContact,
            reason: None,
            misfit: Misfit::default(),
            fast_ratio: T::one(),
            slow_ratio: T::one(),
            baseline: T::one(),
            recent: T::one(),
            snapshots: [[T::zero(); PARAMETER_SLOTS]; SNAPSHOTS],
            taken: 0,
            until_snapshot: 0,
            changed_samples: 0,
            settled: false,
            alien_samples: 0,
            was_converged: false,
            hold: Hold::default(),
            suspected: (0, None),
            doubts: 0,
            agreed: 0,
        }
    }
}

impl<T: Real> ConvergenceMonitor<T> {
    /// Status of the estimate after the last sample.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Reason why the status is not [`Status::Converged`], where there is one.
    pub fn reason(&self) -> Option<Reason> {
        self.reason
    }

    /// Factor by which the standard errors are too small, at least 1, by the innovations and the `excess`
    /// of an estimator that can look back on its residuals. The innovations of one that forgets are
    /// correlated by its own errors, so that their means say nothing.
    pub fn inflation(&self, excess: Option<Excess<T>>) -> T {
        let recent = T::one().max_of(self.slow_ratio).sqrt();
        excess.map_or(recent, |excess| recent.max_of(excess.inflation))
    }

    /// Takes the phase of a sample, learned from or not.
    pub fn observe_phase(&mut self, phase: Phase) {
        if phase == Phase::Contact && self.status == Status::NoContact {
            self.status = Status::Unobservable;
        }
    }

    /// Takes the parameters after a sample and its innovation; says whether the material has changed.
    /// `doubt` is a reason not to trust the parameters that only the estimator can know.
    pub fn update(
        &mut self,
        params: &MonitorParams<T>,
        parameters: &[ParameterEstimate<T>],
        innovation: &Innovation<T>,
        excess: Option<Excess<T>>,
        doubt: Option<Doubt>,
    ) -> Option<Event> {
        let ratio = innovation.test_ratio.min_of(T::from_f64(MAX_RATIO));
        let normalized = innovation.normalized();
        self.hold.take(normalized, params.change_samples / 2);
        // While the parameters still come from their start, they are what errs, and not the law.
        if excess.is_none() && self.taken >= SNAPSHOTS {
            self.misfit.update(normalized, T::one(), params.noise_gain);
        }
        let alien =
            innovation.test_ratio > T::from_f64(CHANGE_RATIO) * T::one().max_of(self.baseline);
        self.was_converged &= self.alien_samples > 0;
        self.was_converged |= self.status == Status::Converged;
        self.alien_samples = match alien {
            true => self.alien_samples + 1,
            false => self.alien_samples.saturating_sub(1),
        };
        self.fast_ratio += T::from_f64(1.0 / FAST_SAMPLES) * (ratio - self.fast_ratio);
        self.slow_ratio += params.slow_gain * (ratio - self.slow_ratio);
        let unbounded = innovation.test_ratio.min_of(T::from_f64(MAX_BASELINE));
        let before = T::one().max_of(self.baseline);
        self.recent += T::from_f64(1.0 / FAST_SAMPLES) * (unbounded - self.recent);
        // After an estimate that held, what is alien waits for a verdict: a surface that is 50 µm elsewhere raises
        // the ratio to 10⁵, and within 20 samples its own mean by so much that nothing was alien any more.
        if !(alien && self.was_converged && excess.is_some()) {
            self.baseline += params.slow_gain * (unbounded - self.baseline);
        }
        self.settled |= matches!(self.status, Status::Converged | Status::ModelSuspect);
        if self.settled && self.has_changed(params, excess.is_some(), before) {
            self.restart(params);
            return Some(Event::MaterialChange);
        }
        let steady = self.steady(params, parameters);
        let before = self.status;
        self.changed_samples = self.changed_samples.saturating_sub(1);
        (self.status, self.reason) = self.judge(params, parameters, steady, doubt, excess);
        self.remember_doubt(params, before, excess.is_some());
        None
    }

    /// A law that the data have contradicted is not believed again before as much has been seen that agrees:
    /// of what creeps or relaxes, single strokes fit. A doubt that returns lasts twice as long as the last one,
    /// where it comes from residuals that an estimator has looked back on: the innovations of a cascade are in part
    /// its own doing, and a zero or a skew in doubt is watched for itself.
    fn remember_doubt(&mut self, params: &MonitorParams<T>, before: Status, looks_back: bool) {
        let (samples, _) = self.suspected;
        let of_law = looks_back && self.reason == Some(Reason::Residual);
        let windows = match self.status {
            Status::ModelSuspect => SUSPECTED_WINDOWS,
            Status::Converging if of_law => DOUBTED_WINDOWS,
            _ => return self.wait(params),
        };
        self.agreed = 0;
        let mut lasts = params.window.saturating_mul(windows);
        if of_law {
            let is_suspect = self.status == Status::ModelSuspect && before != Status::ModelSuspect;
            if before == Status::Converged || is_suspect && samples < lasts / 2 {
                self.doubts = MOST_DOUBTS.min(self.doubts + 1);
            }
            lasts = lasts.saturating_mul(1 << self.doubts.saturating_sub(1));
        }
        if lasts >= samples {
            self.suspected = (lasts, self.reason);
        }
    }

    /// Takes a sample that agrees.
    fn wait(&mut self, params: &MonitorParams<T>) {
        let (samples, reason) = self.suspected;
        if self.status == Status::Converged && samples > 0 {
            (self.status, self.reason) = (Status::Converging, reason);
        }
        self.suspected.0 = samples.saturating_sub(1);
        self.agreed += 1;
        if self.agreed >= params.window.saturating_mul(FORGIVEN_WINDOWS) {
            (self.doubts, self.agreed) = (self.doubts.saturating_sub(1), 0);
        }
    }

    /// Whether the innovations speak for another material. An estimator that can look back has waited
    /// with what it learns until that has lasted; any other has learned from it already.
    fn has_changed(&self, params: &MonitorParams<T>, waits: bool, before: T) -> bool {
        if waits {
            self.alien_samples >= params.change_samples
        } else {
            self.recent > T::from_f64(CHANGE_RATIO) * before
        }
    }

    /// Takes the innovation of a sample that was not learned from: a hold in which the force leaves the
    /// prediction is no converged estimate. Says whether the material has changed, of an estimator that looks back:
    /// the prediction of a law that relaxes is in a hold what its rates make of it, and they err together.
    pub fn watch(
        &mut self,
        params: &MonitorParams<T>,
        innovation: &Innovation<T>,
        looks_back: bool,
    ) -> Option<Event> {
        let ratio = innovation.test_ratio.min_of(T::from_f64(MAX_RATIO));
        self.fast_ratio += T::from_f64(1.0 / FAST_SAMPLES) * (ratio - self.fast_ratio);
        if self.status == Status::Converged && self.fast_ratio > T::from_f64(DOUBT_RATIO) {
            self.status = Status::Converging;
            self.reason = Some(Reason::Residual);
        }
        let leap = (self.hold).take(innovation.normalized(), params.change_samples / 2)?;
        let enough = T::from_f64(CHANGE_RATIO) * T::one().max_of(self.baseline);
        if !looks_back || !self.settled || leap * leap < enough {
            return None;
        }
        self.restart(params);
        Some(Event::MaterialChange)
    }

    fn judge(
        &self,
        params: &MonitorParams<T>,
        parameters: &[ParameterEstimate<T>],
        steady: bool,
        doubt: Option<Doubt>,
        excess: Option<Excess<T>>,
    ) -> (Status, Option<Reason>) {
        let mean_square = self
            .slow_ratio
            .max_of(excess.unwrap_or_else(|| self.misfit.excess()).mean_square);
        let reason = doubt.map(Doubt::reason);
        if self.changed_samples > 0 {
            (Status::Changed, None)
        } else if self.taken >= SNAPSHOTS && mean_square > params.suspect_ratio {
            (Status::ModelSuspect, reason.or(Some(Reason::Residual)))
        } else if !parameters.iter().all(ParameterEstimate::observable) {
            (Status::Unobservable, reason.or(Some(Reason::Excitation)))
        } else if !steady {
            (Status::Converging, reason)
        } else if let Some(Doubt::Against(_)) = doubt {
            (Status::ModelSuspect, reason)
        } else if doubt.is_some() {
            (Status::Converging, reason)
        } else if self.fast_ratio > T::from_f64(DOUBT_RATIO)
            || excess.is_some() && mean_square > T::from_f64(DOUBT_MEAN_SQUARE)
        {
            (Status::Converging, Some(Reason::Residual))
        } else {
            (Status::Converged, None)
        }
    }

    /// Starts anew for another material.
    fn restart(&mut self, params: &MonitorParams<T>) {
        self.status = Status::Changed;
        self.changed_samples = params.window / 2;
        self.taken = 0;
        self.reason = None;
        self.settled = false;
        self.suspected = (0, None);
        (self.doubts, self.agreed) = (0, 0);
        self.forget_innovations();
    }

    /// Forgets the innovations, which were those of other estimates.
    pub fn forget_innovations(&mut self) {
        (self.slow_ratio, self.baseline) = (T::one(), T::one());
        self.misfit = Misfit::default();
        self.alien_samples = 0;
        self.hold = Hold::default();
    }

    /// Whether every standard error is within the bound, and every parameter within the bound of all its
    /// snapshots, which span one window of learning.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> MonitorParams<f64> {
        MonitorParams::validate(&Config::default(), 0.1).unwrap()
    }

    fn at(value: f64) -> [ParameterEstimate<f64>; 1] {
        [ParameterEstimate {
            value,
            std_error: 0.01,
            scale: 1.0,
        }]
    }

    /// An innovation with this test ratio; its sign alternates as that of white noise does.
    fn innovation(ratio: f64, at: u32) -> Innovation<f64> {
        let sign = if (at / 8).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        Innovation::new(sign * ratio.sqrt(), 0.0, 1.0)
    }

    fn feed(monitor: &mut ConvergenceMonitor<f64>, samples: u32, value: f64, ratio: f64) -> u32 {
        fed(monitor, samples, value, ratio, None)
    }

    /// The same of an estimator that has looked back on its residuals: their mean square.
    fn look_back(monitor: &mut ConvergenceMonitor<f64>, samples: u32, ratio: f64, square: f64) {
        let excess = Excess {
            mean_square: square,
            inflation: 1.0,
        };
        fed(monitor, samples, 1.0, ratio, Some(excess));
    }

    fn fed(
        monitor: &mut ConvergenceMonitor<f64>,
        samples: u32,
        value: f64,
        ratio: f64,
        excess: Option<Excess<f64>>,
    ) -> u32 {
        let update = |i: &u32| {
            let innovation = innovation(ratio, *i);
            monitor
                .update(&params(), &at(value), &innovation, excess, None)
                .is_some()
        };
        (0..samples).filter(update).count() as u32
    }

    #[test]
    fn steady_parameters_converge_after_a_window_and_not_before() {
        let mut monitor = ConvergenceMonitor::default();
        feed(&mut monitor, 400, 1.0, 1.0);
        assert_eq!(monitor.status(), Status::Converging);
        feed(&mut monitor, 200, 1.0, 1.0);
        assert_eq!(monitor.status(), Status::Converged);
    }

    #[test]
    fn a_parameter_that_moves_is_not_converged() {
        let mut monitor = ConvergenceMonitor::default();
        for i in 0..2000 {
            monitor.update(
                &params(),
                &at(1.0 + 2e-4 * f64::from(i)),
                &innovation(1.0, i),
                None,
                None,
            );
        }
        assert_eq!(monitor.status(), Status::Converging);
    }

    #[test]
    fn a_large_standard_error_is_unobservable() {
        let mut monitor = ConvergenceMonitor::default();
        let unknown = [ParameterEstimate {
            value: 1.0,
            std_error: 0.6,
            scale: 1.0,
        }];
        (0..1000).for_each(|i| {
            monitor.update(&params(), &unknown, &innovation(1.0, i), None, None);
        });
        assert_eq!(monitor.status(), Status::Unobservable);
    }

    #[test]
    fn a_change_is_flagged_once_and_only_after_convergence() {
        let mut monitor = ConvergenceMonitor::default();
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
    fn a_doubt_that_returns_lasts_twice_as_long_until_it_is_forgotten() {
        let mut monitor = ConvergenceMonitor::default();
        look_back(&mut monitor, 1000, 1.0, 1.0);
        // Samples from a doubt to the next converged estimate: 1, 2, 4 windows of 500.
        let waits = |monitor: &mut ConvergenceMonitor<f64>| {
            look_back(monitor, 1, 1.0, 5.0);
            assert_eq!(monitor.status(), Status::Converging);
            (0..4000).find(|_| {
                look_back(monitor, 1, 1.0, 1.0);
                monitor.status() == Status::Converged
            })
        };
        let times: [u32; 3] = core::array::from_fn(|_| waits(&mut monitor).unwrap());
        assert_eq!(times, [500, 1000, 2000]);
        look_back(&mut monitor, 3 * 16 * 500, 1.0, 1.0);
        assert_eq!(waits(&mut monitor), Some(500));
    }

    #[test]
    fn a_residual_of_twice_the_noise_that_lasts_is_not_converged() {
        let mut monitor = ConvergenceMonitor::default();
        look_back(&mut monitor, 6000, 1.0, 5.0);
        let said = (monitor.status(), monitor.reason());
        assert_eq!(said, (Status::Converging, Some(Reason::Residual)));
    }

    #[test]
    fn a_lasting_misfit_is_suspect() {
        let mut monitor = ConvergenceMonitor::default();
        feed(&mut monitor, 3000, 1.0, 60.0);
        assert_eq!(monitor.status(), Status::ModelSuspect);
        assert!((monitor.inflation(None) - libm::sqrt(60.0)).abs() < 0.1);
    }
}
