//! What comes out: one record per sample.

use crate::law::LawKind;
use crate::sample::Faults;
use crate::status::Status;

/// Slots for parameters; [`LawKind::parameters`] says what stands in which.
pub const PARAMETER_SLOTS: usize = 5;

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
    /// Force that was measured [N], filtered, without the resting force.
    pub observation_n: T,
    /// Force that the law predicts with the estimates so far [N].
    pub prediction_n: T,
    /// Observation − prediction [N].
    pub innovation_n: T,
    /// Variance that the innovation should have [N²].
    pub variance_n2: T,
    /// innovation² / variance: about 1 while the law explains the force.
    pub test_ratio: T,
}

/// Where the probe is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// Measuring the noise and the resting force; the probe should be in free air.
    #[default]
    Settling = 0,
    /// In free air.
    Free = 1,
    /// In contact.
    Contact = 2,
}

/// Something that happened at this sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// The probe touched.
    Contact = 1,
    /// The probe lifted off.
    Release = 2,
    /// The material is another one.
    MaterialChange = 3,
}

/// One record per sample. Every number in it is finite, whatever came in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T = f32> {
    /// The instant that the record describes [µs]: the sample's time less the delay of the filter.
    pub time_us: u64,
    /// The law that the parameters belong to.
    pub law: LawKind,
    /// Where the probe is.
    pub phase: Phase,
    /// How far the parameters can be trusted.
    pub status: Status,
    /// Penetration [m]: filtered position − surface; negative in free air, 0 while no surface is known.
    pub depth_m: T,
    /// Rate of penetration [m/s], with the same delay.
    pub speed_mps: T,
    /// Force [N] with the same delay, resting force removed.
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
