//! The curves of the monitor: force and depth over time, the loop, the parameters with their bands.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::Span;
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

use estimator_core::Estimate;

use crate::cli::monitor::scene::{SHOWN_S, Scene, Trend};
use crate::number::{Measured, prefix_for, quantity, unit_text};
use crate::report::estimate::label;
use crate::stats::{highest, lowest};

/// A trend needs so many columns.
const TREND_COLUMNS: u16 = 22;

/// Force and depth over time, and the loop beside them.
pub(super) fn draw_strips(frame: &mut Frame, scene: &Scene, area: Rect, with_loop: bool) {
    let beside = if with_loop {
        Constraint::Percentage(38)
    } else {
        Constraint::Length(0)
    };
    let [left, right] = Layout::horizontal([Constraint::Fill(1), beside]).areas(area);
    let [upper, lower] = Layout::vertical([Constraint::Fill(1); 2]).areas(left);
    let times = (scene.time_s - SHOWN_S, scene.time_s);
    for (strip, name, unit, color, place) in [
        (&scene.force, "force", "N", Color::Cyan, upper),
        (&scene.depth, "depth", "m", Color::LightBlue, lower),
    ] {
        let points = strip.points();
        let now = strip_now(scene, unit);
        let title = format!("{name} {now}, last {SHOWN_S:.0} s");
        plot(frame, place, &title, &[(&points, color)], times, unit);
    }
    if with_loop {
        draw_loop(frame, scene, right);
    }
}

fn strip_now(scene: &Scene, unit: &str) -> String {
    let of = |estimate: &Estimate<f32>| match unit {
        "N" => estimate.force_n,
        _ => estimate.depth_m,
    };
    let now = scene.view.estimate.as_ref().map(of);
    now.map_or(String::new(), |now| quantity(now.into(), 3, unit))
}

fn draw_loop(frame: &mut Frame, scene: &Scene, area: Rect) {
    let points: Vec<(f64, f64)> = scene.path.iter().copied().collect();
    let depth = Scaled::of(points.iter().map(|(x, _)| *x), "m");
    let scaled: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x / depth.factor, *y)).collect();
    let title = format!("force over depth [{}]", depth.unit);
    plot(
        frame,
        area,
        &title,
        &[(&scaled, Color::Cyan)],
        (depth.low, depth.high),
        "N",
    );
}

/// The range of an axis in the unit that suits it.
struct Scaled {
    factor: f64,
    unit: String,
    low: f64,
    high: f64,
}

impl Scaled {
    fn of(values: impl Iterator<Item = f64> + Clone, unit: &str) -> Scaled {
        let (low, high) = (lowest(values.clone()), highest(values));
        let (low, high) = match low <= high {
            true => (low.min(0.0), high.max(0.0)),
            false => (0.0, 1.0),
        };
        let high = if high > low { high } else { low + 1e-6 };
        let prefix = prefix_for(low.abs().max(high.abs()), unit);
        Scaled {
            factor: prefix.factor,
            unit: unit_text(prefix, unit),
            low: low / prefix.factor,
            high: high / prefix.factor,
        }
    }
}

/// Lines over a common axis, with the ends of the upright one in figures.
fn plot(
    frame: &mut Frame,
    area: Rect,
    title: &str,
    lines: &[(&[(f64, f64)], Color)],
    across: (f64, f64),
    unit: &str,
) {
    let values = lines
        .iter()
        .flat_map(|(points, _)| points.iter().map(|(_, y)| *y));
    let scale = Scaled::of(values, unit);
    let scaled: Vec<(Vec<(f64, f64)>, Color)> = lines
        .iter()
        .map(|(points, color)| {
            let points = points.iter().map(|(x, y)| (*x, y / scale.factor));
            (points.collect(), *color)
        })
        .collect();
    chart(
        frame,
        area,
        &format!("{title} "),
        &scaled,
        across,
        (scale.low, scale.high),
        &scale.unit,
    );
}

fn chart(
    frame: &mut Frame,
    area: Rect,
    title: &str,
    lines: &[(Vec<(f64, f64)>, Color)],
    across: (f64, f64),
    (low, high): (f64, f64),
    unit: &str,
) {
    let datasets = lines.iter().map(|(points, color)| {
        Dataset::default()
            .marker(Marker::Braille)
            .graph_type(GraphType::Line)
            .style(Style::new().fg(*color))
            .data(points)
    });
    let label = |value: f64| {
        let size = (high - low).abs();
        let places = (1.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        // A zero has no sign.
        let text = format!("{value:.places$}");
        let is_zero = text.parse() == Ok(0.0);
        Span::from(if is_zero { text.replace('-', "") } else { text })
    };
    let upright = Axis::default()
        .bounds([low, high])
        .labels([
            label(low),
            Span::from(format!("{} {unit}", label(high).content)),
        ])
        .style(Style::new().fg(Color::DarkGray));
    let flat = Axis::default()
        .bounds([across.0, across.1])
        .style(Style::new().fg(Color::DarkGray));
    let block = Block::new().title(Span::from(title.to_string()).add_modifier(Modifier::BOLD));
    let chart = Chart::new(datasets.collect())
        .block(block)
        .x_axis(flat)
        .y_axis(upright);
    frame.render_widget(chart.legend_position(None), area);
}

/// The parameters over time with their bands: as many as there is room for, the first ones.
pub(super) fn draw_trends(frame: &mut Frame, scene: &Scene, area: Rect) {
    let room = (area.width / TREND_COLUMNS).max(1) as usize;
    let shown = scene.trends.len().min(room);
    let columns = Layout::horizontal(vec![Constraint::Fill(1); shown]).split(area);
    for (trend, column) in scene.trends.iter().zip(columns.iter()) {
        draw_trend(frame, scene, trend, *column);
    }
}

fn draw_trend(frame: &mut Frame, scene: &Scene, trend: &Trend, area: Rect) {
    let unit = trend.info.unit.symbol();
    // The symbol of the equations where there is one: three of them stand beside each other.
    let name = label(trend.info.name);
    let name = match name.rsplit_once(' ') {
        Some((_, symbol)) if symbol.chars().count() <= 2 => symbol.to_string(),
        _ => name.to_lowercase(),
    };
    let Some((_, value, error)) = trend.points.back().copied() else {
        frame.render_widget(Paragraph::new(format!("{name}\n–")), area);
        return;
    };
    let title = format!("{name} {}", Measured::new(value, Some(error), unit));
    let line = |of: fn(&(f64, f64, f64)) -> f64| -> Vec<(f64, f64)> {
        trend
            .points
            .iter()
            .map(|point| (point.0, of(point)))
            .collect()
    };
    let (middle, low, high) = (line(|p| p.1), line(|p| p.1 - p.2), line(|p| p.1 + p.2));
    // The first estimates may be wrong by orders of magnitude: the axis shows the second half.
    let late: Vec<_> = trend.points.iter().skip(trend.points.len() / 2).collect();
    let least = lowest(late.iter().map(|p| p.1 - p.2));
    let most = highest(late.iter().map(|p| p.1 + p.2));
    let margin = (0.1 * (most - least)).max(1e-3 * value.abs()).max(1e-12);
    let prefix = prefix_for(most.abs().max(least.abs()), unit);
    let scaled = |points: Vec<(f64, f64)>, color| {
        let points = points.into_iter().map(|(x, y)| (x, y / prefix.factor));
        (points.collect::<Vec<_>>(), color)
    };
    let lines = [
        scaled(low, Color::DarkGray),
        scaled(high, Color::DarkGray),
        scaled(middle, Color::Green),
    ];
    let times = (scene.time_s - SHOWN_S, scene.time_s);
    let range = (
        (least - margin) / prefix.factor,
        (most + margin) / prefix.factor,
    );
    chart(frame, area, &format!("{title} "), &lines, times, range, "");
}
