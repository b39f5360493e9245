//! `palpate estimate`: the board's step over a log, or a fit of the whole log.

mod batch;
mod files;
mod methods;
mod print;
mod show;
mod whole_log;

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use estimator_core::Config;
use estimator_core::physics::law::LawId;

pub use methods::MethodChoice;
pub use show::{Shown, document};
pub use whole_log::BatchArgs;

use crate::cli::ReadingArgs;
use crate::diagnostic::Diagnostic;
use crate::estimate::{Choices, Estimation, estimate};
use crate::log::UniformLog;
use crate::output::say;

/// Arguments of `palpate estimate`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  palpate estimate log.csv --law hunt_crossley --out result\n  \
    palpate estimate instron.csv --columns \"t=Time[ms]*1e-3,x=pos_mm*1e-3,f=-Fz\"\n  \
    palpate estimate indentation.csv --method batch --indenter sphere:0.003 --out result\n  \
    palpate estimate log.csv --compensate model.toml --out result"
)]
pub struct EstimateArgs {
    /// Logs: CSV with t_s (s), x_m (m, growing into the material), f_n (N, pushing out), or .csv.gz.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The contact law; auto takes the one that explains the force best.
    #[arg(long, value_parser = law_choice(), default_value = AUTO)]
    pub law: LawChoice,
    /// The estimator; by default the law's own.
    #[arg(long, value_enum)]
    pub method: Option<MethodChoice>,
    /// Where estimate.json, estimate.csv and report.html go; a folder per log if there are several.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Estimator configuration (TOML): filter, contact, forgetting, initial values.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Depth (m) at which stiffness and damping are reported; 1 mm unless the log is of another scale.
    #[arg(long, value_name = "M", value_parser = positive)]
    pub reference_depth: Option<f64>,
    /// Position of the surface (m), if it is known; otherwise it is found, or taken from the impact.
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = finite)]
    pub surface: Option<f64>,
    /// Take the effects of the rig in this model (TOML), such as `palpate gap` writes, off the log
    /// before anything else: friction, drag, inertia, lag, delay, compliance, ….
    #[arg(long, value_name = "FILE")]
    pub compensate: Option<PathBuf>,
    /// Write every N-th sample into estimate.csv.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// What is given for a fit of the whole log.
    #[command(flatten)]
    pub batch: BatchArgs,
    /// How the log is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl EstimateArgs {
    /// Reads a log and takes off it what the rig adds.
    fn read(&self, path: &Path) -> Result<UniformLog, Diagnostic> {
        let log = self.reading.read(path)?;
        match &self.compensate {
            None => Ok(log),
            Some(model) => crate::compensate::read(log, model),
        }
    }
}

/// The law on the command line; `None` takes the one that explains the force best.
pub type LawChoice = Option<LawId>;

const AUTO: &str = "auto";

fn law_choice() -> impl TypedValueParser<Value = LawChoice> {
    let auto = PossibleValue::new(AUTO).help("The one that explains the force best");
    let touched = LawId::ALL.iter().filter(|law| **law != LawId::Free);
    let laws = touched.map(|law| {
        let value = PossibleValue::new(law.name()).help(law.info().summary);
        value.aliases(law.info().alias)
    });
    PossibleValuesParser::new(std::iter::once(auto).chain(laws)).map(|name| LawId::from_name(&name))
}

fn positive(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err("must be positive, in metres".into())
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let value: f64 = text
        .parse()
        .map_err(|_| "must be a number in metres, such as 0.001")?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err("must be finite".into())
    }
}

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`] for input that cannot be used; else what the file system says.
pub fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    if whole_log::wanted(args) {
        return whole_log::run(args);
    }
    args.batch.refuse()?;
    let methods = methods::methods(args.law, args.method)?;
    let base = match &args.config {
        Some(path) => crate::settings::read(path)?,
        None => Config::default(),
    };
    let choices = Choices {
        reference_depth_m: args.reference_depth,
        surface_m: args.surface,
    };
    for (path, name) in args.logs.iter().zip(names(&args.logs)) {
        let log = args.read(path)?;
        let estimation = estimate(&log, base, &methods, choices)?;
        say(print::summary(path, &log, &estimation))?;
        if let Some(out) = &args.out {
            let folder = if args.logs.len() > 1 {
                out.join(name)
            } else {
                out.clone()
            };
            let inputs: Vec<&Path> = std::iter::once(path.as_path())
                .chain(args.compensate.as_deref())
                .collect();
            write(&folder, &inputs, &log, &estimation, args.every as usize)?;
            let report = folder.join("report.html");
            say(format!("report: {}\n", report.display()))?;
        }
    }
    Ok(())
}

/// A folder for each log: its name without endings, and with a number where an earlier log has the
/// same (`simulate` calls every one log.csv).
fn names(logs: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for path in logs {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.trim_end_matches(".gz").trim_end_matches(".csv");
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let free = std::iter::once(name.to_string())
            .chain(numbered)
            .find(|name| !names.contains(name));
        names.extend(free);
    }
    names
}

fn write(
    folder: &Path,
    inputs: &[&Path],
    log: &UniformLog,
    estimation: &Estimation,
    every: usize,
) -> Result<(), Box<dyn Error>> {
    let context = files::Context {
        method: MethodChoice::of(estimation.replay.config.method).name(),
        reference_depth_m: f64::from(estimation.replay.config.reference.depth_m),
        noise_n: estimation.replay.noise_n,
        selection: &estimation.selection,
        compensated: &log.compensated.effects,
        notes: &estimation.notes,
    };
    crate::json::write_json(
        &folder.join("estimate.json"),
        &files::json(&estimation.outcome, &context),
    )?;
    files::write_csv(&folder.join("estimate.csv"), &estimation.replay, every)?;
    let title = format!("Estimate of {}", inputs[0].display());
    let shown = Shown::new("", log, estimation);
    document(&[shown], &title, inputs)?.write(&folder.join("report.html"))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_log_is_its_name_without_endings() {
        assert_eq!(names(&["a/b/log.1.csv.gz".into()]), ["log.1"]);
    }

    #[test]
    fn logs_of_one_name_do_not_overwrite_each_other() {
        let logs = ["a/log.csv", "b/log.csv", "log-2.csv", "c/log.csv.gz"].map(PathBuf::from);
        assert_eq!(names(&logs), ["log", "log-2", "log-2-2", "log-3"]);
    }
}
