//! `palpate gap` on rigs with a known truth and on measured records, and the way of a finding back to the board.

#[path = "../common/mod.rs"]
mod common;
mod compensation;
mod input;
mod joints;
mod machines;
mod records;
mod rigs;
mod steps;
