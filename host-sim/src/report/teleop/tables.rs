//! The measures of a run, and what a person would notice of them.

use super::run::TeleopReport;
use crate::report::{Cell, Section, Table};
use crate::teleop::Measures;
use crate::teleop::notice::notices;

/// The measures.
pub(super) fn summary(report: &TeleopReport<'_>) -> Section {
    let rows = felt(report.measures).into_iter().chain(rest(report));
    let rows = rows.map(|(name, cell)| [Cell::from(name), cell]);
    let table = Table::new(["Measure", "Value"]).rows(rows);
    let packets = &report.measures.packets;
    Section::new("Measures")
        .table(table)
        .text(limits(report.measures))
        .text(format!(
            "{} messages were sent, {} were lost, {} arrived too late or were refused; {} bytes a second the \
             busier way.",
            packets.sent, packets.lost, packets.rejected, packets.bytes_per_s
        ))
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

fn felt(measures: &Measures) -> [(&'static str, Cell); 7] {
    [
        (
            "Felt minus true force, rms over peak, from when it is ready",
            share(measures.felt_force_rmse_share),
        ),
        (
            "Felt minus true force over every contact, rms over peak",
            share(Some(measures.felt_force_rmse_share_whole)),
        ),
        (
            "Felt minus true force on the second material, rms over peak",
            share(measures.felt_force_rmse_share_after),
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
        (
            "The same after the change of material",
            time(measures.resettled_s),
        ),
    ]
}

fn rest(report: &TeleopReport<'_>) -> [(&'static str, Cell); 5] {
    let measures = report.measures;
    let (limit_s, tried_s) = report.limit_s;
    let limit = match limit_s {
        Some(limit_s) if limit_s >= tried_s => Cell::from(format!("at least {tried_s} s")),
        Some(limit_s) => Cell::quantity(limit_s, 2, "s"),
        None => Cell::Missing("none".into()),
    };
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
            "Energy that the coupling created",
            quantity(measures.created_energy_j, "J"),
        ),
        (
            "Energy of exchanged impedances, declared",
            quantity(measures.exchanged_energy_j, "J"),
        ),
        ("Largest round trip at which it comes to rest", limit),
    ]
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
            notice.value.map_or(Cell::Missing("none".into()), number),
            number(threshold.from),
            Cell::from(if notice.is_noticed() {
                "noticed"
            } else {
                "not noticed"
            }),
            Cell::from(threshold.source),
        ]
    });
    let table = Table::new(["What", "Here", "Noticed from", "A person", "Because"]).rows(rows);
    Section::new("What a person would notice").table(table)
}
