//! Logs: CSV with a header, `t_s,x_m,f_n` and whatever else was recorded.
//!
//! Position grows into the material and a positive force pushes the probe out; SI units. Files of
//! other machines are read with a [`ColumnMap`] that names their columns, signs and units. What a
//! reader of the log should know (rows left out, stamps that repeat) stands in [`Log::notes`].

mod cell;
mod columns;
mod preamble;
mod read;
mod record;
mod resample;
mod sampling;
mod source;
mod timing;
mod write;

pub use columns::{Channel, ColumnMap};
pub use record::{ExtraColumn, FEWEST_SAMPLES, Log, ReadOptions};
pub use resample::{Compensated, UniformLog};
pub use sampling::{Drops, Sampling, Stamps};
pub use timing::{Gap, Timing};
