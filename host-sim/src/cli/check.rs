//! `palpate check`: what is in a log, before any law.

mod files;
mod sampling;

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use estimator_core::estimate::method::Method;
use estimator_core::{Config, Fault};
use serde_json::{Map, Value};

use crate::cli::ReadingArgs;
use crate::cli::estimate::faults_in_words;
use crate::cli::logs::folder;
use crate::cli::summary::{Answer, Failure, each};
use crate::estimate::{Choices, estimate};
use crate::inspect::{Inspection, suspicions};
use crate::json::write_json;
use crate::kind;
use crate::log::{Log, STANDARD_INPUT, Sampling, UniformLog};
use crate::number::quantity;
use crate::output::try_folder;
use crate::replay::{EventKind, EventMark};
use crate::stats::extent;
use crate::wrap::wrapped;

/// Arguments of `palpate check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  palpate check log.csv\n  palpate check runs --out checked")]
pub struct CheckArgs {
    /// Logs: CSV with t_s (s), x_m (m, growing into the material), f_n (N, pushing out), or what a machine
    /// exports; .gz, folders, patterns such as 'runs/*.csv', or - for standard input.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Where check.json goes; a folder per log, summary.csv and summary.json if there are several.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How the log is read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// Runs the verb.
///
/// # Errors
/// A [`crate::diagnostic::Diagnostic`] for a file that cannot be read.
pub fn run(args: &CheckArgs) -> Result<(), Box<dyn Error>> {
    if let Some(out) = &args.out {
        try_folder(out)?;
    }
    each(&args.logs, args.out.as_deref(), &|file, name| {
        let logs = Log::read_all(file, &args.reading.options())?;
        let is_one = logs.len() == 1;
        let checked = logs.into_iter().map(|log| {
            let folder = folder(name, is_one, file, &log.path);
            checked(args, folder.as_deref(), &log)
        });
        checked.collect()
    })
}

/// Checks a recording and writes its file.
fn checked(args: &CheckArgs, folder: Option<&str>, raw: &Log) -> Result<Answer, Failure> {
    kind::worded(raw.kind.unwrap_or_default(), || worded(args, folder, raw))
}

fn worded(args: &CheckArgs, folder: Option<&str>, raw: &Log) -> Result<Answer, Failure> {
    let log = raw.uniform()?;
    // Kelvin–Voigt: any contact will do to find the touches.
    let estimation = estimate(
        &log,
        Config::default(),
        &[Method::KELVIN_VOIGT],
        Choices::default(),
    )?;
    let facts = raw.sampling();
    let mut inspection = estimation.inspection;
    // The touches are those of what the estimator saw; noise and steps are those of the samples as they were taken, not
    // of means or of lines between them.
    inspection.noise_n = log.force_noise_n();
    inspection.force_step_n = facts.force_step_n;
    inspection.position_step_m = facts.position_step_m;
    // What the estimator says of a law that was taken for the touches alone is none of this verb's.
    let mut faults = estimation.outcome.events;
    faults.retain(EventMark::is_fault);
    let json = files::json(raw, &facts, &inspection, &faults);
    if let Some(out) = &args.out {
        let folder = folder.map_or(out.clone(), |folder| out.join(folder));
        write_json(&folder.join("check.json"), &json)?;
    }
    let name = match raw.path.as_os_str() == STANDARD_INPUT {
        true => "standard input".to_string(),
        false => raw.path.display().to_string(),
    };
    Ok(Answer {
        path: raw.path.clone(),
        text: describe(&name, raw, &facts, &log, (&inspection, &faults)),
        row: row(&json, &log, &inspection),
        json,
    })
}

/// A log's row in the table of several.
fn row(json: &Value, log: &UniformLog, inspection: &Inspection) -> Map<String, Value> {
    let mut row = Map::new();
    for key in ["samples", "duration_s"] {
        row.insert(key.into(), json[key].clone());
    }
    for key in ["rate_hz", "stamps", "missing"] {
        row.insert(key.into(), json["sampling"][key].clone());
    }
    row.insert("force_noise_n".into(), json["force_noise_n"].clone());
    row.insert("touches".into(), inspection.touches.len().into());
    let (good, _) = uses(inspection);
    row.insert("good_for".into(), good.join("; ").into());
    row.insert("suspicions".into(), suspicions(log).join("; ").into());
    row
}

/// The text of `check`: a screen at most for an ordinary log.
fn describe(
    name: &str,
    raw: &Log,
    facts: &Sampling,
    log: &UniformLog,
    (inspection, faults): (&Inspection, &[EventMark]),
) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = timing(&mut text, name, raw, facts)
        .and_then(|()| channels(&mut text, raw, inspection))
        .and_then(|()| happened(&mut text, faults))
        .and_then(|()| rest(&mut text, inspection))
        .and_then(|()| contacts(&mut text, inspection))
        .and_then(|()| verdict(&mut text, log, inspection));
    text
}

fn timing(text: &mut String, name: &str, raw: &Log, facts: &Sampling) -> std::fmt::Result {
    writeln!(text, "{name}")?;
    let lines = sampling::lines(raw, facts);
    for (number, line) in lines.iter().chain(&raw.notes).enumerate() {
        let lead = if number == 0 {
            "  time      "
        } else {
            "            "
        };
        writeln!(text, "{}", wrapped(lead, line))?;
    }
    Ok(())
}

fn channels(text: &mut String, raw: &Log, inspection: &Inspection) -> std::fmt::Result {
    let line = |name: &str, channel: &[f64], unit: &str, step: Option<f64>| {
        let (low, high) = extent(channel);
        let step = step.map_or("no steps".into(), |s| {
            format!("steps of {}", quantity(s, 2, unit))
        });
        let (low, high) = (quantity(low, 4, unit), quantity(high, 4, unit));
        format!("  {name:<9} {low} … {high}, {step}")
    };
    writeln!(
        text,
        "{}",
        line("position", &raw.position_m, "m", inspection.position_step_m)
    )?;
    let force = line("force", &raw.force_n, "N", inspection.force_step_n);
    writeln!(
        text,
        "{force}, noise {} rms",
        quantity(inspection.noise_n, 2, "N")
    )?;
    if let Some(limit) = inspection.saturated_n {
        writeln!(
            text,
            "            flat tops at {}: saturated",
            quantity(limit, 4, "N")
        )?;
    }
    for extra in &raw.extra {
        let (low, high) = extent(&extra.values);
        match low <= high {
            true => writeln!(text, "  further   {}: {low} … {high}", extra.name)?,
            false => writeln!(text, "  further   {}: no numbers", extra.name)?,
        }
    }
    Ok(())
}

/// The faults; what is missing stands with the time.
fn happened(text: &mut String, faults: &[EventMark]) -> std::fmt::Result {
    let missed = Fault::SampleMissed.code();
    let is_told =
        |event: &&EventMark| !matches!(event.kind, EventKind::Fault { code, .. } if code == missed);
    match faults_in_words(faults.iter().filter(is_told)) {
        Some(faults) => writeln!(text, "{}", wrapped("  faults    ", &faults)),
        None => Ok(()),
    }
}

fn rest(text: &mut String, inspection: &Inspection) -> std::fmt::Result {
    // A rest that is far below what can be read is none.
    let rest_n = match inspection.rest_n.abs() > 1e-3 * inspection.noise_n {
        true => inspection.rest_n,
        false => 0.0,
    };
    if inspection.free_s == 0.0 {
        return writeln!(
            text,
            "  free air  none: the log begins in contact, and never leaves it"
        );
    }
    let rest = quantity(rest_n, 2, "N");
    write!(
        text,
        "  free air  {}, force {rest}",
        quantity(inspection.free_s, 3, "s")
    )?;
    match inspection.disturbance {
        Some(times) if times > 2.0 => writeln!(
            text,
            ", wandering {times:.1} × more than its noise: drag, drift or hum"
        ),
        _ => writeln!(text),
    }
}

fn contacts(text: &mut String, inspection: &Inspection) -> std::fmt::Result {
    writeln!(text, "  touches   {}", inspection.touches.len())?;
    for touch in inspection.touches.iter().take(8) {
        writeln!(
            text,
            "            {:9.3} … {:9.3} s, up to {} and {} deep",
            touch.from_s,
            touch.to_s,
            quantity(touch.peak_force_n, 3, "N"),
            quantity(touch.peak_depth_m, 3, "m"),
        )?;
    }
    if inspection.touches.len() > 8 {
        writeln!(
            text,
            "            … and {} more",
            inspection.touches.len() - 8
        )?;
    }
    for hold in inspection.holds.iter().take(8) {
        writeln!(
            text,
            "  hold      {:9.3} … {:9.3} s at position {}: {} → {}{}",
            hold.from_s,
            hold.to_s,
            quantity(hold.position_m, 4, "m"),
            quantity(hold.from_n, 3, "N"),
            quantity(hold.to_n, 3, "N"),
            if hold.relaxed > 0.0 {
                format!(", relaxes by {:.1} %", 100.0 * hold.relaxed)
            } else {
                String::new()
            }
        )?;
    }
    if inspection.pull_n > 0.0 {
        let pull = quantity(inspection.pull_n, 3, "N");
        writeln!(
            text,
            "  pulls     {pull} below rest: adhesion, friction or a moving resting force"
        )?;
    }
    Ok(())
}

fn verdict(text: &mut String, log: &UniformLog, inspection: &Inspection) -> std::fmt::Result {
    for suspicion in suspicions(log) {
        writeln!(text, "{}", wrapped("  ! ", &suspicion))?;
    }
    let (good, bad) = uses(inspection);
    for (label, uses) in [("good for", good), ("not for", bad)] {
        if !uses.is_empty() {
            let lead = format!("  {label:<9} ");
            writeln!(text, "{}", wrapped(&lead, &uses.join("; ")))?;
        }
    }
    Ok(())
}

/// What the log is good for, and what not.
fn uses(inspection: &Inspection) -> (Vec<String>, Vec<String>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    for judge in [elastic, damping, relaxation, free_air] {
        match judge(inspection) {
            Ok(use_) => good.push(use_),
            Err(use_) => bad.push(use_),
        }
    }
    (good, bad)
}

/// A force that stands out, and a depth that changes.
fn pressed(inspection: &Inspection) -> Result<(), &'static str> {
    let touches = inspection.touches.iter();
    let peak_n = touches.clone().map(|t| t.peak_force_n).fold(0.0, f64::max);
    let peak_m = touches.map(|t| t.peak_depth_m).fold(0.0, f64::max);
    if inspection.touches.is_empty() {
        return Err("no contact");
    }
    if peak_n <= 50.0 * inspection.noise_n {
        return Err("no contact of 50 times the noise");
    }
    match peak_m > 0.0 {
        true => Ok(()),
        false => Err("the depth never changes"),
    }
}

fn elastic(inspection: &Inspection) -> Result<String, String> {
    match pressed(inspection) {
        Ok(()) => Ok("stiffness and exponent".into()),
        Err(why) => Err(format!("stiffness and exponent ({why})")),
    }
}

fn damping(inspection: &Inspection) -> Result<String, String> {
    pressed(inspection).map_err(|why| format!("damping ({why})"))?;
    let (slow, fast) = inspection.speeds_mps.unwrap_or((1.0, 1.0));
    match (fast <= 3.0 * slow, inspection.changes_speed) {
        (true, false) => return Err("damping (one speed only)".into()),
        (true, true) => {
            let fast = quantity(fast, 2, "m/s");
            return Ok(format!("damping (at {fast} and at rest or back)"));
        }
        (false, _) => {}
    }
    let (slow, fast) = (quantity(slow, 2, "m/s"), quantity(fast, 2, "m/s"));
    Ok(format!("damping (speeds from {slow} to {fast})"))
}

fn relaxation(inspection: &Inspection) -> Result<String, String> {
    pressed(inspection).map_err(|why| format!("relaxation ({why})"))?;
    let lengths = inspection.holds.iter().map(|h| h.to_s - h.from_s);
    match lengths.fold(0.0, f64::max) {
        longest if longest > 0.0 => Ok(format!(
            "relaxation (a hold of {})",
            quantity(longest, 3, "s")
        )),
        _ => Err("relaxation (no hold)".into()),
    }
}

fn free_air(inspection: &Inspection) -> Result<String, String> {
    match inspection.free_s > 0.2 {
        true => Ok("noise, resting force and friction in free air".into()),
        false if inspection.free_s == 0.0 => Err("noise and resting force (no free air)".into()),
        false => Err("noise and resting force (hardly any free air)".into()),
    }
}
