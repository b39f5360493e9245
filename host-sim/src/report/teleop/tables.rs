//! The measures of a run, and what a person would notice of them.

use super::run::TeleopReport;
use super::words;
use crate::number::quantity;
use crate::report::{Cell, Section, Table, capitalised};
use crate::teleop::Measures;
use crate::teleop::measure::felt::NotCompared;
use crate::teleop::notice::notices;

/// The measures.
pub(super) fn summary(report: &TeleopReport<'_>) -> Section {
    let rows = felt(report.measures).into_iter().chain(rest(report));
    let rows = rows.map(|(name, cell)| [Cell::from(name), cell]);
    let table = Table::new(["Measure", "Value"]).rows(rows);
    let section = Section::new("Measures")
        .table(table)
        .text(limits(report.measures))
        .text(messages(report.measures));
    let notes = report.notes.iter().map(|note| capitalised(note) + ".");
    notes.fold(section, Section::text)
}

fn messages(measures: &Measures) -> String {
    let packets = &measures.packets;
    let age = |age_s: Option<f64>| age_s.map_or("–".into(), |age_s| quantity(age_s, 2, "s"));
    let to_rate = match packets.lost_to_rate {
        0 => String::new(),
        lost => format!(" ({lost} of them to the limited rate)"),
    };
    format!(
        "{} messages were sent, {} were lost{to_rate}, {} arrived too late or were refused; {} bytes a second the \
         busier way. What the slave applies is {} old on average, what the master applies {}: of messages that \
         overtake each other the newest counts.",
        packets.sent,
        packets.lost,
        packets.rejected,
        packets.bytes_per_s,
        age(measures.ages_s[0]),
        age(measures.ages_s[1]),
    )
}

fn share(value: Option<f64>) -> Cell {
    match value {
        Some(value) => Cell::Number(format!("{:.1} %", 100.0 * value)),
        None => Cell::Missing("none".into()),
    }
}

fn time(value: Option<f64>) -> Cell {
    match value {
        Some(value) => Cell::quantity(value, 2, "s"),
        None => Cell::Missing("never".into()),
    }
}

fn felt(measures: &Measures) -> Vec<(&'static str, Cell)> {
    let why = measures
        .felt_force_not_compared
        .map_or("none", NotCompared::word);
    let mut rows = vec![
        (
            "Felt minus true force, rms over peak, from when it is ready",
            match measures.felt_force_rmse_share {
                None => Cell::Missing(why.into()),
                known => share(known),
            },
        ),
        (
            "Felt minus true force over every contact, rms over peak",
            share(Some(measures.felt_force_rmse_share_whole)),
        ),
        (
            "Felt stiffness, error",
            share(measures.felt_stiffness_error),
        ),
        ("Felt damping, error", share(measures.felt_damping_error)),
        (
            "Contact and way back until felt within 5 %",
            time(measures.settled_s),
        ),
    ];
    if measures.changed_s.is_some() {
        rows.extend([
            (
                "Felt minus true force on the second material, rms over peak",
                share(measures.felt_force_rmse_share_after),
            ),
            (
                "Contact and way back on the second material",
                time(measures.resettled_s),
            ),
        ]);
    }
    rows
}

fn rest(report: &TeleopReport<'_>) -> [(&'static str, Cell); 6] {
    let measures = report.measures;
    let limit = words::limit(&report.limit, report.options.round_trip_s());
    let quantity = |value, unit| Cell::quantity(value, 2, unit);
    [
        (
            "Slave's distance from the master's position one delay earlier, rms",
            quantity(measures.position_rmse_m, "m"),
        ),
        (
            "Peak force on the material, first touch",
            quantity(measures.peak_touch_n, "N"),
        ),
        (
            "Energy that the coupling gave out beyond what went in",
            energy(measures.coupling_energy_j),
        ),
        (
            "The same at the hand, after the master's own damping",
            energy(measures.created_energy_j),
        ),
        (
            "Energy of exchanged impedances, declared",
            quantity(measures.exchanged_energy_j, "J"),
        ),
        (
            "Comes to rest, if only slowly, at every round trip tried up to",
            limit.map_or_else(|why| Cell::Missing(why.into()), Cell::from),
        ),
    ]
}

/// Energy that came out; what may have been stored before is not counted.
fn energy(value_j: f64) -> Cell {
    match value_j > 0.0 {
        true => Cell::quantity(value_j, 2, "J"),
        false => Cell::Missing("none beyond what was stored".into()),
    }
}

fn limits(measures: &Measures) -> String {
    let limits: Vec<String> = measures
        .limits
        .iter()
        .map(|(name, share)| format!("{name} {:.1} %", 100.0 * share))
        .collect();
    match limits.as_slice() {
        [] => String::new(),
        limits => format!(
            "Limits of the renderer at work, as a share of the contact: {}.",
            limits.join(", ")
        ),
    }
}

/// What a person would notice.
pub(super) fn noticed(report: &TeleopReport<'_>) -> Section {
    let rows = notices(report.trace, report.measures).map(|notice| {
        let threshold = notice.threshold;
        let number = |value: f64| match threshold.unit {
            "1" => Cell::Number(format!("{:.1} %", 100.0 * value)),
            unit => Cell::quantity(value, 2, unit),
        };
        [
            Cell::from(threshold.what),
            notice
                .value
                .map_or(Cell::Missing("not determined".into()), number),
            number(threshold.from),
            match notice.is_noticed {
                Some(true) => Cell::from("noticed"),
                Some(false) => Cell::from("not noticed"),
                None => Cell::Missing("cannot be told".into()),
            },
            Cell::from(threshold.source),
        ]
    });
    let table = Table::new(["What", "Here", "Noticed from", "A person", "Because"]).rows(rows);
    Section::new("What a person would notice").table(table)
}
