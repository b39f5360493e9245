//! Teleoperation: the command, the bridge between two boards, and impedance reflection.

mod bridge;
#[cfg(unix)]
mod bridge_processes;
mod command;
#[path = "../common/mod.rs"]
mod common;
mod reflection;
#[cfg(unix)]
#[path = "../common/terminal.rs"]
mod terminal_end;
