//! `palpate gap` on the command line.

mod files;
mod motion;
mod plan;
pub mod print;

pub use files::json;

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::cli::{ReadingArgs, progress::Bar, reading::positive};
use crate::diagnostic::Diagnostic;
use crate::gap::{self, Finding, MOTION, Options, Plan, gap_with_progress};
use crate::json::write_json;
use crate::kind;
use crate::log::UniformLog;
use crate::model::Model;
use crate::motion::Motion;
use crate::output::{result, say, try_folder};

/// Arguments of `palpate gap`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate gap --model base.toml --log measured.csv --out result\n  \
    palpate gap --model drive.toml --log run1.csv --log run2.csv --bandwidth 20 --out result\n  \
    palpate gap --plan --model base.toml --motion motion.toml --noise 0.02\n\n\
    The verdict is one of no_missing_effect, missing_effects, ambiguous, partly_explained, unexplained; \
    exit status 0 whichever it is."
)]
pub struct GapArgs {
    /// The base model (TOML): what the simulation knows. Values are starting points unless fixed.
    #[arg(long, value_name = "FILE")]
    pub model: PathBuf,
    /// A log of the rig; several logs of one rig are fitted together.
    #[arg(
        long = "log",
        value_name = "LOG",
        required_unless_present = "plan",
        conflicts_with = "plan"
    )]
    pub logs: Vec<PathBuf>,
    /// Before any log: which effects a motion will show and tell apart, and what to record as well.
    #[arg(long)]
    pub plan: bool,
    /// With --plan: the motion file (TOML), as simulate takes it; a palpation by default.
    #[arg(long, value_name = "FILE", requires = "plan", conflicts_with = "logs")]
    pub motion: Option<PathBuf>,
    /// With --plan: standard deviation of the force noise (N); the model's sensor by default.
    #[arg(long, value_name = "N", requires = "plan", conflicts_with = "logs", value_parser = positive_n)]
    pub noise: Option<f64>,
    /// Compare both forces below this frequency (Hz) only: a zero-phase low-pass on both.
    #[arg(long, value_name = "HZ", value_parser = positive_hz)]
    pub bandwidth: Option<f64>,
    /// Where report.html, gap.json, model.toml and gap.csv go, or plan.json; and motion.toml, where a
    /// motion is advised.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How the logs are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

fn positive_hz(text: &str) -> Result<f64, String> {
    positive(text, "a positive frequency in Hz, such as 20")
}

fn positive_n(text: &str) -> Result<f64, String> {
    positive(text, "a positive standard deviation in N, such as 0.02")
}

/// Says what a motion will show, before any log.
fn plan_motion(args: &GapArgs) -> Result<(), Box<dyn Error>> {
    let model = Model::read(&args.model)?;
    let named = args
        .motion
        .as_ref()
        .filter(|path| path.as_os_str() != "palpation");
    let motion = named.map(|path| Motion::read(path)).transpose()?;
    let plan = gap::plan(&model, motion.as_ref(), args.noise, &Options::default())?;
    kind::worded(model.kind.unwrap_or_default(), || tell_plan(args, &plan))
}

/// Writes the files of a plan and prints its summary.
fn tell_plan(args: &GapArgs, plan: &Plan) -> Result<(), Box<dyn Error>> {
    let json = plan::json(plan);
    if let Some(folder) = &args.out {
        try_folder(folder)?;
        motion::put(folder, plan::motion(plan).as_deref())?;
        write_json(&folder.join("plan.json"), &json)?;
    }
    result(&json)?;
    say(plan::summary(plan))?;
    if let Some(folder) = args
        .out
        .as_ref()
        .filter(|_| !plan::advised(plan).is_empty())
    {
        say(format!(
            "  motion          {}\n",
            folder.join(MOTION).display()
        ))?;
    }
    Ok(())
}

/// Reads the inputs, finds what is missing, writes the files and prints a summary.
///
/// # Errors
/// A [`Diagnostic`] for a model or a log that cannot be used; an I/O error if a file cannot be
/// written.
pub fn run(args: &GapArgs) -> Result<(), Box<dyn Error>> {
    if args.plan {
        return plan_motion(args);
    }
    let clock = Instant::now();
    let model = Model::read(&args.model)?;
    if let Some(folder) = &args.out {
        try_folder(folder)?;
    }
    let read = args.logs.iter().map(|path| args.reading.read(path));
    let logs: Vec<Vec<UniformLog>> = read.collect::<Result<_, Diagnostic>>()?;
    let logs: Vec<UniformLog> = logs.into_iter().flatten().collect();
    let options = Options {
        bandwidth_hz: args.bandwidth,
        ..Options::default()
    };
    let bar = Bar::new();
    let finding = gap_with_progress(&model, &logs, &options, &bar)?;
    drop(bar);
    let kind = finding.model.kind.unwrap_or_default();
    kind::worded(kind, || tell(args, &finding, clock))
}

/// Writes the files of a finding and prints its summary.
fn tell(args: &GapArgs, finding: &Finding, clock: Instant) -> Result<(), Box<dyn Error>> {
    let seconds = clock.elapsed().as_secs_f64();
    let json = files::json(finding, seconds);
    if let Some(folder) = &args.out {
        let inputs = files::Inputs {
            model: &args.model,
            logs: &args.logs,
        };
        files::write(folder, finding, &inputs, &json)?;
    }
    result(&json)?;
    say(print::summary(finding))?;
    say(format!("  time        {seconds:.1} s\n"))?;
    if finding.advised.is_some() {
        say(match &args.out {
            Some(folder) => format!("  motion      {}\n", folder.join(MOTION).display()),
            None => format!("  motion      --out DIR writes it to DIR/{MOTION}\n"),
        })?;
    }
    if let Some(folder) = &args.out {
        say(format!(
            "  report      {}\n",
            folder.join("report.html").display()
        ))?;
    }
    Ok(())
}
