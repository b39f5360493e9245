//! What is drawn beside the curves: shaded touches, lines and labels of events, the strip of states.

use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, IntoFont, RGBColor, TextStyle};

use super::{
    area::Error, area::Plot, area::Root, canvas::PX, canvas::Role, chart::Chart, chart::Marker,
    layout::Layout, layout::STRIP_HEIGHT, marks::of_rank, marks::visible,
};

/// The width of a letter of a label [px].
const LETTER_PX: f64 = 6.2;

pub(super) fn text_style(color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", 12 * PX).into_font().color(&color)
}

/// Draws a text centred on a point [px].
pub(super) fn text(
    root: &Root,
    text: &str,
    color: RGBColor,
    (x, y): (f64, f64),
) -> Result<(), Error> {
    let style = text_style(color).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new(text.to_string(), (units(x), units(y)), style))
}

/// A length [px] in units of the canvas.
fn units(px: f64) -> i32 {
    (px * f64::from(PX)).round() as i32
}

/// Draws the touches and the lines of events behind the curves.
pub(super) fn behind(chart: &Chart, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    let (low, high) = (layout.y.low, layout.y.high);
    let area = plot.plotting_area();
    for (from, to) in merge(&chart.touches, layout) {
        let style = Role::TOUCH.color().filled();
        area.draw(&Rectangle::new([(from, low), (to, high)], style))?;
    }
    for marker in visible(chart, &layout.x) {
        let at = layout.x.map(marker.at);
        let line = vec![(at, low), (at, high)];
        area.draw(&PathElement::new(line, Role::event(marker.major).color()))?;
    }
    Ok(())
}

/// The touches within the axis. Touches with less than half a pixel between them are joined.
fn merge(touches: &[(f64, f64)], layout: &Layout) -> Vec<(f64, f64)> {
    let (low, high) = (layout.x.low, layout.x.high);
    let gap = 0.5 * (high - low) / layout.view().size_px.0;
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (from, to) in touches {
        let (from, to) = (layout.x.map(*from).max(low), layout.x.map(*to).min(high));
        if !(from < to && from.is_finite()) {
            continue;
        }
        match out.last_mut() {
            Some(last) if from - last.1 < gap => last.1 = last.1.max(to),
            _ => out.push((from, to)),
        }
    }
    out
}

/// Draws the labels of events and the strip of states.
pub(super) fn above(chart: &Chart, layout: &Layout, root: &Root) -> Result<(), Error> {
    let mut labels = Labels::new(layout);
    for marker in of_rank(chart, &layout.x, true) {
        labels.add_if_free(marker);
    }
    // If every second label of a kind were left out, it would seem that only every second touch was
    // released: either all labels of a kind are shown, or only the first one.
    let before = labels.placed.len();
    if !of_rank(chart, &layout.x, false).all(|marker| labels.add_if_free(marker)) {
        labels.placed.truncate(before);
        for marker in of_rank(chart, &layout.x, false) {
            if labels
                .placed
                .iter()
                .all(|(_, _, old)| old.label != marker.label)
            {
                labels.add_if_free(marker);
            }
        }
    }
    for (middle, _, marker) in &labels.placed {
        let at = (*middle, f64::from(layout.strip_top) - 9.0);
        // The label may stand beside its line; the script moves it with the line.
        let line = units(layout.x_px(marker.at)) as usize;
        let color = Role::event_label(marker.major).numbered(line);
        text(root, &marker.label, color, at)?;
    }
    strip(chart, layout, root)
}

/// The labels in one row that do not cover each other, each with its middle, half width and marker.
struct Labels<'c> {
    ends: (f64, f64),
    layout: &'c Layout,
    placed: Vec<(f64, f64, &'c Marker)>,
}

impl<'c> Labels<'c> {
    fn new(layout: &'c Layout) -> Self {
        Labels {
            ends: (f64::from(layout.left - 20), f64::from(layout.width)),
            layout,
            placed: Vec::new(),
        }
    }

    fn add_if_free(&mut self, marker: &'c Marker) -> bool {
        let half = 0.5 * text_px(&marker.label) + 5.0;
        let at = self.layout.x_px(marker.at);
        let at = at.min(self.ends.1 - half).max(self.ends.0 + half);
        let free = |(other, width, _): &(f64, f64, _)| (at - other).abs() >= half + width;
        let is_free = self.placed.iter().all(free);
        if is_free {
            self.placed.push((at, half, marker));
        }
        is_free
    }
}

fn text_px(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER_PX
}

fn strip(chart: &Chart, layout: &Layout, root: &Root) -> Result<(), Error> {
    let (top, bottom) = (layout.strip_top, layout.strip_top + STRIP_HEIGHT - 2);
    let mut drawn_to = f64::NEG_INFINITY;
    for span in &chart.strip {
        let from = layout.x_px(span.from).max(drawn_to);
        let to = layout.x_px(span.to);
        // A state of less than half a pixel cannot be seen, and a flickering one could fill the file.
        if to - from < 0.5 || to.is_nan() || from.is_nan() {
            continue;
        }
        drawn_to = to;
        let corners = [(units(from), top * PX), (units(to), bottom * PX)];
        root.draw(&Rectangle::new(
            corners,
            Role::strip(span.tone).color().filled(),
        ))?;
        if to - from > text_px(&span.label) + 4.0 {
            let middle = (0.5 * (from + to), 0.5 * f64::from(top + bottom));
            text(root, &span.label, Role::STRIP_LABEL.color(), middle)?;
        }
    }
    Ok(())
}
