//! Charts as SVG for a [`Document`](super::Document): what is drawn, not how.
//!
//! ```
//! use palpate::report::plot::{Axis, Chart, Series};
//!
//! let (time_s, force_n) = ([0.0, 0.1, 0.2], [0.0, 4.1, 0.2]);
//! let svg = Chart::new(Axis::time(), Axis::new("Force", "N"))
//!     .series(Series::measured("measured", &time_s, &force_n))
//!     .to_svg("Force over time");
//! assert!(svg.starts_with("<svg") && svg.contains("Force [N]"));
//! ```
//!
//! A chart never fails: no data gives an empty frame that says so, values that are not finite break
//! the line, and long series are thinned to what can be seen.

mod annotate;
mod axis;
mod canvas;
mod draw;
mod layout;
mod thin;

use std::borrow::Cow;

pub use axis::Axis;
pub(crate) use canvas::Role;

/// The colour of a series. The style sheet gives them colours that people with any colour vision
/// tell apart (Okabe & Ito), others in dark mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Ink {
    /// What was measured: neutral, dark on light.
    Measured = 0,
    /// The first colour: the estimate, the better model.
    First = 1,
    /// The second colour.
    Second = 2,
    /// The third colour.
    Third = 3,
    /// The fourth colour.
    Fourth = 4,
    /// Background: noise bands, references.
    Muted = 5,
}

impl Ink {
    pub(crate) const CLASSES: [&'static str; 6] = ["m", "a", "b", "c", "d", "n"];
    /// The colours for series of equal rank, in order.
    pub const RANKS: [Ink; 4] = [Ink::First, Ink::Second, Ink::Third, Ink::Fourth];
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stroke {
    /// A line.
    Solid = 0,
    /// A dashed line.
    Dashed = 1,
    /// A dot for each point.
    Dots = 2,
    /// A hairline, for a noisy signal.
    Thin = 3,
}

/// One curve, with a band around it if it has one.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    name: String,
    ink: Ink,
    stroke: Stroke,
    x: Cow<'a, [f64]>,
    y: Cow<'a, [f64]>,
    half_width: Option<Cow<'a, [f64]>>,
}

impl<'a> Series<'a> {
    /// A curve through the points (x, y), as many as the shorter of the two has.
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

    /// What was measured: dashed and neutral.
    pub fn measured(
        name: impl Into<String>,
        x: impl Into<Cow<'a, [f64]>>,
        y: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Series::new(name, Ink::Measured, Stroke::Dashed, x, y)
    }

    /// What was estimated: solid, in the first colour.
    pub fn estimated(
        name: impl Into<String>,
        x: impl Into<Cow<'a, [f64]>>,
        y: impl Into<Cow<'a, [f64]>>,
    ) -> Self {
        Series::new(name, Ink::First, Stroke::Solid, x, y)
    }

    /// A band of y ± `half_width` around it: a standard error.
    pub fn band(mut self, half_width: impl Into<Cow<'a, [f64]>>) -> Self {
        self.half_width = Some(half_width.into());
        self
    }
}

/// Something that happened at one instant: a vertical line with a label above the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Where, in the unit of the x axis.
    pub at: f64,
    /// What.
    pub label: String,
    /// Major markers are drawn strong, and their labels first where there is no room for all.
    pub major: bool,
}

/// A state that holds from one instant to another, in the strip above the plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// From, in the unit of the x axis.
    pub from: f64,
    /// To.
    pub to: f64,
    /// Written inside where there is room.
    pub label: String,
    /// Its colour.
    pub tone: StripTone,
}

/// The colours of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum StripTone {
    /// As it should be.
    Good = 0,
    /// On its way, or to be looked at.
    Warning = 1,
    /// Not to be trusted.
    Bad = 2,
    /// Nothing to say.
    Neutral = 3,
    /// News.
    Info = 4,
}

/// A horizontal band.
#[derive(Clone, Copy, Debug)]
struct Level {
    low: f64,
    high: f64,
}

/// How much of the page a chart takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// The whole width, for anything over time.
    Wide,
    /// The whole width and less high, for several above each other.
    Slim,
    /// Half the width, for loops and for two beside each other.
    Half,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    x: Axis,
    y: Axis,
    size: Size,
    series: Vec<Series<'a>>,
    levels: Vec<Level>,
    markers: Vec<Marker>,
    touches: Vec<(f64, f64)>,
    strip: Vec<Span>,
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

    /// How much of the page it takes.
    pub fn size(mut self, size: Size) -> Self {
        self.size = size;
        self
    }

    /// Adds a curve; later ones lie on top.
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

    /// Shades intervals of x: the touches.
    pub fn touches(mut self, touches: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.touches.extend(touches);
        self
    }

    /// States over x, in a strip above the plot.
    pub fn strip(mut self, spans: impl IntoIterator<Item = Span>) -> Self {
        self.strip.extend(spans);
        self
    }

    /// The SVG element; `title` is what a screen reader says it shows.
    pub fn to_svg(&self, title: &str) -> String {
        draw::to_svg(self, title)
    }

    /// Class and name of what a legend has to explain, in the order of drawing; curves that share a
    /// name share an entry. Empty when a single curve needs no explanation.
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
