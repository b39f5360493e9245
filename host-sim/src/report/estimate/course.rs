//! The log from its first to its last sample: force, displacement, residual.

use super::{figures::Layout, figures::annotate, figures::compare, run::Run};
use crate::report::{Figure, plot::Axis, plot::Chart, plot::Ink, plot::Series, plot::Stroke};

/// How to read the figures over time.
pub(super) const HOW_TO_READ: &str = "Estimated: the replay with the final parameters. Shaded: in contact; in a \
    long log neighbouring touches may merge into one shaded area, and a curve that fills the figure is drawn as \
    the area between its peaks.";

/// The force over time, and the displacement below it.
pub(super) fn forces(run: &Run, layout: &Layout) -> Vec<Figure> {
    let force =
        Chart::new(Axis::time(), Axis::new("Force F", "N").with_zero()).size(layout.over_time);
    let force = compare(
        force,
        run,
        &run.time_s[..],
        &run.measured_n[..],
        &run.estimated_n[..],
    );
    let depth = Chart::new(Axis::time(), Axis::new("Depth δ", "m").with_zero())
        .size(layout.slim)
        .series(Series::new(
            "",
            Ink::Measured,
            Stroke::Solid,
            &run.time_s[..],
            &run.depth_m[..],
        ));
    vec![
        Figure::new(layout.title(run, "Force", ""), &annotate(force, run))
            .caption("Measured and estimated force."),
        Figure::new(layout.title(run, "Displacement", ""), &annotate(depth, run))
            .caption("Penetration; it is negative in free air."),
    ]
}

/// The residual of the law, compared with the noise of the force.
pub(super) fn residual(run: &Run, layout: &Layout) -> Vec<Figure> {
    let forces = run.measured_n.iter().zip(run.estimated_n.iter());
    let residual: Vec<f64> = forces
        .map(|(measured, estimated)| measured - estimated)
        .collect();
    let (mean_s, mean) = match &run.mean_residual {
        Some((times_s, means)) => (&times_s[..], running_mean(means, means.len() / MEANS)),
        None => (
            &run.time_s[..],
            running_mean(&residual, residual.len() / MEANS),
        ),
    };
    let axis = Axis::new("Measured − estimated", "N").with_zero();
    let mut chart = Chart::new(Axis::time(), axis)
        .size(layout.over_time)
        .series(Series::new(
            "residual",
            Ink::Muted,
            Stroke::Thin,
            &run.time_s[..],
            residual,
        ))
        .series(Series::estimated("running mean", mean_s, mean));
    let mut caption = format!(
        "Measured minus estimated force, and its running mean over 1/{MEANS} of the log. A pattern in \
         the mean is an effect that the law does not contain."
    );
    if let Some(noise) = run.noise_n {
        chart = chart.level_band(-noise, noise);
        caption += " Band: ± one standard deviation of the force noise.";
    }
    vec![Figure::new(layout.title(run, "Residual", ""), &annotate(chart, run)).caption(caption)]
}

/// The number of independent values that the running mean of a residual has. A pattern within one touch
/// of a log of 10 s is visible, and noise is reduced to a sixth.
const MEANS: usize = 250;

/// The mean over `width` values around each value. Values that are not finite do not count; where the
/// value itself is not finite the mean is NaN.
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
