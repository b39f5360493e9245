//! The report of `palpate teleop`: what the operator felt of the material, and what the schemes make of
//! delay and loss.

mod figures;
mod map;
mod run;
mod tables;
mod words;

pub use words::rest;

pub use run::TeleopReport;

use super::{Document, Provenance, Section, Tone, capitalised};
use crate::number::setting;
use crate::teleop::measure::felt::NotCompared;
use crate::teleop::measure::stability::Rest;
use crate::teleop::{Cell, Measures, Options, SchemeId};

/// The felt force is right below this share, and wrong above the other.
const RIGHT: f64 = 0.05;
const WRONG: f64 = 0.15;

impl TeleopReport<'_> {
    /// The report.
    pub fn document(&self) -> Document {
        let (tone, badge, sentence) = verdict(self.options, self.measures);
        let over_time = figures::over_time(self)
            .into_iter()
            .fold(Section::new("Over time"), Section::figure);
        let by_depth = figures::by_depth(self)
            .into_iter()
            .fold(Section::new("Felt against true force"), Section::figure);
        let parameters = figures::parameters(self)
            .into_iter()
            .fold(Section::new("Parameters on both sides"), Section::figure);
        let frequency = Section::new("Transparency over frequency");
        let frequency = match self.transparency {
            [] => frequency,
            lines => frequency.figure(figures::transparency(lines)),
        };
        let maps = map::maps(self.map).into_iter().fold(
            Section::new("Schemes over delay and loss"),
            Section::heat_map,
        );
        let document = Document::new(title(self.options)).verdict(tone, badge, sentence);
        [
            tables::summary(self),
            tables::noticed(self),
            by_depth,
            over_time,
            frequency,
            parameters,
            maps,
        ]
        .into_iter()
        .filter(|section| !section.is_empty())
        .fold(document, Document::section)
        .provenance(self.provenance.clone())
    }
}

/// The report of a comparison.
pub fn comparison(cells: &[Cell], provenance: Provenance) -> Document {
    let stable = |id: SchemeId| {
        let own = || cells.iter().filter(|cell| cell.scheme == id);
        (own().filter(|cell| cell.is_stable()).count(), own().count())
    };
    let (rests, all) = stable(SchemeId::Reflection);
    let sentence = format!(
        "Impedance reflection comes to rest in {rests} of {all} cells, position–force in {} of {}.",
        stable(SchemeId::PositionForce).0,
        stable(SchemeId::PositionForce).1,
    );
    let document = Document::new("Teleoperation: schemes side by side").verdict(
        Tone::Neutral,
        "compared",
        sentence,
    );
    let sections = map::sections(cells);
    sections
        .into_iter()
        .fold(document, Document::section)
        .provenance(provenance)
}

fn title(options: &Options) -> String {
    let [there, back] = options.channels;
    format!(
        "Teleoperation: {} on {}, {} round trip",
        words::words(options.scheme),
        options.environment.first.name,
        setting(there.delay_s + back.delay_s, "s"),
    )
}

/// How good the run is, in a word and in a sentence.
pub fn verdict(options: &Options, measures: &Measures) -> (Tone, &'static str, String) {
    let felt = match measures.felt_force_rmse_share {
        Some(share) => format!(
            "The felt force is {:.1} % of its peak off the true one",
            100.0 * share
        ),
        None => measures
            .felt_force_not_compared
            .map_or("", NotCompared::sentence)
            .into(),
    };
    let shaped = match options.shaping()[0] {
        1.0 => String::new(),
        gain => format!(", which is shaped by {gain:.2} on purpose"),
    };
    let rest = words::rest(options, measures);
    let sentence = || format!("{}. {felt}{shaped}.", capitalised(&rest));
    match measures.rests() {
        Rest::Moves => return (Tone::Bad, "unstable", sentence()),
        Rest::CannotTell => return (Tone::Warning, "rest not known", sentence()),
        Rest::Rests => {}
    }
    let (tone, badge) = match measures.felt_force_rmse_share {
        Some(share) if share <= RIGHT => (Tone::Good, "transparent"),
        Some(share) if share <= WRONG => (Tone::Warning, "stable"),
        _ => (Tone::Bad, "not transparent"),
    };
    (tone, badge, format!("{felt}{shaped}; {rest}."))
}

#[cfg(test)]
mod tests;
