//! What impedance reflection has to reach in teleoperation, row by row.

pub mod bar;
pub mod hand;
