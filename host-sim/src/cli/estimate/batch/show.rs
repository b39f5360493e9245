//! A batch fit as the report wants it.

use std::io;
use std::path::Path;

use super::print::name;
use crate::batch::{Batch, ModulusKind, Parameter};
use crate::cli::estimate::show::tone;
use crate::estimate::{explain::multiple, trust_in_words};
use crate::log::UniformLog;
use crate::model::law_title;
use crate::number::fixed;
use crate::report::{
    Cell, Document, Input, Provenance, Section, Table, called, estimate as report,
};

/// Of touches, so many rows are shown.
const MOST_ROWS: usize = 14;

/// The report; `path` is the log that it was made from.
///
/// # Errors
/// If the log cannot be read again for its hash.
pub(super) fn document(log: &UniformLog, batch: &Batch, path: &Path) -> io::Result<Document> {
    let finals = finals(&batch.parameters);
    let estimated: &[f64] = &batch.columns.estimated_n;
    let (depth_m, estimated_n) = (&batch.elastic.0, &batch.elastic.1);
    let run = report::Run {
        name: "",
        law: batch.family.name(),
        time_s: (&log.time_s).into(),
        depth_m: (&batch.columns.depth_m).into(),
        speed_mps: (&batch.columns.speed_mps).into(),
        measured_n: (&batch.columns.measured_n).into(),
        estimated_n: estimated.into(),
        noise_n: Some(batch.noise_n),
        finals,
        touches: (&batch.touches).into(),
        events: (&batch.events).into(),
        elastic: (!depth_m.is_empty()).then_some(report::Elastic {
            depth_m: depth_m.into(),
            estimated_n: estimated_n.into(),
            true_n: Default::default(),
        }),
        force_rmse_n: batch.force_rmse_n,
        reference_depth_m: Some(batch.reference_depth_m),
        ..report::Run::default()
    };
    let title = format!("Estimate of {}", called(path));
    let badge = batch.status.name().replace('_', " ");
    let verdict = verdict(batch);
    let provenance = Provenance::of_this_process();
    let document = report::EstimateReport {
        title: &title,
        tone: tone(batch.status),
        badge: &badge,
        verdict: &verdict,
        runs: &[run],
        notes: &batch.notes,
        provenance: provenance.input(Input::of_file(path)?),
    }
    .document();
    Ok(sections(batch)
        .into_iter()
        .fold(document, Document::section))
}

fn finals(parameters: &[Parameter]) -> Vec<report::FinalParameter<'_>> {
    let all = parameters.iter();
    all.map(|parameter| report::FinalParameter {
        name: parameter.name,
        unit: parameter.unit,
        estimate: parameter.estimate,
        truth: None,
    })
    .collect()
}

/// One sentence: what was found and whether to trust it.
fn verdict(batch: &Batch) -> String {
    let Some(rmse) = batch.force_rmse_n else {
        return "Nothing was touched.".into();
    };
    let law = law_title(batch.family.name());
    let misfit = rmse / batch.noise_n;
    let trust = trust_in_words(batch.status, batch.reason, misfit);
    let multiple = multiple(misfit);
    format!("{law} {trust}; in contact the residual is {multiple} the noise.")
}

/// What the recursive methods do not have.
fn sections(batch: &Batch) -> Vec<Section> {
    let tables = [modulus(batch), per_touch(batch), selection(batch)];
    let mut section = Section::new("The fit of the whole log");
    let mut some = false;
    for table in tables.into_iter().flatten() {
        section = section.table(table);
        some = true;
    }
    some.then_some(section).into_iter().collect()
}

fn modulus(batch: &Batch) -> Option<Table> {
    let modulus = batch.modulus.as_ref()?;
    let value = match modulus.value {
        Some(value) => Cell::measured(value.value, Some(value.std_error), "Pa"),
        None => Cell::Missing("not determined".into()),
    };
    let kind = match modulus.kind {
        ModulusKind::Instantaneous => "At once",
        ModulusKind::Relaxed => "At rest",
    };
    let mut table = Table::new(["Young's modulus", "Value"])
        .row([Cell::from(kind), value])
        .caption(format!(
            "Indenter {}, Poisson's ratio {}, exponent {}",
            modulus.indenter, modulus.poisson, modulus.exponent_assumed
        ));
    if let Some(relaxed) = modulus.relaxed_pa {
        table = table.row([Cell::from("Relaxed"), Cell::quantity(relaxed, 3, "Pa")]);
    }
    Some(table)
}

fn cell(parameter: &Parameter) -> Cell {
    match parameter.estimate {
        Some(estimate) => Cell::measured(estimate.value, Some(estimate.std_error), parameter.unit),
        None => Cell::Missing("not observable".into()),
    }
}

fn per_touch(batch: &Batch) -> Option<Table> {
    let first = batch.per_touch.first()?;
    let names = first.parameters.iter().map(|parameter| {
        let mut name = parameter.name.replace('_', " ");
        name[..1].make_ascii_uppercase();
        name
    });
    let table = Table::new(
        ["From [s]".to_string(), "To [s]".to_string()]
            .into_iter()
            .chain(names),
    )
    .column("Error of block means, rms")
    .caption("Each touch by itself, with the surface and the relaxation of the whole log")
    .at_most(MOST_ROWS);
    let rows = batch.per_touch.iter().map(|touch| {
        let ends = [touch.from_s, touch.to_s].map(|at| Cell::Number(fixed(at, -3)));
        let error = Cell::quantity(touch.block_rmse_n, 3, "N");
        let cells = ends.into_iter().chain(touch.parameters.iter().map(cell));
        cells.chain([error]).collect::<Vec<_>>()
    });
    Some(table.rows(rows))
}

fn selection(batch: &Batch) -> Option<Table> {
    let table = Table::new(["Law", "Free numbers", "Force error, rms", "BIC − best"])
        .caption("The laws that were compared; the smallest BIC is taken");
    let rows = batch.selection.iter().map(|tried| {
        [
            Cell::from(name(tried).replace('_', " ")),
            Cell::count(tried.parameters),
            Cell::quantity(tried.force_rmse_n, 3, "N"),
            Cell::Number(fixed(tried.score, -1)),
        ]
    });
    (batch.selection.len() > 1).then(|| table.rows(rows))
}
