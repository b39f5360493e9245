//! A chart: axes, curves and what is marked on them.

use std::borrow::Cow;

use super::{axis::Axis, canvas::Role, ink::Ink, ink::StripTone, ink::Stroke};

/// One curve, which may have a band around it.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    pub(super) name: String,
    pub(super) ink: Ink,
    pub(super) stroke: Stroke,
    pub(super) x: Cow<'a, [f64]>,
    pub(super) y: Cow<'a, [f64]>,
    pub(super) half_width: Option<Cow<'a, [f64]>>,
}

impl<'a> Series<'a> {
    /// A curve through the points (x, y). The shorter of the two decides the number of points.
    pub fn new(
        name: impl Into<String>,
        ink: Ink,
        stroke: Stroke,
        x: impl Into<Cow<'a, [f64]>>,
        y: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Series {
            name: name.into(),
            ink,
            stroke,
            x: x.into(),
            y: y.into(),
            half_width: None,
        }
    }

    /// A curve of what was measured, which is dashed and neutral.
    pub fn measured(
        name: impl Into<String>,
        x: impl Into<Cow<'a, [f64]>>,
        y: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Series::new(name, Ink::Measured, Stroke::Dashed, x, y)
    }

    /// A curve of what was estimated, which is solid and in the first colour.
    pub fn estimated(
        name: impl Into<String>,
        x: impl Into<Cow<'a, [f64]>>,
        y: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Series::new(name, Ink::First, Stroke::Solid, x, y)
    }

    /// Adds a band of y ± `half_width` around the curve, such as a standard error.
    pub fn band(mut self, half_width: impl Into<Cow<'a, [f64]>>) -> Self {
        self.half_width = Some(half_width.into());
        self
    }
}

/// An event at one instant, drawn as a vertical line with a label above the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Where the event is, in the unit of the x axis.
    pub at: f64,
    /// What the event is.
    pub label: String,
    /// Major markers are drawn stronger, and their labels come first where there is no room for all.
    pub major: bool,
}

/// A state that holds from one instant to another, drawn in the strip above the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// The start, in the unit of the x axis.
    pub from: f64,
    /// The end, in the unit of the x axis.
    pub to: f64,
    /// The label, which is written inside where there is room.
    pub label: String,
    /// The colour of the state.
    pub tone: StripTone,
}

/// A horizontal band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// How much of the page a chart takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// The chart takes the whole width, for curves over time.
    Wide,
    /// The chart takes the whole width and is lower, for several charts above each other.
    Slim,
    /// The chart takes half the width, for loops and for two charts beside each other.
    Half,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) size: Size,
    pub(super) series: Vec<Series<'a>>,
    pub(super) levels: Vec<Level>,
    pub(super) markers: Vec<Marker>,
    pub(super) touches: Vec<(f64, f64)>,
    pub(super) strip: Vec<Span>,
}

impl<'a> Chart<'a> {
    /// An empty chart with these axes, half a page wide.
    pub fn new(x: Axis, y: Axis) -> Self {
        Chart {
            x,
            y,
            size: Size::Half,
            series: Vec::new(),
            levels: Vec::new(),
            markers: Vec::new(),
            touches: Vec::new(),
            strip: Vec::new(),
        }
    }

    /// Sets how much of the page the chart takes.
    pub fn size(mut self, size: Size) -> Self {
        self.size = size;
        self
    }

    /// Adds a curve. Later curves lie on top of earlier ones.
    pub fn series(mut self, series: Series<'a>) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a muted horizontal band from `low` to `high` over the whole width.
    pub fn level_band(mut self, low: f64, high: f64) -> Self {
        self.levels.push(Level { low, high });
        self
    }

    /// Adds vertical lines with labels.
    pub fn markers(mut self, markers: impl IntoIterator<Item = Marker>) -> Self {
        self.markers.extend(markers);
        self
    }

    /// Shades intervals of x, such as the touches.
    pub fn touches(mut self, touches: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.touches.extend(touches);
        self
    }

    /// Adds the states over x in a strip above the plot.
    pub fn strip(mut self, spans: impl IntoIterator<Item = Span>) -> Self {
        self.strip.extend(spans);
        self
    }

    /// The classes and names that a legend has to explain, in the order of drawing. Curves that share a
    /// name share an entry. The list is empty if a single curve needs no explanation.
    pub(crate) fn legend(&self) -> Vec<(String, &str)> {
        let mut entries: Vec<(String, &str)> = Vec::new();
        for series in self.series.iter().filter(|s| !s.name.is_empty()) {
            let class = Role::line(series.ink, series.stroke).class();
            if !entries.iter().any(|(_, name)| *name == series.name) {
                entries.push((class, &series.name));
            }
        }
        if entries.len() < 2 {
            Vec::new()
        } else {
            entries
        }
    }

    pub(crate) fn width(&self) -> Size {
        self.size
    }
}
