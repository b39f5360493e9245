//! The estimate on the terminal.

use std::fmt::Write;
use std::path::Path;

use super::methods::MethodChoice;
use crate::estimate::{Compared, Estimation, Outcome, explain::times};
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
    write_parameters(text, outcome)?;
    if let Some(rmse) = outcome.force_rmse_n {
        let noise = estimation.replay.noise_n;
        writeln!(
            text,
            "residual in contact {} rms, {} the noise of {}",
            quantity(rmse, 3, "N"),
            times(rmse / noise),
            quantity(noise, 3, "N")
        )?;
    }
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

fn write_parameters(text: &mut String, outcome: &Outcome) -> std::fmt::Result {
    let names = outcome
        .named(&outcome.parameters)
        .map(|(info, _)| info.name.len());
    let width = names.max().unwrap_or(0).max(10);
    for (info, estimate) in outcome.named(&outcome.parameters) {
        match estimate {
            Some(e) => {
                let error = Some(f64::from(e.std_error));
                let measured = Measured::new(f64::from(e.value), error, info.unit.symbol());
                writeln!(text, "  {:<width$} {measured}", info.name)?;
            }
            None => writeln!(text, "  {:<width$} not observable", info.name)?,
        }
    }
    Ok(())
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
pub(crate) fn faults_in_words(events: &[EventMark]) -> Option<String> {
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
