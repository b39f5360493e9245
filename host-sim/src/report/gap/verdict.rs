//! The verdict in one sentence.

use estimator_core::physics::effect::EffectId;

use crate::gap::{Finding, MissingEffect, Verdict, changes_in_words, share_in_words};
use crate::number::{Measured, column, spaced};
use crate::report::{Tone, capitalised};

/// The tone and the words of the badge.
pub(super) fn badge(finding: &Finding) -> (Tone, &'static str) {
    if finding.mistaken.is_some() {
        return (Tone::Warning, "units or signs");
    }
    match finding.verdict {
        Verdict::NoMissingEffect => (Tone::Good, "nothing missing"),
        Verdict::MissingEffects if finding.effects.len() == 1 => (Tone::Good, "missing effect"),
        Verdict::MissingEffects => (Tone::Good, "missing effects"),
        Verdict::Ambiguous => (Tone::Warning, "ambiguous"),
        Verdict::PartlyExplained => (Tone::Warning, "partly explained"),
        Verdict::Unexplained if finding.nothing_new && finding.has_changed() => {
            (Tone::Warning, "changed")
        }
        Verdict::Unexplained if finding.nothing_new => (Tone::Good, "nothing new"),
        Verdict::Unexplained => (Tone::Bad, "unexplained"),
    }
}

/// The verdict with its numbers.
pub(super) fn sentence(finding: &Finding) -> String {
    if let Some(why) = &finding.mistaken {
        return capitalised(why) + ".";
    }
    let (before, after) = errors(finding);
    let times =
        |ratio: f64| format!("{ratio:.2} times what noise and the errors of the motion allow");
    let names: Vec<String> = finding.effects.iter().map(named).collect();
    let names = names.join(" and ");
    let shrinks = format!(
        "With {} the error on held-out parts falls from {before} to {after}: {}.",
        if finding.effects.len() == 1 {
            "it"
        } else {
            "them"
        },
        times(finding.ratio_after)
    );
    let text = match finding.verdict {
        Verdict::NoMissingEffect => format!(
            "The base model explains the measurement once its parameters are fitted: its error on \
             held-out parts is {after}, {}.",
            times(finding.ratio_after)
        ),
        Verdict::MissingEffects => format!("The model lacks {names}. {shrinks}"),
        Verdict::Ambiguous => format!(
            "The model lacks {names}, or {}: this log does not tell them apart. {shrinks}",
            rivals(finding)
        ),
        Verdict::Unexplained if finding.nothing_new => format!(
            "Beside the model {}{}: with its parameters fitted its error on held-out parts is {before}, \
             hardly more than was left when it was identified. That is {}, and no effect of the catalogue \
             explains it.",
            finding.nothing_new_in_words(),
            changes(finding),
            times(finding.ratio_before)
        ),
        Verdict::Unexplained if !finding.left_out.is_empty() => format!(
            "Nothing is missing{}: with that stretch the base model's error on held-out parts is {before}, {}.",
            spaced(&finding.outside_in_words()),
            times(finding.ratio_before)
        ),
        Verdict::Unexplained => format!(
            "Something is missing that no effect of the catalogue explains: with its parameters fitted \
             the base model's error on held-out parts is {before}, {}.",
            times(finding.ratio_before)
        ),
        Verdict::PartlyExplained => format!(
            "The model lacks {names}, which takes {} of the disagreement{} off. What remains no effect of \
             the catalogue explains. {shrinks}",
            spaced(&share_in_words(finding.explained_share().unwrap_or(0.0))),
            spaced(&finding.outside_in_words())
        ),
    };
    match finding.slow_remainder_in_words() {
        words if words.is_empty() => text,
        words => format!("{text} But {words}."),
    }
}

/// The numbers that have changed, in brackets; empty where none has.
fn changes(finding: &Finding) -> String {
    if !finding.has_changed() {
        return String::new();
    }
    let all = changes_in_words(finding.changed.as_ref());
    format!(" ({})", spaced(&all.join("; ")))
}

/// The errors before and after, with the same unit prefix and decimals.
pub(super) fn errors(finding: &Finding) -> (String, String) {
    let errors_n = [finding.rmse_before_n, finding.rmse_after_n];
    let (unit, values) = column(&errors_n, 4, "N");
    let text = |at: usize| format!("{}\u{a0}{unit}", values.get(at).map_or("–", String::as_str));
    (text(0), text(1))
}

/// An effect with its leading parameter.
fn named(effect: &MissingEffect) -> String {
    let title = title(effect.id);
    match effect.parameters.first() {
        Some(first) => {
            let value = Measured::new(first.value, first.std_error, first.unit);
            format!("{title} ({} {value})", first.name.replace('_', " "))
        }
        None => title,
    }
}

fn rivals(finding: &Finding) -> String {
    let mut ids: Vec<String> = Vec::new();
    for id in finding
        .effects
        .iter()
        .flat_map(|effect| &effect.alternatives)
    {
        if !ids.contains(&title(*id)) {
            ids.push(title(*id));
        }
    }
    ids.join(" or ")
}

/// The name of an effect for people, within a sentence.
pub(super) fn title(id: EffectId) -> String {
    let words = id.name().replace('_', " ");
    // Two of them are named after people.
    words
        .replace("coulomb", "Coulomb")
        .replace("stribeck", "Stribeck")
}

/// The same name at the start of a cell.
pub(super) fn heading(id: EffectId) -> String {
    capitalised(&title(id))
}
