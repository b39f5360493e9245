//! Where the base model is off, and what remains.

use crate::gap::{Finding, Region, Verdict, words};
use crate::report::number::{fixed, quantity};
use crate::report::{Cell, Section, Table};

/// Where it was, and where it still is.
pub(super) fn place(finding: &Finding) -> Section {
    let section = Section::new("Where the base model and the measurement disagree");
    if finding.disagreement.is_empty() {
        return section.text(
            "Nowhere: in no phase, at no depth, speed, time or frequency are the residuals significantly \
             larger than noise and the errors of the motion allow (false discoveries below 1 %).",
        );
    }
    let remains = match (finding.verdict, finding.remaining.is_empty()) {
        (Verdict::NoMissingEffect, _) => {
            "All of it is within what the floor itself may be wrong by.".to_string()
        }
        (_, true) => "With the effects, nothing significant remains anywhere.".into(),
        (_, false) => format!("What remains with the effects: {}.", words(&finding.remaining)),
    };
    section
        .text(sentence(&words(&finding.disagreement)))
        .text(remains)
        .table(table(&finding.disagreement, "Before"))
        .table(table(&finding.remaining, "After"))
}

fn sentence(text: &str) -> String {
    match text {
        "" => String::new(),
        text => format!("{text}."),
    }
}

fn table(regions: &[Region], caption: &str) -> Table {
    let rows = regions.iter().map(|region| {
        let is_line = region.hz.is_some() || region.pitch_m.is_some();
        let percent = |share: f64| Cell::Number(format!("{} %", fixed(100.0 * share, 0)));
        [
            Cell::from(name(region)),
            percent(region.share),
            match is_line {
                true => Cell::Missing("–".into()),
                false => percent(region.samples),
            },
            Cell::quantity(region.rms_n, 3, "N"),
        ]
    });
    let caption = match regions.is_empty() {
        true => format!("{caption}: no region exceeds what is allowed significantly"),
        false => format!("{caption}: regions that exceed what is allowed significantly"),
    };
    Table::new(["Region", "Share of the excess", "of the samples", "Residual, rms"])
        .caption(caption)
        .rows(rows)
}

fn name(region: &Region) -> String {
    if let Some(hz) = region.hz {
        return format!("Line at {}", quantity(hz, 4, "Hz"));
    }
    if let Some(pitch_m) = region.pitch_m {
        return format!("Repeats every {} of way", quantity(pitch_m, 4, "m"));
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
        "slow" => "Slower half of the speeds",
        "fast" => "Faster half of the speeds",
        "early" => "First half of the log",
        "late" => "Second half of the log",
        other => other,
    }
    .into()
}
