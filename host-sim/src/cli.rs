//! The verbs of the command line, a file each: arguments, what a verb calls, what it writes and prints.
//! Nothing else knows of clap.

pub mod check;
pub mod config;
pub mod demo;
pub mod effects;
pub mod estimate;
pub mod gap;
mod logs;
pub mod manual;
pub mod monitor;
mod progress;
mod reading;
pub mod record;
pub mod simulate;
mod summary;
pub mod teleop;

pub use reading::ReadingArgs;
