//! The residuals over time, depth and speed, the forces over time, and the loop of one touch.

use std::ops::Range;

use super::bins::{LEFT_OUT, LogCurves};
use crate::report::Figure;
use crate::report::plot::{Axis, Chart, Ink, Series, Size, Span, StripTone, Stroke};
use crate::stats::quantile;

/// Bins over depth and over speed.
const BINS: usize = 40;
const BEFORE: Ink = Ink::Second;
const AFTER: Ink = Ink::First;

/// The residuals before and after, below a strip of the phases of the contact; and the residuals after,
/// compared with what is allowed.
pub(super) fn residuals_over_time<'a>(log: &'a LogCurves<'a>) -> Vec<Figure> {
    let time = &log.curves.time_s;
    let drawn = |shown: &[&'a [f64]]| {
        Chart::new(Axis::time(), axis(shown).with_zero())
            .strip(log.phases().into_iter().map(span))
            .touches(log.held_out())
    };
    let allowed = |chart: Chart<'a>| {
        let twice = |allowed: &f64| {
            if *allowed > 0.0 {
                2.0 * allowed
            } else {
                f64::NAN
            }
        };
        let allowed: Vec<f64> = log.curves.allowed_n.iter().map(twice).collect();
        let zero = vec![0.0; allowed.len()];
        chart
            .series(Series::new("allowed, ±2σ", Ink::Muted, Stroke::Thin, time, zero).band(allowed))
    };
    let after = |name: &str| Series::new(name, AFTER, Stroke::Thin, time, &log.after_n);
    if !log.changed {
        let chart = allowed(drawn(&[&log.after_n]).size(Size::Wide)).series(after("base model"));
        let caption = format!(
            "Measured force minus that of the base model. {ALLOWED} {}",
            shaded(log)
        );
        return vec![Figure::new("Residual over time", &chart).caption(caption)];
    }
    let both = drawn(&[&log.before_n, &log.after_n])
        .size(Size::Wide)
        .series(Series::new(
            "before",
            BEFORE,
            Stroke::Thin,
            time,
            &log.before_n,
        ))
        .series(after("after"));
    let with_effects = allowed(drawn(&[&log.after_n]).size(Size::Slim)).series(after("after"));
    vec![
        Figure::new("Residual over time", &both).caption(format!(
            "Measured minus modelled force: of the base model (before) and with the effects (after), each \
             fitted to the whole log. {}",
            shaded(log)
        )),
        Figure::new("Residual with the effects", &with_effects).caption(format!("The residual after, on a scale of its own. {ALLOWED}")),
    ]
}

const ALLOWED: &str =
    "Grey: two standard deviations of what noise and the errors of the motion allow.";
/// What is drawn beside the residuals.
fn shaded(log: &LogCurves<'_>) -> String {
    let left_out = match log.left_out.is_empty() {
        true => "",
        false => ", red what was left out",
    };
    format!(
        "Strip: grey free air, purple loading (or forward, where nothing is touched), yellow hold, green unloading (or back)\
         {left_out}. Shaded: the held-out parts, on which the errors of the verdict were taken."
    )
}

/// An axis that shows all but the worst thousandth of the residuals.
fn axis(shown: &[&[f64]]) -> Axis {
    let sizes = shown.iter().copied().flatten().map(|r| r.abs());
    let most = 1.3 * quantile(sizes.filter(|r| r.is_finite()), 0.999);
    Axis::new("Residual", "N").range(-most, most)
}

fn span((phase, from, to): (&str, f64, f64)) -> Span {
    let (label, tone) = match phase {
        "loading" => ("in", StripTone::Info),
        "hold" => ("hold", StripTone::Warning),
        "unloading" => ("out", StripTone::Good),
        "forward" => ("forward", StripTone::Info),
        "backward" => ("back", StripTone::Good),
        LEFT_OUT => (LEFT_OUT, StripTone::Bad),
        _ => ("free", StripTone::Neutral),
    };
    Span {
        from,
        to,
        label: label.into(),
        tone,
    }
}

/// The measured force and the forces of both models.
pub(super) fn force_over_time<'a>(log: &'a LogCurves<'a>) -> Figure {
    let curves = log.curves;
    let time = &curves.time_s;
    let chart = Chart::new(Axis::time(), Axis::new("Force F", "N").with_zero())
        .size(Size::Wide)
        .touches(log.held_out());
    let chart = models(log, chart, 0..time.len(), time);
    Figure::new("Force over time", &chart)
        .caption("Measured and modelled force. Shaded: the held-out parts.")
}

/// The forces of the models and the measured force over `x`, in a part of the log.
fn models<'a>(
    log: &'a LogCurves<'a>,
    chart: Chart<'a>,
    part: Range<usize>,
    x: &'a [f64],
) -> Chart<'a> {
    let curves = log.curves;
    let chart = match log.changed {
        true => {
            let before = &curves.before_n[part.clone()];
            chart.series(Series::new("before", BEFORE, Stroke::Solid, x, before))
        }
        false => chart,
    };
    chart
        .series(Series::new(
            last(log),
            AFTER,
            Stroke::Solid,
            x,
            &curves.after_n[part.clone()],
        ))
        .series(Series::measured("measured", x, &curves.measured_n[part]))
}

/// The name of the last model.
fn last(log: &LogCurves<'_>) -> &'static str {
    if log.changed { "after" } else { "base model" }
}

/// The loop of one touch, and mean residuals over depth and speed.
pub(super) fn by_depth_and_speed<'a>(log: &'a LogCurves<'a>) -> Vec<Figure> {
    let mut figures = vec![loops(log), over_place(log)];
    if !log.touches() {
        let (all, speed) = (0..log.curves.time_s.len(), &log.curves.speed_mps);
        let chart = Chart::new(
            Axis::new("Speed", "m/s"),
            Axis::new("Force F", "N").with_zero(),
        );
        let figure = Figure::new("Force over speed", &models(log, chart, all, speed));
        figures.push(figure.caption("The forces over the speed of the motor side."));
    }
    figures.push(over_speed(log));
    figures
}

/// Force over depth in the touch where the base model is furthest off, or over position where nothing is touched.
fn loops<'a>(log: &'a LogCurves<'a>) -> Figure {
    let curves = log.curves;
    let (place, worst) = (log.place(), worst_touch(log));
    let range = worst.clone().unwrap_or(0..curves.time_s.len());
    let chart = Chart::new(
        Axis::new(place.axis, "m"),
        Axis::new("Force F", "N").with_zero(),
    );
    let chart = models(log, chart, range.clone(), &place.each_m[range.clone()]);
    let (title, caption) = match (worst, &curves.time_s[range]) {
        (Some(_), [from, .., to]) => (
            "Hysteresis loop",
            format!(
                "The touch from {from:.2} to {to:.2} s, where the base model is furthest off. The area inside \
                 a loop is the work that the contact dissipates."
            ),
        ),
        _ => (
            "Force over position",
            "The forces over the whole travel. The area inside a loop is the work that the machine takes.".into(),
        ),
    };
    Figure::new(title, &chart).caption(caption)
}

/// Samples of the touch with the largest excess of the base model's residuals.
fn worst_touch(log: &LogCurves<'_>) -> Option<Range<usize>> {
    let depth = &log.curves.depth_m;
    let touching = |at: usize| depth[at] > 0.02 * log.course.deepest_m;
    let mut best: Option<(f64, Range<usize>)> = None;
    let (mut from, mut excess) = (None, 0.0);
    for at in 0..=depth.len() {
        if at < depth.len() && touching(at) {
            from = from.or(Some(at));
            let residual = log.before_n[at];
            if residual.is_finite() {
                excess += residual * residual - log.curves.allowed_n[at].powi(2);
            }
        } else if let Some(start) = from.take() {
            // A touch of a few samples shows no loop.
            let is_worse = best.as_ref().is_none_or(|(worst, _)| excess > *worst);
            if is_worse && at - start >= 20 {
                best = Some((excess, start..at));
            }
            excess = 0.0;
        }
    }
    best.map(|(_, range)| range)
}

fn over_place<'a>(log: &'a LogCurves<'a>) -> Figure {
    let place = log.place();
    // A little of the free air before a touch, too.
    let range = (place.from_m - 0.1 * log.course.deepest_m, place.to_m);
    let [there, back] = match log.touches() {
        true => ["in", "out"],
        false => ["forward", "back"],
    };
    let mut chart = Chart::new(
        Axis::new(place.axis, "m"),
        Axis::new("Mean residual", "N").with_zero(),
    );
    for (name, ink, residuals) in both(log) {
        for (way, direction, stroke) in [(there, 1, Stroke::Solid), (back, -1, Stroke::Dashed)] {
            let wanted = |at: usize| log.direction(at) == direction;
            let (x, y) = log.means(residuals, place.each_m, range, BINS, wanted);
            chart = chart.series(Series::new(format!("{name}, {way}"), ink, stroke, x, y));
        }
    }
    let name = place.name;
    Figure::new(format!("Residual over {name}"), &chart).caption(format!(
        "Means over the samples of the same {name}, on the way {there} and on the way {back}. Two lines of \
         opposite sign mean friction, play or a delay; one common shape means another law or compliance.",
    ))
}

fn over_speed<'a>(log: &'a LogCurves<'a>) -> Figure {
    let most = log.course.fast_mps * 1.2;
    let mut chart = Chart::new(
        Axis::new("Speed", "m/s"),
        Axis::new("Mean residual", "N").with_zero(),
    );
    let contact = log.touches();
    let depth = &log.curves.depth_m;
    for (name, ink, residuals) in both(log) {
        for (place, stroke, deep) in [
            ("touching", Stroke::Solid, true),
            ("free", Stroke::Dashed, false),
        ] {
            let wanted = |at: usize| !contact || (depth[at] > 0.0) == deep;
            if !contact && !deep {
                continue;
            }
            let speed = &log.curves.speed_mps;
            let (x, y) = log.means(residuals, speed, (-most, most), BINS, wanted);
            let name = if contact {
                format!("{name}, {place}")
            } else {
                name.to_string()
            };
            chart = chart.series(Series::new(name, ink, stroke, x, y));
        }
    }
    Figure::new("Residual over speed", &chart).caption(
        "Means over the samples of the same speed; inward (or forward) is positive. A step at zero means \
         friction, a slope means drag.",
    )
}

fn both<'a>(log: &'a LogCurves<'a>) -> impl Iterator<Item = (&'static str, Ink, &'a [f64])> {
    let before: (_, _, &[f64]) = ("before", BEFORE, &log.before_n);
    let after: (_, _, &[f64]) = (last(log), AFTER, &log.after_n);
    log.changed.then_some(before).into_iter().chain([after])
}
