//! `palpate teleop` on the command line.

mod args;
mod bridge;
pub mod print;
mod setup;

pub use args::TeleopArgs;

use std::error::Error;
use std::time::Instant;

use serde_json::Value;

use crate::cli::progress::Bar;
use crate::gap::Progress;
use crate::json::write_json;
use crate::output::{result, say, try_folder};
use crate::report::teleop::{TeleopReport, comparison};
use crate::report::{Input, Provenance};
use crate::teleop::measure::run as run_and_measure;
use crate::teleop::measure::transparency::transparency;
use crate::teleop::{Grid, Measures, Options, compare, json, limit};
use crate::wrap::wrapped;

/// Runs the scheme, or all of them, writes the files and prints a summary.
///
/// # Errors
/// A [`Diagnostic`](crate::diagnostic::Diagnostic) for a file that cannot be used; an I/O error if a file
/// cannot be written.
pub fn run(args: &TeleopArgs) -> Result<(), Box<dyn Error>> {
    if let Some(out) = &args.out {
        try_folder(out)?;
    }
    if bridge::is_asked(args) {
        return bridge::run(args);
    }
    let (options, notes) = setup::options(args)?;
    match args.compare {
        true => run_all(args, &options, &notes),
        false => run_one(args, &options, notes),
    }
}

fn run_one(
    args: &TeleopArgs,
    options: &Options,
    mut notes: Vec<String>,
) -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let (trace, measures) = run_and_measure(options, args.seed);
    let took_s = started.elapsed().as_secs_f64();
    notes.extend(setup::never_changed(options, &trace));
    let mut value = json::run(options, &measures, args.seed, &notes);
    result(&value)?;
    say(print::summary(options, &trace, &measures))?;
    say(print::speed(1, options.duration_s(), took_s))?;
    say_notes(&notes)?;
    let Some(folder) = &args.out else {
        return Ok(());
    };
    let bar = Bar::new();
    let grid = Grid::around(options);
    let map = compare(&grid, &|done, total| {
        bar.at(0.8 * done as f64 / total as f64, "the other schemes");
    });
    bar.at(0.8, "stability");
    let limit = limit(options, measures.rests(), args.seed);
    bar.at(0.9, "transparency");
    let lines: Vec<_> = setup::beside(options.scheme)
        .into_iter()
        .map(|id| {
            (
                id,
                transparency(&options.clone().with_scheme(id), args.seed),
            )
        })
        .collect();
    drop(bar);
    let report = TeleopReport {
        options,
        trace: &trace,
        measures: &measures,
        transparency: &lines,
        map: &map,
        limit,
        notes: &notes,
        provenance: provenance(args)?.setting("Seed", args.seed.to_string()),
    };
    json::add_sweeps(&mut value, &lines, &limit);
    finish(folder, &value, &report.document())
}

fn say_notes(notes: &[String]) -> std::io::Result<()> {
    notes
        .iter()
        .try_for_each(|note| say(wrapped("note: ", note) + "\n"))
}

fn run_all(args: &TeleopArgs, options: &Options, notes: &[String]) -> Result<(), Box<dyn Error>> {
    let mut grid = Grid::table(options.clone(), args.seeds);
    if !args.model.is_empty() {
        grid.environments = vec![options.environment.clone()];
    }
    let bar = Bar::new();
    let started = Instant::now();
    let cells = compare(&grid, &|done, total| {
        bar.at(
            done as f64 / total as f64,
            &format!("{done} of {total} runs"),
        );
    });
    drop(bar);
    let value = Value::Array(cells.iter().map(json::cell).collect());
    result(&value)?;
    say(print::table(&cells))?;
    let runs: Vec<&Measures> = cells.iter().flat_map(|cell| &cell.runs).collect();
    let simulated_s = runs.iter().map(|run| run.duration_s).sum();
    say(print::speed(
        runs.len(),
        simulated_s,
        started.elapsed().as_secs_f64(),
    ))?;
    say_notes(notes)?;
    let Some(folder) = &args.out else {
        return Ok(());
    };
    let seeds = provenance(args)?.setting("Seeds of each cell", args.seeds.to_string());
    finish(folder, &value, &comparison(&cells, seeds))
}

fn finish(
    folder: &std::path::Path,
    value: &Value,
    document: &crate::report::Document,
) -> Result<(), Box<dyn Error>> {
    write_json(&folder.join("teleop.json"), value)?;
    let report = folder.join("report.html");
    document.write(&report)?;
    say(format!("  report      {}\n", report.display()))?;
    Ok(())
}

fn provenance(args: &TeleopArgs) -> std::io::Result<Provenance> {
    let files = args.model.iter().chain(&args.operator).chain(&args.channel);
    let mut provenance = Provenance::of_this_process();
    for file in files {
        provenance = provenance.input(Input::of_file(file)?);
    }
    Ok(provenance)
}
