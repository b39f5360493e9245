//! Felt and true force over depth and time, positions, energy, transparency, parameters.

use super::run::TeleopReport;
use super::words::words;
use crate::report::Figure;
use crate::report::plot::{Axis, Chart, Ink, Marker, Series, Size, Span, StripTone, Stroke};
use crate::teleop::environment::Material;
use crate::teleop::measure::felt::scored;
use crate::teleop::measure::transparency::{self, Line};
use crate::teleop::notice::STIFFNESS;
use crate::teleop::operator::Grip;
use crate::teleop::{Row, SchemeId};

/// The felt and the true force over the depth, a figure per material.
pub(super) fn by_depth(report: &TeleopReport<'_>) -> Vec<Figure> {
    let trace = report.trace;
    let scored = scored(trace);
    let environment = &report.options.environment;
    let names = [
        Some(environment.first.name.as_str()),
        environment
            .second
            .as_ref()
            .map(|material| material.name.as_str()),
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
                "What the operator feels, and what the material does at the same depth and speed, from when the scheme is ready (reflection: from its first estimate on).",
            )
        })
    });
    figures.collect()
}

/// Forces, positions and energy over time.
pub(super) fn over_time(report: &TeleopReport<'_>) -> Vec<Figure> {
    vec![forces(report), positions(report), energies(report)]
}

fn wide<'a>(report: &TeleopReport<'_>, axis: Axis) -> Chart<'a> {
    Chart::new(Axis::time(), axis)
        .size(Size::Wide)
        .markers(markers(report))
}

/// A curve over time.
fn curve<'a>(
    report: &TeleopReport<'_>,
    name: &str,
    (ink, stroke): (Ink, Stroke),
    of: impl Fn(&Row) -> f64,
) -> Series<'a> {
    let trace = report.trace;
    Series::new(
        name,
        ink,
        stroke,
        trace.column(|row| row.time_s),
        trace.column(of),
    )
}

fn forces(report: &TeleopReport<'_>) -> Figure {
    let most_n = 2.0 * limit_n(report);
    let real = |row: &Row| row.true_n.min(most_n);
    let chart = wide(report, Axis::new("Force", "N").with_zero())
        .strip(strip(report))
        .series(curve(report, "felt", (Ink::First, Stroke::Thin), |row| {
            row.felt_n
        }))
        .series(curve(
            report,
            "on the slave",
            (Ink::Second, Stroke::Thin),
            |row| row.contact_n,
        ))
        .series(curve(
            report,
            "true at the master's depth",
            (Ink::Measured, Stroke::Dashed),
            real,
        ));
    Figure::new("Forces", &chart).caption(
        "Strip: green where the scheme is ready and is compared. Where the true force at the master's \
         depth leaves the figure, the operator feels too little and goes in too deep.",
    )
}

fn positions(report: &TeleopReport<'_>) -> Figure {
    let chart = wide(report, Axis::new("Position", "m"))
        .series(curve(
            report,
            "master",
            (Ink::First, Stroke::Solid),
            |row| row.master_m,
        ))
        .series(curve(
            report,
            "slave",
            (Ink::Second, Stroke::Solid),
            |row| row.slave_m,
        ));
    Figure::new("Positions", &chart)
        .caption("The surface is at 0; positions grow into the material.")
}

fn energies(report: &TeleopReport<'_>) -> Figure {
    let exchanged = (Ink::Third, Stroke::Dashed);
    let chart = wide(report, Axis::new("Energy", "J").with_zero())
        .series(curve(
            report,
            "operator into coupling",
            (Ink::First, Stroke::Solid),
            |row| row.felt_j,
        ))
        .series(curve(
            report,
            "slave into material",
            (Ink::Second, Stroke::Solid),
            |row| row.material_j,
        ))
        .series(curve(report, "exchanged impedances", exchanged, |row| {
            row.exchanged_j
        }));
    Figure::new("Energy", &chart).caption(
        "A coupling that creates none never gives back more than it got: where its curve is below 0, or falls in the \
         last press by more than was stored, it gave energy out, to the master's own damping and to the hand. What an \
         exchange of impedances adds under the hand, V_new − V_old, is declared.",
    )
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
    let change = trace
        .changed_s
        .map(|changed_s| marker(changed_s, "material changes"));
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
    let chart = schemes
        .iter()
        .zip(Ink::RANKS)
        .fold(chart, |chart, ((id, lines), ink)| {
            if transparency::oscillates(lines) {
                return chart;
            }
            let x: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
            let y: Vec<f64> = lines.iter().map(|line| line.magnitude).collect();
            chart.series(Series::new(words(*id), ink, Stroke::Solid, x, y))
        });
    let mut caption = String::from(
        "|Ẑ/Z|: the felt over the true force at the lines of a motion within the material; what is above 2 is drawn \
         at the upper edge. Band: differences in stiffness that people do not feel (15 %).",
    );
    let moving = schemes
        .iter()
        .filter(|(_, lines)| transparency::oscillates(lines));
    let moving: Vec<&str> = moving.map(|(id, _)| words(*id)).collect();
    if !moving.is_empty() {
        caption += &format!(
            " Not drawn, as it oscillates by itself and does not follow the motion: {}.",
            moving.join(", ")
        );
    }
    Figure::new("Transparency", &chart).caption(caption)
}

/// Stiffness, damping and exponent as the slave identifies them, and the hand as the master does.
pub(super) fn parameters(report: &TeleopReport<'_>) -> Vec<Figure> {
    let rows = &report.trace.rows;
    let mut figures = Vec::new();
    if rows.iter().any(|row| row.identified.is_some()) {
        for (place, name, unit) in [
            (0, "Stiffness", "N/m"),
            (1, "Damping", "N s/m"),
            (2, "Exponent", "1"),
        ] {
            let exact = |row: &Row| touched(report, row).of_a_board()[place];
            let axis = Axis::new(name, unit).with_zero();
            let chart = parameter(report, axis, exact, |row| row.identified?[place]);
            figures.push(
                Figure::new(format!("{name} of the material, at the slave"), &chart).caption(
                    "As the slave's board identifies it, at a depth of 1 mm; band: two standard errors.",
                ),
            );
        }
    }
    if rows.iter().any(|row| row.hand.is_some()) {
        let operator = &report.options.operator;
        for (place, name, unit) in [(0, "Stiffness", "N/m"), (1, "Damping", "N s/m")] {
            let of = |grip: &Grip| [grip.stiffness_n_per_m, grip.damping_ns_per_m][place];
            let most = crate::stats::highest(operator.grips.iter().map(of));
            // A hand that is not known yet has any value.
            let axis = Axis::new(name, unit).range(0.0, 2.0 * most);
            let exact = |row: &Row| Some(of(&operator.grip(row.time_s)));
            let chart = parameter(report, axis, exact, |row| row.hand?[place]);
            figures.push(
                Figure::new(format!("{name} of the hand, at the master"), &chart).caption(
                    "As the master identifies it between 3 and 20 Hz, while the hand moves; band: two \
                     standard errors.",
                ),
            );
        }
    }
    figures
}

/// What is under the slave at an instant.
fn touched<'a>(report: &'a TeleopReport<'_>, row: &Row) -> &'a Material {
    let environment = &report.options.environment;
    let changed = report
        .trace
        .changed_s
        .is_some_and(|changed_s| row.time_s >= changed_s);
    match &environment.second {
        Some(second) if changed => second,
        _ => &environment.first,
    }
}

/// A parameter over time with its band, and its true value where there is one.
fn parameter<'a>(
    report: &TeleopReport<'_>,
    axis: Axis,
    exact: impl Fn(&Row) -> Option<f64>,
    of: impl Fn(&Row) -> Option<(f64, f64)>,
) -> Chart<'a> {
    let time = report.trace.column(|row| row.time_s);
    let known = report
        .trace
        .rows
        .iter()
        .map(|row| of(row).unwrap_or((f64::NAN, f64::NAN)));
    let (values, errors): (Vec<f64>, Vec<f64>) = known.unzip();
    let band: Vec<f64> = errors.into_iter().map(|error| 2.0 * error).collect();
    let line = report.trace.column(|row| exact(row).unwrap_or(f64::NAN));
    let chart = Chart::new(Axis::time(), axis)
        .series(Series::estimated("identified", time.clone(), values).band(band));
    match line.iter().any(|value| value.is_finite()) {
        true => chart.series(Series::measured("true", time, line)),
        false => chart,
    }
}
