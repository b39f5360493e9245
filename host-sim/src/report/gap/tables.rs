//! The tables: errors before and after, effects, base parameters, candidates, floors.

use super::label;
use super::verdict::{heading, title};
use crate::gap::{
    Candidate, Finding, MissingEffect, ParameterEstimate, Verdict, changes_in_words, times_larger,
};
use crate::number::{Measured, spaced};
use crate::report::{Cell, Section, Table};

/// A parameter has moved if it changed by more than this many standard errors.
const MOVED: f64 = 3.0;
/// Half a 95 % interval in standard errors.
const INTERVAL: f64 = 1.96;
/// The most sets of effects that are shown.
const MOST_SETS: usize = 14;

/// The errors before and after, the advice and the notes.
pub(super) fn summary(finding: &Finding) -> Section {
    let has_effects = !finding.effects.is_empty();
    let errors = super::verdict::errors(finding);
    let times = |ratio: f64| format!("{ratio:.2} ×");
    let multiple = |rmse_n: f64| times(rmse_n / finding.noise_floor_n);
    let row = |name: &str, before: String, after: String| {
        let after = has_effects.then_some(Cell::Number(after));
        [Cell::from(name), Cell::Number(before)]
            .into_iter()
            .chain(after)
            .collect::<Vec<_>>()
    };
    let columns = match has_effects {
        true => vec!["Held-out parts", "Before", "After"],
        false => vec!["Held-out parts", "Base model"],
    };
    let table = Table::new(columns)
        .row(row("Error, rms", errors.0, errors.1))
        .row(row(
            "over the noise of the force",
            multiple(finding.rmse_before_n),
            multiple(finding.rmse_after_n),
        ))
        .row(row(
            "over noise and errors of the motion",
            times(finding.ratio_before),
            times(finding.ratio_after),
        ));
    let what = match finding.bandwidth_hz {
        None => "the measured force".to_string(),
        Some(hz) => format!("both forces below {hz} Hz"),
    };
    let said = match has_effects {
        true => "Before: the base model, refitted. After: the same with the effects, all refitted.",
        false => "The base model is refitted.",
    };
    // That nothing is missing stands in the verdict.
    let advice = match finding.verdict {
        Verdict::NoMissingEffect if finding.advised.is_none() => String::new(),
        _ => spaced(&finding.advice),
    };
    Section::new("What to know")
        .text(advice)
        .list(finding.notes.iter().map(|note| spaced(note)))
        .text(format!(
            "The errors are those of {what}, on parts of the log that the fits do not see. {said}"
        ))
        .table(table)
}

/// The missing effects with their parameters.
pub(super) fn effects(finding: &Finding) -> Section {
    let mut section = Section::new("What it is");
    for effect in &finding.effects {
        section = section.table(table(&heading(effect.id), &effect.parameters));
    }
    section.list(
        finding
            .effects
            .iter()
            .map(|effect| description(effect, finding)),
    )
}

/// A table of parameters with their intervals.
fn table(caption: &str, parameters: &[ParameterEstimate]) -> Table {
    let rows = parameters.iter().map(|estimate| {
        [
            Cell::from(label(&estimate.name)),
            measured(estimate),
            interval(estimate),
        ]
    });
    Table::new(["Parameter", "Value ± standard error", "95 % interval"])
        .caption(caption)
        .rows(rows)
}

fn description(effect: &MissingEffect, finding: &Finding) -> String {
    let mut text = format!(
        "{}: {}. Without it, all else refitted, the squared error on held-out parts is {}.",
        heading(effect.id),
        effect.id.info().law,
        share_larger(effect.held_out_gain),
    );
    // What a single effect explains is the disagreement, whose table stands below.
    if finding.effects.len() > 1 {
        text += &format!(" {}.", where_it_shows(&effect.place));
    }
    if !effect.alternatives.is_empty() {
        let others: Vec<String> = effect.alternatives.iter().map(|id| title(*id)).collect();
        let motion = match finding.advised {
            Some(_) => "motion.toml",
            None => effect.id.info().motion,
        };
        text += &format!(
            " This log is explained as well by: {}. To tell them apart, record {motion}.",
            others.join(", "),
        );
    }
    spaced(&text)
}

/// How much larger the squared error is without an effect; `gain` is 1 − (RMSE with/RMSE without)².
fn share_larger(gain: f64) -> String {
    format!(
        "{} (held-out gain {:.1} %)",
        times_larger(gain),
        100.0 * gain
    )
}

fn where_it_shows(place: &str) -> String {
    match place {
        "" => "It shows in no particular region".into(),
        place => format!(
            "Of what it explains, {}",
            place.replace("of the excess ", "")
        ),
    }
}

fn measured(estimate: &ParameterEstimate) -> Cell {
    Cell::measured(estimate.value, estimate.std_error, estimate.unit)
}

/// A cell about a parameter, or that there is none.
fn or_none(estimate: Option<&ParameterEstimate>, of: impl Fn(&ParameterEstimate) -> Cell) -> Cell {
    estimate.map_or(Cell::Missing("–".into()), of)
}

/// The 95 % interval of a parameter, with both ends in the digits and the unit of the value.
fn interval(estimate: &ParameterEstimate) -> Cell {
    if let Some(remark) = estimate.remark() {
        return Cell::Missing(remark.into());
    }
    let Some(error) = estimate
        .std_error
        .filter(|error| *error > 0.0 && error.is_finite())
    else {
        return Cell::Missing(
            if estimate.at_bound {
                "at its bound"
            } else {
                "not fitted"
            }
            .into(),
        );
    };
    let end = |sign: f64| {
        let end = Measured::new(
            estimate.value + sign * INTERVAL * error,
            Some(error),
            estimate.unit,
        );
        (end.value, end.unit)
    };
    let ((low, low_unit), (high, unit)) = (end(-1.0), end(1.0));
    let low = if low_unit == unit {
        low
    } else {
        format!("{low} {low_unit}")
    };
    Cell::Number(format!("{low} … {high} {unit}").trim_end().into())
}

/// The base's parameters before and after, and whether they moved.
pub(super) fn base(finding: &Finding) -> Section {
    let given = finding.given();
    let given = given
        .iter()
        .map(|(id, parameters)| table(&heading(*id), parameters));
    let section = given.fold(environment(finding), Section::table);
    match changes_in_words(finding.changed.as_ref()) {
        words if words.is_empty() => section,
        words => section.text(format!(
            "Changed since the model was identified: {}.",
            words.join("; ")
        )),
    }
}

fn environment(finding: &Finding) -> Section {
    if finding.base_after.is_empty() {
        return Section::new("The effects that the base model had already");
    }
    let pairs = finding.base_pairs();
    if finding.effects.is_empty() {
        let rows = pairs.map(|(_, after)| {
            [
                Cell::from(label(&after.name)),
                measured(after),
                interval(after),
            ]
        });
        let table = Table::new(["Parameter", "Value ± standard error", "95 % interval"]).rows(rows);
        return Section::new("The base model's parameters")
            .text("The base model is fitted to the whole log.")
            .table(table);
    }
    let rows = pairs.map(|(before, after)| {
        [
            Cell::from(label(&after.name)),
            or_none(before, measured),
            measured(after),
            interval(after),
            or_none(before, |before| Cell::Number(change(before, after))),
            or_none(before, |before| moved(before, after)),
        ]
    });
    let columns = [
        "Parameter",
        "Before",
        "After",
        "95 % interval after",
        "Change",
        "Moved?",
    ];
    Section::new("What that does to the base model's parameters")
        .text(
            "A model without the effect bends its own parameters to imitate it, and its standard errors do \
             not show that. Moved: by more than three standard errors (σ) of both fits together.",
        )
        .table(Table::new(columns).rows(rows))
}

/// The base's parameters before and after and the effects' own, each beside its true value.
pub(super) fn against(finding: &Finding, truths: &[(&str, f64)]) -> Table {
    let truth = |own: &ParameterEstimate| match truths.iter().find(|(name, _)| *name == own.name) {
        Some((_, truth)) => Cell::measured(*truth, None, own.unit),
        None => Cell::Missing("–".into()),
    };
    let base = finding.base_pairs();
    let base = base.map(|(before, after)| {
        let name = Cell::from(label(&after.name));
        [
            name,
            or_none(before, measured),
            measured(after),
            truth(after),
        ]
    });
    let effects = finding.effects.iter().flat_map(|effect| {
        effect.parameters.iter().map(|own| {
            let name = format!("{}: {}", heading(effect.id), own.name.replace('_', " "));
            let none = Cell::Missing("not in the model".into());
            [Cell::from(name), none, measured(own), truth(own)]
        })
    });
    Table::new(["Parameter", "Without it", "With it", "True"])
        .caption("The model's parameters, each fit to the same log; value ± one standard error.")
        .rows(base.chain(effects))
}

pub(super) fn change(before: &ParameterEstimate, after: &ParameterEstimate) -> String {
    let change = (after.value - before.value) / before.value.abs();
    match change {
        // A parameter that may be 0, such as the surface, has no meaningful relative change.
        c if !c.is_finite() || before.name == "surface" => {
            let difference = after.value - before.value;
            let sign = if difference > 0.0 { "+" } else { "" };
            // As `moved` counts.
            let errors = before.std_error.zip(after.std_error);
            let both = errors.map(|(a, b)| a.hypot(b));
            format!("{sign}{}", Measured::new(difference, both, after.unit))
        }
        c if c.abs() >= 0.0995 => format!("{:+.0} %", 100.0 * c),
        c => format!("{:+.1} %", 100.0 * c),
    }
    .replacen('-', "\u{2212}", 1)
}

pub(super) fn moved(before: &ParameterEstimate, after: &ParameterEstimate) -> Cell {
    match (before.std_error, after.std_error) {
        (Some(a), Some(b)) if a.hypot(b) > 0.0 => {
            let errors = (after.value - before.value).abs() / a.hypot(b);
            match errors > MOVED {
                true => Cell::Number(format!("yes, by {errors:.0} σ")),
                false => Cell::Number(format!("no, {errors:.1} σ")),
            }
        }
        (None, None) => Cell::Missing("not fitted".into()),
        _ => Cell::Missing("at a bound in one fit".into()),
    }
}

/// The sets of effects that were tried, the best first.
pub(super) fn ladder(finding: &Finding) -> Section {
    if finding.ladder.is_empty() {
        return Section::new("");
    }
    let chosen: Vec<_> = finding.effects.iter().map(|effect| effect.id).collect();
    let rows = finding.ladder.iter().map(|candidate| {
        [
            Cell::from(set(candidate)),
            Cell::Number(format!("{:.3} ×", candidate.ratio)),
            Cell::from(role(finding, candidate, &chosen)),
        ]
    });
    let table = Table::new([
        "Added to the base model",
        "Residual over what is allowed",
        "",
    ])
    .caption("All numbers are refitted jointly, on the whole log, at the resolution of the search.")
    .rows(rows)
    .at_most(MOST_SETS);
    Section::new("What was tried").table(table)
}

fn set(candidate: &Candidate) -> String {
    match candidate.ids.is_empty() {
        true => "nothing".into(),
        false => candidate
            .ids
            .iter()
            .map(|id| title(*id))
            .collect::<Vec<_>>()
            .join(" + "),
    }
}

/// Whether a candidate is the answer, is an alternative to it, or neither.
fn role(
    finding: &Finding,
    candidate: &Candidate,
    chosen: &[estimator_core::physics::effect::EffectId],
) -> &'static str {
    let same = |one: &[_], other: &[_]| {
        one.len() == other.len() && one.iter().all(|id| other.contains(id))
    };
    if same(&candidate.ids, chosen) {
        return if chosen.is_empty() {
            "base model, and the answer"
        } else {
            "the answer"
        };
    }
    if candidate.ids.is_empty() {
        return "base model";
    }
    let swapped = finding.effects.iter().any(|effect| {
        effect.alternatives.iter().any(|other| {
            let ids: Vec<_> = chosen
                .iter()
                .map(|id| if *id == effect.id { *other } else { *id })
                .collect();
            same(&candidate.ids, &ids)
        })
    });
    if swapped {
        "an alternative to the answer"
    } else {
        ""
    }
}

/// How the noise floor of each log was found.
pub(super) fn floors(finding: &Finding, names: &[String]) -> Section {
    let rows = finding.floors.iter().enumerate().map(|(at, floor)| {
        [
            Cell::from(names.get(at).map_or("the log", String::as_str)),
            Cell::quantity(floor.high_pass_n, 3, "N"),
            match floor.rest_n {
                Some(rest) => Cell::quantity(rest, 3, "N"),
                None => Cell::Missing("never at rest".into()),
            },
            Cell::quantity(floor.used_n, 3, "N"),
            Cell::from(floor.why.as_str()),
        ]
    });
    let columns = [
        "Log",
        "Second differences",
        "At rest in free air",
        "Used",
        "Why",
    ];
    Section::new("The noise floor")
        .text("The scatter of the force that no motion causes. It is measured without a model.")
        .table(Table::new(columns).rows(rows).at_most(MOST_SETS))
}
