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

#[cfg(test)]
mod tests {
    use super::*;

    fn chart<'a>(x: &'a [f64], y: &'a [f64]) -> Chart<'a> {
        Chart::new(Axis::time(), Axis::new("Force", "N"))
            .series(Series::estimated("estimated", x, y).band(vec![0.1; y.len()]))
            .series(Series::measured("measured", x, y))
            .series(Series::new("dots", Ink::Second, Stroke::Dots, x, y))
    }

    fn parse(svg: &str) -> roxmltree::Document<'_> {
        roxmltree::Document::parse(svg).unwrap()
    }

    fn count(svg: &str, class: &str) -> usize {
        let document = parse(svg);
        let has = |n: &roxmltree::Node| n.attribute("class") == Some(class);
        document.descendants().filter(has).count()
    }

    #[test]
    fn whatever_the_data_the_svg_is_well_formed_and_has_numbers_only() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for (x, y) in [
            (&[][..], &[][..]),
            (&[1.0], &[2.0]),
            (&[0.0, 1.0], &[3.0, 3.0]),
            (&[1.0, 1.0], &[0.0, 5.0]),
            (&[nan, nan], &[nan, nan]),
            (&[0.0, 1.0, 2.0], &[1.0, inf, -inf]),
            (&[-1e300, 1e300], &[-1e300, 1e300]),
            (&[0.0, 1e-300], &[1e-300, 0.0]),
            (&[0.0, 1.0], &[1e9, 1e9 + 1.0]),
            (&[2.0, 1.0, 3.0], &[1.0, 2.0, 3.0]),
        ] {
            let svg = chart(x, y).size(Size::Wide).to_svg("t");
            parse(&svg);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{x:?} {y:?}");
        }
    }

    #[test]
    fn an_axis_that_leaves_the_data_out_clips_it_near_the_plot() {
        let (x, y) = ([0.0, 1.0, 2.0], [0.0, 1e12, 0.0]);
        let axis = Axis::new("Force", "N").range(0.0, 1.0);
        let chart = Chart::new(Axis::time(), axis).series(Series::estimated("", &x, &y));
        parse(&chart.to_svg("t"));
    }

    #[test]
    fn without_data_the_chart_says_so() {
        assert!(chart(&[], &[]).to_svg("t").contains(">no data</text>"));
        assert!(!chart(&[0.0], &[1.0]).to_svg("t").contains("no data"));
    }

    #[test]
    fn a_gap_in_the_data_is_a_gap_in_the_line() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let svg = chart(&x, &[1.0, 2.0, f64::NAN, 2.0, 1.0]).to_svg("t");
        assert_eq!(count(&svg, "line a"), 2);
        assert_eq!(count(&svg, "band a"), 2);
        assert_eq!(count(&svg, "line dashed m"), 2);
    }

    #[test]
    fn a_hundred_thousand_points_take_less_than_80_kb() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|x| (x * x).sin()).collect();
        let bare = Chart::new(Axis::time(), Axis::new("y", "1"));
        let line = bare.clone().size(Size::Wide);
        let line = line.series(Series::estimated("", &x, &y)).to_svg("t");
        let path = bare.series(Series::estimated("", &y, &x)).to_svg("t");
        // Measured: 11 kB (an envelope) and 54 kB.
        assert!((5_000..60_000).contains(&line.len()), "{}", line.len());
        assert!((5_000..80_000).contains(&path.len()), "{}", path.len());
    }

    #[test]
    fn events_have_labels_where_there_is_room_and_major_ones_come_first() {
        let x = [0.0, 100.0];
        let marker = |at: f64, label: &str, major| Marker {
            at,
            label: label.into(),
            major,
        };
        let events = [
            marker(10.0, "contact", false),
            marker(50.0, "release", false),
            marker(50.5, "material change", true),
            marker(80.0, "contact", false),
            marker(500.0, "outside", true),
        ];
        let svg = chart(&x, &x).markers(events).to_svg("t");
        assert_eq!(count(&svg, "event-label major"), 1);
        // The release has no room, so of each minor kind only the first is labelled.
        assert_eq!(count(&svg, "event-label"), 1);
        assert_eq!((count(&svg, "event"), count(&svg, "event major")), (3, 1));
        assert!(!svg.contains("outside"));
    }

    #[test]
    fn touches_are_shaded_and_joined_where_no_gap_can_be_seen() {
        let x = [0.0, 100.0];
        let far = [(10.0, 20.0), (30.0, 40.0), (90.0, 1e9), (f64::NAN, 5.0)];
        assert_eq!(count(&chart(&x, &x).touches(far).to_svg("t"), "touch"), 3);
        let near = (0..10_000).map(|i| (0.01 * f64::from(i), 0.01 * f64::from(i) + 0.009));
        assert_eq!(count(&chart(&x, &x).touches(near).to_svg("t"), "touch"), 1);
    }

    #[test]
    fn a_strip_names_its_states_where_there_is_room() {
        let x = [0.0, 100.0];
        let span = |from, to, tone| Span {
            from,
            to,
            label: "converged".into(),
            tone,
        };
        let spans = [
            span(0.0, 2.0, StripTone::Warning),
            span(2.0, 2.01, StripTone::Bad),
            span(2.01, 100.0, StripTone::Good),
        ];
        let svg = chart(&x, &x).strip(spans).to_svg("t");
        assert_eq!(count(&svg, "strip warning") + count(&svg, "strip good"), 2);
        assert_eq!(count(&svg, "strip bad"), 0);
        assert_eq!(count(&svg, "strip-label"), 1);
    }

    #[test]
    fn a_single_curve_needs_no_legend() {
        let x = [0.0, 1.0];
        let one = Chart::new(Axis::time(), Axis::time()).series(Series::estimated("a", &x, &x));
        assert!(one.legend().is_empty());
        let names: Vec<_> = chart(&x, &x)
            .legend()
            .into_iter()
            .map(|(_, n)| n.to_string())
            .collect();
        assert_eq!(names, ["estimated", "measured", "dots"]);
    }

    #[test]
    fn every_class_that_a_chart_writes_has_a_rule() {
        let style = include_str!("style.css");
        let inks = [Ink::Measured, Ink::Muted].into_iter().chain(Ink::RANKS);
        for ink in inks {
            let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Dots, Stroke::Thin];
            let roles = strokes.map(|stroke| Role::line(ink, stroke));
            for role in roles
                .into_iter()
                .chain([Role::band(ink), Role::envelope(ink)])
            {
                for class in role.class().split(' ') {
                    assert!(style.contains(&format!(".{class}")), "{class}");
                }
            }
        }
    }
}
