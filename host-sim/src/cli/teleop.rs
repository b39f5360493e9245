//! `palpate teleop` on the command line.

pub mod print;
mod setup;

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use crate::cli::progress::Bar;
use crate::gap::Progress;
use crate::json::write_json;
use crate::output::say;
use crate::report::teleop::{TeleopReport, comparison};
use crate::report::{Input, Provenance};
use crate::teleop::measure::transparency::transparency;
use crate::teleop::{Grid, Options, SchemeId, System, compare, json, measure, stability_limit_s};

/// Arguments of `palpate teleop`.
#[derive(Args, Clone, Debug)]
#[command(
    about = "Teleoperate: what an operator feels of a material across delay and loss, by eight schemes",
    long_about = "Simulate a teleoperation: an operator moves a master, a slave touches a material, a channel \
                  with delay, jitter and loss lies in between. Measures what is felt against what there is to \
                  feel, and compares impedance reflection (the boards' own code) with seven other schemes.",
    after_help = "Examples:\n  palpate teleop --delay-ms 150 --out run\n  palpate teleop --scheme \
                  position_force --delay-ms 20 --out run\n  palpate teleop --compare --seeds 2 --out table\n\n\
                  An operator, in SI units (all keys optional):\n  [[grip]]              # the hand, from a time on\n  \
                  from = 0.0            # s\n  mass = 0.35           # kg\n  damping = 9.0         # N s/m\n  \
                  stiffness = 700.0     # N/m\n  [task]\n  inside = 0.014        # m, how deep it means to go\n\n\
                  A channel (all keys optional; [there] master to slave, [back] slave to master):\n  [there]\n  \
                  delay = 0.05          # s, one way\n  jitter = 0.3          # share of the delay\n  loss = 0.05           \
                  # share of the messages\n  burst = 4             # lost in a row, in the mean"
)]
pub struct TeleopArgs {
    /// How master and slave are coupled: position_position, position_force, four_channel,
    /// wave_variables, passivity, reflection, reflection_both, reflection_shaped.
    #[arg(long, value_name = "SCHEME", default_value = "reflection", value_parser = scheme)]
    pub scheme: SchemeId,
    /// Mean delay, one way (ms).
    #[arg(long, value_name = "MS", value_parser = delay)]
    pub delay_ms: Option<f64>,
    /// How far the delay varies, as a share of it (0 to 1).
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub jitter: Option<f64>,
    /// Share of the messages that is lost (0 to 0.99).
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub loss: Option<f64>,
    /// What the slave touches (TOML, as simulate takes it); its surface is put to 0 m. Without one: the
    /// chapter's gel, and from halfway its plastic.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Who moves the master (TOML).
    #[arg(long, value_name = "FILE")]
    pub operator: Option<PathBuf>,
    /// The channel (TOML); the flags above go before it.
    #[arg(long, value_name = "FILE")]
    pub channel: Option<PathBuf>,
    /// All schemes over round trips of 0 to 5 s, jitter and loss, on four materials (or on --model).
    #[arg(long)]
    pub compare: bool,
    /// Seeds of each cell of the comparison.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub seeds: u64,
    /// Seed of noise and channel; one seed is one run.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Where teleop.json and report.html go.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Only the result as JSON, on standard output.
    #[arg(long)]
    pub json: bool,
    /// Nothing on standard output.
    #[arg(long)]
    pub quiet: bool,
}

fn scheme(text: &str) -> Result<SchemeId, String> {
    SchemeId::from_name(text).ok_or_else(|| {
        let names = SchemeId::ALL.map(SchemeId::name);
        format!("must be one of {}", names.join(", "))
    })
}

fn delay(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=60_000.0).contains(&value) => Ok(value),
        _ => Err("must be a delay from 0 to 60000 ms, such as 50".into()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.99).contains(&value) => Ok(value),
        _ => Err("must be a share from 0 to 0.99, such as 0.05".into()),
    }
}

/// Runs the scheme, or all of them, writes the files and prints a summary.
///
/// # Errors
/// A [`Diagnostic`](crate::diagnostic::Diagnostic) for a file that cannot be used; an I/O error if a file
/// cannot be written.
pub fn run(args: &TeleopArgs) -> Result<(), Box<dyn Error>> {
    let options = setup::options(args)?;
    match args.compare {
        true => run_all(args, &options),
        false => run_one(args, &options),
    }
}

fn run_one(args: &TeleopArgs, options: &Options) -> Result<(), Box<dyn Error>> {
    let trace = System::new(options, args.seed).run();
    let measures = measure(&trace);
    let value = json::run(options, &measures);
    tell(args, &value, || print::summary(options, &trace, &measures))?;
    let Some(folder) = &args.out else {
        return Ok(());
    };
    let bar = Bar::new();
    let grid = Grid::around(options);
    let map = compare(&grid, &|done, total| {
        bar.at(0.8 * done as f64 / total as f64, "the other schemes");
    });
    bar.at(0.8, "stability");
    let limit_s = stability_limit_s(options, LONGEST_TRIED_S, args.seed);
    bar.at(0.9, "transparency");
    let lines: Vec<_> = setup::beside(options.scheme)
        .into_iter()
        .map(|id| (id, transparency(&options.clone().with_scheme(id), args.seed)))
        .collect();
    drop(bar);
    let report = TeleopReport {
        options,
        trace: &trace,
        measures: &measures,
        transparency: &lines,
        map: &map,
        limit_s: (limit_s, LONGEST_TRIED_S),
        provenance: provenance(args)?,
    };
    finish(args, folder, &value, &report.document())
}

/// The largest round trip that is tried for the limit of stability (s).
const LONGEST_TRIED_S: f64 = 5.0;

fn run_all(args: &TeleopArgs, options: &Options) -> Result<(), Box<dyn Error>> {
    let mut grid = Grid::table(options.clone(), args.seeds);
    if args.model.is_some() {
        grid.environments = vec![options.environment.clone()];
    }
    let bar = Bar::new();
    let cells = compare(&grid, &|done, total| {
        bar.at(done as f64 / total as f64, &format!("{done} of {total} runs"));
    });
    drop(bar);
    let value = Value::Array(cells.iter().map(json::cell).collect());
    tell(args, &value, || print::table(&cells))?;
    match &args.out {
        Some(folder) => finish(args, folder, &value, &comparison(&cells, provenance(args)?)),
        None => Ok(()),
    }
}

/// Prints the result as it was asked for.
fn tell(args: &TeleopArgs, value: &Value, text: impl Fn() -> String) -> Result<(), Box<dyn Error>> {
    if args.json {
        say(format!("{}\n", serde_json::to_string_pretty(value)?))?;
    } else if !args.quiet {
        say(text())?;
    }
    Ok(())
}

fn finish(
    args: &TeleopArgs,
    folder: &std::path::Path,
    value: &Value,
    document: &crate::report::Document,
) -> Result<(), Box<dyn Error>> {
    write_json(&folder.join("teleop.json"), value)?;
    let report = folder.join("report.html");
    document.write(&report)?;
    if !args.json && !args.quiet {
        say(format!("  report      {}\n", report.display()))?;
    }
    Ok(())
}

fn provenance(args: &TeleopArgs) -> std::io::Result<Provenance> {
    let files = [&args.model, &args.operator, &args.channel];
    let mut provenance = Provenance::of_this_process().setting("Seed", args.seed.to_string());
    for file in files.into_iter().flatten() {
        provenance = provenance.input(Input::of_file(file)?);
    }
    Ok(provenance)
}
