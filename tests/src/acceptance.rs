//! The acceptance table: what each method finds on simulated palpations whose truth is known.

pub mod cases;
pub mod floor;
pub mod relaxing;
pub mod rows;
pub mod score;
