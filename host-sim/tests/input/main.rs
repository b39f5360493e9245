//! What people bring to the command, right, odd or wrong, and what it answers.

mod bad_input;
mod brought;
#[path = "../common/mod.rs"]
mod common;
mod odd_input;
mod readme;
mod real_logs;
mod rotary;
mod several;
