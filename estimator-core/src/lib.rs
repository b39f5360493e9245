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

pub mod budget;
pub mod calibration;
pub mod config;
pub mod contact;
pub mod effect;
pub mod error;
pub mod estimate;
pub mod estimator;
pub mod filter;
pub mod frame;
pub mod identify;
pub mod instants;
pub mod law;
pub mod link;
pub mod noise;
pub mod reflection;
pub mod rig;
pub mod rls;
pub mod sample;
pub mod sampling;
pub mod scalar;
pub mod sensing;
pub mod settings;
pub mod status;
pub mod units;

pub use config::{Config, Params};
pub use error::ConfigError;
pub use estimate::Estimate;
pub use estimator::{State, step};
pub use law::LawKind;
pub use sample::{Fault, Faults, Sample};
pub use scalar::{Real, Scalar};
pub use status::Status;
