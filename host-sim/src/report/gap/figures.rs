//! Residuals over time, over depth and over speed, forces over time, and the loop of one touch.

use std::ops::Range;

use super::bins::{Course, quantile};
use crate::report::Figure;
use crate::report::plot::{Axis, Chart, Ink, Series, Size, Span, StripTone, Stroke};

/// Bins over depth and over speed.
const BINS: usize = 40;
const BEFORE: Ink = Ink::Second;
const AFTER: Ink = Ink::First;

/// Residuals before and after, the phases above; and those after against what is allowed.
pub(super) fn residuals_over_time<'a>(course: &'a Course<'a>) -> Vec<Figure> {
    let time = &course.curves.time_s;
    let drawn = |shown: &[&'a [f64]]| {
        Chart::new(Axis::time(), axis(shown).with_zero())
            .strip(course.phases().into_iter().map(span))
            .touches(course.held_out())
    };
    let allowed = |chart: Chart<'a>| {
        let twice = |allowed: &f64| {
            if *allowed > 0.0 {
                2.0 * allowed
            } else {
                f64::NAN
            }
        };
        let allowed: Vec<f64> = course.curves.allowed_n.iter().map(twice).collect();
        let zero = vec![0.0; allowed.len()];
        chart
            .series(Series::new("allowed, ±2σ", Ink::Muted, Stroke::Thin, time, zero).band(allowed))
    };
    let after = |name: &str| Series::new(name, AFTER, Stroke::Thin, time, &course.after_n);
    if !course.changed {
        let chart = allowed(drawn(&[&course.after_n]).size(Size::Wide)).series(after("base model"));
        let caption = format!("Measured less modelled force. {ALLOWED} {SHADED}");
        return vec![Figure::new("Residual over time", &chart).caption(caption)];
    }
    let both = drawn(&[&course.before_n, &course.after_n])
        .size(Size::Wide)
        .series(Series::new(
            "before",
            BEFORE,
            Stroke::Thin,
            time,
            &course.before_n,
        ))
        .series(after("after"));
    let own = allowed(drawn(&[&course.after_n]).size(Size::Slim)).series(after("after"));
    vec![
        Figure::new("Residual over time", &both).caption(format!(
            "Measured less modelled force: the base model (before) and with the effects (after), each \
             fitted to the whole log. {SHADED}"
        )),
        Figure::new("Residual with the effects", &own).caption(format!("What is left, larger. {ALLOWED}")),
    ]
}

const ALLOWED: &str =
    "Grey: two standard deviations of what noise and the errors of the motion allow.";
const SHADED: &str = "Strip: grey free air, purple loading, yellow hold, green unloading. Shaded: held out \
    when the errors of the verdict were taken.";

/// An axis that shows all but the worst thousandth of the residuals.
fn axis(shown: &[&[f64]]) -> Axis {
    let sizes = shown.iter().copied().flatten().map(|r| r.abs());
    let most = 1.3 * quantile(sizes.collect(), 0.999);
    Axis::new("Residual", "N").range(-most, most)
}

fn span((phase, from, to): (&str, f64, f64)) -> Span {
    let (label, tone) = match phase {
        "loading" => ("in", StripTone::Info),
        "hold" => ("hold", StripTone::Warning),
        "unloading" => ("out", StripTone::Good),
        _ => ("free", StripTone::Neutral),
    };
    Span {
        from,
        to,
        label: label.into(),
        tone,
    }
}

/// Measured force and both models'.
pub(super) fn force_over_time<'a>(course: &'a Course<'a>) -> Figure {
    let curves = course.curves;
    let time = &curves.time_s;
    let chart = Chart::new(Axis::time(), Axis::new("Force F", "N").with_zero())
        .size(Size::Wide)
        .touches(course.held_out());
    let chart = models(course, chart, 0..time.len(), time);
    Figure::new("Force over time", &chart)
        .caption("What was measured, and what the models say. Shaded: held out.")
}

/// The models' forces and the measured one over `x`, of a part of the log.
fn models<'a>(
    course: &'a Course<'a>,
    chart: Chart<'a>,
    part: Range<usize>,
    x: &'a [f64],
) -> Chart<'a> {
    let curves = course.curves;
    let chart = match course.changed {
        true => {
            let before = &curves.before_n[part.clone()];
            chart.series(Series::new("before", BEFORE, Stroke::Solid, x, before))
        }
        false => chart,
    };
    chart
        .series(Series::new(
            last(course),
            AFTER,
            Stroke::Solid,
            x,
            &curves.after_n[part.clone()],
        ))
        .series(Series::measured("measured", x, &curves.measured_n[part]))
}

/// The name of the last model.
fn last(course: &Course<'_>) -> &'static str {
    if course.changed {
        "after"
    } else {
        "base model"
    }
}

/// The loop of one touch, and mean residuals over depth and speed.
pub(super) fn by_depth_and_speed<'a>(course: &'a Course<'a>) -> Vec<Figure> {
    let mut figures = vec![hysteresis(course)];
    if course.deepest_m > 0.0 {
        figures.push(over_depth(course));
    }
    figures.push(over_speed(course));
    figures
}

/// Force over depth in the touch where the base model is furthest off; over speed without contact.
fn hysteresis<'a>(course: &'a Course<'a>) -> Figure {
    let curves = course.curves;
    let worst = worst_touch(course);
    let (range, x, axis, title) = match &worst {
        Some(range) => (
            range.clone(),
            &curves.depth_m,
            Axis::new("Depth δ", "m"),
            "Hysteresis loop",
        ),
        None => (
            0..curves.time_s.len(),
            &curves.speed_mps,
            Axis::new("Speed", "m/s"),
            "Force over speed",
        ),
    };
    let part = |channel: &'a [f64]| &channel[range.clone()];
    let x = part(x);
    let chart = Chart::new(axis, Axis::new("Force F", "N").with_zero());
    let chart = models(course, chart, range.clone(), x);
    let caption = match (worst, part(&curves.time_s)) {
        (Some(_), [from, .., to]) => format!(
            "The touch from {from:.2} to {to:.2} s, where the base model is furthest off. The area inside \
             a loop is the work that is dissipated."
        ),
        _ => "Forces over the speed of the motor side.".into(),
    };
    Figure::new(title, &chart).caption(caption)
}

/// Samples of the touch with the largest excess of the base model's residuals.
fn worst_touch(course: &Course<'_>) -> Option<Range<usize>> {
    let depth = &course.curves.depth_m;
    let touching = |at: usize| depth[at] > 0.02 * course.deepest_m;
    let mut best: Option<(f64, Range<usize>)> = None;
    let (mut from, mut excess) = (None, 0.0);
    for at in 0..=depth.len() {
        if at < depth.len() && touching(at) {
            from = from.or(Some(at));
            let residual = course.before_n[at];
            if residual.is_finite() {
                excess += residual * residual - course.curves.allowed_n[at].powi(2);
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

fn over_depth<'a>(course: &'a Course<'a>) -> Figure {
    let range = (-0.1 * course.deepest_m, course.deepest_m);
    let mut chart = Chart::new(
        Axis::new("Depth δ", "m"),
        Axis::new("Mean residual", "N").with_zero(),
    );
    for (name, ink, residuals) in both(course) {
        for (way, direction, stroke) in [("in", 1, Stroke::Solid), ("out", -1, Stroke::Dashed)] {
            let wanted = |at: usize| course.direction(at) == direction;
            let (x, y) = course.means(residuals, &course.curves.depth_m, range, BINS, wanted);
            chart = chart.series(Series::new(format!("{name}, {way}"), ink, stroke, x, y));
        }
    }
    Figure::new("Residual over depth", &chart).caption(
        "Means over the samples of the same depth, on the way in and on the way out. Two lines of \
         opposite sign: friction, play or a delay; one common shape: another law or compliance.",
    )
}

fn over_speed<'a>(course: &'a Course<'a>) -> Figure {
    let most = course.usual_mps * 1.2;
    let mut chart = Chart::new(
        Axis::new("Speed", "m/s"),
        Axis::new("Mean residual", "N").with_zero(),
    );
    let contact = course.deepest_m > 0.0;
    let depth = &course.curves.depth_m;
    for (name, ink, residuals) in both(course) {
        for (place, stroke, deep) in [
            ("touching", Stroke::Solid, true),
            ("free", Stroke::Dashed, false),
        ] {
            let wanted = |at: usize| !contact || (depth[at] > 0.0) == deep;
            if !contact && !deep {
                continue;
            }
            let speed = &course.curves.speed_mps;
            let (x, y) = course.means(residuals, speed, (-most, most), BINS, wanted);
            let name = if contact {
                format!("{name}, {place}")
            } else {
                name.to_string()
            };
            chart = chart.series(Series::new(name, ink, stroke, x, y));
        }
    }
    Figure::new("Residual over speed", &chart).caption(
        "Means over the samples of the same speed; inward is positive. A step at zero is friction, a \
         slope is drag.",
    )
}

fn both<'a>(course: &'a Course<'a>) -> impl Iterator<Item = (&'static str, Ink, &'a [f64])> {
    let before: (_, _, &[f64]) = ("before", BEFORE, &course.before_n);
    let after: (_, _, &[f64]) = (last(course), AFTER, &course.after_n);
    course.changed.then_some(before).into_iter().chain([after])
}
