//! What the report of a run is made of.

use crate::report::Provenance;
use crate::teleop::measure::transparency::Line;
use crate::teleop::{Cell, Limit, Measures, Options, SchemeId, Trace};

/// What the report of a run is made of.
#[derive(Clone, Debug)]
pub struct TeleopReport<'a> {
    /// What was run.
    pub options: &'a Options,
    /// What happened.
    pub trace: &'a Trace,
    /// What it was like.
    pub measures: &'a Measures,
    /// The transparency of some schemes on the same channel, the run's own first.
    pub transparency: &'a [(SchemeId, Vec<Line>)],
    /// All schemes over delay and loss.
    pub map: &'a [Cell],
    /// Up to which round trip the scheme comes to rest.
    pub limit: Limit,
    /// What of the input has no effect.
    pub notes: &'a [String],
    /// What the report was made from.
    pub provenance: Provenance,
}
