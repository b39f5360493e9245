//! What the workflow comes to: verdict, effects, regions, curves.

mod region;
mod result;

pub use region::{Region, words};
pub use result::{Advised, Curves, Finding, Known, Named, Tried, Verdict, times_larger};

/// Name of the file that an advised motion is written to.
pub const MOTION: &str = "motion.toml";
