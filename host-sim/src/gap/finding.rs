//! The finding of the workflow: verdict, effects, regions, curves.

mod change;
mod episode;
mod parameter;
mod region;
mod result;

pub(crate) use change::changes;
pub use change::{Change, ChangesSince, changes_in_words};
pub use episode::Episode;
pub use parameter::ParameterEstimate;
pub use region::{Pattern, Region, regions_in_words, share_in_words};
pub(in crate::gap) use result::NEARLY_NOISE;
pub use result::{
    AdvisedMotion, Candidate, Curves, Finding, Grade, MissingEffect, Next, Support, Verdict,
    times_larger,
};

/// Name of the file that an advised motion is written to.
pub const MOTION: &str = "motion.toml";
