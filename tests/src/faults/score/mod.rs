//! What the estimator says of a log with a fault, and whether that is right.

pub mod cell;
pub mod efficient;
pub mod fit;
pub mod gap;
pub mod judge;
pub mod run;
pub mod snapshot;
pub mod table;
