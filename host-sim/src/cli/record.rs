//! `palpate record`: a board's bytes into a file as they come, and that file as a log.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;

use crate::cli::progress::Spinner;
use crate::diagnostic::Diagnostic;
use crate::interrupt;
use crate::kind::{Kind, kind_named};
use crate::link::{Device, device::Statistics, port, record::convert, record::record};
use crate::number::counted;
use crate::output::say;

/// Arguments of `palpate record`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate record --port /dev/ttyUSB0 --seconds 60 --out run7\n  \
    palpate record --convert run7\n\n\
    Without --seconds it records until Ctrl-C, and then writes the log as well. After a crash --convert makes it."
)]
pub struct RecordArgs {
    /// Serial port, the emulator's working directory, or `simulated`: a simulated board, new at every start.
    #[arg(long, value_name = "PORT", required_unless_present = "convert")]
    pub port: Option<String>,
    /// How long (s), from when the settings have been read; what came while they were, about 0.4 s, is kept as well. A port
    /// that falls silent for 3 s ends a recording, too.
    #[arg(long, value_name = "S", requires = "port")]
    pub seconds: Option<f64>,
    /// Where recording.frames, settings.toml and log.csv go; made if missing.
    #[arg(long, value_name = "DIR", required_unless_present = "convert")]
    pub out: Option<PathBuf>,
    /// Whether the board's machine is linear (log in m and N) or rotary (rad and N m).
    #[arg(long, value_name = "KIND", default_value = "linear", value_parser = kind_named)]
    pub kind: Kind,
    /// Make the log of a recording that was not ended: the folder with its recording.frames.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["port", "out"])]
    pub convert: Option<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`] for a port or a folder that is not there or has a recording already; an I/O
/// error if the disk is full or nothing comes.
pub fn run(args: &RecordArgs) -> Result<(), Box<dyn Error>> {
    if let Some(folder) = &args.convert {
        say(convert(folder, args.kind)?)?;
        return Ok(());
    }
    let (Some(name), Some(folder)) = (&args.port, &args.out) else {
        return Err(Diagnostic::new("nothing to record")
            .remedy("give --port and --out")
            .into());
    };
    if let Some(seconds) = args.seconds.filter(|s| !s.is_finite() || *s <= 0.0) {
        let diagnostic =
            Diagnostic::new("the length of a recording must be positive").value(seconds);
        return Err(diagnostic.remedy("give --seconds greater than 0").into());
    }
    // Ctrl-C ends the recording as its length would: the log is written.
    interrupt::watch();
    let mut device = Device::new(port::open(name)?);
    let end = args.seconds.map(|s| (s * 1e6) as u64);
    let spinner = Spinner::new(1);
    let statistics = record(&mut device, folder, end)?;
    drop(spinner);
    say(said(&statistics))?;
    say(convert(folder, args.kind)?)?;
    Ok(())
}

fn said(statistics: &Statistics) -> String {
    format!(
        "{}, {} lost on the line, {} garbled\n",
        counted(statistics.frames as usize, "frame"),
        statistics.lost,
        statistics.garbled
    )
}
