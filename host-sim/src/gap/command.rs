//! `palpate gap` on the command line.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use super::{Options, files, gap, print};
use crate::diagnostic::Diagnostic;
use crate::estimate::ReadingArgs;
use crate::log::UniformLog;
use crate::model::Model;
use crate::output::say;

/// Arguments of `palpate gap`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate gap --model base.toml --log measured.csv --out result\n  \
    palpate gap --model drive.toml --log run1.csv --log run2.csv --bandwidth 20 --out result\n\n\
    The verdict is one of no_missing_effect, missing_effects, ambiguous, unexplained; \
    exit status 0 whichever it is."
)]
pub struct GapArgs {
    /// The base model (TOML): what the simulation knows. Values are starting points unless fixed.
    #[arg(long, value_name = "FILE")]
    pub model: PathBuf,
    /// A log of the rig; several logs of one rig are fitted together.
    #[arg(long = "log", value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// Compare both forces below this frequency (Hz) only: a zero-phase low-pass on both.
    #[arg(long, value_name = "HZ", value_parser = positive_hz)]
    pub bandwidth: Option<f64>,
    /// Where report.html, gap.json, model.toml and gap.csv go.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How the logs are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

fn positive_hz(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a positive frequency in Hz, such as 20".into()),
    }
}

/// Reads, finds, writes, says.
///
/// # Errors
/// A [`Diagnostic`] for a model or a log that cannot be used; an I/O error if a file cannot be
/// written.
pub fn run(args: &GapArgs) -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let model = Model::read(&args.model)?;
    let logs: Vec<UniformLog> = args
        .logs
        .iter()
        .map(|path| args.reading.read(path))
        .collect::<Result<_, Diagnostic>>()?;
    let options = Options {
        bandwidth_hz: args.bandwidth,
        ..Options::default()
    };
    let finding = gap(&model, &logs, &options)?;
    let seconds = clock.elapsed().as_secs_f64();
    if let Some(folder) = &args.out {
        let read = files::Read {
            model: &args.model,
            logs: &args.logs,
        };
        files::write(folder, &finding, &read, seconds)?;
    }
    say(print::summary(&finding, args.out.as_deref(), seconds))?;
    Ok(())
}
