//! The firmware in QEMU against the host. `cargo xtask test` builds what this needs and says where
//! it is.

mod budget;
mod codes;
mod commands;
mod compensation;
mod fields;
mod frames;
mod image;
mod joined;
mod rendering;
mod replay;
mod settings;

/// The length of a run: 100 s at 1 kHz.
const SAMPLES: usize = 100_000;
