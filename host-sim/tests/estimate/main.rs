//! `palpate estimate` on simulated logs whose truth is known, each room one kind of record: what is said, how sure it
//! is, and that nothing is wrong and `converged`.

mod beginning;
mod changes;
#[path = "../common/mod.rs"]
mod common;
mod conditioning;
mod contacts;
mod flicker;
mod low_pass;
mod power_law;
mod recovery;
mod sensing;
