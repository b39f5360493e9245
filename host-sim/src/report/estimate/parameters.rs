//! The parameters over time, with their standard errors and the status.

use estimator_core::estimate::{Estimated, status::Status};

use super::{figures::Layout, figures::annotate, run::Run, run::Trajectory, run::label};
use crate::report::{Figure, plot::Axis, plot::Chart, plot::Series, plot::Span, plot::StripTone};
use crate::stats::quantile;

/// How to read the figures of the parameters.
pub(super) const HOW_TO_READ: &str = "Line: estimate; band around it: ± one standard error; strip \
    above: status of the estimate; shaded: in contact.";

/// A figure of each parameter with its standard error, and the status above it.
pub(super) fn figures(run: &Run, layout: &Layout) -> Vec<Figure> {
    run.parameters
        .iter()
        .map(|trajectory| parameter(run, layout, trajectory))
        .collect()
}

fn parameter(run: &Run, layout: &Layout, trajectory: &Trajectory) -> Figure {
    let column = |of: fn(&Estimated<f64>) -> f64| -> Vec<f64> {
        let value = |v: &Option<_>| v.as_ref().map_or(f64::NAN, of);
        trajectory.values.iter().map(value).collect()
    };
    let (values, errors) = (column(|e| e.value), column(|e| e.std_error));
    let mut axis = Axis::new(label(trajectory.name), trajectory.unit);
    let mut caption = format!("{} ± one standard error.", label(trajectory.name));
    if let Some((low, high)) = range_that_matters(&values, &errors) {
        axis = axis.range(low, high);
        if values.iter().any(|v| *v < low || *v > high) {
            caption += " The axis shows where the estimate settles; the transient leaves it.";
        }
    }
    let own = run.finals.iter().find(|own| own.name == trajectory.name);
    let truth = own.and_then(|own| own.truth);
    let mut chart = Chart::new(Axis::time(), axis)
        .size(layout.slim)
        .strip(status_spans(run))
        .series(Series::estimated("estimated", &run.time_s[..], values).band(errors));
    if let (Some(truth), [from, .., to]) = (truth, &run.time_s[..]) {
        chart = chart.series(Series::measured("true", vec![*from, *to], vec![truth; 2]));
        caption += " Dashed: the true value of the simulated rig.";
    }
    Figure::new(
        layout.title(run, &label(trajectory.name), ""),
        &annotate(chart, run),
    )
    .caption(caption)
}

/// The range in which a trajectory spends most of its time, with room for a transient; it is no larger
/// than the range of all values. The first estimates may be wrong by orders of magnitude, and on an axis
/// that holds them nothing else could be read.
fn range_that_matters(values: &[f64], errors: &[f64]) -> Option<(f64, f64)> {
    let finite: Vec<(f64, f64)> = values
        .iter()
        .zip(errors)
        .filter(|(v, _)| v.is_finite())
        .map(|(v, e)| (*v, if e.is_finite() { *e } else { 0.0 }))
        .collect();
    // The last four fifths of the log. A material that is touched for a hundredth of them still counts.
    let late = &finite[finite.len() / 5..];
    let low = quantile(late.iter().map(|(v, e)| v - e), 0.01);
    let high = quantile(late.iter().map(|(v, e)| v + e), 0.99);
    let middle = 0.5 * (low + high);
    let half = (0.5 * (high - low)).max(0.1 * middle.abs());
    let extreme = |pick: fn(f64, f64) -> f64| finite.iter().map(|(v, _)| *v).reduce(pick);
    let low = extreme(f64::min)?.clamp(middle - 2.5 * half, middle - 1.2 * half);
    let high = extreme(f64::max)?.clamp(middle + 1.2 * half, middle + 2.5 * half);
    let margin = 0.05 * (high - low);
    Some((low - margin, high + margin))
}

/// The intervals of equal status.
fn status_spans(run: &Run) -> Vec<Span> {
    let mut spans: Vec<(Status, f64, f64)> = Vec::new();
    for (status, time) in run.status.iter().zip(run.time_s.iter()) {
        match spans.last_mut() {
            Some((last, _, to)) => {
                *to = *time;
                if last != status {
                    spans.push((*status, *time, *time));
                }
            }
            None => spans.push((*status, *time, *time)),
        }
    }
    let shown = spans
        .into_iter()
        .filter(|(s, _, _)| *s != Status::NoContact);
    shown
        .map(|(status, from, to)| Span {
            from,
            to,
            label: status.name().replace('_', " "),
            tone: tone(status),
        })
        .collect()
}

fn tone(status: Status) -> StripTone {
    match status {
        Status::NoContact | Status::Unobservable => StripTone::Neutral,
        Status::Converging => StripTone::Warning,
        Status::Converged => StripTone::Good,
        Status::Changed => StripTone::Info,
        Status::ModelSuspect => StripTone::Bad,
    }
}
