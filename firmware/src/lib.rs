//! Palpate on a motor controller: everything but the tasks (`main.rs`) and where a program that cannot
//! go on ends (`halt.rs`). A library, so that the link proof (`bin/panic_free.rs`) is made of the code
//! that runs.
#![no_std]
#![deny(missing_docs)]

pub mod board;
pub mod driver;
pub mod force;
pub mod sampling;
pub mod service;
mod stack;
pub mod telemetry;
