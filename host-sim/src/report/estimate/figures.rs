//! What the figures of a run have in common: their sizes, their titles, and the marks of events.

use std::borrow::Cow;

use estimator_core::estimate::Event;

use super::run::Run;
use crate::replay::EventKind;
use crate::report::{Figure, plot::Chart, plot::Marker, plot::Series, plot::Size};

/// Makes the figures of one kind for one run.
pub(super) type Kind = for<'a> fn(&'a Run<'a>, &Layout) -> Vec<Figure>;

/// How much of the page the figures of a run take.
pub(super) struct Layout {
    /// The size of a figure over time.
    pub(super) over_time: Size,
    /// The size of one of several figures above each other.
    pub(super) slim: Size,
    named: bool,
}

impl Layout {
    /// A single run has the whole width; several runs stand beside each other.
    pub(super) fn new(runs: usize) -> Layout {
        Layout {
            over_time: if runs > 1 { Size::Half } else { Size::Wide },
            slim: if runs > 1 { Size::Half } else { Size::Slim },
            named: runs > 1,
        }
    }

    /// The title of a figure: what it shows, the run, and the part of the run.
    pub(super) fn title(&self, run: &Run, what: &str, part: &str) -> String {
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

/// With more faults than this a figure marks none; the table of faults has them all.
const MOST_FAULTS: usize = 50;

/// The chart with the touches shaded and the events marked by lines.
pub(super) fn annotate<'a>(chart: Chart<'a>, run: &Run) -> Chart<'a> {
    let faults = run.events.iter().filter(|event| event.is_fault());
    let mark_faults = faults.count() <= MOST_FAULTS;
    let shown = run
        .events
        .iter()
        .filter(|event| mark_faults || !event.is_fault());
    let markers = shown.map(|event| {
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

/// Above this ratio of noise to largest force the measured curve covers the estimated one.
const NOISY: f64 = 0.005;

/// Measured and estimated values in one chart. The dashed measured curve lies on top, since the estimate
/// shows through its gaps; a noisy measured curve would hide the estimate, and lies below.
pub(super) fn compare<'a>(
    chart: Chart<'a>,
    run: &Run,
    x: &'a [f64],
    measured: impl Into<Cow<'a, [f64]>>,
    estimated: impl Into<Cow<'a, [f64]>>,
) -> Chart<'a> {
    let measured = Series::measured("measured", x, measured);
    let estimated = Series::estimated("estimated", x, estimated);
    let finite = run.measured_n.iter().filter(|f| f.is_finite());
    let largest = finite.map(|f| f.abs()).fold(0.0, f64::max);
    match run.noise_n.is_some_and(|noise| noise > NOISY * largest) {
        true => chart.series(measured).series(estimated),
        false => chart.series(estimated).series(measured),
    }
}
