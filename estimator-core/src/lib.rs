#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod board;
pub mod estimate;
pub mod maths;
pub mod physics;

pub use estimate::config::Config;
pub use estimate::error::ConfigError;
pub use estimate::estimator::{State, step};
pub use estimate::fault::{Fault, Faults};
pub use estimate::params::Params;
pub use estimate::record::Estimate;
pub use estimate::sample::Sample;
pub use estimate::status::Status;
pub use maths::scalar::{Real, Scalar};
pub use physics::law::LawKind;
