//! Logs: CSV with a header, `t_s,x_m,f_n` and whatever else was recorded.
//!
//! Position grows into the material and a positive force pushes the probe out; SI units. Files of
//! other machines are read with a [`ColumnMap`] that names their columns, signs and units. What a
//! reader of the log should know (rows left out, stamps that repeat) stands in [`Log::notes`].

mod agreed;
mod arrival;
mod cell;
mod channel;
mod coarse;
mod columns;
mod encoding;
mod fields;
mod guess;
mod mcap;
mod names;
mod orientation;
mod origin;
mod preamble;
mod question;
mod read;
mod record;
mod resample;
mod sampling;
mod source;
mod stamp;
mod timing;
mod uniform;
mod units;
mod write;

pub use agreed::agreed_kind;
pub use channel::Channel;
pub use columns::ColumnMap;
pub use mcap::{McapTopics, write_mcap};
pub use origin::SourceColumns;
pub use record::{ExtraColumn, FEWEST_SAMPLES, Log, ReadOptions};
pub use sampling::{Drops, Sampling, Stamps};
pub use source::STANDARD_INPUT;
pub(crate) use source::bytes;
pub use timing::{Gap, Timing};
pub use uniform::{Compensated, Taken, UniformLog};
