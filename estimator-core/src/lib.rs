//! Contact estimation for a motor controller: a load cell and an encoder in, the mechanical
//! impedance of whatever is being touched out, one sample at a time.
//!
//! The crate is the only home of contact physics and estimation in Palpate. It owns no clock, no
//! seed and no memory beyond its own [`State`]: the board, the emulator and the host's replay run
//! the same [`step`] and get the same bits.
//!
//! ```
//! use estimator_core::{Config, Sample, State, step};
//!
//! let params = Config::default().validate::<f32>().expect("the defaults are valid");
//! let mut state = State::new(&params);
//! let sample = Sample { time_us: 1000, position_m: -0.002, force_n: 0.003, ..Sample::default() };
//! let estimate = step(&params, &mut state, sample);
//! assert!(estimate.parameters.iter().all(Option::is_none), "nothing has been touched yet");
//! ```
//!
//! Equation numbers are those of Biagiotti & Melchiorri, "Environment Estimation in Teleoperation
//! Systems", *Advances in Telerobotics*, Springer STAR 31, 2007. Positions grow into the material;
//! a positive force pushes the probe out.
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
