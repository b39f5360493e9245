//! From raw samples to position, speed and force that belong to one instant.
//!
//! Position, speed and force leave each filter with the same delay: with a speed from a causal filter
//! beside a raw force, every estimator errs by 1.5–3 % on gel.

mod aligned;
mod response;
mod savitzky_golay;
mod state_variable;

pub use aligned::Aligned;
pub use response::Response;
pub use savitzky_golay::{MAX_HALF_WIDTH, SavitzkyGolay, SavitzkyGolayParams};
pub use state_variable::{StateVariable, StateVariableParams};

use crate::estimate::{config, error::ConfigError, error::require_each, sample::Sample};
use crate::maths::scalar::Real;

/// Coefficients of the configured filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterParams<T> {
    /// Coefficients of the chapter's state-variable filter.
    StateVariable(StateVariableParams<T>),
    /// Weights of the Savitzky–Golay window.
    SavitzkyGolay(SavitzkyGolayParams<T>),
}

impl<T: Real> FilterParams<T> {
    pub(crate) fn validate(filter: config::Filter, rate_hz: f32) -> Result<Self, ConfigError> {
        match filter {
            config::Filter::StateVariable {
                cutoff_hz,
                damping_ratio,
            } => {
                require_each! {
                    cutoff_hz > 0.0 && cutoff_hz < 0.4 * rate_hz, "filter.cutoff_hz", cutoff_hz,
                        "must lie between 0 and 0.4 × rate_hz";
                    (0.3..=2.0).contains(&damping_ratio), "filter.damping_ratio", damping_ratio,
                        "must lie between 0.3 and 2";
                }
                Ok(Self::StateVariable(StateVariableParams::new(
                    cutoff_hz,
                    damping_ratio,
                    rate_hz,
                )))
            }
            config::Filter::SavitzkyGolay { half_width } => {
                require_each! {
                    (1..=MAX_HALF_WIDTH).contains(&usize::from(half_width)),
                        "filter.half_width", f32::from(half_width), "must lie between 1 and 32 samples";
                }
                Ok(Self::SavitzkyGolay(SavitzkyGolayParams::new(
                    half_width, rate_hz,
                )))
            }
        }
    }

    /// Delay, memory and noise gain of the filter.
    pub fn response(&self) -> &Response<T> {
        match self {
            Self::StateVariable(params) => params.response(),
            Self::SavitzkyGolay(params) => params.response(),
        }
    }
}

/// State of the configured filter.
#[derive(Clone, Debug)]
pub enum FilterState<T> {
    /// State of the chapter's state-variable filter.
    StateVariable(StateVariable<T>),
    /// State of the Savitzky–Golay window.
    SavitzkyGolay(SavitzkyGolay<T>),
}

impl<T: Real> FilterState<T> {
    /// The state before the first sample.
    pub fn new(params: &FilterParams<T>) -> Self {
        match params {
            FilterParams::StateVariable(_) => Self::StateVariable(StateVariable::default()),
            FilterParams::SavitzkyGolay(_) => Self::SavitzkyGolay(SavitzkyGolay::default()),
        }
    }

    /// Forgets the past, as if the probe had always rested at this sample.
    pub fn restart(&mut self, sample: &Sample<T>) {
        match self {
            Self::StateVariable(s) => s.restart(sample),
            Self::SavitzkyGolay(s) => s.restart(sample),
        }
    }

    /// Takes one sample. The result is zero if state and coefficients belong to different filters,
    /// which [`FilterState::new`] excludes.
    pub fn update(&mut self, params: &FilterParams<T>, sample: &Sample<T>) -> Aligned<T> {
        match (self, params) {
            (Self::StateVariable(s), FilterParams::StateVariable(p)) => s.update(p, sample),
            (Self::SavitzkyGolay(s), FilterParams::SavitzkyGolay(p)) => s.update(p, sample),
            _ => Aligned::default(),
        }
    }
}
