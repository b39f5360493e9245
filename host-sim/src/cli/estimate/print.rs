//! The estimate on the terminal.

use std::fmt::Write;
use std::path::Path;

use estimator_core::{Status, estimate::Estimated};

use super::methods::MethodChoice;
use super::show::wide;
use crate::estimate::{Compared, Estimation, Reason, explain::times, meaning};
use crate::log::UniformLog;
use crate::number::{Measured, counted, quantity};
use crate::replay::{EventMark, fault_tallies};
use crate::wrap::wrapped;

/// A dozen lines: the log, the parameters, the fit, the notes.
pub(super) fn summary(path: &Path, log: &UniformLog, estimation: &Estimation) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_summary(&mut text, path, log, estimation);
    text
}

/// The first line: which log, how long, how often touched.
pub(crate) fn headline(path: &Path, log: &UniformLog, touches: usize) -> String {
    let seconds = log.len() as f64 * log.period_s();
    format!(
        "{}: {seconds:.2} s at {} Hz, {}\n",
        path.display(),
        (log.rate_hz * 1e3).round() / 1e3,
        counted(touches, "touch")
    )
}

fn write_summary(
    text: &mut String,
    path: &Path,
    log: &UniformLog,
    estimation: &Estimation,
) -> std::fmt::Result {
    let outcome = &estimation.outcome;
    let method = MethodChoice::of(estimation.replay.config.method).name();
    text.push_str(&headline(path, log, outcome.touches.len()));
    let why = outcome
        .reason
        .map_or(String::new(), |why| format!(" ({})", why.name()));
    write!(
        text,
        "{} ({method}): {}{why}",
        outcome.law.name(),
        outcome.status.name()
    )?;
    match outcome.settled_at_s {
        Some(after) => writeln!(
            text,
            ", settled within 5 % {} after first contact",
            quantity(after, 3, "s")
        )?,
        None if outcome.touches.is_empty() => writeln!(text)?,
        None => writeln!(text, ", not settled within 5 %")?,
    }
    write_reason(text, outcome.status, outcome.reason)?;
    let named = outcome.named(&outcome.parameters);
    let rows: Vec<Row> = named
        .map(|(info, estimate)| (info.name, info.unit.symbol(), estimate.map(wide)))
        .collect();
    write_parameters(text, &rows)?;
    write_residual(text, outcome.force_rmse_n, estimation.replay.noise_n)?;
    write_events(text, &outcome.events)?;
    let compared = estimation
        .selection
        .iter()
        .any(|own| own.force_rmse_n.is_some());
    if compared && estimation.selection.len() > 1 {
        writeln!(text, "{}", wrapped("", &tried(&estimation.selection)))?;
    }
    for note in &estimation.notes {
        writeln!(text, "{}", wrapped("note: ", note))?;
    }
    Ok(())
}

/// What the reason behind a status means, and what to do; nothing where there is none.
pub(super) fn write_reason(
    text: &mut String,
    status: Status,
    reason: Option<Reason>,
) -> std::fmt::Result {
    let Some(reason) = reason else { return Ok(()) };
    let lead = format!("  {}: ", reason.name());
    writeln!(text, "{}", wrapped(&lead, &meaning(status, reason)))
}

/// A parameter as it is printed: name, unit, estimate.
pub(super) type Row = (&'static str, &'static str, Option<Estimated<f64>>);

pub(super) fn write_parameters(text: &mut String, rows: &[Row]) -> std::fmt::Result {
    let longest = rows.iter().map(|(name, ..)| name.len());
    let width = longest.max().unwrap_or(0).max(10);
    for (name, unit, estimate) in rows {
        match estimate {
            Some(own) => {
                let measured = Measured::new(own.value, Some(own.std_error), unit);
                writeln!(text, "  {name:<width$} {measured}")?;
            }
            None => writeln!(text, "  {name:<width$} not observable")?,
        }
    }
    Ok(())
}

/// What a law leaves of a force with a noise (N rms); nothing where that is not known.
pub(super) fn write_residual(
    text: &mut String,
    rmse_n: Option<f64>,
    noise_n: f64,
) -> std::fmt::Result {
    let Some(rmse_n) = rmse_n else { return Ok(()) };
    writeln!(
        text,
        "residual in contact {} rms, {} the noise of {}",
        quantity(rmse_n, 3, "N"),
        times(rmse_n / noise_n),
        quantity(noise_n, 3, "N")
    )
}

/// What happened meanwhile: faults of the sensors, and other materials.
pub(crate) fn write_events(text: &mut String, events: &[EventMark]) -> std::fmt::Result {
    if let Some(faults) = faults_in_words(events) {
        writeln!(text, "{}", wrapped("faults: ", &faults))?;
    }
    let changes = events.iter().filter(|event| event.is_material_change());
    let changes: Vec<String> = changes
        .map(|event| quantity(event.time_s, 4, "s"))
        .collect();
    if !changes.is_empty() {
        let at = changes.join(", ");
        writeln!(
            text,
            "{}",
            wrapped(
                "changes: ",
                &format!(
                    "another material at {at}: the report and `segments` have the parameters of each"
                )
            )
        )?;
    }
    Ok(())
}

/// The faults among events, each with how often and when; `None` without one.
pub(crate) fn faults_in_words<'a>(
    events: impl IntoIterator<Item = &'a EventMark>,
) -> Option<String> {
    let each = fault_tallies(events).into_iter().map(|tally| {
        let (first_s, last_s) = tally.between_s;
        let [first, last] = [first_s, last_s].map(|at_s| quantity(at_s, 4, "s"));
        let when = match tally.count {
            1 => format!("at {first}"),
            count => format!("{count} times, {first} to {last}"),
        };
        format!("{} ({when})", tally.description)
    });
    let all: Vec<String> = each.collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The laws that were compared, and what each leaves; of a law with several methods the best of them.
fn tried(selection: &[Compared]) -> String {
    let mut best: Vec<(&'static str, Option<f64>)> = Vec::new();
    for Compared {
        law,
        force_rmse_n: rmse,
        ..
    } in selection
    {
        match best.iter_mut().find(|(own, _)| own == law) {
            None => best.push((law, *rmse)),
            Some((_, Some(least))) => *least = least.min(rmse.unwrap_or(f64::INFINITY)),
            Some((_, none)) => *none = *rmse,
        }
    }
    let laws = best.iter().map(|(law, rmse)| match rmse {
        Some(rmse) => format!("{law} leaves {}", quantity(*rmse, 3, "N")),
        None => format!("{law} cannot be determined"),
    });
    format!("laws tried: {}", laws.collect::<Vec<_>>().join("; "))
}
