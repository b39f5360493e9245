//! The report of `palpate gap`: the missing effects, where they show, and what remains unexplained with
//! them.
//!
//! [`GapReport`] borrows a [`Finding`]. [`GapReport::document`] says the verdict first, and then shows the
//! evidence: tables of regions, effects and parameters, and for every log the residuals over time, depth,
//! speed and frequency, before and after the effects were added.

mod bins;
mod figures;
mod map;
mod next;
mod regions;
mod spectrum;
mod tables;
mod verdict;

use super::estimate::label;
use super::{Document, Provenance, Section};
use crate::gap::Finding;
use bins::LogCurves;

/// The most logs that are drawn. The tables hold for all logs.
const MOST_LOGS: usize = 4;

/// What the report is made of.
#[derive(Clone, Debug)]
pub struct GapReport<'a> {
    /// The heading: what was compared with what.
    pub title: &'a str,
    /// What was found.
    pub finding: &'a Finding,
    /// Names of the logs, in the order of [`Finding::curves`].
    pub names: &'a [String],
    /// What the report was made from.
    pub provenance: Provenance,
}

impl GapReport<'_> {
    /// The finding as a part of another report: the verdict, the numbers beside the true ones, which a simulated rig
    /// knows by name, and the residual before and after.
    pub fn short(&self, heading: &str, truths: &[(&str, f64)]) -> Section {
        let finding = self.finding;
        let section = Section::new(heading)
            .text(verdict::sentence(finding))
            .table(tables::against(finding, truths));
        let Some(log) = LogCurves::of(finding, 0) else {
            return section;
        };
        let residuals = figures::residuals_over_time(&log).into_iter().take(1);
        let by = figures::by_depth_and_speed(&log).into_iter().take(2);
        residuals.chain(by).fold(section, Section::figure)
    }

    /// The report.
    pub fn document(&self) -> Document {
        let finding = self.finding;
        let (tone, badge) = verdict::badge(finding);
        let sections = [
            tables::summary(finding),
            next::motion(finding),
            tables::effects(finding),
            regions::place(finding),
            tables::base(finding),
        ];
        let document = Document::new(self.title).verdict(tone, badge, verdict::sentence(finding));
        let logs = (0..MOST_LOGS).filter_map(|at| Some((at, LogCurves::of(finding, at)?)));
        let logs = logs.flat_map(|(at, log)| {
            let name = match finding.curves.len() {
                1 => "",
                _ => self.names.get(at).map_or("", String::as_str),
            };
            self.log(name, &log)
        });
        sections
            .into_iter()
            .chain(logs)
            .chain([tables::ladder(finding), tables::floors(finding, self.names)])
            .filter(|section| !section.is_empty())
            .fold(document, Document::section)
            .provenance(self.provenance.clone())
    }

    fn log(&self, name: &str, log: &LogCurves<'_>) -> [Section; 2] {
        let heading = |what: &str| match name {
            "" => what.to_string(),
            name => format!("{what}: {name}"),
        };
        let mut over_time = figures::residuals_over_time(log)
            .into_iter()
            .chain([figures::force_over_time(log)])
            .fold(Section::new(heading("Over time")), Section::figure);
        if self.finding.curves.len() > MOST_LOGS && !name.is_empty() {
            over_time = over_time.text(format!(
                "The first {MOST_LOGS} of {} logs are drawn; gap_N.csv has the curves of all.",
                self.finding.curves.len()
            ));
        }
        let mut by = Section::new(heading(&format!(
            "By {}, speed and frequency",
            log.place().name
        )));
        for map in map::maps(log) {
            by = by.heat_map(map);
        }
        let spectrum = spectrum::figure(log, self.finding);
        by = figures::by_depth_and_speed(log)
            .into_iter()
            .chain([spectrum])
            .fold(by, Section::figure);
        [over_time, by]
    }
}

#[cfg(test)]
mod tests;
