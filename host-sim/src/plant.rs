//! The simulated rig: a position-controlled linear motor presses a probe into a material, a load
//! cell and an encoder look on.
//!
//! The core's [`Rig`](estimator_core::physics::rig::Rig) is the signal chain between motor and sensors; twenty sub-steps a sample, all in f64. Each part is checked against a closed form by the tests
//! beside it; what the sensors read and what was true are kept apart.

pub mod chain;
pub mod contact;
pub mod delay;
pub mod material;
pub mod motor;
pub mod rig;
pub mod sensors;

pub use chain::{Effects, depth_at_m};
pub use contact::Contact;
pub use material::{GEL, Material, PLASTIC};
pub use motor::{Motor, MotorState};
pub use rig::{Rig, Run, Stage, Truth};
pub use sensors::{Encoder, FORCE_CODES, LoadCell, Sensors};
