//! The figures that readers of the chapter know.

use std::ops::Range;

use estimator_core::estimate::Event;
use estimator_core::status::Status;

use super::window::{Window, windows};
use super::{EventKind, Run, Trajectory, label};
use crate::report::Figure;
use crate::report::number::setting;
use crate::report::plot::{Axis, Chart, Ink, Marker, Series, Size, Span, StripTone, Stroke};

/// Makes the figures of one kind for one run.
pub(super) type Kind = for<'a> fn(&'a Run<'a>, &Layout) -> Vec<Figure>;

/// How much room a run has.
pub(super) struct Layout {
    /// Of a figure over time, and of one of several above each other.
    over_time: Size,
    slim: Size,
    named: bool,
}

impl Layout {
    /// A single run has the whole width, several stand beside each other.
    pub(super) fn new(runs: usize) -> Layout {
        Layout {
            over_time: if runs > 1 { Size::Half } else { Size::Wide },
            slim: if runs > 1 { Size::Half } else { Size::Slim },
            named: runs > 1,
        }
    }

    fn title(&self, run: &Run, what: &str, part: &str) -> String {
        let mut title = what.to_string();
        if self.named && !run.name.is_empty() {
            title += &format!(", {}", run.name);
        }
        if !part.is_empty() {
            title += &format!(", {part}");
        }
        title
    }
}

fn part<'a>(data: &'a [f64], range: &Range<usize>) -> &'a [f64] {
    &data[range.start.min(data.len())..range.end.min(data.len())]
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

/// Touches, and the lines of what happened.
fn annotate<'a>(chart: Chart<'a>, run: &Run) -> Chart<'a> {
    let markers = run.events.iter().map(|event| {
        let (label, major) = match &event.kind {
            EventKind::Estimator(Event::Contact) => ("contact".to_string(), false),
            EventKind::Estimator(Event::Release) => ("release".to_string(), false),
            EventKind::Estimator(Event::MaterialChange) => ("material change".to_string(), true),
            EventKind::Fault { code, .. } => (format!("fault {code}"), true),
        };
        Marker {
            at: event.time_s,
            label,
            major,
        }
    });
    chart
        .markers(markers)
        .touches(run.touches.iter().map(|t| (t.from_s, t.to_s)))
}

/// Hysteresis loops, elastic response and power exchange.
pub(super) fn contact(run: &Run, layout: &Layout) -> Vec<Figure> {
    let windows = windows(run);
    let loops = windows.iter().map(|w| hysteresis(run, layout, w));
    let is_whole = windows.len() == 1;
    let powers = windows.iter().map(|w| power(run, layout, w, is_whole));
    // The order that leaves no gaps: one loop and the elastic response share a row, or two loops.
    match is_whole {
        true => loops.chain(elastic(run, layout)).chain(powers).collect(),
        false => loops.chain(powers).chain(elastic(run, layout)).collect(),
    }
}

fn hysteresis(run: &Run, layout: &Layout, window: &Window) -> Figure {
    let range = window.of(run.time_s);
    let depth = part(run.depth_m, &range);
    // In free air both forces are zero, and the approach would be most of the picture.
    let in_contact = |force: &[f64]| -> Vec<f64> {
        let value = |(f, d): (&f64, &f64)| if *d >= 0.0 { *f } else { f64::NAN };
        force.iter().zip(depth).map(value).collect()
    };
    let measured = in_contact(part(run.measured_n, &range));
    let estimated = in_contact(part(run.estimated_n, &range));
    let chart = Chart::new(
        Axis::new("Depth δ", "m"),
        Axis::new("Force F", "N").with_zero(),
    )
    .series(Series::estimated("estimated", depth, estimated))
    .series(Series::measured("measured", depth, measured));
    Figure::new(layout.title(run, "Hysteresis loop", &window.name), &chart).caption(format!(
        "Force over depth, measured dashed and estimated solid. The area inside a loop is the work \
         that the contact dissipates.{}",
        shown(window)
    ))
}

/// Says which part of a long log a figure shows.
fn shown(window: &Window) -> String {
    match window.name.as_str() {
        "" => String::new(),
        name => format!(" Of this long log: the {name}."),
    }
}

fn elastic(run: &Run, layout: &Layout) -> Option<Figure> {
    let elastic = run.elastic?;
    let mut chart = Chart::new(
        Axis::new("Depth δ", "m"),
        Axis::new("Elastic force", "N").with_zero(),
    )
    .series(Series::estimated(
        "estimated",
        elastic.depth_m,
        elastic.estimated_n,
    ));
    let mut caption = String::from("Force over depth at rest, from the final parameters.");
    if !elastic.true_n.is_empty() {
        chart = chart.series(Series::measured("true", elastic.depth_m, elastic.true_n));
        caption += " Dashed: the true curve of the simulated rig.";
    }
    Some(Figure::new(layout.title(run, "Elastic response", ""), &chart).caption(caption))
}

fn power(run: &Run, layout: &Layout, window: &Window, wide: bool) -> Figure {
    let range = window.of(run.time_s);
    let (time, speed) = (part(run.time_s, &range), part(run.speed_mps, &range));
    let measured = product(part(run.measured_n, &range), speed);
    let estimated = product(part(run.estimated_n, &range), speed);
    let chart = Chart::new(Axis::time(), Axis::new("Power F dδ/dt", "W").with_zero())
        .size(if wide { layout.over_time } else { Size::Half })
        .series(Series::estimated("estimated", time, estimated))
        .series(Series::measured("measured", time, measured));
    Figure::new(
        layout.title(run, "Power exchange", &window.name),
        &annotate(chart, run),
    )
    .caption(format!(
        "Power into the material while loading (positive) and back out of it while unloading; \
         shaded: in touch.{}",
        shown(window)
    ))
}

/// How to read the figures of the parameters.
pub(super) const PARAMETERS: &str = "Line: estimate; band around it: ± one standard error; strip \
    above: status of the estimate; shaded: in touch.";

/// Every parameter with its standard error, and the status above.
pub(super) fn parameters(run: &Run, layout: &Layout) -> Vec<Figure> {
    run.parameters
        .iter()
        .map(|trajectory| parameter(run, layout, trajectory))
        .collect()
}

fn parameter(run: &Run, layout: &Layout, trajectory: &Trajectory) -> Figure {
    let column = |of: fn(&estimator_core::estimate::Estimated<f64>) -> f64| -> Vec<f64> {
        let value = |v: &Option<_>| v.as_ref().map_or(f64::NAN, of);
        trajectory.values.iter().map(value).collect()
    };
    let (values, errors) = (column(|e| e.value), column(|e| e.std_error));
    let mut axis = Axis::new(label(trajectory.name), trajectory.unit);
    let mut caption = format!("{} ± one standard error.", label(trajectory.name));
    if let Some((low, high)) = range_that_matters(&values, &errors) {
        axis = axis.range(low, high);
        if values.iter().any(|v| *v < low || *v > high) {
            caption += " The axis shows where the estimate ends up; the transient leaves it.";
        }
    }
    let chart = Chart::new(Axis::time(), axis)
        .size(layout.slim)
        .strip(status_spans(run))
        .series(Series::estimated("", run.time_s, values).band(errors));
    Figure::new(
        layout.title(run, &label(trajectory.name), ""),
        &annotate(chart, run),
    )
    .caption(caption)
}

/// The range in which a trajectory spends its time, with room for a transient, if it is smaller than
/// all that it visits. The first estimates may be wrong by orders of magnitude; on an axis with room
/// for them nothing else could be read.
fn range_that_matters(values: &[f64], errors: &[f64]) -> Option<(f64, f64)> {
    let finite: Vec<(f64, f64)> = values
        .iter()
        .zip(errors)
        .filter(|(v, _)| v.is_finite())
        .map(|(v, e)| (*v, if e.is_finite() { *e } else { 0.0 }))
        .collect();
    // The last four fifths; a material that is touched for a hundredth of them still counts.
    let late = &finite[finite.len() / 5..];
    let low = quantile(late.iter().map(|(v, e)| v - e), 0.01)?;
    let high = quantile(late.iter().map(|(v, e)| v + e), 0.99)?;
    let middle = 0.5 * (low + high);
    let half = (0.5 * (high - low)).max(0.1 * middle.abs());
    let extreme = |pick: fn(f64, f64) -> f64| finite.iter().map(|(v, _)| *v).reduce(pick);
    let low = extreme(f64::min)?.clamp(middle - 2.5 * half, middle - 1.2 * half);
    let high = extreme(f64::max)?.clamp(middle + 1.2 * half, middle + 2.5 * half);
    let margin = 0.05 * (high - low);
    Some((low - margin, high + margin))
}

fn quantile(values: impl Iterator<Item = f64>, fraction: f64) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let at = (fraction * values.len().saturating_sub(1) as f64).round() as usize;
    let at = at.min(values.len().checked_sub(1)?);
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// Runs of equal status.
fn status_spans(run: &Run) -> Vec<Span> {
    let mut spans: Vec<(Status, f64, f64)> = Vec::new();
    for (status, time) in run.status.iter().zip(run.time_s) {
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

/// Force above displacement.
pub(super) fn over_time(run: &Run, layout: &Layout) -> Vec<Figure> {
    let force = Chart::new(Axis::time(), Axis::new("Force F", "N").with_zero())
        .size(layout.over_time)
        .series(Series::estimated("estimated", run.time_s, run.estimated_n))
        .series(Series::measured("measured", run.time_s, run.measured_n));
    let depth = Chart::new(Axis::time(), Axis::new("Depth δ", "m").with_zero())
        .size(layout.slim)
        .series(Series::new(
            "",
            Ink::Measured,
            Stroke::Solid,
            run.time_s,
            run.depth_m,
        ));
    let mut caption = String::from(
        "Measured force and the replay with the estimated parameters. Shaded: in touch.",
    );
    if windows(run).len() > 1 {
        caption += " In a log of this length touches may merge into the area that they cover.";
    }
    vec![
        Figure::new(layout.title(run, "Force", ""), &annotate(force, run)).caption(caption),
        Figure::new(layout.title(run, "Displacement", ""), &annotate(depth, run))
            .caption("Penetration; negative in free air. Shaded: in touch."),
    ]
}

/// What the law leaves unexplained, against the noise.
pub(super) fn residual(run: &Run, layout: &Layout) -> Vec<Figure> {
    let forces = run.measured_n.iter().zip(run.estimated_n);
    let residual: Vec<f64> = forces
        .map(|(measured, estimated)| measured - estimated)
        .collect();
    let mean = running_mean(&residual, residual.len() / MEANS);
    let axis = Axis::new("Measured − estimated", "N").with_zero();
    let mut chart = Chart::new(Axis::time(), axis)
        .size(layout.over_time)
        .series(Series::new(
            "residual",
            Ink::Muted,
            Stroke::Thin,
            run.time_s,
            residual,
        ))
        .series(Series::estimated("running mean", run.time_s, mean));
    let mut caption = format!(
        "What the estimate leaves unexplained; running mean over 1/{MEANS} of the log. A mean with \
         a pattern is something that the law does not know."
    );
    if let Some(noise) = run.noise_n {
        chart = chart.level_band(-noise, noise);
        caption += " Band: ± one standard deviation of the force noise.";
    }
    vec![Figure::new(layout.title(run, "Residual", ""), &annotate(chart, run)).caption(caption)]
}

/// The running mean of a residual has so many independent values: a pattern within a touch of a
/// 10 s log shows, noise is down to a sixth.
const MEANS: usize = 250;

/// Mean over `width` values around each; values that are not finite do not count, and where the
/// value itself is not finite there is none.
fn running_mean(values: &[f64], width: usize) -> Vec<f64> {
    let half = width / 2;
    let mut sums = vec![(0.0, 0.0)];
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        if value.is_finite() {
            (sum, count) = (sum + value, count + 1.0);
        }
        sums.push((sum, count));
    }
    let mean = |i: usize| {
        let (from, to) = (
            sums[i.saturating_sub(half)],
            sums[(i + half + 1).min(values.len())],
        );
        (to.0 - from.0) / (to.1 - from.1)
    };
    let finite_mean = |(i, v): (usize, &f64)| if v.is_finite() { mean(i) } else { f64::NAN };
    values.iter().enumerate().map(finite_mean).collect()
}

/// β over |F − F̂| and over time.
pub(super) fn forgetting(run: &Run, layout: &Layout) -> Vec<Figure> {
    let mut figures = Vec::new();
    figures.extend(beta_over_error(run, layout));
    if !run.forgetting.is_empty() {
        let chart = Chart::new(Axis::time(), Axis::new("β", "1"))
            .size(if figures.is_empty() {
                layout.over_time
            } else {
                Size::Half
            })
            .series(Series::new(
                "",
                Ink::First,
                Stroke::Thin,
                run.time_s,
                run.forgetting,
            ));
        figures.push(
            Figure::new(layout.title(run, "β over time", ""), &annotate(chart, run))
                .caption("1: everything is remembered, or nothing is being learned."),
        );
    }
    figures
}

fn beta_over_error(run: &Run, layout: &Layout) -> Option<Figure> {
    let law = run.forgetting_law?;
    let errors: Vec<f64> = run.innovation_n.iter().map(|e| e.abs()).collect();
    let largest = errors
        .iter()
        .copied()
        .filter(|e| e.is_finite())
        .fold(0.0, f64::max);
    let end = (3.0 * law.alpha_3_n).max(1.05 * largest);
    let curve_x: Vec<f64> = (0..=300).map(|i| end * f64::from(i) / 300.0).collect();
    let curve_y: Vec<f64> = curve_x.iter().map(|e| law.beta(*e)).collect();
    let chart = Chart::new(
        Axis::new("Force error before learning", "N").range(0.0, end),
        Axis::new("β", "1"),
    )
    .series(Series::new(
        "equation (24)",
        Ink::Muted,
        Stroke::Solid,
        curve_x,
        curve_y,
    ))
    .series(Series::new(
        "visited",
        Ink::First,
        Stroke::Dots,
        errors,
        run.forgetting,
    ));
    let caption = format!(
        "The larger the error of the predicted force, the faster the past is forgotten: α₁ = {}, α₂ = {} per N, \
         α₃ = {}. Dots at β = 1: samples that were not learned from.",
        setting(law.alpha_1, "1"),
        setting(law.alpha_2_per_n, "1"),
        setting(law.alpha_3_n, "N"),
    );
    let title = layout.title(run, "β over the force error", "");
    Some(Figure::new(title, &chart).caption(caption))
}
