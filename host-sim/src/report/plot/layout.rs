//! The places of the parts of a chart, and the ranges of its axes.

use std::fmt::Write;

use super::{
    axis::Scale, canvas::Layers, canvas::PX, chart::Chart, chart::Size, marks::visible, thin::View,
};
use crate::report::html::escape;

/// The height of the strip of states, and of a row of labels above the plot [px].
pub(super) const STRIP_HEIGHT: i32 = 15;
const LABEL_HEIGHT: i32 = 18;
/// The room for tick labels and the name of the axis below the plot [px].
const BOTTOM: i32 = 43;
const RIGHT: i32 = 14;
/// The width of a digit of the tick labels [px], for 12 px of any common sans-serif.
const DIGIT_PX: f64 = 6.8;
/// The length that a labelled tick takes of the x axis, and of the y axis [px].
const TICK_PX: (i32, i32) = (65, 32);

/// The sizes in pixels, and the fitted axes.
pub(super) struct Layout {
    pub(super) width: i32,
    pub(super) height: i32,
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) strip_top: i32,
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) has_data: bool,
}

impl Layout {
    pub(super) fn new(chart: &Chart) -> Layout {
        let (width, plot_height) = match chart.size {
            Size::Wide => (900, 200),
            Size::Slim => (900, 140),
            Size::Half => (430, 230),
        };
        let extent = Extent::of(chart);
        let y = chart
            .y
            .resolve(extent.y, (plot_height / TICK_PX.1) as usize);
        let longest = y.ticks.iter().map(|(_, t)| t.chars().count()).max();
        let labels = (longest.unwrap_or(1) as f64 * DIGIT_PX).ceil() as i32;
        // Charts above each other share their left edge as long as their labels are no longer than this.
        let usual = if chart.size == Size::Half { 28 } else { 41 };
        let left = 36 + labels.max(usual);
        let ticks = ((width - left - RIGHT) / TICK_PX.0).min(10);
        let x = chart.x.resolve(extent.x, ticks as usize);
        let has_markers = visible(chart, &x).next().is_some();
        let strip_top = 6 + LABEL_HEIGHT * i32::from(has_markers);
        let top = strip_top + (STRIP_HEIGHT + 2) * i32::from(!chart.strip.is_empty());
        Layout {
            width,
            height: top + plot_height + BOTTOM,
            left,
            top,
            strip_top,
            x,
            y,
            has_data: extent.x.is_some() && extent.y.is_some(),
        }
    }

    pub(super) fn right(&self) -> i32 {
        RIGHT
    }

    pub(super) fn bottom(&self) -> i32 {
        BOTTOM
    }

    pub(super) fn view(&self) -> View {
        View {
            x: (self.x.low, self.x.high),
            y: (self.y.low, self.y.high),
            size_px: (
                f64::from(self.width - self.left - RIGHT),
                f64::from(self.height - self.top - BOTTOM),
            ),
        }
    }

    /// The position [px] of a value on the x axis, kept within the plot.
    pub(super) fn x_px(&self, at: f64) -> f64 {
        let view = self.view();
        let px = (self.x.map(at) - view.x.0) / (view.x.1 - view.x.0) * view.size_px.0;
        f64::from(self.left) + px.clamp(0.0, view.size_px.0)
    }

    /// The SVG element with the layers. The plot is an element of its own, which clips the curves; so is what lies
    /// behind the grid. The script of the page moves both when a reader zooms in, and reads the axes and the names
    /// of the series off the outer element.
    pub(super) fn assemble(&self, chart: &Chart, title: &str, layers: &Layers) -> String {
        let (w, h) = (self.width * PX, self.height * PX);
        let (width, height) = self.view().size_px;
        let (pw, ph) = (width as i32 * PX, height as i32 * PX);
        let (x, y) = (self.left * PX, self.top * PX);
        let plot = |class: &str, contents: &str| {
            format!(
                "<svg class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{pw}\" height=\"{ph}\" \
                 viewBox=\"{x} {y} {pw} {ph}\" preserveAspectRatio=\"none\" overflow=\"hidden\">\n{contents}</svg>\n"
            )
        };
        let mut svg = String::with_capacity(layers.data.len() + layers.frame.len() + 1200);
        let _ = write!(
            svg,
            "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" \
             role=\"img\" aria-label=\"{}\"{}>\n{}{}{}</svg>",
            escape(&self.spoken(chart, title)),
            self.attributes(chart),
            plot("back", &layers.back),
            layers.frame,
            plot("plot", &layers.data),
        );
        svg
    }

    /// What a screen reader says of the chart.
    fn spoken(&self, chart: &Chart, title: &str) -> String {
        let names = chart.series.iter().map(|s| s.name.as_str());
        let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
        format!(
            "{title}: {} over {}. {}",
            self.y.name,
            self.x.name,
            names.join(", ")
        )
    }

    /// Each axis by its ends, whether it is logarithmic, and its name with the unit; and the names of the series.
    fn attributes(&self, chart: &Chart) -> String {
        let mut out = String::new();
        if !self.has_data {
            return out;
        }
        for (letter, scale) in [("x", &self.x), ("y", &self.y)] {
            let log = u8::from(scale.is_log());
            // Writing into a String cannot fail.
            let _ = write!(
                out,
                " data-{letter}=\"{} {} {log}\" data-{letter}n=\"{}\"",
                scale.low,
                scale.high,
                escape(&scale.name)
            );
        }
        for (series, number) in chart.series.iter().zip(1..) {
            let _ = write!(out, " data-n{number}=\"{}\"", escape(&series.name));
        }
        out
    }
}

/// The range of the data.
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
                // A time axis shows all of the log, also where this curve has no values.
                if x.is_finite() && (y.is_finite() || chart.x.is_tight()) {
                    grow(&mut extent.x, *x);
                }
                if x.is_finite() && y.is_finite() {
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
            for level in &chart.levels {
                let ends = [level.low, level.high].into_iter();
                ends.filter(|end| end.is_finite())
                    .for_each(|end| grow(&mut extent.y, end));
            }
        }
        extent
    }
}

fn grow(range: &mut Option<(f64, f64)>, value: f64) {
    let (low, high) = range.unwrap_or((value, value));
    *range = Some((low.min(value), high.max(value)));
}
