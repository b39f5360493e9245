//! The simulated rig: a position-controlled linear motor presses a probe into a material, a load
//! cell and an encoder look on.
//!
//! Twenty sub-steps a sample, all in f64. Each part is checked against a closed form by the tests
//! beside it; what the sensors read and what was true are kept apart.

pub mod contact;
pub mod material;
pub mod motor;
pub mod rig;
pub mod sensors;

pub use contact::{Contact, Law, MODES, Memory};
pub use material::{GEL, Material, PLASTIC};
pub use motor::{Motor, MotorState};
pub use rig::{Rig, Run, Stage, Truth};
pub use sensors::{Encoder, LoadCell, Sensors};
