//! What comes out: one record per sample.

use crate::estimate::fault::Faults;
use crate::estimate::phase::{Event, Phase};
use crate::estimate::status::Status;
use crate::maths::scalar::Real;
use crate::physics::law::LawKind;

/// Slots for parameters; [`LawKind::parameters`] says what stands in which. The longest law has 7.
pub const PARAMETER_SLOTS: usize = 12;

/// A value with its standard error, both in the unit of the parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimated<T> {
    /// The estimate.
    pub value: T,
    /// One standard deviation of its error, as far as the law holds.
    pub std_error: T,
}

/// The parameters of the law in the order of [`LawKind::parameters`]; `None` is not observable.
pub type Parameters<T> = [Option<Estimated<T>>; PARAMETER_SLOTS];

/// Prediction against observation, before the estimate has seen the sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovation<T> {
    /// Force that was measured (N), filtered, without the resting force.
    pub observation_n: T,
    /// Force that the law predicts with the estimates so far (N).
    pub prediction_n: T,
    /// Observation − prediction (N).
    pub innovation_n: T,
    /// Variance that the innovation should have (N²).
    pub variance_n2: T,
    /// innovation² / variance: about 1 while the law explains the force.
    pub test_ratio: T,
}

impl<T: Real> Innovation<T> {
    /// The record of one observation and its prediction, of variance `variance_n2` > 0.
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

    /// The record in newtons from one in units of `unit` newtons.
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

/// One record per sample. Every number in it is finite, whatever came in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T = f32> {
    /// The instant that the record describes (µs): the sample's time less the delay of the filter.
    pub time_us: u64,
    /// The law that the parameters belong to.
    pub law: LawKind,
    /// Where the probe is.
    pub phase: Phase,
    /// How far the parameters can be trusted.
    pub status: Status,
    /// Penetration (m): filtered position − surface; negative in free air, 0 while no surface is known.
    pub depth_m: T,
    /// Rate of penetration (m/s), with the same delay.
    pub speed_mps: T,
    /// Force (N) with the same delay, resting force removed.
    pub force_n: T,
    /// The parameters, in SI units at the reference depth.
    pub parameters: Parameters<T>,
    /// Prediction against observation.
    pub innovation: Innovation<T>,
    /// The forgetting factor β of (24) that was used; 1 where nothing was learned.
    pub forgetting: T,
    /// What happened, if anything.
    pub event: Option<Event>,
    /// What is wrong, if anything.
    pub faults: Faults,
}

impl<T: Real> Estimate<T> {
    /// The record before anything was touched.
    pub(crate) fn nothing(law: LawKind) -> Self {
        Estimate {
            time_us: 0,
            law,
            phase: Phase::default(),
            status: Status::default(),
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

    /// Every number is finite.
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
