//! The energy of a contact: hysteresis loop, power exchange, elastic response.

use std::ops::Range;

use super::figures::{Layout, annotate, compare};
use super::run::Run;
use super::window::{Window, windows};
use crate::report::{Figure, plot::Axis, plot::Chart, plot::Series, plot::Size};

/// How to read the figures of the loops.
pub(super) const HOW_TO_READ: &str = "The area inside a loop is the work that the contact dissipates. Power is \
    positive where it goes into the material, and negative where it comes back. Shaded: in contact.";

/// Hysteresis loops, elastic response and power exchange.
pub(super) fn figures(run: &Run, layout: &Layout) -> Vec<Figure> {
    let windows = windows(run);
    let loops = windows.iter().map(|w| hysteresis(run, layout, w));
    let is_whole = windows.len() == 1;
    let powers = windows.iter().map(|w| power(run, layout, w, is_whole));
    // This order leaves no gaps: one loop and the elastic response share a row, or two loops do.
    match is_whole {
        true => loops.chain(elastic(run, layout)).chain(powers).collect(),
        false => loops.chain(powers).chain(elastic(run, layout)).collect(),
    }
}

fn hysteresis(run: &Run, layout: &Layout, window: &Window) -> Figure {
    let range = window.of(&run.time_s);
    let depth = part(&run.depth_m, &range);
    // In free air both forces are zero, and the approach would take most of the figure.
    let in_contact = |force: &[f64]| -> Vec<f64> {
        let value = |(f, d): (&f64, &f64)| if *d >= 0.0 { *f } else { f64::NAN };
        force.iter().zip(depth).map(value).collect()
    };
    let measured = in_contact(part(&run.measured_n, &range));
    let estimated = in_contact(part(&run.estimated_n, &range));
    let chart = Chart::new(
        Axis::new("Depth δ", "m"),
        Axis::new("Force F", "N").with_zero(),
    );
    let chart = compare(chart, run, depth, measured, estimated);
    Figure::new(layout.title(run, "Hysteresis loop", &window.name), &chart).caption(format!(
        "Measured and estimated force over depth{}.",
        shown(run, window)
    ))
}

/// Says which part of a log a figure shows.
fn shown(run: &Run, window: &Window) -> String {
    match window.name.as_str() {
        "" => String::new(),
        name => {
            let (all, deep) = (run.touches.len(), super::window::shown(run).len());
            let chatter = match all - deep {
                0 => String::new(),
                left_out => format!(", besides {left_out} of hardly any depth"),
            };
            format!(" in the {name} of {deep}{chatter}")
        }
    }
}

fn elastic(run: &Run, layout: &Layout) -> Option<Figure> {
    let elastic = run.elastic.as_ref()?;
    let mut chart = Chart::new(
        Axis::new("Depth δ", "m"),
        Axis::new("Elastic force", "N").with_zero(),
    )
    .series(Series::estimated(
        "estimated",
        &elastic.depth_m[..],
        &elastic.estimated_n[..],
    ));
    let mut caption = String::from("Force over depth at rest, from the final parameters.");
    if !elastic.true_n.is_empty() {
        chart = chart.series(Series::measured(
            "true",
            &elastic.depth_m[..],
            &elastic.true_n[..],
        ));
        caption += " Dashed: the true curve of the simulated rig.";
    }
    Some(Figure::new(layout.title(run, "Elastic response", ""), &chart).caption(caption))
}

fn power(run: &Run, layout: &Layout, window: &Window, wide: bool) -> Figure {
    let range = window.of(&run.time_s);
    let (time, speed) = (part(&run.time_s, &range), part(&run.speed_mps, &range));
    let measured = product(part(&run.measured_n, &range), speed);
    let estimated = product(part(&run.estimated_n, &range), speed);
    let chart = Chart::new(Axis::time(), Axis::new("Power F dδ/dt", "W").with_zero())
        .size(if wide { layout.over_time } else { Size::Half });
    let chart = compare(chart, run, time, measured, estimated);
    Figure::new(
        layout.title(run, "Power exchange", &window.name),
        &annotate(chart, run),
    )
    .caption(format!(
        "Measured and estimated power into the material{}.",
        shown(run, window)
    ))
}

fn part<'a>(data: &'a [f64], range: &Range<usize>) -> &'a [f64] {
    &data[range.start.min(data.len())..range.end.min(data.len())]
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}
