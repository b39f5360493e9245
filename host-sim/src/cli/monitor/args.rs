//! Arguments of `palpate monitor`.

use std::path::PathBuf;

use clap::Args;

use crate::kind::{Kind, kind_named};

/// Arguments of `palpate monitor`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  palpate monitor --port /dev/ttyUSB0\n  palpate monitor --log run7/log.csv --speed 2\n\n\
    On a terminal it fills the screen: p or space pauses the picture, m marks the instant, r begins and ends a\n\
    recording, q ends it. In a pipe it writes lines; Ctrl-C ends it."
)]
pub struct MonitorArgs {
    /// Serial port, the emulator's working directory, or `simulated`: a simulated board, new at every start.
    #[arg(long, value_name = "PORT", required_unless_present = "log")]
    pub port: Option<String>,
    /// Replay a log instead of a board, through the board's estimator and at the log's own pace.
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    pub log: Option<PathBuf>,
    /// Speed of the replay: 1 is real time, 10 is ten times as fast.
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, requires = "log", value_parser = pace)]
    pub speed: f64,
    /// Whether the board's machine is linear (m, N) or rotary (rad, N m); a log says it itself.
    #[arg(long, value_name = "KIND", requires = "port", value_parser = kind_named)]
    pub kind: Option<Kind>,
    /// Time between two pictures or lines (s).
    #[arg(long, value_name = "S", default_value_t = 0.2, value_parser = interval)]
    pub every: f64,
    /// End after this many pictures or lines.
    #[arg(long, value_name = "N")]
    pub looks: Option<u64>,
    /// Folder of the recordings, a numbered folder for each; made with the first.
    #[arg(long, value_name = "DIR", default_value = "palpate-monitor")]
    pub out: PathBuf,
    /// Plain lines on a terminal, too.
    #[arg(long)]
    pub plain: bool,
    /// Serve samples and estimates to Foxglove and PlotJuggler at this address.
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
            kind: None,
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
