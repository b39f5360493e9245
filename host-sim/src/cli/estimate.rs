//! `palpate estimate`: the board's step over a log, or a fit of the whole log.

mod args;
mod batch;
mod files;
mod json;
mod law;
mod methods;
mod print;
mod show;
mod whole_log;

use std::error::Error;
use std::path::Path;

pub use args::{BatchArgs, EstimateArgs};
pub use methods::MethodChoice;
pub use show::{Shown, document};

use args::names;

use crate::batch::{batch_instead, lateness};
use crate::estimate::{Choices, Estimation, estimate};
use crate::log::UniformLog;
use crate::output::say;

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`](crate::diagnostic::Diagnostic) for input that cannot be used; else what the file system says.
pub fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    let settings = args.settings()?;
    // What is held, other than the surface, only a fit of the whole log can hold.
    if args.wants_whole_log() || (args.is_auto() && settings.needs_whole_log()) {
        return whole_log::run(args);
    }
    args.batch.refuse()?;
    settings.refuse()?;
    let methods = methods::methods(args.law, args.method)?;
    let choices = Choices {
        reference_depth_m: args.reference_depth,
        surface_m: args.surface.or(settings.held.value("surface")),
    };
    for (path, name) in args.logs.iter().zip(names(&args.logs)) {
        let log = args.read(path)?;
        let mut estimation = estimate(&log, settings.config, &methods, choices)?;
        estimation.take_lateness(lateness(&log, &estimation));
        if args.is_auto() {
            let options = whole_log::options(args, &settings)?;
            let fitted = batch_instead(&log, settings.config, &options, &estimation)?;
            if let Some(fitted) = fitted {
                whole_log::tell(args, path, &name, &log, &fitted)?;
                continue;
            }
        }
        say(print::summary(path, &log, &estimation))?;
        if let Some(folder) = args.folder(&name) {
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
