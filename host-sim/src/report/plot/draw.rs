//! Draws a [`Chart`] as SVG: frame, bands, curves.

use plotters::chart::{ChartBuilder, LabelAreaPosition};
use plotters::drawing::IntoDrawingArea;
use plotters::element::{PathElement, Polygon, Rectangle};
use plotters::style::Color;

use super::{
    annotate, annotate::text_style, area::Error, area::Plot, canvas::Canvas, canvas::Layers,
    canvas::PX, canvas::Role, chart::Chart, chart::Level, chart::Series, ink::Ink, ink::Stroke,
    layout::Layout, thin,
};

/// Curves leave the plot by at most this multiple of its size, since plotters counts in i32; what lies
/// outside the plot is clipped anyway.
const FAR: f64 = 20.0;
/// Columns of a pixel that a curve over time is thinned to. With 2 a reader who zooms in sees twice as much; a
/// curve of an hour takes 50 kB, and a report has about twelve.
const FINER: f64 = 2.0;

/// The chart as an SVG element.
pub(super) fn to_svg(chart: &Chart, title: &str) -> String {
    let layout = Layout::new(chart);
    let mut layers = Layers::default();
    // The canvas writes to memory; the only error left would be a layout without room.
    let drawn = draw(chart, &layout, &mut layers);
    debug_assert!(drawn.is_ok(), "{drawn:?}");
    layout.assemble(chart, title, &layers)
}

fn draw(chart: &Chart, layout: &Layout, layers: &mut Layers) -> Result<(), Error> {
    let size = ((layout.width * PX) as u32, (layout.height * PX) as u32);
    let root = Canvas::new(layers, size).into_drawing_area();
    annotate::above(chart, layout, &root)?;
    let mut plot = ChartBuilder::on(&root)
        .margin_top(layout.top * PX)
        .margin_right(layout.right() * PX)
        .set_label_area_size(LabelAreaPosition::Left, layout.left * PX)
        .set_label_area_size(LabelAreaPosition::Bottom, layout.bottom() * PX)
        .build_cartesian_2d(layout.x.clone(), layout.y.clone())?;
    annotate::behind(chart, layout, &plot)?;
    frame(layout, &mut plot)?;
    if !layout.has_data {
        let middle = (
            f64::from(layout.width) * 0.54,
            f64::from(layout.height) * 0.45,
        );
        return annotate::text(&root, "no data", Role::EMPTY.color(), middle);
    }
    for level in &chart.levels {
        level_band(level, layout, &plot)?;
    }
    // Series count from 1: an element without a number belongs to none.
    for (series, number) in chart.series.iter().zip(1..) {
        band(series, number, layout, &plot)?;
    }
    for (series, number) in chart.series.iter().zip(1..) {
        curve(series, number, layout, &plot)?;
    }
    // In front of a dense curve the edges still show where the band is.
    for level in &chart.levels {
        level_edges(level, layout, &plot)?;
    }
    Ok(())
}

/// Draws the axes, the grid, the tick labels and the names.
fn frame(layout: &Layout, plot: &mut Plot) -> Result<(), Error> {
    plot.configure_mesh()
        .bold_line_style(Role::GRID.color())
        .light_line_style(Role::MINOR.color())
        .axis_style(Role::AXIS.color())
        .label_style(text_style(Role::TICK.color()))
        .axis_desc_style(text_style(Role::NAME.color()))
        .set_all_tick_mark_size(4 * PX)
        .x_desc(layout.x.name.as_str())
        .y_desc(layout.y.name.as_str())
        .draw()
}

fn level_band(level: &Level, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    let ends = [level.low, level.high].map(|v| clamp(layout.y.map(v), layout.view().y));
    if ends.iter().any(|end| end.is_nan()) {
        return Ok(());
    }
    let corners = [(layout.x.low, ends[0]), (layout.x.high, ends[1])];
    let style = Role::band(Ink::Muted).color().filled();
    plot.plotting_area().draw(&Rectangle::new(corners, style))
}

fn level_edges(level: &Level, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    for end in [level.low, level.high] {
        let y = clamp(layout.y.map(end), layout.view().y);
        if y.is_finite() {
            let line = vec![(layout.x.low, y), (layout.x.high, y)];
            plot.plotting_area()
                .draw(&PathElement::new(line, Role::EDGE.color()))?;
        }
    }
    Ok(())
}

fn band(series: &Series, number: usize, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    let view = &layout.view().finer(FINER);
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
        let color = Role::band(series.ink).numbered(number);
        plot.plotting_area().draw(&Polygon::new(outline, color))?;
    }
    Ok(())
}

fn curve(series: &Series, number: usize, layout: &Layout, plot: &Plot) -> Result<(), Error> {
    let view = &layout.view();
    let points = series.x.iter().zip(series.y.iter()).map(|(x, y)| {
        let (x, y) = (layout.x.map(*x), layout.y.map(*y));
        (clamp(x, view.x), clamp(y, view.y))
    });
    let area = plot.plotting_area();
    let over_time = series.stroke != Stroke::Dots && thin::is_time_series(&series.x);
    if over_time && thin::is_dense(&thin::over_time(points.clone(), view), view) {
        let color = Role::envelope(series.ink).numbered(number);
        for outline in thin::band(points.map(|(x, y)| (x, y, y)), &view.finer(FINER)) {
            area.draw(&Polygon::new(outline, color))?;
        }
        return Ok(());
    }
    let pieces = match series.stroke {
        Stroke::Dots => vec![thin::dots(points, view)],
        _ if over_time => thin::over_time(points, &view.finer(FINER)),
        _ => thin::along_path(points, view),
    };
    let color = Role::line(series.ink, series.stroke).numbered(number);
    for piece in pieces {
        area.draw(&PathElement::new(piece, color))?;
    }
    Ok(())
}

/// Keeps a value near enough to the axis for the whole numbers of plotters. A value that is not finite
/// becomes NaN.
fn clamp(value: f64, (low, high): (f64, f64)) -> f64 {
    let far = FAR * (high - low);
    value.max(low - far).min(high + far) + 0.0 * value
}
