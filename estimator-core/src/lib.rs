//! Contact estimation for a motor controller: a load cell and an encoder in, the mechanical
//! impedance of whatever is being touched out.
//!
//! The crate is the only home of contact physics and estimation in Palpate. It owns no clock, no
//! seed and no memory beyond its own `State`: the board, the emulator and the host's replay run
//! the same `step` and get the same bits.
//!
//! Equation numbers are those of Biagiotti & Melchiorri, "Environment Estimation in Teleoperation
//! Systems", *Advances in Telerobotics*, Springer STAR 31, 2007. Positions grow into the material;
//! a positive force pushes the probe out.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod config;
pub mod error;
pub mod estimate;
pub mod law;
pub mod sample;
pub mod scalar;
pub mod status;
pub mod units;

pub use config::Config;
pub use error::ConfigError;
pub use estimate::Estimate;
pub use law::LawKind;
pub use sample::{Fault, Faults, Sample};
pub use scalar::{Real, Scalar};
pub use status::Status;
