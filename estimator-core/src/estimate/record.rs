//! The output of the estimator: one record per sample.

use crate::estimate::{fault::Faults, phase::Event, phase::Phase, status::Reason, status::Status};
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Number of slots for parameters, whose meaning [`LawKind::parameters`] gives; the longest law uses 7.
pub const PARAMETER_SLOTS: usize = 12;

/// An estimated parameter: a value with its standard error, both in the unit of the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimated<T> {
    /// Estimated value.
    pub value: T,
    /// Standard deviation of the error of the value, provided that the law holds.
    pub std_error: T,
}

/// The parameters of a law in the order of [`LawKind::parameters`]; `None` is a parameter that the data
/// do not determine.
pub type Parameters<T> = [Option<Estimated<T>>; PARAMETER_SLOTS];

/// Innovation of one sample: its observation against the prediction of the estimates before it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovation<T> {
    /// Measured force (N), filtered and without the resting force.
    pub observation_n: T,
    /// Force that the law predicts with the estimates before this sample (N).
    pub prediction_n: T,
    /// Innovation (N): observation − prediction.
    pub innovation_n: T,
    /// Expected variance of the innovation (N²).
    pub variance_n2: T,
    /// Test ratio, innovation² / variance: about 1 while the law explains the force.
    pub test_ratio: T,
}

impl<T: Real> Innovation<T> {
    /// Compares an observation with its prediction; their difference has the variance `variance_n2` > 0.
    pub(crate) fn new(observation_n: T, prediction_n: T, variance_n2: T) -> Self {
        let innovation_n = observation_n - prediction_n;
        Innovation {
            observation_n,
            prediction_n,
            innovation_n,
            variance_n2,
            test_ratio: innovation_n * innovation_n / variance_n2,
        }
    }

    /// Innovation over its expected standard deviation; 0 outside contact.
    pub(crate) fn normalized(&self) -> T {
        if self.variance_n2 > T::zero() {
            self.innovation_n / self.variance_n2.sqrt()
        } else {
            T::zero()
        }
    }

    /// Converts an innovation in units of `unit` newtons to newtons.
    pub(crate) fn in_newtons(self, unit: T) -> Self {
        Innovation {
            observation_n: self.observation_n * unit,
            prediction_n: self.prediction_n * unit,
            innovation_n: self.innovation_n * unit,
            variance_n2: self.variance_n2 * unit * unit,
            test_ratio: self.test_ratio,
        }
    }
}

/// Everything that is known after one sample. Every number in it is finite, whatever the sample
/// contains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate<T = f32> {
    /// Instant that the estimate describes (µs): the time of the sample less the delay of the filter.
    pub time_us: u64,
    /// Law that the parameters belong to.
    pub law: LawKind,
    /// Where the probe is.
    pub phase: Phase,
    /// Status that says how far the parameters can be trusted.
    pub status: Status,
    /// Reason why the status is not better, where there is one.
    pub reason: Option<Reason>,
    /// Penetration (m), filtered position − surface: negative in free air, 0 before a surface is known.
    pub depth_m: T,
    /// Rate of the penetration (m/s), with the same delay.
    pub speed_mps: T,
    /// Filtered force (N) without the resting force, with the same delay.
    pub force_n: T,
    /// Parameters of the law in SI units, at the reference depth.
    pub parameters: Parameters<T>,
    /// Innovation of the sample; zero outside contact.
    pub innovation: Innovation<T>,
    /// Forgetting factor β of (24) that was used; 1 if nothing was learned.
    pub forgetting: T,
    /// Event at this sample, if there is one.
    pub event: Option<Event>,
    /// Faults of this sample.
    pub faults: Faults,
}

impl<T: Real> Estimate<T> {
    /// The estimate before anything was touched.
    pub(crate) fn nothing(law: LawKind) -> Self {
        Estimate {
            time_us: 0,
            law,
            phase: Phase::default(),
            status: Status::default(),
            reason: None,
            depth_m: T::zero(),
            speed_mps: T::zero(),
            force_n: T::zero(),
            parameters: [None; PARAMETER_SLOTS],
            innovation: Innovation::default(),
            forgetting: T::one(),
            event: None,
            faults: Faults::NONE,
        }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let innovation = &self.innovation;
        let signals = [self.depth_m, self.speed_mps, self.force_n, self.forgetting];
        let channel = [
            innovation.observation_n,
            innovation.prediction_n,
            innovation.innovation_n,
            innovation.variance_n2,
            innovation.test_ratio,
        ];
        let parameters = self.parameters.iter().flatten();
        signals.into_iter().chain(channel).all(Real::is_finite)
            && parameters
                .into_iter()
                .all(|p| p.value.is_finite() && p.std_error.is_finite())
    }
}
