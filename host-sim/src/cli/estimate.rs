//! `palpate estimate`: the board's step over a log, or a fit of the whole log.

mod args;
mod batch;
mod files;
mod json;
mod law;
mod mcap;
mod methods;
mod print;
mod show;
mod thin;
mod whole_log;

use std::error::Error;
use std::io;
use std::path::Path;

pub use args::{BatchArgs, EstimateArgs};
pub(crate) use json::events;
pub use methods::MethodChoice;
pub(crate) use print::faults_in_words;
use serde_json::{Map, Value};
pub use show::{Shown, document};

use crate::batch::{Options, batch, batch_instead, is_dented, lateness};
use crate::cli::logs::folder;
use crate::cli::summary::{Answer, Failure, each};
use crate::estimate::{Choices, Estimation, estimate, low_passed, settled, undrifted};
use crate::json::write_json;
use crate::kind;
use crate::log::UniformLog;
use crate::output::try_folder;
use crate::report::called;
use crate::settings::Settings;
use estimator_core::estimate::method::Method;

/// Runs the verb.
///
/// # Errors
/// A [`Diagnostic`](crate::diagnostic::Diagnostic) for input that cannot be used; else what the file system says.
pub fn run(args: &EstimateArgs) -> Result<(), Box<dyn Error>> {
    let settings = args.settings()?;
    if let Some(out) = &args.out {
        try_folder(out)?;
    }
    let task = Task::new(args, &settings)?;
    each(&args.logs, args.out.as_deref(), &|file, name| {
        task.run(file, name)
    })
}

/// What is done with every log.
struct Task<'a> {
    args: &'a EstimateArgs,
    settings: &'a Settings,
    /// The methods to try; none for a fit of the whole log.
    methods: Vec<Method>,
    /// What a whole log is fitted with, where that may be done.
    options: Option<Options>,
}

impl<'a> Task<'a> {
    fn new(args: &'a EstimateArgs, settings: &'a Settings) -> Result<Self, Box<dyn Error>> {
        // What is held, other than the surface, only a fit of the whole log can hold.
        let whole_log = args.wants_whole_log() || (args.is_auto() && settings.needs_whole_log());
        let mut methods = Vec::new();
        if !whole_log {
            args.batch.refuse()?;
            settings.refuse()?;
            methods = methods::methods(args.law, args.method)?;
        }
        let options = match whole_log || args.is_auto() {
            true => Some(whole_log::options(args, settings)?),
            false => None,
        };
        Ok(Task {
            args,
            settings,
            methods,
            options,
        })
    }

    /// Reads a file and estimates every recording in it. The files of the only recording of the only file go into
    /// `--out` itself.
    fn run(&self, file: &Path, name: Option<&str>) -> Result<Vec<Answer>, Failure> {
        let logs = self.args.read(file)?;
        let is_one = logs.len() == 1;
        let mut answers = Vec::new();
        for log in logs {
            let path = match is_one {
                true => file.to_path_buf(),
                false => log.path.clone(),
            };
            let folder = folder(name, is_one, file, &path);
            answers.push(self.answer(file, &path, folder.as_deref(), &log)?);
        }
        Ok(answers)
    }

    fn answer(
        &self,
        file: &Path,
        path: &Path,
        folder: Option<&str>,
        log: &UniformLog,
    ) -> Result<Answer, Failure> {
        let kind = log.kind.unwrap_or_default();
        self.args.batch.refuse_on(kind)?;
        // What the force does besides the contact is taken off before any method sees it.
        let settled = settled(log);
        let log = settled.as_ref().unwrap_or(log);
        let undrifted = undrifted(log);
        let log = undrifted.as_ref().unwrap_or(log);
        let low_passed = low_passed(log);
        let log = low_passed.as_ref().unwrap_or(log);
        kind::worded(kind, || self.worded(file, path, folder, log))
    }

    fn worded(
        &self,
        file: &Path,
        path: &Path,
        folder: Option<&str>,
        log: &UniformLog,
    ) -> Result<Answer, Failure> {
        let (mut text, json) = self.fitted(file, path, folder, log)?;
        if let Some(folder) = self.args.folder(folder) {
            let report = folder.join("report.html");
            text.push_str(&format!("report: {}\n", report.display()));
        }
        Ok(Answer {
            path: path.to_path_buf(),
            text,
            row: row(&json),
            json,
        })
    }

    /// Estimates a recording, writes its files, and gives what is said of it and its JSON.
    fn fitted(
        &self,
        file: &Path,
        path: &Path,
        folder: Option<&str>,
        log: &UniformLog,
    ) -> Result<(String, Value), Failure> {
        let (args, settings) = (self.args, self.settings);
        let whole = |fitted| whole_log::told(args, file, path, folder, log, &fitted);
        if let (true, Some(options)) = (self.methods.is_empty(), &self.options) {
            return Ok(whole(batch(log, settings.config, options)?)?);
        }
        let choices = Choices {
            reference_depth_m: args.reference_depth,
            surface_m: args.surface.or(settings.held.value("surface")),
        };
        let mut estimation = estimate(log, settings.config, &self.methods, choices)?;
        estimation.take_dent(is_dented(log, &estimation));
        estimation.take_lateness(lateness(log, &estimation));
        if let Some(options) = &self.options {
            let fitted = batch_instead(log, settings.config, options, &estimation)?;
            if let Some(fitted) = fitted {
                return Ok(whole(fitted)?);
            }
        }
        let numbers = numbers(log, &estimation);
        if let Some(folder) = args.folder(folder) {
            let inputs: Vec<&Path> = std::iter::once(file)
                .chain(args.compensate.as_deref())
                .collect();
            write_json(&folder.join("estimate.json"), &numbers)?;
            write(
                &folder,
                &inputs,
                path,
                log,
                &estimation,
                args.every as usize,
            )?;
            if args.mcap {
                // A log that was too fast for the estimator is there as it saw it.
                let seen = Some((&estimation.replay, args.every as usize));
                mcap::write(&folder.join("estimate.mcap"), estimation.log(log), seen)?;
            }
        }
        Ok((print::summary(path, log, &estimation), numbers))
    }
}

/// The content of `estimate.json`.
fn numbers(log: &UniformLog, estimation: &Estimation) -> Value {
    let context = files::Context {
        method: MethodChoice::of(estimation.replay.config.method).name(),
        reference_depth_m: f64::from(estimation.replay.config.reference.depth_m),
        noise_n: estimation.replay.noise_n,
        selection: &estimation.selection,
        compensated: &log.compensated.effects,
        notes: &estimation.notes,
    };
    files::json(&estimation.outcome, &context)
}

fn write(
    folder: &Path,
    inputs: &[&Path],
    path: &Path,
    log: &UniformLog,
    estimation: &Estimation,
    every: usize,
) -> io::Result<()> {
    files::write_csv(&folder.join("estimate.csv"), &estimation.replay, every)?;
    let title = format!("Estimate of {}", called(path));
    let shown = Shown::new("", log, estimation);
    document(vec![shown], &title, inputs)?.write(&folder.join("report.html"))
}

/// A log's row in the table of several: what was found, and how far it can be trusted.
fn row(json: &Value) -> Map<String, Value> {
    let mut row = Map::new();
    for key in ["status", "status_reason", "law"] {
        row.insert(key.into(), json[key].clone());
    }
    for (name, parameter) in json["parameters"].as_object().into_iter().flatten() {
        row.insert(name.clone(), parameter["value"].clone());
        row.insert(format!("{name}_std_error"), parameter["std_error"].clone());
    }
    for key in [
        "force_rmse_n",
        "force_noise_n",
        "method",
        "reference_depth_m",
        "settled_at_s",
    ] {
        row.insert(key.into(), json[key].clone());
    }
    let touches = json["touches"].as_array().map_or(0, Vec::len);
    row.insert("touches".into(), touches.into());
    let modulus = &json["modulus"];
    if modulus.is_object() {
        row.insert("modulus_pa".into(), modulus["value"].clone());
        row.insert("modulus_pa_std_error".into(), modulus["std_error"].clone());
    }
    row
}
