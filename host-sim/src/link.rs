//! The host's side of a board: a port to it, the frames that come over it, and what a person does
//! with them.
//!
//! A port is a serial line, the working directory of the emulator, or a simulated board that runs
//! the core's own protocol, sampling and settings code.

pub mod backup;
pub mod board;
pub mod device;
pub mod port;
pub mod record;
pub mod world;

pub use board::SimulatedBoard;
pub use device::Device;
pub use port::Port;
