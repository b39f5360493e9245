//! Palpate on a motor controller: everything but the tasks (`main.rs`) and the end of a program that cannot
//! go on (`halt.rs`). It is a library, so that the link proof (`bin/panic_free.rs`) consists of the code that
//! runs.
#![no_std]
#![deny(missing_docs)]

pub mod board;
pub mod crash;
pub mod driver;
pub mod force;
pub mod sampling;
pub mod service;
pub mod stack;
pub mod systick;
pub mod telemetry;
