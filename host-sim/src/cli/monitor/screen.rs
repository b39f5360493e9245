//! The picture of the monitor, for a terminal of any size: what matters most stays when room gets scarce.

mod charts;

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Color, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use estimator_core::board::link::{Health, Range};
use estimator_core::board::settings::Key;
use estimator_core::{Estimate, Status};

use super::scene::Scene;
use super::view::{parameters, phase};
use crate::link::{condition, device::Statistics};
use crate::number::quantity;
use charts::{draw_strips, draw_trends};

/// Rows below which the strips, the trends of the parameters and the lines of the board are left out.
const STRIP_ROWS: u16 = 12;
const TREND_ROWS: u16 = 22;
const BOARD_ROWS: u16 = 16;
/// Columns below which there is no loop beside the strips.
const LOOP_COLUMNS: u16 = 60;

/// Draws the scene.
pub(super) fn draw(frame: &mut Frame, scene: &Scene, statistics: &Statistics) {
    let area = frame.area();
    let (width, height) = (area.width, area.height);
    let has_strips = height >= STRIP_ROWS;
    let has_trends = height >= TREND_ROWS;
    let board = board_lines(scene, statistics, height >= BOARD_ROWS);
    let numbers = match has_trends {
        true => 0,
        false => scene.trends.len().clamp(1, 7) as u16,
    };
    let rows = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(numbers),
        if has_strips {
            Constraint::Fill(3)
        } else {
            Constraint::Length(1)
        },
        if has_trends {
            Constraint::Fill(2)
        } else {
            Constraint::Length(0)
        },
        Constraint::Length(board.len().min(6) as u16),
        if has_trends {
            Constraint::Max(5)
        } else {
            Constraint::Fill(1)
        },
        Constraint::Length(1),
    ]);
    let [head, list, strips, trends, link, events, foot] = rows.areas(area);
    frame.render_widget(headline(scene), head);
    let estimate = scene.view.estimate;
    if let Some(estimate) = &estimate {
        frame.render_widget(Paragraph::new(number_lines(estimate)), list);
        match has_strips {
            true => draw_strips(frame, scene, strips, width >= LOOP_COLUMNS),
            false => frame.render_widget(force_and_depth(estimate), strips),
        }
    } else {
        frame.render_widget("no data yet", strips);
    }
    if has_trends {
        draw_trends(frame, scene, trends);
    }
    frame.render_widget(Paragraph::new(board), link);
    frame.render_widget(Paragraph::new(event_lines(scene, events.height)), events);
    frame.render_widget(keys(scene), foot);
}

/// Name, time, phase and status, and whether the picture stands or is recorded.
fn headline(scene: &Scene) -> Line<'static> {
    let mut spans = vec![
        Span::from(format!(" {} ", scene.name)).bold().reversed(),
        Span::from(format!(" {:.1} s  ", scene.time_s)),
    ];
    if let Some(estimate) = &scene.view.estimate {
        spans.push(Span::from(format!(
            "{}  ",
            phase(estimate.phase).trim_end()
        )));
        spans.push(status(estimate));
    }
    if let Some((since_s, folder)) = &scene.recording {
        let long_s = (scene.time_s - since_s).max(0.0);
        let text = format!("  ● {long_s:.0} s into {folder}");
        spans.push(Span::from(text).fg(Color::Red).bold());
    }
    for (is, text) in [(scene.is_paused, "  paused"), (scene.has_ended, "  ended")] {
        if is {
            spans.push(Span::from(text).fg(Color::Yellow).bold());
        }
    }
    Line::from(spans)
}

fn status(estimate: &Estimate<f32>) -> Span<'static> {
    let (sign, color) = match estimate.status {
        Status::Converged => ("✓", Color::Green),
        Status::ModelSuspect => ("✕", Color::Red),
        Status::Changed => ("!", Color::Magenta),
        Status::Converging => ("…", Color::Yellow),
        Status::NoContact | Status::Unobservable => ("–", Color::Gray),
    };
    let words = estimate.status.name().replace('_', " ");
    let why = estimate
        .reason
        .map(|reason| format!(" ({})", reason.name()));
    Span::from(format!("{sign} {words}{}", why.unwrap_or_default())).fg(color)
}

/// The parameters in numbers.
fn number_lines(estimate: &Estimate<f32>) -> Vec<Line<'static>> {
    let lines = parameters(estimate);
    lines
        .map(|(name, value)| Line::from(format!(" {name:<17} {value}")))
        .collect()
}

fn force_and_depth(estimate: &Estimate<f32>) -> Line<'static> {
    Line::from(format!(
        " force {}   depth {}",
        quantity(estimate.force_n.into(), 3, "N"),
        quantity(estimate.depth_m.into(), 3, "m")
    ))
}

/// The link, the board's time, and what else it says of itself.
fn board_lines(scene: &Scene, statistics: &Statistics, with_board: bool) -> Vec<Line<'static>> {
    let view = &scene.view;
    let mut lines = vec![Line::from(format!(
        " link   {:.0} Hz, {} lost, {} garbled, estimates {} ms old",
        view.rate_hz,
        statistics.lost,
        statistics.garbled,
        view.late_us / 1000
    ))];
    let teleoperation = view.teleoperation().into_iter().flatten();
    lines.extend(teleoperation.map(|said| Line::from(format!(" {said}"))));
    if let (Some(health), true) = (&view.health, with_board) {
        lines.extend(health_lines(health));
    }
    lines
}

fn health_lines(health: &Health) -> Vec<Line<'static>> {
    let Range { min, max, .. } = health.period;
    let mut lines = vec![
        Line::from(format!(
            " board  step {}…{}, task ≤ {}, response ≤ {}, period {min}…{max}",
            health.step.min, health.step.max, health.task.max, health.response.max
        )),
        Line::from(format!(
            "        {} late, {} missed, {} dropped, {} garbled, {} bytes of stack free",
            health.overruns, health.missed, health.dropped, health.garbled, health.stack_free
        )),
    ];
    let mut say = |text: String| lines.push(Line::from(format!("        {text}")));
    condition::lines(health).into_iter().for_each(&mut say);
    if health.clock_fallback {
        say("no crystal: times are off by up to 1 % at 25 °C, and 8 % beyond".into());
    }
    if let Some(key) = health.concerns {
        say(format!("saved {} cannot be used", key.info().name));
    }
    lines
}

/// Faults that stand, by name and by the setting that decides about them, then the last events.
fn event_lines(scene: &Scene, room: u16) -> Vec<Line<'static>> {
    let standing = scene.faults.iter().map(|fault| {
        let setting = Key::deciding(fault).map(|key| format!(" ({})", key.info().name));
        let text = format!(
            " fault {:>2}  {}{}",
            fault.code(),
            fault.describe(),
            setting.unwrap_or_default()
        );
        Line::from(text).fg(Color::Red)
    });
    let mut lines: Vec<Line> = standing.collect();
    let past = scene.events.iter().rev().map(|event| {
        let text = format!(" {:>8.2} s  {}", event.time_s, event.what);
        match event.is_fault {
            true => Line::from(text).fg(Color::Red),
            false => Line::from(text),
        }
    });
    lines.extend(past);
    lines.truncate(room.into());
    lines
}

fn keys(scene: &Scene) -> Line<'static> {
    let record = match scene.recording {
        Some(_) => "end recording",
        None => "record",
    };
    let pause = if scene.is_paused { "go on" } else { "pause" };
    let mut spans = Vec::new();
    for (key, what) in [("p", pause), ("m", "mark"), ("r", record), ("q", "quit")] {
        spans.push(Span::from(format!(" {key} ")).reversed());
        spans.push(Span::from(format!(" {what}  ")));
    }
    spans.push(Span::from(scene.said.clone()).fg(Color::Yellow));
    Line::from(spans)
}

#[cfg(test)]
mod tests;
