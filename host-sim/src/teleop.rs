//! Teleoperation: an operator moves a master, a slave touches an environment, a channel lies in between.
//!
//! The system of Biagiotti & Melchiorri, Fig. 1: both manipulators, the operator, the channel with its delay,
//! jitter and losses, and eight schemes of coupling behind one trait, measured against each other. The
//! impedance reflection runs the boards' own code at both ends.

pub mod board;
pub mod bridge;
pub mod channel;
pub mod compare;
pub mod device;
pub mod environment;
pub mod file;
pub mod hand;
pub mod held;
pub mod json;
pub mod limit;
pub mod measure;
pub mod notice;
pub mod operator;
pub mod options;
pub mod scheme;
pub mod system;
pub mod trace;

pub use compare::{Cell, Grid, compare};
pub use limit::{Limit, limit};
pub use measure::{Measures, measure};
pub use options::{Options, SchemeId};
pub use system::System;
pub use trace::{Row, Trace};
