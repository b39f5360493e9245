//! Common failure modes, with pictures.

use super::Ignored;
use super::text::{percent, settings, taken_off};
use crate::kind;
use crate::number::quantity;
use crate::report::plot::{Axis, Chart, Ink, Series, Size, Stroke};
use crate::report::{Cell, Document, Figure, Provenance, Section, Table, Tone};

/// The strokes at 1 Hz of the built-in palpation (s): the approach is over, the fast ones not begun.
const STROKES_S: std::ops::Range<f64> = 1.0..3.9;

/// A residual of this many times the noise is one that a reader of a report sees.
const SEEN: f64 = 1.5;

/// The page.
pub(super) fn document(shown: &[Ignored], provenance: Provenance) -> Document {
    let quiet = shown
        .iter()
        .filter(|own| own.misfit.is_some_and(|misfit| misfit < SEEN));
    let quiet: Vec<&str> = quiet.map(|own| own.id.name()).collect();
    let sentence = match shown {
        [one] => format!("{}: {}.", one.id.name(), one.id.info().signature),
        _ if quiet.is_empty() => {
            format!("All {} effects leave a trace in the residual.", shown.len())
        }
        _ => format!(
            "Of {} effects, all but these leave a trace in the residual of a fit that does not know of \
             them: {}.",
            shown.len(),
            quiet.join(", ")
        ),
    };
    let title = "Common failure modes of a palpation";
    let mut document = Document::new(title).verdict(Tone::Neutral, "catalogue", sentence);
    document = document.section(overview(shown));
    for own in shown {
        document = document.section(kind::worded(own.touched.kind, || section(own)));
    }
    document.provenance(provenance)
}

fn overview(shown: &[Ignored]) -> Section {
    let columns = ["Effect", "Stiffness", "Damping", "Exponent", "Residual"];
    let rows = shown.iter().map(|own| {
        let bias = |name| match own.bias(name) {
            Some(share) => Cell::Number(percent(share)),
            None => Cell::Missing("–".into()),
        };
        let misfit = own.misfit.map_or(Cell::Missing("–".into()), times);
        [
            own.id.name().into(),
            bias("stiffness"),
            bias("damping"),
            bias("exponent"),
            misfit,
        ]
    });
    let table = Table::new(columns).rows(rows).caption(
        "Error of each parameter when the effect is ignored, and what is left of the force in contact, in \
         multiples of its noise. About 1: the parameters have taken the effect up, and nothing shows it.",
    );
    Section::new("Ignored").text(
        "The simulated rig palpates the gel of the chapter (K 1350 N/m, λ 36 N s/m, n 1.35; a linear contact \
         where an effect belongs to one, a torsion spring where a machine turns) for 8.6 s with one hidden effect; load cell 20 mN, encoder 1 µm, 1 kHz. \
         The law without the effect is fitted to the whole log, with a constant force and, for \
         Hunt–Crossley, a time skew beside it: an offset and a delay end up there, and not in the law.",
    ).table(table)
}

/// 3.2 ×
fn times(misfit: f64) -> Cell {
    Cell::Number(format!("{} ×", quantity(misfit, 3, "1").trim_end()))
}

fn section(own: &Ignored) -> Section {
    let info = own.id.info();
    let facts = [
        format!("Law: {} (in the {})", info.law, info.stage.name()),
        format!("Shows as: {}", info.signature),
        format!("Shown by: {}", info.motion),
        format!(
            "Here: {}, in a palpation of {}",
            settings(own),
            own.touched.name
        ),
        format!("Compensated: {}", taken_off(own.id)),
    ];
    Section::new(own.id.name())
        .list(facts)
        .table(parameters(own))
        .figure(hysteresis(own))
        .figure(over_depth(own))
        .figure(over_time(own))
}

fn parameters(own: &Ignored) -> Table {
    let rows = own.base.iter().map(|(name, unit, truth, found)| {
        let found_cell = match found {
            Some(found) => Cell::measured(found.value, Some(found.std_error), unit),
            None => Cell::Missing("not observable".into()),
        };
        let off = own.bias(name).map_or(Cell::Text(String::new()), |share| {
            Cell::Number(percent(share))
        });
        [
            (*name).into(),
            Cell::measured(*truth, None, unit),
            found_cell,
            off,
        ]
    });
    let law = own.family.name();
    let left = own.misfit.map_or(String::new(), |misfit| {
        format!(
            " The residual is {} × the noise.",
            quantity(misfit, 3, "1").trim_end()
        )
    });
    Table::new(["Parameter", "True", "Fitted", "Off"])
        .rows(rows)
        .caption(format!("{law} without {}.{left}", own.id.name()))
}

fn hysteresis(own: &Ignored) -> Figure {
    let part = |values: &[f64], log: &crate::log::UniformLog| -> Vec<f64> {
        let timed = log.time_s.iter().zip(values);
        let within = timed.filter(|(time, _)| STROKES_S.contains(*time));
        within.map(|(_, value)| *value).collect()
    };
    let x = Axis::new("Position read", "m");
    let (with, without) = (&own.with, &own.without);
    let chart = Chart::new(x, Axis::new("Force read", "N").with_zero())
        .series(Series::new(
            "without",
            Ink::Measured,
            Stroke::Dashed,
            part(&without.position_m, without),
            part(&without.force_n, without),
        ))
        .series(Series::new(
            "with the effect",
            Ink::First,
            Stroke::Solid,
            part(&with.position_m, with),
            part(&with.force_n, with),
        ));
    Figure::new("Hysteresis loop", &chart).caption("Three strokes at 1 Hz, through free air.")
}

fn over_depth(own: &Ignored) -> Figure {
    let points = own.depth_m.iter().zip(&own.residual_n).zip(&own.in_contact);
    // A third of 9000 points shows the same cloud.
    let (depth_m, residual_n): (Vec<f64>, Vec<f64>) = points
        .filter(|(_, contact)| **contact)
        .map(|((depth, residual), _)| (*depth, *residual))
        .step_by(3)
        .unzip();
    let axis = Axis::new("Residual", "N").with_zero();
    let chart = Chart::new(Axis::new("Depth δ", "m"), axis).series(Series::new(
        "",
        Ink::Second,
        Stroke::Dots,
        depth_m,
        residual_n,
    ));
    Figure::new("Residual over depth", &chart)
        .caption("Measured less fitted force after the best fit without the effect.")
}

fn over_time(own: &Ignored) -> Figure {
    let axis = Axis::new("Residual", "N").with_zero();
    let touches = touches(own);
    let chart = Chart::new(Axis::time(), axis)
        .size(Size::Slim)
        .touches(touches)
        .series(Series::new(
            "",
            Ink::Second,
            Stroke::Thin,
            own.with.time_s.as_slice(),
            own.residual_n.as_slice(),
        ));
    Figure::new("Residual over time", &chart)
        .caption("The same over time; shaded: in contact. In free air it is the force less its constant part.")
}

/// Stretches in contact (s).
fn touches(own: &Ignored) -> Vec<(f64, f64)> {
    let mut from = 0;
    let runs = own.in_contact.chunk_by(|a, b| a == b).map(|run| {
        let range = from..from + run.len();
        from = range.end;
        (run[0], range)
    });
    let time = &own.with.time_s;
    runs.filter(|(contact, _)| *contact)
        .map(|(_, range)| (time[range.start], time[range.end - 1]))
        .collect()
}
