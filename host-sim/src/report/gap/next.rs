//! The motion to record next: its curve, and how far and how fast it goes compared with the logs.

use crate::gap::Finding;
use crate::motion::Limits;
use crate::report::plot::{Axis, Chart, Ink, Series, Size, Stroke};
use crate::report::{Cell, Figure, Section, Table};

/// Points of the curve. The fastest motions have a few hundred cycles.
const POINTS: u32 = 8_000;

/// The section on the motion; empty where no motion is advised.
pub(super) fn motion(finding: &Finding) -> Section {
    let Some(advised) = &finding.advised else {
        return Section::new("");
    };
    let motion = &advised.motion;
    let step_s = motion.duration_s() / f64::from(POINTS);
    let time: Vec<f64> = (0..=POINTS).map(|at| f64::from(at) * step_s).collect();
    let position: Vec<f64> = time.iter().map(|t| motion.position(*t).0).collect();
    let series = Series::new("motion.toml", Ink::First, Stroke::Thin, time, position);
    let chart = Chart::new(Axis::time(), Axis::new("Position", "m"))
        .size(Size::Slim)
        .series(series);
    let row = |name: &str, of: fn(&Limits) -> f64, unit: &str| {
        let cell = |limits: &Limits| Cell::quantity(of(limits), 3, unit);
        vec![
            Cell::from(name),
            cell(&finding.limits()),
            cell(&motion.limits()),
        ]
    };
    let table = Table::new(["", "Logs so far", "motion.toml"])
        .row(row("Deepest position", |limits| limits.highest_m, "m"))
        .row(row("Farthest out", |limits| limits.lowest_m, "m"))
        .row(row("Highest speed", |limits| limits.fastest_mps, "m/s"));
    Section::new("What to record next")
        .text(format!(
            "{} Beside this report motion.toml holds the motion: {}. Check its limits against the rig \
             before it runs.",
            advised.purpose, advised.words
        ))
        .table(table)
        .figure(
            Figure::new("The motion", &chart)
                .caption("Position over time, as motion.toml commands it."),
        )
}
