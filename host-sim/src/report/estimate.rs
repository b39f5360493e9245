//! The report of `palpate estimate`: what the touches of a log say about the material.
//!
//! [`EstimateReport`] borrows what the replay of a log has recorded; [`EstimateReport::document`]
//! makes tables and the figures that readers of the chapter know: hysteresis loop, power exchange,
//! parameters over time, force and displacement over time, elastic response, β. Several runs stand
//! side by side.

mod course;
mod figures;
mod forgetting;
mod loops;
mod parameters;
mod run;
mod tables;
mod window;

pub(crate) use run::label;
pub use run::{
    Column, Elastic, EstimateReport, FinalParameter, ForgettingLaw, Run, Segment, Trajectory,
};

use super::{Document, Section};

impl EstimateReport<'_> {
    /// The report.
    pub fn document(&self) -> Document {
        let mut document = Document::new(self.title)
            .verdict(self.tone, self.badge, self.verdict)
            .section(tables::result(self));
        let notes = tables::notes(self);
        if !notes.is_empty() {
            document = document.section(notes);
        }
        for section in self.figures() {
            document = document.section(section);
        }
        document.provenance(self.provenance.clone())
    }

    /// One section per kind of figure, so that the runs stand side by side.
    fn figures(&self) -> Vec<Section> {
        let kinds: [(&str, &str, figures::Kind); 5] = [
            ("Force and depth", loops::HOW_TO_READ, loops::figures),
            (
                "Parameters over time",
                parameters::HOW_TO_READ,
                parameters::figures,
            ),
            (
                "Force and displacement over time",
                course::HOW_TO_READ,
                course::forces,
            ),
            ("Residual", "", course::residual),
            (
                "Forgetting factor β",
                forgetting::EQUATION,
                forgetting::figures,
            ),
        ];
        let layout = figures::Layout::new(self.runs.len());
        kinds
            .into_iter()
            .filter_map(|(heading, text, kind)| {
                let figures = self.runs.iter().map(|run| kind(run, &layout));
                let figures = interleave(figures.collect());
                let section = Section::new(heading).text(text);
                (!figures.is_empty()).then(|| figures.into_iter().fold(section, Section::figure))
            })
            .collect()
    }
}

/// The first figures of all runs, then the second ones, and so on: figures of one kind stand beside each
/// other.
fn interleave<T>(runs: Vec<Vec<T>>) -> Vec<T> {
    let mut runs: Vec<_> = runs.into_iter().map(Vec::into_iter).collect();
    let mut out = Vec::new();
    loop {
        let before = out.len();
        out.extend(runs.iter_mut().filter_map(Iterator::next));
        if out.len() == before {
            return out;
        }
    }
}

#[cfg(test)]
mod tests;
