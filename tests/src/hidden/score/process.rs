//! Runs a program with a time limit and measures the time that it takes.

use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A run that takes longer than this has failed (s).
const TOO_LONG_S: u64 = 300;
/// The times in /proc/PID/stat have this many ticks a second, on every Linux.
const TICKS_HZ: f64 = 100.0;

/// The time that a run took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Took {
    /// Wall-clock time (s).
    pub(crate) seconds: f64,
    /// Processor time of all threads (s), to 10 ms; NaN where there is no /proc.
    pub(crate) cpu_s: f64,
}

/// Runs a program to its end; its standard error goes to the file `stderr`.
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

/// User plus system time (s) from a line of /proc/PID/stat: its 14th and 15th words. The second word, in
/// brackets, may hold blanks.
pub fn cpu(stat: &str) -> Option<f64> {
    let (_, rest) = stat.rsplit_once(')')?;
    let mut ticks = rest.split_whitespace().skip(11).take(2);
    let user: f64 = ticks.next()?.parse().ok()?;
    let system: f64 = ticks.next()?.parse().ok()?;
    Some((user + system) / TICKS_HZ)
}
