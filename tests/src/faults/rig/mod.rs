//! The rig of the fault table: a probe that follows a motion exactly, a Hunt–Crossley material, a load
//! cell and an encoder, integrated at 20 kHz in plain f64. It uses no code of `estimator-core` or
//! `host-sim`.

pub mod case;
pub mod fault;
pub mod material;
pub mod motion;
pub mod plan;
pub mod sensors;
pub mod world;
pub mod write;

/// Sub-steps a second.
pub const FINE_HZ: f64 = 20_000.0;
/// Samples a second.
pub const RATE_HZ: f64 = 1000.0;
/// Sub-steps a sample.
pub const SUBSTEPS: usize = 20;
/// Noise of the force (N rms), unless the fault is its noise.
pub const NOISE_N: f64 = 0.02;
/// Step of the force channel (N).
pub const FORCE_STEP_N: f64 = 5e-3;
/// A count of the encoder (m).
pub const COUNT_M: f64 = 1e-6;
/// The depth at which stiffness and damping hold (m).
pub const REFERENCE_M: f64 = 1e-3;
