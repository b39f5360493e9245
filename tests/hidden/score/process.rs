//! A program that is run, with a limit and the time that it took.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A run that takes longer has failed (s).
const TOO_LONG_S: u64 = 300;
/// Ticks a second of the times in /proc/PID/stat, on every Linux.
const TICKS_HZ: f64 = 100.0;

/// What a run took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Took {
    /// Wall clock (s).
    pub(crate) seconds: f64,
    /// Of all threads (s), to 10 ms; NaN where there is no /proc.
    pub(crate) cpu_s: f64,
}

/// Runs to the end; what it says goes to `stderr`.
pub(crate) fn run(command: &mut Command, stderr: &Path) -> Result<Took, String> {
    let program = command.get_program().to_owned();
    let log = File::create(stderr).map_err(|e| format!("{}: {e}", stderr.display()))?;
    let started = Instant::now();
    let mut child = command
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    let stat = format!("/proc/{}/stat", child.id());
    let mut cpu_s = f64::NAN;
    let status = loop {
        // Before the status is asked for: that ends the process's record.
        let said = std::fs::read_to_string(&stat).ok();
        cpu_s = said.and_then(|text| cpu(&text)).unwrap_or(cpu_s);
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            break status;
        }
        if started.elapsed() > Duration::from_secs(TOO_LONG_S) {
            // It may have ended meanwhile.
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("longer than {TOO_LONG_S} s"));
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let seconds = started.elapsed().as_secs_f64();
    if status.success() {
        Ok(Took { seconds, cpu_s })
    } else {
        Err(format!("{status}, see {}", stderr.display()))
    }
}

/// User and system time (s) of a line of /proc/PID/stat: the 14th and 15th word; the second, in
/// brackets, may hold blanks.
pub(crate) fn cpu(stat: &str) -> Option<f64> {
    let (_, rest) = stat.rsplit_once(')')?;
    let mut ticks = rest.split_whitespace().skip(11).take(2);
    let user: f64 = ticks.next()?.parse().ok()?;
    let system: f64 = ticks.next()?.parse().ok()?;
    Some((user + system) / TICKS_HZ)
}
