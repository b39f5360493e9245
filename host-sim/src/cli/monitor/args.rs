//! Arguments of `palpate monitor`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `palpate monitor`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  palpate monitor --port /dev/ttyUSB0\n  palpate monitor --log run7/log.csv --speed 2\n\n\
    On a terminal it fills the screen: p or space pauses the picture, m marks the instant, r begins and ends a\n\
    recording, q ends it. In a pipe it is a line for every look; Ctrl-C ends it."
)]
pub struct MonitorArgs {
    /// Serial port, the emulator's working directory, or `simulated`: a new board every time.
    #[arg(long, value_name = "PORT", required_unless_present = "log")]
    pub port: Option<String>,
    /// Watch a log in place of a board: the board's own step over it, at its own pace.
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    pub log: Option<PathBuf>,
    /// Pace of a log: 1 is its own, 10 is ten times as fast.
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, requires = "log", value_parser = pace)]
    pub speed: f64,
    /// Time between two looks (s).
    #[arg(long, value_name = "S", default_value_t = 0.2, value_parser = interval)]
    pub every: f64,
    /// End after so many looks.
    #[arg(long, value_name = "N")]
    pub looks: Option<u64>,
    /// Where recordings go, numbered folders in it; made at the first.
    #[arg(long, value_name = "DIR", default_value = "palpate-monitor")]
    pub out: PathBuf,
    /// Plain lines on a terminal, too.
    #[arg(long)]
    pub plain: bool,
    /// Serve what comes to Foxglove and PlotJuggler, at this address.
    #[cfg(feature = "foxglove")]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:8765")]
    pub foxglove: Option<String>,
}

impl Default for MonitorArgs {
    fn default() -> Self {
        MonitorArgs {
            port: None,
            log: None,
            speed: 1.0,
            every: 0.2,
            looks: None,
            out: "palpate-monitor".into(),
            plain: false,
            #[cfg(feature = "foxglove")]
            foxglove: None,
        }
    }
}

fn interval(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.02..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("a time from 0.02 to 3600 s".into()),
    }
}

fn pace(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(times) if (0.01..=1e4).contains(&times) => Ok(times),
        _ => Err("a number from 0.01 to 10000".into()),
    }
}
