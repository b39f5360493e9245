//! The tables: result, segments, touches, faults.

use estimator_core::estimate::Estimated;

use super::{EstimateReport, EventKind, FinalParameter, Run, Touch, label};
use crate::report::number::{column, fixed, setting};
use crate::report::{Cell, Section, Table};

/// Of touches and faults, so many rows are shown.
const MOST_ROWS: usize = 14;

/// Law, parameters and figures of merit, a column a run; then what happened in each run.
pub(super) fn result(report: &EstimateReport) -> Section {
    let runs = report.runs;
    let names = runs.iter().map(|run| match run.name {
        "" => "Estimate",
        name => name,
    });
    let mut table = Table::new(std::iter::once("Parameter").chain(names));
    let row = |name: String, cell: &dyn Fn(&Run) -> Cell| {
        std::iter::once(Cell::from(name))
            .chain(runs.iter().map(cell))
            .collect::<Vec<_>>()
    };
    table = table.row(row("Law".into(), &|run| Cell::Number(law(run.law))));
    for name in parameter_names(runs) {
        table = table.row(row(label(name), &|run| {
            let of_run = run.finals.iter().find(|p| p.name == name);
            of_run.map_or(Cell::Missing("–".into()), value)
        }));
    }
    let merits: [(&str, fn(&Run) -> Option<Cell>); 5] = [
        ("Settled, after first contact", |run| {
            run.settled_at_s.map(|t| Cell::quantity(t, 2, "s"))
        }),
        ("Force error, rms in contact", |run| {
            run.force_rmse_n.map(|f| Cell::quantity(f, 2, "N"))
        }),
        ("Force noise, rms", |run| {
            run.noise_n.map(|f| Cell::quantity(f, 2, "N"))
        }),
        ("Touches", |run| Some(Cell::count(run.touches.len()))),
        ("Length of the log", |run| {
            let ends = run.time_s.first().zip(run.time_s.last());
            ends.map(|(from, to)| Cell::quantity(to - from, 3, "s"))
        }),
    ];
    for (name, merit) in merits {
        if runs.iter().any(|run| merit(run).is_some()) {
            let cell = |run: &Run| merit(run).unwrap_or(Cell::Missing("–".into()));
            table = table.row(row(name.into(), &cell));
        }
    }
    let depth = runs.iter().find_map(|run| run.reference_depth_m);
    let at = depth.map_or(String::new(), |d| {
        format!("; stiffness and damping at a depth of {}", setting(d, "m"))
    });
    let table = table.caption(format!("Value ± one standard error{at}."));
    let more = runs
        .iter()
        .flat_map(|run| [segments(run), touches(run), faults(run)]);
    more.flatten()
        .fold(Section::new("Result").table(table), Section::table)
}

/// Names of all parameters of all runs, in the order in which they come.
fn parameter_names<'a>(runs: &[Run<'a>]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for parameter in runs.iter().flat_map(|run| run.finals) {
        if !names.contains(&parameter.name) {
            names.push(parameter.name);
        }
    }
    names
}

fn law(name: &str) -> String {
    match name {
        "kelvin_voigt" => "Kelvin–Voigt".into(),
        "hunt_crossley" => "Hunt–Crossley".into(),
        "zener" => "Zener".into(),
        "quasi_linear" => "quasi-linear".into(),
        other => other.replace('_', " "),
    }
}

fn value(parameter: &FinalParameter) -> Cell {
    match parameter.estimate {
        Some(Estimated { value, std_error }) => {
            Cell::measured(value, Some(std_error), parameter.unit)
        }
        None => Cell::Missing("not observable".into()),
    }
}

/// What to know before trusting the numbers.
pub(super) fn notes(report: &EstimateReport) -> Section {
    Section::new("Notes").list(report.notes.iter().map(String::as_str))
}

fn caption(run: &Run, text: &str) -> String {
    match run.name {
        "" => text.to_string(),
        name => format!("{text}: {name}"),
    }
}

/// Only where the material changed: one segment repeats the result.
fn segments(run: &Run) -> Option<Table> {
    let all = run.segments.iter().flat_map(|segment| segment.parameters);
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
            of_segment.map_or(Cell::Missing("–".into()), value)
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

/// What went wrong; other events stand among the touches and the materials.
fn faults(run: &Run) -> Option<Table> {
    let rows: Vec<_> = run
        .events
        .iter()
        .filter_map(|event| {
            let EventKind::Fault { code, description } = &event.kind else {
                return None;
            };
            Some([
                time(event.time_s),
                Cell::from(format!("{code}: {description}")),
            ])
        })
        .collect();
    let table = Table::new(["Time [s]", "Fault"])
        .caption(caption(run, "Faults"))
        .at_most(MOST_ROWS);
    (!rows.is_empty()).then(|| table.rows(rows))
}

/// An instant, to the millisecond: the sampling period of the board.
fn time(at_s: f64) -> Cell {
    Cell::Number(fixed(at_s, -3))
}
