//! The tables: result, segments, touches, faults.

use estimator_core::estimate::Estimated;

use super::run::{EstimateReport, FinalParameter, Run, label};
use crate::model::law_title;
use crate::number::{column, fixed, setting};
use crate::replay::{Touch, fault_tallies};
use crate::report::{Cell, Section, Table};

/// The most rows that a table of touches or materials shows.
const MOST_ROWS: usize = 14;

/// Law, parameters and figures of merit, with a column for each run; then what happened in each run.
pub(super) fn result(report: &EstimateReport) -> Section {
    let runs = report.runs;
    let names = runs.iter().map(|run| match run.name {
        "" => "Estimate",
        name => name,
    });
    let depth = runs.iter().find_map(|run| run.reference_depth_m);
    let at = depth.map_or(String::new(), |depth| {
        format!(
            "; stiffness and damping at a depth of {}",
            setting(depth, "m")
        )
    });
    let table = Table::new(std::iter::once("Parameter").chain(names))
        .caption(format!("Value ± one standard error{at}."))
        .row(row(runs, "Law", &|run| {
            Some(Cell::Number(law_title(run.law)))
        }))
        .rows(parameter_names(runs).into_iter().flat_map(|name| {
            let found = row(runs, &label(name), &|run| {
                let own = run.finals.iter().find(|p| p.name == name);
                own.map(|own| value(own))
            });
            [Some(found), truth(runs, name)].into_iter().flatten()
        }))
        .rows(merits(runs));
    let more = runs
        .iter()
        .flat_map(|run| [segments(run), touches(run), faults(run)]);
    more.flatten()
        .fold(Section::new("Result").table(table), Section::table)
}

/// A row of the result. A run that has no such value gets a dash.
fn row(runs: &[Run], name: &str, cell: &dyn Fn(&Run) -> Option<Cell>) -> Vec<Cell> {
    let cell = |run: &Run| cell(run).unwrap_or(Cell::Missing("–".into()));
    std::iter::once(Cell::from(name))
        .chain(runs.iter().map(cell))
        .collect()
}

/// The true values of a parameter below the estimates, where a simulated rig knows them.
fn truth(runs: &[Run], name: &str) -> Option<Vec<Cell>> {
    let of = |run: &Run| {
        let own = run.finals.iter().find(|p| p.name == name)?;
        Some(Cell::measured(own.truth?, None, own.unit))
    };
    let any = runs.iter().any(|run| of(run).is_some());
    any.then(|| row(runs, "\u{2003}true", &of))
}

/// The figures of merit that at least one run has.
fn merits(runs: &[Run]) -> Vec<Vec<Cell>> {
    type Merit = fn(&Run) -> Option<Cell>;
    let settled: Merit = |run| run.settled_at_s.map(|t| Cell::quantity(t, 2, "s"));
    let error: Merit = |run| run.force_rmse_n.map(|f| Cell::quantity(f, 2, "N"));
    let noise: Merit = |run| run.noise_n.map(|f| Cell::quantity(f, 2, "N"));
    let touches: Merit = |run| Some(Cell::count(run.touches.len()));
    let length: Merit = |run| {
        let ends = run.time_s.first().zip(run.time_s.last());
        ends.map(|(from, to)| Cell::quantity(to - from, 3, "s"))
    };
    let merits = [
        ("Settled, after first contact", settled),
        ("Force error, rms in contact", error),
        ("Force noise, rms", noise),
        ("Touches", touches),
        ("Length of the log", length),
    ];
    let known = merits
        .iter()
        .filter(|(_, merit)| runs.iter().any(|run| merit(run).is_some()));
    known.map(|(name, merit)| row(runs, name, merit)).collect()
}

/// The names of all parameters of all runs, in the order in which they appear.
fn parameter_names<'a>(runs: &[Run<'a>]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for parameter in runs.iter().flat_map(|run| &run.finals) {
        if !names.contains(&parameter.name) {
            names.push(parameter.name);
        }
    }
    names
}

fn value(parameter: &FinalParameter) -> Cell {
    match parameter.estimate {
        Some(Estimated { value, std_error }) => {
            Cell::measured(value, Some(std_error), parameter.unit)
        }
        None => Cell::Missing("not observable".into()),
    }
}

/// The notes, which a reader should know before trusting the numbers.
pub(super) fn notes(report: &EstimateReport) -> Section {
    Section::new("Notes").list(report.notes.iter().map(String::as_str))
}

fn caption(run: &Run, text: &str) -> String {
    match run.name {
        "" => text.to_string(),
        name => format!("{text}: {name}"),
    }
}

/// The materials, where the material changed. A single segment would repeat the result.
fn segments(run: &Run) -> Option<Table> {
    let all = run.segments.iter().flat_map(|segment| &segment.parameters);
    let mut names: Vec<&str> = Vec::new();
    for parameter in all {
        if !names.contains(&parameter.name) {
            names.push(parameter.name);
        }
    }
    let columns = ["From [s]".to_string(), "To [s]".to_string()].into_iter();
    let table = Table::new(columns.chain(names.iter().map(|name| label(name))))
        .caption(caption(run, "Materials"))
        .at_most(MOST_ROWS);
    let rows = run.segments.iter().map(|segment| {
        let cell = |name: &&str| {
            let of_segment = segment.parameters.iter().find(|p| p.name == *name);
            of_segment.map_or(Cell::Missing("–".into()), |own| value(own))
        };
        let ends = [time(segment.from_s), time(segment.to_s)];
        ends.into_iter()
            .chain(names.iter().map(cell))
            .collect::<Vec<_>>()
    });
    (run.segments.len() > 1).then(|| table.rows(rows))
}

fn touches(run: &Run) -> Option<Table> {
    let of = |value: fn(&Touch) -> f64| run.touches.iter().map(value).collect::<Vec<f64>>();
    let (force_unit, forces) = column(&of(|touch| touch.peak_force_n), 4, "N");
    let (depth_unit, depths) = column(&of(|touch| touch.peak_depth_m), 4, "m");
    let table = Table::new(["Touch", "From [s]", "To [s]"])
        .column(format!("Peak force [{force_unit}]"))
        .column(format!("Peak depth [{depth_unit}]"))
        .caption(caption(run, "Touches"))
        .at_most(MOST_ROWS);
    let cells = run.touches.iter().zip(forces).zip(depths).enumerate();
    let rows = cells.map(|(i, ((touch, force), depth))| {
        [
            Cell::count(i + 1),
            time(touch.from_s),
            time(touch.to_s),
            Cell::Number(force),
            Cell::Number(depth),
        ]
    });
    (!run.touches.is_empty()).then(|| table.rows(rows))
}

/// The faults, with a row for each kind, since a log may have a fault in every sample. The other events
/// stand in the tables of touches and materials.
fn faults(run: &Run) -> Option<Table> {
    let tallies = fault_tallies(run.events.iter());
    let rows = tallies.iter().map(|tally| {
        [
            Cell::from(format!("{}: {}", tally.code, tally.description)),
            Cell::count(tally.count),
            time(tally.between_s.0),
            time(tally.between_s.1),
        ]
    });
    let table = Table::new(["Fault", "Times", "First [s]", "Last [s]"]);
    (!tallies.is_empty()).then(|| table.caption(caption(run, "Faults")).rows(rows))
}

/// An instant (s) to the millisecond, which is the sampling period of the board.
fn time(at_s: f64) -> Cell {
    Cell::Number(fixed(at_s, -3))
}
