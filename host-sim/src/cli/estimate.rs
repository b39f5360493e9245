//! `palpate estimate`: the board's step over a log, or a fit of the whole log.

mod args;
mod batch;
mod files;
mod law;
mod methods;
mod print;
mod show;
mod whole_log;

use std::error::Error;
use std::path::Path;

use estimator_core::Config;

pub use args::{BatchArgs, EstimateArgs};
pub use methods::MethodChoice;
pub use show::{Shown, document};

use args::names;

use crate::estimate::{Choices, Estimation, estimate};
use crate::log::UniformLog;
use crate::output::say;

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`](crate::diagnostic::Diagnostic) for input that cannot be used; else what the file system says.
pub fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    if args.wants_whole_log() {
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
    document(vec![shown], &title, inputs)?.write(&folder.join("report.html"))?;
    Ok(())
}
