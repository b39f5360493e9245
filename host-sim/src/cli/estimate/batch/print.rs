//! A batch fit on the terminal.

use std::fmt::Write;
use std::path::Path;

use estimator_core::physics::law::Recovery;

use crate::batch::{Batch, Form, Modulus, Tried};
use crate::cli::estimate::print::{
    Row, headline, write_events, write_parameters, write_reason, write_residual,
};
use crate::log::UniformLog;
use crate::number::{Measured, counted, quantity};
use crate::wrap::wrapped;

/// A dozen lines: the log, the parameters, the fit, the laws, the notes.
pub(crate) fn summary(path: &Path, log: &UniformLog, batch: &Batch) -> String {
    let mut text = String::new();
    // Writing into a String cannot fail.
    let _ = write_summary(&mut text, path, log, batch);
    text
}

fn write_summary(
    text: &mut String,
    path: &Path,
    log: &UniformLog,
    batch: &Batch,
) -> std::fmt::Result {
    text.push_str(&headline(path, log, batch.touches.len()));
    let why = batch
        .reason
        .map_or(String::new(), |why| format!(" ({})", why.name()));
    writeln!(
        text,
        "{} (batch): {}{why}",
        batch.family.name(),
        batch.status.name()
    )?;
    write_reason(text, batch.status, batch.reason)?;
    let rows = batch.parameters.iter();
    let rows: Vec<Row> = rows.map(|own| (own.name, own.unit, own.estimate)).collect();
    write_parameters(text, &rows)?;
    if let Some(modulus) = &batch.modulus {
        writeln!(text, "{}", young(modulus))?;
    }
    write_residual(text, batch.force_rmse_n, batch.noise_n)?;
    write_events(text, &batch.events)?;
    if batch.selection.len() > 1 {
        writeln!(text, "{}", wrapped("", &tried(&batch.selection)))?;
    }
    for note in &batch.notes {
        writeln!(text, "{}", wrapped("note: ", note))?;
    }
    Ok(())
}

/// Young's modulus, with which it is and whether it holds.
fn young(modulus: &Modulus) -> String {
    let value = match modulus.value {
        Some(value) => Measured::new(value.value, Some(value.std_error), "Pa").to_string(),
        None => "not determined".into(),
    };
    let holds = match modulus.why.is_empty() {
        true => "",
        false => ", not valid here",
    };
    format!(
        "Young's modulus, {}: {value}{holds} ({}, Poisson's ratio {})",
        modulus.kind.name(),
        modulus.indenter,
        modulus.poisson
    )
}

/// A law's name, with its form and the number of its modes if it has a choice.
pub(super) fn name(tried: &Tried) -> String {
    let form = match tried.family.elastic {
        Form::Power => "",
        Form::Exponential => "exponential ",
    };
    let name = match tried.family.listed_modes() {
        0 => tried.family.name().into(),
        modes => format!(
            "{form}{} with {}",
            tried.family.name(),
            counted(modes, "mode")
        ),
    };
    match tried.family.recovery {
        Recovery::WithProbe => name,
        Recovery::ByCreep => format!("{name}, recovering by creep"),
    }
}

/// The laws that were compared, and what each leaves.
fn tried(selection: &[Tried]) -> String {
    let laws = selection.iter().map(|tried| {
        format!(
            "{} leaves {}",
            name(tried),
            quantity(tried.force_rmse_n, 3, "N")
        )
    });
    format!("laws tried: {}", laws.collect::<Vec<_>>().join("; "))
}
