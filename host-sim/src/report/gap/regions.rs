//! The regions in which the base model and the log disagree, and those that remain with the effects.

use crate::gap::{Finding, Pattern, Region, Verdict};
use crate::number::{column, fixed, quantity, spaced};
use crate::phase::PHASES;
use crate::report::{Cell, Section, Table};

/// The section on where the models and the log disagree.
pub(super) fn place(finding: &Finding) -> Section {
    let section = Section::new("Where the base model and the measurement disagree");
    if finding.disagreement.is_empty() {
        return section.text(
            "In no phase, at no depth, speed, time or frequency are the residuals significantly larger than \
             noise and the errors of the motion allow (false discoveries below 1 %).",
        );
    }
    let section = match (
        finding.verdict,
        finding.effects.is_empty(),
        finding.remaining.is_empty(),
    ) {
        (Verdict::NoMissingEffect, ..) => {
            section.text("All of it lies within the uncertainty of the noise floor itself.")
        }
        (_, true, _) => section,
        (_, _, true) if finding.slow_remainder.is_some() => {
            section.text("What remains with the effects stands out in no part more than in others.")
        }
        (_, _, true) => section.text("With the effects, nothing significant remains anywhere."),
        _ => section.text(spaced(&format!(
            "With the effects {} of the excess remains.",
            remaining_share(finding)
        ))),
    };
    section.table(table(finding))
}

/// The share of the excess on held-out parts that remains.
fn remaining_share(finding: &Finding) -> String {
    let excess = |ratio: f64| (ratio * ratio - 1.0).max(0.0);
    let share = 100.0 * excess(finding.ratio_after) / excess(finding.ratio_before);
    match share {
        share if share >= 9.5 => format!("{share:.0} %"),
        share if share >= 0.1 => format!("{share:.1} %"),
        _ => "less than 0.1 %".into(),
    }
}

/// The order of the rows after the phases of the contact or the ways: depth or place, speed, time, patterns.
const AFTER_PHASES: [&str; 14] = [
    "depth_low",
    "depth_mid",
    "depth_high",
    "travel_low",
    "travel_mid",
    "travel_high",
    "slow",
    "fast",
    "early",
    "late",
    "line",
    "pitch",
    "step",
    "surface_step",
];

/// A table of every region in which either model and the log disagree.
fn table(finding: &Finding) -> Table {
    let only_base = finding.effects.is_empty();
    let (before, after) = (&finding.disagreement, &finding.remaining);
    let of = |regions: &[Region], id: &str, at: usize| {
        let mut own = regions.iter().filter(|region| region.id == id);
        own.nth(at).cloned()
    };
    // A zero may step several times.
    let count = before.len().max(after.len());
    let ids = PHASES.iter().chain(&AFTER_PHASES);
    let mut rows: Vec<(Option<Region>, Option<Region>)> = ids
        .flat_map(|id| (0..count).map(move |at| (id, at)))
        .map(|(id, at)| (of(before, id, at), of(after, id, at).filter(|_| !only_base)))
        .collect();
    rows.retain(|(before, after)| before.is_some() || after.is_some());
    let all = rows
        .iter()
        .flat_map(|(before, after)| [before, after])
        .flatten();
    let rms_n: Vec<f64> = all.map(|region| region.rms_n).collect();
    let (unit, errors) = column(&rms_n, 3, "N");
    let mut errors = errors.into_iter().map(Cell::Number);
    let percent = |share: f64| Cell::Number(format!("{} %", fixed(100.0 * share, 0)));
    let none = || Cell::Missing("–".into());
    let cells = rows.iter().map(|(before, after)| {
        let named = before.as_ref().or(after.as_ref());
        let name = |region: &Region| name(region);
        let is_pattern = named.is_some_and(|region| region.pattern.is_some());
        let mut rms = |region: &Option<Region>| {
            region
                .as_ref()
                .and_then(|_| errors.next())
                .unwrap_or_else(none)
        };
        let (rms_before, rms_after) = (rms(before), rms(after));
        let row = [
            Cell::from(named.map_or(String::new(), name)),
            named
                .filter(|_| !is_pattern)
                .map_or_else(none, |region| percent(region.samples)),
            before
                .as_ref()
                .map_or_else(none, |region| percent(region.share)),
            rms_before,
        ];
        row.into_iter()
            .chain((!only_base).then_some(rms_after))
            .collect::<Vec<_>>()
    });
    let cells: Vec<_> = cells.collect();
    Table::new(columns(&unit, only_base))
    .caption(
        "Regions in which the residual is significantly larger than what is allowed; – where it is not.",
    )
    .rows(cells)
}

/// The columns; with the base model alone there is nothing after it.
fn columns(unit: &str, only_base: bool) -> Vec<String> {
    let first = match only_base {
        true => "Residual, rms",
        false => "Residual before, rms",
    };
    let columns = ["Region", "Samples", "Share of the excess"].map(String::from);
    let last = (!only_base).then(|| format!("after [{unit}]"));
    let columns = columns.into_iter().chain([format!("{first} [{unit}]")]);
    columns.chain(last).collect()
}

fn name(region: &Region) -> String {
    match region.pattern {
        Some(Pattern::Line { hz }) => return format!("Line at {}", quantity(hz, 4, "Hz")),
        Some(Pattern::Pitch { m }) => {
            return format!("Repeats every {} of travel", quantity(m, 4, "m"));
        }
        Some(Pattern::Step { s, n }) => {
            return format!("Step of {} at {s:.2} s", quantity(n, 3, "N"));
        }
        Some(Pattern::SurfaceStep { s, m }) => {
            return format!("Surface {} farther at {s:.2} s", quantity(m, 3, "m"));
        }
        None => {}
    }
    match region.id {
        "free" => "Free air",
        "touch" => "Touch",
        "loading" => "Loading",
        "hold" => "Holds",
        "unloading" => "Unloading",
        "lift_off" => "Lift-off",
        "depth_low" => "Shallow third",
        "depth_mid" => "Middle third",
        "depth_high" => "Deep third",
        "forward" => "Way forward",
        "backward" => "Way back",
        "travel_low" => "Lowest third of the travel",
        "travel_mid" => "Middle third of the travel",
        "travel_high" => "Highest third of the travel",
        "slow" => "Slower half of the speeds",
        "fast" => "Faster half of the speeds",
        "early" => "First half of the log",
        "late" => "Second half of the log",
        other => other,
    }
    .into()
}
