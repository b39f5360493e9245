//! What a bridge was like when it has ended.

use super::endpoint::{Clock, Counts};
use super::run::MasterView;

/// What a bridge was like.
#[derive(Clone, Copy, Debug)]
pub struct Summary {
    /// Which end it was: `one_host`, `slave` or `master`.
    pub role: &'static str,
    /// How long it ran (s).
    pub duration_s: f64,
    /// What is known of the other end's clock; `None` on one host, or without the other end.
    pub clock: Option<Clock>,
    /// What has gone over it.
    pub counts: Counts,
    /// What the master does, where this end has it.
    pub master: Option<MasterView>,
}
