//! From a [`Chart`] to SVG: layout, frame, shading, curves.

use std::fmt::Write;

use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, TextStyle};

use super::axis::Scale;
use super::canvas::{Canvas, Layers, PX, Role};
use super::thin::{self, Point, View};
use super::{Chart, Ink, Series, Size, Stroke};
use crate::report::html::escape;

type Error = DrawingAreaErrorKind<std::convert::Infallible>;
type Plot<'a, 'c> = ChartContext<'a, Canvas<'c>, Cartesian2d<Scale, Scale>>;

/// Curves leave the plot by at most this many of its sizes: plotters counts in i32, and the clip
/// hides the rest.
const FAR: f64 = 20.0;
/// Width of a digit of the tick labels [px], for 12 px of any common sans-serif.
const DIGIT_PX: f64 = 6.8;

/// The chart as an SVG element.
pub(super) fn to_svg(chart: &Chart, title: &str) -> String {
    let layout = Layout::new(chart);
    let mut layers = Layers::default();
    // The canvas writes to memory; the only errors left would be a layout without room.
    let drawn = draw(chart, &layout, &mut layers);
    debug_assert!(drawn.is_ok(), "{drawn:?}");
    layout.assemble(chart, title, &layers)
}

/// Sizes in pixels, and the axes.
struct Layout {
    width: i32,
    height: i32,
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
    strip_top: i32,
    x: Scale,
    y: Scale,
    has_data: bool,
}

const STRIP_HEIGHT: i32 = 15;
const LABEL_HEIGHT: i32 = 18;

impl Layout {
    fn new(chart: &Chart) -> Layout {
        let (width, height) = match chart.size {
            Size::Wide => (1000, 250),
            Size::Half => (490, 300),
        };
        let extent = Extent::of(chart);
        let y = chart.y.resolve(extent.y, 6);
        let longest = y.ticks.iter().map(|(_, t)| t.chars().count()).max();
        let labels = (longest.unwrap_or(1) as f64 * DIGIT_PX).ceil() as i32;
        // Charts above each other share their left edge while the labels have up to four digits.
        let left = 38 + labels.max(28);
        let marker_rows = i32::from(!chart.markers.is_empty());
        let strip_rows = i32::from(!chart.strip.is_empty());
        let strip_top = 6 + LABEL_HEIGHT * marker_rows;
        let right = 14;
        let x = chart
            .x
            .resolve(extent.x, ((width - left - right) / 85) as usize);
        Layout {
            width,
            height: height + (LABEL_HEIGHT * marker_rows) + (STRIP_HEIGHT * strip_rows),
            left,
            right,
            top: strip_top + (STRIP_HEIGHT + 2) * strip_rows,
            bottom: 46,
            strip_top,
            x,
            y,
            has_data: extent.x.is_some() && extent.y.is_some(),
        }
    }

    fn view(&self) -> View {
        View {
            x: (self.x.low, self.x.high),
            y: (self.y.low, self.y.high),
            size_px: (
                f64::from(self.width - self.left - self.right),
                f64::from(self.height - self.top - self.bottom),
            ),
        }
    }

    /// Position on the canvas [units] of a value on the x axis.
    fn x_unit(&self, at: f64) -> i32 {
        let view = self.view();
        let px = (at - view.x.0) / (view.x.1 - view.x.0) * view.size_px.0;
        ((f64::from(self.left) + px.clamp(0.0, view.size_px.0)) * f64::from(PX)).round() as i32
    }

    fn assemble(&self, chart: &Chart, title: &str, layers: &Layers) -> String {
        let (w, h) = (self.width * PX, self.height * PX);
        let view = self.view();
        let (x, y) = (self.left * PX, self.top * PX);
        let (pw, ph) = (view.size_px.0 as i32 * PX, view.size_px.1 as i32 * PX);
        let names: Vec<&str> = chart.series.iter().map(|s| s.name.as_str()).collect();
        let mut svg = String::with_capacity(layers.frame.len() + layers.data.len() + 800);
        let _ = write!(
            svg,
            "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" \
             role=\"img\" aria-label=\"{}: {} over {}; {}\">\n{}\
             <svg x=\"{x}\" y=\"{y}\" width=\"{pw}\" height=\"{ph}\" \
             viewBox=\"{x} {y} {pw} {ph}\" overflow=\"hidden\">\n{}</svg>\n</svg>",
            escape(title),
            escape(&self.y.name),
            escape(&self.x.name),
            escape(&names.join(", ")),
            layers.frame,
            layers.data,
        );
        svg
    }
}

/// What the data spans.
#[derive(Default)]
struct Extent {
    x: Option<(f64, f64)>,
    y: Option<(f64, f64)>,
}

impl Extent {
    fn of(chart: &Chart) -> Extent {
        let mut extent = Extent::default();
        for series in &chart.series {
            for (i, (x, y)) in series.x.iter().zip(series.y.iter()).enumerate() {
                if x.is_finite() && y.is_finite() {
                    grow(&mut extent.x, *x);
                    grow(&mut extent.y, *y);
                    let half = series.half_width.as_ref().and_then(|h| h.get(i));
                    if let Some(half) = half.filter(|half| half.is_finite()) {
                        grow(&mut extent.y, y - half);
                        grow(&mut extent.y, y + half);
                    }
                }
            }
        }
        if extent.y.is_some() {
            for (low, high) in chart
                .bands
                .iter()
                .filter(|b| b.0.is_finite() && b.1.is_finite())
            {
                grow(&mut extent.y, *low);
                grow(&mut extent.y, *high);
            }
        }
        extent
    }
}

fn grow(range: &mut Option<(f64, f64)>, value: f64) {
    let (low, high) = range.unwrap_or((value, value));
    *range = Some((low.min(value), high.max(value)));
}

fn draw(chart: &Chart, layout: &Layout, layers: &mut Layers) -> Result<(), Error> {
    let size = ((layout.width * PX) as u32, (layout.height * PX) as u32);
    let root = Canvas::new(layers, size).into_drawing_area();
    draw_markers_and_strip(chart, layout, &root)?;
    let mut plot = ChartBuilder::on(&root)
        .margin_top(layout.top * PX)
        .margin_right(layout.right * PX)
        .set_label_area_size(LabelAreaPosition::Left, layout.left * PX)
        .set_label_area_size(LabelAreaPosition::Bottom, layout.bottom * PX)
        .build_cartesian_2d(layout.x.clone(), layout.y.clone())?;
    draw_shading(chart, layout, &plot)?;
    draw_frame(layout, &mut plot)?;
    if !layout.has_data {
        return draw_text(
            &root,
            "no data",
            Role::EMPTY,
            (layout.width / 2, layout.height / 2),
        );
    }
    let view = layout.view();
    for series in &chart.series {
        draw_band(series, layout, &view, &plot)?;
    }
    for series in &chart.series {
        draw_curve(series, layout, &view, &plot)?;
    }
    Ok(())
}

fn text_style(role: Role) -> TextStyle<'static> {
    ("sans-serif", 12 * PX).into_font().color(&role.color())
}

fn draw_text(
    root: &DrawingArea<Canvas, Shift>,
    text: &str,
    role: Role,
    (x, y): (i32, i32),
) -> Result<(), Error> {
    let style = text_style(role).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new(text.to_string(), (x * PX, y * PX), style))
}

/// Axes, grid, tick labels, names.
fn draw_frame(layout: &Layout, plot: &mut Plot) -> Result<(), Error> {
    plot.configure_mesh()
        .bold_line_style(Role::GRID.color())
        .light_line_style(Role::MINOR.color())
        .axis_style(Role::AXIS.color())
        .label_style(text_style(Role::TICK))
        .axis_desc_style(text_style(Role::NAME))
        .set_all_tick_mark_size(4 * PX)
        .x_desc(layout.x.name.as_str())
        .y_desc(layout.y.name.as_str())
        .draw()
}

/// Touches, level bands and the lines of events, behind the curves.
fn draw_shading(chart: &Chart, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    let (low, high) = (layout.y.low, layout.y.high);
    let area = plot.plotting_area();
    let rectangle =
        |a: Point, b: Point, role: Role| area.draw(&Rectangle::new([a, b], role.color().filled()));
    for (from, to) in merge(&chart.touches, layout) {
        rectangle((from, low), (to, high), Role::TOUCH)?;
    }
    for (a, b) in &chart.bands {
        let ends = [*a, *b].map(|v| layout.y.map(v).clamp(low, high));
        if ends[0] < ends[1] {
            let x = (layout.x.low, layout.x.high);
            rectangle((x.0, ends[0]), (x.1, ends[1]), Role::band(Ink::Muted))?;
        }
    }
    for marker in visible_markers(chart, layout) {
        let at = layout.x.map(marker.at);
        let line = vec![(at, low), (at, high)];
        area.draw(&PathElement::new(line, Role::event(marker.major).color()))?;
    }
    Ok(())
}

/// Touches within the axis, joined where less than half a pixel lies between.
fn merge(touches: &[(f64, f64)], layout: &Layout) -> Vec<(f64, f64)> {
    let (low, high) = (layout.x.low, layout.x.high);
    let gap = 0.5 * (high - low) / layout.view().size_px.0;
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (from, to) in touches {
        let (from, to) = (layout.x.map(*from).max(low), layout.x.map(*to).min(high));
        match out.last_mut() {
            // False as well where an end is not a number.
            _ if !(from < to) => {}
            Some(last) if from - last.1 < gap => last.1 = last.1.max(to),
            _ => out.push((from, to)),
        }
    }
    out
}

/// More minor markers than this would be a grey wall; the shading tells touches as well.
const MOST_MINOR: usize = 40;
/// And more major ones than this.
const MOST_MAJOR: usize = 200;

fn visible_markers<'c>(chart: &'c Chart, layout: &Layout) -> Vec<&'c super::Marker> {
    let inside = |m: &&super::Marker| {
        let at = layout.x.map(m.at);
        at >= layout.x.low && at <= layout.x.high
    };
    let of = |major: bool, most: usize| {
        let some: Vec<_> = chart
            .markers
            .iter()
            .filter(|m| m.major == major)
            .filter(inside)
            .collect();
        if some.len() > most { Vec::new() } else { some }
    };
    let mut markers = of(true, MOST_MAJOR);
    markers.extend(of(false, MOST_MINOR));
    markers
}

/// Labels of events where there is room, major ones first, and the strip of states.
fn draw_markers_and_strip(
    chart: &Chart,
    layout: &Layout,
    root: &DrawingArea<Canvas, Shift>,
) -> Result<(), Error> {
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for marker in visible_markers(chart, layout) {
        let half = 0.5 * text_px(&marker.label) + 5.0;
        let left = f64::from(layout.left - 20) + half;
        let right = f64::from(layout.width) - half;
        let at = f64::from(layout.x_unit(layout.x.map(marker.at))) / f64::from(PX);
        let at = at.min(right).max(left);
        if taken
            .iter()
            .all(|(from, to)| at + half < *from || at - half > *to)
        {
            taken.push((at - half, at + half));
            let role = Role::event_label(marker.major);
            draw_text(root, &marker.label, role, (at as i32, layout.strip_top - 9))?;
        }
    }
    draw_strip(chart, layout, root)
}

fn text_px(text: &str) -> f64 {
    text.chars().count() as f64 * 6.2
}

fn draw_strip(
    chart: &Chart,
    layout: &Layout,
    root: &DrawingArea<Canvas, Shift>,
) -> Result<(), Error> {
    let (top, bottom) = (layout.strip_top, layout.strip_top + STRIP_HEIGHT - 2);
    let mut drawn_to = i32::MIN;
    for span in &chart.strip {
        let from = layout.x_unit(layout.x.map(span.from)).max(drawn_to);
        let to = layout.x_unit(layout.x.map(span.to));
        // Shorter than half a pixel: not seen, and a flickering state could fill the file.
        if to - from < PX / 2 {
            continue;
        }
        drawn_to = to;
        let corners = [(from, top * PX), (to, bottom * PX)];
        root.draw(&Rectangle::new(
            corners,
            Role::strip(span.tone).color().filled(),
        ))?;
        if f64::from((to - from) / PX) > text_px(&span.label) + 4.0 {
            let middle = ((from + to) / 2 / PX, (top + bottom) / 2);
            draw_text(root, &span.label, Role::STRIP_LABEL, middle)?;
        }
    }
    Ok(())
}

fn draw_band(series: &Series, layout: &Layout, view: &View, plot: &Plot) -> Result<(), Error> {
    let Some(half_width) = &series.half_width else {
        return Ok(());
    };
    let points = series.x.iter().zip(series.y.iter()).zip(half_width.iter());
    let points = points.map(|((x, y), half)| {
        let edge = |v: f64| clamp(layout.y.map(v), view.y);
        (
            clamp(layout.x.map(*x), view.x),
            edge(y - half),
            edge(y + half),
        )
    });
    for outline in thin::band(points, view) {
        let role = Role::band(series.ink);
        plot.plotting_area()
            .draw(&Polygon::new(outline, role.color()))?;
    }
    Ok(())
}

fn draw_curve(series: &Series, layout: &Layout, view: &View, plot: &Plot) -> Result<(), Error> {
    let points = series.x.iter().zip(series.y.iter());
    let points = points.map(|(x, y)| {
        let (x, y) = (layout.x.map(*x), layout.y.map(*y));
        (clamp(x, view.x), clamp(y, view.y))
    });
    let role = Role::line(series.ink, series.stroke);
    let pieces = match series.stroke {
        Stroke::Dots => vec![thin::dots(points, view)],
        _ if thin::is_time_series(&series.x) => thin::over_time(points, view),
        _ => thin::along_path(points, view),
    };
    for piece in pieces {
        plot.plotting_area()
            .draw(&PathElement::new(piece, role.color()))?;
    }
    Ok(())
}

/// Keeps a value near enough to the plot for plotters' whole numbers; NaN stays NaN.
fn clamp(value: f64, (low, high): (f64, f64)) -> f64 {
    let far = FAR * (high - low);
    value.max(low - far).min(high + far) + 0.0 * value
}
