//! Felt and true force over depth and time, positions, energy, transparency, parameters.

use super::TeleopReport;
use crate::report::Figure;
use crate::report::plot::{Axis, Chart, Ink, Marker, Series, Size, Span, StripTone, Stroke};
use crate::teleop::measure::felt::scored;
use crate::teleop::measure::transparency::Line;
use crate::teleop::notice::STIFFNESS;
use crate::teleop::{Row, SchemeId};

/// The felt and the true force over the depth, a figure per material.
pub(super) fn by_depth(report: &TeleopReport<'_>) -> Vec<Figure> {
    let trace = report.trace;
    let scored = scored(trace);
    let environment = &report.options.environment;
    let names = [
        Some(environment.first.name.as_str()),
        environment.second.as_ref().map(|material| material.name.as_str()),
    ];
    let stretches = crate::teleop::measure::felt::materials(trace);
    let figures = stretches.into_iter().zip(names).filter_map(|(stretch, name)| {
        let chosen: Vec<&Row> = stretch.filter(|at| scored[*at]).map(|at| &trace.rows[at]).collect();
        let column = |of: &dyn Fn(&Row) -> f64| chosen.iter().map(|row| of(row)).collect::<Vec<_>>();
        let depth = column(&|row| row.master_m);
        let chart = Chart::new(Axis::new("Depth of the master", "m"), Axis::new("Force", "N"))
            .series(Series::new("felt", Ink::First, Stroke::Thin, depth.clone(), column(&|row| row.felt_n)))
            .series(Series::measured("true", depth, column(&|row| row.true_n)));
        (!chosen.is_empty()).then(|| {
            Figure::new(format!("Force over depth: {}", name.unwrap_or_default()), &chart).caption(
                "What the operator feels, and what the material does at the same depth and speed, once the \
                 scheme has what it needs.",
            )
        })
    });
    figures.collect()
}

/// Forces, positions and energy over time.
pub(super) fn over_time(report: &TeleopReport<'_>) -> Vec<Figure> {
    let trace = report.trace;
    let time = trace.column(|row| row.time_s);
    let chart = |axis: Axis| {
        Chart::new(Axis::time(), axis)
            .size(Size::Wide)
            .markers(markers(report))
    };
    let forces = chart(Axis::new("Force", "N").with_zero())
        .strip(strip(report))
        .series(Series::new("felt", Ink::First, Stroke::Thin, time.clone(), trace.column(|row| row.felt_n)))
        .series(Series::new(
            "on the slave",
            Ink::Second,
            Stroke::Thin,
            time.clone(),
            trace.column(|row| row.contact_n),
        ))
        .series(Series::measured(
            "true at the master's depth",
            time.clone(),
            trace.column(|row| row.true_n.min(2.0 * limit_n(report))),
        ));
    let positions = chart(Axis::new("Position", "m"))
        .series(Series::new("master", Ink::First, Stroke::Solid, time.clone(), trace.column(|row| row.master_m)))
        .series(Series::new("slave", Ink::Second, Stroke::Solid, time.clone(), trace.column(|row| row.slave_m)));
    let energies = chart(Axis::new("Energy", "J").with_zero())
        .series(Series::new(
            "operator into coupling",
            Ink::First,
            Stroke::Solid,
            time.clone(),
            trace.column(|row| row.felt_j),
        ))
        .series(Series::new(
            "slave into material",
            Ink::Second,
            Stroke::Solid,
            time.clone(),
            trace.column(|row| row.material_j),
        ))
        .series(Series::new(
            "exchanged impedances",
            Ink::Third,
            Stroke::Dashed,
            time,
            trace.column(|row| row.exchanged_j),
        ));
    vec![
        Figure::new("Forces", &forces).caption(
            "Strip: green where the scheme has what it needs and is compared. Where the true force at the \
             master's depth leaves the figure, the operator feels too little and goes in too deep.",
        ),
        Figure::new("Positions", &positions)
            .caption("The surface is at 0; positions grow into the material."),
        Figure::new("Energy", &energies).caption(
            "A coupling that creates none never gives back more than it got. What an exchange of \
             impedances adds under the hand, V_new − V_old, is declared.",
        ),
    ]
}

/// The largest force that the figure of forces is made for (N).
fn limit_n(report: &TeleopReport<'_>) -> f64 {
    let forces = report.trace.rows.iter();
    crate::stats::highest(forces.map(|row| row.contact_n.max(row.felt_n))).max(1.0)
}

fn markers(report: &TeleopReport<'_>) -> Vec<Marker> {
    let trace = report.trace;
    let touch = trace.rows.iter().find(|row| row.contact_n > 0.1);
    let marker = |at: f64, label: &str| Marker {
        at,
        label: label.into(),
        major: true,
    };
    let touch = touch.map(|row| marker(row.time_s, "first touch"));
    let change = trace.changed_s.map(|changed_s| marker(changed_s, "material changes"));
    touch.into_iter().chain(change).collect()
}

/// Where the scheme has what it needs.
fn strip(report: &TeleopReport<'_>) -> Vec<Span> {
    let trace = report.trace;
    let state = |row: &Row| (!trace.scheme.reflects() || row.heard, row.guarded);
    let mut spans: Vec<Span> = Vec::new();
    for rows in trace.rows.chunk_by(|a, b| state(a) == state(b)) {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            continue;
        };
        let (label, tone) = match state(first) {
            (true, _) => ("known", StripTone::Good),
            (false, true) => ("guarded", StripTone::Warning),
            (false, false) => ("stale", StripTone::Neutral),
        };
        spans.push(Span {
            from: first.time_s,
            to: last.time_s + trace.period_s,
            label: label.into(),
            tone,
        });
    }
    spans
}

/// |Ẑ/Z| of some schemes.
pub(super) fn transparency(schemes: &[(SchemeId, Vec<Line>)]) -> Figure {
    let chart = Chart::new(
        Axis::new("Frequency", "Hz").log(),
        Axis::new("Felt over true impedance", "1").range(0.0, 2.0),
    )
    .size(Size::Wide)
    .level_band(1.0 - STIFFNESS.from, 1.0 + STIFFNESS.from);
    let chart = schemes.iter().zip(Ink::RANKS).fold(chart, |chart, ((id, lines), ink)| {
        let x: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
        let y: Vec<f64> = lines.iter().map(|line| line.magnitude).collect();
        chart.series(Series::new(id.name(), ink, Stroke::Solid, x, y))
    });
    Figure::new("Transparency", &chart).caption(
        "|Ẑ/Z|: the felt over the true force at the lines of a motion within the material. Band: what nobody \
         tells apart by its stiffness (15 %).",
    )
}

/// Stiffness as the slave identifies it, and the hand as the master does.
pub(super) fn parameters(report: &TeleopReport<'_>) -> Vec<Figure> {
    let trace = report.trace;
    let time = trace.column(|row| row.time_s);
    let column = |of: &dyn Fn(&Row) -> Option<(f64, f64)>| {
        let (values, errors): (Vec<f64>, Vec<f64>) =
            trace.rows.iter().map(|row| of(row).unwrap_or((f64::NAN, f64::NAN))).unzip();
        (values, errors.into_iter().map(|error| 2.0 * error).collect::<Vec<f64>>())
    };
    let chart = |name: &str, unit: &str, (values, bands): (Vec<f64>, Vec<f64>), exact: Option<f64>| {
        let most = exact.map(|exact| 2.0 * exact);
        let axis = Axis::new(name, unit).with_zero();
        let axis = most.map_or(axis.clone(), |most| axis.range(0.0, most));
        let chart = Chart::new(Axis::time(), axis)
            .series(Series::estimated("identified", time.clone(), values).band(bands));
        match exact {
            Some(exact) => chart.series(Series::measured("true", time.clone(), vec![exact; time.len()])),
            None => chart,
        }
    };
    let mut figures = Vec::new();
    if trace.rows.iter().any(|row| row.identified.is_some()) {
        for (place, name, unit) in [(0, "Stiffness", "N/m"), (2, "Exponent", "1")] {
            let values = column(&|row| row.identified.and_then(|found| found[place]));
            figures.push(
                Figure::new(format!("{name} of the material, at the slave"), &chart(name, unit, values, None))
                    .caption("As the slave's board identifies it; band: two standard errors."),
            );
        }
    }
    if trace.rows.iter().any(|row| row.hand.is_some()) {
        let grip = report.options.operator.grips.last().copied();
        for (place, name, unit) in [(0, "Stiffness", "N/m"), (1, "Damping", "N s/m")] {
            let exact = grip.map(|grip| [grip.stiffness_n_per_m, grip.damping_ns_per_m][place]);
            let values = column(&|row| row.hand.and_then(|found| found[place]));
            figures.push(
                Figure::new(format!("{name} of the hand, at the master"), &chart(name, unit, values, exact))
                    .caption("As the master identifies it between 3 and 20 Hz; band: two standard errors."),
            );
        }
    }
    figures
}
